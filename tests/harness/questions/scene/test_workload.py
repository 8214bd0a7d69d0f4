"""Work is told before it begins, and what nobody can wait for or no memory holds is refused by the key that asks for it."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from harness import InputError, load_scene
from harness.engines import DEFAULT_ENGINES, load
from harness.questions.scene import scene_run
from harness.questions.scene.scene_run import check_work
from harness.runs.progress import duration_words
from tests.scenes_for_tests import paestum

ENGINES = {name: load(name).capabilities.dimensions for name in DEFAULT_ENGINES}
GB = 1e9


def test_short_work_is_not_announced() -> None:
    assert check_work(paestum(0.3, 2.0), ENGINES, "scene") == ""


def test_long_work_is_told_with_all_that_is_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scene_run, "REPORTED_FROM_S", 0.0)
    scene = paestum(0.1, 6.0, mu=(0.5, 0.5), duration_s=6.0)
    asked: tuple[dict[str, Any], ...] = ({"assess": True}, {"witness": True}, {"horizon": True}, {"spent_s": 1000.0})
    told = [check_work(scene, {"analytic": 2, "pymunk": 2}, "scene", **each) for each in asked]
    assert all("of processor time" in each for each in told)
    assert "17 min" in told[-1]


def test_histories_that_no_memory_holds_are_refused_by_their_key() -> None:
    fine = replace(paestum(0.3, 2.0), duration_s=10.0, output_dt_s=1e-6)
    with pytest.raises(InputError, match=r"scene: output\.dt_s: .*1e\+07 "):
        check_work(fine, ENGINES, "scene", memory_bytes=8 * GB)


@pytest.mark.parametrize(("dt_s", "key"), [(1e-6, "--dt"), (None, "duration_s")])
def test_work_of_more_than_a_day_is_refused_by_its_key(dt_s: float | None, key: str) -> None:
    scene = replace(paestum(0.1, 6.0, mu=(0.5, 0.5)), duration_s=40_000.0, output_dt_s=10.0)
    accuracy = None if dt_s else 1e-6
    with pytest.raises(InputError, match=f"scene: {key}: .* 24 h"):
        check_work(scene, dict.fromkeys(("pybullet", "pybullet:plain"), 3), "scene", accuracy, dt_s)


@pytest.mark.parametrize(("seconds", "said"), [(0.2, "1 s"), (80.0, "80 s"), (600.0, "10 min"), (9e4, "25 h")])
def test_seconds_are_said_in_the_unit_that_fits(seconds: float, said: str) -> None:
    assert duration_words(seconds) == said


FLOOR = """
title = "a block upstairs"
duration_s = 10.0
[statue]
mass_kg = 100.0
centroid_height_m = 0.5
corner_left_m = 0.1
corner_right_m = 0.1
inertia_kg_m2 = 8.666666666666666
[motion.x]
kind = "pulse"
shape = "one_sine"
amplitude_g = 0.3
duration_s = 0.5
floor = [{{ period_s = {period_s} }}]
"""


def test_a_floor_too_stiff_to_follow_is_refused_by_its_key(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(FLOOR.format(period_s=1e-6))
    with pytest.raises(InputError, match=r"motion\.x\.floor\.period_s: .* got 1e-06"):
        load_scene(path)
    path.write_text(FLOOR.format(period_s=0.2))
    load_scene(path)
