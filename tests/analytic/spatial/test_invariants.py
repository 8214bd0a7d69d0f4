"""Balances, cones and symmetries of runs in all three directions."""

import math

import numpy as np
import pytest

import analytic
from analytic import AnalyticInputError, spatial
from analytic.block import GRAVITY_M_S2 as GRAVITY
from analytic.block import rotation_matrices
from tests.budgets_spatial import AUDIT, ENERGY_REL, IMPULSE, MIRROR

BODY = spatial.Body.block(400.0, 0.35, 0.45, 1.1)
DURATION_S = 1.2


def shaken(
    body: spatial.Body, x: float, y: float, friction: float, yaw_rad: float = 0.0, duration_s: float = DURATION_S
) -> spatial.Solution:
    """One sine along each axis, in g, and some vertical motion."""
    return spatial.simulate(
        body,
        analytic.Pulse("one_sine", x * GRAVITY, 0.5),
        analytic.Pulse("one_sine", y * GRAVITY, 0.6),
        analytic.Harmonic(1.0, 3.0),
        duration_s=duration_s,
        friction_static=friction,
        quaternion_wxyz=(math.cos(0.5 * yaw_rad), 0.0, 0.0, math.sin(0.5 * yaw_rad)),
        dt_out_s=0.005,
    )


@pytest.mark.parametrize("friction", [0.35, 0.6, 1.0, math.inf])
def test_balances_hold_and_impulses_stay_in_their_cones(friction: float) -> None:
    run = shaken(BODY, 0.5, 0.45, friction)
    assert run.impacts or friction < 0.4
    assert run.energy_residual < AUDIT
    assert run.momentum_residual < AUDIT
    assert run.cone_residual < IMPULSE
    assert run.gap_m.min() > -IMPULSE
    assert all(event.energy_lost_j >= -IMPULSE for event in run.impacts)
    assert run.energy_lost_by_sliding_j >= -IMPULSE
    assert not run.gave_up


@pytest.mark.parametrize("friction", [0.6, math.inf])
def test_a_mirrored_scene_gives_the_mirrored_history(friction: float) -> None:
    run, other = shaken(BODY, 0.5, 0.45, friction), shaken(BODY, 0.5, -0.45, friction)
    np.testing.assert_allclose(other.position_m, run.position_m * [1.0, -1.0, 1.0], atol=MIRROR)
    np.testing.assert_allclose(other.quaternion_wxyz, run.quaternion_wxyz * [1.0, -1.0, 1.0, -1.0], atol=MIRROR)


def test_a_turned_scene_gives_the_turned_history() -> None:
    """Motion (x, y) turned by a right angle, (−y, x), on a body turned by a right angle."""
    run = shaken(BODY, 0.5, 0.0, 0.6)
    turned = spatial.simulate(
        BODY,
        None,
        analytic.Pulse("one_sine", 0.5 * GRAVITY, 0.5),
        analytic.Harmonic(1.0, 3.0),
        duration_s=DURATION_S,
        friction_static=0.6,
        quaternion_wxyz=(math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)),
        dt_out_s=0.005,
    )
    place = run.position_m
    wanted = np.column_stack([-place[:, 1], place[:, 0], place[:, 2]])
    np.testing.assert_allclose(turned.position_m, wanted, atol=MIRROR)


def test_the_certificate_covers_a_coarser_run() -> None:
    problem = spatial.Problem(BODY, 0.6, 1.0, None, analytic.Pulse("one_sine", 0.5 * GRAVITY, 0.5))
    fine, coarse = (
        spatial.certify(problem, dt_out_s=0.01),
        spatial.certify(problem, tolerance=1e-8, dt_out_s=0.01, accuracy=1e-4),
    )
    assert fine.outcome_is_sure
    assert fine.uncertainty_rad < AUDIT
    size = len(fine.solution.t_s) - 1
    error = spatial.attitude_difference_rad(fine.solution, coarse.solution, size).max()
    assert 0.0 < error <= coarse.uncertainty_rad + fine.uncertainty_rad


def test_a_check_that_is_given_up_has_no_other_outcome() -> None:
    problem = spatial.Problem(BODY, 0.6, 1.0, None, analytic.Pulse("one_sine", 0.5 * GRAVITY, 0.5))
    work = spatial.solve(problem, tolerance=1e-8).work
    found = spatial.certify(problem, tolerance=1e-8, dt_out_s=0.01, most_steps=work.steps + work.rejected + 1)
    assert not found.solution.gave_up
    assert not found.complete
    assert found.outcome_is_sure


