"""How much work a run may do: counted, never timed, so that a slow machine passes and a lost short cut fails."""

import subprocess
import sys
import tracemalloc
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness import Scene, engines
from harness.accuracy.refinement import run_to_accuracy
from harness.model import SKIPS, RunOptions
from harness.questions.bench.standard_scenes import COLUMN, PAESTUM, PEDESTAL, harmonic, scene_of
from tests import budgets_bench as budgets
from tests import doubles
from tests.engines_for_tests import ready

NONE = RunOptions(skips=frozenset())
STEP_S = 2.5e-4


@pytest.fixture(scope="module")
def forced() -> Scene:
    content = {"duration_s": 1.0, "statue": PAESTUM, "pedestal": PEDESTAL, "motion": harmonic(0.429, 3.0)}
    return scene_of("forced", content)


def test_steps_of_the_analytic_model(forced: Scene) -> None:
    engine = engines.load("analytic")
    run = engine.simulate(forced, engine.refinement_levels(forced)[-1], NONE)
    assert 0 < run.steps <= budgets.ANALYTIC_STEPS
    assert 0 < run.work["taylor_coefficients"] <= budgets.ANALYTIC_TERMS
    assert run.work["events"] <= run.steps, "events without steps would be found by a search of their own"
    capped = engine.simulate(forced, engine.settings_for_dt(forced, 0.01), NONE)
    assert capped.steps > budgets.ANALYTIC_STEPS, "the budget does not see shorter steps: it sees nothing"
    assert capped.work["taylor_coefficients"] > budgets.ANALYTIC_TERMS


@pytest.mark.parametrize("name", ["pymunk", "pybullet"])
def test_steps_of_a_contact_engine(forced: Scene, name: str) -> None:
    engine = ready(name)
    run = engine.simulate(forced, engine.settings_for_dt(forced, STEP_S), NONE)
    steps = forced.duration_s / STEP_S
    assert steps <= run.steps + 1
    assert run.steps <= budgets.SPARE * steps
    assert 0 < run.interventions["friction_release"].steps_again <= budgets.REPEATED[name]
    shorter = engine.simulate(forced, engine.settings_for_dt(forced, 0.9 * STEP_S), NONE)
    assert shorter.steps > budgets.SPARE * steps, "the budget does not see steps a tenth shorter: it sees nothing"


@pytest.mark.parametrize("name", ["pymunk", "pybullet"])
def test_a_target_accuracy_takes_few_runs_steps_and_iterations(name: str) -> None:
    engine = ready(name)
    scene = scene_of("easy", {"duration_s": 0.5, "statue": PAESTUM, "motion": harmonic(0.2, 3.0)})
    run = run_to_accuracy(engine, scene, 1e-3, RunOptions())
    assert 2 <= run.work["runs"] <= budgets.ACCURACY_RUNS
    assert run.steps <= run.work["steps_of_all_runs"] <= budgets.ACCURACY_STEPS
    assert run.work["steps_of_all_runs"] * run.settings["iterations"] <= budgets.MOST_ITERATIONS[name]
    finer = run_to_accuracy(engine, scene, 1e-5, RunOptions())
    assert finer.work["steps_of_all_runs"] > budgets.ACCURACY_STEPS, "the budget does not see a finer level"


@pytest.mark.parametrize("name", ["pymunk", "pybullet"])
def test_a_target_that_no_level_is_expected_to_meet_is_given_up_early(forced: Scene, name: str) -> None:
    engine = ready(name)
    finest = engine.refinement_levels(forced)[-1]
    run = run_to_accuracy(engine, forced, 0.1 * finest.expected_error_rad, RunOptions())
    finest_steps = forced.duration_s / finest.dt_s
    both = finest_steps + sum(forced.duration_s / each.dt_s for each in engine.verification_settings(forced, finest))
    assert run.work["steps_of_all_runs"] <= budgets.GIVEN_UP_SHARE[name] * both
    assert {"target_met_until", "target_not_resolved"} & set(doubles.codes(run.findings))
    assert run.numerical_uncertainty_rad > 0.1 * finest.expected_error_rad or run.bounded_until_s < run.end_s


@pytest.mark.parametrize(("name", "duration_s"), [("analytic", 20.0), ("pymunk", 2.0), ("pybullet", 2.0)])
def test_an_outcome_allocates_no_history(forced: Scene, name: str, duration_s: float) -> None:
    engine = ready(name)
    longer = replace(forced, duration_s=duration_s)
    sizes = {}
    for history in (False, True):
        options = RunOptions(history=history)
        engine.simulate(longer, engine.refinement_levels(longer)[0], options)
        tracemalloc.start()
        engine.simulate(longer, engine.refinement_levels(longer)[0], options)
        sizes[history] = tracemalloc.get_traced_memory()[1] / 1024.0
        tracemalloc.stop()
    assert sizes[False] <= budgets.OUTCOME_ALLOCATED_KB[name]
    assert sizes[True] > budgets.OUTCOME_ALLOCATED_KB[name], "the budget does not see a history: it sees nothing"


