"""The hull keeps its budget and its feet."""

from __future__ import annotations

import pytest

from meshes import MeshError, Solid
from meshes.collision import hull
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
