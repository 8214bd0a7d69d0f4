"""The known answers: flight, the planar limit, the block of the specification, modes from rest, flat landing."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

import analytic
from analytic import spatial
from analytic.block import GRAVITY_M_S2 as GRAVITY
from analytic.spatial.problem import Mode
from tests import budgets_spatial as budget

Q = 3.0
"""Height over width of the block of the mode maps."""


def slender(q: float = Q) -> spatial.Body:
    return spatial.Body.block(100.0, 0.4, 0.6, 0.4 * q)


def free(body: spatial.Body, spin: tuple[float, float, float], duration_s: float = 2.0) -> spatial.Solution:
    """Flight of a body thrown up."""
    return spatial.simulate(
        body,
        duration_s=duration_s,
        friction_static=0.5,
        position_m=(0.0, 0.0, 3.0),
        velocity_m_s=(0.3, -0.2, GRAVITY * duration_s / 2.0),
        angular_velocity_rad_s=spin,
        overturn_rad=3.2,
        dt_out_s=0.01,
    )


def test_flight_is_a_parabola_with_constant_momentum_and_energy() -> None:
    body = spatial.Body.block(20.0, 0.2, 0.3, 0.7)
    run = free(body, (2.0, -1.0, 3.0))
    assert [interval.mode for interval in run.intervals] == [Mode.FLIGHT]
    t = run.t_s
    place = np.column_stack([0.3 * t, -0.2 * t, 3.0 + GRAVITY * t - 0.5 * GRAVITY * t * t])
    np.testing.assert_allclose(run.position_m, place, atol=budget.CLOSED_FORM)
    spin = run.angular_velocity_rad_s @ body.inertia_kg_m2
    momentum = np.einsum("tij,tj->ti", run.rotation, spin)
    np.testing.assert_allclose(momentum, momentum[[0]].repeat(len(t), 0), atol=budget.CLOSED_FORM)
    energy = np.einsum("ti,ti->t", spin, run.angular_velocity_rad_s)
    np.testing.assert_allclose(energy, energy[0], rtol=budget.CLOSED_FORM)


def test_flight_follows_jacobis_functions() -> None:
    """Euler's equations for I1 < I2 < I3 in closed form (Landau and Lifshitz, Mechanics, section 37), axes sorted as z, y, x."""
    from scipy.special import ellipj

    body = spatial.Body.block(20.0, 0.2, 0.3, 0.7)
    i1, i2, i3 = body.inertia_kg_m2[2, 2], body.inertia_kg_m2[1, 1], body.inertia_kg_m2[0, 0]
    w1, w3 = 0.5, 2.0
    run = free(body, (w3, 0.0, w1))
    energy, momentum = i1 * w1**2 + i3 * w3**2, (i1 * w1) ** 2 + (i3 * w3) ** 2
    assert momentum > energy * i2
    rate = math.sqrt((i3 - i2) * (momentum - energy * i1) / (i1 * i2 * i3))
    share = (i2 - i1) * (energy * i3 - momentum) / ((i3 - i2) * (momentum - energy * i1))
    sn, cn, dn, _ = ellipj(run.t_s * rate, share)
    size2 = math.sqrt((energy * i3 - momentum) / (i2 * (i3 - i2)))
    np.testing.assert_allclose(run.angular_velocity_rad_s[:, 2], w1 * cn, atol=budget.CLOSED_FORM)
    np.testing.assert_allclose(np.abs(run.angular_velocity_rad_s[:, 1]), np.abs(size2 * sn), atol=budget.CLOSED_FORM)
    np.testing.assert_allclose(run.angular_velocity_rad_s[:, 0], w3 * dn, atol=budget.CLOSED_FORM)


