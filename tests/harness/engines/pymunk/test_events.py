"""pymunk's events inside a step: what converges once they are met where they are."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analytic.excitation import Harmonic, Pulse
from harness.engines.analytic import TwoBlock
from harness.engines.pymunk import Munk2D
from harness.model.run import Run, RunOptions
from harness.model.scene import BaseExcitation, Scene
from harness.questions.bench.standard_scenes import PEDESTAL, TWO
from harness.questions.study.cases import BaseScene
from tests import budgets_engines as budget
from tests.measures.seeded_scenes import random_scene
from tests.scenes_for_tests import SCENES, paestum, rectangle, scene

ENGINE, MODEL = Munk2D(), TwoBlock()


def run(on: Scene, dt_s: float) -> Run:
    return ENGINE.simulate(on, ENGINE.settings_for_dt(on, dt_s), RunOptions())


def error(on: Scene, dt_s: float, **changes: int) -> float:
    settings = replace(ENGINE.settings_for_dt(on, dt_s), **changes)
    found, exact = (
        ENGINE.simulate(on, settings, RunOptions()),
        MODEL.simulate(on, MODEL.refinement_levels(on)[1], RunOptions()),
    )
    times = np.linspace(0.0, min(found.end_s, exact.end_s), 500)
    return float(np.max(np.abs(found.history.at(times) - exact.history.at(times))))


def test_impacts_leave_no_error_of_first_order() -> None:
    on = scene(rectangle(0.2, 1.0), theta_rad=0.0987, duration_s=2.0)
    errors = [error(on, dt_s) for dt_s in (4e-3, 1e-3, 2.5e-4)]
    assert errors[1] <= budget.FREE_ROCKING_RAD
    assert math.log(errors[0] / errors[2], 16.0) >= budget.ORDER_WITH_IMPACTS


def test_impacts_of_small_rocking_are_told_where_they_are_and_with_their_ratios() -> None:
    """A lean of a milliradian moves the top by 1 mm."""
    on = scene(rectangle(0.2, 1.0), theta_rad=1e-3, duration_s=0.3)
    exact = MODEL.simulate(on, MODEL.refinement_levels(on)[1], RunOptions())
    found = run(on, 1.8e-3)
    assert found.impact_times_s == pytest.approx(exact.impact_times_s, abs=budget.SMALL_IMPACT_S)
    assert found.validity["impact_ratios"] == pytest.approx(exact.validity["impact_ratios"], abs=budget.SMALL_RATIO)


@pytest.mark.parametrize("dt_s", [1.7e-3, 1.3e-3, 1.1e-3, 9e-4, 7e-4])
def test_no_step_lets_go_of_the_standing_corner(dt_s: float) -> None:
    # Where a step between two impacts loses the contact, the statue falls freely in it and the next ratio is off by per cent.
    on = scene(rectangle(0.2, 1.0), theta_rad=0.0987, duration_s=2.0)
    assert error(on, dt_s) <= budget.FREE_ROCKING_ANY_STEP_RAD


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
    assert error(replace(on, table="moving"), dt_s) <= budget_rad


def test_a_fall_errs_at_second_order() -> None:
    on = scene(rectangle(0.2, 1.0), theta_rad=0.25, duration_s=0.6)
    assert math.log(error(on, 4e-3) / error(on, 5e-4), 8.0) >= budget.FALL_ORDER


def test_an_impact_right_after_a_stick_onset_is_met() -> None:
    # At 1 ms the pedestal sticks at 0.885 s and the impact comes within the next two steps.
    on = paestum(0.44, 4.5, mu=(0.20, 0.15), duration_s=1.0)
    assert error(on, 1e-3) <= budget.IMPACT_AFTER_STICK_ONSET_RAD


def test_slow_impacts_are_met_too() -> None:
    # Rocking of tenths of a milliradian, at a hundredth of a radian a second.
    on = scene(rectangle(0.2, 1.0), theta_rad=2e-4, duration_s=0.12)
    exact = MODEL.simulate(on, MODEL.refinement_levels(on)[1], RunOptions())
    assert run(on, 5e-4).interventions["impact"].count == len(exact.impact_times_s) > 3
    assert error(on, 5e-4) <= budget.SLOW_IMPACTS_RAD


def test_static_friction_gives_way_inside_a_step() -> None:
    # Steps that are parts of each other begin at the same instants: an error of the first order would be common to all.
    on = paestum(0.334, 3.0, mu=(0.20, 0.15), duration_s=0.25)
    errors = [error(on, dt_s) for dt_s in (2e-3, 5e-4)]
    assert errors[1] <= budget.SLIP_ONSET_RAD
    assert errors[1] <= errors[0] / 4.0


@pytest.mark.parametrize("static", [0.15, 0.20])
def test_a_statue_that_turns_on_one_corner_needs_a_quarter_of_the_iterations(static: float) -> None:
    on = paestum(0.429, 3.0, mu=(static, 0.15))
    settings = ENGINE.settings_for_dt(on, 4e-3)
    assert settings.turning_iterations <= 0.3 * settings.iterations
    few, all_of_them = error(on, 4e-3), error(on, 4e-3, turning_iterations=settings.iterations)
    assert few <= budget.TURNING_SHARE * all_of_them
    assert error(on, 4e-3, turning_iterations=1) > 2.0 * few, "no step takes them"


def test_a_corner_that_reaches_its_friction_takes_all_iterations() -> None:
    # At a coefficient of 2 the solver turns normal impulse into friction and back: what is left grows from step to step.
    on = random_scene(19112, 1.19)
    settings = ENGINE.settings_for_dt(on, 2e-4)
    runs = [
        ENGINE.simulate(on, replace(settings, turning_iterations=n), RunOptions()) for n in (24, settings.iterations)
    ]
    times = np.linspace(1.1, 1.19, 50)
    few, all_of_them = (found.history.at(times) for found in runs if found.history is not None)
    np.testing.assert_allclose(few, all_of_them, rtol=0.0, atol=budget.TURNING_RAD)


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
    found, exact = run(on, 1e-3), MODEL.simulate(on, MODEL.refinement_levels(on)[1], RunOptions())
    assert found.history is not None
    assert exact.history is not None
    assert found.interventions["impact"].count > 15
    assert error(on, 1e-3) <= budget.STICK_ONSET_RAD
    times = np.linspace(0.0, on.duration_s, 500)
    slips = [np.interp(times, history.t_s, history.slip_m) for history in (found.history, exact.history)]
    assert np.max(np.abs(slips[0] - slips[1])) <= budget.STICK_ONSET_M
