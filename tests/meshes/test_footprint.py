"""The touching polygon, corner distances at any azimuth, the base profile, the feet, and a base made ragged."""

import numpy as np
import pytest

from meshes import MeshError, Solid, load_solid, solid_from_mesh
from meshes import footprint as base
from meshes.processing_log import EdgeCount
from meshes.survey import ragged
from tests.budgets_meshes import ROUND_OFF_REL
from tests.meshes.shapes import box, prism


def test_polygon_is_counter_clockwise_convex_and_of_mesh_vertices(statue: Solid) -> None:
    solid = statue
    polygon = solid.footprint_m
    side = np.roll(polygon, -1, axis=0) - polygon
    after = np.roll(side, -1, axis=0)
    assert np.all(side[:, 0] * after[:, 1] - side[:, 1] * after[:, 0] > 0.0)
    rows = {tuple(vertex) for vertex in solid.vertices_m}
    assert all(tuple(vertex) in rows for vertex in polygon)


def test_collinear_points_are_no_corners() -> None:
    points = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0], [1.0, 1.0], [0.7, 0.3]])
    np.testing.assert_array_equal(base.convex_hull(points), [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])


def test_corner_distance_of_a_rectangle_at_any_azimuth(block: Solid) -> None:
    azimuth = np.linspace(0.0, 360.0, 73)
    angle = np.deg2rad(azimuth)
    expected = 0.2 * np.abs(np.cos(angle)) + 0.35 * np.abs(np.sin(angle))
    np.testing.assert_allclose(base.corner_m(block.footprint_m, azimuth), expected, rtol=1e3 * ROUND_OFF_REL)


@pytest.mark.parametrize("azimuth", [0.0, 37.0, 90.0, 200.0])
def test_planar_parameters_are_those_of_the_turned_solid(statue: Solid, azimuth: float) -> None:
    """Toppling towards azimuth a is toppling to the right once the statue is turned by -a."""
    right, left = base.corner_m(statue.footprint_m, [azimuth, azimuth + 180.0])
    turned = statue.rotated(-azimuth)
    across = [-np.sin(np.deg2rad(azimuth)), np.cos(np.deg2rad(azimuth)), 0.0]
    assert turned.corner_right_m == pytest.approx(right, rel=1e3 * ROUND_OFF_REL)
    assert turned.corner_left_m == pytest.approx(left, rel=1e3 * ROUND_OFF_REL)
    assert turned.inertia_planar_kg_m2 == pytest.approx(across @ statue.inertia_kg_m2 @ across, rel=1e3 * ROUND_OFF_REL)
    slender = base.slenderness_rose_rad(statue.footprint_m, statue.centroid_height_m, azimuth)
    assert slender == pytest.approx(np.arctan(right / 0.774))


def test_weakest_direction_is_the_least_of_the_rose(statue: Solid) -> None:
    solid = statue
    weakest = base.weakest_azimuth_deg(solid.footprint_m)
    rose = base.slenderness_rose_rad(solid.footprint_m, solid.centroid_height_m, np.arange(0.0, 360.0, 0.25))
    at_weakest = base.slenderness_rose_rad(solid.footprint_m, solid.centroid_height_m, weakest)[0]
    assert weakest == pytest.approx(0.0, abs=1e-9)
    assert at_weakest <= rose.min() + 1e-12
    assert at_weakest == pytest.approx(np.arctan(0.0682 / 0.774))


def bulged(rise_m: float) -> Solid:
    """A block whose base bulges in the middle: its outer edge is `rise_m` above the lowest line."""
    outline = np.array([[-0.2, rise_m], [-0.05, 0.0], [0.05, 0.0], [0.2, rise_m], [0.2, 1.5], [-0.2, 1.5]])
    return solid_from_mesh(*prism(outline, 0.7), density_kg_m3=2700.0, contact_tolerance_m=5e-3)


def test_a_bulging_base_keeps_its_heights() -> None:
    solid = bulged(3e-3)
    np.testing.assert_allclose(
        solid.base_profile_m, [[-0.2, 3e-3], [-0.05, 0.0], [0.05, 0.0], [0.2, 3e-3]], atol=ROUND_OFF_REL
    )
    assert len(solid.feet_m) == 8
    assert solid.corner_right_m == pytest.approx(0.2)
    assert np.ptp(solid.feet_m[:, 2]) == pytest.approx(3e-3)


def test_beyond_the_tolerance_only_the_bulge_touches() -> None:
    solid = bulged(6e-3)
    assert solid.corner_right_m == pytest.approx(0.05)
    assert len(solid.base_profile_m) == 2


