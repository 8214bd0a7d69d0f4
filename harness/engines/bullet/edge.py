"""When the pedestal's edge can meet the statue: only if some part of the statue comes to or below the top's plane beside it.

Above that plane nothing but the plane itself can touch a convex body, and it does so at vertices: the feet are exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.contact.spatial import matrices

Array = NDArray[np.float64]

DEPTH_M: Final = 1e-4
"""Nearer than this a vertex counts as touching; deeper is beyond any contact's penetration, and where the inset hull begins."""


@dataclass(frozen=True, eq=False)
class EdgeWatch:
    """Called with a row, says whether the statue reaches below the pedestal's top or stands beside it.

    `points_m` (n, 3) are the vertices of the statue's hull about its centroid, in its principal frame; `half_m` the pedestal's
    half width, depth and height.
    """

    points_m: Array
    half_m: tuple[float, float, float]

    def __call__(self, row: tuple[float, ...]) -> bool:
        top, statue = matrices(np.array([row[16:20], row[3:7]]))
        between = top.T @ (np.array(row[0:3]) - np.array(row[13:16]))
        turn = top.T @ statue
        above = between[2] - self.half_m[2] + self.points_m @ turn[2]
        low = above < DEPTH_M
        if not low.any():
            return False
        if above.min() < -DEPTH_M:
            return True
        there = np.abs(between[:2] + self.points_m[low] @ turn[:2].T)
        return bool((there > np.array(self.half_m[:2]) + DEPTH_M).any())
