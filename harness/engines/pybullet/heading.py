"""A run with all of its scene turned about the vertical in Bullet's world: what it changes is Bullet's, not the scene's.

Bullet resolves friction along its own x and y. For a vertex that slides alone the force that it settles on leans towards these
axes at every step (docs/pybullet_contact.md), so that runs with finer steps agree on it; a run under another heading does not.
All above the world keeps the scene's axes: states and pulls are turned as they are handed to Bullet, rows as they are read.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import pybullet

from harness.engines.event_stepping.rows import Body, Row, Vector

if TYPE_CHECKING:
    from harness.engines.pybullet.world import World


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
        for k in range(0, len(row), 13):
            body = self.body(Body(row[k : k + 3], row[k + 3 : k + 7], row[k + 7 : k + 10], row[k + 10 : k + 13]))  # type: ignore[arg-type]
            turned += (*body.place_m, *body.turn, *body.velocity_m_s, *body.rate_rad_s)
        return turned


def puller(world: World) -> Callable[[float, float, float, int], None]:
    """What sets a gravity, given along the scene's axes."""
    set_gravity: Callable[[float, float, float, int], None] = pybullet.setGravity
    if world.heading is None:
        return set_gravity
    turned = world.heading.vector
    return lambda x, y, z, client: set_gravity(*turned((x, y, z)), client)


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
    if world.heading is None:
        return read
    back = world.heading.back
    return lambda: back.row(read())
