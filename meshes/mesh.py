"""A triangle mesh as it is handed from step to step."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# What goes wrong between a scan and a solid.


@dataclass(frozen=True)
class Doubt:
    """What is doubtful of a scan: `code` names it, `values` are numbers in the unit that ends their key, and names."""

    code: str
    values: Mapping[str, Any] = field(default_factory=dict)


class MeshError(ValueError):
    """The mesh cannot be used as it is: what was `wanted`, what came, what to do; `place` is the file, where it is told.

    `doubt` is the same of a mesh that is used all the same.
    """

    def __init__(self, wanted: str, got: str, advice: str = "", place: str = "", doubt: Doubt | None = None) -> None:
        super().__init__(wanted, got, advice, place, doubt)
        self.wanted, self.got, self.advice, self.place, self.doubt = wanted, got, advice, place, doubt

    def at(self, place: str) -> MeshError:
        """The same, in that file."""
        return MeshError(self.wanted, self.got, self.advice, place, self.doubt)

    def __str__(self) -> str:
        text = f"wanted {self.wanted}, got {self.got}" + (f" — {self.advice}" if self.advice else "")
        return f"{self.place}: {text}" if self.place else text


def require(holds: object, wanted: str, got: str, advice: str = "", place: str = "") -> None:
    """Raise `MeshError` unless it holds."""
    if not holds:
        raise MeshError(wanted, got, advice, place)


Faces = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class RawMesh:
    """Vertices (n, 3), triangles (m, 3) and where they came from; unit and axes are what the step says."""

    vertices: Array
    faces: Faces
    source: str

    def with_faces(self, faces: Faces) -> RawMesh:
        """The same vertices under other faces; vertices that none uses are dropped."""
        return RawMesh(*drop_unused(self.vertices, faces), self.source)

    def moved(self, vertices: Array) -> RawMesh:
        """The same faces over moved vertices."""
        return RawMesh(vertices, self.faces, self.source)


def drop_unused(vertices: Array, faces: Faces) -> tuple[Array, Faces]:
    """The vertices that some face uses, in their order, and the faces renumbered."""
    used = np.zeros(len(vertices), dtype=bool)
    used[faces.ravel()] = True
    return vertices[used], (np.cumsum(used) - 1)[faces]


def manifold(vertices: Array, faces: Faces) -> Any:
    """A closed surface as the body of manifold3d, for exact Boolean operations."""
    from manifold3d import Manifold, Mesh64

    return Manifold(Mesh64(np.array(vertices), np.ascontiguousarray(faces, dtype=np.uint64)))


def double_areas(vertices: Array, faces: Faces) -> Array:
    """Normals (m, 3) of the faces, outward by the right-hand rule, as long as twice the face's area."""
    first = vertices[faces[:, 0]]
    return np.cross(vertices[faces[:, 1]] - first, vertices[faces[:, 2]] - first)


def area_vector(points: Array) -> Array:
    """Area vector (3,) of a closed polygon (n, 3) in space (Newell): its normal, as long as its area."""
    centred = points - points.mean(axis=0)
    return np.asarray(0.5 * np.cross(centred, np.roll(centred, -1, axis=0)).sum(axis=0))


def triangulated(polygon: Array, normal: Array) -> Faces:
    """Triangles (n - 2, 3) over a polygon (n, 3), concave ones too, seen flat along `normal`, in the polygon's own sense."""
    from manifold3d import triangulate

    normal = normal / np.linalg.norm(normal)
    helper = np.eye(3)[int(np.argmin(np.abs(normal)))]
    right = np.cross(helper, normal)
    right /= np.linalg.norm(right)
    flat = np.column_stack([polygon @ right, polygon @ np.cross(normal, right)])
    return np.asarray(triangulate([flat]), dtype=np.int64).reshape(-1, 3)


def fan(corners: int) -> Faces:
    """Triangles (n - 2, 3) of a polygon of so many corners, all from its first one."""
    ring = np.arange(1, corners - 1, dtype=np.int64)
    return np.column_stack([np.zeros_like(ring), ring, ring + 1])


def unique_rows(rows: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Of the different rows (n, k) the first place of each, and the number (n,) of each row among them."""
    order = np.lexsort(rows.T)
    new = np.r_[True, (np.diff(rows[order], axis=0) != 0).any(axis=1)]
    number = np.empty(len(order), dtype=np.int64)
    number[order] = np.cumsum(new) - 1
    return order[new], number


def weld(mesh: RawMesh) -> RawMesh:
    """Coincident vertices (within 1e-9 of the extent: texture seams, STL corners) made one, degenerate and unused
    parts dropped."""
    extent = float(np.ptp(mesh.vertices, axis=0).max())
    require(extent != 0.0, "a surface", "all vertices in one place", "export it again", place=mesh.source)
    keys = np.round((mesh.vertices - mesh.vertices.min(axis=0)) / (1e-9 * extent)).astype(np.int64)
    first, number = unique_rows(keys)
    faces = first[number][mesh.faces]
    proper = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    require(proper.any(), "a surface", "only faces without an area", "export it again", place=mesh.source)
    vertices, faces = drop_unused(mesh.vertices, faces[proper])
    return RawMesh(vertices, faces, mesh.source)
