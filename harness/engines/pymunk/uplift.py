"""Uplift inside a step: what a statue that begins to rock is owed for the part of a step in which it still stood.

A step knows the moment about a corner by its mean alone: what pressed the base down in the first part is taken from what lifts it
in the second. Where the moment is j (t − t₀), t₀ at s within the first step that turns, the spin at its end is j (dt²/2 − s dt)
where it should be j (dt − s)²/2. s and j are told by the first two steps, the error stays: j s²/2, at most j dt²/8, whichever
step t₀ falls into, and it grows as any difference does while the statue rocks.
"""

from __future__ import annotations

from typing import Final

from harness.engines.pymunk import native
from harness.engines.pymunk.drive import RunState, slip_rate
from harness.engines.pymunk.support_vertex import SupportVertex

LOOK: Final = 64
"""Steps in which an uplift must have become a rotation that can end in an impact."""
QUIET: Final = 0.05
"""Share of the next step's rate below which the statue still stood, as it trembles in its depth of contact."""
FLAT_RAD: Final = 1e-3
"""Rotation from its facet beyond which a statue whose spin passes zero is not one that begins to rock."""
OUTSIDE: Final = 0.75
"""Distance of t₀ from the first step's beginning, in steps, beyond which the moment grew by no straight line; more than a half is
taken as a half."""


def follow(drive: RunState, support: SupportVertex, whole: int) -> bool:
    """Correct the statue's motion if it has just begun to rock, `whole` steps after the last event.

    Returns False where one more step must be seen first. A correction replaces the state recorded last, unless that was taken.
    """
    world, body = drive.world, support.statue
    # The moment on a sliding pedestal is its kinetic friction's: it begins at once, with the slip onset or a stick onset.
    slides = abs(slip_rate(drive)) > drive.friction.stuck_below_m_s
    if slides or _from_level(support, native.get_angle(body)) > FLAT_RAD:
        return True
    back, spins = 0, [native.get_spin(body)]
    while back == 0 or abs(spins[back]) > QUIET * abs(spins[back - 1]):
        back += 1
        row = world.recorder.last(back) if back <= min(LOOK, whole) else []
        if not row:
            return True
        spins.append(row[world.statue_column + native.SPIN])
    if back < 2:
        return False
    first, second = spins[-2] - spins[-1], spins[-3] - spins[-2]
    grows = second - first
    if grows * spins[0] <= 0.0:
        return True
    begun = 0.5 - first / grows
    if abs(begun) > OUTSIDE:
        return True
    _give(drive, support, grows, min(max(begun, -0.5), 0.5), back - 2)
    drive.work["uplifts_met"] += 1
    if world.recorder.drop():
        native.each_body(native.space_of(world.space), world.recorder.each, world.recorder.target)
    return True


def _give(drive: RunState, support: SupportVertex, grows_rad_s: float, begun: float, since: int) -> None:
    """Add what the first two steps are owed, carried through the `since` whole steps after them.

    `grows_rad_s`: what the spin gains more in a step than in the one before; `begun`: t₀ from the first's beginning, in steps.
    """
    dt, body = drive.settings.dt_s, support.statue
    spin = 0.5 * grows_rad_s * begun**2
    # Positions are read half a step before velocities: (1.5 dt − s)³ j/6 less what one step has moved.
    turn = dt * grows_rad_s * ((1.5 - begun) ** 3 / 6.0 - (0.5 - begun)) + spin * since * dt
    before = native.state_of(body)
    x, z, angle, u, w, rate = before
    arm_x, arm_z = support.arm(support.vertex_at(angle), angle)
    # About the vertex: x' = ω z, z' = −ω x of the arm from the centroid to it, as in `events`.
    turned = (x + turn * arm_z, z - turn * arm_x, angle + turn)
    drive.writers[0].write("uplift", before, (*turned, u + spin * arm_z, w - spin * arm_x, rate + spin))


def _from_level(support: SupportVertex, angle_rad: float) -> float:
    """Rotation from the nearest facet's."""
    turned = angle_rad - support.tilt()
    return min(abs(turned - level) for level in support.level_rad)
