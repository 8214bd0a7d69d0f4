"""Which way is up: the base plane of a scan found from its open rim or its largest flat face, and the body levelled
on it."""

from __future__ import annotations

import shlex
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from meshes.mesh import Array, Doubt, MeshError, RawMesh, area_vector, double_areas
from meshes.processing_log import measure, rims

BASE_RIM_SHARE: Final = 0.02
"""A rim counts as the open base of a scan from this share of the largest face of the bounding box."""
CLEAR_RATIO: Final = 0.8
"""The second-best base plane must have less than this share of the best one's area, or the up axis is not clear."""
TALLER: Final = 1.2
TALLER_SHARE: Final = 0.05
"""Nor is it where the body stands so much taller on another plane of this share of the area: a stele 8 cm thick on its back."""
SAME_RAD: Final = np.deg2rad(10.0)
"""Planes whose normals are closer than this are one base. A random direction is as close to some axis of the file in one case of
22: a tilt beyond it is no levelling, and the axes say nothing for it."""
FLAT_RAD: Final = np.deg2rad(5.0)
ROUND_RAD: Final = np.deg2rad(20.0)
FLAT_RATIO: Final = 0.5
"""A base is flat where half of the hull within the wider angle is within the narrower: of a cylinder's side it is a quarter."""
DEPTH_SHARE: Final = 0.02
DEPTH_RAD: Final = np.deg2rad(30.0)
FILLED: Final = 0.5
"""A base touches: so deep, as a share of the extent, and within this angle lies half of its hull's area; limbs only bridge it."""
OTHER_END: Final = 1.0 / 3.0
OTHER_BASE: Final = 0.1
"""The other end may be the base where the hull, within `SAME_RAD` of a plane of it, has a third of the base's area, or a tenth
and is a base itself. Heads and shoulders of scanned statues have at most 0.29, cuts through busts ragged by a tenth of their
height at least 0.38.
"""
TAPER: Final = 0.02
"""Of a plain tapered column, as a share of its height, the centroid is as near to that of a cone cut off between both ends."""
EQUAL: Final = 0.01
"""Of ends as equal as this the one is taken that stands towards a positive axis of the file."""
SHOWN: Final = 4
"""Of the planes on which a body rests, the broadest that a refusal names."""
LARGEST: Final = 300
"""Planes of the hull from which a body is let roll to where it rests."""
RAGGED_RUN: Final = 8.0
"""Neighbouring points of a ragged rim that rise and fall together, and so count as one."""

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
    """A rotation (3, 3) that puts a body upright, the file axis nearest to up, the tilt left to it, by what, and doubts."""

    rotation: Array
    axis: str
    tilt_rad: float
    why: str
    doubts: tuple[Doubt, ...] = ()


@dataclass(frozen=True)
class _Base:
    """A plane on which a body rests: direction up (3,), area, the body's height over it, the share of it below the centroid."""

    up: Array
    area: float
    height: float
    centroid_share: float
    rim: Array | None = None
    flat: bool = True

    def __str__(self) -> str:
        return f"{name_direction(self.up)} (base {self.area:.3g} square units, height {self.height:.3g})"


def name_direction(up: Array) -> str:
    """A direction as `turn_axis` reads it: an axis of the file where it is one to 1e-4, else its components."""
    for name, rows in UP_ROTATION.items():
        if np.abs(np.array(rows[2]) - up).max() < 1e-4:
            return name
    return ",".join(f"{value + 0.0:.4f}" for value in up)


def turn_axis(up: str) -> Array:
    """Rotation (3, 3) that takes an axis of the file ("-y") or a direction ("0.1,-0.2,0.97") to +z; MeshError for another."""
    if up in UP_ROTATION:
        return np.array(UP_ROTATION[up], dtype=np.float64)
    try:
        direction = np.array([float(value) for value in up.split(",")])
        if direction.shape == (3,) and np.isfinite(direction).all() and np.linalg.norm(direction) > 0.0:
            return upright(direction, "").rotation
    except ValueError:
        pass
    raise MeshError(f"an up axis out of {', '.join(UP_ROTATION)}, or a direction such as 0.1,-0.2,0.97", f"{up!r}")


