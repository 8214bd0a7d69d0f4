"""Engines beside each other give what they give alone; a failure is a recorded outcome of its own engine."""

import time
from dataclasses import replace
from pathlib import Path
from threading import Event
from typing import Any, Never

import numpy as np
import pytest

from analytic.excitation import Harmonic
from analytic.machine_code import Entry
from harness import InputError, Outcome, Run, RunOptions, Scene, Verdict, engines, load_scene
from harness.accuracy import forecast
from harness.accuracy.refinement import RunTarget, check_target, simulate
from harness.engines.base import Engine, EngineFailure, Settings, own_failures
from harness.questions.scene import scene_run as run
from harness.questions.scene import witness as confirm
from harness.questions.scene.scene_run import run_scene, write_result
from harness.runs import task
from tests import doubles
from tests.scenes_for_tests import SCENES, paestum, rectangle, scene

needs_pybullet = pytest.mark.skipif(
    engines.load("pybullet").missing() is not None, reason="pybullet is not installed here"
)


@needs_pybullet
def test_a_process_of_its_own_changes_no_result(monkeypatch: pytest.MonkeyPatch) -> None:
    scene, began = paestum(0.3, 2.0, pedestal=False), []
    isolated = run.simulate_isolated

    def beside(given: Scene, name: str, *target: Any) -> Run:
        began.append(name)
        return isolated(given, name, *target)

    monkeypatch.setattr(run, "simulate_isolated", beside)
    alone = run_scene(scene, ["analytic", "pybullet"], dt_s=1e-3, apart=True)
    assert began == [], "it takes longer to start than the run"
    monkeypatch.setattr(forecast, "START_S", 0.0)
    apart = run_scene(scene, ["analytic", "pybullet"], dt_s=1e-3, apart=True)
    assert began == ["pybullet"]
    for name in ("analytic", "pybullet"):
        a, b = alone.runs[name].history, apart.runs[name].history
        assert np.array_equal(a.theta_rad, b.theta_rad)
    assert list(apart.runs) == list(alone.runs)


def test_runs_by_one_step_that_state_no_error_do_not_differ_by_their_models() -> None:
    """The answer said that they did, the pair's own sentence that their numerical errors are not stated."""
    scene = paestum(0.3, 2.0, pedestal=False, duration_s=0.6)
    result = run_scene(scene, ["analytic", "pymunk", "pymunk:plain"], dt_s=4e-3)
    scores = result.scores["pymunk_vs_pymunk:plain"]
    assert scores.findings[0].code == "pair_differs_unstated"
    assert {each.verdict for each in result.scores.values()} == {Verdict.UNBOUNDED}
    assert result.record().answer.code == "agree_until"


@pytest.mark.parametrize("across", [False, True])
def test_what_motion_each_engine_was_given_is_recorded(across: bool) -> None:
    scene = paestum(0.3, 2.0, pedestal=False, duration_s=0.3)
    shaken = replace(scene, base_excitation=replace(scene.base_excitation, y=Harmonic(2.0, 3.0))) if across else scene
    result = run_scene(shaken, ["analytic", "pymunk", "pybullet"], dt_s=1e-3)
    given = {name: tuple(run.motion_axes or ()) for name, run in result.runs.items() if not run.outcome.failed}
    expected = ("x", "y") if across else ("x",)
    assert given.pop("pybullet", expected) == expected
    assert given == {"analytic": ("x",), "pymunk": ("x",)}
    assert result.record().runs["analytic"].motion_axes == ("x",)
    told = "motion_not_given" in doubles.codes(result.findings())
    assert told is (across and not result.runs["pybullet"].outcome.failed)
    # It is said once of the model: by the pair, or where there is none by its run.
    assert ("motion_across_left_out" in doubles.codes(result.findings())) is (across and not told)


