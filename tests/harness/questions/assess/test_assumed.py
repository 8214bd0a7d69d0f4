"""Assumed widths: every one with its source, told in the documentation, and one that a scene can express."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analytic import Record
from harness import InputError, load_scene
from harness.input.tables import ASSUMPTIONS, assumption
from harness.model import BaseExcitation
from harness.questions.assess.probability import draw, model_draws, sweepable, uncertain_inputs, varied
from reports.messages import ENGLISH
from tests import budgets_assess as budget
from tests.scenes_for_tests import PAESTUM, paestum, scene

ROOT = Path(__file__).parents[4]
ASSUMED = '{ kind = "assumed" }'


def with_table(tmp_path: Path, lines: str, name: str = "paestum_floor.toml") -> Path:
    text = (ROOT / "scenes" / name).read_text(encoding="utf-8").replace("togatus.ply", str(ROOT / "scenes/togatus.ply"))
    path = tmp_path / "scene.toml"
    path.write_text(f"{text}\n[uncertainty]\n{lines}\n", encoding="utf-8")
    return path


def test_every_assumption_has_its_source_and_stands_in_the_documentation() -> None:
    text = (ROOT / "docs" / "probability.md").read_text(encoding="utf-8")
    for item in ASSUMPTIONS:
        source = ENGLISH(f"assumed.{item.name}")
        assert f"| `{item.keys}` | {item.kind} | {item.width:g} | {source} |" in text


def test_a_meshs_place_centroid_and_base_may_be_uncertain(tmp_path: Path) -> None:
    keys = "statue.mesh.azimuth_deg", "statue.mesh.adjust.centroid_rel", "statue.mesh.adjust.base_rel"
    scene = load_scene(with_table(tmp_path, "\n".join(f'"{key}" = {ASSUMED}' for key in keys)), ["duration_s=1.0"])
    inputs = uncertain_inputs(scene)
    for item in inputs:
        given = assumption(item.key)
        assert (item.kind, item.width, item.value) == (given.kind, given.width, 0.0)
    values = draw(inputs, 6, seed=0)
    assert not sweepable(scene, values)
    assert len(set(model_draws(scene, values).peak_share.tolist())) == 6, "every draw is another statue"


def test_a_blocks_centroid_and_corners_are_swept_as_each_scene_says(tmp_path: Path) -> None:
    block = (ROOT / "scenes" / "paestum_block.toml").read_text(encoding="utf-8")
    text = "\n".join(line for line in block.split("[pedestal]")[0].splitlines())
    rest = "[motion.x]" + block.split("[motion.x]")[1]
    keys = "statue.centroid_height_m", "statue.corner_left_m", "statue.corner_right_m"
    path = tmp_path / "block.toml"
    table = "\n".join(f'"{key}" = {ASSUMED}' for key in keys)
    path.write_text(f"{text}\n{rest}\n[uncertainty]\n{table}\n", encoding="utf-8")
    scene = load_scene(path, ["duration_s=2.0", "motion.x.amplitude_g=0.15"])
    values = draw(uncertain_inputs(scene), 12, seed=0)
    assert sweepable(scene, values)
    swept = model_draws(scene, values)
    # A wall far away changes nothing but that each scene is read again.
    walled = load_scene(path, ["duration_s=2.0", "motion.x.amplitude_g=0.15", 'wall={side="left",distance_m=50.0}'])
    assert not sweepable(walled, values)
    slow = model_draws(walled, values)
    np.testing.assert_array_equal(swept.overturned, slow.overturned)
    np.testing.assert_allclose(
        swept.peak_share[~swept.overturned], slow.peak_share[~swept.overturned], rtol=budget.SWEPT_REL
    )


def test_nothing_is_assumed_of_any_other_key(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"uncertainty\.\"duration_s\": .*contact\.floor"):
        load_scene(with_table(tmp_path, f'"duration_s" = {ASSUMED}'))


STRETCH = 1.2


def test_a_stretched_axis_of_time_is_a_slower_and_longer_motion(tmp_path: Path) -> None:
    """A record whose samples lie farther apart, and a harmonic motion of that much lower frequency, both for as much longer."""
    inputs = uncertain_inputs(load_scene(with_table(tmp_path, f'"motion.time_scale" = {ASSUMED}')))
    assert [(item.key, item.value, item.width) for item in inputs] == [("motion.time_scale", 1.0, 0.05)]
    times = np.arange(0.0, 3.0, 0.02)
    shaken = 3.0 * np.sin(9.0 * times) + np.sin(31.0 * times)
    as_given = paestum(0.429, 3.0, duration_s=3.0)
    slower = paestum(0.429, 3.0 / STRETCH, duration_s=3.0 * STRETCH)
    record = replace(as_given, base_excitation=BaseExcitation(x=Record(times, shaken), z=Record(times, 0.4 * shaken)))
    longer = {axis: Record(STRETCH * times, factor * shaken) for axis, factor in (("x", 1.0), ("z", 0.4))}
    thrown = scene(PAESTUM, theta_rate_rad_s=0.2, duration_s=2.0)
    pairs = (
        (as_given, slower),
        (record, replace(slower, base_excitation=BaseExcitation(**longer))),
        (thrown, scene(PAESTUM, theta_rate_rad_s=0.2, duration_s=2.0 * STRETCH)),
    )
    for given, expected in pairs:
        swept = model_draws(given, {"motion.time_scale": np.array([1.0, STRETCH])})
        single = model_draws(varied(given, {"motion.time_scale": STRETCH}), {})
        true = model_draws(expected, {})
        assert swept.peak_share[1] == pytest.approx(true.peak_share[0], rel=budget.SWEPT_REL)
        assert single.peak_share[0] == pytest.approx(true.peak_share[0], rel=budget.SWEPT_REL)
        assert swept.peak_slip_m[1] == pytest.approx(true.peak_slip_m[0], rel=budget.SWEPT_REL, abs=budget.ROUNDING)
        assert swept.overturned[1] == single.overturned[0] == true.overturned[0]
