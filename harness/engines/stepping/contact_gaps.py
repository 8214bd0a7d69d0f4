"""When a vertex of the base comes down: the gap of every foot over its support, and how fast it closes."""

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from harness.engines.stepping import settings
from harness.engines.stepping.frame import greatest_pull_m_s2, matrices
from harness.engines.stepping.step_log import Row, Vector
from harness.model import Array, Scene

Four = tuple[float, float, float, float]

MANY: Final = 40
"""Up to so many feet plain numbers are quicker than arrays: of the 82 of a scan they take three times as long."""


class ContactGaps:
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
        statue, events = scene.statue, settings.EVENTS
        self.feet_m, self.half_m, self.within_m = np.ascontiguousarray(feet_m), half_m, within_m
        self.feet = [tuple(foot) for foot in feet_m.tolist()]
        self.few = within_m is None and len(self.feet) <= MANY
        self.base_m = statue.corner_left_m + statue.corner_right_m
        height_m, own_rad_s = statue.centroid_height_m, math.sqrt(scene.gravity_m_s2 / statue.centroid_height_m)
        self.near_m, self.rest_m, self.held = events.near * height_m, events.rest * height_m, events.held
        self.slow_rad_s = events.least_rate * own_rad_s
        least = max(events.least_at_rest, events.least_gained * own_rad_s * step_s)
        self.least_m_s = min(events.least_rate, least) * own_rad_s * self.base_m
        pull = greatest_pull_m_s2(scene)
        # A standing foot falls back in each step by what its circle, of the centroid's height, took it up in the one before.
        self.drift_s = events.drift * height_m * step_s
        self.drift_m_s2 = self.drift_s * step_s
        self.late_s = events.late * step_s
        # What weight and table together can do to a foot at its distance from the centroid.
        self.bounds = 2.0 * pull / height_m * np.linalg.norm(feet_m, axis=1)
        self.bound = self.bounds.tolist()

    def __call__(self, row: Row, floor_m: float, floor_m_s: float) -> tuple[float, float, int]:
        """These times and that foot's number; `floor_m`, `floor_m_s` are the height of a moving table and its velocity.

        A time is infinite when no foot comes down, or all stand.
        """
        falling = self.falling_m_s(row)
        if not self.few:
            return self._of_many(row, falling, floor_m, floor_m_s)
        near = self.stands_m(row)
        first_s = soonest_s = math.inf
        foot = -1
        (ha, hb, hc, place), (va, vb, vc, rate) = self._support(row, floor_m, floor_m_s)
        for index, (fx, fy, fz) in enumerate(self.feet):
            gap, closing = fx * ha + fy * hb + fz * hc + place, -(fx * va + fy * vb + fz * vc + rate)
            falls = closing > falling and gap > -self.late_s * closing
            if gap > near or (falls and gap > 0.0):
                bound = self.bound[index]
                # Only a foot that is down by then comes sooner: most have no root to take.
                if gap < soonest_s * (closing + 0.5 * bound * soonest_s):
                    soonest_s = (math.sqrt(closing * closing + 2.0 * bound * gap) - closing) / bound
            if falls:
                time_s = gap / closing if gap > 0.0 else 0.0
                if time_s < first_s:
                    first_s, foot = time_s, index
        return first_s, soonest_s, foot

    def _of_many(self, row: Row, falling: float, floor_m: float, floor_m_s: float) -> tuple[float, float, int]:
        """The same for arrays."""
        gap, closing = self._all_gaps(row, floor_m, floor_m_s)
        falls = (closing > falling) & (gap > -self.late_s * closing)
        ahead = (gap > self.stands_m(row)) | (falls & (gap > 0.0))
        bound, near, rate = self.bounds[ahead], gap[ahead], closing[ahead]
        soonest_s = float(np.min((np.sqrt(rate * rate + 2.0 * bound * near) - rate) / bound, initial=math.inf))
        if not falls.any():
            return math.inf, soonest_s, -1
        contact_s = np.full(gap.size, math.inf)
        contact_s[falls] = np.maximum(gap[falls], 0.0) / closing[falls]
        foot = int(np.argmin(contact_s))
        first_s = float(contact_s[foot])
        return first_s, soonest_s, foot if first_s < math.inf else -1

    def standing(self, row: Row, floor_m: float = 0.0, floor_m_s: float = 0.0) -> list[int]:
        """Numbers of the feet that rest on their support, whether they slide along it or not."""
        near, falling = self.stands_m(row), self.falling_m_s(row)
        heights = enumerate(self.heights(row, floor_m, floor_m_s))
        return [k for k, (gap, closing) in heights if abs(gap) < near and abs(closing) < falling]

    def foot_m(self, feet: Sequence[int], row: Row) -> Vector:
        """Where the middle of some feet is from the centroid, world axes."""
        (middle,) = matrices(np.array([row[3:7]])) @ self.feet_m[feet].mean(axis=0)
        return float(middle[0]), float(middle[1]), float(middle[2])

    def foot_speeds_m_s(
        self, feet: Sequence[int], row: Row, others: Sequence[Row], floor_m: float, floor_m_s: float
    ) -> list[float]:
        """How much faster or slower than in a row some feet leave their support in others, on average."""
        heights = self.heights(row, floor_m, floor_m_s)
        moving = [self.heights(other, floor_m, floor_m_s) for other in others]
        return [sum(abs(each[k][1] - heights[k][1]) for k in feet) / len(feet) for each in moving]

    def drift_m(self, row: Row, floor_m: float = 0.0, *, within_s: float = 0.0) -> float:
        """How high feet near their support are above it, at most, with those that come down within `within_s`; 0 for none."""
        near, falling = self.stands_m(row), self.falling_m_s(row)
        highest = 0.0
        for gap, closing in self.heights(row, floor_m, 0.0):
            if highest < gap < (near if closing < falling else closing * within_s):
                highest = gap
        return highest

    def stands_m(self, row: Row) -> float:
        """A height over its support below which a foot stands."""
        square = row[10] * row[10] + row[11] * row[11]
        return min(self.near_m, self.rest_m + self.drift_m_s2 * square)

    def falling_m_s(self, row: Row) -> float:
        """A velocity that only a foot has that comes down."""
        square = row[10] * row[10] + row[11] * row[11]
        return max(
            self.least_m_s, self.drift_s * square, self.base_m * min(self.slow_rad_s, self.held * math.sqrt(square))
        )

    def heights(self, row: Row, floor_m: float, floor_m_s: float) -> list[tuple[float, float]]:
        """Height of each foot over its support, m, and the velocity at which it comes down, m/s."""
        if self.few:
            (ha, hb, hc, place), (va, vb, vc, rate) = self._support(row, floor_m, floor_m_s)
            return [(x * ha + y * hb + z * hc + place, -(x * va + y * vb + z * vc + rate)) for x, y, z in self.feet]
        gap, closing = self._all_gaps(row, floor_m, floor_m_s)
        return list(zip(gap.tolist(), closing.tolist(), strict=True))

    def height(self, foot: int, row: Row, floor_m: float, floor_m_s: float) -> tuple[float, float]:
        """The same of one foot."""
        if self.within_m is not None:
            return self.heights(row, floor_m, floor_m_s)[foot]
        (ha, hb, hc, place), (va, vb, vc, rate) = self._support(row, floor_m, floor_m_s)
        fx, fy, fz = self.feet[foot]
        return fx * ha + fy * hb + fz * hc + place, -(fx * va + fy * vb + fz * vc + rate)

    def _all_gaps(self, row: Row, floor_m: float, floor_m_s: float) -> tuple[Array, Array]:
        """The same as arrays, shape (k,) each; infinite heights beside the pedestal's top."""
        (ha, hb, hc, place), (va, vb, vc, rate) = self._support(row, floor_m, floor_m_s)
        fx, fy, fz = self.feet_m.T
        gap = fx * ha + fy * hb + fz * hc + place
        if self.within_m is not None:
            gap[past_edge_m(self.feet_m, row, self.within_m) > 0.0] = math.inf
        return gap, -(fx * va + fy * vb + fz * vc + rate)

    def _support(self, row: Row, floor_m: float, floor_m_s: float) -> tuple[Four, Four]:
        """Height over the support, and its rate, as components in the statue's principal frame and a constant."""
        x, y, z, w = row[3:7]
        nx, ny, nz = 0.0, 0.0, 1.0
        p, q, r = row[10:13]
        if self.half_m is None:
            place, rate = row[2] - floor_m, row[9] - floor_m_s
        else:
            a, b, c, d = row[16:20]
            nx, ny, nz = 2.0 * (a * c + b * d), 2.0 * (b * c - a * d), 1.0 - 2.0 * (a * a + b * b)
            place = nx * (row[0] - row[13]) + ny * (row[1] - row[14]) + nz * (row[2] - row[15]) - self.half_m
            rate = nx * (row[7] - row[20]) + ny * (row[8] - row[21]) + nz * (row[9] - row[22])
            p, q = p - row[23], q - row[24]
        # n · (ω × f) = f · (n × ω)
        sx, sy, sz = ny * r - nz * q, nz * p - nx * r, nx * q - ny * p
        # Columns of the statue's rotation: a world vector u has the components (u · column) in the statue's frame.
        ax, ay, az = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)
        bx, by, bz = 2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)
        cx, cy, cz = 2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)
        ha, hb, hc = nx * ax + ny * ay + nz * az, nx * bx + ny * by + nz * bz, nx * cx + ny * cy + nz * cz
        va, vb, vc = sx * ax + sy * ay + sz * az, sx * bx + sy * by + sz * bz, sx * cx + sy * cy + sz * cz
        return (ha, hb, hc, place), (va, vb, vc, rate)


def past_edge_m(points_m: Array, row: tuple[float, ...], across_m: tuple[float, float]) -> Array:
    """How far points (k, 3) of the statue lie past the edges of the top, m, (k,); `across_m` are its half width and depth."""
    top, statue = matrices(np.array([row[16:20], row[3:7]]))
    there = (np.array(row[0:3]) - np.array(row[13:16]) + points_m @ statue.T) @ top[:, :2]
    return np.asarray((np.abs(there) - np.array(across_m)).max(axis=1))
