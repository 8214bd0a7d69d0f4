"""A hull within a vertex budget keeps the outermost corners, and lies within the full one."""

import numpy as np
from scipy.spatial import ConvexHull

from meshes import Solid
from meshes.collision import thinned
from tests.budgets_meshes import HULL_GAP_M


def test_a_hull_within_a_budget_nears_the_full_one_from_inside(statue: Solid) -> None:
    full = ConvexHull(statue.vertices_m)
    (small, wide_m), (large, narrow_m) = thinned(statue.vertices_m, 64), thinned(statue.vertices_m, 128)
    for corners, budget in ((small, 64), (large, 128)):
        assert len(corners) == budget
        rows = {tuple(vertex) for vertex in corners}
        assert all(tuple(statue.vertices_m[each]) in rows for each in statue.vertices_m.argmin(axis=0))
    assert ConvexHull(small).volume < ConvexHull(large).volume < full.volume
    assert narrow_m < HULL_GAP_M
    assert narrow_m < wide_m


def test_points_within_the_budget_are_all_corners_of_their_hull() -> None:
    cube = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
    corners, gap_m = thinned(np.vstack([cube, cube.mean(axis=0)]), 8)
    assert gap_m == 0.0
    assert np.array_equal(corners, cube)
