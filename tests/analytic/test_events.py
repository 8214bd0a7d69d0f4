"""Each event happens where its own condition says, and the motion patterns change by the paper's (14) to (19)."""

import itertools
import math
from typing import Any

import numpy as np
import pytest

from analytic import (
    AnalyticInputError,
    Block,
    Event,
    EventKind,
    Form,
    Harmonic,
    Pedestal,
    Pulse,
    Record,
    Rest,
    Solution,
    Wall,
    simulate,
)
from tests.analytic.paestum import FREE, GRAVITY, PEDESTAL, STATUE, shaken
from tests.budgets_analytic import EVENT_REL, RESIDUAL_REL, STICK_ONSET_M_S

M1, M2 = PEDESTAL.mass_kg, STATUE.mass_kg
TOTAL = M1 + M2
H = STATUE.centroid_height_m
CASES = [(0.334, 3.0), (0.429, 3.0), (0.334, 4.5), (0.429, 6.0)]


def corner(pivot: int) -> tuple[float, float, float, float, float]:
    """s, b, R, α, J of the corner rocked about."""
    s = 1.0 if pivot == 1 else -1.0
    b = abs(STATUE.profile_m[pivot][0])
    r = math.hypot(b, H)
    return s, b, r, math.atan2(b, H), STATUE.inertia_kg_m2 + M2 * r * r


def forces(event: Event, a_x: float) -> tuple[float, float]:
    """F and N at an event while the pedestal is stuck (docs/model.md, section 2)."""
    if event.pivot is None:
        return TOTAL * a_x, TOTAL * GRAVITY
    s, _, r, alpha, j = corner(event.pivot)
    phi, rate = alpha - abs(event.theta_rad), event.theta_rate_before_rad_s
    accel = -M2 * r * (a_x * math.cos(phi) + s * GRAVITY * math.sin(phi)) / j
    f = TOTAL * a_x + M2 * r * (math.cos(phi) * accel + s * math.sin(phi) * rate**2)
    n = TOTAL * GRAVITY + M2 * (s * r * math.sin(phi) * accel - r * math.cos(phi) * rate**2)
    return f, n


def pairs(run: Solution) -> list[tuple[Event, Event]]:
    return list(itertools.pairwise(run.events))


@pytest.mark.parametrize(("amplitude_g", "frequency_hz"), CASES)
@pytest.mark.parametrize("normal", ["dynamic", "static"])
def test_slip_starts_where_friction_is_used_up(amplitude_g: float, frequency_hz: float, normal: str) -> None:
    run = shaken(amplitude_g, frequency_hz, form=Form(friction_normal=normal))
    motion = Harmonic(amplitude_g * GRAVITY, frequency_hz)
    slips = [(before, event) for before, event in pairs(run) if event.kind is EventKind.SLIP_ONSET]
    assert slips
    for before, event in slips:
        as_it_was = Event(**{**event.__dict__, "pivot": before.pivot})
        f, n = forces(as_it_was, float(motion.accel_m_s2(event.time_s)))
        held = n if normal == "dynamic" else TOTAL * GRAVITY
        assert abs(f) == pytest.approx(0.20 * held, rel=EVENT_REL)
        assert event.slide == -math.copysign(1.0, f), "the pedestal slides against the floor's force"


@pytest.mark.parametrize(("amplitude_g", "frequency_hz"), CASES)
def test_uplift_starts_where_the_overturning_moment_is_balanced(amplitude_g: float, frequency_hz: float) -> None:
    motion = Harmonic(amplitude_g * GRAVITY, frequency_hz)
    run = simulate(STATUE, motion, duration_s=4.0, gravity_m_s2=GRAVITY)
    lifts = [each for each in run.events if each.kind is EventKind.UPLIFT]
    assert lifts
    for event in lifts:
        assert event.pivot is not None
        s, b, *_ = corner(event.pivot)
        assert -s * float(motion.accel_m_s2(event.time_s)) * H == pytest.approx(GRAVITY * b, rel=EVENT_REL)


