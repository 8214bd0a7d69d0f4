"""Impacts that give something back: bounces of known height, an edge's closed form, energy, and how they end."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from analytic import AnalyticInputError, spatial
from analytic.block import GRAVITY_M_S2 as GRAVITY
from analytic.spatial.kernel.impact import LEAST_RISE_M
from tests.budgets_spatial import AUDIT, CLOSED_FORM, IMPULSE

HALF_M = 0.0524
CORNERS = [(x * HALF_M, y * HALF_M, z * HALF_M) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
CUBE = spatial.Body(0.37, 8.1e-4 * np.eye(3), CORNERS)
DROP_M = 0.1
DROP_S = math.sqrt(2.0 * DROP_M / GRAVITY)


def dropped(turn: Rotation, **changes: Any) -> spatial.Solution:
    """The cube let go with its lowest point 0.1 m above the floor."""
    x, y, z, w = turn.as_quat()
    lowest_m = float((CUBE.vertices_m @ turn.as_matrix().T)[:, 2].min())
    start = {"position_m": (0.0, 0.0, DROP_M - lowest_m), "quaternion_wxyz": (w, x, y, z), "overturn_rad": math.tau}
    return spatial.simulate(CUBE, **({"duration_s": 0.25, "friction_static": 0.5, "dt_out_s": 1e-4} | start | changes))


@pytest.mark.parametrize("share", [0.3, 0.8, 1.0])
@pytest.mark.parametrize("towards", [(0.0, 0.0, -1.0), (1.0, 1.0, -1.0)])
def test_a_drop_onto_a_face_or_a_corner_comes_back_to_e_squared(share: float, towards: tuple[float, ...]) -> None:
    turn = Rotation.align_vectors([[0.0, 0.0, -1.0]], [towards])[0]
    run = dropped(turn, restitution=share)
    first = run.impacts[0]
    assert first.time_s == pytest.approx(DROP_S, abs=CLOSED_FORM)
    assert first.energy_lost_j == pytest.approx(CUBE.mass_kg * GRAVITY * DROP_M * (1.0 - share**2), abs=IMPULSE)
    after = (run.t_s > DROP_S) & (run.t_s < DROP_S * (1.0 + 2.0 * share))
    flown = run.t_s[after] - DROP_S
    rise = share * GRAVITY * DROP_S * flown - 0.5 * GRAVITY * flown**2
    np.testing.assert_allclose(run.gap_m[after].min(axis=1), rise, rtol=0.0, atol=CLOSED_FORM)


def test_an_edge_without_friction_is_struck_by_the_known_impulse() -> None:
    """p = (1 + e) m v / (1 + m a²/I), at the lever a, turns the body by p a/I."""
    share, tilt = 0.4, 0.3
    run = dropped(Rotation.from_euler("y", tilt), restitution=share, friction_static=0.0)
    arm_m = HALF_M * (math.cos(tilt) - math.sin(tilt))
    moment = CUBE.inertia_kg_m2[1, 1]
    impulse = (1.0 + share) * CUBE.mass_kg * GRAVITY * DROP_S / (1.0 + CUBE.mass_kg * arm_m**2 / moment)
    assert run.impacts[0].impulses_n_s[:, 2].sum() == pytest.approx(impulse, rel=CLOSED_FORM)
    after = run.t_s > run.impacts[0].time_s
    assert abs(run.angular_velocity_rad_s[after][0, 1]) == pytest.approx(impulse * arm_m / moment, rel=CLOSED_FORM)


@pytest.mark.parametrize("friction", [0.2, 0.8])
@pytest.mark.parametrize("share", [0.3, 1.0])
def test_no_impact_of_a_thrown_cube_adds_energy(friction: float, share: float) -> None:
    rng = np.random.default_rng(5)
    count = 0
    for _ in range(10):
        run = dropped(
            Rotation.random(rng=rng),
            friction_static=friction,
            restitution=share,
            velocity_m_s=rng.uniform(-1.0, 1.0, 3),
            angular_velocity_rad_s=rng.uniform(-5.0, 5.0, 3),
            duration_s=0.4,
        )
        count += len(run.impacts)
        assert min(event.energy_lost_j for event in run.impacts) > -AUDIT
        assert run.momentum_residual < AUDIT
        assert run.cone_residual < IMPULSE
        assert run.gap_m.min() > -IMPULSE
    assert count > 20


def test_bounces_too_low_to_be_seen_end() -> None:
    """Half the velocity comes back at each: it rests after the last one that would rise above the least rise."""
    first_m_s, least_m_s = GRAVITY * DROP_S, math.sqrt(2.0 * GRAVITY * LEAST_RISE_M)
    bounces = math.floor(math.log2(first_m_s / least_m_s))
    run = dropped(Rotation.identity(), restitution=0.5, duration_s=1.0)
    assert len(run.impacts) == bounces + 1
    flights_s = sum(2.0 * first_m_s * 0.5**k / GRAVITY for k in range(1, bounces + 1))
    assert run.intervals[-1].mode is spatial.Mode.REST
    assert run.intervals[-1].start_s == pytest.approx(DROP_S + flights_s, abs=CLOSED_FORM)


def test_what_gives_back_too_little_has_the_bits_of_a_plastic_impact() -> None:
    turn = Rotation.from_euler("xyz", [0.4, 0.3, 0.2])
    plastic, nearly = dropped(turn), dropped(turn, restitution=1e-4)
    assert plastic.impacts
    np.testing.assert_array_equal(nearly.position_m, plastic.position_m)
    np.testing.assert_array_equal(nearly.quaternion_wxyz, plastic.quaternion_wxyz)


@pytest.mark.parametrize("share", [-0.1, 1.1, math.nan])
def test_a_share_that_is_none_is_refused(share: float) -> None:
    with pytest.raises(AnalyticInputError, match=r"^restitution: "):
        spatial.Problem(CUBE, 1.0, 0.5, restitution=share)
