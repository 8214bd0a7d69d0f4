"""Where the statue is at a rotation: the planar pose that pictures, replay and reach share (docs/model.md, section 1)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from harness.model.in_space import SOLID_COLUMNS, rotations
from harness.records.scene import SceneRecord

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Section:
    """The statue's silhouette `outline_m` (k, 2) in (x, z) and its corners, in the statue frame."""

    outline_m: Array
    corner_left_m: float
    corner_right_m: float

    def pivot_m(self, theta_rad: ArrayLike) -> Array:
        """x of the corner about which the statue turns at these rotations."""
        return np.where(np.asarray(theta_rad) >= 0.0, self.corner_right_m, -self.corner_left_m)

    def posed_m(self, points_m: ArrayLike, theta_rad: ArrayLike, slip_m: ArrayLike) -> Array:
        """Points (k, 2) at rotations (n,) and slips (n,), shape (n, k, 2), from the table and the base plane."""
        points = np.atleast_2d(np.asarray(points_m, dtype=np.float64))
        theta = np.atleast_1d(np.asarray(theta_rad, dtype=np.float64))[:, None]
        pivot = self.pivot_m(theta)
        dx, dz = points[None, :, 0] - pivot, points[None, :, 1]
        x = pivot + dx * np.cos(theta) + dz * np.sin(theta) + np.atleast_1d(np.asarray(slip_m))[:, None]
        return np.stack([x, -dx * np.sin(theta) + dz * np.cos(theta)], axis=-1)

    def top_displacement_m(self, theta_rad: Array, slip_m: Array) -> Array:
        """Horizontal displacement (n,) of the middle of the statue's top from where it stood."""
        height = self.outline_m[:, 1].max()
        at_top = self.outline_m[self.outline_m[:, 1] >= height - 1e-9]
        top = np.array([[0.5 * (at_top[:, 0].min() + at_top[:, 0].max()), height]])
        return np.asarray(self.posed_m(top, theta_rad, slip_m)[:, 0, 0] - top[0, 0])

    def overhang_m(self, theta_rad: Array, slip_m: Array, side: int) -> Array:
        """How far (n,) anything of the statue stands out over its base's edge on that side (+1 right): what a wall limits."""
        x = self.posed_m(self.outline_m, theta_rad, slip_m)[:, :, 0]
        edge = self.corner_right_m if side > 0 else self.corner_left_m
        return np.asarray((side * x).max(axis=1) - edge)


def section(scene: SceneRecord) -> Section:
    """The section of a record's scene."""
    statue = scene.statue
    outline = np.asarray(statue.section_m, dtype=np.float64)
    return Section(outline, statue.corner_left_m, statue.corner_right_m)


def posed_in_space_m(points_m: Array, corner_right_m: float, pose: Mapping[str, float]) -> Array:
    """Points (n, 3) of the statue frame at a 3D engine's pose (values of `SOLID_COLUMNS`), in the table's frame."""
    corner = [pose[name] for name in SOLID_COLUMNS[3:]]
    return np.asarray((points_m - [corner_right_m, 0.0, 0.0]) @ rotations(pose).T + corner)