@pytest.mark.parametrize(("amplitude_g", "frequency_hz"), CASES)
def test_stick_onset_and_impact_are_exact(amplitude_g: float, frequency_hz: float) -> None:
    run = shaken(amplitude_g, frequency_hz)
    stick_onsets = [each for each in run.events if each.kind is EventKind.STICK_ONSET]
    assert stick_onsets
    for event in stick_onsets:
        assert abs(event.slip_rate_after_m_s) == STICK_ONSET_M_S
        assert abs(event.slip_rate_before_m_s) < EVENT_REL
    for event in run.impacts:
        assert event.theta_rad == 0.0
        assert event.theta_rate_before_rad_s * event.theta_rate_after_rad_s >= 0.0


def test_every_event_changes_the_joint_state() -> None:
    run = shaken(0.429, 4.5, duration_s=10.0)
    for before, after in pairs(run):
        if after.kind is EventKind.END:
            continue
        assert (before.pivot, before.slide) != (after.pivot, after.slide) or after.kind is EventKind.IMPACT
        assert after.time_s > before.time_s or before.kind is EventKind.START


@pytest.mark.parametrize(
    ("amplitude_g", "static", "first"),
    [
        (0.10, 0.20, "rocking"),  # (14): uplift at g b₁/h = 0.088 g before slip at 0.20 g: pattern (a)
        (0.06, 0.05, "sliding"),  # (15): slip at 0.05 g, uplift never: pattern (b)
        (0.06, 0.20, "rest"),  # neither limit is reached
    ],
)
def test_first_pattern_follows_the_conditions_14_and_15(amplitude_g: float, static: float, first: str) -> None:
    run = shaken(-amplitude_g, 1.0, floor_static=static, floor_kinetic=0.9 * static, duration_s=2.0)
    started = [strip.pattern for strip in run.patterns if strip.pattern != "rest"]
    assert (started[0] if started else "rest") == first


def test_pattern_a_ends_where_16_says_and_c_starts_where_18_and_19_say() -> None:
    run = shaken(-0.334, 3.0)
    names = [strip.pattern for strip in run.patterns]
    seen = set(itertools.pairwise(names))
    assert ("rest", "rocking") in seen, "(16): A h = g b starts the rocking"
    assert ("rocking", "both") in seen, "(19) ceases to hold: from (a) to (c)"
    for before, event in pairs(run):
        if event.kind is EventKind.SLIP_ONSET and before.pivot is not None and event.pivot is not None:
            just_before = Event(**{**event.__dict__, "theta_rate_before_rad_s": event.theta_rate_before_rad_s})
            f, n = forces(just_before, float(Harmonic(-0.334 * GRAVITY, 3.0).accel_m_s2(event.time_s)))
            assert abs(f) / (0.20 * n) == pytest.approx(1.0, rel=EVENT_REL)


def test_17_starts_both_at_once_under_a_jump() -> None:
    run = simulate(
        STATUE,
        Pulse("rectangular", -0.35 * GRAVITY, 0.3),
        pedestal=PEDESTAL,
        floor_static=0.20,
        floor_kinetic=0.15,
        duration_s=0.1,
        gravity_m_s2=GRAVITY,
    )
    assert run.events[0].pattern == "both"
    assert run.events[0].slide == 1, "the floor goes to the left, the pedestal slides to the right of it"


def test_ambiguous_jump_takes_the_stuck_state_and_says_so() -> None:
    run = simulate(
        STATUE,
        Pulse("rectangular", -0.3 * GRAVITY, 0.5),
        pedestal=PEDESTAL,
        floor_static=0.20,
        floor_kinetic=0.15,
        duration_s=3.0,
        gravity_m_s2=GRAVITY,
    )
    assert run.counts.ties > 0
    assert run.events[0].feasible_states == 2
    assert run.events[0].pattern == "rocking"


