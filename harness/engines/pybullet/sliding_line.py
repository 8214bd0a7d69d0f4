"""The line along which something slides on the floor: one of Bullet's axes is to lie along it (`heading.py`)."""

from __future__ import annotations

import math
from typing import Final

from harness.engines.pybullet.world import World
from harness.engines.stepping.rows import ALONE, Row
from harness.engines.stepping.support import SLIDES_M_S

NEAR_M: Final = 1e-4
"""A foot further above its support than this rubs on nothing."""
IN_LINE_RAD: Final = 3e-4
"""So near to one of Bullet's axes friction leans by less than a ten-thousandth of itself."""
EIGHTH_RAD: Final = 0.25 * math.pi


class SlidingLine:
    """The line along which the pedestal slides on the floor, or while it does not, the statue's lowest foot.

    Bullet's friction is Coulomb's along its own x and y, whatever a contact's effective masses: one of these is to lie along it.
    """

    def __init__(self, world: World, step_s: float) -> None:
        self.world, self.step_s, self.feet_m = world, step_s, world.feet_m

    def askew_rad(self, row: Row) -> float:
        """Angle from the nearer of Bullet's axes to that line, 0 where nothing slides."""
        (_, _, up), (u, v, _) = self.world.table
        x, y, least = 0.0, 0.0, SLIDES_M_S
        if len(row) > ALONE:
            half_m = self.world.pedestal_half_m
            x, y, up = row[20] - row[24] * half_m - u, row[21] + row[23] * half_m - v, up + 2.0 * half_m
        if math.hypot(x, y) < least:
            x, y, least = self._foot(row, up)
            x, y = x - u, y - v
        if math.hypot(x, y) < least:
            return 0.0
        own = math.atan2(y, x) + self.world.turn_rad - self.world.settings.turn_rad
        return (own + EIGHTH_RAD) % (2.0 * EIGHTH_RAD) - EIGHTH_RAD

    def _foot(self, row: Row, support_m: float) -> tuple[float, float, float]:
        """Velocity of the lowest foot, m/s, and how fast it must be to slide: infinitely where it is above its support."""
        x, y, z, w = row[3:7]
        downs = self.feet_m @ (2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y))
        lowest = int(downs.argmin())
        if row[2] + float(downs[lowest]) - support_m > NEAR_M:
            return 0.0, 0.0, math.inf
        c = float(downs[lowest])
        e, f, g = self.feet_m[lowest].tolist()
        a = (1.0 - 2.0 * (y * y + z * z)) * e + 2.0 * ((x * y - z * w) * f + (x * z + y * w) * g)
        b = 2.0 * ((x * y + z * w) * e + (y * z - x * w) * g) + (1.0 - 2.0 * (x * x + z * z)) * f
        p, q, r = row[10:13]
        # A foot that stands moves by its body's turning in half a step: velocities are older than places by that.
        turning = (p * p + q * q + r * r) * math.sqrt(a * a + b * b + c * c) * self.step_s
        return row[7] + q * c - r * b, row[8] + r * a - p * c, SLIDES_M_S + turning
