"""From arrays to a record: events, outcome, forces and energy of motions whose laws are known."""

import math
from dataclasses import replace

import numpy as np
import pytest

from analytic.excitation import Harmonic, Pulse
from harness import Run, RunOptions, load_scene
from harness.engines import load
from harness.engines.base import LayerFault
from harness.engines.stepping import reduce
from harness.engines.stepping.reduce import Report, last_outward, reduce_trajectory, rocking
from harness.engines.stepping.trajectory import Trajectory, apparent_gravity, statue_columns
from harness.model import OVERTURN_RAD, Array, BaseExcitation, Outcome, Wall
from tests import budgets_engines as budget
from tests.measures.seeded_scenes import wide_scene
from tests.scenes_for_tests import PAESTUM, SCENES, paestum, rectangle, scene

TIMES: Array = np.arange(2001) * 1e-3
REPORT = Report(engine="test", settings={}, steps=0, wall_s=0.0, resolution_rad=1e-5, stuck_below_m_s=1e-5)


def standing(theta: Array, rate: Array, t_s: Array = TIMES, gravity: float = 9.81) -> Trajectory:
    """The surveyed statue turning about its standing corner on the floor."""
    side = np.where(theta >= 0.0, 1.0, -1.0)
    corner = np.where(side > 0.0, PAESTUM.corner_right_m, PAESTUM.corner_left_m) * side
    h = PAESTUM.centroid_height_m
    cos, sin = np.cos(theta), np.sin(theta)
    place = np.column_stack([corner - corner * cos + h * sin, h * cos + corner * sin])
    speed = np.column_stack([rate * (corner * sin + h * cos), rate * (corner * cos - h * sin)])
    zero = np.zeros_like(theta)
    pull = np.tile([0.0, -gravity], (t_s.size - 1, 1))
    return Trajectory(t_s, theta, rate, zero, zero, pull, place, speed)


def reduced(theta: Array, rate: Array, **changes: object) -> Run:
    on = replace(paestum(0.0, pedestal=False, duration_s=2.0), **changes)
    return reduce_trajectory(on, standing(theta, rate), REPORT)


def test_impacts_of_a_sine_are_its_zeros() -> None:
    omega = 2.0 * math.pi * 1.3
    shaken = BaseExcitation(x=Harmonic(1.0, 2.0))  # over still ground its energy would decide
    run = reduced(
        0.05 * np.sin(omega * TIMES + 0.2), 0.05 * omega * np.cos(omega * TIMES + 0.2), base_excitation=shaken
    )
    zeros = [(k * math.pi - 0.2) / omega for k in range(1, 6)]
    np.testing.assert_allclose(run.impact_times_s, zeros, atol=budget.EVENT_TIME_S, rtol=0.0)
    assert run.uplift_times_s == ()
    assert run.outcome is Outcome.STANDS
    np.testing.assert_allclose(run.validity["impact_ratios"], 1.0, atol=0.05)


@pytest.mark.parametrize("band_rad", [1e-5, 4e-4, 1.2e-3])
def test_an_impact_is_where_the_rotation_is_back_however_wide_the_band(band_rad: float) -> None:
    """Down at 0.2 rad/s, through zero at 0.7003 s, up on the other side at nine tenths of that."""
    since = TIMES - 0.7003
    theta = np.where(since < 0.0, -0.2, -0.18) * since
    rate = np.where(since < 0.0, -0.2, -0.18)
    found = rocking(TIMES, theta, rate, band_rad)
    assert found.impact_times_s == pytest.approx([0.7003], abs=budget.EVENT_TIME_S)
    assert found.impact_ratios == pytest.approx([0.9])


def test_what_remains_of_a_slip_is_that_at_the_end() -> None:
    """A step may go on beyond the end of the scene."""
    motion = standing(np.zeros_like(TIMES), np.zeros_like(TIMES))
    sliding = replace(motion, slip_m=0.1 * TIMES, slip_rate_m_s=np.full_like(TIMES, 0.1))
    on = replace(paestum(0.3, pedestal=True), duration_s=1.9995)
    run = reduce_trajectory(on, sliding, REPORT)
    assert run.residual_slip_m == pytest.approx(0.1 * run.end_s, abs=1e-12)
    assert run.residual_slip_m == pytest.approx(run.history.slip_m[-1], abs=1e-12)


@pytest.mark.parametrize("power", [2.0, 3.0])
def test_uplift_is_the_start_of_its_power_law(power: float) -> None:
    start = 0.4003
    since = np.maximum(TIMES - start, 0.0)
    run = reduced(0.01 * since**power, 0.01 * power * since ** (power - 1.0))
    assert len(run.uplift_times_s) == 1
    assert abs(run.uplift_times_s[0] - start) <= budget.UPLIFT_TIME_S
    assert run.impact_times_s == ()


