"""A convex hull within a vertex budget, and how far a statue's hull is from the statue.

The base touches through the mesh's own vertices (`Solid.feet_m`) in every case, and so does whatever a flat wall meets. Hull
and convex parts (`meshes.decomposition`) stand for the body above the base where a pedestal's edge can be met.
"""

from functools import lru_cache

import numpy as np

from meshes.mesh import Array, manifold
from meshes.solid import Solid


def thinned(points_m: Array, max_vertices: int) -> tuple[Array, float]:
    """At most `max_vertices` corners (k, 3) of the hull of points (n, 3), and how far the hull stands out of theirs at most, m.

    The outermost along the axes come first, then always the one that stands out furthest: the hull of what is chosen lies within
    the full one.
    """
    from scipy.spatial import ConvexHull

    corners = points_m[np.sort(ConvexHull(points_m).vertices)]
    if len(corners) <= max_vertices:
        return corners, 0.0
    extremes = np.unique([*corners.argmax(axis=0), *corners.argmin(axis=0), *_spread(corners)])
    chosen = np.unique(corners[extremes], axis=0)
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


@lru_cache(maxsize=8)
def hull_excess_rel(solid: Solid, below_m: float) -> float:
    """Volume of the statue's hull below a height over that of the mesh, less one: 0 for a convex statue; exact cuts."""
    from manifold3d import Manifold

    down = (0.0, 0.0, -1.0)
    hull_part = Manifold.hull_points(np.array(solid.vertices_m)).trim_by_plane(down, -below_m)
    body = manifold(solid.vertices_m, solid.faces).trim_by_plane(down, -below_m)
    return float(hull_part.volume() / body.volume() - 1.0)
