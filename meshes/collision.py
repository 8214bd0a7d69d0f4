"""Collision shapes by need: feet under the base, a convex hull within a vertex budget, a convex decomposition.

The base touches through the mesh's own vertices (`Solid.feet_m`) in every case. Hull and parts stand for the body
above it, where a wall
or a pedestal's edge can be met: the hull keeps the feet among its vertices, the parts are cut off a little above the
base, so that
they never carry the statue.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from meshes.decimation import simplified
from meshes.errors import MeshError
from meshes.mesh import RawMesh
from meshes.solid import Solid

Array = NDArray[np.float64]
Faces = NDArray[np.int64]

LEAST_VERTICES = 12
"""A hull with fewer vertices is no statue."""
COARSE_FACES = 3000
"""Triangles given to the decomposition: its search grows with them, its parts hardly change (20-fold slower at 21
000)."""


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
        raise MeshError(f"wanted a hull budget of at least {least} vertices, got {max_vertices}")
    if len(corners) <= max_vertices:
        return Hull(corners, _outward(corners), 0.0, 0.0)
    extremes = corners[np.unique([*corners.argmax(axis=0), *corners.argmin(axis=0)])]
    chosen = np.unique(np.vstack([feet, extremes]), axis=0)
    gap = 0.0
    while True:
        sides = ConvexHull(chosen).equations
        outside = (corners @ sides[:, :3].T + sides[:, 3]).max(axis=1)
        furthest = int(np.argmax(outside))
        gap = float(outside[furthest])
        if len(chosen) >= max_vertices or gap <= 1e-9:
            break
        chosen = np.vstack([chosen, corners[furthest]])
    return Hull(chosen, _outward(chosen), gap, float(ConvexHull(chosen).volume / full.volume - 1.0))


def _on_hull(feet: Array, corners: Array) -> NDArray[np.bool_]:
    """Which feet are corners of the full hull."""
    return np.asarray((feet[:, None, :] == corners[None, :, :]).all(axis=2).any(axis=1))


def _outward(points: Array) -> Faces:
    """Triangles (m, 3) of the convex hull of points (k, 3), all of them corners, outward by the right-hand rule."""
    from scipy.spatial import ConvexHull

    found = ConvexHull(points)
    faces = found.simplices.astype(np.int64)
    normals = np.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]])
    inward = np.einsum("ij,ij->i", normals, found.equations[:, :3]) < 0.0
    faces[inward] = faces[inward][:, ::-1]
    return faces


@lru_cache(maxsize=8)
def hull_excess_rel(solid: Solid, below_m: float) -> float:
    """Volume of the statue's hull below a height over that of the mesh, less one: 0 for a convex statue; exact cuts."""
    from manifold3d import Manifold, Mesh64

    down = (0.0, 0.0, -1.0)
    hull_part = Manifold.hull_points(np.array(solid.vertices_m)).trim_by_plane(down, -below_m)
    body = Manifold(Mesh64(np.array(solid.vertices_m), solid.faces.astype(np.uint64))).trim_by_plane(down, -below_m)
    return float(hull_part.volume() / body.volume() - 1.0)


@dataclass(frozen=True, eq=False)
class Parts:
    """Convex parts of the body above its base, each (vertices (k, 3), faces (m, 3)), and how they fill the statue.

    `volume_rel` is the parts' volume (overlaps counted once) against the mesh's above the same level, less one.
    """

    parts: tuple[tuple[Array, Faces], ...]
    volume_rel: float


def decompose(
    solid: Solid, concavity: float = 0.08, max_parts: int = 24, clearance_m: float = 2e-3, seed: int = 0
) -> Parts:
    """Convex decomposition (CoACD) of the body, coarsened first, cut off `clearance_m` above the base; deterministic
    for a seed.

    `concavity` is CoACD's threshold, the depth left between a part and its hull relative to the body's size (0.01 to
    1).
    """
    import coacd
    from manifold3d import Manifold, Mesh64, OpType

    if not 0.01 <= concavity <= 1.0:
        raise MeshError(f"wanted a concavity between 0.01 and 1, got {concavity:g}")
    coarse = simplified(RawMesh(solid.vertices_m, solid.faces, "solid"), COARSE_FACES, solid.contact_tolerance_m)
    vertices, faces = (solid.vertices_m, solid.faces) if coarse is None else (coarse.vertices, coarse.faces)
    coacd.set_log_level("error")
    raw = coacd.run_coacd(
        coacd.Mesh(vertices, faces.astype(np.int32)),
        threshold=concavity,
        max_convex_hull=max_parts,
        preprocess_mode="off",  # the mesh is closed already; remeshing would move its surface
        resolution=500,
        mcts_iterations=50,
        mcts_nodes=10,
        mcts_max_depth=2,
        decimate=True,
        max_ch_vertex=64,
        seed=seed,
    )
    up = (0.0, 0.0, 1.0)
    pieces = [Manifold.hull_points(np.asarray(vertices)).trim_by_plane(up, clearance_m) for vertices, _ in raw]
    pieces = [piece for piece in pieces if not piece.is_empty()]
    body = Manifold(Mesh64(np.array(solid.vertices_m), solid.faces.astype(np.uint64))).trim_by_plane(up, clearance_m)
    covered = Manifold.batch_boolean(pieces, OpType.Add).volume()
    found = []
    for piece in pieces:
        mesh = piece.to_mesh64()
        found.append((np.array(mesh.vert_properties[:, :3]), np.array(mesh.tri_verts, dtype=np.int64)))
    return Parts(tuple(found), float(covered / body.volume() - 1.0))