def find_orientation(mesh: RawMesh) -> Orientation:
    """The base plane of a scan: the largest of its open rim and the flat planes of its hull on which it rests.

    Raises MeshError with the candidates where none stands out, or where the other end may as well be the base.
    """
    hull = _Hull.of(mesh)
    bases = _bases(mesh, hull)
    if not bases:
        raise _unclear("a flat plane to stand on", [], hull, mesh)
    best = max(bases, key=lambda base: (1.0 + EQUAL * float(base.up.max())) * base.area)
    aside = [base for base in bases if abs(base.up @ best.up) < np.cos(ROUND_RAD)]
    near = [
        base
        for base in aside
        if base.area > CLEAR_RATIO * best.area
        or (base.height > TALLER * best.height and base.area > TALLER_SHARE * best.area)
    ]
    if near:
        raise _unclear("one base plane that stands out", [best, *near], hull, mesh)
    doubts = []
    other = _other_end(best, bases, hull)
    if other is not None:
        if not _is_column(best, other):
            raise _unclear("one end that is the base", [best, other], hull, mesh)
        doubts.append(Doubt("scan_column", {"up": name_direction(other.up), "taken": name_direction(best.up)}))
    orientation = _levelled(best)
    if orientation.tilt_rad > SAME_RAD:
        doubts.append(Doubt("scan_askew", {"up": name_direction(best.up), "tilt_rad": orientation.tilt_rad}))
    return replace(orientation, doubts=tuple(doubts))


def _other_end(best: _Base, bases: list[_Base], hull: _Hull) -> _Base | None:
    """The end opposite to a base, where that may be the base as well."""
    facing = [base for base in bases if base.up @ best.up < -np.cos(DEPTH_RAD) and base.area > OTHER_BASE * best.area]
    if facing:
        return max(facing, key=lambda base: base.area)
    ends = [int(facet) for facet in hull.largest if hull.normals[facet] @ best.up > np.cos(DEPTH_RAD)]
    broad = max(ends, key=lambda facet: hull.area(hull.normals[facet], SAME_RAD), default=None)
    if broad is None or (area := hull.area(hull.normals[broad], SAME_RAD)) < OTHER_END * best.area:
        return None
    rest = hull.normals[hull.rest(broad)]
    return replace(
        best, up=-rest if rest @ best.up > np.cos(DEPTH_RAD) else -hull.normals[broad], area=area, flat=False
    )


def _is_column(base: _Base, other: _Base) -> bool:
    """Whether the centroid lies as in a cone cut off between both ends."""
    ratio = (other.area / base.area) ** 0.5
    share = (1.0 + 2.0 * ratio + 3.0 * ratio**2) / (4.0 * (1.0 + ratio + ratio**2))
    return other.flat and abs(base.centroid_share - share) < TAPER


def _unclear(wanted: str, candidates: list[_Base], hull: _Hull, mesh: RawMesh) -> MeshError:
    """The refusal that names the candidates, and the broadest of what it rests on besides."""
    for down in sorted(hull.rests(), key=lambda down: -hull.area(down, SAME_RAD))[:SHOWN]:
        if all(base.up @ -down < np.cos(SAME_RAD) for base in candidates):
            rest = _Base(-down, hull.area(down, SAME_RAD), float(np.ptp(mesh.vertices @ down)), 0.0)
            candidates = [*candidates, rest]
    got = f"{len(candidates)} to choose from: {'; '.join(f'--up {base}' for base in candidates)}"
    see = shlex.join(["rockcheck", "mesh", "inspect", mesh.source, f"--up={name_direction(candidates[0].up)}"])
    return MeshError(wanted, got, f"look at each, as by `{see} --picture up.png`, and set --up", place=mesh.source)


def up_doubted(mesh: RawMesh) -> tuple[Doubt, ...]:
    """What speaks against z as the up axis of a mesh."""
    hull = _Hull.of(mesh)
    bases = _bases(mesh, hull)
    standing = [base for base in bases if base.up[2] > np.cos(SAME_RAD)]
    broadest = max(bases, key=lambda base: base.area, default=None)
    other = _other_end(standing[0], bases, hull) if standing else broadest
    if other is None or (standing and _is_column(standing[0], other)):
        return ()
    return (Doubt("scan_up", {"up": name_direction(other.up), "area": other.area, "height": other.height}),)


