"""Chipmunk's bodies between whole steps, for what locates events (`harness.engines.event_stepping.locating`)."""

from __future__ import annotations

import math
from typing import Final

from harness.engines.contact.frame import greatest_pull_m_s2
from harness.engines.contact.impact import impact
from harness.engines.event_stepping.settings import EVENTS
from harness.engines.pymunk import drive as driving
from harness.engines.pymunk import native
from harness.engines.pymunk.drive import RunState
from harness.engines.pymunk.support_vertex import SupportVertex

Pair = tuple[float, float]

IMPOSED: Final = "imposed_impact"
"""Kind of what is written where a ratio is prescribed."""


class MunkBodies:
    """The statue on its vertices from right to left, and what is below it; places lag velocities by half a step."""

    def __init__(self, drive: RunState, support: SupportVertex, last_step: int) -> None:
        self.drive, self.support, self.last_step = drive, support, last_step
        self.step_s = drive.settings.dt_s
        self.lag_s = 0.5 * self.step_s
        statue = drive.scene.statue
        pull = 2.0 * greatest_pull_m_s2(drive.scene) / statue.centroid_height_m
        self.most_m_s2 = [pull * math.hypot(x, z) for x, z in support.points]
        self.usual = (support.depth_m, support.fast_rad_s)

    @property
    def place_s(self) -> float:
        """Time of the places."""
        return self.drive.place_s

    @property
    def velocity_s(self) -> float:
        """Time of the velocities."""
        return self.drive.t_s

    def advance(self, move_s: float, kick_s: float, *, hard: bool = False) -> None:
        """One engine step of that length for places and velocities, the standing vertex at its depth in between."""
        self.support.keep(move_s, kick_s)
        driving.advance(self.drive, move_s, kick_s, hard=hard)

    def coast(self, seconds: float) -> None:
        """Move places by their velocities."""
        for writer in self.drive.writers:
            writer.shift(seconds)
        self.drive.place_s += seconds

    def turn_on(self, instant_s: float) -> None:
        """Give the statue's centroid the velocity that it has at an instant, turning on its vertex; spin and support keep theirs.

        Nothing is turned where the statue does not stand on that vertex: of two facets that are passed in one step the first
        has not been met.
        """
        support, world = self.support, self.drive.world
        before = native.state_of(support.statue)
        x, z, angle, _, _, spin = before
        vertex = support.vertex_at(angle)
        if not support.stands_on(vertex):
            return
        arm_x, arm_z = support.arm(vertex, angle + spin * (instant_s - self.place_s))
        carried = native.get_velocity(native.body_of(world.floor if world.pedestal is None else world.pedestal))
        after = (x, z, angle, carried.x + spin * arm_z, carried.y - spin * arm_x, spin)
        self.drive.writers[0].write("turn_on", before, after)
        self.drive.ledger.explain("turn_on", spin, math.hypot(arm_x, arm_z), self.step_s)

    def impact(self, move_s: float, vertex: int) -> None:
        """The impact alone: places at contact, no gravity; by the engine, or by the prescribed ratio."""
        drive, instant_s = self.drive, self.place_s + move_s
        self.support.keep(move_s, 0.0, turned=True)
        gap, opening = self.support.gap(vertex)
        # Chipmunk moves places by velocities alone. What hardly comes down any more meets the engine where it is.
        alone_s = -(gap + self.felt_m()) / opening if opening < 0.0 else move_s
        move_s = alone_s if abs(alone_s) < self.step_s else move_s
        if drive.scene.contact.restitution is None:
            driving.advance(drive, move_s, 0.0, hard=True)
        else:
            self.coast(move_s)
            self._impose()
        drive.work["impacts_split"] += 1
        drive.t_s = drive.place_s = instant_s

    def gap(self, vertex: int) -> Pair:
        """Height of a vertex over the depth at which contacts are kept, at the velocities' time, and its rate."""
        support, ahead_s = self.support, self.velocity_s - self.place_s
        gap, opening = support.gap(vertex, ahead_s)
        below = support.vertex_at(native.get_angle(support.statue))
        if below != vertex and support.stands_on(below):
            # Along the tangent of its circle the statue leaves its support, but for that it is taken back.
            return gap - support.gap(below, ahead_s)[0], opening
        return gap + support.depth_at(native.get_spin(support.statue)), opening

    def felt_m(self) -> float:
        """The depth at which contacts are kept."""
        return self.support.depth_at(native.get_spin(self.support.statue))

    def rising(self) -> tuple[int, float] | None:
        """The vertex that was left behind, and how fast it can come back at most."""
        facet, spin = self.support.facet, native.get_spin(self.support.statue)
        vertex = facet if spin > 0.0 else facet + 1
        return (vertex, self.most_m_s2[vertex]) if self.gap(vertex)[1] > 0.0 else None

    def lift(self, height_m: float | None) -> None:
        """Make contacts thinner than what a half-cycle lifts a vertex by: they let go, and are felt, at their depth."""
        support, (depth_m, fast_rad_s) = self.support, self.usual
        if height_m is None:
            before = native.state_of(support.statue)
            after = (before[0], before[1] + support.depth_m - depth_m, *before[2:])
            support.writer.write("hold", before, after)
            support.depth_m, support.fast_rad_s = depth_m, fast_rad_s
        else:
            # One depth for all of it: corners at two of them would not be level together.
            support.depth_m, support.fast_rad_s = min(depth_m, EVENTS.thin * height_m), math.inf

    def settle(self) -> None:
        """Lay the statue on its facet."""
        self.support.settle()

    def record(self) -> None:
        """Keep a sample of the velocities' time, one for each instant."""
        drive = self.drive
        if drive.t_s > drive.times_s[-1]:
            driving.record(drive, drive.t_s, drive.t_s - drive.place_s)

    def reached(self, number: int) -> None:
        """Keep a sample of a whole step."""
        self.drive.t_s = number * self.step_s
        self.record()

    def _impose(self) -> None:
        """The velocities after the model's impact, on both bodies."""
        drive = self.drive
        world, scene, body = drive.world, drive.scene, self.support.statue
        # It came down from the side against which it turns, whether or not the last digits of the angle have passed zero.
        rate, side = driving.slip_rate(drive), 1 if native.get_spin(body) > 0.0 else -1
        stuck = abs(rate) <= drive.friction.stuck_below_m_s
        after = impact(scene, old_side=side, theta_rate_rad_s=-native.get_spin(body), slip_rate_m_s=rate, stuck=stuck)
        base = native.get_velocity(native.body_of(world.floor)) if drive.moving else None
        base_x, base_z = (base.x, base.y) if base is not None else (0.0, 0.0)
        base_x += after.slip_rate_m_s
        turn, new = after.theta_rate_rad_s, -scene.statue.corner_m(-side) * side
        # About the corner at (new, −h) from the centroid, clockwise: x' = θ̇ h, z' = θ̇ new.
        velocity = (base_x + turn * scene.statue.centroid_height_m, base_z + turn * new)
        before = native.state_of(body)
        drive.writers[0].write(IMPOSED, before, (*before[:3], *velocity, -turn))
        if world.pedestal is not None:
            before = native.state_of(drive.writers[1].body)
            drive.writers[1].write(IMPOSED, before, (*before[:3], base_x, base_z, before[5]))
            driving.set_stuck(drive, stuck=abs(after.slip_rate_m_s) <= drive.friction.stuck_below_m_s)
