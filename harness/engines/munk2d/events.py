"""Events inside a step: the step is split so that an impact or a halt falls on the end of a part.

What is left to first order in a plain loop are events inside a step. The step that holds an impact is therefore split:
velocities are brought to the impact, positions to the contact, and one step without gravity lets the engine compute the impact
alone. The step in which the pedestal halts or reverses ends there.
"""

from __future__ import annotations

import math
from typing import Final

from harness.contact.impact import impact
from harness.engines.munk2d import native
from harness.engines.munk2d.drive import Drive, advance, record, set_stuck, shift, slip_rate
from harness.engines.munk2d.world import MunkSettings
from harness.scene import Scene

SLOW_DEPTHS: Final = 2.0
"""An impact is split when the corner moves more than this many depths in a step; slower ones the engine resolves itself."""
STANDING_RAD: Final = 1e-6
"""Below this rotation both corners stand."""
MOST_SHARE: Final = 1.5
"""An impact nearer than this share of a step (and farther than half a step) is brought to a step's end."""
PAST_HALT: Final = 0.01
"""Share by which a step that ends at a halt goes past it, so that friction stops the pedestal exactly."""


def least_spin_rad_s(scene: Scene, settings: MunkSettings) -> float:
    """Rate below which an impact is left to the engine: the incoming corner moves less than its depth of contact in a step."""
    base = scene.statue.corner_left_m + scene.statue.corner_right_m
    return SLOW_DEPTHS * settings.depth_m / (base * settings.dt_s)


def split_impact(drive: Drive, end_s: float) -> bool:
    """Pass an impact that lies within the coming step: four engine steps for three, ending at `end_s`.

    Returns whether the corner was found where it was expected; if not nothing but one partial step has been made.
    """
    dt, body = drive.settings.dt_s, native.body_of(drive.world.statue)
    angle, spin = native.get_angle(body), native.get_spin(body)
    ahead = -angle / spin - 0.5 * dt
    advance(drive, ahead, ahead)
    record(drive, drive.t_s)
    move = _time_to_contact(drive)
    found = 0.1 * dt < move < 0.9 * dt
    if found:
        _impact(drive, move)
        advance(drive, dt - move, dt)
        record(drive, drive.t_s)
        drive.work["impacts_split"] += 1
    rest = end_s - drive.t_s
    while rest > MOST_SHARE * dt:
        advance(drive, dt, dt)
        record(drive, drive.t_s)
        rest = end_s - drive.t_s
    advance(drive, rest, rest)
    drive.t_s = end_s
    record(drive, end_s)
    return found


def _time_to_contact(drive: Drive) -> float:
    """Time, s, in which the incoming corner reaches the depth at which contacts are kept, at present velocities."""
    # Anticlockwise angle: below zero the statue leans right and its left corner comes in.
    incoming = -1 if native.get_angle(native.body_of(drive.world.statue)) < 0.0 else 1
    gap, opening = _gap(drive, incoming)
    return -(gap + drive.settings.depth_m) / opening if opening < 0.0 else math.inf


def _gap(drive: Drive, side: int) -> tuple[float, float]:
    """Height of a corner (+1 right, −1 left) over its support, m, and its rate, m/s."""
    world, statue = drive.world, drive.scene.statue
    body = native.body_of(world.statue)
    angle, spin = native.get_angle(body), native.get_spin(body)
    place, velocity = native.get_place(body), native.get_velocity(body)
    x, z = side * statue.corner_m(side), -statue.centroid_height_m
    cos, sin = math.cos(angle), math.sin(angle)
    top, rise = 0.0, 0.0
    if world.pedestal is not None and drive.scene.pedestal is not None:
        pedestal = native.body_of(world.pedestal)
        top = native.get_place(pedestal).y + 0.5 * drive.scene.pedestal.height_m
        rise = native.get_velocity(pedestal).y
    elif drive.moving:
        floor = native.body_of(world.floor)
        top, rise = native.get_place(floor).y, native.get_velocity(floor).y
    gap = place.y + x * sin + z * cos - top
    return float(gap), float(velocity.y + spin * (x * cos - z * sin) - rise)


def keep_depth(drive: Drive) -> None:
    """Take back what the standing corner has drifted off its support.

    Each step moves it along the tangent of its circle, ω² h dt²/2 outwards; a contact that is lost for a step comes back as a
    blow, and its force flickers between none and twice the weight.
    """
    body = native.body_of(drive.world.statue)
    angle = native.get_angle(body)
    if abs(angle) < STANDING_RAD:
        return
    gap = _gap(drive, -1 if angle > 0.0 else 1)[0]
    if abs(gap) < drive.settings.slop_m:
        place = native.get_place(body)
        native.set_place(body, (place.x, place.y - gap - drive.settings.depth_m))


def _impact(drive: Drive, move_s: float) -> None:
    """The impact alone: positions at contact, no gravity; by the engine, or by the prescribed ratio."""
    if drive.scene.contact.restitution is None:
        advance(drive, move_s, 0.0)
        return
    world, scene = drive.world, drive.scene
    body = native.body_of(world.statue)
    spin, rate = native.get_spin(body), slip_rate(drive)
    side = 1 if native.get_angle(body) < 0.0 else -1
    stuck = abs(rate) <= drive.friction.stuck_below_m_s
    after = impact(scene, old_side=side, theta_rate_rad_s=-spin, slip_rate_m_s=rate, stuck=stuck)
    for mover in world.movers:
        shift(mover, move_s)
    drive.place_s += move_s
    base = native.get_velocity(native.body_of(world.floor)) if drive.moving else None
    base_x, base_z = (base.x, base.y) if base is not None else (0.0, 0.0)
    support = after.slip_rate_m_s + base_x
    new = -scene.statue.corner_m(-side) * side
    # About the corner at (new, −h) from the centroid, clockwise: x' = θ̇ h, z' = θ̇ new.
    native.set_velocity(
        body,
        (
            support + after.theta_rate_rad_s * scene.statue.centroid_height_m,
            base_z + after.theta_rate_rad_s * new,
        ),
    )
    native.set_spin(body, -after.theta_rate_rad_s)
    if world.pedestal is not None:
        native.set_velocity(native.body_of(world.pedestal), (support, base_z))
        set_stuck(drive, stuck=abs(after.slip_rate_m_s) <= drive.friction.stuck_below_m_s)


def split_halt(drive: Drive, share: float, end_s: float) -> None:
    """End a step where the pedestal halts, and make the rest of it."""
    dt = drive.settings.dt_s
    first = min(share * (1.0 + PAST_HALT), 1.0) * dt
    advance(drive, first, first)
    rest = end_s - drive.t_s
    if rest > 0.0:
        advance(drive, rest, rest)
    drive.t_s = end_s
    record(drive, end_s)
    drive.work["halts_split"] += 1
