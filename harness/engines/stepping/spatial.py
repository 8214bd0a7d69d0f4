"""What three dimensions add to a trajectory: rotation matrices, the columns of a body's pose, a fall in any direction."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.rotation import rotation_matrices
from harness.model.scene import OVERTURN_RAD, Statue

Array = NDArray[np.float64]

OVERTURN_TAN: Final = math.tan(OVERTURN_RAD)
OVERTURN_COS: Final = math.cos(OVERTURN_RAD)


def matrices(turns: Array) -> Array:
    """Rotation matrices (n, 3, 3) of quaternions (n, 4), ordered (x, y, z, w) as Bullet has them."""
    return rotation_matrices(turns[:, [3, 0, 1, 2]])


def planar(up: Array, spin: Array) -> tuple[Array, Array]:
    """θ = atan2(ẑ·x̂, ẑ·ẑ), unwrapped, and its rate, from the statue's axis (n, 3) and its angular velocity (n, 3)."""
    theta = np.unwrap(np.arctan2(up[:, 0], up[:, 2]))
    change = np.cross(spin, up)
    # d atan2(x, z)/dt of the axis, which moves with ω × ẑ; an axis that lies across the plane has no rotation in it.
    size = up[:, 0] ** 2 + up[:, 2] ** 2
    rate: Array = (up[:, 2] * change[:, 0] - up[:, 0] * change[:, 2]) / np.where(size > 0.0, size, 1.0)
    return theta, rate


def statue_columns(statue: Statue, turn: Array, centroid_m: Array) -> dict[str, Array]:
    """Pose of the statue, (n, 3, 3) and (n, 3) in the table's frame, as the columns that every 3D engine records."""
    roll = np.arctan2(turn[:, 2, 1], turn[:, 2, 2])
    sin, cos = np.sin(roll), np.cos(roll)
    # A body on its side (pitch ±π/2) has roll and yaw about one axis: yaw is what is left after the roll, whatever that is.
    yaw = np.arctan2(sin * turn[:, 0, 2] - cos * turn[:, 0, 1], cos * turn[:, 1, 1] - sin * turn[:, 1, 2])
    columns = {
        "roll_rad": roll,
        "pitch_rad": np.arctan2(-turn[:, 2, 0], np.hypot(turn[:, 2, 1], turn[:, 2, 2])),
        "yaw_rad": np.unwrap(yaw),
        "out_of_plane_rad": np.arcsin(np.clip(turn[:, 1, 2], -1.0, 1.0)),
        "statue_y_m": centroid_m[:, 1] - centroid_m[0, 1],
    }
    for name, x in (("right", statue.corner_right_m), ("left", -statue.corner_left_m)):
        path = centroid_m + turn @ np.array([x, 0.0, -statue.centroid_height_m])
        columns |= {f"corner_{name}_{axis}_m": path[:, k] for k, axis in enumerate("xyz")}
    return columns


def fallen(zx: float, zy: float, zz: float) -> bool:
    """Whether the statue's axis (zx, zy, zz) counts as overturned, in the plane or across it."""
    if abs(zx) >= abs(zy):
        return abs(zx) >= zz * OVERTURN_TAN
    return zz <= OVERTURN_COS
