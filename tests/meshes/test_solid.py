"""Mass properties and frame of a solid against closed forms."""

import numpy as np
import pytest

from meshes import MeshError, Solid, solid_from_mesh
from meshes.solid import mass_properties, turn_about_z
from tests.budgets_meshes import FACET_REL, ROUND_OFF_REL
from tests.meshes.shapes import box, cylinder, union


def test_box_mass_centroid_and_inertia_are_the_closed_form(block: Solid) -> None:
    mass = 2700.0 * 0.4 * 0.7 * 1.5
    assert block.mass_kg == pytest.approx(mass, rel=ROUND_OFF_REL)
    assert block.centroid_height_m == pytest.approx(0.75, rel=ROUND_OFF_REL)
    expected = mass / 12.0 * np.diag([0.7**2 + 1.5**2, 0.4**2 + 1.5**2, 0.4**2 + 0.7**2])
    np.testing.assert_allclose(block.inertia_kg_m2, expected, atol=ROUND_OFF_REL * mass)
    assert block.inertia_planar_kg_m2 == block.inertia_kg_m2[1, 1]
    assert (block.corner_left_m, block.corner_right_m, block.depth_m) == pytest.approx((0.2, 0.2, 0.7))
    np.testing.assert_allclose(block.base_profile_m, [[-0.2, 0.0], [0.2, 0.0]], atol=ROUND_OFF_REL)


def test_weighed_mass_solves_the_density() -> None:
    by_mass = solid_from_mesh(*box(0.4, 0.7, 1.5), mass_kg=500.0)
    assert by_mass.density_kg_m3 == pytest.approx(500.0 / 0.42, rel=ROUND_OFF_REL)
    by_density = solid_from_mesh(*box(0.4, 0.7, 1.5), density_kg_m3=by_mass.density_kg_m3)
    np.testing.assert_allclose(by_density.inertia_kg_m2, by_mass.inertia_kg_m2, rtol=ROUND_OFF_REL)


@pytest.mark.parametrize(
    ("density", "mass", "side", "said"),
    [
        *((density, None, 1, "wanted") for density in (None, -1.0, float("nan"))),
        (2700.0, 500.0, 1, "wanted"),
        (None, 0.0, 1, "wanted"),
        (2700.0, None, -1, "outward"),
    ],
)
def test_density_or_mass_and_positive_and_not_inside_out(
    density: float | None, mass: float | None, side: int, said: str
) -> None:
    vertices, faces = box(0.4, 0.7, 1.5)
    with pytest.raises(MeshError, match=said):
        solid_from_mesh(vertices, faces[:, ::side], density_kg_m3=density, mass_kg=mass)


def test_off_diagonal_inertia_of_two_boxes() -> None:
    """Two equal cubes, one above and to the right of the other: I_xz = -Σ m x z, with the sign of the tensor."""
    solid = solid_from_mesh(*union([box(1.0, 1.0, 1.0), box(1.0, 1.0, 1.0, (0.5, 0.25, 1.0))]), density_kg_m3=1.0)
    # Each cube's centre is at ∓(0.25, 0.125, 0.5) from the common centroid.
    assert solid.inertia_kg_m2[0, 2] == pytest.approx(-2.0 * 0.25 * 0.5, rel=ROUND_OFF_REL)
    assert solid.inertia_kg_m2[0, 1] == pytest.approx(-2.0 * 0.25 * 0.125, rel=ROUND_OFF_REL)
    assert solid.inertia_kg_m2[1, 2] == pytest.approx(-2.0 * 0.125 * 0.5, rel=ROUND_OFF_REL)


def test_cylinder_far_from_the_origin_loses_no_digits() -> None:
    vertices, faces = cylinder(0.2, 1.0)
    near = mass_properties(vertices, faces)
    assert near.volume_m3 == pytest.approx(np.pi * 0.04, rel=FACET_REL)
    assert near.inertia_per_density_m5[2, 2] == pytest.approx(0.5 * np.pi * 0.2**4, rel=FACET_REL)
    far = mass_properties(vertices + np.array([4096.0, -8192.0, 512.0]), faces)
    np.testing.assert_allclose(
        far.inertia_per_density_m5, near.inertia_per_density_m5, rtol=1e4 * ROUND_OFF_REL, atol=1e-12
    )


def test_rotated_turns_tensor_and_corners_together(block: Solid) -> None:
    quarter = block.rotated(90.0)
    assert quarter.corner_right_m == pytest.approx(0.35, rel=ROUND_OFF_REL)
    assert quarter.inertia_planar_kg_m2 == pytest.approx(block.inertia_kg_m2[0, 0], rel=ROUND_OFF_REL)
    back = block.rotated(37.0).rotated(-37.0)
    np.testing.assert_allclose(back.vertices_m, block.vertices_m, atol=ROUND_OFF_REL)
    np.testing.assert_allclose(back.inertia_kg_m2, block.inertia_kg_m2, rtol=1e2 * ROUND_OFF_REL, atol=1e-10)


@pytest.mark.parametrize("azimuth", [-90.0, 0.0, 90.0, 180.0, 270.0, 450.0])
def test_quarter_turns_are_exact(azimuth: float) -> None:
    turn = turn_about_z(azimuth)
    assert set(np.unique(turn)) <= {-1.0, 0.0, 1.0}
    assert np.linalg.det(turn) == 1.0


def test_arrays_are_read_only_and_the_digest_sees_every_vertex(block: Solid) -> None:
    with pytest.raises(ValueError, match="read-only"):
        block.vertices_m[0, 0] = 1.0
    vertices, faces = box(0.4, 0.7, 1.5)
    assert solid_from_mesh(vertices, faces, density_kg_m3=2700.0).digest == block.digest
    vertices[6, 2] += 1e-12
    assert solid_from_mesh(vertices, faces, density_kg_m3=2700.0).digest != block.digest
