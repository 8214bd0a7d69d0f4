"""A pose in space as the columns that every engine of three dimensions records, and the rotation that they give."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final, Protocol

import numpy as np

from harness.model.history import Array

# A pedestal that tips: where its centroid and its top come to lie, whose slip is that of the edge on which it
# stands.


class Sides(Protocol):
    """Width and height of a pedestal."""

    @property
    def width_m(self) -> float: ...
    @property
    def height_m(self) -> float: ...


def centroid_shift_m(pedestal: Sides, tilt_rad: Array) -> Array:
    """How far the centroid moves along the floor while the pedestal tips about an edge that stands, of the tilts' shape:
    (h/2) sin φ + sgn φ (w/2) (1 − cos φ).
    """
    aside = 0.5 * pedestal.width_m * np.sign(tilt_rad) * (1.0 - np.cos(tilt_rad))
    return np.asarray(0.5 * pedestal.height_m * np.sin(tilt_rad) + aside)


def support_m(pedestal: Sides | None, slip_m: Array, extra: Mapping[str, Array]) -> Array:
    """Displacement (n,) of what the statue stands on, from a history's columns: of the middle of its pedestal's top."""
    tilt_rad = extra.get("pedestal_tilt_rad")
    if pedestal is None or tilt_rad is None:
        return slip_m
    return np.asarray(slip_m + centroid_shift_m(pedestal, tilt_rad) + 0.5 * pedestal.height_m * np.sin(tilt_rad))


SOLID_COLUMNS: Final = (
    "pitch_rad",
    "roll_rad",
    "yaw_rad",
    "corner_right_x_m",
    "corner_right_y_m",
    "corner_right_z_m",
)
"""Columns that give the statue's whole pose: R = R_z(yaw) R_y(pitch) R_x(roll) and its right corner's place."""


def rotations(columns: Mapping[str, Array | float]) -> Array:
    """Rotation matrices (..., 3, 3) from the statue's frame to the table's, of values or columns of `SOLID_COLUMNS`."""
    pitch, roll, yaw = (columns[name] for name in SOLID_COLUMNS[:3])
    cr, sr, cp, sp, cy, sy = np.cos(roll), np.sin(roll), np.cos(pitch), np.sin(pitch), np.cos(yaw), np.sin(yaw)
    rows = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
