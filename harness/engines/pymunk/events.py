"""Events inside a step: the step is split so that an impact or a stick onset falls on the end of a part.

What is left to first order in a plain loop are events inside a step. The step that holds an impact is therefore split:
velocities are brought to the impact, positions to the contact, and one step without gravity lets the engine compute the impact
alone. The step in which the pedestal sticks or reverses ends there.
"""

from __future__ import annotations

import math
from typing import Final

from harness.engines.contact.impact import impact
from harness.engines.pymunk import native
from harness.engines.pymunk.drive import RunState, advance, record, set_stuck, slip_rate
from harness.engines.pymunk.support_vertex import LEAST_AHEAD, MOST_AHEAD, SupportVertex

MOST_SHARE: Final = 1.5
"""Longest part, in steps, of those that follow an impact."""
IMPOSED: Final = "imposed_impact"
"""Kind of what is written where a ratio is prescribed."""


def split_impact(drive: RunState, support: SupportVertex, facet: int, end_s: float) -> bool:
    """Pass an impact on a facet that lies within the coming steps: four engine steps for three, ending at `end_s`.

    Each part acts with its contacts as they are in its middle. Returns whether the corner was found where it was expected; if
    not nothing but one partial step has been made.
    """
    dt = drive.settings.dt_s
    ahead = _time_level(drive, support, facet)
    incoming = incoming_vertex(support, facet)
    approach(drive, support, facet, ahead, dt)
    move = time_to_contact(support, incoming)
    reached = 0.0 < move < dt
    if reached:
        impact_alone(drive, move)
        # Both were at the impact, velocities by its foreseen time; half a step on, they are half a step ahead again.
        drive.place_s = drive.t_s
        support.keep(0.5 * dt, dt)
        advance(drive, 0.5 * dt, dt)
        record(drive, drive.t_s)
        drive.work["impacts_split"] += 1
    rest = end_s - drive.t_s
    while rest > MOST_SHARE * dt:
        support.keep(dt, dt)
        advance(drive, dt, dt)
        record(drive, drive.t_s)
        rest = end_s - drive.t_s
    move = drive.t_s + 0.5 * rest - drive.place_s
    support.keep(move, rest)
    advance(drive, move, rest)
    end(drive, support, end_s)
    return reached


def incoming_vertex(support: SupportVertex, facet: int) -> int:
    """The vertex that comes down on a facet: to the left the facet's left end, which is the later one."""
    return facet + 1 if native.get_spin(support.statue) > 0.0 else facet


def approach(drive: RunState, support: SupportVertex, facet: int, ahead_s: float, part_s: float) -> None:
    """Velocities to the impact on a facet `ahead_s` after the places, which are half of `part_s` behind; places half the way."""
    incoming = incoming_vertex(support, facet)
    move = 0.5 * ahead_s + 0.25 * part_s
    kick = ahead_s - 0.5 * part_s
    support.keep(move, kick)
    advance(drive, move, kick)
    turn_on(drive, support, 2 * facet + 1 - incoming, support.level_rad[facet] + support.tilt())
    record(drive, drive.t_s, drive.t_s - drive.place_s)
    # A vertex that no longer comes down, as the part has stopped it, is not taken anywhere.
    contact_s = time_to_contact(support, incoming)
    if abs(contact_s) < drive.settings.dt_s:
        support.keep(contact_s, 0.0, turned=True)


def end(drive: RunState, support: SupportVertex, end_s: float) -> None:
    """End on a whole step: positions half a step behind velocities, and these the tangents there."""
    place_s = end_s - 0.5 * drive.settings.dt_s
    angle_rad = native.get_angle(support.statue) + native.get_spin(support.statue) * (place_s - drive.place_s)
    turn_on(drive, support, support.vertex_at(angle_rad), angle_rad)
    for writer in drive.writers:
        writer.shift(place_s - drive.place_s)
    drive.t_s, drive.place_s = end_s, place_s
    record(drive, end_s)


