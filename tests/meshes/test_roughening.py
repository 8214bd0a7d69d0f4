"""A base made ragged: closed still, as heavy, uneven by what was asked, standing."""

import numpy as np
import pytest

from meshes import MeshError, Solid
from meshes.footprint import corner_m, reach_m, sides
from meshes.processing_log import EdgeCount
from meshes.roughening import ragged


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
    np.testing.assert_allclose(reach_m(square, [0.0, 45.0, 90.0, 180.0, 225.0]), [2.0, 2**0.5, 1.0, 1.0, 2**0.5])
    np.testing.assert_allclose(corner_m(square, [0.0, 45.0]), [2.0, 3.0 / 2**0.5])
    lengths, towards = sides(square)
    np.testing.assert_allclose(lengths, [3.0, 2.0, 3.0, 2.0])
    np.testing.assert_allclose(towards, [270.0, 0.0, 90.0, 180.0])
