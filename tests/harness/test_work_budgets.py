"""How much work a run may do: counted, never timed, so that a slow machine passes and a lost short cut fails."""

from __future__ import annotations

import subprocess
import sys
import tracemalloc
from dataclasses import replace

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
    assert run.work["events"] <= run.steps, "events without steps would be found by a search of their own"


@pytest.mark.parametrize(("name", "spare"), [("pymunk", budgets.SPARE), ("pybullet", budgets.SPARE_SUBSTEPS)])
def test_steps_of_a_contact_engine(forced: Scene, name: str, spare: float) -> None:
    engine = engines.load(name)
    if engine.missing():
        pytest.skip(engine.missing() or "")
    run = engine.simulate(forced, engine.settings_for_dt(forced, STEP_S), NONE)
    steps = forced.duration_s / STEP_S
    assert steps <= run.steps + 1
    assert run.steps <= spare * steps


def test_a_target_accuracy_takes_few_runs() -> None:
    scene = scene_of("easy", {"duration_s": 0.5, "statue": PAESTUM, "motion": harmonic(0.2, 3.0)})
    run = run_to_accuracy(engines.load("pymunk"), scene, 1e-3, Want())
    assert 2 <= run.work["runs"] <= budgets.ACCURACY_RUNS
    assert run.work["steps_of_all_runs"] >= run.steps


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


def test_help_imports_no_simulator() -> None:
    code = "import sys, reports.cli; print(len(sys.modules)); print(*sys.modules)"
    count, names = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout.split("\n", 1)
    loaded = set(names.split())
    assert not loaded & {"pybullet", "pymunk", "mujoco", "numba", "trimesh", "scipy", "matplotlib", "plotly"}
    assert int(count) <= budgets.MODULES_OF_HELP


def pulse(duration_s: float = 6.0) -> Scene:
    shaken = {"x": {"kind": "pulse", "shape": "one_sine", "amplitude_g": 0.28, "duration_s": 0.5}}
    return scene_of("pulse", {"duration_s": duration_s, "statue": COLUMN, "motion": shaken})


@pytest.mark.parametrize("name", ["analytic", "pymunk", "pybullet"])
def test_a_quiet_end_is_not_integrated_and_changes_nothing(name: str) -> None:
    engine = engines.load(name)
    if engine.missing():
        pytest.skip(engine.missing() or "")
    scene = pulse(12.0)
    settings = engine.ladder(scene)[1]
    on = engine.simulate(scene, settings, Want())
    off = engine.simulate(scene, settings, Want(skips=frozenset(SKIPS) - {"quiet_end", "quiet_start"}))
    assert on.outcome is off.outcome
    assert on.peak_theta_rad == off.peak_theta_rad, "the skip begins after the peak: the peak is the same bit for bit"
    assert on.steps < off.steps or name == "analytic"


@pytest.mark.parametrize("name", ["analytic", "pymunk", "pybullet"])
def test_a_quiet_start_is_not_integrated_and_changes_nothing(name: str) -> None:
    engine = engines.load(name)
    if engine.missing():
        pytest.skip(engine.missing() or "")
    from analytic.excitation import Record
    from harness.scene import Shake

    t = np.arange(401) * 0.01
    late = 0.35 * 9.81 * np.sin(2.0 * np.pi * 2.0 * t) * (t >= 3.0)
    late[t < 3.0] = 0.05 * np.sin(2.0 * np.pi * 2.0 * t[t < 3.0])
    scene = replace(pulse(4.0), shake=Shake(x=Record(t, late)))
    # The coarsest rung that is expected to resolve what the skip may change: a coarser one differs by its own error.
    settings = next(rung for rung in engine.ladder(scene) if rung.expected_error_rad <= budgets.SKIP_RAD)
    on = engine.simulate(scene, settings, Want())
    off = engine.simulate(scene, settings, Want(skips=frozenset(SKIPS) - {"quiet_start"}))
    assert on.outcome is off.outcome
    allowed = budgets.SAME_RAD if name == "analytic" else budgets.SKIP_RAD
    assert abs(on.peak_theta_rad - off.peak_theta_rad) <= allowed
    assert on.steps < off.steps


def test_the_energy_decides_as_the_integration_does() -> None:
    engine = engines.load("analytic")
    scene = pulse(30.0)
    settings = engine.ladder(scene)[-1]
    on = engine.simulate(scene, settings, Want(history=False))
    off = engine.simulate(scene, settings, Want(history=False, skips=frozenset(SKIPS) - {"energy_outcome"}))
    assert on.outcome is off.outcome
    assert on.steps < off.steps


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
