"""A pose in space as the columns that every engine of three dimensions records, and the rotation that they give."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np

from harness.model.history import Array

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
