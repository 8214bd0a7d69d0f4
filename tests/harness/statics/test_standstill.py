"""A scene in which nothing moves says how far it is from moving, and the least size of its motion that moves it."""

from pathlib import Path

import numpy as np
import pytest

import harness
from analytic.excitation import SampledAcceleration
from harness.questions.scene.scene_run import run_scene
from harness.records.scene import motion_of
from harness.statics.standstill import SETTLES_RAD, motion_sized, push_of, standstill
from tests import scenes_for_tests as blocks
from tests.engines_for_tests import ready


@pytest.fixture
def file(root: Path) -> Path:
    return root / "scenes" / "3d_effects_base.toml"


def test_a_quiet_scene_says_what_would_move_it(file: Path) -> None:
    scene = harness.load_scene(file, ["motion.x.amplitude_g=0.05", "motion.y=none", "motion.z=none"])
    result = run_scene(scene, ["analytic"])
    (told,) = [each.values for each in result.findings() if each.code == "nothing_moves"]
    assert told["push_g"] == pytest.approx(0.05)
    assert told["share"] == pytest.approx(0.567, abs=5e-4)
    assert told["cause"] == "statue_tips"
    key = told["least"]
    assert key == "motion.x.amplitude_g=0.08812"
    moved = run_scene(harness.load_scene(file, [key, "motion.y=none", "motion.z=none"]), ["analytic"])
    assert abs(moved.runs["analytic"].peak_theta_rad) > 0.0
    less = harness.load_scene(file, ["motion.x.amplitude_g=0.0881", "motion.y=none", "motion.z=none"])
    assert run_scene(less, ["analytic"]).runs["analytic"].peak_theta_rad == 0.0


def test_the_least_size_counts_the_motion_across_and_the_vertical(file: Path) -> None:
    """With the y and z of the scene the statue moves before x alone would move it."""
    keys = ["motion.x.amplitude_g=0.05", "motion.y.amplitude_g=0.08", "motion.z.amplitude_g=0.2"]
    scene = harness.load_scene(file, keys)
    told = standstill(scene, run_scene(scene, ["analytic"]).runs.values())
    least = float(told.values["least"].partition("amplitude_g=")[2])
    for factor, moves in ((1.0, True), (0.999, False)):
        share = push_of(harness.load_scene(file, [f"motion.x.amplitude_g={least * factor}", *keys[1:]])).first[1]
        assert (share >= 1.0) is moves


def test_of_like_frictions_the_pedestal_s_gives_way_first(file: Path) -> None:
    """What slides below hands on no more than its own friction."""
    keys = ["pedestal={mass_kg=300.0, width_m=0.8, depth_m=0.8, height_m=0.2}", "contact.statue=0.02"]
    found = push_of(harness.load_scene(file, [*keys, "contact.floor_static=0.02", "contact.floor_kinetic=0.02"]))
    assert found.shares["pedestal_slides"] == found.shares["statue_slides"]
    assert found.first[0] == "pedestal_slides"


def test_what_moves_across_the_rocking_plane_is_not_called_still(file: Path) -> None:
    ready("pybullet")
    keys = ["motion.x.amplitude_g=0.01", "motion.y.amplitude_g=0.7", "motion.z=none", "duration_s=1.5"]
    scene = harness.load_scene(file, keys)
    runs = [harness.simulate(scene, name) for name in ("analytic", "pybullet")]
    assert abs(runs[1].peak_theta_rad) < SETTLES_RAD
    assert standstill(scene, runs) is None
    assert standstill(scene, runs[:1]) is not None


def test_a_push_past_the_limit_is_not_called_still(file: Path) -> None:
    """The analytic model holds a statue on its support that slides: what it leaves out is no rest."""
    scene = harness.load_scene(
        file, ["motion.x.amplitude_g=0.08", "motion.y=none", "motion.z=none", "contact.statue=0.05"]
    )
    run = run_scene(scene, ["analytic"])
    assert [each.values["by"] for each in run.findings() if each.code == "left_domain"] == ["statue_slides"]
    (told,) = [each.values for each in run.findings() if each.code == "no_model_moves"]
    assert told["cause"] == "statue_slides"
    assert told["push_g"] == pytest.approx(0.08)
    assert told["times"] == pytest.approx(1.6, abs=0.05)


def test_what_a_record_does_after_the_run_is_no_part_of_it() -> None:
    quiet = np.array([0.1, -0.2, 5.0, 0.0])
    record = SampledAcceleration(np.array([0.0, 1.0, 3.0, 4.0]), quiet)
    scene = blocks.scene(blocks.rectangle(0.4, 1.0), record, duration_s=1.0)
    assert push_of(scene).peak == pytest.approx(0.2 / scene.gravity_m_s2)
    assert motion_of(scene).x_peak_m_s2 == 0.2


def test_a_scene_that_moves_or_is_not_shaken_says_nothing(file: Path) -> None:
    scene = harness.load_scene(file)
    assert standstill(scene, run_scene(scene, ["analytic"]).runs.values()) is None
    still = harness.load_scene(file, ["motion.x=none", "motion.y=none", "motion.z=none"])
    assert standstill(still, run_scene(still, ["analytic"]).runs.values()) is None
    assert motion_sized(still, 2.0) == ""
