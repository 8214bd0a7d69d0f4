"""Assumed widths: every one with its source, told in the documentation, and one that a scene can express."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from harness.assess.inputs import draw, uncertain_inputs
from harness.assess.model_draws import model_draws, sweepable
from harness.input.scene_file import load_scene
from harness.model.assumed import ASSUMPTIONS, assumption
from harness.model.errors import InputError
from tests import budgets_assess as budget

ROOT = Path(__file__).parents[3]
ASSUMED = '{ kind = "assumed" }'


def with_table(tmp_path: Path, lines: str, name: str = "paestum_floor.toml") -> Path:
    text = (ROOT / "scenes" / name).read_text(encoding="utf-8").replace("togatus.ply", str(ROOT / "scenes/togatus.ply"))
    path = tmp_path / "scene.toml"
    path.write_text(f"{text}\n[uncertainty]\n{lines}\n", encoding="utf-8")
    return path


def test_every_assumption_has_its_source_and_stands_in_the_documentation() -> None:
    text = (ROOT / "docs" / "probability.md").read_text(encoding="utf-8")
    for item in ASSUMPTIONS:
        assert f"| `{item.keys}` | {item.kind} | {item.width:g} | {item.source} |" in text


def test_a_meshs_place_centroid_and_base_may_be_uncertain(tmp_path: Path) -> None:
    keys = "statue.mesh.azimuth_deg", "statue.mesh.adjust.centroid_rel", "statue.mesh.adjust.base_rel"
    scene = load_scene(with_table(tmp_path, "\n".join(f'"{key}" = {ASSUMED}' for key in keys)), ["duration_s=1.0"])
    inputs = uncertain_inputs(scene)
    for item in inputs:
        given = assumption(item.key)
        assert given is not None
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
    with pytest.raises(InputError, match="keys of which a width is assumed"):
        load_scene(with_table(tmp_path, f'"duration_s" = {ASSUMED}'))
