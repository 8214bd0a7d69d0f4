"""How the triangles of a mesh hang together, and the written log of a preparation: every change, its extent, and what it did to
volume, centroid and inertia.
"""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from meshes.mesh import Doubt, Faces, RawMesh
from meshes.solid import MassProperties

# How the triangles of a mesh hang together: edges, parts, rims of holes, orientation.

Indices = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Edges:
    """Undirected edges of a mesh: the half-edges sorted so that those of one edge are neighbours.

    `start` and `end` (3m,) are the half-edges' vertices, `face` (3m,) their faces, `first` (e,) the first half-edge of each edge
    and `faces_at` (e,) how many faces meet there.
    """

    start: Indices
    end: Indices
    face: Indices
    first: Indices
    faces_at: Indices

    @classmethod
    def of(cls, faces: Faces) -> Self:
        """The edges of `faces` (m, 3)."""
        start = faces.ravel()
        end = np.roll(faces, -1, axis=1).ravel()
        key = np.minimum(start, end) * (int(faces.max(initial=0)) + 1) + np.maximum(start, end)
        order = np.argsort(key, kind="stable")
        first = np.flatnonzero(np.r_[True, np.diff(key[order]) != 0])
        return cls(start[order], end[order], order // 3, first, np.diff(np.r_[first, len(order)]))


@dataclass(frozen=True)
class EdgeCount:
    """How many edges of a triangle mesh keep it from bounding a volume."""

    boundary: int
    branching: int
    misoriented: int

    @property
    def closed(self) -> bool:
        """Whether every edge has two faces that pass it in opposite directions."""
        return self.boundary == 0 and self.branching == 0 and self.misoriented == 0

    @classmethod
    def of(cls, faces: Faces) -> Self:
        """Counted over the undirected edges of `faces` (m, 3)."""
        edges = Edges.of(faces)
        pairs = edges.first[edges.faces_at == 2]
        return cls(
            boundary=int((edges.faces_at == 1).sum()),
            branching=int((edges.faces_at > 2).sum()),
            misoriented=int((edges.start[pairs] == edges.start[pairs + 1]).sum()),
        )


def connected(count: int, one: Indices, other: Indices) -> Indices:
    """Number (count,) of the group of each of so many things, of which these are joined in pairs."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(one), dtype=np.int8), (one, other)), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1])


def parts(faces: Faces) -> Indices:
    """Number (m,) of the part that each face belongs to, parts joined through common vertices, part 0 the one of face
    0."""
    ends = np.vstack([faces[:, :2], faces[:, 1:]])
    labels = connected(int(faces.max(initial=-1)) + 1, ends[:, 0], ends[:, 1])[faces[:, 0]]
    _, first, number = np.unique(labels, return_index=True, return_inverse=True)
    return np.argsort(np.argsort(first))[number].astype(np.int64)


def by_part(faces: Faces) -> list[Faces]:
    """The faces of each part."""
    number = parts(faces)
    return [faces[number == k] for k in range(int(number.max(initial=-1)) + 1)]


def rims(faces: Faces) -> list[Indices]:
    """The rims of all holes: vertices in order along the half-edges of the faces beside the hole, longest first.

    Where two holes share a vertex the walk is cut there, so that no rim passes a vertex twice.
    """
    edges = Edges.of(faces)
    alone = edges.first[edges.faces_at == 1]
    following: dict[int, list[int]] = {}
    for a, b in zip(edges.start[alone].tolist(), edges.end[alone].tolist(), strict=True):
        following.setdefault(a, []).append(b)
    loops: list[Indices] = []
    while following:
        walk = [next(iter(following))]
        place = {walk[0]: 0}
        while True:
            ways = following.get(walk[-1])
            if not ways:
                break  # an open chain (inconsistent winding): left to the caller's edge count
            step = ways.pop()
            if not ways:
                del following[walk[-1]]
            if step in place:
                ring = walk[place[step] :]
                loops.append(np.array(ring, dtype=np.int64))
                for vertex in ring[1:]:
                    del place[vertex]
                walk = walk[: place[step] + 1]
                if len(walk) == 1 and step not in following:
                    break
                continue
            place[step] = len(walk)
            walk.append(step)
    return sorted((ring for ring in loops if len(ring) > 2), key=len, reverse=True)


def wound_alike(faces: Faces) -> tuple[Faces, int]:
    """The faces turned so that neighbours agree, and how many were turned; the larger share of each part keeps its
    sense."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import breadth_first_order, connected_components

    edges = Edges.of(faces)
    pair = edges.first[edges.faces_at == 2]
    left, right = edges.face[pair], edges.face[pair + 1]
    weight = np.where(edges.start[pair] == edges.start[pair + 1], 2, 1).astype(np.int8)
    graph = coo_array(
        (np.r_[weight, weight], (np.r_[left, right], np.r_[right, left])), shape=(len(faces),) * 2
    ).tocsr()
    count, label = connected_components(graph, directed=False)
    turned = np.zeros(len(faces), dtype=bool)
    seeds = np.unique(label, return_index=True)[1]
    for part in range(count):
        order, before = breadth_first_order(graph, int(seeds[part]), directed=False)
        if len(order) < 2:
            continue
        through = np.asarray(graph[before[order[1:]], order[1:]]).ravel() == 2
        for face, parent, flip in zip(order[1:].tolist(), before[order[1:]].tolist(), through.tolist(), strict=True):
            turned[face] = turned[parent] ^ flip
        if 2 * int(turned[order].sum()) > len(order):
            turned[order] = ~turned[order]
    result = faces.copy()
    result[turned] = result[turned][:, ::-1]
    return result, int(turned.sum())


CHUNK = 200_000
"""Faces whose moments are summed in one go."""


@dataclass(frozen=True)
class Change:
    """One change of the mesh: what was done to how many things, and its effect (None where it has no meaning).

    `code` names what was done, `values` are numbers in the unit that ends their key, and names.
    """

    code: str
    step: str
    values: Mapping[str, Any]
    count: int
    volume_rel: float | None = None
    centroid_m: float | None = None
    inertia_rel: float | None = None

    def measured(self, before: RawMesh, after: RawMesh) -> Self:
        """The change with its effect; a volume that was nothing before (an open or inside-out mesh) gives no ratio."""
        old, new = measure(before), measure(after)
        if old.volume_m3 <= 0.0 or new.volume_m3 <= 0.0:
            return self
        shift = float(np.linalg.norm(new.centroid_m - old.centroid_m))
        old_trace, new_trace = (float(np.trace(each.inertia_per_density_m5)) for each in (old, new))
        return replace(
            self,
            volume_rel=new.volume_m3 / old.volume_m3 - 1.0,
            centroid_m=shift,
            inertia_rel=new_trace / old_trace - 1.0 if old_trace > 0.0 else math.nan,
        )


@dataclass(frozen=True)
class ProcessingLog:
    """All changes of one preparation in order, and what was found but left as it was."""

    source: str
    changes: tuple[Change, ...] = ()
    found: tuple[Doubt, ...] = ()

    def scaled(self, unit_m: float) -> Self:
        """The log with centroid shifts so far in the file's unit turned into metres."""
        turned = [
            change if change.centroid_m is None else replace(change, centroid_m=unit_m * change.centroid_m)
            for change in self.changes
        ]
        return replace(self, changes=tuple(turned))

    @property
    def invented_rel(self) -> dict[str, float]:
        """Volume taken away as debris or added as base and holes, signs ignored, by step: the limit on repair is held
        against their sum."""
        return {
            step: sum((abs(each.volume_rel or 0.0) for each in self.changes if each.step == step), 0.0)
            for step in ("debris", "base", "holes")
        }

    def as_dict(self) -> dict[str, object]:
        """The log as plain values."""
        return asdict(self)


def measure(mesh: RawMesh) -> MassProperties:
    """Mass properties of a mesh that may still have holes: as if each were closed by a cone to the middle of all rims.

    Each face makes a tetrahedron with that middle; their exact moments are summed some faces at a time, so that a scan of
    millions of faces stays small in memory.
    """
    open_rims = rims(mesh.faces)
    middle = 0.5 * (mesh.vertices.min(axis=0) + mesh.vertices.max(axis=0))
    if open_rims:
        middle = mesh.vertices[np.concatenate(open_rims)].mean(axis=0)
    six_volumes, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    for begin in range(0, len(mesh.faces), CHUNK):
        a, b, c = (mesh.vertices[mesh.faces[begin : begin + CHUNK, k]] - middle for k in range(3))
        weight = np.einsum("ij,ij->i", np.cross(a, b), c)
        total = a + b + c
        six_volumes += float(weight.sum())
        first += weight @ total
        for points in (a, b, c, total):
            second += (weight[:, None] * points).T @ points
    volume = six_volumes / 6.0
    centroid = first / (24.0 * volume) if volume else np.zeros(3)
    moments = second / 120.0 - volume * np.outer(centroid, centroid)
    return MassProperties(volume, centroid + middle, np.trace(moments) * np.eye(3) - moments)
