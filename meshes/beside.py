"""A wall or a second body scanned together with a statue: seen in upright sections, cut off by an upright plane where asked."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, radians, sin
from typing import Final

import numpy as np

from meshes.mesh import Array, Doubt, Faces, RawMesh, area_vector, double_areas, require, triangulated, weld
from meshes.processing_log import rims

WALL_COVERS: Final = 0.7
"""Share of a body's outline seen against a direction that its outermost plane covers where it may be a wall; figures: 0.45."""
UPRIGHT: Final = 0.2
ALIKE_DEG: Final = 10.0
NECK: Final = 0.35
"""Upright section over the smaller of the largest ones to its sides, from which what lies beyond is a second body.

Scanned and generated figures have at least 0.75, two of them that touch 0.1, two on a slab of 3 % of their height 0.07.
"""
LEAST_VOLUME: Final = 0.05
SECTIONS: Final = 96
DIRECTIONS: Final = 18
COARSE: Final = 0.04
"""Edges longer than this share of the body are divided: a section counts whole faces."""


@dataclass(frozen=True)
class Beside:
    """What hangs on a statue, in words and as a doubt, and the cut: all farther than `distance_m` from the file's origin along
    `azimuth_deg`.
    """

    what: str
    doubt: Doubt
    azimuth_deg: float
    distance_m: float

    def __str__(self) -> str:
        return f"{self.what} towards {self.azimuth_deg:.0f}° (from x, counter-clockwise from above)"


def attached_beside(vertices_m: Array, faces: Faces) -> Beside | None:
    """The wall, else the second body on a body with z up; None where there is neither."""
    return _wall(vertices_m, faces) or _second_body(vertices_m, faces)


def _wall(vertices: Array, faces: Faces) -> Beside | None:
    """An upright plane of the hull that covers most of the body's outline and ends in a layer as a floor does."""
    from scipy.spatial import ConvexHull

    hull = ConvexHull(vertices)
    area = 0.5 * np.linalg.norm(double_areas(vertices, hull.simplices.astype(np.int64)), axis=1)
    normal = hull.equations[:, :3]
    left = np.where(np.abs(normal[:, 2]) < UPRIGHT, area, 0.0)
    while left.max() > 0.0:
        alike = (normal @ normal[int(left.argmax())] > cos(radians(ALIKE_DEG))) & (left > 0.0)
        x, y = (normal[alike, :2] * left[alike, None]).sum(axis=0)
        azimuth, covered = float(np.arctan2(y, x)), float(left[alike].sum())
        left[alike] = 0.0
        turned = vertices @ _turn(azimuth).T
        if covered < WALL_COVERS * float(ConvexHull(turned[hull.vertices, :2]).volume):
            continue
        layer = attached_floor(turned, faces)
        if layer is not None and layer.certain:
            said = f"an outermost {layer.cut_m:.3g} m of {layer.times:.3g} times the outline of all before it: a wall"
            return Beside(
                said,
                Doubt("scan_wall", {"layer_m": layer.cut_m, "times": layer.times}),
                azimuth_deg=float(np.rad2deg(azimuth)) % 360.0,
                distance_m=-float(turned[:, 2].min()) - layer.cut_m,
            )
    return None


def _second_body(vertices: Array, faces: Faces) -> Beside | None:
    """Two bodies with a narrow section between them, by the areas of sections across every tenth degree.

    The area at s is that of the surface before s projected along the direction (divergence theorem on the part before s).
    """
    from trimesh.remesh import subdivide_to_size

    longest = np.linalg.norm(vertices[faces] - vertices[np.roll(faces, -1, axis=1)], axis=2).max(axis=1)
    coarse = longest > COARSE * float(np.ptp(vertices, axis=0).max())
    fine: tuple[Array, Faces] = subdivide_to_size(  # type: ignore[no-untyped-call]
        vertices, faces[coarse], COARSE * float(np.ptp(vertices, axis=0).max())
    )
    corners = np.concatenate([vertices[faces[~coarse]], fine[0][fine[1]]])
    projected = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    middle = corners.mean(axis=1)
    found: list[tuple[float, Beside]] = []
    for azimuth in np.arange(DIRECTIONS) * np.pi / DIRECTIONS:
        along = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        places, first, last = middle @ along, float((vertices @ along).min()), float((vertices @ along).max())
        bins = np.clip(((places - first) / (last - first) * SECTIONS).astype(np.int64), 0, SECTIONS - 1)
        section = np.maximum(-np.cumsum(np.bincount(bins, projected @ along, SECTIONS))[:-1], 0.0)
        if not section.sum() > 0.0:
            continue
        before = np.cumsum(section) / section.sum()
        sides = np.minimum(np.maximum.accumulate(section), np.maximum.accumulate(section[::-1])[::-1])
        inside = (before > LEAST_VOLUME) & (before < 1.0 - LEAST_VOLUME) & (sides > 0.0)
        share = np.where(inside, section / np.where(sides > 0.0, sides, 1.0), np.inf)
        at = int(share.argmin())
        if share[at] > NECK:
            continue
        cut, beyond = first + (last - first) * (at + 1) / SECTIONS, 1.0 - float(before[at])
        far, least = beyond <= 0.5, min(beyond, 1.0 - beyond)
        body = Beside(
            f"a section of {100 * share[at]:.0f} % of those to its sides, and {100 * least:.0f} % of the volume beyond it:"
            " a second body",
            Doubt("scan_second_body", {"section": float(share[at]), "beyond": least}),
            azimuth_deg=float(np.rad2deg(azimuth)) + (0.0 if far else 180.0),
            distance_m=cut if far else -cut,
        )
        found.append((float(share[at]), body))
    return min(found, key=lambda each: each[0])[1] if found else None


