"""What every engine owes, driven by the flags that it declares."""

import contextlib
import gc
import resource
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analytic.excitation import Harmonic
from harness import InputError, Outcome, Scene, engines
from harness.accuracy.refinement import run_to_accuracy
from harness.engines.base import Engine, EngineFailure, Settings
from harness.model import SKIPS, Run, RunOptions
from harness.records.base import plain
from tests import budgets_engines as budget
from tests.measures.seeded_scenes import wide_scene
from tests.scenes_for_tests import GRAVITY_M_S2, PAESTUM, paestum, scene

NAMES = tuple(engines.REGISTRY)
STEP_S = 1e-3
REFUSE_A_RATIO = {"pymunk:plain", "pybullet:plain", "spatial"}


@pytest.fixture(params=NAMES)
def engine(request: pytest.FixtureRequest) -> Engine:
    """Each engine of the registry, skipped with its own reason where it cannot run."""
    found = engines.load(request.param)
    reason = found.missing()
    if reason is not None:
        pytest.skip(reason)
    return found


def run(engine: Engine, on: Scene, options: RunOptions | None = None) -> Run:
    return engine.simulate(on, engine.settings_for_dt(on, STEP_S), options or RunOptions())


def shaken(engine: Engine, *args: float, pedestal: bool = True, **scene_is: Any) -> Scene:
    """The surveyed statue, on its pedestal if it is asked for and the engine takes one."""
    return paestum(*args, pedestal=pedestal and engine.capabilities.pedestal, **scene_is)


def test_name_is_that_of_the_registry(engine: Engine) -> None:
    assert engines.load(engine.name).name == engine.name


@pytest.mark.parametrize("name", ["analytics", "analytic,pymunk", ["analytic"], None])
def test_what_names_no_engine_is_refused(name: str) -> None:
    with pytest.raises(InputError, match=r"^--engine: "):
        engines.load(name)


