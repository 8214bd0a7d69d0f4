"""Where a surface passes through itself: pairs of triangles of which one's edge pierces the other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Faces = NDArray[np.int64]


def crossing_faces(vertices: Array, faces: Faces) -> Faces:
    """Indices (k,) of the triangles that another one without a common vertex pierces."""
    one, other = _close_pairs(vertices, faces)
    shared = (faces[one][:, :, None] == faces[other][:, None, :]).any(axis=(1, 2))
    one, other = one[~shared], other[~shared]
    through = _pierced(vertices, faces, one, other) | _pierced(vertices, faces, other, one)
    return np.unique(np.r_[one[through], other[through]])


def _close_pairs(vertices: Array, faces: Faces) -> tuple[Faces, Faces]:
    """Pairs of faces whose bounding boxes overlap."""
    from shapely import STRtree, box

    corners = vertices[faces]
    low, high = corners.min(axis=1), corners.max(axis=1)
    first, second, third = np.argsort(np.ptp(vertices, axis=0))[::-1]
    boxes = box(low[:, first], low[:, second], high[:, first], high[:, second])
    one, other = STRtree(boxes).query(boxes)
    keep = (one < other) & (low[one, third] <= high[other, third]) & (low[other, third] <= high[one, third])
    return one[keep], other[keep]


def _pierced(vertices: Array, faces: Faces, triangle: Faces, edges_of: Faces) -> NDArray[np.bool_]:
    """Whether any edge of `edges_of` passes through the inside of `triangle` (signed volumes, strictly)."""
    a, b, c = (vertices[faces[triangle, k]] for k in range(3))
    through = np.zeros(len(triangle), dtype=bool)
    for k in range(3):
        p, q = vertices[faces[edges_of, k]], vertices[faces[edges_of, (k + 1) % 3]]
        sides = _volume(a, b, c, p) * _volume(a, b, c, q) < 0.0
        turns = np.sign([_volume(p, q, a, b), _volume(p, q, b, c), _volume(p, q, c, a)])
        through |= sides & (np.abs(turns.sum(axis=0)) == 3)
    return through


def _volume(a: Array, b: Array, c: Array, d: Array) -> Array:
    """Six times the signed volume (n,) of tetrahedra."""
    return np.asarray(np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a))
