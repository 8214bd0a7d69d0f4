"""Micro-rocking: rocking in half-cycles of a few steps, whose impacts follow each other sooner than whole steps could tell.

A statue that rises under a floor that shakes at a high frequency often micro-rocks first: rocking of 1e-5 rad in half-cycles of
some milliseconds, with impacts of a hundredth of a radian a second. It is next to nothing, but its next rise begins with it. In
whole steps such a half-cycle ends in the step in which it returns, and alike at every step that is longer. Here it is cut into
parts of its own length, and its impacts are met, until the half-cycles are long enough for whole steps or too short for these to
tell.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.engines.contact import frame
from harness.engines.pymunk import events, native
from harness.engines.pymunk.drive import RunState, advance, record, slip_rate
from harness.engines.pymunk.support_vertex import LEAST_AHEAD, MOST_AHEAD, SupportVertex

Array = NDArray[np.float64]

SHORT_STEPS: Final = 8.0
"""A half-cycle expected to be shorter than so many steps is passed in parts of its own."""
LEAST_STEPS: Final = 0.25
"""One shorter than this is left to whole steps, in which it dies out."""
FAST: Final = 3.0
"""Impacts at a rate above so many times `SupportVertex.fast_rad_s` are met by whole steps: what the shape of a half-cycle changes
in their instant is little, and parts cost more."""
PARTS: Final = 5.0
"""Parts of a half-cycle as it is expected from the forces at its beginning."""
MOST_PARTS: Final = 20
"""Parts after which a half-cycle that does not return is left to whole steps."""
DEPTH_SHARE: Final = 5e-3
"""Depth of contact in a half-cycle over what the half-cycle lifts a corner by: a contact lets go, and is felt, at its depth."""
PEAK_SHARE: Final = 0.25
"""Peak of a half-cycle over the rate at its beginning times its duration, at a constant acceleration."""
AFTER_STEPS: Final = 2.0
"""Whole steps that must be left after a half-cycle."""
LEAST_TAIL: Final = 0.5
"""Share of a step that the part which ends on a whole step takes at least."""


def is_short(drive: RunState, support: SupportVertex, facet: int, t_s: float) -> bool | None:
    """Whether the impact to come on a facet belongs to micro-rocking; None where steps of this length can tell of none."""
    vertex = events.incoming_vertex(support, facet)
    # A statue at rest tilts on a vertex that is still in contact.
    if support.gap(vertex)[0] <= -support.depth_m:
        return None
    dt, spin = drive.settings.dt_s, native.get_spin(support.statue)
    half_cycle_s = next_half_cycle_s(drive, support, vertex, t_s)
    if half_cycle_s <= LEAST_STEPS * dt:
        return None
    return half_cycle_s <= SHORT_STEPS * dt or abs(spin) <= FAST * support.fast_rad_s


def next_half_cycle_s(drive: RunState, support: SupportVertex, vertex: int, t_s: float) -> float:
    """Duration, s, of a half-cycle about a vertex from `t_s` on at the statue's present rate, under the forces of the coming
    step.

    Infinite where these do not bring it back. A pedestal is taken to be held, if it sticks within half of that half-cycle, or to
    slide.
    """
    spin, angle = native.get_spin(support.statue), native.get_angle(support.statue)
    dt, drag = drive.settings.dt_s, drive.friction.kinetic
    along, _, down = frame.mean_gravity(drive.scene, t_s, t_s + dt)
    x, z = support.arm(vertex, angle)
    statue = drive.scene.statue
    inertia = statue.inertia_kg_m2 + statue.mass_kg * (x * x + z * z)

    def lasts_s(pull_m_s2: float) -> float:
        # What pulls acts at the centroid, which is at (−x, −z) from the vertex.
        gained = statue.mass_kg * (z * pull_m_s2 - x * down) / inertia
        return 2.0 * abs(spin / gained) if gained * spin < 0.0 else math.inf

    held_s, rate = lasts_s(along), slip_rate(drive)
    braked = drag * abs(down)
    if abs(rate) <= max(drive.friction.stuck_below_m_s, 0.5 * held_s * braked):
        return held_s
    return lasts_s(math.copysign(braked, rate))


def pass_micro_rocking(drive: RunState, support: SupportVertex, facet: int, edges_s: Array) -> int:
    """Pass the impact on a facet within the coming steps, and the short half-cycles that follow; the whole step reached."""
    dt, depth_m, fast_rad_s = drive.settings.dt_s, support.depth_m, support.fast_rad_s
    spin = native.get_spin(support.statue)
    part, gained = dt, spin - drive.world.recorder.last(1)[drive.world.statue_column + native.SPIN]
    # One depth for all of it: corners at two of them would not be level together.
    support.fast_rad_s = math.inf if abs(spin) < fast_rad_s else 0.0
    returns = True
    while returns:
        incoming = events.incoming_vertex(support, facet)
        if not _locate_impact(drive, support, facet, part, gained):
            break
        spin = native.get_spin(support.statue)
        half_cycle_s = next_half_cycle_s(drive, support, incoming, drive.t_s)
        if half_cycle_s < LEAST_STEPS * dt:
            support.settle()
            break
        if half_cycle_s > SHORT_STEPS * dt or drive.t_s + half_cycle_s + AFTER_STEPS * dt > edges_s[-1]:
            break
        part, support.fast_rad_s = min(half_cycle_s / PARTS, dt), math.inf
        peak_rad = PEAK_SHARE * abs(spin) * half_cycle_s
        support.depth_m = min(depth_m, DEPTH_SHARE * peak_rad * support.length_m[facet])
        # The impact that follows a half-cycle comes at most `MOST_AHEAD` parts later, and the last part of all has
        # its least length.
        last_s = float(edges_s[-1]) - (MOST_AHEAD + LEAST_TAIL) * dt
        returns, gained = _half_cycle(drive, support, facet, part, last_s)
    support.depth_m, support.fast_rad_s = depth_m, fast_rad_s
    return _to_whole_step(drive, support, edges_s)


def _locate_impact(drive: RunState, support: SupportVertex, facet: int, part_s: float, gained_rad_s: float) -> bool:
    """The last of the parts of a half-cycle, all of this length, and its impact; whether it was met."""
    ahead = _back_s(support, facet, part_s, gained_rad_s)
    incoming = events.incoming_vertex(support, facet)
    if not LEAST_AHEAD * part_s <= ahead <= MOST_AHEAD * part_s:
        return False
    events.approach(drive, support, facet, ahead, part_s)
    move = events.time_to_contact(support, incoming)
    if not -part_s < move < drive.settings.dt_s:
        return False
    events.impact_alone(drive, move)
    drive.place_s = drive.t_s
    drive.work["impacts_split"] += 1
    return True


def _half_cycle(
    drive: RunState, support: SupportVertex, facet: int, part_s: float, last_s: float
) -> tuple[bool, float]:
    """Parts of a half-cycle up to the one before it returns to the facet; whether it does, and the spin gained in the last.

    A half-cycle may last longer than expected: none of its parts ends after `last_s`, so that whole steps end the run.
    """
    move, gained = 0.5 * part_s, 0.0
    for _ in range(MOST_PARTS):
        if drive.t_s + part_s > last_s:
            return False, gained
        spin = native.get_spin(support.statue)
        support.keep(move, part_s)
        advance(drive, move, part_s)
        record(drive, drive.t_s, 0.5 * part_s)
        gained, move = native.get_spin(support.statue) - spin, part_s
        ahead = _back_s(support, facet, part_s, gained)
        if ahead <= MOST_AHEAD * part_s:
            return ahead >= LEAST_AHEAD * part_s, gained
    return False, gained


def _back_s(support: SupportVertex, facet: int, part_s: float, gained_rad_s: float) -> float:
    """Time, s, from that of the places, half a part ago, to the statue's return to a facet, at the last part's acceleration."""
    spin, pull = native.get_spin(support.statue), gained_rad_s / part_s
    # Places brought forward by half a part at the present velocity are those of its instant.
    left = support.left_rad(facet) - 0.5 * part_s * spin
    if pull * left <= 0.0:
        return float(0.5 * part_s + left / spin) if spin * left > 0.0 else math.inf
    speed = math.copysign(math.sqrt(spin * spin + 2.0 * pull * left), left)
    return float(0.5 * part_s + (speed - spin) / pull)


def _to_whole_step(drive: RunState, support: SupportVertex, edges_s: Array) -> int:
    """One part to the end of a whole step."""
    end = int(np.searchsorted(edges_s, drive.t_s + LEAST_TAIL * drive.settings.dt_s))
    part = float(edges_s[end]) - drive.t_s
    move = drive.t_s + 0.5 * part - drive.place_s
    support.keep(move, part)
    advance(drive, move, part)
    events.end(drive, support, float(edges_s[end]))
    return end