def test_a_wobbling_body_comes_to_rest() -> None:
    tilt = 0.05
    body = spatial.Body.block(50.0, 0.4, 0.5, 0.5)
    run = spatial.simulate(
        body,
        duration_s=4.0,
        friction_static=0.8,
        quaternion_wxyz=(math.cos(tilt), math.sin(tilt) * 0.6, math.sin(tilt) * 0.8, 0.0),
        dt_out_s=0.01,
    )
    assert run.outcome is spatial.Outcome.STANDS
    assert run.intervals[-1].mode is spatial.Mode.REST
    assert run.energy_residual < AUDIT


def test_outcomes_are_those_of_single_runs() -> None:
    problem = spatial.Problem(
        BODY,
        3.0,
        0.8,
        None,
        analytic.Pulse("one_sine", 0.5 * GRAVITY, 0.8),
        analytic.Pulse("one_sine", 0.4 * GRAVITY, 0.7),
    )
    scales = np.array([0.5, 0.7, 1.5, 3.0])
    many = spatial.outcomes(problem, {"scale": scales}, threads=2)
    for k, scale in enumerate(scales):
        run = spatial.simulate(
            BODY,
            problem.motion_x.scaled(scale),
            problem.motion_y.scaled(scale),
            duration_s=3.0,
            friction_static=0.8,
            tolerance=1e-7,
            dt_out_s=None,
        )
        assert many.outcomes[k] is run.outcome
        assert many.impacts[k] == run.work.impacts
        assert many.peak_tilt_rad[k] == run.peak_tilt_rad
    assert many.overturned.tolist() == [False, False, True, True]
    none = spatial.outcomes(problem, {"scale": []})
    assert (none.peak_tilt_rad.shape, none.overturned.tolist()) == ((0,), [])


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"inertia_kg_m2": np.diag([1.0, 1.0, 3.0])}, "principal"),
        ({"vertices_m": np.zeros((2, 3))}, "three"),
        ({"vertices_m": 5.0}, "three"),
        ({"vertices_m": np.zeros((257, 3))}, "at most 256"),
        ({"mass_kg": -1.0}, "mass_kg"),
    ],
)
def test_what_is_no_body_is_refused(change: dict[str, object], told: str) -> None:
    given = {"mass_kg": 1.0, "inertia_kg_m2": np.eye(3), "vertices_m": BODY.vertices_m} | change
    with pytest.raises(AnalyticInputError, match=told):
        spatial.Body(**given)  # type: ignore[arg-type]


def test_numbers_that_cannot_be_run_are_refused() -> None:
    with pytest.raises(AnalyticInputError, match="friction_kinetic"):
        spatial.Problem(BODY, 1.0, 0.3, 0.4)
    with pytest.raises(AnalyticInputError, match="quaternion"):
        spatial.Problem(BODY, 1.0, 0.3, quaternion_wxyz=(1.0, 1.0, 0.0, 0.0))
    with pytest.raises(AnalyticInputError, match="colour"):
        spatial.outcomes(spatial.Problem(BODY, 1.0, 0.3), {"colour": [1.0]})


@pytest.mark.parametrize("turned", [False, True])
def test_the_start_has_the_energy_of_what_was_given(turned: bool) -> None:
    """½ m v² + ½ ω · I ω with the centroid's velocity as given; about a vertex that is ½ ω · I_vertex ω."""
    body, spin = spatial.Body.block(400.0, 0.35, 0.45, 1.1), np.array([0.3, -0.2, 0.5])
    half = 0.05
    turn = np.array([math.cos(half), 0.6 * math.sin(half), 0.8 * math.sin(half), 0.0])
    rotation = rotation_matrices(turn[None])[0]
    arm = body.vertices_m[np.argmin(body.vertices_m @ rotation[2])]
    velocity = rotation @ np.cross(spin, -arm) if turned else np.zeros(3)
    given = spatial.Problem(
        body, 1.0, 0.5, quaternion_wxyz=turn, velocity_m_s=velocity, angular_velocity_rad_s=spin, gravity_m_s2=GRAVITY
    )
    start = given.start
    energy = 0.5 * body.mass_kg * start[7:10] @ start[7:10] + 0.5 * start[10:] @ body.inertia_kg_m2 @ start[10:]
    about = body.inertia_kg_m2 + (body.mass_kg * (arm @ arm * np.eye(3) - np.outer(arm, arm)) if turned else 0.0)
    assert energy == pytest.approx(0.5 * spin @ about @ spin, rel=ENERGY_REL)
    run = spatial.solve(given, dt_out_s=1e-4)
    if turned:
        np.testing.assert_allclose(run.velocity_m_s[0], velocity, rtol=0.0, atol=ENERGY_REL)
