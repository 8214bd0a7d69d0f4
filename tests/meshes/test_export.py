"""A solid written for viewers is the same surface."""

from pathlib import Path

import numpy as np
import trimesh

from meshes.solid import write_glb
from tests.budgets_meshes import FLOAT32_ROUNDING_M
from tests.meshes import togatus


def test_a_written_solid_is_the_same_surface(tmp_path: Path) -> None:
    solid = togatus.build()
    write_glb(solid, tmp_path / "statue.glb")
    back = trimesh.load(tmp_path / "statue.glb", force="mesh", process=False)
    assert np.array_equal(back.faces, solid.faces)
    assert np.max(np.abs(back.vertices - solid.vertices_m)) <= FLOAT32_ROUNDING_M
