"""What the harness wrote into an engine's bodies while it ran: an unmodified contact engine has none."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Intervention:
    """The writes of one kind: how many, and the sums of what they changed, each taken without its sign.

    `moved_m`, `turned_rad`: places and rotations; `velocity_m_s`, `rate_rad_s`: velocities and angular velocities; `given_j`,
    `taken_j`: energy, kinetic and of height, that they added and removed; `steps_again`: steps solved again.
    """

    count: int = 0
    moved_m: float = 0.0
    turned_rad: float = 0.0
    velocity_m_s: float = 0.0
    rate_rad_s: float = 0.0
    given_j: float = 0.0
    taken_j: float = 0.0
    steps_again: int = 0