def test_a_symmetric_top_precesses_steadily() -> None:
    """ω turns about the body's axis at (I3 − I1) ω3/I1, the axis about L at |L|/I1."""
    base = spatial.Body.block(20.0, 0.3, 0.3, 0.7)
    across, along = base.inertia_kg_m2[0, 0], base.inertia_kg_m2[2, 2]
    run = free(base, (0.7, 0.0, 4.0))
    turn = (along - across) / across * 4.0 * run.t_s
    wanted = np.column_stack([0.7 * np.cos(turn), 0.7 * np.sin(turn), np.full_like(turn, 4.0)])
    np.testing.assert_allclose(run.angular_velocity_rad_s, wanted, atol=budget.CLOSED_FORM)
    momentum = np.array([across * 0.7, 0.0, along * 4.0])
    size = np.linalg.norm(momentum)
    axis, direction, angle = run.rotation[:, :, 2], momentum / size, size / across * run.t_s
    start = axis[0] - direction * (axis[0] @ direction)
    turned = np.outer(np.cos(angle), start) + np.outer(np.sin(angle), np.cross(direction, start))
    np.testing.assert_allclose(axis, turned + direction * (axis[0] @ direction), atol=budget.CLOSED_FORM)


SPECIFIED = spatial.Body(
    500.0, np.diag([77.9167, 75.0, 10.4167]), spatial.Body.block(500.0, 0.30, 0.40, 1.20).vertices_m
)
BLOCK_X = analytic.Pulse("one_sine", 0.5 * GRAVITY, 0.5)
BLOCK_Y = analytic.Pulse("one_sine", 0.45 * GRAVITY, 0.6)


def test_the_specified_block_comes_down_on_vertex_after_vertex() -> None:
    run = spatial.simulate(SPECIFIED, BLOCK_X, BLOCK_Y, duration_s=1.1, friction_static=math.inf)
    assert run.events[1].time_s == pytest.approx(1.0 / 24.0, abs=budget.IMPULSE)
    lifted = run.intervals[2]
    assert lifted.mode is Mode.VERTEX_STICK
    assert lifted.vertices.index(spatial.VertexState.STICKING) == 0
    assert lifted.start_s == pytest.approx(0.0829, abs=budget.TIME_S)
    landings = [(event.time_s, event.vertex) for event in run.impacts]
    for (time_s, vertex), (printed_s, printed) in zip(landings, ((0.3840, 3), (0.4219, 2), (1.0575, 1)), strict=True):
        assert vertex == printed
        assert time_s == pytest.approx(printed_s, abs=budget.TIME_S)


@pytest.mark.parametrize(
    ("time_s", "printed"), [(0.061, 0.389), (0.0709, 0.605), (0.0769, 1.10), (0.0789, 1.59), (0.0809, 3.06)]
)
def test_the_least_friction_on_its_edge(time_s: float, printed: float) -> None:
    run = spatial.simulate(SPECIFIED, BLOCK_X, BLOCK_Y, duration_s=time_s, friction_static=math.inf)
    assert run.least_friction == pytest.approx(printed, rel=budget.FRICTION_REL)
    slipped = spatial.simulate(SPECIFIED, BLOCK_X, BLOCK_Y, duration_s=time_s, friction_static=0.99 * printed)
    assert any(event.kind is spatial.EventKind.SLIP_ONSET for event in slipped.events)


def test_the_friction_that_a_body_at_rest_needs_is_that_of_the_motion_s_peak() -> None:
    shaken = analytic.Harmonic(0.1 * GRAVITY, 1.0)
    run = spatial.simulate(SPECIFIED, shaken, duration_s=2.0, friction_static=0.5)
    assert run.least_friction == pytest.approx(0.1, rel=budget.FRICTION_REL)


def test_the_friction_that_one_vertex_needs_is_that_of_the_force_on_it() -> None:
    """Turning about one vertex the body's own acceleration gives the force, by differences of its velocity."""
    turn = (math.cos(0.05), 0.6 * math.sin(0.05), 0.8 * math.sin(0.05), 0.0)
    run = spatial.simulate(SPECIFIED, duration_s=0.2, friction_static=math.inf, quaternion_wxyz=turn)
    assert run.intervals[-1].mode is Mode.VERTEX_STICK
    force = np.gradient(run.velocity_m_s, run.t_s, axis=0)[1:-1] + np.array([0.0, 0.0, GRAVITY])
    needed = (np.hypot(force[:, 0], force[:, 1]) / force[:, 2]).max()
    assert run.least_friction == pytest.approx(needed, rel=budget.FRICTION_REL)


def test_what_slides_needs_all_the_friction_that_there_is() -> None:
    jump = analytic.Pulse("rectangular", GRAVITY, 0.1)
    run = spatial.simulate(slender(1.0), jump, duration_s=0.1, friction_static=0.3, friction_kinetic=0.2)
    assert run.intervals[0].mode is Mode.FLAT_SLIDE
    assert run.least_friction == pytest.approx(0.3, rel=budget.CLOSED_FORM)


