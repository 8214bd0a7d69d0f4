"""Which vertices of a statue a flat support can touch, and how the statue stands at the start.

A plane touches a rigid body only at vertices of its convex hull, whatever lies between them: one small sphere at each such
vertex is the body's exact contact with floor and wall, with one fixed contact point each.
"""

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from harness.engines.stepping.contact_gaps import past_edge_m
from harness.engines.stepping.frame import matrices
from harness.engines.stepping.step_log import ALONE, Row
from harness.model import OVERTURN_RAD, Array, Statue

# When the pedestal's edge can meet the statue: only if some part of the statue comes to or below the top's plane beside it.
#
# Above that plane nothing but the plane itself can touch a convex body, and it does so at vertices: the feet are exact. Beside
# the top that plane is not there: a vertex about to come down to it must find the pedestal's edges instead.


DEPTH_M: Final = 1e-4
"""Nearer than this a vertex counts as touching; deeper is beyond any contact's penetration, and where the inset hull begins."""


FLUSH_M: Final = 1e-6
"""A foot no further past an edge than this stands over the top: bases are as wide as pedestals."""


@dataclass(frozen=True, eq=False)
class EdgeCrossing:
    """Called with a row, says whether a foot has come over the edges of the pedestal's top, or back over it, since `start`."""

    feet_m: Array
    across_m: tuple[float, float]
    start: Row

    @cached_property
    def beside(self) -> NDArray[np.bool_]:
        """Which feet (k,) stand beside the top."""
        return past_edge_m(self.feet_m, self.start, self.across_m) > FLUSH_M

    def __call__(self, row: Row) -> bool:
        past = past_edge_m(self.feet_m, row, self.across_m)
        return bool(np.where(self.beside, past < -DEPTH_M, past > DEPTH_M).any())


@dataclass(frozen=True, eq=False)
class EdgeWatch:
    """Called with a row, says whether the statue reaches below the pedestal's top beside it, or may do so before the next look.

    `points_m` (n, 3) are the vertices of the statue's hull about its centroid, in its principal frame; `half_m` the pedestal's
    half width, depth and height; `ahead_s` the longest time between two looks; `pull_m_s2` bounds what weight and table do.
    """

    points_m: Array
    half_m: tuple[float, float, float]
    ahead_s: float = 0.0
    pull_m_s2: float = 0.0

    @cached_property
    def radius_m(self) -> float:
        """Distance of the furthest vertex from the centroid."""
        return float(np.max(np.linalg.norm(self.points_m, axis=1)))

    def __call__(self, row: Row) -> bool:
        # Everything along the axes of the pedestal's top: the statue's place, velocity and rotation, both rates.
        top, statue = matrices(np.array([row[16:20], row[3:7]]))
        state, below = np.array(row[:ALONE]), np.array(row[ALONE:])
        place, velocity = (state[0:3] - below[0:3]) @ top, (state[7:10] - below[7:10]) @ top
        rate, rate_below = state[10:13] @ top, below[10:13] @ top
        arms = self.points_m @ (top.T @ statue).T
        lowest = float(arms[:, 2].min()) + place[2] - self.half_m[2]
        spin = math.hypot(*rate) + math.hypot(*rate_below)
        # A point's acceleration is at most what pulls the body, twice over, and what keeps it on its circle.
        slack = (self.pull_m_s2 + 0.5 * self.radius_m * spin**2) * self.ahead_s**2
        reach = (math.hypot(*velocity) + self.radius_m * spin) * self.ahead_s + slack
        if lowest >= DEPTH_M + reach:
            return False
        if lowest < -DEPTH_M:
            return True
        arms = arms[arms[:, 2] < DEPTH_M + reach + self.half_m[2] - place[2]]
        # A point at p from the centroid moves by v + ω × p − ω_top × (b + p) against the top.
        moving = velocity - place @ _turning(rate_below) + arms @ _turning(rate - rate_below)
        points = arms + place - (0.0, 0.0, self.half_m[2])
        then = points + self.ahead_s * moving
        down = np.minimum(points[:, 2], then[:, 2] - slack) < DEPTH_M
        furthest = np.maximum(np.abs(points[down, :2]), np.abs(then[down, :2]))
        return bool((furthest > (self.half_m[0] + DEPTH_M, self.half_m[1] + DEPTH_M)).any())


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
    cosine, cross = float(normal @ down), _turning(np.cross(normal, down)).T
    return np.asarray(np.eye(3) + cross + cross @ cross / (1.0 + cosine))


def _turning(axis: Array) -> Array:
    """The matrix (3, 3) by which a row vector p becomes axis × p; numpy's own product of vectors takes ten times as long."""
    a, b, c = axis
    return np.array([[0.0, c, -b], [-c, 0.0, a], [b, -a, 0.0]])
