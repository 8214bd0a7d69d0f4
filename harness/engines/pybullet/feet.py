"""Which vertices of a statue a flat support can touch, and how the statue stands at the start.

A plane touches a rigid body only at vertices of its convex hull, whatever lies between them: one small sphere at each such
vertex is the body's exact contact with floor and wall, with one fixed contact point each.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from harness.model.scene import OVERTURN_RAD, Statue

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

REST_LEAN_RAD: Final = 0.2
"""A facet on which the statue rests leans less than this, or the scan was not stood upright."""
FLAT_RAD: Final = 1e-9
"""A lean below this is none: rounding of the hull's normals."""

CACHED_STATUES: Final = 8
"""Statues whose vertices are remembered: each level of a climb and each amplitude of a search takes the same."""


@dataclass(frozen=True, eq=False)
class Rest:
    """How the statue stands when nothing moves: `rotation` (3, 3) from its frame, `lean_rad` of its axis, whether found."""

    rotation: Array
    lean_rad: float
    stable: bool


@lru_cache(maxsize=CACHED_STATUES)
def touchable(statue: Statue, lean_rad: float = OVERTURN_RAD) -> Array:
    """Vertices (k, 3), statue frame, that a level support can touch while the statue leans up to `lean_rad` in any direction.

    On the Gaussian sphere the facets' outward normals bound the region of each vertex; a vertex counts when the edges of its
    region come within `lean_rad` of straight down, or when its region holds it.
    """
    vertices, hull = _hull(statue)
    if hull is None:
        return statue.footprint_m
    lean = np.arccos(np.clip(-hull.equations[:, 2], -1.0, 1.0))
    chosen = set(np.unique(hull.simplices[lean <= lean_rad]).tolist())
    chosen.add(int(np.argmin(vertices[:, 2])))
    for facet, others in enumerate(hull.neighbors):
        for opposite, other in enumerate(others):
            if other > facet and _arc_lean(hull.equations[facet, :3], hull.equations[other, :3]) <= lean_rad:
                chosen.update(np.delete(hull.simplices[facet], opposite).tolist())
    return np.asarray(vertices[sorted(chosen)])


@lru_cache(maxsize=CACHED_STATUES)
def hull_vertices(statue: Statue) -> Array:
    """All vertices (k, 3) of the statue's convex hull, statue frame; of a block given by numbers its eight corners."""
    vertices, hull = _hull(statue)
    if hull is None:
        top = statue.footprint_m + np.array([0.0, 0.0, statue.height_m])
        return np.vstack([statue.footprint_m, top])
    return np.asarray(vertices[np.sort(hull.vertices)])


@lru_cache(maxsize=CACHED_STATUES)
def rest(statue: Statue) -> Rest:
    """The pose on the facet, nearest to upright, over which the centroid stands; upright when no such facet is found."""
    vertices, hull = _hull(statue)
    if hull is None:
        return Rest(np.eye(3), 0.0, True)
    centroid = np.array([0.0, 0.0, statue.centroid_height_m])
    normals = hull.equations[:, :3]
    lean = np.arccos(np.clip(-normals[:, 2], -1.0, 1.0))
    # From the least lean on: the first that carries the centroid is nearest to upright.
    for facet in np.argsort(lean):
        if lean[facet] > REST_LEAN_RAD:
            break
        if _over(vertices[hull.simplices[facet]], normals[facet], centroid):
            if lean[facet] <= FLAT_RAD:
                return Rest(np.eye(3), 0.0, True)
            return Rest(_turn_down(normals[facet]), float(lean[facet]), True)
    return Rest(np.eye(3), 0.0, False)


def _hull(statue: Statue) -> tuple[Array, ConvexHull | None]:
    if statue.solid is None:
        return statue.footprint_m, None
    vertices = statue.solid.vertices_m
    return vertices, ConvexHull(vertices)


def _arc_lean(a: Array, b: Array) -> float:
    """Least angle between straight down and the arc from unit normal `a` to `b`."""
    down = np.array([0.0, 0.0, -1.0])
    ends = max(float(a @ down), float(b @ down))
    pole = np.cross(a, b)
    size = float(np.linalg.norm(pole))
    if size < 1e-12:
        return math.acos(min(ends, 1.0))
    nearest = down - (down @ pole) * pole / size**2
    inside = float(np.cross(a, nearest) @ pole) >= 0.0 and float(np.cross(nearest, b) @ pole) >= 0.0
    return math.acos(min(max(float(np.linalg.norm(nearest)) if inside else ends, -1.0), 1.0))


def _over(triangle: Array, normal: Array, point: Array) -> bool:
    """Whether `point` projected along `normal` falls into the triangle (3, 3)."""
    sides = np.roll(triangle, -1, axis=0) - triangle
    turning = np.cross(sides, point - triangle) @ normal
    scale = 1e-12 * float(np.sum(sides**2))
    return bool(np.all(turning >= -scale) or np.all(turning <= scale))


def _turn_down(normal: Array) -> Array:
    """The least rotation (3, 3) that takes unit `normal` to (0, 0, −1) (Rodrigues)."""
    down = np.array([0.0, 0.0, -1.0])
    axis, cosine = np.cross(normal, down), float(normal @ down)
    cross = np.array([[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]])
    return np.asarray(np.eye(3) + cross + cross @ cross / (1.0 + cosine))
