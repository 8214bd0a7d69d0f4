"""The scene turned about the vertical in Bullet's world, so that what slides does so along one of Bullet's axes.

Bullet resolves friction along its own x and y. Askew to these the force that it settles on leans towards them at every step, so
that runs with finer steps agree on it; along them it is Coulomb's (docs/pybullet_contact.md). All above the world keeps the
scene's axes: states and pulls are turned as they are handed to Bullet, rows as they are read.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import pybullet

from harness.engines.event_stepping.rows import ALONE, Body, Row, Vector

if TYPE_CHECKING:
    from harness.engines.pybullet.world import World

SLIDES_M_S: Final = 1e-3
"""What is slower than this stands: a solver's remainder."""
NEAR_M: Final = 1e-4
"""A foot further above its support than this rubs on nothing."""
IN_LINE_RAD: Final = 3e-4
"""So near to one of Bullet's axes friction leans by less than a ten-thousandth of itself."""
EIGHTH_RAD: Final = 0.25 * math.pi


@dataclass(frozen=True)
class Heading:
    """The turn from the scene's axes to Bullet's about the vertical, as cosine and sine of it and of its half."""

    cos: float
    sin: float
    half_cos: float
    half_sin: float

    @classmethod
    def of(cls, turn_rad: float) -> Heading | None:
        """A turn by so much; None for none."""
        if turn_rad == 0.0:
            return None
        return cls(math.cos(turn_rad), math.sin(turn_rad), math.cos(0.5 * turn_rad), math.sin(0.5 * turn_rad))

    @property
    def back(self) -> Heading:
        """The turn from Bullet's axes to the scene's."""
        return Heading(self.cos, -self.sin, self.half_cos, -self.half_sin)

    def vector(self, vector: Vector) -> Vector:
        """A vector, turned."""
        x, y, z = vector
        return self.cos * x - self.sin * y, self.sin * x + self.cos * y, z

    def body(self, state: Body) -> Body:
        """A body's state, turned."""
        x, y, z, w = state.turn
        # The turn comes after the body's own: its quaternion (0, 0, s, c) stands on the left of the product.
        c, s = self.half_cos, self.half_sin
        turn = (c * x - s * y, c * y + s * x, c * z + s * w, c * w - s * z)
        return Body(self.vector(state.place_m), turn, self.vector(state.velocity_m_s), self.vector(state.rate_rad_s))

    def row(self, row: Row) -> Row:
        """The row of one or two bodies, turned."""
        turned: Row = ()
        for k in range(0, len(row), ALONE):
            body = self.body(Body(row[k : k + 3], row[k + 3 : k + 7], row[k + 7 : k + 10], row[k + 10 : k + 13]))  # type: ignore[arg-type]
            turned += (*body.place_m, *body.turn, *body.velocity_m_s, *body.rate_rad_s)
        return turned


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


def puller(world: World) -> Callable[[float, float, float, int], None]:
    """What sets a gravity, given along the scene's axes."""
    set_gravity: Callable[[float, float, float, int], None] = pybullet.setGravity

    def turned(x: float, y: float, z: float, client: int) -> None:
        set_gravity(*((x, y, z) if world.heading is None else world.heading.vector((x, y, z))), client)

    return set_gravity if world.heading is None and not world.follows else turned


def reader(world: World) -> Callable[[], Row]:
    """What reads the state of both bodies as one row."""
    pose, speed, client = pybullet.getBasePositionAndOrientation, pybullet.getBaseVelocity, world.client
    statue, pedestal = world.statue, world.pedestal

    def both() -> Row:
        place, turn = pose(statue, client)
        velocity, rate = speed(statue, client)
        below, level = pose(pedestal, client)
        slip, tip = speed(pedestal, client)
        return (*place, *turn, *velocity, *rate, *below, *level, *slip, *tip)

    def alone() -> Row:
        place, turn = pose(statue, client)
        velocity, rate = speed(statue, client)
        return (*place, *turn, *velocity, *rate)

    read = alone if pedestal is None else both
    if world.heading is None and not world.follows:
        return read
    return lambda: read() if world.heading is None else world.heading.back.row(read())
