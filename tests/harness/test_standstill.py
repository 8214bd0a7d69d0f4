"""A scene in which nothing moves says how far it is from moving, and the key that makes it move."""

from __future__ import annotations

from pathlib import Path

import pytest

import harness
from harness.run import run_scene
from harness.standstill import motion_sized, standstill


@pytest.fixture
def file(root: Path) -> Path:
    return root / "scenes" / "3d_effects_base.toml"


def test_a_quiet_scene_says_what_would_move_it(file: Path) -> None:
    scene = harness.load_scene(file, ["motion.x.amplitude_g=0.05", "motion.y=none", "motion.z=none"])
    result = run_scene(scene, ["analytic"])
    (told,) = [note for note in result.scene.notes if note.startswith("nothing moves")]
    assert "at 0.0881 g, the floor's peak along x is 0.05 g" in told
    key = told.rpartition("--set ")[2]
    assert key == "motion.x.amplitude_g=0.1322"
    moved = run_scene(harness.load_scene(file, [key, "motion.y=none", "motion.z=none"]), ["analytic"])
    assert abs(moved.runs["analytic"].peak_theta_rad) > 0.0
    assert not any(note.startswith("nothing moves") for note in moved.scene.notes)


def test_a_scene_that_moves_or_is_not_shaken_says_nothing(file: Path) -> None:
    scene = harness.load_scene(file)
    assert standstill(scene, run_scene(scene, ["analytic"]).runs.values()) is None
    still = harness.load_scene(file, ["motion.x=none", "motion.y=none", "motion.z=none"])
    assert standstill(still, run_scene(still, ["analytic"]).runs.values()) is None
    assert motion_sized(still, 2.0) == ""
