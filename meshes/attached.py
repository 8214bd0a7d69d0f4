"""A floor or plate scanned together with a statue: seen by its width under a body, and cut off where the caller says so."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from meshes.errors import MeshError
from meshes.mesh import Array, Faces, RawMesh, weld

WIDER: Final = 3.0
"""Area under the body over that of the whole body above, from which the lowest layer is a floor.

The plinth of a scanned standing figure has 2.1 times the figure's own area seen from above, a bust's base 1.0.
"""
LAYER: Final = 0.15
"""Share of the height in which a floor ends: a block as high is a pedestal, and no mistake of scanning."""
SHEET: Final = 0.02
SHEET_WIDER: Final = 1.3
"""A floor that is no wider than a plinth is thinner: under this share of the height, and so many times as wide as all above it.

In their lowest fiftieth scanned and generated statues with plinths have at most 0.99 times the area above them, up to twice it at
a twentieth.
"""
PLINTH: Final = 1.5
"""A thicker layer of so many times the area, and under `WIDER`, may be the statue's plinth or a floor: it is said, and kept."""
STEPS: Final = 60
FILLET: Final = 0.95
"""The cut lies where the area of what is above falls by less than a twentieth a step: above the fillet that a scan leaves."""
ON_CUT: Final = 1e-9
"""Points this near to a cut, as a share of the height, are on it: rounding, far below what a scan resolves."""


@dataclass(frozen=True)
class Floor:
    """A lowest layer that is `times` as wide in area as all that stands on it, and the height at which to cut it off.

    It is `certain` where no plinth is so wide, or so thin.
    """

    times: float
    cut_m: float
    certain: bool = True

    def __str__(self) -> str:
        what = "a floor or a plate scanned together with the statue" if self.certain else "its plinth, or a floor"
        return f"the lowest {self.cut_m:.3g} m spread over {self.times:.3g} times the area of all that stands on them: {what}"


def attached_floor(vertices_m: Array, faces: Faces) -> Floor | None:
    """The floor under a body with z up, or None; its areas are those of convex hulls seen from above."""
    bottom, height = float(vertices_m[:, 2].min()), float(np.ptp(vertices_m[:, 2]))
    levels = bottom + LAYER * height * np.arange(1, STEPS + 1) / STEPS
    below, above = _areas(vertices_m, faces, levels)
    if not above.min() > 0.0:
        return None
    sheet = round(SHEET / LAYER * STEPS) - 1
    wide, thin = float(below[-1] / above.min()), float(below[sheet] / above[sheet])
    certain = wide >= WIDER or thin >= SHEET_WIDER
    if not certain and wide < PLINTH:
        return None
    times, limit = (
        (thin, below[sheet] / SHEET_WIDER)
        if wide < WIDER and certain
        else (wide, below[-1] / (WIDER if certain else PLINTH))
    )
    first = int(np.argmax(above <= limit))
    while first + 1 < STEPS and above[first + 1] < FILLET * above[first]:
        first += 1
    return Floor(times, float(levels[first] - bottom), certain)


def _areas(vertices: Array, faces: Faces, levels: Array) -> tuple[Array, Array]:
    """Areas of the hulls of what is below each level and of what is above it, the sections themselves in both."""
    band = np.searchsorted(levels, vertices[:, 2])
    a, b = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    through = band[a] != band[b]
    start, end = vertices[a[through]], vertices[b[through]]
    order = np.argsort(band, kind="stable")
    bands = np.split(vertices[order], np.searchsorted(band[order], np.arange(1, len(levels) + 1)))
    sections = [_section(start, end, level) for level in levels]
    below, above, outer = [], [], np.empty((0, 3))
    for points, section in zip(bands[:-1], sections, strict=True):
        outer = _outer(np.vstack([outer, points]))
        below.append(_area(np.vstack([outer, section])))
    outer = np.empty((0, 3))
    for points, section in zip(bands[:0:-1], sections[::-1], strict=True):
        outer = _outer(np.vstack([outer, points]))
        above.append(_area(np.vstack([outer, section])))
    return np.array(below), np.array(above[::-1])


def _section(start: Array, end: Array, level: float) -> Array:
    """Where the edges between two sets of points (n, 3) pass a level."""
    through = (start[:, 2] - level) * (end[:, 2] - level) < 0.0
    a, b = start[through], end[through]
    return np.asarray(a + ((level - a[:, 2]) / (b[:, 2] - a[:, 2]))[:, None] * (b - a))


def _outer(points: Array) -> Array:
    """Those of points (n, 3) that lie on their hull seen from above."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        return points[ConvexHull(points[:, :2]).vertices]
    except (QhullError, ValueError):
        return points


def _area(points: Array) -> float:
    from scipy.spatial import ConvexHull, QhullError

    try:
        return float(ConvexHull(points[:, :2]).volume)
    except (QhullError, ValueError):  # on a line, or too few
        return 0.0


def cut_below(mesh: RawMesh, height_m: float) -> RawMesh:
    """The mesh in metres, z up, without what lies lower than `height_m` above its lowest point; open there.

    Raises MeshError where nothing would be left.
    """
    from trimesh.intersections import slice_faces_plane

    low, size = float(mesh.vertices[:, 2].min()), float(np.ptp(mesh.vertices[:, 2]))
    if not 0.0 < height_m < size:
        raise MeshError(
            f"a cut between the lowest and the highest point, {size:.4g} m above it",
            f"{height_m:g} m",
            place=mesh.source,
        )
    level = low + height_m
    vertices, faces, _ = slice_faces_plane(  # type: ignore[no-untyped-call]
        mesh.vertices, mesh.faces, plane_normal=[0.0, 0.0, 1.0], plane_origin=[0.0, 0.0, level]
    )
    # Each face beside the cut has its own points there; exactly level and welded, the cut stays closed.
    vertices[np.abs(vertices[:, 2] - level) < ON_CUT * size, 2] = level
    return weld(RawMesh(vertices, faces, mesh.source))
