"""The compiled model held to the independent solver on random blocks in two and three directions, and that to known answers."""

import math
from typing import Final

import numpy as np
import pytest
from scipy.special import ellipj

import analytic
from analytic import spatial
from tests import budgets_spatial as budget
from tests.analytic.spatial.bodies import MASS, G, base, block_inertia, known_block, standing
from tests.analytic.spatial.reference import initial_state, simulate
from tests.analytic.spatial.reference_body import Case, rotation

FRICTIONS: Final = (0.3, 0.4, 0.6, 0.8, 1.0, 2.0)
SEEDS: Final = (0, 1, 2, 3, 4, 5, 9, 10, 11, 15, 16, 17)
"""All frictions in turn. Left out: where edges rock by little as they slide (7, 8) the reference takes a minute."""
DURATION_S: Final = 0.5
STEP_S: Final = 0.005


def drawn(seed: int, kinetic: float) -> tuple[spatial.Problem, Case]:
    """A block under harmonics along x and y, every third along z too, for either solver; kinetic: its coefficient's share."""
    rng = np.random.default_rng(seed)
    width, depth = rng.uniform(0.25, 0.45, 2)
    height = rng.uniform(0.8, 1.3)
    mu = FRICTIONS[seed % len(FRICTIONS)]
    amplitudes = [*(rng.uniform(0.35, 0.6, 2) * G), rng.uniform(0.1, 0.2) * G if seed % 3 == 0 else 0.0]
    frequencies = rng.uniform(0.9, 2.0, 3)
    motions = [
        analytic.Harmonic(a, f) if a else analytic.ZeroExcitation()
        for a, f in zip(amplitudes, frequencies, strict=True)
    ]
    x, y, z = (
        lambda t, a=a, f=f: a * math.sin(2.0 * math.pi * f * t) for a, f in zip(amplitudes, frequencies, strict=True)
    )
    problem = spatial.Problem(
        spatial.Body.block(400.0, width, depth, height),
        DURATION_S,
        mu,
        kinetic * mu,
        motion_x=motions[0],
        motion_y=motions[1],
        motion_z=motions[2],
        gravity_m_s2=G,
    )
    case = Case(
        400.0,
        block_inertia(400.0, width, depth, height),
        base(width, depth, height),
        mu,
        kinetic * mu,
        x,
        y,
        z,
        gravity_m_s2=G,
    )
    return problem, case


