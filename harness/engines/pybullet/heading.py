"""The scene turned about the vertical in Bullet's world, so that what slides does so along one of Bullet's axes.

Bullet resolves friction along its own x and y. Askew to these the force that it settles on leans towards them at every step, so
that runs with finer steps agree on it; along them it is Coulomb's (docs/engines.md). All above the world keeps the
scene's axes: states and pulls are turned as they are handed to Bullet, rows as they are read.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from harness.engines.stepping.rows import ALONE, Body, Row, Vector


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