@pytest.mark.parametrize(
    ("amplitude_g", "printed"), [(1.0 / 3.0 + 1e-9, 0.3333), (0.5, 0.3735), (1.0, 0.4783), (2.0, 0.6364)]
)
def test_from_rest_the_mode_follows_friction(amplitude_g: float, printed: float) -> None:
    """Uplift without slip above μ = (A (q² + 4) + 3 q)/(4 q² + 1 + 3 q A); uplift with slip or slip alone below."""
    a, q = amplitude_g, Q
    critical = (a * (q * q + 4.0) + 3.0 * q) / (4.0 * q * q + 1.0 + 3.0 * q * a)
    assert critical == pytest.approx(printed, abs=1e-4)
    jump = analytic.Pulse("rectangular", a * GRAVITY, 0.1)
    modes = []
    for share in (1.0 - budget.THRESHOLD, 1.0 + budget.THRESHOLD):
        run = spatial.simulate(slender(), jump, duration_s=1e-4, friction_static=share * critical, dt_out_s=None)
        modes.append(run.intervals[-1].mode)
    assert modes[1] is Mode.EDGE_STICK
    assert modes[0] in (Mode.EDGE_SLIDE, Mode.FLAT_SLIDE)


@pytest.mark.parametrize(
    ("amplitude_g", "friction", "mode"),
    [(0.2, 0.4, Mode.REST), (0.35, 0.3, Mode.FLAT_SLIDE), (0.5, 0.45, Mode.EDGE_STICK), (1.0, 0.4, Mode.EDGE_SLIDE)],
)
def test_the_four_modes_from_rest(amplitude_g: float, friction: float, mode: Mode) -> None:
    jump = analytic.Pulse("rectangular", amplitude_g * GRAVITY, 0.1)
    run = spatial.simulate(slender(), jump, duration_s=1e-4, friction_static=friction)
    assert run.intervals[-1].mode is mode


@pytest.mark.parametrize(("friction", "printed"), [(0.4, 1.6207), (0.5, 0.8947), (0.7, 0.3964)])
def test_a_block_that_lands_flat(friction: float, printed: float) -> None:
    """It rocks about an edge that sticks above |v_z/v_x| = (4 + q² − 3 μ q)/(μ (1 + 4 q²) − 3 q), about one that slides below."""
    q = Q
    limit = (4.0 + q * q - 3.0 * friction * q) / (friction * (1.0 + 4.0 * q * q) - 3.0 * q)
    assert limit == pytest.approx(printed, abs=1e-4)
    modes = []
    for share in (1.0 - budget.THRESHOLD, 1.0 + budget.THRESHOLD):
        run = spatial.simulate(
            slender(),
            duration_s=1e-6,
            friction_static=friction,
            velocity_m_s=(1.0, 0.0, -share * limit),
            dt_out_s=None,
        )
        modes.append(run.intervals[-1].mode)
    assert modes == [Mode.EDGE_SLIDE, Mode.EDGE_STICK]


@pytest.mark.parametrize("vx_m_s", [0.19, 0.3])
def test_a_square_that_rocks_onto_its_base_may_slide_the_other_way(vx_m_s: float) -> None:
    """It turns about an edge that slides by v_x − ω h, to either side: the base comes to lie flat, and slides on by what its
    friction leaves of the centroid's velocity.
    """
    half, rate, friction = 0.03, 6.6, 0.25
    square = spatial.Body.block(0.1, 2.0 * half, 2.0 * half, 2.0 * half)
    run = spatial.simulate(
        square,
        duration_s=1e-6,
        friction_static=friction,
        velocity_m_s=(vx_m_s, 0.0, -rate * half),
        angular_velocity_rad_s=(0.0, rate, 0.0),
        dt_out_s=None,
    )
    assert run.intervals[0].mode is Mode.FLAT_SLIDE
    (impact,) = run.impacts
    assert impact.impulses_n_s.sum(axis=0) == pytest.approx([-friction * 0.1 * rate * half, 0.0, 0.1 * rate * half])


