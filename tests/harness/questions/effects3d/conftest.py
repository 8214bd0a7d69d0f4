"""The scene of the third dimension, and a plain block in it."""

from pathlib import Path

import pytest

import harness
from harness.model import Scene
from harness.questions.effects3d import with_solid
from meshes import solid_from_mesh
from tests.meshes.shapes import box


@pytest.fixture(scope="session")
def scene(root: Path) -> Scene:
    return harness.load_scene(root / "scenes" / "3d_effects_base.toml")


@pytest.fixture(scope="session")
def block(scene: Scene) -> Scene:
    """The scene with a plain block in place of the statue."""
    vertices, faces = box(0.3, 0.4, 1.2)
    return with_solid(scene, solid_from_mesh(vertices, faces, density_kg_m3=2700.0))
