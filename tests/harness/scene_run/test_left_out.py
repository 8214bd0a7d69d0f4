"""Why a body in space leaves the planar model: said with the numbers of each thing taken away."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.input.scene_file import load_scene
from harness.scene_run.left_out import TAKEN_AWAY
from harness.scene_run.scene_run import run_scene

pytest.importorskip("pybullet")


def test_the_shipped_pedestal_scene_differs_by_its_products_of_inertia(root: Path) -> None:
    scene = load_scene(root / "scenes" / "paestum_pedestal.toml").but(duration_s=2.0)
    result = run_scene(scene, ("analytic", "pybullet"), accuracy_rad=1e-4)
    said = [note for note in result.scene.notes if "differ because of" in note]
    assert len(said) == 1
    assert "because of the products of inertia, which the plane leaves out" in said[0]
    diagonal = np.diag(np.diag(scene.statue.inertia_tensor_kg_m2))
    without = scene.but(statue=replace(scene.statue, inertia_tensor_kg_m2=diagonal))
    again = run_scene(without, ("analytic", "pybullet"), accuracy_rad=1e-4)
    assert not [note for note in again.scene.notes if "differ because of" in note]


def test_what_a_scene_has_none_of_is_not_taken_away(root: Path) -> None:
    block = load_scene(root / "scenes" / "paestum_block.toml")
    assert [what for what, take in TAKEN_AWAY.items() if take(block) is not None] == []