@pytest.mark.parametrize(
    ("name", "stored", "expected"),
    [
        pytest.param("pybullet", False, "pybullet, still", marks=needs_pybullet),
        ("spatial", True, "spatial, still"),
        ("spatial", False, "spatial, compiled first, once after an upgrade"),
    ],
)
def test_an_engine_that_works_on_beside_the_others_is_told(
    name: str, stored: bool, expected: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    awaited, said = Event(), []

    def slow(*given: object) -> Run:
        assert awaited.wait(10.0), "nobody said what is still at work"
        return simulate(scene, "analytic")

    def told(words: str) -> None:
        said.append(words)
        if words == expected:
            awaited.set()

    scene = paestum(0.3, 2.0, pedestal=False)
    monkeypatch.setattr(run, "simulate_isolated", slow)
    monkeypatch.setattr(forecast, "START_S", 0.0)
    simulate(scene, "analytic")  # the planar model is compiled by now
    monkeypatch.setattr(Entry, "is_stored", stored)
    run_scene(scene, ["analytic", name], dt_s=1e-3, apart=True, on_progress=told)
    assert said[:3] == ["analytic", name, expected]


def test_an_engine_that_is_not_here_is_an_outcome(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(type(engines.load("pymunk")), "missing", lambda self: "pymunk is not installed")
    result = run_scene(paestum(0.1, 2.0), ["analytic", "pymunk"])
    assert result.failed
    assert result.runs["pymunk"].outcome is Outcome.UNAVAILABLE
    assert result.scores == {}
    write_result(result, tmp_path / "out")
    assert not (tmp_path / "out" / "history_pymunk.csv").exists()


@pytest.mark.parametrize("where", ["simulate", "refinement_levels"])
def test_a_fault_of_one_engine_is_its_own_row(where: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever an engine raises, in its run or in what prepares it, the others' answers stand."""

    def fault(*arguments: object) -> Never:
        raise ValueError("no such shape")

    guarded = own_failures("pymunk")(fault) if where == "simulate" else fault
    monkeypatch.setattr(type(engines.load("pymunk")), where, guarded)
    result = run_scene(scene(rectangle(0.2, 1.0), theta_rad=0.05), ("analytic", "pymunk"), accuracy_rad=1e-3)
    assert result.runs["pymunk"].outcome is Outcome.CRASHED
    assert "no such shape" in result.runs["pymunk"].message
    assert result.runs["analytic"].outcome is Outcome.STANDS
    assert result.failed


def test_a_class_of_engines_lets_out_nothing_but_its_failures() -> None:
    class Faulty(Engine):
        name = "faulty"

        def simulate(self, scene: Scene, settings: Settings, options: RunOptions) -> Run:
            raise IndexError("three of two")

    with pytest.raises(EngineFailure, match="three of two"):
        Faulty.simulate(engines.load("pymunk"), paestum(), Settings(1e-3, 1e-3), RunOptions())  # type: ignore[arg-type]


def test_an_old_result_is_replaced_whole(tmp_path: Path) -> None:
    scene = paestum(0.1, 2.0)
    write_result(run_scene(scene, ["analytic", "pymunk"]), tmp_path)
    write_result(run_scene(scene, ["analytic"]), tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["history_analytic.csv", "result.json"]


@pytest.mark.parametrize(("accuracy", "dt"), [(1e-3, 1e-3), (0.0, None), (1.0, None), (None, 0.0), (None, 1.0)])
def test_a_target_out_of_range_is_a_mistake(accuracy: float | None, dt: float | None) -> None:
    with pytest.raises(InputError, match="wanted"):
        check_target(accuracy, dt)


def test_an_unknown_engine_names_the_nearest() -> None:
    with pytest.raises(InputError, match=r"got 'pymonk' .* pymunk\?"):
        simulate(paestum(0.1, 2.0), "pymonk")
    with pytest.raises(InputError, match=r"got 'pymunk,spatial' .* -e "):
        simulate(paestum(0.1, 2.0), "pymunk,spatial")


@pytest.mark.parametrize(
    ("off", "chance", "again", "whole"),
    [(3e-3, True, True, True), (3e-3, False, True, False), (0.5, True, False, False), (1e-4, True, False, False)],
)
def test_a_difference_of_models_is_confirmed_by_a_finer_run_up_to_it(
    monkeypatch: pytest.MonkeyPatch, off: float, chance: bool, again: bool, whole: bool
) -> None:
    """Two runs of an engine that agreed by chance are not a difference of models; one far beyond all chance is not run again.

    Only a difference that a finer target takes away costs a whole finer run.
    """
    history = doubles.rocking()
    asked: list[tuple[str, float | None, float]] = []

    def answer(engine: Engine, scene: Scene, target: RunTarget) -> Run:
        asked.append((engine.name, target.accuracy_rad, scene.duration_s))
        wrong = engine.name == "pymunk" and (target.accuracy_rad is None or not chance)
        path = doubles.raised(history, off) if wrong else history
        known = {"numerical_uncertainty_rad": 1e-4, "slip_uncertainty_m": 1e-4, "reliable_until_s": 10.0}
        return doubles.run_of(path, engine.name, settings={"expected_error_rad": 1e-4}, **known)

    monkeypatch.setattr(run, "simulate_with", answer)
    monkeypatch.setattr(confirm, "simulate_with", answer)
    monkeypatch.setattr(run, "_horizons", lambda *args, **options: {})
    scene = replace(paestum(), duration_s=10.0)
    result = run_scene(scene, ["analytic", "pymunk"])
    finer = [(name, duration_s) for name, accuracy_rad, duration_s in asked if accuracy_rad is not None]
    assert all(name == "pymunk" for name, _ in finer), "a model that certifies its own error is sure of it"
    ends_s = [duration_s for _, duration_s in finer]
    assert len(ends_s) == again + whole
    assert all(end_s < 0.5 * scene.duration_s for end_s in ends_s[:again])
    assert ends_s[again:] == [scene.duration_s] * whole
    verdict = result.scores["analytic_vs_pymunk"].verdict
    assert verdict is (Verdict.MODEL if off > 0.1 or not chance else Verdict.AGREE)
    assert ("refined_for_comparison" in doubles.codes(result.findings())) is again


def test_a_difference_that_an_error_of_the_own_step_grows_to_is_none_of_models() -> None:
    """A statue turns back 1e-6 rad before it would meet its pedestal: by every step of 0.25 to 2 ms it meets it, which makes 6e-3
    rad of half a second."""
    shaken = {"motion.x.amplitude_g": 0.345, "motion.x.frequency_hz": 8.0}
    result = run_scene(load_scene(SCENES / "paestum_pedestal.toml", shaken), ["analytic", "pymunk"])
    evidence = result.scores["analytic_vs_pymunk"].evidence
    assert evidence.exceeded_s == pytest.approx(1.18, abs=0.05)
    assert result.runs["pymunk"].bounded_until_s < evidence.exceeded_s
    assert result.scores["analytic_vs_pymunk"].verdict is Verdict.UNBOUNDED


def _slow(told: Path) -> None:
    told.with_name("began").touch()
    time.sleep(8.0)
    told.touch()


@needs_pybullet
def test_an_interrupt_ends_what_runs_beside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A run in a process of its own that is long, or stopped, is not waited for."""
    monkeypatch.setattr(run, "simulate_isolated", lambda *_: task.call(_slow, (tmp_path / "ended",)))
    monkeypatch.setattr(forecast, "START_S", 0.0)

    def interrupt(text: str) -> None:
        if text.endswith("still"):
            while not (tmp_path / "began").exists():
                time.sleep(run.KILLED_S)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_scene(paestum(0.3, 2.0, pedestal=False), ["analytic", "pybullet"], apart=True, on_progress=interrupt)
    assert not (tmp_path / "ended").exists()


@needs_pybullet
def test_a_failure_beside_ends_what_else_runs_beside(monkeypatch: pytest.MonkeyPatch) -> None:
    """The others' threads waited for their long runs before the failure was told."""
    ended = Event()

    def beside(given: Scene, name: str, *target: object) -> Run:
        if name == "pybullet":
            raise RuntimeError("no process")
        assert ended.wait(10.0), "nobody ended it"
        return doubles.run_of(None, name)

    monkeypatch.setattr(run, "simulate_isolated", beside)
    monkeypatch.setattr(run, "_give_up", lambda waiting: ended.set())
    monkeypatch.setattr(forecast, "START_S", 0.0)
    with pytest.raises(RuntimeError, match="no process"):
        run_scene(paestum(0.3, 2.0, pedestal=False), ["analytic", "pybullet", "spatial"], apart=True)
    assert ended.is_set()
