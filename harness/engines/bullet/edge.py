"""When the pedestal's edge can meet the statue: only if some part of the statue lies below the plane of the pedestal's top.

Above that plane nothing but the plane itself can touch a convex body, and it does so at vertices: the feet are exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

DEPTH_M: Final = 1e-4
"""A vertex so far below the top's plane is beyond any contact's penetration, and just where the inset hull begins."""


@dataclass(frozen=True, eq=False)
class EdgeWatch:
    """Called with a row, says whether the statue reaches below the top of a pedestal `height_m` high.

    `points_m` (n, 3) are the vertices of the statue's hull about its centroid, in its principal frame.
    """

    points_m: Array
    half_height_m: float

    def __call__(self, row: tuple[float, ...]) -> bool:
        # The top's normal, in the world, then in the statue's frame: rows of rotation matrices.
        a, b, c, d = row[16:20]
        nx, ny, nz = 2.0 * (a * c + b * d), 2.0 * (b * c - a * d), 1.0 - 2.0 * (a * a + b * b)
        x, y, z, w = row[3:7]
        here = np.array(
            [
                (1 - 2 * (y * y + z * z)) * nx + 2 * (x * y + z * w) * ny + 2 * (x * z - y * w) * nz,
                2 * (x * y - z * w) * nx + (1 - 2 * (x * x + z * z)) * ny + 2 * (y * z + x * w) * nz,
                2 * (x * z + y * w) * nx + 2 * (y * z - x * w) * ny + (1 - 2 * (x * x + y * y)) * nz,
            ]
        )
        above = (row[0] - row[13]) * nx + (row[1] - row[14]) * ny + (row[2] - row[15]) * nz - self.half_height_m
        return bool(above + (self.points_m @ here).min() < -DEPTH_M)
