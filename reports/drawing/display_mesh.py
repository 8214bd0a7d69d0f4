"""The statue's own mesh made ready for the screen: decimated where needed, edges kept sharp; its true outline as seen along y."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from harness.records.scene import SceneRecord
from reports.drawing.kinematics import StatueSection

Array = NDArray[np.float64]
Faces = NDArray[np.int64]

MOST_FACES: Final = 8_000
"""More faces than this do not show on a page: shaded smoothly, each is some six pixels wide; they would make it large."""
CREASE_RAD: Final = float(np.radians(38.0))
"""Faces that meet at a sharper angle, and hang together nowhere else, are drawn with an edge between them, as at a plinth."""

SMOOTHED: Final = 1.0 / 800.0
"""Bends of the outline smaller than this share of the height are left out: less than a pixel in every picture."""


def display_mesh(
    path: Path | None, shape: StatueSection, depth_m: float, most_faces: int = MOST_FACES
) -> tuple[Array, Faces]:
    """Vertices (n, 3) in the statue frame and faces (m, 3) of the mesh of a result folder, split along its creases.

    Of a statue given by numbers those of the block that stands for it.
    """
    if path is None:
        return _prism(shape.outline_m, depth_m)
    vertices, faces = read_mesh(path)
    if len(faces) > most_faces:
        vertices, faces = decimated(vertices, faces, most_faces)
    return _creased(vertices, faces)


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


def eye_axes(azimuth_rad: float, raised_rad: float) -> Array:
    """Rows: to the right, upwards and towards the eye, of an eye far away at that azimuth and so high."""
    eye = np.array([
        np.cos(raised_rad) * np.cos(azimuth_rad), np.cos(raised_rad) * np.sin(azimuth_rad), np.sin(raised_rad)
    ])  # fmt: skip
    right = np.array([-np.sin(azimuth_rad), np.cos(azimuth_rad), 0.0])
    return np.stack([right, np.cross(eye, right), eye])


def facing(vertices: Array, faces: Faces, eye: Array) -> tuple[NDArray[np.intp], Array]:
    """The faces that look at an eye far away in a direction (3,), the farthest first, and the unit normals (m, 3) of all."""
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), np.finfo(float).tiny)
    seen = np.flatnonzero(normals @ eye > 0.0)
    return seen[np.argsort(corners[seen].mean(axis=1) @ eye)], normals


def _prism(outline_m: Array, depth_m: float) -> tuple[Array, Faces]:
    """The silhouette pulled along y; the outline runs counter-clockwise as seen with x right and z up."""
    count = len(outline_m)
    rings = [np.insert(outline_m, 1, y, axis=1) for y in (-0.5 * depth_m, 0.5 * depth_m)]
    here = np.arange(count)
    after = np.roll(here, -1)
    front = np.column_stack([np.zeros_like(here), here, after])[1:-1]
    back = count + front[:, ::-1]
    sides = [np.column_stack([here, here + count, after]), np.column_stack([after, here + count, after + count])]
    return np.vstack(rings), np.vstack([front, back, *sides])


def _creased(vertices: Array, faces: Faces) -> tuple[Array, Faces]:
    """The surface with its vertices split along creases: what shares a vertex is shaded as one."""
    import trimesh

    mesh: Any = trimesh.Trimesh(vertices, faces, process=False)
    smooth = trimesh.graph.smooth_shade(mesh, angle=CREASE_RAD, facet_minarea=None)
    return np.asarray(smooth.vertices, dtype=np.float64), np.asarray(smooth.faces, dtype=np.int64)


def silhouette_m(scene: SceneRecord, mesh: Path | None) -> Array:
    """The outline (k, 2) in (x, z), statue frame: the mesh's shadow along y, or the section of a statue without one."""
    if mesh is None:
        return np.asarray(scene.statue.section_m, dtype=np.float64)
    return _shadow(mesh, mesh.stat().st_mtime_ns)


@lru_cache(maxsize=4)
def _shadow(mesh: Path, _changed_ns: int) -> Array:
    import shapely

    vertices, faces = read_mesh(mesh)
    corners = vertices[faces][:, :, [0, 2]]
    edges = corners[:, 1:] - corners[:, :1]
    towards = edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0] > 0.0
    shadow: Any = shapely.union_all(shapely.polygons(corners[towards]))
    whole = max(shapely.get_parts(shadow), key=lambda part: float(part.area))
    outline = shapely.Polygon(whole.exterior).simplify(SMOOTHED * float(np.ptp(vertices[:, 2]))).exterior
    return np.asarray(outline.coords, dtype=np.float64)[:-1]