def test_a_hollow_under_the_base_is_no_foot() -> None:
    outline = np.array([[-0.2, 0.0], [0.0, 4e-3], [0.2, 0.0], [0.2, 1.5], [-0.2, 1.5]])
    solid = solid_from_mesh(*prism(outline, 0.7), density_kg_m3=2700.0, contact_tolerance_m=5e-3)
    np.testing.assert_allclose(solid.base_profile_m, [[-0.2, 0.0], [0.2, 0.0]], atol=ROUND_OFF_REL)
    assert len(solid.feet_m) == 4


def test_one_raised_vertex_changes_the_base(block: Solid) -> None:
    vertices, faces = box(0.4, 0.7, 1.5)
    vertices[1, 2] += 5e-4
    raised = solid_from_mesh(vertices, faces, density_kg_m3=2700.0)
    assert raised.digest != block.digest
    assert np.ptp(raised.feet_m[:, 2]) == pytest.approx(5e-4)


def test_too_few_touching_vertices_are_refused() -> None:
    spike = np.array([[-0.2, 0.3], [0.0, 0.0], [0.2, 0.3], [0.2, 1.5], [-0.2, 1.5]])
    with pytest.raises(MeshError, match="got 2 within 1 mm"):
        solid_from_mesh(*prism(spike, 0.7), density_kg_m3=2700.0)


def test_real_scan_weakest_side(data_dir: object) -> None:
    """The acephalous Maria's weakest quarter direction is 20.4° as its source states, to the digit printed."""
    solid = load_solid(f"{data_dir}/meshes/maria_acephalous.obj", unit="m", density_kg_m3=2700.0)
    quarters = base.slenderness_rose_rad(solid.footprint_m, solid.centroid_height_m, [0.0, 90.0, 180.0, 270.0])
    assert np.rad2deg(quarters.min()) == pytest.approx(20.4, abs=0.15)
    assert solid.height_m == pytest.approx(1.513, abs=5e-4)


@pytest.mark.parametrize("lifted_m", [9e-151, 1e-13, -1e-13])
def test_a_base_level_within_rounding_has_two_corners(lifted_m: float) -> None:
    """What a scan's file writes for nought bends no facet of the model."""
    chain = base.lower_chain(np.array([[-8.0, lifted_m], [-0.1, 0.0], [0.1, 0.0], [0.1, 1.0]]))
    np.testing.assert_allclose(chain, [[-8.0, lifted_m], [0.1, 0.0]], atol=ROUND_OFF_REL)


def test_ragged_is_a_closed_surface_of_the_same_body(statue: Solid) -> None:
    rough = ragged(statue, 1e-3, spacing_m=0.05, seed=2)
    assert EdgeCount.of(rough.faces).closed
    assert rough.mass_kg == statue.mass_kg
    np.testing.assert_array_equal(rough.inertia_kg_m2, statue.inertia_kg_m2)
    assert 0.3e-3 < np.ptp(rough.feet_m[:, 2]) <= 1e-3
    assert rough.vertices_m[:, 2].min() == 0.0
    base = rough.vertices_m[rough.vertices_m[:, 2] <= 1e-3]
    assert len(base) >= 2 * (0.4267 + 0.72) / 0.05
    np.testing.assert_array_equal(rough.vertices_m, ragged(statue, 1e-3, spacing_m=0.05, seed=2).vertices_m)


def test_ragged_refuses_what_is_no_roughness(statue: Solid) -> None:
    for depth, spacing in ((0.0, 0.05), (0.1, 0.05), (1e-3, 0.0)):
        with pytest.raises(MeshError, match="contact tolerance"):
            ragged(statue, depth, spacing_m=spacing, seed=0)


def test_reach_is_the_outline_and_corner_its_support() -> None:
    square = np.array([[-1.0, -1.0], [2.0, -1.0], [2.0, 1.0], [-1.0, 1.0]])
    np.testing.assert_allclose(base.reach_m(square, [0.0, 45.0, 90.0, 180.0, 225.0]), [2.0, 2**0.5, 1.0, 1.0, 2**0.5])
    np.testing.assert_allclose(base.corner_m(square, [0.0, 45.0]), [2.0, 3.0 / 2**0.5])
    lengths, towards = base.sides(square)
    np.testing.assert_allclose(lengths, [3.0, 2.0, 3.0, 2.0])
    np.testing.assert_allclose(towards, [270.0, 0.0, 90.0, 180.0])