@pytest.mark.parametrize(
    ("size_m", "friction", "velocity_m_s", "spin_rad_s"),
    [
        ((0.2322, 0.1024, 0.1786), 0.193, (-0.1153, -0.0067, -0.4164), (4.9126, -1.4203, 0.0)),
        ((0.2473, 0.1299, 0.1628), 0.218, (-0.006, 0.1068, -0.3009), (-1.3008, 1.75, 0.0)),
    ],
)
def test_every_landing_has_an_answer(
    size_m: tuple[float, float, float],
    friction: float,
    velocity_m_s: tuple[float, float, float],
    spin_rad_s: tuple[float, float, float],
) -> None:
    """Impulses with Coulomb friction always have a solution: here the base lies flat and turns as no start without yaw says."""
    body = spatial.Body.block(1.0, *size_m)
    run = spatial.simulate(
        body,
        duration_s=1e-6,
        friction_static=friction,
        velocity_m_s=velocity_m_s,
        angular_velocity_rad_s=spin_rad_s,
        dt_out_s=None,
    )
    assert run.intervals[0].mode is Mode.FLAT_SLIDE
    assert run.momentum_residual < budget.AUDIT


def test_a_sliding_block_follows_newmark() -> None:
    """A push a for t1 on a block with friction μ: it slides 0.5 (a − μ g) a t1²/(μ g) and stops at a t1/(μ g)."""
    a, friction, t1 = 3.0, 0.2, 0.3
    flat = spatial.Body.block(100.0, 1.0, 0.8, 0.3)
    run = spatial.simulate(
        flat, analytic.Pulse("rectangular", -a, t1), duration_s=1.0, friction_static=friction, dt_out_s=0.01
    )
    grip = friction * GRAVITY
    assert run.position_m[-1, 0] == pytest.approx(0.5 * (a - grip) * a * t1**2 / grip, abs=budget.SLIDE_M)
    stopped = [event for event in run.events if event.kind is spatial.EventKind.STICK_ONSET]
    assert [event.time_s for event in stopped] == pytest.approx([a * t1 / grip], abs=1e-9)
    assert run.energy_lost_by_sliding_j == pytest.approx(100.0 * grip * run.position_m[-1, 0], rel=budget.AUDIT)


@pytest.mark.parametrize("end_s", [0.30374, 0.3038, 0.304, 0.3042, 0.3045, 0.31])
def test_a_block_that_slides_straight_back_turns_where_it_stops(end_s: float) -> None:
    """Under A sin ωt, A = 2 μ g, it slides from sin ωt = 1/2 until its velocity is none, and back at once, as A |sin ωt| > μ g
    there. Friction that turned round within the step that reaches it hid the turn, wherever that step happened to end.
    """
    friction, omega = 0.25, 4.0 * math.pi
    grip = friction * GRAVITY

    def floor_m_s(time_s: float) -> float:
        return 2.0 * grip * (1.0 - math.cos(omega * time_s)) / omega

    def slides_m_s(time_s: float, from_s: float, sign: float) -> float:
        return sign * grip * (time_s - from_s) - floor_m_s(time_s) + floor_m_s(from_s)

    begins_s = math.asin(0.5) / omega
    turns_s = float(brentq(lambda time_s: slides_m_s(time_s, begins_s, 1.0), 0.28, 0.32, xtol=1e-15))
    flat = spatial.Body.block(100.0, 1.0, 0.8, 0.3)
    shaking = analytic.Harmonic(2.0 * grip, 0.5 * omega / math.pi)
    run = spatial.simulate(flat, shaking, duration_s=end_s, friction_static=friction, dt_out_s=end_s)
    assert run.velocity_m_s[-1, 0] == pytest.approx(slides_m_s(end_s, turns_s, -1.0), abs=budget.SLIDE_M)


@pytest.mark.parametrize("friction", [0.8, 1.0, 5.0])
def test_at_the_limit_of_friction_an_edge_is_left_by_a_lift(friction: float) -> None:
    """Sliding is possible at that very instant, not after it: no mode of some microseconds may stand between."""
    block = spatial.Body.block(500.0, 0.30, 0.40, 1.20)
    run = spatial.simulate(block, BLOCK_X, BLOCK_Y, duration_s=0.1, friction_static=friction, dt_out_s=None)
    assert [interval.mode for interval in run.intervals] == [Mode.REST, Mode.EDGE_STICK, Mode.VERTEX_STICK]