HEAVY = {"pybullet", "pymunk", "numba", "llvmlite", "trimesh", "scipy", "matplotlib", "vl_convert", "jinja2"}
"""Libraries that cost a tenth of a second or more to import."""
NEEDED = {"pymunk": {"pymunk", "llvmlite"}, "pybullet": {"pybullet", "scipy", "llvmlite"}, "analytic": {"llvmlite"}}
"""Those of them that a run of one engine needs: over still ground its end is asked of the model's own rule."""
RUN = """
from harness.accuracy.refinement import simulate
from harness.questions.bench.standard_scenes import COLUMN, harmonic, scene_of
simulate(scene_of("short", {{"duration_s": 0.1, "statue": COLUMN, "motion": harmonic(0.3, 2.0)}}), "{name}")
"""


def modules(code: str) -> set[str]:
    """What a fresh interpreter has loaded after some code, counted alike whatever else is installed.

    NumPy's Fortran wrapper, which SciPy loads, takes charset_normalizer where it is installed.
    """
    without = "import sys\nsys.modules['charset_normalizer'] = None"
    command = [sys.executable, "-c", f"{without}\n{code}\nimport sys\nprint(*sys.modules)"]
    return set(subprocess.run(command, capture_output=True, text=True, check=True).stdout.split())


def test_help_imports_no_simulator() -> None:
    loaded = modules("import reports.cli")
    assert not loaded & HEAVY
    later = budgets.MODULES_OF_LATER_PYTHON if sys.version_info >= (3, 12) else 0
    assert len(loaded) <= budgets.MODULES_OF_HELP + later
    more = modules("import reports.cli, scipy.integrate")
    assert len(more) > budgets.MODULES_OF_HELP, "the budget does not see a library: it sees nothing"


@pytest.mark.parametrize("name", ["pymunk", "pybullet", "analytic"])
def test_a_run_imports_its_own_engine_only(name: str) -> None:
    ready(name)
    loaded = modules(RUN.format(name=name))
    assert loaded & HEAVY == NEEDED[name]
    assert len(loaded) <= budgets.MODULES_OF_RUN[name]


def command(*words: object) -> str:
    """The code of a command, in a process that goes on after it."""
    given = ["rockcheck", *map(str, words)]
    return f"sys.argv = {given!r}\nfrom reports.cli import main\ntry:\n    main()\nexcept SystemExit:\n    out = sys.stdout"


def test_a_run_of_two_engines_loads_few_of_our_modules(root: Path, tmp_path: Path) -> None:
    ready("pymunk")
    scene, out = root / "scenes" / "paestum_pedestal.toml", tmp_path / "run"
    loaded = modules(
        command("run", scene, "-e", "analytic", "-e", "pymunk", "-q", "--set", "duration_s=1.0", "--out", out)
    )
    assert (out / "conservator.html").is_file()
    own = [name for name in loaded if name.partition(".")[0] in ("analytic", "harness", "meshes", "reports")]
    assert len(own) <= budgets.OWN_MODULES_OF_RUN


def test_a_page_of_one_model_imports_no_geometry_of_space(root: Path, tmp_path: Path) -> None:
    scene, out = root / "scenes" / "free_rocking.toml", tmp_path / "run"
    loaded = modules(command("run", scene, "-e", "analytic", "-q", "--out", out))
    assert (out / "report.html").is_file()
    assert not loaded & {"scipy.spatial", "trimesh", "numba", "pybullet", "pymunk"}


def test_a_fallen_statue_is_not_integrated_and_changes_nothing() -> None:
    engine = engines.load("pymunk")
    scene = scene_of("falls", {"duration_s": 8.0, "statue": COLUMN, "motion": harmonic(0.6, 1.0)})
    settings = engine.refinement_levels(scene)[0]
    on = engine.simulate(scene, settings, RunOptions())
    off = engine.simulate(scene, settings, RunOptions(skips=frozenset(SKIPS) - {"stop_at_overturn"}))
    assert on.outcome is off.outcome
    assert on.outcome.overturned
    assert np.array_equal(on.history.theta_rad, off.history.theta_rad)
    assert on.steps < 0.5 * off.steps