def angles_rad(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Angle between the attitudes of two histories of quaternions (n, 4)."""
    sign = np.sign(np.einsum("ij,ij->i", one, other))[:, None]
    return np.asarray(4.0 * np.arcsin(np.clip(0.5 * np.linalg.norm(one - sign * other, axis=1), 0.0, 1.0)))


@pytest.mark.parametrize(("seed", "kinetic"), [*((seed, 1.0) for seed in SEEDS), *((seed, 0.75) for seed in SEEDS[:6])])
def test_a_random_block_follows_the_reference(seed: int, kinetic: float) -> None:
    problem, case = drawn(seed, kinetic)
    times = np.linspace(0.0, DURATION_S, round(DURATION_S / STEP_S) + 1)
    wanted = simulate(case, initial_state(np.array([0.0, 0.0, -case.vertices_m[0, 2]])), times)
    found = spatial.certify(problem, dt_out_s=STEP_S)
    assert wanted.outcome == "ran"
    solution = found.solution
    assert len(solution.t_s) == len(times)
    turned = angles_rad(solution.quaternion_wxyz, wanted.states[:, 6:10])
    moved = np.linalg.norm(solution.position_m - wanted.states[:, :3], axis=1)
    impacts = [event.time_s for event in wanted.impacts()]
    before = times < min(impacts, default=math.inf)
    assert before.sum() > 1
    assert turned[before].max() < budget.TWO_SOLVERS
    assert moved[before].max() < budget.TWO_SOLVERS
    reliable = times <= found.reliable_until_s
    assert turned[reliable].max() < budget.TWO_SOLVERS + found.uncertainty_rad
    assert moved[reliable].max() < budget.TWO_SOLVERS + found.place_uncertainty_m


def test_the_known_block_lifts_onto_its_edge_and_walks_over_its_vertices() -> None:
    run = standing(known_block(math.inf), 1.2)
    assert run.events[0].time_s == pytest.approx(1.0 / 24.0, abs=budget.INTEGRATED)
    assert [joint.sticking for joint in run.joints[1:5]] == [(0, 3), (0,), (3,), (2,)]
    assert run.events[1].time_s == pytest.approx(0.0829, abs=budget.TIME_S)
    landed = [(event.time_s, event.vertices) for event in run.impacts()]
    assert [vertices for _, vertices in landed] == [(0, 3), (2, 3), (1, 2)]
    assert [time for time, _ in landed] == pytest.approx([0.3840, 0.4219, 1.0575], abs=budget.TIME_S)


def test_torque_free_flight_of_three_different_moments() -> None:
    """Euler's equations by Jacobi's functions: ω = (a cn, b sn, c dn) about the body's axes."""
    i1, i2, i3 = 3.0, 2.0, 1.0
    omega = np.array([0.8, 0.0, 2.0])
    first, third = omega[0], omega[2]
    rate = third * math.sqrt((i1 - i3) * (i2 - i3) / (i1 * i2))
    m = (i1 - i2) * i1 * first**2 / ((i2 - i3) * i3 * third**2)
    second = first * math.sqrt(i1 * (i1 - i3) / (i2 * (i2 - i3)))
    case = Case(10.0, np.diag([i1, i2, i3]), base(0.1, 0.1, 0.1), 1.0, 1.0)
    times = np.linspace(0.0, 2.0, 21)
    run = simulate(case, initial_state(np.array([0.0, 0.0, 100.0]), None, None, omega), times)
    sn, cn, dn, _ = ellipj(rate * times, m)
    wanted = np.stack([first * cn, -second * sn, third * dn], axis=1)
    assert np.max(np.abs(run.states[:, 10:] - wanted)) < budget.INTEGRATED


def test_a_heavy_top_precesses_steadily() -> None:
    """m g l = Ω (C ω₃ − A′ Ω cos θ): the tilt stays, the axis turns at Ω."""
    mass, arm, across, along = 2.0, 0.3, 0.05, 0.02
    tilt, precession = 0.4, 3.0
    about = across + mass * arm**2
    spin = (mass * G * arm / precession + about * precession * math.cos(tilt)) / along
    q = np.array([math.cos(tilt / 2), 0.0, math.sin(tilt / 2), 0.0])
    turn = rotation(q)
    omega = turn.T @ np.array([0.0, 0.0, precession])
    omega[2] = spin
    case = Case(mass, np.diag([across, across, along]), np.array([[0.0, 0.0, -arm]]), 10.0, 10.0)
    centroid = turn @ np.array([0.0, 0.0, arm])
    velocity = np.cross([0.0, 0.0, precession], centroid)
    times = np.linspace(0.0, 1.0, 11)
    run = simulate(case, initial_state(centroid, q, velocity, omega), times)
    assert [joint.sticking for joint in run.joints] == [(0,)]
    for t, y in zip(times, run.states, strict=True):
        axis = rotation(y[6:10])[:, 2]
        angle = precession * t
        wanted = [math.sin(tilt) * math.cos(angle), math.sin(tilt) * math.sin(angle), math.cos(tilt)]
        assert axis == pytest.approx(wanted, abs=budget.INTEGRATED)


@pytest.mark.parametrize(("amplitude_g", "critical"), [(0.5, 0.3735), (1.0, 0.4783), (2.0, 0.6364)])
def test_uplift_without_slip_needs_a_coefficient(amplitude_g: float, critical: float) -> None:
    """μ = (A (q² + 4) + 3 q)/(4 q² + 1 + 3 q A) for a step of A g on a rectangle, q = h/b = 3."""
    q = 3.0
    formula = (amplitude_g * (q * q + 4) + 3 * q) / (4 * q * q + 1 + 3 * q * amplitude_g)
    assert formula == pytest.approx(critical, abs=budget.TIME_S)
    block = (100.0, block_inertia(100.0, 0.2, 0.2, 0.6), base(0.2, 0.2, 0.6))
    for side in (-1.0, 1.0):
        friction = formula + side * budget.UPLIFT
        case = Case(*block, friction, friction, accel_x_m_s2=lambda _t: amplitude_g * G)
        joint = standing(case, 1e-6, 1e-6).joints[0]
        assert (joint.sticking, joint.sliding) == (((0, 3), ()) if side > 0.0 else ((), (0, 3)))


@pytest.mark.parametrize("direction", [0.0, 0.7, 2.0])
@pytest.mark.parametrize(("static", "kinetic"), [(0.2, 0.2), (0.3, 0.2)])
def test_a_block_slides_as_newmark_says(direction: float, static: float, kinetic: float) -> None:
    """A rectangular pulse A for T: slip = (A − μg) T² A/(2 μg) against it."""
    push, period = 0.4 * G, 0.3
    cos, sin = math.cos(direction), math.sin(direction)
    case = Case(
        MASS,
        block_inertia(MASS, 0.6, 0.7, 0.3),
        base(0.6, 0.7, 0.3),
        static,
        kinetic,
        accel_x_m_s2=lambda t: push * cos if t < period else 0.0,
        accel_y_m_s2=lambda t: push * sin if t < period else 0.0,
        breaks_s=(period,),
    )
    run = standing(case, 1.0, 0.01)
    slip = push * (push - kinetic * G) * period**2 / (2.0 * kinetic * G)
    assert run.states[-1, :2] == pytest.approx([-slip * cos, -slip * sin], abs=budget.SLIDES_M)
    assert run.joints[-1].sticking == (0, 1, 2, 3)
    assert np.max(np.abs(run.states[:, 10:])) < budget.SLIDES_M
