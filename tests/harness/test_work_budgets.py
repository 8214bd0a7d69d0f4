"""How much work a run may do: counted, never timed, so that a slow machine passes and a lost short cut fails."""

from __future__ import annotations

import subprocess
import sys
import tracemalloc

import numpy as np
import pytest

from harness import engines
from harness.benchmark.scenes import COLUMN, PAESTUM, PEDESTAL, harmonic, scene_of
from harness.engine import SKIPS, Want
from harness.scene import Scene
from harness.uncertainty import run_to_accuracy
from tests import budgets_bench as budgets

NONE = Want(skips=frozenset())
STEP_S = 2.5e-4


@pytest.fixture(scope="module")
def forced() -> Scene:
    content = {"duration_s": 1.0, "statue": PAESTUM, "pedestal": PEDESTAL, "motion": harmonic(0.429, 3.0)}
    return scene_of("forced", content)


def test_steps_of_the_analytic_model(forced: Scene) -> None:
    engine = engines.load("analytic")
    run = engine.simulate(forced, engine.ladder(forced)[-1], NONE)
    assert 0 < run.steps <= budgets.ANALYTIC_STEPS
    assert 0 < run.work["taylor_coefficients"] <= budgets.ANALYTIC_TERMS
    assert run.work["events"] <= run.steps, "events without steps would be found by a search of their own"
    capped = engine.simulate(forced, engine.settings_for_dt(forced, 0.01), NONE)
    assert capped.steps > budgets.ANALYTIC_STEPS, "the budget does not see shorter steps: it sees nothing"
    assert capped.work["taylor_coefficients"] > budgets.ANALYTIC_TERMS


@pytest.mark.parametrize(("name", "spare"), [("pymunk", budgets.SPARE), ("pybullet", budgets.SPARE_SUBSTEPS)])
def test_steps_of_a_contact_engine(forced: Scene, name: str, spare: float) -> None:
    engine = engines.load(name)
    if engine.missing():
        pytest.skip(engine.missing() or "")
    run = engine.simulate(forced, engine.settings_for_dt(forced, STEP_S), NONE)
    steps = forced.duration_s / STEP_S
    assert steps <= run.steps + 1
    assert run.steps <= spare * steps
    half = engine.simulate(forced, engine.settings_for_dt(forced, 0.5 * STEP_S), NONE)
    assert half.steps > spare * steps, "the budget does not see steps of half the length: it sees nothing"


def test_a_target_accuracy_takes_few_runs() -> None:
    scene = scene_of("easy", {"duration_s": 0.5, "statue": PAESTUM, "motion": harmonic(0.2, 3.0)})
    run = run_to_accuracy(engines.load("pymunk"), scene, 1e-3, Want())
    assert 2 <= run.work["runs"] <= budgets.ACCURACY_RUNS
    assert run.steps <= run.work["steps_of_all_runs"] <= budgets.ACCURACY_STEPS
    finer = run_to_accuracy(engines.load("pymunk"), scene, 1e-4, Want())
    assert finer.work["steps_of_all_runs"] > budgets.ACCURACY_STEPS, "the budget does not see a finer rung"


def test_an_outcome_allocates_no_history(forced: Scene) -> None:
    engine = engines.load("analytic")
    longer = forced.but(duration_s=20.0)
    sizes = {}
    for history in (False, True):
        engine.simulate(longer, engine.ladder(longer)[0], Want(history=history))
        tracemalloc.start()
        engine.simulate(longer, engine.ladder(longer)[0], Want(history=history))
        sizes[history] = tracemalloc.get_traced_memory()[1] / 1024.0
        tracemalloc.stop()
    assert sizes[False] <= budgets.OUTCOME_ALLOCATED_KB
    assert sizes[True] > budgets.OUTCOME_ALLOCATED_KB, "the budget does not see a history of 20 s: it sees nothing"


def modules(*more: str) -> set[str]:
    """What a fresh interpreter has loaded to answer --help, and with further modules."""
    code = f"import sys, {', '.join(('reports.cli', *more))}; print(*sys.modules)"
    return set(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split())


def test_help_imports_no_simulator() -> None:
    loaded = modules()
    assert not loaded & {"pybullet", "pymunk", "mujoco", "numba", "trimesh", "scipy", "matplotlib", "plotly"}
    assert len(loaded) <= budgets.MODULES_OF_HELP
    assert len(modules("scipy.integrate")) > budgets.MODULES_OF_HELP, (
        "the budget does not see a library: it sees nothing"
    )


def test_a_fallen_statue_is_not_integrated_and_changes_nothing() -> None:
    engine = engines.load("pymunk")
    scene = scene_of("falls", {"duration_s": 8.0, "statue": COLUMN, "motion": harmonic(0.6, 1.0)})
    settings = engine.ladder(scene)[0]
    on = engine.simulate(scene, settings, Want())
    off = engine.simulate(scene, settings, Want(skips=frozenset(SKIPS) - {"stop_at_overturn"}))
    assert on.outcome is off.outcome
    assert on.outcome.overturned
    assert on.history is not None
    assert off.history is not None
    assert np.array_equal(on.history.theta_rad, off.history.theta_rad)
    assert on.steps < 0.5 * off.steps
