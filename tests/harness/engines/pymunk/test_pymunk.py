"""pymunk against the analytic model, its own limits and known answers."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from analytic.excitation import Harmonic, SampledAcceleration
from harness import Outcome, Run, RunOptions
from harness.engines.analytic import TwoBlock
from harness.engines.base import EngineFailure
from harness.engines.pymunk import Munk2D
from harness.engines.pymunk.plain import PlainMunk2D
from harness.engines.pymunk.settings import MunkSettings
from harness.engines.stepping.loop import IMPOSED_LABEL
from harness.model.scene import OVERTURN_RAD, Pedestal, Scene, Wall
from tests import budgets_engines as budget
from tests.engines_for_tests import ready
from tests.measures.contact_engines import baseline_loop
from tests.scenes_for_tests import GRAVITY_M_S2, PAESTUM, paestum, rectangle, scene

CASES = [(0.334, 2.0), (0.334, 3.0), (0.429, 2.0), (0.429, 3.0)]
ENGINE, PLAIN = Munk2D(), PlainMunk2D()


def run(on: Scene, dt_s: float = 2.5e-4, **changes: object) -> Run:
    settings = replace(ENGINE.settings_for_dt(on, dt_s), **changes)  # type: ignore[arg-type]
    return ENGINE.simulate(on, settings, RunOptions())


def exact(on: Scene) -> Run:
    model = TwoBlock()
    return model.simulate(on, model.refinement_levels(on)[1], RunOptions())


def apart(a: Run, b: Run) -> tuple[float, float]:
    """Largest difference in rotation, rad, and in slip, m."""
    assert a.history.t_s.size == b.history.t_s.size
    theta = np.abs(a.history.theta_rad - b.history.theta_rad)
    slip = np.abs(a.history.slip_m - b.history.slip_m)
    return float(np.max(theta)), float(np.max(slip))


@pytest.mark.parametrize(("amplitude_g", "frequency_hz"), CASES)
def test_pedestal_follows_the_model(amplitude_g: float, frequency_hz: float) -> None:
    on = paestum(amplitude_g, frequency_hz)
    model = exact(on)
    coarse, fine = apart(run(on, 1e-3), model), apart(run(on), model)
    assert fine[0] <= budget.PEDESTAL_FINE_RAD <= budget.PEDESTAL_RAD
    assert fine[1] <= budget.SLIP_M
    assert fine[0] < coarse[0]


@pytest.mark.parametrize(("amplitude_g", "frequency_hz"), CASES)
def test_floor_follows_the_model(amplitude_g: float, frequency_hz: float) -> None:
    on = paestum(amplitude_g, frequency_hz, pedestal=False)
    assert apart(run(on), exact(on))[0] <= budget.FLOOR_FINE_RAD


@pytest.mark.parametrize(("amplitude_g", "frequency_hz"), CASES)
def test_two_frictions_follow_the_model(amplitude_g: float, frequency_hz: float) -> None:
    on = paestum(amplitude_g, frequency_hz, mu=(0.20, 0.15))
    assert apart(run(on), exact(on))[0] <= budget.TWO_FRICTIONS_FINE_RAD <= budget.TWO_FRICTIONS_RAD


@pytest.mark.parametrize("ratio", [0.85, 0.90])
@pytest.mark.parametrize(("amplitude_g", "frequency_hz"), [CASES[0], CASES[3]])
def test_prescribed_ratio_is_imposed_on_both_bodies(ratio: float, amplitude_g: float, frequency_hz: float) -> None:
    on = paestum(amplitude_g, frequency_hz, mu=(0.20, 0.15), restitution=ratio)
    found = run(on)
    assert IMPOSED_LABEL in found.labels
    assert found.interventions["imposed_impact"].count > 0
    ours, other = (
        apart(found, exact(on))[0],
        apart(found, exact(replace(on, contact=replace(on.contact, restitution=None))))[0],
    )
    assert ours <= budget.TWO_FRICTIONS_RAD
    assert other > 3.0 * ours


def test_whole_steps_alone_are_seen_to_be_worse() -> None:
    on = paestum(0.429, 3.0)
    model = exact(on)
    plain = PLAIN.simulate(on, PLAIN.settings_for_dt(on, 2.5e-4), RunOptions())
    assert apart(plain, model)[0] > 5.0 * apart(run(on), model)[0]


def test_vertical_motion_follows_the_model() -> None:
    on = paestum(0.429, 3.0, mu=(0.20, 0.15))
    on = replace(on, base_excitation=replace(on.base_excitation, z=Harmonic(0.25 * GRAVITY_M_S2, 7.0)))
    assert apart(run(on), exact(on))[0] <= budget.PEDESTAL_RAD


def test_order_before_the_first_impact() -> None:
    on = paestum(0.334, 3.0, duration_s=0.45)
    model = exact(on)
    assert model.impact_times_s == ()
    errors = [apart(run(on, dt, iterations=400), model)[0] for dt in (2e-3, 1e-3, 5e-4, 2.5e-4)]
    assert math.log2(errors[0] / errors[-1]) / 3.0 >= budget.ORDER_LEAST >= 0.8 * ENGINE.order


def test_free_rocking_known_answer() -> None:
    block = rectangle(0.2, 1.0)
    alpha = block.slenderness_rad(1)
    found = run(scene(block, theta_rad=0.5 * alpha, duration_s=1.0))
    assert found.impact_times_s[0] == pytest.approx(0.34709, abs=budget.FREE_ROCKING_TIME_S)
    assert found.validity["impact_ratios"][0] == pytest.approx(0.9423, abs=budget.FREE_ROCKING_RATIO * 5.0)
    assert -np.min(found.history.theta_rad) / alpha == pytest.approx(0.4222, abs=budget.FREE_ROCKING_PEAK)
    assert found.history.theta_rad[0] == pytest.approx(0.5 * alpha, abs=1e-12)


@pytest.mark.parametrize("pedestal", [False, True])
def test_moving_table_is_the_same_motion(pedestal: bool) -> None:
    on = paestum(0.429, 2.0, pedestal=pedestal, mu=(0.20, 0.15))
    theta, slip = apart(run(on), run(replace(on, table="moving")))
    assert theta <= budget.TABLE_RAD
    assert slip <= budget.TABLE_RAD


def test_at_rest_nothing_moves() -> None:
    on = paestum(0.0, duration_s=60.0, output_dt_s=0.1)
    found = ENGINE.simulate(on, ENGINE.settings_for_dt(on, 1e-3), RunOptions(skips=frozenset()))
    assert found.steps == 60_000
    settled = found.history.t_s > 1.0
    for values in (found.history.theta_rad, found.history.slip_m, found.history.extra["statue_slip_m"]):
        assert np.ptp(values[settled]) <= budget.CREEP


@pytest.mark.parametrize("pedestal", [True, False])
def test_at_rest_no_level_creeps(pedestal: bool) -> None:
    """After the contacts have settled in the first half of some steps, at the rate of a minute."""
    on = paestum(0.0, 1.0, pedestal=pedestal)
    for level in ENGINE.refinement_levels(on):
        rest = replace(on, duration_s=budget.REST_STEPS * level.dt_s)
        columns = ENGINE.simulate(rest, level, RunOptions(skips=frozenset())).history.columns()
        late = columns["t_s"] >= 0.5 * rest.duration_s
        minute = 60.0 / (0.5 * rest.duration_s)
        for name, most in (
            ("slip_m", budget.CREEP),
            ("statue_slip_m", budget.CREEP_M),
            ("theta_rad", budget.CREEP_TURN_RAD),
        ):
            assert minute * np.ptp(columns[name][late]) <= most, (level.dt_s, name)


def test_a_mirrored_scene_gives_the_mirrored_history() -> None:
    on = paestum(0.429, 3.0, duration_s=0.6)
    mirrored = replace(
        PAESTUM,
        corner_left_m=PAESTUM.corner_right_m,
        corner_right_m=PAESTUM.corner_left_m,
        section_m=PAESTUM.section_m[::-1] * np.array([-1.0, 1.0]),
    )
    other = replace(
        on, statue=mirrored, base_excitation=replace(on.base_excitation, x=on.base_excitation.x.scaled(-1.0))
    )
    a, b = run(on).history, run(other).history
    np.testing.assert_allclose(b.theta_rad, -a.theta_rad, atol=budget.PEDESTAL_FINE_RAD)


def test_slippery_statue_slides_on_its_pedestal() -> None:
    on = replace(
        paestum(0.429, 2.0, mu=0.9),
    )
    held = run(on)
    slippery = run(replace(on, contact=replace(on.contact, statue=0.1)))
    assert held.validity["statue_slip_m"] < 1e-5
    assert slippery.validity["statue_slip_m"] > 1e-2


def test_narrow_pedestal_tips() -> None:
    on = scene(PAESTUM, Harmonic(0.334 * GRAVITY_M_S2, 2.0), pedestal=Pedestal(250.0, 0.44, 0.8, 1.2), mu=0.9)
    assert run(on).validity["pedestal_tilt_rad"] > 1e-3
    assert run(paestum(0.334, 2.0)).validity["pedestal_tilt_rad"] < 1e-5


def test_wall_stops_the_fall() -> None:
    free = paestum(0.429, 1.5, pedestal=False, duration_s=3.0)
    walled = replace(free, wall=Wall("right", 0.3))
    fallen, stopped = run(free, 1e-3), run(walled, 1e-3)
    assert fallen.outcome is Outcome.OVERTURNED_RIGHT
    assert stopped.outcome is Outcome.TOUCHES_WALL
    limit = walled.wall_rotation_rad
    assert limit < stopped.peak_theta_rad < min(limit + 0.05, OVERTURN_RAD)


def test_quiet_start_and_end_are_skipped_without_a_change() -> None:
    times = np.linspace(0.0, 6.0, 601)
    pulse = np.where((times > 2.0) & (times < 2.3), -4.0 * np.sin((times - 2.0) * 2.0 * math.pi / 0.3), 0.0)
    on = paestum(duration_s=12.0, mu=(0.20, 0.15), output_dt_s=0.01)
    on = replace(on, base_excitation=replace(on.base_excitation, x=SampledAcceleration(times, pulse)))
    settings = ENGINE.settings_for_dt(on, 1e-3)
    whole, short = (
        ENGINE.simulate(on, settings, RunOptions(skips=frozenset())),
        ENGINE.simulate(on, settings, RunOptions()),
    )
    assert whole.skipped == {}
    assert set(short.skipped) == {"quiet_start", "quiet_end"}
    assert short.steps < 0.5 * whole.steps
    assert apart(whole, short)[0] <= budget.FLOOR_FINE_RAD
    assert short.outcome is whole.outcome
    assert np.max(np.abs(whole.history.theta_rad if whole.history else 0.0)) > 1e-3


def test_direct_calls_are_the_public_ones() -> None:
    on = paestum(0.429, 3.0)
    settings = PLAIN.settings_for_dt(on, 1e-3)
    history = PLAIN.simulate(on, settings, RunOptions(skips=frozenset())).history
    angles = [-(row[2] + 1e-3 * row[5]) for row in baseline_loop(on, settings)[1]]
    assert np.max(np.abs(history.theta_rad)) > 0.01
    np.testing.assert_allclose(history.theta_rad[1:], angles, rtol=0.0, atol=budget.ROUNDING_RAD)


def test_energy_and_contact_are_recorded() -> None:
    found = run(paestum(0.429, 3.0))
    assert found.validity["energy_gained_j"] <= budget.ENERGY_J
    assert 0.0 < found.validity["penetration_m"] < 1e-5
    assert 0.2 < found.validity["statue_friction_needed"] < 0.5
    assert found.history is not None
    columns = ("statue_slip_m", "pedestal_tilt_rad", "energy_j", "statue_force_z_n", "floor_force_x_n")
    for name in columns:
        assert np.all(np.isfinite(found.history.extra[name]))
    names = {pattern.name for pattern in found.patterns}
    assert {"rest", "sliding", "both", "rocking"} == names


def test_settings_of_another_engine_are_refused() -> None:
    model = TwoBlock()
    with pytest.raises(EngineFailure, match=r"pymunk .*TwoBlockSettings"):
        ENGINE.simulate(paestum(), model.refinement_levels(paestum())[0], RunOptions())


def test_levels_are_ordered() -> None:
    levels = ENGINE.refinement_levels(paestum())
    assert all(isinstance(level, MunkSettings) for level in levels)
    assert all(a.dt_s > b.dt_s for a, b in pairwise(levels))
    assert all(a.expected_error_rad > b.expected_error_rad for a, b in pairwise(levels))


def test_a_baseline_loop_makes_the_same_motion_in_as_many_steps() -> None:
    on = paestum(0.08, 5.0, mu=0.8, duration_s=0.5)
    settings = ENGINE.settings_for_dt(on, 1e-3)
    seconds, rows = baseline_loop(on, settings)
    found = ENGINE.simulate(on, settings, RunOptions(skips=frozenset()))
    assert seconds > 0.0
    assert found.steps <= len(rows) * budget.BARE_LOOP_STEPS
    angles = [-(row[2] + 1e-3 * row[5]) for row in rows]
    np.testing.assert_allclose(found.history.theta_rad[1:], angles, rtol=0.0, atol=budget.LAID_RAD)


def test_its_version_is_the_distribution_s(monkeypatch: pytest.MonkeyPatch) -> None:
    """The module of 7.0.0 calls itself 2.0.0."""
    import pymunk

    monkeypatch.setattr(pymunk, "version", "2.0.0")
    assert ENGINE.missing() is None
    monkeypatch.setattr("harness.engines.pymunk.metadata.version", lambda name: {"pymunk": "6.9.0"}[name])
    assert "6.9.0" in (ENGINE.missing() or "")


@pytest.mark.parametrize("name", ["pymunk", "pymunk:plain"])
def test_a_motion_across_the_plane_changes_nothing(name: str) -> None:
    """A push across it had a share in the friction that holds the pedestal, which slid at nine tenths of its limit."""
    engine, on = ready(name), paestum(0.334, 2.0, mu=(0.2, 0.15), duration_s=0.6)
    motion = on.base_excitation
    across = replace(on, base_excitation=replace(motion, y=Harmonic(2.0, 2.0)))
    alone, beside = (engine.simulate(each, engine.settings_for_dt(each, 1e-3), RunOptions()) for each in (on, across))
    assert alone.peak_slip_m > 0.0
    assert np.array_equal(alone.history.theta_rad, beside.history.theta_rad)
    assert np.array_equal(alone.history.slip_m, beside.history.slip_m)
