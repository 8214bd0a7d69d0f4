"""The statue's own mesh made ready for the screen: decimated where needed, edges kept sharp."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from reports.drawing.kinematics import Section

Array = NDArray[np.float64]
Faces = NDArray[np.int64]

MOST_FACES: Final = 8_000
"""More faces than this do not show on a page: shaded smoothly, each is some six pixels wide; they would make it large."""
CREASE_COS: Final = float(np.cos(np.radians(38.0)))
"""Faces that meet at a sharper angle are drawn with an edge between them, as at a plinth."""
BUSY_VERTEX: Final = 256


@dataclass(frozen=True, eq=False)
class DisplayMesh:
    """Vertices (n, 3) in the statue frame, unit normals (n, 3), faces (m, 3); `source_faces` is the count before decimation."""

    vertices_m: Array
    normals: Array
    faces: Faces
    source_faces: int


def display_mesh(path: Path | None, shape: Section, depth_m: float, most_faces: int = MOST_FACES) -> DisplayMesh:
    """The mesh of a result folder, or the block that stands for a statue given by numbers."""
    vertices, faces = _prism(shape.outline_m, depth_m) if path is None else read_mesh(path)
    count = len(faces)
    if count > most_faces:
        vertices, faces = decimated(vertices, faces, most_faces)
    return _creased(vertices, faces, count)


def read_mesh(path: Path) -> tuple[Array, Faces]:
    """Vertices (n, 3) in the statue frame and faces (m, 3) of the mesh in a result folder."""
    import trimesh

    mesh: Any = trimesh.load(path, force="mesh", process=False)
    return np.asarray(mesh.vertices, dtype=np.float64), np.asarray(mesh.faces, dtype=np.int64)


def decimated(vertices: Array, faces: Faces, most_faces: int) -> tuple[Array, Faces]:
    """The surface with so many faces or a few more, for the eye alone."""
    import fast_simplification

    share = 1.0 - most_faces / len(faces)
    points, triangles = fast_simplification.simplify(vertices.astype(np.float32), faces.astype(np.int32), share)
    return np.asarray(points, dtype=np.float64), np.asarray(triangles, dtype=np.int64)


def _prism(outline_m: Array, depth_m: float) -> tuple[Array, Faces]:
    """The silhouette pulled along y; the outline runs counter-clockwise as seen with x right and z up."""
    count = len(outline_m)
    half = 0.5 * depth_m
    rings = [np.column_stack([outline_m[:, 0], np.full(count, y), outline_m[:, 1]]) for y in (-half, half)]
    front = [(0, k, k + 1) for k in range(1, count - 1)]
    back = [(count, count + k + 1, count + k) for k in range(1, count - 1)]
    sides = []
    for k in range(count):
        after = (k + 1) % count
        sides += [(k, k + count, after), (after, k + count, after + count)]
    return np.vstack(rings), np.array(front + back + sides, dtype=np.int64)


def _creased(vertices: Array, faces: Faces, source_faces: int) -> DisplayMesh:
    """Split vertices along creases, so that smooth stays smooth and sharp stays sharp."""
    corners = vertices[faces]
    weighted = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(weighted, axis=1, keepdims=True)
    flat = weighted / np.where(size > 0.0, size, 1.0)
    of_corner = np.repeat(np.arange(len(faces)), 3)
    normals = weighted[of_corner].copy()
    first, second = _corner_pairs(faces.ravel())
    smooth = np.einsum("ij,ij->i", flat[of_corner[first]], flat[of_corner[second]]) > CREASE_COS
    np.add.at(normals, first[smooth], weighted[of_corner[second[smooth]]])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    normals /= np.where(length > 0.0, length, 1.0)
    keys = np.column_stack([faces.ravel(), np.round(normals * 60.0).astype(np.int64)])
    _, unique_at, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    return DisplayMesh(vertices[faces.ravel()[unique_at]], normals[unique_at], inverse.reshape(-1, 3), source_faces)


def _corner_pairs(vertex_of_corner: NDArray[np.int64]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """All ordered pairs of different face corners that share a vertex (none at vertices of very many faces)."""
    order = np.argsort(vertex_of_corner, kind="stable")
    starts = np.flatnonzero(np.diff(vertex_of_corner[order], prepend=-1))
    counts = np.diff(np.append(starts, len(order)))
    first, second = [], []
    for count in np.unique(counts):
        if count < 2 or count > BUSY_VERTEX:
            continue
        block = order[starts[counts == count][:, None] + np.arange(count)]
        for shift in range(1, count):
            first.append(block.ravel())
            second.append(np.roll(block, shift, axis=1).ravel())
    if not first:
        return np.zeros(0, dtype=np.intp), np.zeros(0, dtype=np.intp)
    return np.concatenate(first), np.concatenate(second)
