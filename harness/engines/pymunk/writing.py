"""The one place from which a body of Chipmunk's is written to while a run goes on, and its account.

A moving table is not among what is accounted for: its motion is the scene's own.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Final

from pymunk._chipmunk_cffi import lib

from harness.engines.event_stepping.interventions import Ledger
from harness.engines.pymunk import native

Row = Sequence[float]
Pair = tuple[float, float]

set_place: Final = lib.cpBodySetPosition
set_angle: Final = lib.cpBodySetAngle
set_velocity: Final = lib.cpBodySetVelocity
set_spin: Final = lib.cpBodySetAngularVelocity


class BodyWriter:
    """Writes to one of Chipmunk's dynamic bodies. States are x, z, angle and their rates, as `native.state_of` has them."""

    def __init__(self, body: Any, mass_kg: float, inertia_kg_m2: float, gravity_m_s2: float, ledger: Ledger) -> None:
        self.body, self.mass_kg, self.inertia_kg_m2 = body, mass_kg, inertia_kg_m2
        self.gravity_m_s2, self.ledger = gravity_m_s2, ledger

    def write(self, kind: str, before: Row, after: Row) -> None:
        """Change the body's state from what it is, `before`; what does not differ is not written."""
        x0, z0, angle0, u0, w0, spin0 = before
        x, z, angle, u, w, spin = after
        account, joules = self.ledger.of(kind), 0.0
        if x != x0 or z != z0:
            set_place(self.body, (x, z))
            account.moved_m += math.hypot(x - x0, z - z0)
            # A lift is potential energy, a changed velocity kinetic: the account holds both to tell energy from nowhere.
            joules = self.mass_kg * self.gravity_m_s2 * (z - z0)
        if angle != angle0:
            set_angle(self.body, angle)
            account.turned_rad += abs(angle - angle0)
        if u != u0 or w != w0:
            set_velocity(self.body, (u, w))
            account.velocity_m_s += math.hypot(u - u0, w - w0)
            joules += 0.5 * self.mass_kg * (u * u + w * w - u0 * u0 - w0 * w0)
        if spin != spin0:
            set_spin(self.body, spin)
            account.rate_rad_s += abs(spin - spin0)
            joules += 0.5 * self.inertia_kg_m2 * (spin * spin - spin0 * spin0)
        account.count += 1
        account.energy(joules)

    def shift(self, time_s: float) -> None:
        """Move the body along its present velocities, for a part of a step."""
        before = native.state_of(self.body)
        x, z, angle, u, w, spin = before
        self.write("part_of_step", before, (x + u * time_s, z + w * time_s, angle + spin * time_s, u, w, spin))

    def restore(self, state: Row) -> None:
        """Put the body back to where a step began that is solved again."""
        x, z, angle, u, w, spin = state
        set_place(self.body, (x, z))
        set_angle(self.body, angle)
        set_velocity(self.body, (u, w))
        set_spin(self.body, spin)


def move_table(floor: Any, place: Pair, velocity: Pair) -> None:
    """Give a moving table its velocity and place."""
    set_velocity(floor, velocity)
    set_place(floor, place)


def place_table(floor: Any, place: Pair) -> None:
    """Put a moving table back to where a step began that is solved again."""
    set_place(floor, place)
