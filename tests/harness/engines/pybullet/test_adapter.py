"""pybullet against the analytic model and closed forms: accuracy, order, frictions, impacts, table, planes."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pytest

from analytic.closed_form import frequency_parameter_rad_s, quarter_period_s
from analytic.excitation import Harmonic, Pulse, SampledAcceleration
from harness import Outcome, RunOptions, load_scene
from harness.model.scene import BaseExcitation, Pedestal, Wall
from harness.questions.bench.standard_scenes import standard_set
from tests import budgets_bullet as budget
from tests.harness.engines.pybullet.cases import NOTHING_SKIPPED, WHOLE, apart, bullet, exact, worst
from tests.scenes_for_tests import GRAVITY_M_S2, SCENES, paestum, rectangle, scene

CASES = [(0.429, 3.0), (0.334, 3.0), (0.429, 2.0), (0.334, 2.0)]


@pytest.mark.parametrize(("amplitude_g", "frequency_hz"), CASES)
def test_floor(amplitude_g: float, frequency_hz: float) -> None:
    case = paestum(amplitude_g, frequency_hz, pedestal=False)
    assert apart(bullet(case), exact(case)) <= budget.FLOOR_RAD
    run = bullet(case, options=WHOLE)
    assert apart(run, exact(case)) <= budget.WHOLE_FLOOR_RAD
    assert run.validity["out_of_plane_rad"] <= budget.PLANAR_RAD
    assert run.validity["yaw_rad"] <= budget.PLANAR_RAD


@pytest.mark.parametrize(("amplitude_g", "frequency_hz"), CASES)
def test_pedestal(amplitude_g: float, frequency_hz: float) -> None:
    case = paestum(amplitude_g, frequency_hz)
    half, run = bullet(case), bullet(case, options=WHOLE)
    assert apart(half, exact(case)) <= budget.PEDESTAL_RAD
    assert apart(half, exact(case), "slip_m") <= budget.PEDESTAL_SLIP_M
    assert apart(run, exact(case)) <= budget.WHOLE_PEDESTAL_RAD
    assert apart(run, exact(case), "slip_m") <= budget.WHOLE_SLIP_M
    assert run.validity["out_of_plane_rad"] <= budget.PLANAR_RAD
    assert run.validity["yaw_rad"] <= budget.PLANAR_RAD
    whole_steps = round(case.duration_s / 2.5e-4)
    assert run.steps - whole_steps <= budget.SUBSTEP_SHARE * whole_steps


def test_a_wrong_friction_is_seen() -> None:
    case = paestum(0.429, 3.0)
    assert apart(bullet(paestum(0.429, 3.0, mu=0.16)), exact(case)) > budget.SEEN * budget.PEDESTAL_RAD


@pytest.mark.parametrize(
    ("pedestal", "frequency_hz", "until_s", "coarsest_s"),
    [(False, 2.0, 1.0, 4e-3), (True, 3.0, 0.45, 2e-3), (True, 2.0, 0.7, 4e-3)],
)
def test_order_before_the_first_impact(pedestal: bool, frequency_hz: float, until_s: float, coarsest_s: float) -> None:
    case = paestum(0.429, frequency_hz, pedestal=pedestal, duration_s=until_s, output_dt_s=4e-3)
    reference = exact(case)
    steps = tuple(coarsest_s / halving for halving in (1, 2, 4, 8))
    tight = {"residual": 1e-14, "iterations": 2000}
    for options in (RunOptions(), WHOLE):
        errors = [apart(bullet(case, dt_s, options, **tight), reference) for dt_s in steps]
        order = float(np.polyfit(np.log2(steps), np.log2(errors), 1)[0])
        assert order >= budget.LEAST_ORDER, errors


@pytest.mark.parametrize("name", ["free rocking", "one sine pulse", "harmonic, pedestal, two friction coefficients"])
def test_impacts_cost_no_order(name: str) -> None:
    """Over several impacts and slips the error falls with the step, from one that a coarse level is allowed."""
    case = next(item for item in standard_set() if item.name == name).scene()
    coarse, fine = (apart(bullet(case, dt_s), exact(case)) for dt_s in (4e-3, 2.5e-4))
    assert coarse <= budget.COARSEST_RAD
    assert fine <= budget.FALLEN * coarse


def test_impacts_are_met_at_steps_that_no_foot_crosses_quickly() -> None:
    """A coming foot that is nearer than a standing one may be, because it goes so little in a step, still comes."""
    case = scene(rectangle(0.4, 1.0), theta_rad=2e-3, duration_s=0.12)
    assert apart(bullet(case, 2e-5), exact(case)) <= budget.SMALL_RAD


def test_finest_level_stays_in_the_plane() -> None:
    from harness.engines import load

    case = paestum(0.429, 3.0, duration_s=0.3)
    engine = load("pybullet")
    run = engine.simulate(case, engine.refinement_levels(case)[-1], NOTHING_SKIPPED)
    assert run.validity["out_of_plane_rad"] <= budget.PLANAR_FINEST_RAD


@pytest.mark.parametrize(("amplitude_g", "frequency_hz"), CASES[:2])
def test_static_and_kinetic_friction(amplitude_g: float, frequency_hz: float) -> None:
    case = paestum(amplitude_g, frequency_hz, mu=(0.20, 0.15))
    run = bullet(case)
    assert apart(run, exact(case)) <= budget.BOTH_FRICTIONS_RAD
    assert run.interventions["friction_release"].steps_again > 0
    for one_number in (0.15, 0.20):
        other = bullet(paestum(amplitude_g, frequency_hz, mu=one_number))
        assert apart(other, exact(case)) > budget.SEEN * apart(run, exact(case))


@pytest.mark.parametrize("ratio", [0.85, 0.90])
def test_imposed_ratio(ratio: float) -> None:
    case = paestum(0.429, 3.0, restitution=ratio)
    run = bullet(case)
    assert apart(run, exact(case)) <= budget.BOTH_FRICTIONS_RAD
    assert run.labels == ("impact law imposed",)
    assert run.interventions["imposed_impact"].count == len(run.impact_times_s)
    np.testing.assert_allclose(run.validity["impact_ratios"], ratio, atol=budget.IMPOSED_RATIO)


@pytest.mark.parametrize(("amplitude_g", "ratio", "dt_s"), [(0.429, 0.85, 1e-3), (0.334, 0.90, 4e-3)])
def test_imposed_ratio_lets_a_pedestal_slide(amplitude_g: float, ratio: float, dt_s: float) -> None:
    """An imposed impact says whether friction is static after it, and is met where the statue is quicker than it seemed."""
    case = paestum(amplitude_g, 3.0, mu=(0.20, 0.15), restitution=ratio)
    assert apart(bullet(case, dt_s), exact(case)) <= budget.COARSEST_RAD


@pytest.mark.parametrize("pedestal", [True, False])
def test_moving_table_is_the_accelerating_frame(pedestal: bool) -> None:
    case = paestum(0.429, 3.0, pedestal=pedestal, duration_s=0.6)
    frame, moving = bullet(case, options=WHOLE), bullet(replace(case, table="moving"))
    assert apart(frame, moving) <= budget.TABLE_RAD
    assert apart(frame, moving, "slip_m") <= budget.WHOLE_SLIP_M


def test_a_table_that_moves_before_anything_else_does_takes_it_along() -> None:
    """Until a ramp reaches the limits of rest nothing moves on the table, which has its velocity by then."""
    motion = Harmonic(0.25 * GRAVITY_M_S2, 2.0, ramp_s=1.0)
    t_s = np.arange(0.0, 1.2, 0.002)
    sampled = BaseExcitation(x=SampledAcceleration(t_s, motion.accel_m_s2(t_s)))
    for each in (sampled, BaseExcitation(x=motion)):
        case = replace(paestum(0.3, 2.0, duration_s=1.0), base_excitation=each)
        frame, moving = bullet(case, 1e-3), bullet(replace(case, table="moving"), 1e-3)
        assert frame.skipped["quiet_start"] > 0.3
        assert moving.peak_slip_m == pytest.approx(frame.peak_slip_m, abs=budget.WHOLE_SLIP_M)
        assert apart(moving, frame) <= budget.TABLE_RAD


def test_moving_table_with_two_frictions_and_vertical_motion() -> None:
    case = paestum(0.429, 3.0, mu=(0.20, 0.15), duration_s=0.6)
    case = replace(
        case, base_excitation=type(case.base_excitation)(x=case.base_excitation.x, z=Harmonic(0.1 * GRAVITY_M_S2, 5.0))
    )
    frame, moving = bullet(case), bullet(replace(case, table="moving"))
    assert apart(frame, moving) <= budget.TABLE_RAD
    assert apart(frame, exact(case)) <= budget.BOTH_FRICTIONS_RAD
    level = bullet(paestum(0.429, 3.0, mu=(0.20, 0.15), duration_s=0.6))
    assert apart(level, exact(case)) > budget.SEEN * apart(frame, exact(case))


def test_free_rocking() -> None:
    block = rectangle(0.2, 1.0, mass_kg=100.0, depth_m=0.2)
    alpha = block.slenderness_rad(1)
    run = bullet(scene(block, theta_rad=0.5 * alpha, duration_s=1.2), 5e-4)
    p = frequency_parameter_rad_s(
        mass_kg=block.mass_kg,
        inertia_kg_m2=block.inertia_kg_m2,
        radius_m=float(np.hypot(block.corner_right_m, block.centroid_height_m)),
        gravity_m_s2=GRAVITY_M_S2,
    )
    assert run.impact_times_s[0] == pytest.approx(quarter_period_s(0.5 * alpha, alpha, p), abs=budget.FREE_IMPACT_S)
    rebound = run.history.theta_rad[run.history.t_s > run.impact_times_s[0] + 0.01]
    assert -float(np.min(rebound)) / alpha == pytest.approx(0.4222, rel=budget.FREE_PEAK_REL)


def test_initial_rate() -> None:
    case = scene(rectangle(0.4, 1.0), theta_rate_rad_s=-0.5, duration_s=0.3)
    run = bullet(case)
    assert apart(run, exact(case)) <= budget.FLOOR_RAD
    assert run.history.theta_rad[40] < 0.0


def test_overturning_time() -> None:
    case = paestum(0.429, 1.5, pedestal=False, duration_s=4.0)
    run, reference = bullet(case, 5e-4), exact(case)
    assert run.outcome is reference.outcome is Outcome.OVERTURNED_RIGHT
    assert run.no_return_time_s == pytest.approx(reference.no_return_time_s, abs=2e-3)


def test_wall_is_touched_where_the_silhouette_meets_it() -> None:
    case = replace(paestum(0.429, 2.0, pedestal=False, duration_s=2.0), wall=Wall("right", 0.2))
    run = bullet(case, 5e-4)
    assert run.outcome is Outcome.TOUCHES_WALL
    reach = case.wall_rotation_rad
    assert reach is not None
    touch = float(run.history.at(np.array([run.validity["wall_touch_time_s"]]))[0])
    assert touch == pytest.approx(reach, abs=2e-3)
    # The wall holds: the rotation does not pass it, and without it the statue falls.
    assert run.peak_theta_rad == pytest.approx(reach, abs=2e-3)
    assert bullet(replace(case, wall=None, duration_s=3.0), 5e-4).outcome is Outcome.OVERTURNED_RIGHT


def test_statue_slips_on_its_support_as_newmark_says() -> None:
    pulse = Pulse("rectangular", 0.3 * GRAVITY_M_S2, 0.25)
    run = bullet(scene(rectangle(0.5, 0.4), pulse, mu_statue=0.1, duration_s=1.2), 5e-4)
    # A rectangular pulse a for t_d against friction μg: slip = (a − μg) a t_d² / (2 μg).
    a, held = 0.3 * GRAVITY_M_S2, 0.1 * GRAVITY_M_S2
    assert run.validity["statue_slip_m"] == pytest.approx((a - held) * a * 0.25**2 / (2.0 * held), abs=budget.SLIP_M)
    assert run.peak_theta_rad < budget.PLANAR_RAD


def test_pedestal_tips() -> None:
    high = Pedestal(mass_kg=250.0, width_m=0.45, depth_m=0.8, height_m=0.6)
    run = bullet(replace(paestum(0.9, 2.0, mu=1.5, duration_s=0.8), pedestal=high), 5e-4)
    assert run.validity["pedestal_tilt_rad"] > 0.05
    held = bullet(paestum(0.429, 2.0, duration_s=0.5), 5e-4)
    assert held.validity["pedestal_tilt_rad"] < budget.PLANAR_RAD


@pytest.mark.parametrize("pedestal", [True, False])
def test_creep_at_rest_on_the_finest_level(pedestal: bool) -> None:
    from harness.engines import load

    case = paestum(0.0, 1.0, pedestal=pedestal, duration_s=budget.REST_S)
    engine = load("pybullet")
    run = engine.simulate(case, engine.refinement_levels(case)[-1], NOTHING_SKIPPED)
    long = 60.0 / budget.REST_S
    for column in ("theta_rad", "yaw_rad", "out_of_plane_rad"):
        assert long * _drift(run, column) <= budget.CREEP_RAD, column
    for column in ("slip_m", "statue_y_m", "corner_right_x_m"):
        assert long * _drift(run, column) <= budget.CREEP_M, column


@pytest.mark.parametrize("pedestal", [True, False])
@pytest.mark.parametrize(
    ("level", "skips"), [*((level, {"base_only", "mirror"}) for level in range(5)), (0, ()), (2, ())]
)
def test_no_level_creeps(pedestal: bool, level: int, skips: Iterable[str]) -> None:
    from harness.engines import load

    engine = load("pybullet")
    case = paestum(0.0, 1.0, pedestal=pedestal)
    settings = engine.refinement_levels(case)[level]
    # The first penetration is taken back by a share in each step, not in each second.
    rest_s = budget.REST_STEPS * settings.dt_s
    run = engine.simulate(replace(case, duration_s=rest_s), settings, RunOptions(skips=frozenset(skips)))
    assert run.steps == budget.REST_STEPS
    for column, most in (
        ("theta_rad", budget.CREEP_RAD),
        ("slip_m", budget.CREEP_M),
        ("corner_right_x_m", budget.CREEP_M),
        ("yaw_rad", budget.CREEP_RAD),
        ("statue_y_m", budget.CREEP_M),
    ):
        assert 60.0 / rest_s * _drift(run, column) <= most, column


def test_what_friction_just_fails_to_hold_slides() -> None:
    """Rest without creep must not come from holding what slides: a push a hundredth above the limit moves the pedestal."""
    peak_m_s2 = 1.01 * 0.15 * GRAVITY_M_S2
    case = replace(
        paestum(0.0, 1.0, duration_s=0.25),
        statue=rectangle(0.5, 1.0),
        base_excitation=BaseExcitation(x=Pulse("rectangular", peak_m_s2, 0.2)),
    )
    slid = worst(bullet(case, 1e-3), "slip_m")
    assert slid == pytest.approx(0.5 * (peak_m_s2 - 0.15 * GRAVITY_M_S2) * 0.2**2, rel=0.1)


def _drift(run: object, column: str) -> float:
    """Change over the last two thirds of a run: its first third settles the contact's first penetration."""
    values = run.history.columns()[column]  # type: ignore[attr-defined]
    late = values[values.size // 3 :]
    return float(np.max(np.abs(late - late[0]))) * 1.5


@pytest.mark.parametrize("sampled", [False, True])
def test_rest_that_is_left_out_changes_no_rotation_after_it(sampled: bool) -> None:
    """Each crest passes the statue's limit by a tenth: what it does then begins from contacts as they are at that instant."""
    motion = Harmonic(0.1 * GRAVITY_M_S2, 0.8)
    t_s = np.arange(0.0, 3.0, 0.002)
    x = SampledAcceleration(t_s, motion.accel_m_s2(t_s)) if sampled else motion
    case = replace(load_scene(SCENES / "paestum_pedestal.toml"), base_excitation=BaseExcitation(x=x), duration_s=2.5)
    run = bullet(case, 1e-3)
    assert run.skipped["quiet_start"] > 0.8
    assert run.skipped["quiet_rest"] > 0.5
    assert run.peak_theta_rad > 2e-3
    assert apart(run, bullet(case, 1e-3, NOTHING_SKIPPED)) <= budget.REST_LEFT_OUT_RAD


def test_nothing_is_integrated_where_nothing_can_move() -> None:
    still = bullet(paestum(0.0, 1.0, duration_s=60.0))
    assert still.steps < 10
    assert still.outcome is Outcome.STANDS
    assert worst(still, "theta_rad") <= budget.CREEP_RAD
