"""The steps that are told of an engine's runs are those that are taken, whatever ends the climb."""

from dataclasses import replace

import pytest

from harness import Run, RunOptions, Scene, engines, load_scene, simulate
from harness.accuracy.forecast import (
    SPACE_TIMES,
    TRIAL_STEPS,
    expected_steps,
    first_settings,
    moving_s,
    timed_step_s,
)
from harness.engines.base import Engine, Settings
from harness.statics.plan import first_motion_s
from tests.budgets import FORECAST_TIMES
from tests.measures.seeded_scenes import random_scene, space_scene, tipping_scene, wide_scene
from tests.scenes_for_tests import paestum

SCENES = {
    "errors outgrow every level": paestum(0.334, 4.5, mu=(0.2, 0.15), duration_s=8.0),
    "two runs agree": random_scene(963_001),
    "the third level": paestum(0.2, 3.0, duration_s=6.0),
    "comes to rest": random_scene(977_003, 15.0),
    "falls early": wide_scene(977_004, 15.0),
    "the pedestal tips": tipping_scene(977_000, 4.0),
    "the pedestal tips, and runs part soon": tipping_scene(977_002, 4.0),
}


@pytest.mark.parametrize(
    ("engine", "scene"),
    [
        *(pytest.param("pymunk", scene, id=f"pymunk, {name}") for name, scene in SCENES.items()),
        *(
            pytest.param("pybullet", scene, id=f"pybullet, {name}")
            for name, scene in SCENES.items()
            if "tips" not in name
        ),
    ],
)
def test_the_steps_that_are_told_are_those_that_are_taken(engine: str, scene: Scene) -> None:
    told, taken = expected_steps(engine, scene), simulate(scene, engine).work["steps_of_all_runs"]
    assert told.least / FORECAST_TIMES < taken < told.most * FORECAST_TIMES
    # Of three levels each costs twice as much as those before it: no more than these is left open.
    assert told.most < 12.0 * told.least


@pytest.mark.parametrize("seed", [880_007, 880_008, 880_020])
def test_a_body_that_falls_in_space_alone_takes_no_steps_after_it(seed: int) -> None:
    """In the plane it stands, for seven times the steps."""
    scene = space_scene(seed, 10.0)
    told, taken = expected_steps("pybullet", scene), simulate(scene, "pybullet").work["steps_of_all_runs"]
    assert told.least / FORECAST_TIMES < taken < told.most * FORECAST_TIMES


def test_what_the_exact_body_does_not_compute_is_asked_of_the_plane() -> None:
    """A wall, which ends the run: not the whole scene is told."""
    scene = load_scene("scenes/paestum_floor.toml", ['wall = {side = "right", distance_m = 0.5}'])
    model = simulate(scene, "analytic")
    assert model.outcome.value == "touches_wall"
    moved_s = sum(each.end_s - each.start_s for each in model.patterns if each.name != "rest")
    first = first_settings("pybullet", scene)
    assert expected_steps("pybullet", scene).least == pytest.approx(SPACE_TIMES[0] * moved_s / first.dt_s, rel=1e-2)


def test_what_cannot_move_takes_no_steps_and_what_falls_none_after_it() -> None:
    falls = paestum(0.3, 2.0, duration_s=20.0)
    least_s, most_s = moving_s(falls)
    assert least_s < 5.0 < most_s == pytest.approx(20.0 - first_motion_s(falls))
    assert moving_s(replace(falls, duration_s=10.0))[0] == least_s
    assert expected_steps("pymunk", falls, dt_s=1e-3).most == pytest.approx(1e3 * most_s)


def test_a_step_is_timed_in_its_own_scene(monkeypatch: pytest.MonkeyPatch) -> None:
    """At the settings of its target: a finer one's step has more iterations, what a table of seconds would not know."""
    scene, engine, timed = paestum(0.2, 3.0, duration_s=6.0), engines.load("pymunk"), list[Settings]()

    def simulate(self: Engine, given: Scene, settings: Settings, options: RunOptions) -> Run:
        timed.append(settings)
        return own(self, given, settings, options)

    own = type(engine).simulate
    monkeypatch.setattr(type(engine), "simulate", simulate)
    for target_rad in (None, 1e-6):
        timed.clear()
        assert timed_step_s("pymunk", scene, target_rad) > 0.0
        assert timed == [first_settings("pymunk", scene, target_rad)] * len(TRIAL_STEPS)
