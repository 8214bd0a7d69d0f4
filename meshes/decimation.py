"""Fewer triangles within stated bounds on volume, centroid and inertia; vertices of the base are never touched."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshes.errors import Doubt, MeshError
from meshes.hole_filling import close_pinches
from meshes.mesh import Faces, RawMesh, drop_unused, unique_rows, weld
from meshes.processing_log import Change, change, measure
from meshes.repair import open_branches
from meshes.topology import EdgeCount

PINCHED_SHARE = 0.02
"""Edge collapses may pinch at most this share of the edges, or the decimation is given up."""

FEWEST = 100
"""Triangles that a statue above its base has at least: with fewer quadric errors say nothing of its shape."""

ROUNDS = 5
"""Closing one pinch may touch the next; rounds of opening and closing before the decimation is given up."""


@dataclass(frozen=True)
class Bounds:
    """The most that decimation may change: volume, centroid as a share of the height, inertia."""

    volume_rel: float = 1e-3
    centroid_share: float = 5e-4
    inertia_rel: float = 2e-3


def decimate(
    mesh: RawMesh, max_faces: int, keep_below_m: float, bounds: Bounds
) -> tuple[RawMesh, Change | None, Doubt | None]:
    """A closed mesh with about `max_faces` triangles, or with as few as the bounds allow; unchanged if that is not
    fewer. The third is why more were kept than asked, None where they were not.

    Faces with a vertex up to `keep_below_m` over the lowest point are kept as they are.
    """
    height = float(np.ptp(mesh.vertices[:, 2]))
    before = measure(mesh)
    target, why = max_faces, dict[str, object]()

    def kept(faces: int) -> Doubt | None:
        return Doubt("scan_faces_kept", {"faces": faces, "asked": max_faces, **why}) if why else None

    while target < 0.9 * len(mesh.faces):
        fewer = simplified(mesh, target, keep_below_m)
        if isinstance(fewer, dict):
            broken = fewer
        else:
            faces = {"before": len(mesh.faces), "after": len(fewer.faces)}
            made = Change("prepared_decimated", "decimation", faces, len(mesh.faces) - len(fewer.faces))
            made = change(made, before, measure(fewer))
            broken = _beyond(made, bounds, height)
            if not broken:
                return fewer, made, kept(len(fewer.faces))
        why = why or broken
        target *= 2
    return mesh, None, kept(len(mesh.faces))


def _beyond(made: Change, bounds: Bounds, height_m: float) -> dict[str, object]:
    """Which bound a decimation broke, and by how much; empty for none."""
    if made.volume_rel is None or made.centroid_m is None or made.inertia_rel is None:
        return {"cause": "encloses_nothing"}
    if abs(made.volume_rel) > bounds.volume_rel:
        return {"cause": "volume", "change": made.volume_rel, "limit": bounds.volume_rel}
    if made.centroid_m > bounds.centroid_share * height_m:
        return {"cause": "centroid", "moved_m": made.centroid_m, "limit_m": bounds.centroid_share * height_m}
    if abs(made.inertia_rel) > bounds.inertia_rel:
        return {"cause": "inertia", "change": made.inertia_rel, "limit": bounds.inertia_rel}
    return {}


def simplified(mesh: RawMesh, max_faces: int, keep_below_m: float) -> RawMesh | dict[str, object]:
    """The mesh with its faces above the base simplified by quadric error, or why that cannot be."""
    from fast_simplification import simplify

    level = mesh.vertices[:, 2].min() + keep_below_m
    low = (mesh.vertices[:, 2] <= level)[mesh.faces].any(axis=1)
    target = max_faces - int(low.sum())
    if target < FEWEST or not (~low).any():
        return {"cause": "base", "base": int(low.sum()), "fewest": FEWEST}
    vertices, faces = drop_unused(mesh.vertices, mesh.faces[~low])
    reduction = 1.0 - target / len(faces)
    if reduction <= 0.0:
        return {"cause": "nothing_to_leave_out"}
    points, triangles = simplify(vertices, faces.astype(np.int32), reduction, preserve_border=True)[:2]
    base_vertices, base_faces = drop_unused(mesh.vertices, mesh.faces[low])
    joined = weld(
        RawMesh(
            np.vstack([base_vertices, points]),
            np.vstack([base_faces, triangles.astype(np.int64) + len(base_vertices)]),
            mesh.source,
        )
    )
    sound = _sound(joined)
    return {"cause": "breaks"} if sound is None else sound


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
    number = unique_rows(np.sort(faces, axis=1))[1]
    return np.asarray(faces[np.bincount(number)[number] == 1])