def test_a_rest_between_two_excursions_is_no_passage() -> None:
    theta = np.where(TIMES < 0.5, 0.02 * np.sin(2.0 * math.pi * TIMES), 0.0)
    late = TIMES > 1.5
    theta = np.where(late, 0.02 * (TIMES - 1.5) ** 2, theta)
    found = rocking(TIMES, theta, np.gradient(theta, TIMES), 1e-5)
    assert len(found.impact_times_s) == 1
    np.testing.assert_allclose(found.uplift_times_s, [0.0, 1.5], atol=budget.UPLIFT_TIME_S, rtol=0.0)


@pytest.mark.parametrize(("sign", "outcome"), [(1, Outcome.OVERTURNED_RIGHT), (-1, Outcome.OVERTURNED_LEFT)])
def test_overturning_ends_the_run_between_samples(sign: int, outcome: Outcome) -> None:
    run = reduced(sign * TIMES, sign * np.ones_like(TIMES))
    assert run.outcome is outcome
    assert run.overturn_time_s == pytest.approx(OVERTURN_RAD, abs=budget.EVENT_TIME_S)
    assert run.no_return_time_s == pytest.approx(PAESTUM.slenderness_rad(sign), abs=budget.EVENT_TIME_S)
    assert run.history.t_s[-1] == run.end_s == run.overturn_time_s
    assert run.peak_theta_rad == OVERTURN_RAD


def test_no_return_is_the_last_crossing() -> None:
    alpha = PAESTUM.slenderness_rad(1)
    theta = np.interp(TIMES, [0.0, 0.5, 1.0, 2.0], [0.0, 2.0 * alpha, 0.0, 2.0 * alpha])
    assert last_outward(TIMES, theta - alpha)[1] == pytest.approx(1.5, abs=budget.EVENT_TIME_S)


def test_numbers_that_are_not_finite_are_a_divergence() -> None:
    theta = np.zeros_like(TIMES)
    theta[700] = np.nan
    run = reduced(theta, np.zeros_like(TIMES))
    assert run.outcome is Outcome.DIVERGED
    assert run.history is None
    assert run.end_s == TIMES[700]


def test_the_wall_is_touched_where_its_rotation_says() -> None:
    on = replace(paestum(0.0, pedestal=False, duration_s=2.0), wall=Wall("right", 0.4))
    limit = on.wall_rotation_rad
    run = reduce_trajectory(on, standing(0.4 * TIMES, np.full_like(TIMES, 0.4)), REPORT)
    assert run.outcome is Outcome.TOUCHES_WALL
    assert run.validity["wall_touch_time_s"] == pytest.approx(limit / 0.4, abs=1.1e-3)
    assert replace(on, wall=Wall("right", 5.0)).wall_rotation_rad == math.inf, "nothing reaches so far"


def test_a_statue_at_rest_is_carried_by_its_weight() -> None:
    on = paestum(0.0, pedestal=False, duration_s=2.0)
    motion = standing(np.zeros_like(TIMES), np.zeros_like(TIMES))
    run = reduce_trajectory(on, motion, REPORT)
    weight = 707.0 * 9.81
    assert run.validity["statue_normal_least_n"] == pytest.approx(weight, rel=1e-9)
    assert run.validity["statue_friction_needed"] == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(run.history.extra["statue_force_z_n"], weight, rtol=1e-9)


def test_energy_that_appears_from_nothing_is_found() -> None:
    on = paestum(0.0, pedestal=False, duration_s=2.0)
    rate = np.where(TIMES < 1.0, 0.0, 0.1)
    theta = np.maximum(TIMES - 1.0, 0.0) * 0.1
    j = on.pivot_inertia_kg_m2[1]
    falling = standing(0.05 + 0.0 * TIMES, np.zeros_like(TIMES))
    gained, none = (reduce_trajectory(on, each, REPORT).validity for each in (standing(theta, rate), falling))
    assert gained["energy_gained_j"] >= 0.5 * j * 0.1**2
    assert none["energy_gained_j"] == 0.0


def test_gravity_of_a_step_is_exact_across_a_jump() -> None:
    on = scene(rectangle(0.2, 1.0), Pulse("rectangular", 3.0, 0.0101, 0.0052), Harmonic(2.0, 5.0), duration_s=0.1)
    edges = np.arange(101) * 1e-3
    gravity = apparent_gravity(on, edges)
    assert np.sum(gravity[:, 0]) * 1e-3 == pytest.approx(-3.0 * 0.0101, rel=1e-12)
    expected = np.diff(on.base_excitation.z.velocity_m_s(edges)) / 1e-3
    np.testing.assert_allclose(gravity[:, 2], -9.81 - expected, rtol=1e-12)
    assert np.all(gravity[:, 1] == 0.0)


