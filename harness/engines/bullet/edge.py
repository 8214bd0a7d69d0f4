"""When the pedestal's edge can meet the statue: only if some part of the statue comes to or below the top's plane beside it.

Above that plane nothing but the plane itself can touch a convex body, and it does so at vertices: the feet are exact. Beside the
top that plane is not there: a vertex about to come down to it must find the pedestal's edges instead.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.contact.spatial import matrices

Array = NDArray[np.float64]

DEPTH_M: Final = 1e-4
"""Nearer than this a vertex counts as touching; deeper is beyond any contact's penetration, and where the inset hull begins."""


@dataclass(frozen=True, eq=False)
class EdgeWatch:
    """Called with a row, says whether the statue reaches below the pedestal's top beside it, or may do so before the next look.

    `points_m` (n, 3) are the vertices of the statue's hull about its centroid, in its principal frame; `half_m` the pedestal's
    half width, depth and height; `ahead_s` the longest time between two looks; `pull_m_s2` bounds what weight and table do.
    """

    points_m: Array
    half_m: tuple[float, float, float]
    ahead_s: float = 0.0
    pull_m_s2: float = 0.0

    @cached_property
    def radius_m(self) -> float:
        """Distance of the furthest vertex from the centroid."""
        return float(np.max(np.linalg.norm(self.points_m, axis=1)))

    def __call__(self, row: tuple[float, ...]) -> bool:
        top, statue = matrices(np.array([row[16:20], row[3:7]]))
        between = top.T @ (np.array(row[0:3]) - np.array(row[13:16]))
        turn = top.T @ statue
        above = between[2] - self.half_m[2] + self.points_m @ turn[2]
        rate, own_rate = top.T @ np.array(row[10:13]), top.T @ np.array(row[23:26])
        velocity = top.T @ (np.array(row[7:10]) - np.array(row[20:23]))
        spin = float(np.linalg.norm(rate) + np.linalg.norm(own_rate))
        # A point's acceleration is at most what pulls the body, twice over, and what keeps it on its circle.
        slack = (self.pull_m_s2 + 0.5 * self.radius_m * spin**2) * self.ahead_s**2
        reach = (float(np.linalg.norm(velocity)) + self.radius_m * spin) * self.ahead_s + slack
        low = above < DEPTH_M + reach
        if not low.any():
            return False
        if above.min() < -DEPTH_M:
            return True
        arms = self.points_m[low] @ turn.T
        way = self.ahead_s * (velocity + np.cross(rate, arms) - np.cross(own_rate, between + arms))
        there = (between + arms)[:, :2]
        down = np.minimum(above[low], above[low] + way[:, 2] - slack) < DEPTH_M
        beside = np.maximum(np.abs(there), np.abs(there + way[:, :2])) > np.array(self.half_m[:2]) + DEPTH_M
        return bool((down & beside.any(axis=1)).any())
