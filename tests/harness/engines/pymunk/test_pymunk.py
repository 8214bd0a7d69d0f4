"""pymunk against the model where it has ways of its own: iterations, small and slow impacts, slip, samples, plain calls."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analytic.excitation import Harmonic, Pulse
from harness import Scene
from harness.engines.pymunk import Munk2D, PlainMunk2D
from harness.model import BaseExcitation, Pedestal
from harness.questions.bench.standard_scenes import PEDESTAL, TWO
from harness.questions.study.cases import BaseScene
from tests import budgets_engines as budget
from tests.engines_for_tests import NOTHING_SKIPPED, apart, error, exact, run
from tests.measures.contact_engines import baseline_loop
from tests.scenes_for_tests import GRAVITY_M_S2, PAESTUM, SCENES, paestum, rectangle, scene

ENGINE, PLAIN = Munk2D(), PlainMunk2D()


def test_at_rest_nothing_moves() -> None:
    on = paestum(0.0, duration_s=60.0, output_dt_s=0.1)
    found = run("pymunk", on, 1e-3, NOTHING_SKIPPED)
    assert found.steps == 60_000
    settled = found.history.t_s > 1.0
    for values in (found.history.theta_rad, found.history.slip_m, found.history.extra["statue_slip_m"]):
        assert np.ptp(values[settled]) <= budget.CREEP


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
    a, b = run("pymunk", on).history, run("pymunk", other).history
    np.testing.assert_allclose(b.theta_rad, -a.theta_rad, atol=budget.FOLLOWS_RAD["pymunk"]["pedestal"])


def test_direct_calls_are_the_public_ones() -> None:
    on = paestum(0.429, 3.0)
    settings = PLAIN.settings_for_dt(on, 1e-3)
    history = PLAIN.simulate(on, settings, NOTHING_SKIPPED).history
    angles = [-(row[2] + 1e-3 * row[5]) for row in baseline_loop(on, settings)[1]]
    assert np.max(np.abs(history.theta_rad)) > 0.01
    np.testing.assert_allclose(history.theta_rad[1:], angles, rtol=0.0, atol=budget.ROUNDING_RAD)


def test_energy_and_contact_are_recorded() -> None:
    found = run("pymunk", paestum(0.429, 3.0))
    assert found.validity["energy_gained_j"] <= budget.ENERGY_J
    assert 0.0 < found.validity["penetration_m"] < 1e-5
    assert 0.2 < found.validity["statue_friction_needed"] < 0.5
    assert found.history is not None
    columns = ("statue_slip_m", "pedestal_tilt_rad", "energy_j", "statue_force_z_n", "floor_force_x_n")
    for name in columns:
        assert np.all(np.isfinite(found.history.extra[name]))
    names = {pattern.name for pattern in found.patterns}
    assert {"rest", "sliding", "both", "rocking"} == names


def test_a_baseline_loop_makes_the_same_motion_in_as_many_steps() -> None:
    on = paestum(0.08, 5.0, mu=0.8, duration_s=0.5)
    settings = ENGINE.settings_for_dt(on, 1e-3)
    seconds, rows = baseline_loop(on, settings)
    found = ENGINE.simulate(on, settings, NOTHING_SKIPPED)
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
    on = paestum(0.334, 2.0, mu=(0.2, 0.15), duration_s=0.6)
    motion = on.base_excitation
    across = replace(on, base_excitation=replace(motion, y=Harmonic(2.0, 2.0)))
    alone, beside = (run(name, each, 1e-3) for each in (on, across))
    assert alone.peak_slip_m > 0.0
    assert np.array_equal(alone.history.theta_rad, beside.history.theta_rad)
    assert np.array_equal(alone.history.slip_m, beside.history.slip_m)


def test_impacts_of_small_rocking_are_told_where_they_are_and_with_their_ratios() -> None:
    """A lean of a milliradian moves the top by 1 mm."""
    on = scene(rectangle(0.2, 1.0), theta_rad=1e-3, duration_s=0.3)
    model = exact(on)
    found = run("pymunk", on, 1.8e-3)
    assert found.impact_times_s == pytest.approx(model.impact_times_s, abs=budget.SMALL_IMPACT_S)
    assert found.validity["impact_ratios"] == pytest.approx(model.validity["impact_ratios"], abs=budget.SMALL_RATIO)


@pytest.mark.parametrize(
    ("floor", "dt_s", "budget_rad"),
    [
        (BaseExcitation(x=Harmonic(4.0, 2.0)), 2.5e-4, budget.MOVED_ASIDE_RAD),
        (
            BaseExcitation(x=Pulse("one_sine", 4.0, 0.6, 0.02), z=Pulse("one_sine", 4.0, 0.4, 0.05)),
            1e-3,
            budget.MOVED_UP_RAD,
        ),
    ],
)
def test_impacts_on_a_table_that_moves_are_met_where_it_is_then(
    floor: BaseExcitation, dt_s: float, budget_rad: float
) -> None:
    on = replace(scene(rectangle(0.3, 1.2), duration_s=0.8), base_excitation=floor)
    assert error("pymunk", replace(on, table="moving"), dt_s) <= budget_rad


def test_slow_impacts_are_met_too() -> None:
    # Rocking of tenths of a milliradian, at a hundredth of a radian a second.
    on = scene(rectangle(0.2, 1.0), theta_rad=2e-4, duration_s=0.12)
    model = exact(on)
    assert run("pymunk", on, 5e-4).interventions["impact"].count == len(model.impact_times_s) > 3
    assert error("pymunk", on, 5e-4) <= budget.SLOW_IMPACTS_RAD


def test_a_vertex_that_an_approach_has_stopped_is_taken_nowhere(data_dir: Path) -> None:
    # At 10.375 s a part of micro-rocking ends with all at rest: contact was then 1e13 s ahead, and the statue went
    # into the pedestal.
    west = {
        "kind": "record",
        "file": str(data_dir / "records/coalinga1983_PFZ14.csv"),
        "column": "a_90_ms2",
        "unit": "m/s2",
    }
    statue = {"mesh": {"file": "togatus.ply", "unit": "m", "density_kg_m3": 2700.0}}
    content = {"title": "micro-rocking", "statue": statue, "pedestal": PEDESTAL, "contact": TWO, "motion": {"x": west}}
    on = BaseScene(SCENES / "scene.toml", {**content, "duration_s": 10.5}).scene({})
    found, model = run("pymunk", on, 1e-3), exact(on)
    assert found.history is not None
    assert model.history is not None
    assert found.interventions["impact"].count > 15
    assert error("pymunk", on, 1e-3) <= budget.STICK_ONSET_RAD
    times = np.linspace(0.0, on.duration_s, 500)
    slips = [np.interp(times, history.t_s, history.slip_m) for history in (found.history, model.history)]
    assert np.max(np.abs(slips[0] - slips[1])) <= budget.STICK_ONSET_M


def squat() -> Scene:
    """A block as half as wide as high that rocks, slides and meets its pedestal once."""
    motion = Pulse("one_sine", 0.8 * GRAVITY_M_S2, 1.2, 0.0)
    pedestal = Pedestal(500.0, 3.0, 0.5, 0.3)
    return scene(rectangle(1.5, 2.9), motion, pedestal=pedestal, mu=0.6, mu_statue=2.0, duration_s=1.5)


def test_slip_beside_rocking_errs_at_second_order() -> None:
    on = squat()
    coarse, fine = (
        apart(run("pymunk", on, 2e-3), exact(on), "slip_m"),
        apart(run("pymunk", on, 2.5e-4), exact(on), "slip_m"),
    )
    assert fine <= budget.SLIP_BESIDE_ROCKING_M
    assert math.log(coarse / fine, 8.0) >= budget.SLIP_ORDER


@pytest.mark.parametrize("pedestal", [True, False])
def test_a_statue_that_holds_does_not_walk_over_its_support(pedestal: bool) -> None:
    on = squat() if pedestal else replace(squat(), pedestal=None)
    assert run("pymunk", on, 1e-3).validity["statue_slip_m"] <= budget.STATUE_WALK_M


def test_a_start_with_a_rate_has_its_momentum() -> None:
    pedestal = Pedestal(300.0, 0.6, 0.5, 0.1)
    on = scene(rectangle(0.4, 1.0), theta_rate_rad_s=-1.0, pedestal=pedestal, mu=0.1, mu_statue=2.0, duration_s=1.2)
    assert apart(run("pymunk", on, 2.5e-4), exact(on), "slip_m") <= budget.THROWN_SLIP_M


def test_a_run_in_the_layers_domain_says_that_no_step_was_plain() -> None:
    validity = run("pymunk", squat(), 1e-3).validity
    assert (validity["plain_from_s"], validity["plain_for_s"], validity["plain_because"]) == (None, 0.0, [])


def test_a_statue_that_slips_at_its_impact_says_so() -> None:
    # Thrown to one side, it meets its support where friction does not bear the impact, not before.
    on = scene(rectangle(0.7, 1.0), theta_rad=0.1, mu_statue=0.45, duration_s=0.6)
    found = run("pymunk", on, 1e-3)
    assert found.validity["plain_because"] == ["statue_slides"]
    assert found.validity["plain_from_s"] == pytest.approx(found.impact_times_s[0], abs=budget.TWO_STEPS_S)
    assert 0.0 < found.validity["plain_for_s"] < 0.5 * found.end_s