def turn_on(drive: RunState, support: SupportVertex, vertex: int, angle_rad: float) -> None:
    """Give the statue's centroid the velocity that it has at `angle_rad`, turning on `vertex`; spin and support keep theirs.

    Nothing is turned where the statue does not stand on that vertex: of two facets that are passed in one step the first has
    not been met.
    """
    world, body = drive.world, support.statue
    if not support.stands_on(vertex):
        return
    before = native.state_of(body)
    x, z, angle, _, _, spin = before
    arm_x, arm_z = support.arm(vertex, angle_rad)
    carried = native.get_velocity(native.body_of(world.floor if world.pedestal is None else world.pedestal))
    after = (x, z, angle, carried.x + spin * arm_z, carried.y - spin * arm_x, spin)
    drive.writers[0].write("turn_on", before, after)
    drive.ledger.explain("turn_on", spin, math.hypot(arm_x, arm_z), drive.settings.dt_s)


def _time_level(drive: RunState, support: SupportVertex, facet: int) -> float:
    """Time, s, in which positions bring a facet down; velocities, half a step ahead, go on changing as in the last step."""
    dt, left = drive.settings.dt_s, support.left_rad(facet)
    spin = native.get_spin(support.statue)
    plain_s = float(left / spin)
    gained = spin - drive.world.recorder.last(1)[drive.world.statue_column + native.SPIN]
    # left = T (spin + gained (T - dt) / 2 dt), by one correction of the time at a constant rate.
    level_s = float(left / (spin + 0.5 * gained * (plain_s / dt - 1.0)))
    return level_s if LEAST_AHEAD * dt <= level_s <= MOST_AHEAD * dt else plain_s


def time_to_contact(support: SupportVertex, vertex: int) -> float:
    """Time, s, in which a vertex reaches the depth at which contacts are kept, at present velocities."""
    gap, opening = support.gap(vertex)
    return -(gap + support.depth_at(native.get_spin(support.statue))) / opening if opening < 0.0 else math.inf


def impact_alone(drive: RunState, move_s: float) -> None:
    """The impact alone: positions at contact, no gravity; by the engine, or by the prescribed ratio."""
    if drive.scene.contact.restitution is None:
        advance(drive, move_s, 0.0, hard=True)
        return
    world, scene = drive.world, drive.scene
    body = native.body_of(world.statue)
    spin, rate = native.get_spin(body), slip_rate(drive)
    side = 1 if native.get_angle(body) < 0.0 else -1
    stuck = abs(rate) <= drive.friction.stuck_below_m_s
    after = impact(scene, old_side=side, theta_rate_rad_s=-spin, slip_rate_m_s=rate, stuck=stuck)
    for writer in drive.writers:
        writer.shift(move_s)
    drive.place_s += move_s
    base = native.get_velocity(native.body_of(world.floor)) if drive.moving else None
    base_x, base_z = (base.x, base.y) if base is not None else (0.0, 0.0)
    base_x_m_s = after.slip_rate_m_s + base_x
    new = -scene.statue.corner_m(-side) * side
    # About the corner at (new, −h) from the centroid, clockwise: x' = θ̇ h, z' = θ̇ new.
    velocity = (
        base_x_m_s + after.theta_rate_rad_s * scene.statue.centroid_height_m,
        base_z + after.theta_rate_rad_s * new,
    )
    before = native.state_of(body)
    drive.writers[0].write(IMPOSED, before, (*before[:3], *velocity, -after.theta_rate_rad_s))
    if world.pedestal is not None:
        before = native.state_of(drive.writers[1].body)
        drive.writers[1].write(IMPOSED, before, (*before[:3], base_x_m_s, base_z, before[5]))
        set_stuck(drive, stuck=abs(after.slip_rate_m_s) <= drive.friction.stuck_below_m_s)


def split_stick_onset(drive: RunState, support: SupportVertex, share: float, end_s: float) -> None:
    """End a step where the pedestal sticks, and make the rest of it.

    A statue at rest meets the stick onset with both ends of its base, which takes the solver many times longer than one vertex.
    """
    dt = drive.settings.dt_s
    first = min(share, 1.0) * dt
    advance(drive, first, first, hard=abs(native.get_spin(support.statue)) <= support.least_of_all_rad_s)
    rest = end_s - drive.t_s
    if rest > 0.0:
        advance(drive, rest, rest)
    drive.t_s = end_s
    record(drive, end_s)
    drive.work["halts_split"] += 1
