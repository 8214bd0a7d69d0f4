"""No result hangs on a constant: each number of what locates events, changed by a fifth, moves it by less than its error."""

from __future__ import annotations

import ast
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from harness import engines
from harness.model.history import History
from harness.model.options import RunOptions
from tests.measures.coverage import random_scene
from tests.scenes_for_tests import paestum

STEP_S = 1e-3
FIFTH = 0.2
LAYER = ("contact_time", "locating", "loop", "micro_rocking", "slip_onset", "step_state", "stepper", "touch")
MODULES = {
    "pymunk": (*(f"..event_stepping.{room}" for room in LAYER), "__init__", "support"),
    "pybullet": (*(f"..event_stepping.{room}" for room in LAYER), "backend"),
    "mujoco": ("adapter", "model"),
}
BOUNDS = {"MOST_AHEAD": 3.0, "APPROACH": 1.0, "SHORT": 1.0, "SATURATED": 1.0, "MOST_FRICTION": 1.0}
"""Constants that must stay below a bound, as a split impact takes three steps and an approach ends before its event: of these
what they leave to it is changed."""
SCENES = {
    "two coefficients": paestum(0.429, 3.0, mu=(0.20, 0.15)),
    "on the floor": paestum(0.334, 2.0, pedestal=False),
    "micro-rocking": random_scene(10_129),
}


def constants(module: ModuleType) -> list[str]:
    """Names of the numbers that a module defines and that are no counts."""
    tree = ast.parse(Path(str(module.__file__)).read_text(encoding="utf-8"))
    targets = [
        target
        for node in tree.body
        for target in (node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)])
    ]
    names = [
        name.id
        for target in targets
        if target is not None
        for name in ast.walk(target)
        if isinstance(name, ast.Name) and name.id.isupper()
    ]
    return [name for name in names if isinstance(getattr(module, name), float)]


def histories(name: str) -> list[History]:
    engine = engines.load(name)
    found = []
    for scene in SCENES.values():
        history = engine.simulate(scene, engine.settings_for_dt(scene, STEP_S), RunOptions()).history
        assert history is not None
        found.append(history)
    return found


@pytest.mark.parametrize(("name", "room"), [(name, room) for name, rooms in MODULES.items() for room in rooms])
def test_a_fifth_more_or_less_moves_no_result_by_its_error(
    name: str, room: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    engine = engines.load(name)
    reason = engine.missing()
    if reason is not None:
        pytest.skip(reason)
    path = f"harness.engines.{name}"
    module = import_module(path if room == "__init__" else f".{room}" if room[0] != "." else room, path)
    own = histories(name)
    limits = [engine.settings_for_dt(scene, STEP_S).expected_error_rad for scene in SCENES.values()]
    for constant in constants(module):
        value = getattr(module, constant)
        bound = BOUNDS.get(constant)
        for change in (-FIFTH, FIFTH):
            other = value * (1.0 + change) if bound is None else bound - (bound - value) * (1.0 + change)
            with monkeypatch.context() as patch:
                patch.setattr(module, constant, other)
                moved = [np.max(np.abs(a.theta_rad - b.at(a.t_s))) for a, b in zip(own, histories(name), strict=True)]
            for scene, by_rad, limit_rad in zip(SCENES, moved, limits, strict=True):
                assert by_rad <= limit_rad, f"{constant} {value:g} -> {other:g} moves {scene!r} by {by_rad:.1e} rad"


@pytest.mark.parametrize("name", list(MODULES))
def test_a_fifth_more_or_less_of_a_level_s_numbers_does_neither(name: str) -> None:
    """What a level's settings hold is a default of theirs, out of a module's reach: stiffness, residuals, depths, reach."""
    engine = engines.load(name)
    reason = engine.missing()
    if reason is not None:
        pytest.skip(reason)
    scene = SCENES["two coefficients"]
    settings = engine.settings_for_dt(scene, STEP_S)
    own = engine.simulate(scene, settings, RunOptions()).history
    assert own is not None
    numbers = {key: value for key, value in vars(settings).items() if isinstance(value, float)}
    for key in set(numbers) - {"dt_s", "expected_error_rad"}:
        for change in (-FIFTH, FIFTH):
            other = replace(settings, **{key: numbers[key] * (1.0 + change)})  # type: ignore[arg-type]
            history = engine.simulate(scene, other, RunOptions()).history
            assert history is not None
            by_rad = np.max(np.abs(own.theta_rad - history.at(own.t_s)))
            assert by_rad <= settings.expected_error_rad, (
                f"{key} x {1.0 + change:g} moves the rotation by {by_rad:.1e} rad"
            )


def test_constants_are_found() -> None:
    module = import_module("harness.engines.event_stepping.micro_rocking")
    found = constants(module)
    assert {"SHORT_STEPS", "LEAST_STEPS", "PARTS"} <= set(found)
    assert "LEAST_AHEAD" not in found, "another module's"
