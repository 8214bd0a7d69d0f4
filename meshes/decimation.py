"""Fewer triangles within stated bounds on volume, centroid and inertia; vertices of the base are never touched."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshes.errors import MeshError
from meshes.hole_filling import close_pinches
from meshes.mesh import Faces, RawMesh, drop_unused, weld
from meshes.processing_log import Change, change, measure
from meshes.repair import open_branches
from meshes.topology import EdgeCount

PINCHED_SHARE = 0.02
"""Edge collapses may pinch at most this share of the edges, or the decimation is given up."""

ROUNDS = 5
"""Closing one pinch may touch the next; rounds of opening and closing before the decimation is given up."""


@dataclass(frozen=True)
class Bounds:
    """The most that decimation may change: volume, centroid as a share of the height, inertia."""

    volume_rel: float = 1e-3
    centroid_share: float = 5e-4
    inertia_rel: float = 2e-3


def decimate(mesh: RawMesh, max_faces: int, keep_below_m: float, bounds: Bounds) -> tuple[RawMesh, Change | None]:
    """A closed mesh with about `max_faces` triangles, or with as few as the bounds allow; unchanged if that is not
    fewer.

    Faces with a vertex up to `keep_below_m` over the lowest point are kept as they are.
    """
    height = float(np.ptp(mesh.vertices[:, 2]))
    before = measure(mesh)
    target = max_faces
    while target < 0.9 * len(mesh.faces):
        fewer = simplified(mesh, target, keep_below_m)
        if fewer is not None:
            what = f"{len(mesh.faces)} triangles reduced to {len(fewer.faces)}, the base kept"
            made = change("decimation", what, len(mesh.faces) - len(fewer.faces), before, measure(fewer))
            if _within(made, bounds, height):
                return fewer, made
        target *= 2
    return mesh, None


def _within(made: Change, bounds: Bounds, height_m: float) -> bool:
    """Whether a decimation kept its bounds."""
    if made.volume_rel is None or made.centroid_m is None or made.inertia_rel is None:
        return False
    return (
        abs(made.volume_rel) <= bounds.volume_rel
        and made.centroid_m <= bounds.centroid_share * height_m
        and abs(made.inertia_rel) <= bounds.inertia_rel
    )


def simplified(mesh: RawMesh, max_faces: int, keep_below_m: float) -> RawMesh | None:
    """The mesh with its faces above the base simplified by quadric error; None if that broke the closed surface."""
    from fast_simplification import simplify

    level = mesh.vertices[:, 2].min() + keep_below_m
    low = (mesh.vertices[:, 2] <= level)[mesh.faces].any(axis=1)
    target = max_faces - int(low.sum())
    if target < 100 or not (~low).any():
        return None
    vertices, faces = drop_unused(mesh.vertices, mesh.faces[~low])
    reduction = 1.0 - target / len(faces)
    if reduction <= 0.0:
        return None
    points, triangles = simplify(vertices, faces.astype(np.int32), reduction, preserve_border=True)[:2]
    base_vertices, base_faces = drop_unused(mesh.vertices, mesh.faces[low])
    joined = weld(
        RawMesh(
            np.vstack([base_vertices, points]),
            np.vstack([base_faces, triangles.astype(np.int64) + len(base_vertices)]),
            mesh.source,
        )
    )
    return _sound(joined)


def _sound(mesh: RawMesh) -> RawMesh | None:
    """The mesh without what edge collapses leave: faces back to back dropped, pinched edges opened, the holes
    closed."""
    for _ in range(ROUNDS):
        mesh = mesh.with_faces(_unfolded(mesh.faces))
        if EdgeCount.of(mesh.faces).closed:
            return mesh
        try:
            mesh, _ = open_branches(mesh, PINCHED_SHARE)
            mesh = close_pinches(mesh)
        except MeshError:
            return None
    return None


def _unfolded(faces: Faces) -> Faces:
    """The faces without those that lie on another one with the same three vertices."""
    while True:
        order = np.lexsort(np.sort(faces, axis=1).T)
        same = (np.diff(np.sort(faces, axis=1)[order], axis=0) == 0).all(axis=1)
        if not same.any():
            return faces
        folded = np.zeros(len(faces), dtype=bool)
        folded[order[:-1][same]] = True
        folded[order[1:][same]] = True
        faces = faces[~folded]
