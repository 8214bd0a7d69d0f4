"""Where a surface passes through itself: pairs of triangles of which one's edge pierces the other."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Faces = NDArray[np.int64]

CHUNK = 20_000
"""Faces looked at in one go."""


@dataclass(frozen=True)
class Crossings:
    """How many of the faces looked at pierce, or are pierced by, a face without a common vertex."""

    faces: int
    looked_at: int

    @property
    def share(self) -> float:
        """Share of the faces looked at."""
        return self.faces / self.looked_at


def crossings(vertices: Array, faces: Faces, most: int = 100_000) -> Crossings:
    """Self-intersections of a surface, each face against all others; of a larger surface a fixed random choice of
    `most`."""
    chosen = np.arange(len(faces))
    if len(faces) > most:
        chosen = np.sort(np.random.default_rng(0).choice(len(faces), most, replace=False))
    found = 0
    for one, other in _close_pairs(vertices, faces, chosen):
        shared = (faces[one][:, :, None] == faces[other][:, None, :]).any(axis=(1, 2))
        one, other = one[~shared], other[~shared]
        through = _pierced(vertices, faces, one, other) | _pierced(vertices, faces, other, one)
        found += len(np.unique(one[through]))
    return Crossings(found, len(chosen))


def _close_pairs(vertices: Array, faces: Faces, chosen: Faces) -> Iterator[tuple[Faces, Faces]]:
    """Pairs (chosen face, other face) whose bounding boxes overlap, some thousand at a time so that memory stays
    small."""
    from shapely import STRtree, box

    corners = vertices[faces]
    low, high = corners.min(axis=1), corners.max(axis=1)
    first, second, third = np.argsort(np.ptp(vertices, axis=0))[::-1]
    boxes = box(low[:, first], low[:, second], high[:, first], high[:, second])
    tree = STRtree(boxes)
    for begin in range(0, len(chosen), CHUNK):
        some = chosen[begin : begin + CHUNK]
        place, other = tree.query(boxes[some])
        one = some[place]
        keep = (one != other) & (low[one, third] <= high[other, third]) & (low[other, third] <= high[one, third])
        yield one[keep], other[keep]


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
