"""The base vertex that stands, the facet that comes next, and how the vertex is kept at the depth at which contacts last.

A step moves a turning body along the tangent of its vertex's circle, ω² h dt²/2 off the support. A contact that is lost so for
one step lets the statue fall freely and comes back as a blow: an impact met in such a step has the wrong ratio, by up to a tenth.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Sequence
from typing import Final

from harness.engines.pymunk import native
from harness.engines.pymunk.base_geometry import STEEPEST_RAD, base_vertices, fall_rad_s2, velocity_owed
from harness.engines.pymunk.drive import RunState

Pair = tuple[float, float]
Row = Sequence[float]

LEVEL_RAD: Final = 1e-6
"""Nearer than this to a facet's rotation both of its ends stand."""
LEANING_RAD: Final = 2.0
"""Beyond this rotation no vertex of the base stands any more."""
TIPPED_RAD: Final = 1e-3
"""A pedestal tilted by more has its own impacts: its statue is left to whole steps."""
SLOW_DEPTHS: Final = 2.0
"""A statue whose vertices move less than this many depths in a step stands on both of them where its pedestal sticks."""
HALF_CYCLE_STEPS: Final = 0.1
"""Share of a step's fall by which a statue at rest does not turn: above that rate its impacts are met."""
TURNING_DEPTH: Final = 0.05
"""Depth of contact of a statue that turns slowly over that at rest: a vertex is let go, and felt, at its depth, and a half-cycle
that lifts it by less would end at its peak."""
CLEAR_DEPTHS: Final = 2.0
"""Depths of rest by which the other end of a facet must be up before the standing one comes up, too."""
SETTLED: Final = 0.01
"""Share of these depths by which a statue at rest may be off its own."""
FAST_RAD_S: Final = 0.02
"""Rate from which on a statue stands at the depth of rest again, so that its circle does not take it off its support."""
LEAST_AHEAD: Final = 0.6
MOST_AHEAD: Final = 2.3
"""Steps to an impact between which it is met: more than one apart, as what falls is faster in each step."""
SLOW_STEPS: Final = 10.0
"""A rate that gravity changes in so many steps takes a vertex nowhere. Held in each of them a statue would not come to rest;
never held, one at rest would sink and turn within the slop."""
SLOW_RISE: Final = 0.05
"""... nor does one at which the tangent of its circle takes it up by half this share of its depth: at long steps such rises would
add up to the depth, and the contact be lost for a step."""
RISES: Final = 4.0
"""A vertex that goes this many times as far as its circle takes it, and its depth, lifts off: it is left alone."""

NEAR, FAR = -1, -2
"""No facet to be met now: a contact may come or go in the step, or the statue turns on one vertex throughout."""
CLEAR_STEPS: Final = 0.02
"""Rotation over the step, rad/s, beyond which the vertex left behind is off the support: ten times its depth of contact."""
LEAST_BORNE: Final = 0.02
"""Share of its weight below which a statue counts as flying: it may land in the coming step."""
MOST_FRICTION: Final = 0.9
"""Share of its friction's limit above which a vertex counts as sliding: at a high coefficient the solver is slow there."""

HELD_SHARE: Final = 1e-3
"""Share of its rate about the centroid below which a vertex is held by its support: the solver leaves 1e-9 of it."""


