"""The generated statue: the surveyed numbers, a closed surface, and nothing but its base within reach of the
support."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from meshes import Solid, load_solid
from meshes.intake import EdgeCount
from meshes.prepare import Wanted, inspect
from meshes.solid import write_glb
from tests.budgets_meshes import (
    CENTROID_TOLERANCE_M,
    FLAT_BASE_M,
    FLOAT32_ROUNDING_M,
    RESOLVED_ABS,
    SURVEY_ASKED_REL,
    SURVEY_REL,
)
from tests.meshes import togatus

FREE_ROTATION_RAD = 0.6
OVERTURN_RAD = 1.5


def test_surveyed_numbers(statue: Solid) -> None:
    survey = {
        "mass_kg": 707.0,
        "centroid_height_m": 0.774,
        "corner_right_m": 0.0682,
        "corner_left_m": 0.3585,
        "depth_m": 0.72,
    }
    assert {name: getattr(statue, name) for name in survey} == pytest.approx(survey, rel=SURVEY_REL)
    assert statue.height_m == pytest.approx(1.46, rel=SURVEY_ASKED_REL)


def test_its_file_is_told_as_one_part(root: Path) -> None:
    found = inspect(root / "scenes" / "togatus.ply", Wanted(unit="m", up="z"), density_kg_m3=2700.0)
    assert " units, 1 part; closed: " in found.facts()[0]
    assert any(" 4 feet " in fact for fact in found.facts()), "uneven by 0.00 mm was told of it"


def test_kept_proportions_are_the_solution() -> None:
    solved = togatus.solve(togatus.Proportions(girth=1.0, taper=0.1, lean=0.0, sway=0.0))
    for name in ("girth", "taper", "lean", "sway"):
        assert getattr(solved, name) == pytest.approx(getattr(togatus.SOLVED, name), abs=RESOLVED_ABS)


def test_closed_with_one_flat_base_of_four_corners(statue: Solid) -> None:
    assert EdgeCount.of(statue.faces).closed
    assert 5_000 < len(statue.faces) < 25_000
    assert statue.footprint_m.shape == (4, 3)
    np.testing.assert_allclose(statue.footprint_m[:, 2], 0.0, atol=FLAT_BASE_M)
    np.testing.assert_allclose(statue.base_profile_m, [[-0.3585, 0.0], [0.0682, 0.0]], atol=1e-9)
    y_middle = 0.5 * (statue.footprint_m[:, 1].max() + statue.footprint_m[:, 1].min())
    assert abs(y_middle) < CENTROID_TOLERANCE_M


def test_products_of_inertia_are_small_but_real(statue: Solid) -> None:
    inertia = statue.inertia_kg_m2
    for across in (inertia[0, 1], inertia[1, 2]):
        assert 1e-4 * inertia[1, 1] < abs(across) < 0.1 * inertia[1, 1]


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_nothing_but_the_base_touches(statue: Solid, side: float) -> None:
    """Rotated by 0.6 rad about either corner, every vertex above the plinth's lower face stays above the support."""
    corner = statue.corner_right_m if side > 0 else statue.corner_left_m
    above = statue.vertices_m[statue.vertices_m[:, 2] > statue.contact_tolerance_m]
    reach = side * above[:, 0] - corner
    height = above[:, 2] * np.cos(FREE_ROTATION_RAD) - reach * np.sin(FREE_ROTATION_RAD)
    assert height.min() > 0.0


def assert_same(read: Solid, statue: Solid) -> None:
    assert read.mass_kg == pytest.approx(statue.mass_kg, rel=1e-6)
    assert read.inertia_planar_kg_m2 == pytest.approx(statue.inertia_planar_kg_m2, rel=1e-6)
    assert read.corner_right_m == pytest.approx(statue.corner_right_m, rel=1e-5)


@pytest.mark.parametrize("suffix", ["ply", "obj", "stl", "glb"])
def test_written_and_read_again(statue: Solid, tmp_path: Path, suffix: str) -> None:
    """Every format keeps the solid: STL, GLB and PLY round to float32 (6e-8 relative), OBJ prints 8 decimals."""
    file = tmp_path / f"statue.{suffix}"
    togatus.write(file)
    again = load_solid(file, unit="m", density_kg_m3=togatus.DENSITY_KG_M3)
    assert_same(again, statue)


def test_written_for_viewers_it_is_the_same_surface(statue: Solid, tmp_path: Path) -> None:
    write_glb(statue, tmp_path / "statue.glb")
    back = trimesh.load(tmp_path / "statue.glb", force="mesh", process=False)
    assert np.array_equal(back.faces, statue.faces)
    assert np.max(np.abs(back.vertices - statue.vertices_m)) <= FLOAT32_ROUNDING_M


def test_fallen_it_lies_beyond_the_limit_of_overturning(statue: Solid) -> None:
    """Every side of the silhouette that can carry the centroid, but the base, is reached beyond 1.5 rad of rotation."""
    outline = statue.section_m
    ahead = np.roll(outline, -1, axis=0)
    along = (ahead - outline) / np.linalg.norm(ahead - outline, axis=1)[:, None]
    place = ((np.array([0.0, statue.centroid_height_m]) - outline) * along).sum(axis=1)
    carries = (place > 0.0) & (place < np.linalg.norm(ahead - outline, axis=1))
    rotation = np.abs(np.arctan2(along[carries, 1], along[carries, 0]))
    assert len(rotation) >= 3
    assert sorted(rotation)[0] == pytest.approx(0.0, abs=1e-9)
    assert sorted(rotation)[1] > OVERTURN_RAD


def test_the_scenes_mesh_is_this_statue(statue: Solid, root: Path) -> None:
    """PLY keeps float32: 6e-8 of a metre and a half."""
    written = load_solid(root / "scenes" / "togatus.ply", unit="m", density_kg_m3=togatus.DENSITY_KG_M3)
    assert_same(written, statue)
