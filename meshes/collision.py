"""A statue's convex hull within a vertex budget, and how far a hull is from the statue.

The base touches through the mesh's own vertices (`Solid.feet_m`) in every case, and so does whatever a flat wall meets. Hull
and convex parts (`meshes.decomposition`) stand for the body above the base where a pedestal's edge can be met.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from meshes.errors import MeshError
from meshes.mesh import manifold
from meshes.solid import Solid

Array = NDArray[np.float64]
Faces = NDArray[np.int64]

LEAST_VERTICES = 12
"""A hull with fewer vertices is no statue."""


@dataclass(frozen=True, eq=False)
class Hull:
    """Convex hull within a vertex budget: vertices (k, 3), outward faces (m, 3).

    `gap_m` is how far the full hull stands out of it at most, `volume_rel` its volume against the full hull's, less
    one.
    """

    vertices_m: Array
    faces: Faces
    gap_m: float
    volume_rel: float


def hull(solid: Solid, max_vertices: int = 128) -> Hull:
    """The convex hull with at most `max_vertices` of the mesh's own vertices, its feet always among them.

    The vertex that stands out furthest is added until the budget is used. Raises MeshError for a budget that is too
    small.
    """
    from scipy.spatial import ConvexHull

    full = ConvexHull(solid.vertices_m)
    corners = solid.vertices_m[np.sort(full.vertices)]
    feet = solid.feet_m[_on_hull(solid.feet_m, corners)]
    least = max(LEAST_VERTICES, len(feet) + 4)
    if max_vertices < least:
        raise MeshError(f"a hull budget of at least {least} vertices", str(max_vertices))
    chosen, gap = thinned(corners, feet, max_vertices)
    return Hull(chosen, outward(chosen), gap, float(ConvexHull(chosen).volume / full.volume - 1.0))


def thinned(points_m: Array, first_m: Array | None, max_vertices: int) -> tuple[Array, float]:
    """At most `max_vertices` corners (k, 3) of the hull of points (n, 3), and how far the hull stands out of theirs at most, m.

    Those of `first_m` and the outermost along the axes come first, then always the one that stands out furthest: the hull of
    what is chosen lies within the full one.
    """
    from scipy.spatial import ConvexHull

    corners = points_m[np.sort(ConvexHull(points_m).vertices)]
    if len(corners) <= max_vertices:
        return corners, 0.0
    extremes = corners[np.unique([*corners.argmax(axis=0), *corners.argmin(axis=0), *_spread(corners)])]
    chosen = np.unique(extremes if first_m is None else np.vstack([first_m, extremes]), axis=0)
    while True:
        sides = ConvexHull(chosen).equations
        outside = (corners @ sides[:, :3].T + sides[:, 3]).max(axis=1)
        furthest = int(np.argmax(outside))
        gap = float(outside[furthest])
        if len(chosen) >= max_vertices or gap <= 1e-9:
            return chosen, gap
        chosen = np.vstack([chosen, corners[furthest]])


def _spread(corners: Array) -> list[int]:
    """Indices of four corners that span a volume, whatever the body's position: furthest from a point, a line, a plane."""
    chosen = [int(np.argmax(np.linalg.norm(corners - corners.mean(axis=0), axis=1)))]
    offset = corners - corners[chosen[0]]
    chosen.append(int(np.argmax(np.linalg.norm(offset, axis=1))))
    away = np.cross(offset, offset[chosen[1]])
    chosen.append(int(np.argmax(np.linalg.norm(away, axis=1))))
    return [*chosen, int(np.argmax(np.abs(offset @ away[chosen[2]])))]


def _on_hull(feet: Array, corners: Array) -> NDArray[np.bool_]:
    """Which feet are corners of the full hull."""
    return np.asarray((feet[:, None, :] == corners[None, :, :]).all(axis=2).any(axis=1))


def outward(points: Array) -> Faces:
    """Triangles (m, 3) of the convex hull of points (k, 3), all of them corners, outward by the right-hand rule."""
    from scipy.spatial import ConvexHull

    hull = ConvexHull(points)
    faces = hull.simplices.astype(np.int64)
    normals = np.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]])
    inward = np.einsum("ij,ij->i", normals, hull.equations[:, :3]) < 0.0
    faces[inward] = faces[inward][:, ::-1]
    return faces


@lru_cache(maxsize=8)
def hull_excess_rel(solid: Solid, below_m: float) -> float:
    """Volume of the statue's hull below a height over that of the mesh, less one: 0 for a convex statue; exact cuts."""
    from manifold3d import Manifold

    down = (0.0, 0.0, -1.0)
    hull_part = Manifold.hull_points(np.array(solid.vertices_m)).trim_by_plane(down, -below_m)
    body = manifold(solid.vertices_m, solid.faces).trim_by_plane(down, -below_m)
    return float(hull_part.volume() / body.volume() - 1.0)
