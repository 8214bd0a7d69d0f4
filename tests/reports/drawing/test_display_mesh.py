"""The mesh on the screen is the statue's own, its edges sharp."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from harness.records.scene import SceneRecord
from reports.drawing.kinematics import display_mesh
from tests.reports.invented_run import block_scene

SCENE = SceneRecord.of(block_scene())
OUTLINE = [[-0.3, 0.0], [0.1, 0.0], [0.1, 1.4], [-0.3, 1.4]]
BLOCK = replace(SCENE, statue=replace(SCENE.statue, section_m=OUTLINE, depth_m=0.7))


def test_a_block_has_its_size_and_flat_sides() -> None:
    solid = trimesh.Trimesh(*display_mesh(BLOCK, None))
    solid.merge_vertices(merge_norm=True)
    assert solid.is_watertight
    assert solid.volume == pytest.approx(0.4 * 1.4 * 0.7)
    assert len(solid.faces) == 12


def test_what_meets_at_a_sharp_angle_shares_no_vertex(tmp_path: Path) -> None:
    trimesh.creation.box((0.4, 0.7, 1.4)).export(tmp_path / "block.glb")
    assert len(display_mesh(BLOCK, tmp_path / "block.glb")[0]) == 24


def test_a_sphere_is_smooth(tmp_path: Path) -> None:
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.5)
    ball.export(tmp_path / "ball.glb")
    vertices, _ = display_mesh(BLOCK, tmp_path / "ball.glb")
    assert len(vertices) == len(ball.vertices)


def test_more_faces_than_show_are_decimated_and_keep_the_shape(tmp_path: Path) -> None:
    trimesh.creation.icosphere(subdivisions=5, radius=0.5).export(tmp_path / "ball.glb")
    vertices, faces = display_mesh(BLOCK, tmp_path / "ball.glb", most_faces=1000)
    assert len(faces) <= 1000
    assert np.linalg.norm(vertices, axis=1) == pytest.approx(0.5, rel=0.02)


def test_a_round_block_has_a_face_for_each_side() -> None:
    rim = np.linspace(0.0, 2.0 * np.pi, 3000, endpoint=False)
    outline = np.column_stack([0.3 * np.cos(rim), 0.7 + 0.7 * np.sin(rim)])
    statue = replace(SCENE.statue, section_m=outline.tolist(), depth_m=0.5)
    _, faces = display_mesh(replace(SCENE, statue=statue), None)
    assert len(faces) == 2 * 2998 + 6000
