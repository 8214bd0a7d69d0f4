"""When a vertex of the base comes down: the gap of every foot over its support, and how fast it closes."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.contact.spatial import matrices
from harness.scene import Scene

Array = NDArray[np.float64]
Row = tuple[float, ...]

LEAST_RATE_RAD_S: Final = 3e-3
"""A slower approach is no impact: what such a rate can lift is below a hundred-thousandth of a radian."""
DRIFT: Final = 4.0
"""A foot that falls faster than this many times its drift in a step comes down; a slower one stands."""
NEAR_M: Final = 5e-6
"""A foot nearer than this stands: the circle on which it turns takes it so far off its support within a step."""


class Touch:
    """Asked with a row: the time, s, until the first foot comes down at its present velocity, and the soonest that any could.

    `feet_m` (k, 3) about the centroid in the statue's principal frame; `half_m` half the pedestal's height, None on the floor.
    `within_m` are the pedestal's half width and depth where a foot beside its top meets nothing; None where the top has no end.
    """

    def __init__(
        self,
        scene: Scene,
        feet_m: Array,
        half_m: float | None,
        step_s: float,
        within_m: tuple[float, float] | None = None,
    ) -> None:
        statue, shake = scene.statue, scene.shake
        self.feet_m, self.half_m, self.within_m = np.ascontiguousarray(feet_m), half_m, within_m
        self.least_m_s = LEAST_RATE_RAD_S * (statue.corner_left_m + statue.corner_right_m)
        pull = scene.gravity_m_s2 + shake.x.peak_m_s2 + shake.y.peak_m_s2 + shake.z.peak_m_s2
        # A standing foot falls back in each step by what its circle, of the centroid's height, took it up in the one before.
        self.drift_s = DRIFT * statue.centroid_height_m * step_s
        # What weight and table together can do to a foot at its distance from the centroid.
        self.bound = 2.0 * pull / statue.centroid_height_m * np.linalg.norm(feet_m, axis=1)

    def __call__(self, row: Row, floor_m: float = 0.0, floor_m_s: float = 0.0) -> tuple[float, float, int]:
        """These times and that foot's number; `floor_m`, `floor_m_s` are the height of a moving table and its velocity.

        A time is infinite when no foot comes down, or all stand.
        """
        gap, closing = self._gaps(row, floor_m, floor_m_s)
        away, coming = gap > NEAR_M, closing > self._falling_m_s(row)
        coming &= gap > -NEAR_M
        if not (away | coming).any():
            return math.inf, math.inf, -1
        bound = self.bound
        times = (np.sqrt(closing * closing + 2.0 * bound * np.abs(gap)) - closing) / bound
        soonest = float(np.min(times[away], initial=math.inf))
        if not coming.any():
            return math.inf, soonest, -1
        times = np.where(coming, np.maximum(gap, 0.0) / np.where(coming, closing, 1.0), math.inf)
        foot = int(np.argmin(times))
        return float(times[foot]), soonest, foot

    def until(self, row: Row, foot: int, floor_m: float = 0.0, floor_m_s: float = 0.0) -> float:
        """Time, s, until that foot comes down; infinite when it does not."""
        gap, closing = self._gaps(row, floor_m, floor_m_s)
        return max(float(gap[foot] / closing[foot]), 0.0) if closing[foot] > self.least_m_s else math.inf

    def drift_m(self, row: Row, floor_m: float = 0.0, *, coming_s: float = 0.0) -> float:
        """How high feet near their support are above it, at most, with those that come down within `coming_s`; 0 for none."""
        gap, closing = self._gaps(row, floor_m, 0.0)
        reach = np.where(closing < self._falling_m_s(row), NEAR_M, closing * coming_s)
        near = np.abs(gap) < reach
        return max(float(np.max(gap[near])), 0.0) if near.any() else 0.0

    def _falling_m_s(self, row: Row) -> float:
        """A velocity that only a foot has that comes down."""
        return max(self.least_m_s, self.drift_s * (row[10] * row[10] + row[11] * row[11]))

    def _gaps(self, row: Row, floor_m: float, floor_m_s: float) -> tuple[Array, Array]:
        """Height of each foot over its support, m, and the velocity at which it comes down, m/s, shape (k,)."""
        x, y, z, w = row[3:7]
        # Columns of the statue's rotation: a world vector u has the components (u · column) in the statue's frame.
        turn = (
            (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)),
            (2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)),
            (2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)),
        )
        nx, ny, nz = 0.0, 0.0, 1.0
        place, rate = row[2] - floor_m, row[9] - floor_m_s
        if self.half_m is not None:
            a, b, c, d = row[16:20]
            nx, ny, nz = 2.0 * (a * c + b * d), 2.0 * (b * c - a * d), 1.0 - 2.0 * (a * a + b * b)
            place = nx * (row[0] - row[13]) + ny * (row[1] - row[14]) + nz * (row[2] - row[15]) - self.half_m
            rate = nx * (row[7] - row[20]) + ny * (row[8] - row[21]) + nz * (row[9] - row[22])
        p, q, r = row[10] - (row[23] if len(row) > 23 else 0.0), row[11] - (row[24] if len(row) > 23 else 0.0), row[12]
        # n · (ω × f) = f · (n × ω)
        sx, sy, sz = ny * r - nz * q, nz * p - nx * r, nx * q - ny * p
        both = np.array([[nx * t[0] + ny * t[1] + nz * t[2], sx * t[0] + sy * t[1] + sz * t[2]] for t in turn])
        found = self.feet_m @ both
        gap = found[:, 0] + place
        if self.within_m is not None:
            gap[self._beside(row)] = math.inf
        return gap, -(found[:, 1] + rate)

    def _beside(self, row: Row) -> NDArray[np.bool_]:
        """Which feet stand beside the pedestal's top, shape (k,)."""
        top, statue = matrices(np.array([row[16:20], row[3:7]]))
        there = (np.array(row[0:3]) - np.array(row[13:16]) + self.feet_m @ statue.T) @ top[:, :2]
        return np.asarray((np.abs(there) > np.array(self.within_m)).any(axis=1))