def test_wall_ends_the_run_where_the_top_touches_it() -> None:
    top = ((0.0682, 1.46),)
    run = simulate(STATUE, Harmonic(0.429 * GRAVITY, 1.5), duration_s=10.0, wall=Wall("right", 0.4, top))
    assert run.outcome.value == "touches_wall"
    assert run.theta_rad[-1] == pytest.approx(math.asin(0.4 / 1.46), rel=EVENT_REL)
    away = simulate(STATUE, Harmonic(0.429 * GRAVITY, 1.5), duration_s=10.0, wall=Wall("left", 0.4, top))
    assert away.outcome.value == "overturned_right"


@pytest.mark.parametrize("skips", [True, False])
def test_a_pedestal_that_slides_to_a_wall_touches_it_when_newton_says(skips: bool) -> None:
    # One block under a constant push: u̇ = −(a − μ g) t; the pedestal's side starts 0.1 m before the wall.
    a, mu, edge = 3.0, 0.1, 0.2133 - 0.3
    wall = Wall("left", 0.1 - edge, ((-0.2133, 1.0), (0.2133, 1.0)))
    keywords: Any = {"floor_static": mu, "floor_kinetic": mu, "gravity_m_s2": GRAVITY, "skip_start": skips}
    block = Block.two_corners(
        mass_kg=100.0, centroid_height_m=0.1, inertia_kg_m2=5.0, corner_left_m=0.2133, corner_right_m=0.2133
    )
    run = simulate(
        block, Pulse("rectangular", a, 2.0), duration_s=2.0, wall=wall, pedestal=Pedestal(50.0, 0.6, 0.2), **keywords
    )
    assert run.outcome.value == "touches_wall"
    assert run.end_s == pytest.approx(math.sqrt(2.0 * 0.1 / (a - mu * GRAVITY)), rel=EVENT_REL)
    assert run.final_slip_m == pytest.approx(-0.1, rel=EVENT_REL)


@pytest.mark.parametrize(("side", "omega"), [("right", 0.9), ("left", -2.8), ("left", 1.1)])
def test_the_energy_meets_the_wall_as_the_integration_does(side: Any, omega: float) -> None:
    wall = Wall(side, 0.5, ((-0.3585, 1.46), (0.0682, 1.46)))
    given: Any = {"duration_s": 8.0, "wall": wall, "theta_rate0_rad_s": omega, "dt_s": None, "gravity_m_s2": GRAVITY}
    by_energy, integrated = (simulate(STATUE, Rest(), **given, skip_energy=skips) for skips in (True, False))
    assert by_energy.outcome is integrated.outcome
    assert by_energy.peak_signed_rad == pytest.approx(integrated.peak_signed_rad, rel=EVENT_REL)


@pytest.mark.parametrize(
    ("changes", "said"), [({"wall": Wall("right", 0.08, ((0.0682, 1.46),))}, "inside"), ({"theta0_rad": 0.3}, "beyond")]
)
def test_a_start_at_the_wall_is_refused(changes: Any, said: str) -> None:
    given: Any = {"wall": Wall("right", 0.4, ((0.0682, 1.46),)), "pedestal": PEDESTAL, "duration_s": 1.0}
    with pytest.raises(AnalyticInputError, match=said):
        simulate(STATUE, Rest(), **(given | changes))


def test_a_point_that_cannot_touch_and_a_base_of_many_vertices_roll_to_the_wall() -> None:
    # A disk of 64 sides rolls without slipping: its centre goes R θ, so that its side is at the wall after distance/R.
    turns = np.linspace(0.0, 2.0 * math.pi, 65)[:-1] + math.pi / 64.0
    rim = np.stack([np.sin(turns), 1.0 - np.cos(turns)], axis=1)
    low = rim[(rim[:, 1] < 0.9)]
    base = low[np.argsort(low[:, 0])] - [0.0, low[:, 1].min()]
    block = Block.from_profile(mass_kg=10.0, centroid_height_m=1.0, inertia_kg_m2=5.0, profile_m=base)
    wall = Wall("right", 0.3, tuple(map(tuple, rim)))
    run = simulate(block, Rest(), duration_s=4.0, theta_rate0_rad_s=3.0, wall=wall, overturn_rad=1.4)
    assert run.outcome.value == "touches_wall"
    assert run.theta_rad[-1] == pytest.approx(
        base[-1, 0] + 0.3 - 1.0, abs=2.0 * (1.0 - math.cos(math.pi / 64.0))
    )  # its corners


