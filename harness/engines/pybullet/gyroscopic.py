"""Bullet's gyroscopic torque made of second order: what a step's own misses is added to it as an external torque.

Euler's equations are I ω̇ + ω × I ω = τ. Bullet takes ω × I ω at the velocity with which a step begins, half a step before
the step's middle: the rotation then errs by the first order of the step, in flight as about a vertex. Here it is taken at
the velocity foreseen for the middle of the time over which the velocity is changed. No place and no velocity is written.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from harness.engines.pybullet import writing
from harness.engines.stepping.rows import Row, Vector

if TYPE_CHECKING:
    from harness.engines.pybullet.world import World
    from harness.engines.stepping.step_log import Ledger


KIND: Final = "gyroscopic"
"""Kind of this intervention."""
STILL_RAD_S: Final = 1e-6
"""A body that turns more slowly has no gyroscopic torque worth a call: less than 1e-12 rad/s²."""


class Gyroscope:
    """The torque that the next step lacks: `prepare_step` it from the rows, `act` before each solution of the step."""

    def __init__(self, world: World) -> None:
        self.world, self.body, self.client = world, world.statue, world.client
        # What turns in the plane alone turns about a principal axis: nothing is missing.
        self.moments: Vector | None = None if world.in_plane else world.moments
        self.torque: Vector | None = None

    def prepare_step(self, row: Row, rate_rad_s2: Vector, span_s: float, length_s: float, ledger: Ledger) -> None:
        """A step of `length_s` that takes velocities on by `span_s` (shorter around events), from a row whose angular velocity
        changes by `rate_rad_s2`.
        """
        self.torque = None
        if self.moments is None or abs(row[10]) + abs(row[11]) + abs(row[12]) < STILL_RAD_S:
            return
        (ix, iy, iz), (x, y, z, w), half = self.moments, row[3:7], 0.5 * span_s
        # Columns of the body's rotation.
        ax, ay, az = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)
        bx, by, bz = 2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)
        cx, cy, cz = 2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)
        f, g, h = row[10:13]
        p, q, r = f * ax + g * ay + h * az, f * bx + g * by + h * bz, f * cx + g * cy + h * cz
        f, g, h = f + half * rate_rad_s2[0], g + half * rate_rad_s2[1], h + half * rate_rad_s2[2]
        u, v, s = f * ax + g * ay + h * az, f * bx + g * by + h * bz, f * cx + g * cy + h * cz
        share = span_s / length_s
        a = (iy - iz) * (share * v * s - q * r)
        b = (iz - ix) * (share * s * u - r * p)
        c = (ix - iy) * (share * u * v - p * q)
        self.torque = a * ax + b * bx + c * cx, a * ay + b * by + c * cy, a * az + b * bz + c * cz
        rate_rad_s = length_s * math.hypot(a / ix, b / iy, c / iz)
        ledger.of(KIND).write(0.0, 0.0, 0.0, rate_rad_s, length_s * (a * p + b * q + c * r))

    def act(self) -> None:
        """Add the torque foreseen to the step that follows: Bullet forgets it with that."""
        if self.torque is not None:
            heading = self.world.heading
            torque = self.torque if heading is None else heading.vector(self.torque)
            writing.twist(self.body, torque, self.client)