class SupportVertex:
    """The base as vertices from right to left, (x, z) from the centroid, and its facets between them.

    `level_rad` (ascending, anticlockwise as Chipmunk counts) are the rotations at which the facets lie on a level support: turned
    beyond the first i of them the statue stands on vertex i. `facet` is the one that was found to come; impacts are met at rates
    above `half_cycle_rad_s`, and at those below `least_of_all_rad_s` the statue stands on a whole facet at a stick onset.
    `depth_m` is the depth at which a vertex is kept at rates up to `fast_rad_s`, `rest_m` that at rest and above; `gained_rad_s`
    what the spin gained in the last whole step, `owed_m_s` what the last `hold` took from the velocity.
    """

    def __init__(self, drive: RunState) -> None:
        world, scene = drive.world, drive.scene
        self.writer = drive.writers[0]
        self.statue, self.floor = native.body_of(world.statue), native.body_of(world.floor)
        self.pedestal = None if world.pedestal is None else native.body_of(world.pedestal)
        points = base_vertices(scene)
        self.points = [(float(x), float(z)) for x, z in points]
        steps = points[:-1] - points[1:]
        self.level_rad = [float(-math.atan2(dz, dx)) for dx, dz in steps]
        self.length_m = [float(math.hypot(dx, dz)) for dx, dz in steps]
        # An impact below this rate is left to the engine: the far end of the longest facet moves less than its depth in a step.
        self.least_of_all_rad_s = SLOW_DEPTHS * drive.settings.depth_m / (max(self.length_m) * drive.settings.dt_s)
        self.height_m, self.moving = scene.statue.centroid_height_m, drive.moving
        self.rest_m, self.slop_m = drive.settings.depth_m, drive.settings.slop_m
        self.depth_m = TURNING_DEPTH * self.rest_m
        self.clear_of_rest_rad = [CLEAR_DEPTHS * self.rest_m / length for length in self.length_m]
        self.half_m = 0.0 if scene.pedestal is None else 0.5 * scene.pedestal.height_m
        self.near_s, self.far_s = LEAST_AHEAD * drive.settings.dt_s, MOST_AHEAD * drive.settings.dt_s
        self.facet, self.risen = NEAR, False
        self.drive, self.gained_rad_s, self.owed_m_s = drive, 0.0, (0.0, 0.0)
        self.clear_rad, self.walled = CLEAR_STEPS * drive.settings.dt_s, scene.wall is not None
        self.dt_s, self.most_friction = drive.settings.dt_s, MOST_FRICTION * scene.contact.statue
        self.asked = -2
        self.last_state: Row = native.state_of(self.statue)
        falls_rad_s = fall_rad_s2(scene) * drive.settings.dt_s
        rising_rad_s = math.sqrt(SLOW_RISE * self.depth_m / self.height_m) / drive.settings.dt_s
        self.half_cycle_rad_s = HALF_CYCLE_STEPS * falls_rad_s
        self.slow_rad_s = min(SLOW_STEPS * falls_rad_s, rising_rad_s)
        self.fast_rad_s = max(FAST_RAD_S, self.slow_rad_s)

    def next_facet(self, state: Row, below: Row | None, before_rad_s: float) -> int:
        """The facet whose impact is to be met now, at a rate that was another a step before; else `NEAR` or `FAR`.

        `FAR`: the statue turns on one vertex, no facet is met in the coming steps, and the one left behind is off its support.
        """
        level, turned, spin = self.level_rad, state[2], state[5]
        if below is not None:
            tilt = below[2]
            if not -TIPPED_RAD <= tilt <= TIPPED_RAD:
                return NEAR
            turned -= tilt
        self.gained_rad_s = spin - before_rad_s
        above = bisect_left(level, turned)
        facet, behind = (above - 1, above) if spin < 0.0 else (above, above - 1)
        if 0 <= facet < len(level):
            ahead_s = (level[facet] - turned) / spin
            if ahead_s < self.far_s:
                return facet if ahead_s >= self.near_s else NEAR
        close = 0 <= behind < len(level) and abs(turned - level[behind]) < self.clear_rad
        return NEAR if close or self.walled or not -STEEPEST_RAD < turned < STEEPEST_RAD else FAR

    def held(self, k: int, state: Row, pull_m_s2: Pair) -> bool:
        """Whether the support bore it and kept its vertex from sliding in step k − 1, whose gravity was `pull_m_s2`.

        To be asked before each step: the state of the last question is what the velocity has changed from.
        """
        before, followed = self.last_state, self.asked == k - 1
        self.last_state, self.asked = state, k
        if not followed:
            return False
        falls = self.dt_s * pull_m_s2[1]
        borne = state[4] - before[4] - falls
        pushed = state[3] - before[3] - self.dt_s * pull_m_s2[0]
        return borne > -LEAST_BORNE * falls and abs(pushed) < self.most_friction * borne

    def left_rad(self, facet: int) -> float:
        """Rotation left until the facet lies on the support."""
        return float(self.level_rad[facet] - native.get_angle(self.statue) + self.tilt())

    def gap(self, vertex: int) -> Pair:
        """Height of a vertex over its support, m, and its rate, m/s."""
        place_x, place_z, angle, _, rise, spin = native.state_of(self.statue)
        x, z = self.points[vertex]
        cos, sin = math.cos(angle), math.sin(angle)
        below = self.below()
        top, top_rise = 0.0, 0.0
        if below is not None:
            top, top_rise = self._top(below, place_x + x * cos - z * sin, 0.0, below[2]), below[4]
        return place_z + x * sin + z * cos - top, rise + spin * (x * cos - z * sin) - top_rise

    def stands_on(self, vertex: int) -> bool:
        """Whether the vertex moves with its support, but for `HELD_SHARE` of its rate about the centroid."""
        _, _, angle, along, rise, spin = native.state_of(self.statue)
        arm_x, arm_z = self.arm(vertex, angle)
        below = self.below()
        if below is not None:
            along, rise = along - below[3], rise - below[4]
        slide, lift = along - spin * arm_z, rise + spin * arm_x
        return math.hypot(slide, lift) <= HELD_SHARE * abs(spin) * math.hypot(arm_x, arm_z)

    def vertex_at(self, angle_rad: float) -> int:
        """The vertex that a statue turned so stands on."""
        return bisect_left(self.level_rad, angle_rad - self.tilt())

    def arm(self, vertex: int, angle_rad: float) -> Pair:
        """Where a vertex is from the centroid when the statue is turned so, m."""
        (x, z), cos, sin = self.points[vertex], math.cos(angle_rad), math.sin(angle_rad)
        return x * cos - z * sin, x * sin + z * cos

    def tilt(self) -> float:
        """Rotation of the pedestal, rad."""
        return 0.0 if self.pedestal is None else float(native.get_angle(self.pedestal))

    def keep(self, length_s: float, kick_s: float, *, turned: bool = False) -> None:
        """Place the statue so that a move of `length_s` takes its standing vertex to its depth, unless it hardly turns.

        `kick_s`: by how much its velocities go on; `turned`: they are already those of the circle where it arrives.
        """
        self.gained_rad_s = 0.0
        lag_s = self.drive.t_s - self.drive.place_s
        lags_s = None if turned else (lag_s, lag_s + kick_s - length_s)
        self.hold(native.state_of(self.statue), self.below(), length_s, lags_s)

    def hold(
        self,
        state: Row,
        below: Row | None,
        length_s: float,
        lags_s: Pair | None,
        support_m: float | None = None,
        *,
        slow: bool = False,
    ) -> None:
        """The same from the states of the statue and of what moves below it; one at rest is settled, only if `slow`.

        `lags_s`: by how much its places lag its velocities before and after that move, None where these are already the circle's
        where it arrives; `support_m`: the support's height after that move, where the table's own motion gives it.
        """
        self.owed_m_s = (0.0, 0.0)
        place_x, place_z, angle, rate_x, rate_z, spin = state
        if -self.slow_rad_s < spin < self.slow_rad_s:
            at_rest = -self.half_cycle_rad_s < spin < self.half_cycle_rad_s
            if at_rest and not slow:
                return
            if self._in_reach(angle if below is None else angle - below[2]):
                if at_rest:
                    self.settle()
                return
        turn, tilt = spin * length_s, 0.0
        angle += turn
        if self.pedestal is not None and below is not None:
            tilt = below[2] + below[5] * length_s
        if not (-LEANING_RAD <= angle <= LEANING_RAD and -TIPPED_RAD <= tilt <= TIPPED_RAD):
            return
        level, leaning = self.level_rad, angle - tilt
        vertex = bisect_left(level, leaning)
        if (vertex > 0 and leaning - level[vertex - 1] < LEVEL_RAD) or (
            vertex < len(level) and level[vertex] - leaning < LEVEL_RAD
        ):
            return
        x, z = self.points[vertex]
        cos, sin = math.cos(angle), math.sin(angle)
        if support_m is None:
            support_m = 0.0
            if below is not None:
                support_m = self._top(below, place_x + rate_x * length_s + x * cos - z * sin, length_s, tilt)
        depth = self.depth_at(spin)
        excess = place_z + rate_z * length_s + x * sin + z * cos - support_m + depth
        if not -self.slop_m < excess < RISES * (depth + self.height_m * turn * turn):
            return
        ahead_x, ahead_z = 0.0, 0.0
        if lags_s is not None:
            arm_x, arm_z = x * cos - z * sin, x * sin + z * cos
            slides = rate_x - spin * (arm_z - turn * arm_x) - (0.0 if below is None else below[3])
            ahead_x, owed_x, owed_z = self._ahead(spin, turn, length_s, lags_s, (arm_x, arm_z), slides)
            self.owed_m_s, ahead_z = (owed_x, owed_z), owed_z * length_s
            rate_x, rate_z = rate_x - owed_x, rate_z - owed_z
            self.drive.ledger.explain("hold", abs(spin) + abs(self.gained_rad_s), self.height_m, self.dt_s)
        self.writer.write(
            "hold", state, (place_x + ahead_x, place_z - excess + ahead_z, state[2], rate_x, rate_z, spin)
        )

    def _ahead(
        self, spin: float, turn: float, length_s: float, lags_s: Pair, arm_m: Pair, slides_m_s: float
    ) -> tuple[float, float, float]:
        """How far the places go ahead along the support, m, and what is owed by the velocity, m/s (x, z)."""
        arm_x, arm_z = arm_m
        owed_x, owed_z = velocity_owed(spin, self.gained_rad_s, turn, lags_s, arm_x, arm_z)
        if abs(slides_m_s) <= HELD_SHARE * abs(spin) * self.height_m:
            # Along the support, too, the arc from the tangent: else the statue would walk over it.
            return 0.5 * turn * turn * arm_x + owed_x * length_s, owed_x, owed_z
        # A vertex that slides along its support is tied to it in height alone.
        return 0.0, 0.0, owed_z

    def depth_at(self, spin_rad_s: float) -> float:
        """Depth, m, at which the standing vertex of a statue that turns so is kept."""
        return self.depth_m if -self.fast_rad_s < spin_rad_s < self.fast_rad_s else self.rest_m

    def settle(self) -> None:
        """Lay a statue at rest on its facet again, at the depth of rest; the iterations left what it has turned there."""
        tilt = self.tilt()
        leaning = native.get_angle(self.statue) - tilt
        facet = min(range(len(self.level_rad)), key=lambda i: abs(leaning - self.level_rad[i]))
        off = abs(leaning - self.level_rad[facet])
        if off > self.clear_of_rest_rad[facet]:
            return
        if off > SETTLED * self.clear_of_rest_rad[facet]:
            before = native.state_of(self.statue)
            self.writer.write("settle", before, (*before[:2], self.level_rad[facet] + tilt, *before[3:]))
        sunk = max(self.gap(facet)[0], self.gap(facet + 1)[0]) + self.rest_m
        if SETTLED * self.rest_m < abs(sunk) < self.slop_m:
            before = native.state_of(self.statue)
            self.writer.write("settle", before, (before[0], before[1] - sunk, *before[2:]))

    def _in_reach(self, leaning_rad: float) -> bool:
        """Whether the other end of a facet may be in contact at the depth of rest."""
        level, clear = self.level_rad, self.clear_of_rest_rad
        vertex = bisect_left(level, leaning_rad)
        return (vertex > 0 and leaning_rad - level[vertex - 1] < clear[vertex - 1]) or (
            vertex < len(level) and level[vertex] - leaning_rad < clear[vertex]
        )

    def below(self) -> Row | None:
        """State of what moves below the statue, if anything does."""
        below = self.floor if self.pedestal is None and self.moving else self.pedestal
        return None if below is None else native.state_of(below)

    def _top(self, below: Row, x_m: float, length_s: float, tilt_rad: float) -> float:
        """Height of what the statue stands on at x, m, after a further move of `length_s`, tilted by `tilt_rad` then."""
        top = below[1] + below[4] * length_s + self.half_m
        if self.pedestal is None:
            return top
        return top + (x_m - below[0] - below[3] * length_s) * tilt_rad
