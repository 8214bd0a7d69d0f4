"""The spatial reference against known answers: a block under two sines, its edge by Lagrange, tops, thresholds, sliding."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipj

from tests import budgets_spatial_reference as budgets
from tests.analytic.spatial.bodies import (
    DEPTH,
    HEIGHT,
    INERTIA,
    MASS,
    WIDTH,
    G,
    base,
    block_inertia,
    known_block,
    standing,
)
from tests.analytic.spatial.reference import initial_state, simulate
from tests.analytic.spatial.reference_body import Array, Case, Kinematics, rotation
from tests.analytic.spatial.reference_contact import Joint, base_margin, least_edge_friction
from tests.analytic.spatial.reference_events import force_in


def test_the_known_block_lifts_onto_its_edge_and_walks_over_its_vertices() -> None:
    run = standing(known_block(math.inf), 1.2)
    assert run.events[0].time_s == pytest.approx(1.0 / 24.0, abs=budgets.INTEGRATED)
    assert [phase.joint.sticking for phase in run.phases[1:5]] == [(0, 3), (0,), (3,), (2,)]
    assert run.events[1].time_s == pytest.approx(0.0829, abs=budgets.PRINTED_TIME_S)
    landed = [(event.time_s, event.vertices) for event in run.impacts()]
    assert [vertices for _, vertices in landed] == [(0, 3), (2, 3), (1, 2)]
    assert [time for time, _ in landed] == pytest.approx([0.3840, 0.4219, 1.0575], abs=budgets.PRINTED_TIME_S)


@pytest.mark.parametrize(
    ("time_s", "friction", "slope"),
    [(0.061, 0.389, 20.0), (0.0709, 0.605, 40.0), (0.0769, 1.10, 200.0), (0.0789, 1.59, 400.0), (0.0809, 3.06, 1500.0)],
)
def test_the_friction_that_the_edge_needs(time_s: float, friction: float, slope: float) -> None:
    """The slope is that of the need at the instant: the printed time is good to half of its last digit."""
    case = known_block(math.inf)
    start = initial_state(np.array([0.0, 0.0, HEIGHT / 2]))
    y = simulate(case, start, np.array([0.0, time_s])).states[-1]
    forces = force_in(case, time_s, y, Joint((0, 3))).forces
    needed = least_edge_friction(Kinematics.of(case, y).points[[0, 3]], [forces[0], forces[3]])
    assert needed == pytest.approx(friction, abs=slope * budgets.PRINTED_TIME_S + budgets.PRINTED_FRICTION)


@pytest.mark.parametrize("friction", [0.5, 1.0, 5.0])
def test_the_edge_is_left_when_its_need_passes_the_coefficient(friction: float) -> None:
    run = standing(known_block(friction), 0.09)
    event = run.events[1]
    assert event.kind == "slips"
    y = run.phases[2].state
    forces = force_in(known_block(friction), event.time_s, y, Joint((0, 3))).forces
    points = Kinematics.of(known_block(friction), y).points[[0, 3]]
    assert least_edge_friction(points, [forces[0], forces[3]]) == pytest.approx(friction, abs=budgets.SLIDING)


def test_the_edge_by_lagrange_in_one_angle() -> None:
    """J θ̈ = −m R [a_x cos φ + s g sin φ] about the edge x = −b: motion along the edge does nothing."""
    case, up, end = known_block(math.inf), 1.0 / 24.0, 0.082
    radius, alpha = math.hypot(WIDTH / 2, HEIGHT / 2), math.atan2(WIDTH, HEIGHT)
    inertia = INERTIA[1, 1] + MASS * radius**2

    def rate(t: float, y: Array) -> list[float]:
        phi = alpha + y[0]
        torque = -MASS * radius * (case.accel_x_m_s2(t) * math.cos(phi) - G * math.sin(phi))
        return [y[1], torque / inertia]

    times = np.linspace(up, end, 40)
    lagrange = solve_ivp(rate, (up, end), [0.0, 0.0], method="DOP853", t_eval=times, rtol=1e-12, atol=1e-14).y
    run = simulate(case, initial_state(np.array([0.0, 0.0, HEIGHT / 2])), np.array([0.0, *times]))
    theta = 2.0 * np.arctan2(run.states[1:, 8], run.states[1:, 6])
    assert np.ptp(theta) > 1e6 * budgets.INTEGRATED
    assert np.max(np.abs(theta - lagrange[0])) < budgets.INTEGRATED
    assert np.max(np.abs(run.states[1:, 11] - lagrange[1])) < budgets.INTEGRATED


def test_torque_free_flight_of_a_symmetric_top() -> None:
    """R(t) = exp(t L/A) R(0) exp(t ω₃ (1 − C/A) e₃), while the centroid falls freely."""
    across, along = 2.0, 0.7
    omega = np.array([1.0, -2.0, 5.0])
    case = Case(10.0, np.diag([across, across, along]), base(0.1, 0.1, 0.1), 1.0, 1.0)
    times = np.linspace(0.0, 2.0, 21)
    start = initial_state(np.array([0.0, 0.0, 100.0]), None, np.array([1.0, 2.0, 3.0]), omega)
    run = simulate(case, start, times)
    momentum = np.diag([across, across, along]) @ omega
    for t, y in zip(times, run.states, strict=True):
        wanted = _turn(momentum / across * t) @ _turn(np.array([0.0, 0.0, omega[2] * (1.0 - along / across) * t]))
        assert np.max(np.abs(rotation(y[6:10]) - wanted)) < budgets.INTEGRATED
        assert y[:3] == pytest.approx([t, 2.0 * t, 100.0 + 3.0 * t - 0.5 * G * t**2], abs=budgets.INTEGRATED)


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
    assert np.max(np.abs(run.states[:, 10:] - wanted)) < budgets.INTEGRATED


def test_a_heavy_top_precesses_steadily() -> None:
    """m g l = Ω (C ω₃ − A′ Ω cos θ): the tilt stays, the axis turns at Ω."""
    mass, arm, across, along = 2.0, 0.3, 0.05, 0.02
    tilt, precession = 0.4, 3.0
    about = across + mass * arm**2
    spin = (mass * G * arm / precession + about * precession * math.cos(tilt)) / along
    turn = _turn(np.array([0.0, tilt, 0.0]))
    omega = turn.T @ np.array([0.0, 0.0, precession])
    omega[2] = spin
    case = Case(mass, np.diag([across, across, along]), np.array([[0.0, 0.0, -arm]]), 10.0, 10.0)
    centroid = turn @ np.array([0.0, 0.0, arm])
    velocity = np.cross([0.0, 0.0, precession], centroid)
    q = np.array([math.cos(tilt / 2), 0.0, math.sin(tilt / 2), 0.0])
    times = np.linspace(0.0, 1.0, 11)
    run = simulate(case, initial_state(centroid, q, velocity, omega), times)
    assert [phase.joint.sticking for phase in run.phases] == [(0,)]
    for t, y in zip(times, run.states, strict=True):
        axis = rotation(y[6:10])[:, 2]
        angle = precession * t
        wanted = [math.sin(tilt) * math.cos(angle), math.sin(tilt) * math.sin(angle), math.cos(tilt)]
        assert axis == pytest.approx(wanted, abs=budgets.INTEGRATED)


@pytest.mark.parametrize(("amplitude_g", "critical"), [(0.5, 0.3735), (1.0, 0.4783), (2.0, 0.6364)])
def test_uplift_without_slip_needs_a_coefficient(amplitude_g: float, critical: float) -> None:
    """μ = (A (q² + 4) + 3 q)/(4 q² + 1 + 3 q A) for a step of A g on a rectangle, q = h/b = 3."""
    q = 3.0
    formula = (amplitude_g * (q * q + 4) + 3 * q) / (4 * q * q + 1 + 3 * q * amplitude_g)
    assert formula == pytest.approx(critical, abs=budgets.PRINTED_TIME_S)
    block = (100.0, block_inertia(100.0, 0.2, 0.2, 0.6), base(0.2, 0.2, 0.6))
    for side in (-1.0, 1.0):
        friction = formula + side * budgets.THRESHOLD
        case = Case(*block, friction, friction, accel_x_m_s2=lambda _t: amplitude_g * G)
        joint = standing(case, 1e-6, 1e-6).phases[0].joint
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
    assert run.states[-1, :2] == pytest.approx([-slip * cos, -slip * sin], abs=budgets.SLIDING)
    assert run.phases[-1].joint.sticking == (0, 1, 2, 3)
    assert np.max(np.abs(run.states[:, 10:])) < budgets.SLIDING


@pytest.mark.parametrize("shares", [(0.0, 0.0), (0.2, 0.1), (0.12, -0.2)])
def test_the_cone_program_knows_what_rest_needs(shares: tuple[float, float]) -> None:
    """A body at rest needs |T|/N of its gravity, no more: friction in proportion to N balances it."""
    case = Case(MASS, INERTIA, base(WIDTH, DEPTH, HEIGHT), 1.0, 1.0)
    now = Kinematics.of(case, initial_state(np.array([0.0, 0.0, HEIGHT / 2])))
    total = MASS * G * np.array([*shares, 1.0, 0.0, 0.0, 0.0])
    needed = math.hypot(*shares)
    assert base_margin(needed + budgets.THRESHOLD, now.jacobians, total) > 0.0
    if needed:
        assert base_margin(needed - budgets.THRESHOLD, now.jacobians, total) < 0.0
    level = MASS * G / 4.0
    assert base_margin(1.0, now.jacobians, MASS * G * np.eye(6)[2]) == pytest.approx(level, rel=budgets.CONE_PROGRAM)


def _turn(vector: Array) -> Array:
    """The rotation matrix of a rotation vector."""
    angle = float(np.linalg.norm(vector))
    if angle == 0.0:
        return np.eye(3)
    return rotation(np.array([math.cos(angle / 2), *(math.sin(angle / 2) * vector / angle)]))
