"""No result hangs on a constant: each number of what locates events, changed by a fifth, moves it by less than its error."""

import ast
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from harness import History, RunOptions, Scene, engines
from harness.engines.stepping import step_state
from harness.engines.stepping.step_state import EventSettings
from harness.questions.bench.standard_scenes import PAESTUM, harmonic, scene_of
from tests.engines_for_tests import ready
from tests.measures.coverage import random_scene
from tests.scenes_for_tests import paestum

STEP_S = 1e-3
FIFTH = 0.2
MODULES = {
    "pymunk": ("pymunk", "pymunk.backend"),
    "pybullet": ("pybullet.world",),
    "pymunk:plain": ("pymunk", "stepping.support"),
    "pybullet:plain": ("pybullet.adapter", "stepping.support"),
}
IN_SPACE = ("pybullet.world",)
"""Rooms of pybullet that hold what only a motion out of the plane passes, too."""
LOCATING = ("pymunk", "pybullet")
"""Engines in which events are located."""
NUMBERS = tuple(item.name for item in fields(EventSettings) if item.type == "float")
EXACT = {"EIGHTH_RAD": "an eighth of a turn"}
"""Numbers that are no choice."""
BOUNDS = {"approach": 1.0, "short": 1.0, "MOST_FRICTION": 1.0}
"""Numbers that must stay below a bound, as an approach ends before its event: of these what they leave to it is changed."""
SCENES = {
    "two coefficients": paestum(0.429, 3.0, mu=(0.20, 0.15), duration_s=0.72),
    "micro-rocking": replace(random_scene(10_129), duration_s=2.4),
}
"""The first ends after its last event of another kind (uplift, slides, impacts at 0.49 and 0.59 s), the second where what a
number changes has grown to its most."""
ASKEW = {
    "askew": scene_of(
        "askew",
        {
            "duration_s": 0.8,
            "statue": PAESTUM,
            "contact": {"statue": 0.35},
            "motion": {**harmonic(0.45, 2.5), "y": harmonic(0.30, 3.1)["x"]},
        },
    )
}
"""It rocks out of its plane, and slides."""


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
    return [name for name in names if isinstance(getattr(module, name), float) and name not in EXACT]


def histories(name: str, scenes: Mapping[str, Scene] = SCENES) -> list[History]:
    engine = engines.load(name)
    found = []
    for scene in scenes.values():
        history = engine.simulate(scene, engine.settings_for_dt(scene, STEP_S), RunOptions()).history
        assert history is not None
        found.append(history)
    return found


@cache
def unchanged(name: str, askew: bool = False) -> list[History]:
    """Histories of an engine as it is."""
    return histories(name, ASKEW if askew else SCENES)


def changed(number: str, value: float) -> list[float]:
    """A fifth less and a fifth more of a number, or of what it leaves to its bound."""
    bound = BOUNDS.get(number, 0.0)
    return [bound + (value - bound) * (1.0 + change) for change in (-FIFTH, FIFTH)]


def assert_moves_little(name: str, own: Sequence[History], what: str, scenes: Mapping[str, Scene] = SCENES) -> None:
    engine = engines.load(name)
    for label, scene, before, after in zip(scenes, scenes.values(), own, histories(name, scenes), strict=True):
        by_rad = np.max(np.abs(before.theta_rad - after.at(before.t_s)))
        limit_rad = engine.settings_for_dt(scene, STEP_S).expected_error_rad
        assert by_rad <= limit_rad, f"{what} moves {label!r} by {by_rad:.1e} rad"


@pytest.mark.slow
@pytest.mark.parametrize("name", LOCATING)
def test_a_fifth_more_or_less_of_what_locates_events_moves_no_result_by_its_error(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    own = unchanged(name)
    for number in NUMBERS:
        for value in changed(number, getattr(step_state.EVENTS, number)):
            with monkeypatch.context() as patch:
                patch.setattr(step_state, "EVENTS", replace(step_state.EVENTS, **{number: value}))
                assert_moves_little(name, own, f"{number} = {value:g}")


@pytest.mark.parametrize(
    ("name", "room", "scenes"),
    [(name, room, SCENES) for name, rooms in MODULES.items() for room in rooms]
    + [("pybullet", room, ASKEW) for room in IN_SPACE],
    ids=lambda each: each if isinstance(each, str) else ", ".join(each),
)
def test_a_fifth_more_or_less_of_an_engine_s_own_moves_no_result_by_its_error(
    name: str, room: str, scenes: Mapping[str, Scene], monkeypatch: pytest.MonkeyPatch
) -> None:
    ready(name)
    module = import_module(f"harness.engines.{room}")
    own = unchanged(name, scenes is ASKEW)
    for constant in constants(module):
        for value in changed(constant, getattr(module, constant)):
            with monkeypatch.context() as patch:
                patch.setattr(module, constant, value)
                assert_moves_little(name, own, f"{constant} = {value:g}", scenes)


@pytest.mark.parametrize("name", list(MODULES))
def test_a_fifth_more_or_less_of_a_level_s_numbers_does_neither(name: str) -> None:
    """What a level's settings hold is a default of theirs, out of a module's reach: stiffness, residuals, depths, reach."""
    engine = ready(name)
    scene = SCENES["two coefficients"]
    level = engine.settings_for_dt(scene, STEP_S)
    own = engine.simulate(scene, level, RunOptions()).history
    assert own is not None
    numbers = {key: value for key, value in vars(level).items() if isinstance(value, float)}
    for key in set(numbers) - {"dt_s", "expected_error_rad"}:
        for change in (-FIFTH, FIFTH):
            other = replace(level, **{key: numbers[key] * (1.0 + change)})  # type: ignore[arg-type]
            history = engine.simulate(scene, other, RunOptions()).history
            by_rad = np.max(np.abs(own.theta_rad - history.at(own.t_s)))
            assert by_rad <= level.expected_error_rad, (
                f"{key} x {1.0 + change:g} moves the rotation by {by_rad:.1e} rad"
            )


def test_the_numbers_are_found_and_reach_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    assert {"short_steps", "near", "unsolved"} <= set(NUMBERS)
    assert {"HELD_SHARE", "RISES"} <= set(constants(import_module("harness.engines.pymunk.backend")))
    own = unchanged("pymunk")
    monkeypatch.setattr(step_state, "EVENTS", replace(step_state.EVENTS, most_jumps=0))
    with pytest.raises(AssertionError, match="moves"):
        assert_moves_little("pymunk", own, "no event located")


@pytest.mark.parametrize("name", LOCATING)
def test_a_verification_run_stays_around_events_for_another_time(name: str) -> None:
    """What the layer errs by is then another, so that the spread of the two runs holds it too."""
    engine, scene = ready(name), SCENES["two coefficients"]
    level = engine.settings_for_dt(scene, STEP_S)
    (verification,) = engine.verification_settings(scene, level)
    shares = [vars(each)["event_share"] for each in (level, verification)]
    assert shares[0] == 1.0 != shares[1]
    own, other = (
        engine.simulate(scene, replace(level, event_share=share), RunOptions()).history  # type: ignore[call-arg]
        for share in shares
    )
    assert not np.array_equal(own.theta_rad, other.theta_rad)
