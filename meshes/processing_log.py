"""The written log of a preparation: every change, its extent, and what it did to volume, centroid and inertia."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from meshes.errors import Doubt
from meshes.mesh import RawMesh
from meshes.solid import MassProperties
from meshes.topology import rims

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


@dataclass(frozen=True)
class ProcessingLog:
    """All changes of one preparation in order, and what was found but left as it was."""

    source: str
    changes: tuple[Change, ...] = ()
    found: tuple[Doubt, ...] = ()

    def with_doubts(self, *doubts: Doubt) -> ProcessingLog:
        """The log with what was found more."""
        return replace(self, found=(*self.found, *doubts))

    def and_changed(self, change: Change) -> ProcessingLog:
        """The log with one more change."""
        return replace(self, changes=(*self.changes, change))

    def scaled(self, unit_m: float) -> ProcessingLog:
        """The log with centroid shifts so far in the file's unit turned into metres."""
        turned = [
            change if change.centroid_m is None else replace(change, centroid_m=unit_m * change.centroid_m)
            for change in self.changes
        ]
        return replace(self, changes=tuple(turned))

    @property
    def invented_rel(self) -> float:
        """Volume taken away as debris or added as base and holes, signs ignored: what the limit on repair is held
        against."""
        changed = (change.volume_rel for change in self.changes if change.step in ("debris", "base", "holes"))
        return sum(abs(volume) for volume in changed if volume is not None)

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


def change(made: Change, before: MassProperties, after: MassProperties) -> Change:
    """The change with its effect; a volume that was nothing before (an open or inside-out mesh) gives no ratio."""
    if before.volume_m3 <= 0.0 or after.volume_m3 <= 0.0:
        return made
    shift = float(np.linalg.norm(after.centroid_m - before.centroid_m))
    trace_before, trace_after = (float(np.trace(p.inertia_per_density_m5)) for p in (before, after))
    inertia = trace_after / trace_before - 1.0 if trace_before > 0.0 else math.nan
    volume = after.volume_m3 / before.volume_m3 - 1.0
    return replace(made, volume_rel=volume, centroid_m=shift, inertia_rel=inertia)