def _turn(azimuth: float) -> Array:
    """The rotation (3, 3) that takes the horizontal direction of an azimuth, radians, to -z."""
    away = np.array([cos(azimuth), sin(azimuth), 0.0])
    side = np.array([-away[1], away[0], 0.0])
    return np.stack([side, np.cross(-away, side), -away])


def cut_beyond(mesh: RawMesh, azimuth_deg: float, distance_m: float) -> RawMesh:
    """The mesh in metres, z up, without what lies farther than `distance_m` along an azimuth; closed flat there.

    Raises MeshError where nothing or all would be left.
    """
    turn = _turn(radians(azimuth_deg))
    turned = mesh.moved(mesh.vertices @ turn.T)
    cut = cut_below(turned, -distance_m - float(turned.vertices[:, 2].min()))
    level = float(cut.vertices[:, 2].min())
    flat = [rim[::-1] for rim in rims(cut.faces) if cut.vertices[rim, 2].max() <= level]
    caps = [rim[triangulated(cut.vertices[rim], area_vector(cut.vertices[rim]))] for rim in flat]
    return cut.with_faces(np.vstack([cut.faces, *caps])).moved(cut.vertices @ turn)


# A floor or plate scanned together with a statue: seen by its width under a body, and cut off where the caller says so.

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
NEAR_CUT: Final = 1e-7
"""No vertex is nearer to a cut: faces that only just reach over it leave slivers that are welded away, and a torn rim."""
CUT_TRIES: Final = 20
"""So often a cut is raised by as much; a gap comes before, but in scans of tens of millions of points."""


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
    return _swept(bands[:-1], sections), _swept(bands[:0:-1], sections[::-1])[::-1]


def _swept(bands: Sequence[Array], sections: Sequence[Array]) -> Array:
    """Areas (k,) of the hulls of all bands up to each, with the section that ends it."""
    areas, outer = [], np.empty((0, 3))
    for points, section in zip(bands, sections, strict=True):
        outer = _hull(np.vstack([outer, points]))[0]
        areas.append(_hull(np.vstack([outer, section]))[1])
    return np.array(areas)


def _section(start: Array, end: Array, level: float) -> Array:
    """Where the edges between two sets of points (n, 3) pass a level."""
    through = (start[:, 2] - level) * (end[:, 2] - level) < 0.0
    a, b = start[through], end[through]
    return np.asarray(a + ((level - a[:, 2]) / (b[:, 2] - a[:, 2]))[:, None] * (b - a))


def _hull(points: Array) -> tuple[Array, float]:
    """Those of points (n, 3) that lie on their hull seen from above, and its area."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = ConvexHull(points[:, :2])
    except (QhullError, ValueError):  # on a line, or too few
        return points, 0.0
    return points[hull.vertices], float(hull.volume)


def cut_below(mesh: RawMesh, height_m: float) -> RawMesh:
    """The mesh in metres, z up, without what lies lower than `height_m` above its lowest point; open there.

    Raises MeshError where nothing would be left.
    """
    from trimesh.intersections import slice_faces_plane

    low, size = float(mesh.vertices[:, 2].min()), float(np.ptp(mesh.vertices[:, 2]))
    require(
        0.0 < height_m < (1.0 - CUT_TRIES * NEAR_CUT) * size,
        f"a cut between the lowest and the highest point, {size:.4g} m above it",
        f"{height_m:g} m",
        place=mesh.source,
    )
    level = low + height_m
    for _ in range(CUT_TRIES):
        if np.any(np.abs(mesh.vertices[:, 2] - level) < NEAR_CUT * size):
            level += NEAR_CUT * size
    vertices, faces, _ = slice_faces_plane(  # type: ignore[no-untyped-call]
        mesh.vertices, mesh.faces, plane_normal=[0.0, 0.0, 1.0], plane_origin=[0.0, 0.0, level]
    )
    # Each face beside the cut has its own points there; exactly level and welded, the cut stays closed.
    vertices[np.abs(vertices[:, 2] - level) < ON_CUT * size, 2] = level
    return weld(RawMesh(vertices, faces, mesh.source))
