"""The stress run: checks that fail when they must, cells whose category follows from numbers, scenes that come out."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from harness import engines, stresses
from harness.benchmark.scenes import COLUMN, scene_of
from harness.engine import Want
from harness.history import History, Outcome
from harness.record import Run
from harness.scene import Scene
from harness.stresses import checks, explained, more, scenes, stability
from harness.stresses.catalogue import catalogue, leaning

QUICK = ("released 1e-3 rad below balance", "released 1e-3 rad beyond balance", "0.01 m high", "100 m high",
         "floor falls at 1 g: the two-block model", "floor falls at 1 g: the engines", "height to width 50")  # fmt: skip


@pytest.fixture(scope="module")
def scene() -> Scene:
    return scene_of("free", leaning(COLUMN, 0.5, 0.6))


@pytest.fixture(scope="module")
def exact(scene: Scene) -> Run:
    engine = engines.load("analytic")
    return engine.simulate(scene, engine.ladder(scene)[-1], Want())


@pytest.mark.parametrize("name", QUICK)
def test_hard_scenes_come_out(name: str) -> None:
    hard = next(item for item in catalogue() if item.name == name)
    found = scenes.row_of(hard)
    assert found["holds"], found["got"]


def test_names_of_hard_scenes_are_their_own() -> None:
    names = [item.name for item in catalogue()]
    assert len(set(names)) == len(names)


def spoiled(run: Run, **changes: Any) -> Run:
    return replace(run, **changes)


def test_checks_fail_when_they_must(scene: Scene, exact: Run) -> None:
    assert all(check(scene, exact).holds for check in checks.BASIC)
    assert not checks.finite(scene, spoiled(exact, peak_theta_rad=float("nan"))).holds
    gained = spoiled(exact, validity={"energy_gained_j": 0.05 * checks.barrier_j(scene)})
    assert not checks.energy(scene, gained).holds
    assert not checks.depth(scene, spoiled(exact, validity={"penetration_m": 1e-3})).holds
    assert not checks.creep(scene, exact).holds, "a rocking statue is not at rest"
    assert not checks.ends_at_rest(scene, exact).holds
    assert not checks.upright(scene, exact).holds


def test_energy_from_out_of_the_plane_is_told_from_energy_of_contacts(scene: Scene, exact: Run) -> None:
    h = exact.history
    assert h is not None
    zero = np.zeros_like(h.t_s)
    gained = {"energy_gained_j": 0.05 * checks.barrier_j(scene)}
    turning = {"yaw_rad": 2.0 * h.t_s, "roll_rad": zero, "statue_y_m": zero}
    for extra, holds in (({**turning, "yaw_rad": zero}, False), (turning, True)):
        history = History(h.t_s, h.theta_rad, h.theta_rate_rad_s, h.slip_m, h.slip_rate_m_s, extra=extra)
        found = checks.energy(scene, spoiled(exact, validity=gained, history=history))
        assert found.holds is holds
        assert ("out of the plane" in found.sentence) is holds
    yaw_inertia = scene.statue.inertia_tensor_kg_m2[2, 2]
    assert checks.beyond_plane_j(scene, spoiled(exact, history=history)) == pytest.approx(2.0 * yaw_inertia)


def still(drift_rad: float) -> History:
    t = np.linspace(0.0, 10.0, 1001)
    zero = np.zeros_like(t)
    return History(t, drift_rad * t / 10.0 + 1e-6 * np.sin(50.0 * t), zero, zero, zero)


def test_creep_is_told_from_trembling(scene: Scene, exact: Run) -> None:
    assert checks.creep(scene, spoiled(exact, history=still(1e-7), end_s=10.0)).holds
    assert not checks.creep(scene, spoiled(exact, history=still(1e-5), end_s=10.0)).holds


def test_a_cell_is_judged_by_its_numbers(scene: Scene, exact: Run) -> None:
    h = exact.history
    assert h is not None
    assert stability.judge(scene, exact, exact, False)[0] == "stable"
    wrong = History(h.t_s, 1.1 * h.theta_rad, h.theta_rate_rad_s, h.slip_m, h.slip_rate_m_s)
    assert stability.judge(scene, spoiled(exact, history=wrong), exact, False)[0] == "inaccurate"
    gained = spoiled(exact, validity={"energy_gained_j": checks.barrier_j(scene)})
    assert stability.judge(scene, gained, exact, False)[0] == "drifting"
    crashed = spoiled(exact, outcome=Outcome.CRASHED, history=None, message="died")
    assert stability.judge(scene, crashed, exact, False) == ("diverged", "died")


def cell(setting: str, category: str, **more: Any) -> explained.Cell:
    return explained.Cell("pymunk", setting, "hard", category, "evidence", **more)


def why(*row: explained.Cell, tightest: explained.Cell | None = None) -> list[str]:
    return [item.explained for item in explained.explained(row, lambda: tightest)]


def test_only_what_numbers_explain_is_explained() -> None:
    wrong, stable = cell("a", "inaccurate", error_rad=1.0), cell("b", "stable", error_rad=1e-4)
    assert why(wrong, stable) == ["the step is too long for this scene: b is stable", ""]
    assert why(cell("a", "inaccurate", error_rad=0.1), cell("b", "inaccurate", error_rad=0.2)) == ["", ""]
    better = cell("b", "inaccurate", error_rad=0.3)
    assert "at b the error is 3.0e-01" in why(wrong, better)[0]
    assert "the error falls with the step, from 1.0e+00" in why(wrong, better)[1]
    falling = why(cell("a", "drifting", gained_j=1.0), cell("b", "drifting", gained_j=0.3))
    assert all("falls with the step" in text for text in falling)
    assert why(cell("a", "drifting", gained_j=1.0), cell("b", "drifting", gained_j=1.0)) == ["", ""]
    assert why(cell("a", "stable"), cell("b", "diverged")) == ["", ""]


def test_a_short_run_is_compared_over_its_own_time_only() -> None:
    long = cell("a", "inaccurate", error_rad=1.0, early_rad=2e-3)
    assert why(long, cell("b", "inaccurate", error_rad=2e-3, early_rad=2e-3, short=True)) == ["", ""]
    assert all(why(long, cell("b", "inaccurate", error_rad=1e-3, early_rad=1e-3, short=True)))


def test_a_short_stable_run_does_not_explain_what_went_wrong_later() -> None:
    short = cell("b", "stable", error_rad=1e-5, early_rad=1e-5, short=True)
    assert why(cell("a", "inaccurate", error_rad=1.0, early_rad=1e-5), short) == ["", ""], (
        "both are right in the first part"
    )
    told = why(cell("a", "inaccurate", error_rad=1.0, early_rad=0.1), short)[0]
    assert told.endswith("at b the error is 1.0e-05 rad over the first part, where it is 1.0e-01 rad here")
    assert why(cell("a", "drifting", gained_j=1.0), cell("b", "stable", gained_j=0.0, short=True)) == ["", ""]


def test_the_finest_rung_explains_what_the_step_does_not() -> None:
    stuck = cell("a", "inaccurate", error_rad=5e-3, early_rad=5e-3)
    assert "unconverged: with tight" in why(stuck, tightest=cell("tight", "stable", early_rad=1e-4))[0]
    assert why(stuck, tightest=cell("tight", "inaccurate", early_rad=4.9e-3)) == [""]


@pytest.mark.parametrize("question", [more._repeated, more._mirrored, more._permuted, more._refined, more._no_motion])
def test_hard_questions(question: Any) -> None:
    found = question()
    assert found["holds"], found["got"]


def test_what_does_not_hold_is_told_and_fails() -> None:
    wrong = {"name": "n", "wanted": "stands", "got": {"pymunk": "overturned_left"}, "holds": False}
    bad = {"reader": "scene", "inputs": 10, "tracebacks": 1, "hangs": 0, "half_written": 0}
    good = {**bad, "tracebacks": 0, "found": []}
    done = {"part": "fuzz", "wall_s": 1.0, "busy_s": 2.0, "tasks": 3, "left": []}
    whole = {
        "scenes": [{**wrong, "holds": True}], "cells": [cell("a", "stable").as_dict()], "fuzz": [good], "parts": [done],
    }  # fmt: skip
    assert stresses.holds(whole)
    assert not stresses.holds({**whole, "parts": [{**done, "left": ["scene: 0 to 99"]}]}), (
        "what is not done does not hold"
    )
    for spoilt in (
        {**whole, "scenes": [wrong]},
        {**whole, "cells": [cell("a", "diverged").as_dict()]},
        {**whole, "fuzz": [{**bad, "found": [{"seed": 3, "what": "KeyError"}]}]},
    ):
        assert not stresses.holds(spoilt)
        told = " ".join(stresses.sentences(spoilt))
        assert "pymunk: overturned_left" in told or "Unexplained: pymunk" in told or "seed 3" in told
