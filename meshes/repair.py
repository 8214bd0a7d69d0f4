"""Small repairs of a scan's triangles, each on its own: it returns the mesh and the change, None if there was nothing
to do."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from meshes.errors import MeshError
from meshes.hollow import OUTSIDE_REL
from meshes.mesh import RawMesh, double_areas, drop_unused, manifold, unique_rows
from meshes.processing_log import Change, change, measure
from meshes.topology import EdgeCount, Edges, parts, wound_alike

Repaired = tuple[RawMesh, Change | None]
Part = tuple[NDArray[np.float64], NDArray[np.int64]]
"""Vertices (n, 3) and outward triangles (m, 3) of a closed surface."""


def drop_duplicates(mesh: RawMesh) -> Repaired:
    """Faces over the same three vertices made one."""
    unique = np.sort(unique_rows(np.sort(mesh.faces, axis=1))[0])
    removed = len(mesh.faces) - len(unique)
    if not removed:
        return mesh, None
    return mesh.with_faces(mesh.faces[unique]), Change("prepared_duplicates", "duplicates", {"faces": removed}, removed)


def drop_debris(mesh: RawMesh, largest_share: float) -> Repaired:
    """Separate parts with less than `largest_share` of the largest part's area removed."""
    number = parts(mesh.faces)
    areas = np.bincount(number, weights=0.5 * np.linalg.norm(double_areas(mesh.vertices, mesh.faces), axis=1))
    small = areas < largest_share * areas.max()
    if not small.any():
        return mesh, None
    cleaned = mesh.with_faces(mesh.faces[~small[number]])
    count = int(small.sum())
    values = {"pieces": count, "largest": float(areas[small].max() / areas.max())}
    return cleaned, change(Change("prepared_debris", "debris", values, count), measure(mesh), measure(cleaned))


def open_branches(mesh: RawMesh, largest_share: float) -> Repaired:
    """At edges with more than two faces those that stick out removed, else all, to be closed as holes.

    Raises MeshError if they are too many.
    """
    edges = Edges.of(mesh.faces)
    branching = np.repeat(edges.faces_at > 2, edges.faces_at)
    count = int((edges.faces_at > 2).sum())
    if count == 0:
        return mesh, None
    if count > max(3, largest_share * len(edges.faces_at)):
        raise MeshError(
            "edges with two faces each",
            f"{count} of {len(edges.faces_at)} with more (non-manifold)",
            "in MeshLab use Repair Non Manifold Edges, in Blender select Non Manifold and dissolve",
            place=mesh.source,
        )
    bad = np.unique(edges.face[branching])
    free = np.unique(edges.face[np.repeat(edges.faces_at == 1, edges.faces_at)])
    fins = np.intersect1d(bad, free)
    if len(fins):
        trimmed = mesh.with_faces(np.delete(mesh.faces, fins, axis=0))
        if EdgeCount.of(trimmed.faces).branching == 0:
            values = {"edges": count, "faces": len(fins)}
            return trimmed, Change("prepared_fins", "non-manifold", values, len(fins))
    opened = mesh.with_faces(np.delete(mesh.faces, bad, axis=0))
    return opened, Change("prepared_branches", "non-manifold", {"edges": count, "faces": len(bad)}, len(bad))


def wind_alike(mesh: RawMesh) -> Repaired:
    """Neighbouring faces given one sense."""
    if EdgeCount.of(mesh.faces).misoriented == 0:
        return mesh, None
    faces, turned = wound_alike(mesh.faces)
    made = Change("prepared_wound", "orientation", {"faces": turned}, turned)
    return RawMesh(mesh.vertices, faces, mesh.source), made


def turn_outward(mesh: RawMesh) -> Repaired:
    """A surface that is inside out turned, its holes thought closed."""
    if measure(mesh).volume_m3 >= 0.0:
        return mesh, None
    turned = RawMesh(mesh.vertices, np.ascontiguousarray(mesh.faces[:, ::-1]), mesh.source)
    return turned, Change("prepared_inside_out", "orientation", {}, len(mesh.faces))


def join_bodies(mesh: RawMesh) -> Repaired:
    """Several closed parts made one body, the largest first: one that faces inward inside it becomes a hollow, others are joined.

    Raises MeshError for parts that stay apart, and a shell that faces inward partly outside.
    """
    number = parts(mesh.faces)
    count = int(number.max()) + 1
    if count == 1:
        return mesh, None
    pieces = [drop_unused(mesh.vertices, mesh.faces[number == k]) for k in range(count)]
    if all(EdgeCount.of(faces).closed for _, faces in pieces):
        body, kinds = _assembled(pieces, mesh.source)
        if sum(measure(RawMesh(*part, "")).volume_m3 > 0.0 for part in _apart(body)) == 1:
            joined = RawMesh(*body, mesh.source)
            made = Change("prepared_bodies", "bodies", kinds, count)
            return joined, change(made, measure(mesh), measure(joined))
    sizes = ", ".join(" × ".join(f"{value:.3g}" for value in np.ptp(vertices, axis=0)) for vertices, _ in pieces[:4])
    raise MeshError(
        "one statue",
        f"{count} separate bodies of {sizes} units",
        "export each to a file of its own (MeshLab: Split in Connected Components), or give a hollow"
        " statue's inner shell as a second file",
        place=mesh.source,
    )


def _apart(surface: Part) -> list[Part]:
    number = parts(surface[1])
    return [drop_unused(surface[0], surface[1][number == k]) for k in range(int(number.max(initial=-1)) + 1)]


def _assembled(pieces: Sequence[Part], source: str) -> tuple[Part, dict[str, int]]:
    """The body of closed parts, and how many beside the largest were joined, turned, kept as hollows, counted as solid."""
    volumes = [measure(RawMesh(*piece, source)).volume_m3 for piece in pieces]
    body, kinds = manifold(np.empty((0, 3)), np.empty((0, 3), dtype=np.int64)), list[str]()
    for volume, (vertices, faces) in sorted(zip(volumes, pieces, strict=True), key=lambda each: -abs(each[0])):
        piece = manifold(vertices, faces if volume >= 0.0 else faces[:, ::-1])
        inside = (piece ^ body).volume() / max(abs(volume), np.finfo(np.float64).tiny)
        if volume < 0.0 and 0.5 < inside < 1.0 - OUTSIDE_REL:
            raise MeshError(
                "an inner shell inside the statue",
                f"one that faces inward with {100.0 * (1.0 - inside):.3g} % of its volume outside",
                "cut both shells where they meet, or turn its faces if it is a part of the body",
                place=source,
            )
        hollow = volume < 0.0 and inside > 0.5
        buried = volume > 0.0 and inside > 1.0 - OUTSIDE_REL
        kinds.append("hollow" if hollow else "turned" if volume < 0.0 else "buried" if buried else "joined")
        body = body - piece if hollow else body + piece
    mesh = body.to_mesh64()
    return (
        np.asarray(mesh.vert_properties[:, :3], dtype=np.float64),
        np.asarray(mesh.tri_verts, dtype=np.int64),
    ), Counter(kinds[1:])