def test_nothing_is_told_of_what_comes_after_the_end() -> None:
    """The overturning rotation is reached between two samples, and so is the end: largest values are not of the later one."""
    theta = 0.7503 * TIMES
    falling = replace(
        standing(theta, np.full_like(TIMES, 0.7503)), slip_m=0.1 * TIMES, slip_rate_m_s=np.full_like(TIMES, 0.1)
    )
    run = reduce_trajectory(paestum(0.0, pedestal=False, duration_s=2.0), falling, REPORT)
    assert run.end_s == pytest.approx(1.5 / 0.7503)
    assert run.peak_slip_m == pytest.approx(0.1 * run.end_s) == run.residual_slip_m
    assert run.history is not None
    assert run.history.theta_rad[-1] == pytest.approx(OVERTURN_RAD)


def test_flight_is_told_from_lying_on_another_edge() -> None:
    on = paestum(0.0, pedestal=False, duration_s=2.0)
    theta = np.minimum(TIMES, 1.4)
    lying = standing(theta, np.where(TIMES < 1.4, 1.0, 0.0))
    assert reduce_trajectory(on, lying, REPORT).validity["statue_flight_m"] <= budget.IMPULSE
    lifted = replace(lying, statue_xz_m=lying.statue_xz_m + np.array([0.0, 0.01]))
    assert reduce_trajectory(on, lifted, REPORT).validity["statue_flight_m"] == pytest.approx(0.01, abs=1e-9)
    # Rocking about its front edge lifts both corners of the plane, and not the statue.
    block = rectangle(0.4, 1.0)
    foot = np.array([0.0, -0.5 * block.depth_m, 0.0])
    roll = 0.1 * np.sin(0.5 * math.pi * TIMES)
    cos, sin, zero, one = np.cos(roll), np.sin(roll), np.zeros_like(roll), np.ones_like(roll)
    turn = np.stack([one, zero, zero, zero, cos, -sin, zero, sin, cos], axis=1).reshape(-1, 3, 3)
    place = foot + turn @ (np.array([0.0, 0.0, block.centroid_height_m]) - foot)
    for lift_m in (0.0, 0.01):
        at = place + np.array([0.0, 0.0, lift_m])
        rocking = replace(standing(zero, zero), statue_xz_m=at[:, [0, 2]], extra=statue_columns(block, turn, at))
        run = reduce_trajectory(scene(block, duration_s=2.0), rocking, REPORT)
        found = run.validity
        assert run.patterns[-1].name == "rocking"
        assert found["statue_flight_m"] == pytest.approx(lift_m, abs=1e-9)
        assert found["plain_because"] == (["contact_lost"] if lift_m else [])
    sliding = place + np.column_stack([zero, 0.01 * TIMES, zero])
    aside = replace(standing(zero, zero), statue_xz_m=sliding[:, [0, 2]], extra=statue_columns(block, turn, sliding))
    slid = reduce_trajectory(scene(block, duration_s=2.0), aside, REPORT)
    assert slid.validity["plain_because"] == ["statue_slides"]
    assert slid.patterns[-1].name == "statue_slides"
    bulge = np.vstack([PAESTUM.section_m, [[0.4, 0.5]]])
    rounded = replace(on, statue=replace(PAESTUM, section_m=bulge))
    found = reduce_trajectory(rounded, lying, REPORT).validity
    assert found["penetration_m"] > 0.1


def test_a_light_friction_under_a_quick_strong_motion_is_read_as_it_acts() -> None:
    """2.4 g at 5.8 Hz against μ = 0.054: means of velocities over two steps read a friction 5 % above its limit at 4 ms."""
    scene, engine = wide_scene(772_137), load("pymunk")
    run = engine.simulate(scene, engine.settings_for_dt(scene, 4e-3), RunOptions())
    assert run.peak_slip_m > 0.8


def test_a_step_in_which_a_pedestal_comes_to_rest_is_no_fault_of_the_friction() -> None:
    """The shipped statue under 0.662 g at 1.02 Hz falls at once: of 33 steps at 4 ms in which its pedestal is held one follows
    its sliding, and its force, read from velocities of before and after, is three times the limit."""
    motion = {"x": {"kind": "harmonic", "amplitude_g": 0.662, "frequency_hz": 1.02}}
    on, engine = load_scene(SCENES / "paestum_pedestal.toml", {"motion": motion, "uncertainty": {}}), load("pymunk")
    (coarse, *_) = engine.refinement_levels(on)
    assert engine.simulate(on, coarse, RunOptions()).outcome is Outcome.OVERTURNED_RIGHT


def test_a_wall_that_stops_a_pedestal_is_no_friction_of_the_floor(monkeypatch: pytest.MonkeyPatch) -> None:
    """The pedestal juts out by 0.087 m on the left, and slides into a wall 0.09 m from the statue's base."""
    scene, engine = replace(paestum(mu=(0.20, 0.15)), wall=Wall("left", 0.09)), load("pymunk")
    level = engine.settings_for_dt(scene, 1e-3)
    assert engine.simulate(scene, level, RunOptions()).history is not None
    monkeypatch.setattr(reduce, "friction_is_known", lambda *_: True)
    with pytest.raises(LayerFault, match="friction_"):
        engine.simulate(scene, level, RunOptions())