def _levelled(base: _Base) -> Orientation:
    if base.rim is None:
        return upright(base.up, "facet")
    orientation, error = upright(base.up, "rim"), _tilt_error(base.rim)
    if orientation.tilt_rad > 2.0 * error:
        return orientation
    return Orientation(turn_axis(orientation.axis), orientation.axis, 0.0, "level_rim")


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
    sizes = np.linalg.svd(rim - rim.mean(axis=0), compute_uv=False)
    return float(sizes[2] / sizes[1] / np.sqrt(max(len(rim) / RAGGED_RUN, 3.0)))


@dataclass(frozen=True, eq=False)
class _Hull:
    """The planes of a body's hull: outward normals (k, 3), areas (k,), their distances (k,) from the centroid."""

    normals: Array
    areas: Array
    depths: Array
    centroid: Array

    @classmethod
    def of(cls, mesh: RawMesh) -> _Hull:
        from scipy.spatial import ConvexHull

        hull = ConvexHull(mesh.vertices)
        size = float(np.ptp(mesh.vertices, axis=0).max())
        scaled = np.round(hull.equations / [1.0, 1.0, 1.0, size], 9)
        _, first, number = np.unique(scaled, axis=0, return_index=True, return_inverse=True)
        areas = 0.5 * np.linalg.norm(double_areas(mesh.vertices, hull.simplices.astype(np.int64)), axis=1)
        normals, offsets = hull.equations[first, :3], hull.equations[first, 3]
        centroid = measure(mesh).centroid_m
        return cls(
            normals, np.bincount(number.ravel(), areas).astype(np.float64), -(offsets + normals @ centroid), centroid
        )

    @cached_property
    def largest(self) -> NDArray[np.int64]:
        """The largest planes first, at most `LARGEST`."""
        return np.argsort(self.areas)[::-1][:LARGEST].astype(np.int64)

    def area(self, direction: Array, within_rad: float) -> float:
        """Area of the hull seen along `direction`, of planes whose normals are within an angle of it."""
        along = self.normals @ direction
        near = along > np.cos(within_rad)
        return float(self.areas[near] @ along[near])

    def rest(self, facet: int) -> int:
        """The plane on which it comes to rest, let go on another."""
        seen = set[int]()
        while facet not in seen:
            seen.add(facet)
            falling = self.normals @ self.normals[facet]
            ahead = np.where(falling > 1e-9, self.depths / np.maximum(falling, 1e-9), np.inf)
            facet = int(np.argmin(ahead))
        return facet

    def rests(self) -> Array:
        """Outward normals (k, 3) of the planes on which it comes to rest from its largest ones."""
        found: list[Array] = []
        for facet in np.unique([self.rest(int(start)) for start in self.largest]):
            if not any(normal @ self.normals[facet] > np.cos(SAME_RAD) for normal in found):
                found.append(self.normals[facet])
        return np.array(found)


def _bases(mesh: RawMesh, hull: _Hull) -> list[_Base]:
    """The flat planes on which a body rests and which it touches, and its largest open rim where it rests on it."""
    vectors = 0.5 * double_areas(mesh.vertices, mesh.faces)
    centres = mesh.vertices[mesh.faces].mean(axis=1)
    deep = DEPTH_SHARE * float(np.ptp(mesh.vertices, axis=0).max())
    rim = _largest_rim(mesh)
    open_down = None if rim is None else area_vector(rim[::-1])
    bases = []
    for down in hull.rests():
        along, level = mesh.vertices @ down, float((mesh.vertices @ down).max())
        facing = vectors @ down
        near = (centres @ down > level - deep) & (facing > np.cos(DEPTH_RAD) * np.linalg.norm(vectors, axis=1))
        area, own, direction = float(facing[near].sum()), None, down
        if open_down is not None and open_down @ down > np.cos(ROUND_RAD) * np.linalg.norm(open_down):
            area, own = max(area, float(np.linalg.norm(open_down))), rim
            direction, open_down = open_down / np.linalg.norm(open_down), None
        flat = hull.area(down, FLAT_RAD) > FLAT_RATIO * hull.area(down, ROUND_RAD)
        if own is None and not (flat and area > FILLED * hull.area(down, SAME_RAD)):
            continue
        height = float(np.ptp(along))
        bases.append(_Base(-direction, area, height, (level - float(hull.centroid @ down)) / height, own))
    return bases
