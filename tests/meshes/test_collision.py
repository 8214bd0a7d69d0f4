"""Collision shapes: the hull keeps its budget and its feet, the decomposition covers the body and clears the base."""

from __future__ import annotations

import numpy as np
import pytest

from meshes import MeshError, Solid
from meshes.collision import decompose, hull
from meshes.solid import mass_properties
from tests.budgets_meshes import HULL_GAP_M


def test_hull_within_budget_keeps_the_feet(statue: Solid) -> None:
    small, large = hull(statue, 64), hull(statue, 128)
    for found, budget in ((small, 64), (large, 128)):
        assert len(found.vertices_m) <= budget
        rows = {tuple(vertex) for vertex in found.vertices_m}
        assert all(tuple(foot) in rows for foot in statue.feet_m)
        assert mass_properties(found.vertices_m, found.faces).volume_m3 > statue.mass_kg / statue.density_kg_m3
    assert large.gap_m < HULL_GAP_M
    assert large.gap_m < small.gap_m
    assert small.volume_rel < large.volume_rel <= 0.0


def test_hull_refuses_a_tiny_budget(statue: Solid) -> None:
    with pytest.raises(MeshError, match="budget"):
        hull(statue, 5)


def test_decomposition_covers_the_body_and_clears_the_base(statue: Solid) -> None:
    found = decompose(statue, concavity=0.2, max_parts=8, clearance_m=2e-3)
    assert 1 <= len(found.parts) <= 8
    convex = mass_properties(hull(statue).vertices_m, hull(statue).faces).volume_m3
    assert 0.0 < found.volume_rel < convex * statue.density_kg_m3 / statue.mass_kg - 1.0
    assert min(vertices[:, 2].min() for vertices, _ in found.parts) >= 2e-3 - 1e-9
    again = decompose(statue, concavity=0.2, max_parts=8, clearance_m=2e-3)
    for (one, _), (other, _) in zip(found.parts, again.parts, strict=True):
        np.testing.assert_array_equal(one, other)


def test_decomposition_refuses_a_senseless_concavity(statue: Solid) -> None:
    with pytest.raises(MeshError, match="concavity"):
        decompose(statue, concavity=0.0)