def test_loss_of_gravity_is_lift_off() -> None:
    run = simulate(FREE, Rest(), Harmonic(12.0, 1.0), duration_s=2.0, gravity_m_s2=GRAVITY)
    assert run.outcome.value == "lift_off"
    falls = math.asin(GRAVITY / 12.0) / (2.0 * math.pi) + 0.5
    assert run.end_s == pytest.approx(falls, rel=EVENT_REL)


def test_high_friction_under_a_slender_statue_is_the_paradox() -> None:
    """D = J − m²/M Z(Z − κX) reaches zero only for μ_k > 2√(K(K − 1)), K = J M/(m²R²) (docs/model.md, section 2)."""
    alpha, pedestal = 0.9576, Pedestal(10.0, 3.0, 0.1)
    block = Block.rectangle(width_m=2.0 * math.sin(alpha), height_m=2.0 * math.cos(alpha), mass_kg=100.0)
    k = 4.0 / 3.0 * 1.1
    bound = 2.0 * math.sqrt(k * (k - 1.0))
    outcomes = []
    for kinetic in (0.9 * bound, 2.0 * bound):
        runs = [
            simulate(
                block,
                Harmonic(30.0, frequency, phase),
                pedestal=pedestal,
                floor_static=1.1 * kinetic,
                floor_kinetic=kinetic,
                duration_s=3.0,
                dt_s=None,
                theta0_rad=0.3,
            ).outcome.value
            for frequency in (1.0, 2.0, 4.0)
            for phase in (0.0, 1.5, 3.0, 4.5)
        ]
        outcomes.append(runs.count("friction_paradox"))
    assert outcomes[0] == 0
    assert outcomes[1] > 0


def test_a_break_of_the_motion_is_a_step_end() -> None:
    times = np.arange(0.0, 2.0, 0.01)
    record = Record(times, 2.5 * np.sin(12.0 * times) * np.sign(np.sin(7.0 * times)))
    fine = simulate(STATUE, record, duration_s=2.0, accuracy_rad=1e-14)
    coarse = simulate(STATUE, record, duration_s=2.0, accuracy_rad=1e-8)
    assert fine.counts.steps >= np.count_nonzero(times > fine.events[1].time_s) - 1
    assert np.abs(fine.theta_rad - coarse.theta_rad).max() < 1e-8


WORN = Block.from_profile(
    mass_kg=700.0,
    centroid_height_m=0.8,
    inertia_kg_m2=150.0,
    profile_m=((-0.25, 0.012), (-0.1, 0.0), (0.12, 0.0), (0.22, 0.015)),
)


@pytest.mark.parametrize("block", [STATUE, WORN], ids=["two corners", "worn base"])
def test_every_event_leaves_nothing_of_its_function_but_rounding(block: Block) -> None:
    scene = {"pedestal": PEDESTAL, "floor_static": 0.20, "floor_kinetic": 0.15, "gravity_m_s2": GRAVITY}
    run = simulate(block, Harmonic(0.429 * GRAVITY, 3.0), duration_s=4.0, **scene)  # type: ignore[arg-type]
    left = {event.kind: event.residual for event in run.events}
    assert {EventKind.IMPACT, EventKind.STICK_ONSET, EventKind.SLIP_ONSET} <= set(left)
    assert 0.0 < run.results.event_residual == max(event.residual for event in run.events) <= RESIDUAL_REL
