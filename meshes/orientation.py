"""Which way is up: the base plane of a scan found from its open rim or its largest flat face, and the body levelled
on it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from meshes.errors import MeshError
from meshes.mesh import Array, RawMesh, double_areas
from meshes.solid import mass_properties
from meshes.topology import rims

if TYPE_CHECKING:
    from scipy.spatial import ConvexHull


BASE_RIM_SHARE = 0.02
"""A rim counts as the open base of a scan from this share of the largest face of the bounding box."""
CLEAR_RATIO = 0.8
"""The second-best base plane must have less than this share of the best one's area, or the up axis is not clear."""
SAME_DIRECTION_RAD = np.deg2rad(10.0)
"""Flat faces whose normals are closer than this are one base."""
RAGGED_RUN = 8.0
"""Neighbouring points of a ragged rim that rise and fall together, and so count as one."""
FLAT_SHARE = 0.005
"""A face belongs to a base plane if it is within this share of the body's extent from it."""

UP_ROTATION = {
    "z": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "-z": ((1, 0, 0), (0, -1, 0), (0, 0, -1)),
    "y": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "-y": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "x": ((0, 0, -1), (0, 1, 0), (1, 0, 0)),
    "-x": ((0, 0, 1), (0, 1, 0), (-1, 0, 0)),
}
"""Rows of the proper rotation that takes the file's up axis to +z."""


@dataclass(frozen=True)
class Orientation:
    """A rotation (3, 3) that puts a body upright, the file axis nearest to up, the tilt left to it, and why."""

    rotation: Array
    axis: str
    tilt_rad: float
    why: str


def turn_axis(up: str) -> Array:
    """Rotation (3, 3) that takes the file's axis `up` to +z; raises MeshError for an unknown one."""
    if up not in UP_ROTATION:
        raise MeshError(f"an up axis out of {', '.join(UP_ROTATION)}", f"{up!r}")
    return np.array(UP_ROTATION[up], dtype=np.float64)


def find_orientation(mesh: RawMesh) -> Orientation:
    """The base plane of a scan: its large open rim if it has one, else the flat face with the largest contact area.

    Raises MeshError if no plane stands out, with the advice to set the up axis.
    """
    rim = _largest_rim(mesh)
    if rim is not None:
        why = "the plane of the largest open rim, taken to be the base that was not scanned"
        orientation = upright(-area_vector(rim[::-1]), why)
        if orientation.tilt_rad > 2.0 * _tilt_error(rim):
            return orientation
        why = f"{why}: level within its own error of {np.rad2deg(_tilt_error(rim)):.2f}°"
        return Orientation(turn_axis(orientation.axis), orientation.axis, 0.0, why)
    return upright(-_standing_normal(mesh), "the facet of the base on which its weight rests")


def upright(up: Array, why: str) -> Orientation:
    """The rotation that takes the direction `up` (3,) to +z: the nearest file axis first, then the least tilt."""
    up = up / np.linalg.norm(up)
    axis = max(UP_ROTATION, key=lambda name: float(np.array(UP_ROTATION[name], dtype=np.float64)[2] @ up))
    swap = turn_axis(axis)
    return Orientation(least_turn(swap @ up) @ swap, axis, float(np.arccos(min(1.0, (swap @ up)[2]))), why)


def least_turn(direction: Array) -> Array:
    """The smallest rotation (3, 3) that takes a unit vector with positive z to +z (Rodrigues' formula)."""
    x, y, z = direction
    cross = np.array([[0.0, 0.0, -x], [0.0, 0.0, -y], [x, y, 0.0]])
    return np.asarray(np.eye(3) + cross + cross @ cross / (1.0 + z))


def area_vector(points: Array) -> Array:
    """Area vector (3,) of a closed polygon (n, 3) in space (Newell): its normal, as long as its area."""
    centred = points - points.mean(axis=0)
    return np.asarray(0.5 * np.cross(centred, np.roll(centred, -1, axis=0)).sum(axis=0))


def _largest_rim(mesh: RawMesh) -> Array | None:
    """Points (n, 3) of the rim around the largest area, or None if none is large enough to be a base."""
    extent = np.sort(np.ptp(mesh.vertices, axis=0))
    loops = [mesh.vertices[rim] for rim in rims(mesh.faces)]
    largest = max(loops, key=lambda points: float(np.linalg.norm(area_vector(points))), default=None)
    if largest is None or np.linalg.norm(area_vector(largest)) < BASE_RIM_SHARE * extent[1] * extent[2]:
        return None
    return largest


def _tilt_error(rim: Array) -> float:
    """Standard error of the tilt of a ragged rim's plane: residual over radius and the root of the independent
    points."""
    centred = rim - rim.mean(axis=0)
    sizes = np.linalg.svd(centred, compute_uv=False)
    return float(sizes[2] / sizes[1] / np.sqrt(max(len(rim) / RAGGED_RUN, 3.0)))


def _standing_normal(mesh: RawMesh) -> Array:
    """Outward normal of the hull facet that the weight's line meets when the body stands on its largest flat face."""
    from scipy.spatial import ConvexHull

    hull = ConvexHull(mesh.vertices)
    normals, offsets = hull.equations[:, :3], hull.equations[:, 3]
    flat = _flat_normal(mesh, hull)
    centroid = mass_properties(mesh.vertices, mesh.faces).centroid_m
    down, seen = flat, set[int]()
    while True:
        falling = normals @ down
        depth = np.where(falling > 1e-9, -(offsets + normals @ centroid) / np.maximum(falling, 1e-9), np.inf)
        facet = int(np.argmin(depth))
        if facet in seen:
            break
        seen.add(facet)
        down = normals[facet]
    if down @ flat < np.cos(SAME_DIRECTION_RAD):
        raise MeshError(
            "a statue that stands on its largest flat face",
            "one that falls over from it",
            "set the up axis (--up) if it was taken for another, or mend the base",
            place=mesh.source,
        )
    return np.asarray(down)


def _flat_normal(mesh: RawMesh, hull: ConvexHull) -> Array:
    """Outward normal of the hull plane on which most of the mesh's own area lies."""
    corners = mesh.vertices[hull.simplices]
    hull_area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    vectors = double_areas(mesh.vertices, mesh.faces)
    areas = np.linalg.norm(vectors, axis=1)
    centres = mesh.vertices[mesh.faces].mean(axis=1)
    extent = float(np.ptp(mesh.vertices, axis=0).max())
    candidates: list[tuple[float, Array]] = []
    for facet in np.argsort(hull_area)[::-1][:60]:
        normal = hull.equations[facet, :3]
        if any(other @ normal > np.cos(SAME_DIRECTION_RAD) for _, other in candidates):
            continue
        near = centres @ normal > -hull.equations[facet, 3] - FLAT_SHARE * extent
        near &= vectors @ normal > np.cos(SAME_DIRECTION_RAD) * areas
        touching = vectors[near].sum(axis=0)
        direction = touching / np.linalg.norm(touching) if near.any() else normal
        candidates.append((0.5 * float(areas[near].sum()), direction))
    candidates.sort(key=lambda pair: pair[0], reverse=True)
    if len(candidates) > 1 and candidates[1][0] > CLEAR_RATIO * candidates[0][0]:
        raise MeshError(
            "one base plane that stands out",
            f"two of {candidates[0][0]:.4g} and {candidates[1][0]:.4g} square units",
            "set the up axis (--up)",
            place=mesh.source,
        )
    return candidates[0][1]
