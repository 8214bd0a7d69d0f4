"""A wall or a second body scanned together with a statue: seen in upright sections, cut off by an upright plane where asked."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, radians, sin
from typing import Final

import numpy as np

from meshes.attached import attached_floor, cut_below
from meshes.errors import Doubt
from meshes.hole_filling import triangulated
from meshes.mesh import Array, Faces, RawMesh
from meshes.orientation import area_vector
from meshes.topology import rims

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
    corners = vertices[hull.simplices]
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
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
            doubt = Doubt("scan_wall", {"layer_m": layer.cut_m, "times": layer.times})
            return Beside(said, doubt, float(np.rad2deg(azimuth)) % 360.0, -float(turned[:, 2].min()) - layer.cut_m)
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
    narrowest: tuple[float, Beside] | None = None
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
        if share[at] > NECK or (narrowest is not None and share[at] >= narrowest[0]):
            continue
        cut, beyond = first + (last - first) * (at + 1) / SECTIONS, 1.0 - float(before[at])
        part = f"{100 * min(beyond, 1.0 - beyond):.0f} % of the volume beyond it"
        said = f"a section of {100 * share[at]:.0f} % of those to its sides, and {part}: a second body"
        far = beyond <= 0.5
        doubt = Doubt("scan_second_body", {"section": float(share[at]), "beyond": min(beyond, 1.0 - beyond)})
        body = Beside(said, doubt, float(np.rad2deg(azimuth)) + (0.0 if far else 180.0), cut if far else -cut)
        narrowest = float(share[at]), body
    return narrowest[1] if narrowest else None


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