def test_a_worker_says_why_it_knows_no_engine_of_a_script(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("multiprocessing.parent_process", object)
    with pytest.raises(InputError, match=r"got 'mine' .*jobs=1"):
        engines.load("mine")


def test_a_text_is_one_name() -> None:
    assert engines.asked("analytic", engines.DEFAULT_ENGINES) == ["analytic"]
    assert engines.asked(["pymunk", "analytic", "pymunk"], ()) == ["pymunk", "analytic"]
    assert engines.asked(None, ("pymunk",)) == engines.asked([], ("pymunk",)) == ["pymunk"]


def test_levels_go_from_coarse_to_fine(engine: Engine) -> None:
    levels = engine.refinement_levels(shaken(engine))
    assert len(levels) >= 2
    assert all(a.expected_error_rad > b.expected_error_rad for a, b in pairwise(levels))
    assert all(a.dt_s >= b.dt_s for a, b in pairwise(levels))
    assert engine.verification_settings(shaken(engine), levels[0])


def test_settings_of_another_engine_are_refused(engine: Engine) -> None:
    on = shaken(engine)
    with pytest.raises(EngineFailure, match=rf"^{engine.name} .*Settings"):
        engine.simulate(on, Settings(1e-3, 1e-9), RunOptions())


def test_history_is_on_the_output_grid(engine: Engine) -> None:
    on = shaken(engine, 0.429, 3.0, duration_s=0.3005, output_dt_s=0.002)
    history = run(engine, on).history
    np.testing.assert_allclose(history.t_s[:-1], np.arange(151) * 0.002, atol=1e-12)
    assert history.t_s[-1] == pytest.approx(0.3005, abs=1e-12)


@pytest.mark.parametrize("pedestal", [False, True])
def test_same_scene_same_bits_whatever_ran_before(engine: Engine, pedestal: bool) -> None:
    on = shaken(engine, 0.429, 3.0, pedestal=pedestal, mu=(0.20, 0.15), duration_s=0.3)
    first = run(engine, on)
    run(engine, scene(PAESTUM, Harmonic(6.0, 1.0), theta_rad=0.05, duration_s=0.1))
    with contextlib.suppress(EngineFailure):
        run(engine, shaken(engine, 0.334, 2.0, pedestal=not pedestal, mu=0.5, duration_s=0.1, restitution=0.85))
    again = run(engine, on)
    assert first.history is not None
    assert again.history is not None
    for name, values in first.history.columns().items():
        np.testing.assert_array_equal(values, again.history.columns()[name], err_msg=name)


def test_record_is_plain_and_labelled(engine: Engine) -> None:
    found = run(engine, shaken(engine, 0.429, 3.0, duration_s=0.3))
    assert found.engine == engine.name
    assert found.outcome is Outcome.STANDS
    assert found.steps > 0
    assert found.settings["dt_s"] >= 0.0
    assert found.patterns
    assert found.patterns[0].start_s == 0.0
    assert all(a.end_s == pytest.approx(b.start_s, abs=5e-3) for a, b in pairwise(found.patterns))
    assert "engine" in plain(found)


def test_only_the_outcome_leaves_no_history(engine: Engine) -> None:
    on = shaken(engine, 0.429, 3.0, duration_s=0.3)
    short = run(engine, on, RunOptions(history=False))
    assert short.history is None
    whole = run(engine, on, RunOptions(history=False, skips=frozenset(SKIPS) - {"no_history"}))
    assert whole.outcome is short.outcome


def test_a_stopped_run_is_the_beginning_of_the_whole_one(engine: Engine) -> None:
    on = shaken(engine, 0.429, 3.0, duration_s=1.5)
    whole, stopped = run(engine, on).history, run(engine, on, RunOptions(stop=lambda t_s, theta_rad: t_s > 0.3)).history
    assert engine.capabilities.certifies or stopped.duration_s < 1.0
    # The last samples wait for a step beyond them.
    inside = stopped.t_s < stopped.duration_s - 2.0 * STEP_S
    np.testing.assert_array_equal(stopped.theta_rad[inside], whole.theta_rad[: stopped.t_s.size][inside])


def test_overturning_ends_the_run_and_is_told_by_its_side(engine: Engine) -> None:
    for sign, outcome in ((1.0, Outcome.OVERTURNED_RIGHT), (-1.0, Outcome.OVERTURNED_LEFT)):
        side = 1 if sign > 0.0 else -1
        on = scene(PAESTUM, theta_rad=sign * 1.05 * PAESTUM.slenderness_rad(side), duration_s=6.0)
        found = run(engine, on)
        assert found.outcome is outcome
        assert found.overturn_time_s == found.end_s
        assert found.end_s < 6.0


def test_accuracy_is_stated(engine: Engine) -> None:
    on = shaken(engine, 0.334, 3.0, pedestal=False, duration_s=0.5)
    found = run_to_accuracy(engine, on, 2e-3, RunOptions())
    assert found.numerical_uncertainty_rad <= 2e-3
    assert found.reliable_until_s is not None


def test_a_prescribed_impact_is_labelled_by_whoever_has_its_own(engine: Engine) -> None:
    asked = shaken(engine, 0.429, 3.0, mu=0.15, restitution=0.85, duration_s=0.6)
    if engine.name in REFUSE_A_RATIO:
        with pytest.raises(EngineFailure, match=r"contact\.restitution"):
            run(engine, asked)
        return
    labelled = any("imposed" in label for label in run(engine, asked).labels)
    assert labelled == engine.capabilities.own_impact


def test_forces_are_recorded_where_declared(engine: Engine) -> None:
    history = run(engine, shaken(engine, 0.429, 3.0, duration_s=0.3)).history
    found = [name for name in history.extra if name.endswith("_n")]
    assert bool(found) >= engine.capabilities.forces


def test_a_moving_table_where_declared(engine: Engine) -> None:
    if not engine.capabilities.moving_table:
        pytest.skip(f"{engine.name} moves the frame only")
    on = shaken(engine, 0.429, 3.0, pedestal=False, duration_s=0.5)
    fine = engine.settings_for_dt(on, 2.5e-4)
    a, b = (engine.simulate(item, fine, RunOptions()).history for item in (on, replace(on, table="moving")))
    assert np.max(np.abs(a.theta_rad - b.theta_rad)) <= budget.MOVING_TABLE_RAD


@pytest.mark.parametrize("seed", [507, 606, 615])
@pytest.mark.parametrize("name", ["pymunk", "pybullet"])
def test_a_pedestal_slides_on_a_moving_table_as_in_its_frame(name: str, seed: int) -> None:
    """By 1 to 15 cm more where a run begins on a table that has its velocity by then (606, 615), and by 5 mm where a step is made
    twice as friction gives way in it, and the table has gone on in the first (507)."""
    engine = engines.load(name)
    if (reason := engine.missing()) is not None:
        pytest.skip(reason)
    on = replace(wide_scene(seed), duration_s=2.0)
    coarse = engine.settings_for_dt(on, STEP_S)
    a, b = (engine.simulate(item, coarse, RunOptions()).history for item in (on, replace(on, table="moving")))
    assert np.max(np.abs(a.slip_m - b.slip_m)) <= budget.MOVING_TABLE_SLIP_M


def test_a_pedestal_is_taken_where_declared(engine: Engine) -> None:
    on = paestum(0.429, 3.0, duration_s=0.05)
    if engine.capabilities.pedestal:
        assert run(engine, on).outcome is Outcome.STANDS
        return
    with pytest.raises(EngineFailure, match=f"^{engine.name} .* pedestal"):
        run(engine, on)


def test_statue_slips_where_declared(engine: Engine) -> None:
    if not engine.capabilities.statue_slips:
        pytest.skip(f"{engine.name} holds the statue on its support")
    on = scene(PAESTUM, Harmonic(0.4 * GRAVITY_M_S2, 2.0), mu_statue=0.1, duration_s=0.3)
    history = run(engine, on).history
    assert np.max(np.abs(history.extra["statue_slip_m"])) > 1e-2


def test_no_memory_is_kept(engine: Engine) -> None:
    on = shaken(engine, 0.429, 3.0, duration_s=0.02)
    for _ in range(20):
        run(engine, on)
    gc.collect()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for _ in range(60):
        run(engine, on)
    gc.collect()
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    assert grown / 60 < budget.KEPT_KIB, f"{grown / 60:.1f} KiB a run"


@pytest.mark.parametrize("name", NAMES)
def test_loading_an_engine_loads_no_other_simulator(name: str, root: Path) -> None:
    foreign = sorted({"pymunk", "pybullet"} - {name.removesuffix(":plain")})
    code = (
        "import sys; from harness import engines; "
        f"engines.load({name!r}); print([m for m in {foreign!r} if m in sys.modules])"
    )
    told = subprocess.run([sys.executable, "-c", code], cwd=root, capture_output=True, text=True, check=True)
    assert told.stdout.strip() == "[]"
