"""The base vertex that stands, the facet that comes next, and how the vertex is kept at the depth at which contacts last.

A step moves a turning body along the tangent of its vertex's circle, ω² h dt²/2 off the support. A contact that is lost so for
one step lets the statue fall freely and comes back as a blow: an impact met in such a step has the wrong ratio, by up to a tenth.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.engines.munk2d import native
from harness.engines.munk2d.drive import Drive
from harness.engines.munk2d.world import MunkSettings
from harness.scene import Scene
from meshes.footprint import lower_chain

Array = NDArray[np.float64]
Pair = tuple[float, float]

LEVEL_RAD: Final = 1e-6
"""Nearer than this to a facet's rotation both of its ends stand."""
STEEPEST_RAD: Final = 1.0
"""Facets of the silhouette that are steeper belong to its flanks: a statue that lies on them has fallen."""
LEANING_RAD: Final = 2.0
"""Beyond this rotation no vertex of the base stands any more."""
TIPPED_RAD: Final = 1e-3
"""A pedestal tilted by more has its own impacts: its statue is left to whole steps."""
SLOW_DEPTHS: Final = 2.0
"""An impact is met when its vertex moves more than this many depths in a step; slower ones the engine resolves itself."""
LEAST_AHEAD: Final = 0.6
MOST_AHEAD: Final = 2.3
"""Steps to an impact between which it is met: more than one apart, as what falls is faster in each step."""
MOST_GAINED: Final = 0.3
"""Share of the rate above which its change in the last step leaves an impact to whole steps: swings of so few steps must die out
in them, and parts of steps would keep them alive."""
SLOW_STEPS: Final = 10.0
"""A rate that gravity changes in so many steps takes a vertex nowhere. Held up in each of them, a statue that comes to rest in
swings of a few steps would rock for ever; never held up, one at rest would sink and turn within the slop."""
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


class Standing:
    """The base as vertices from right to left, (x, z) from the centroid, and its facets between them.

    `level_rad` (ascending, anticlockwise as Chipmunk counts) are the rotations at which the facets lie on a level support: turned
    beyond the first i of them the statue stands on vertex i. `least_rad_s` are the rates above which their impacts are met,
    `facet` the one that was found to come.
    """

    def __init__(self, drive: Drive) -> None:
        world, scene = drive.world, drive.scene
        self.statue, self.floor = native.body_of(world.statue), native.body_of(world.floor)
        self.pedestal = None if world.pedestal is None else native.body_of(world.pedestal)
        points = base_vertices(scene)
        self.points = [(float(x), float(z)) for x, z in points]
        steps = points[:-1] - points[1:]
        self.level_rad = [float(-math.atan2(dz, dx)) for dx, dz in steps]
        self.length_m = [float(math.hypot(dx, dz)) for dx, dz in steps]
        self.least_rad_s = [least_rate_rad_s(drive.settings, length) for length in self.length_m]
        self.height_m, self.moving = scene.statue.centroid_height_m, drive.moving
        self.depth_m, self.slop_m = drive.settings.depth_m, drive.settings.slop_m
        self.half_m = 0.0 if scene.pedestal is None else 0.5 * scene.pedestal.height_m
        self.near_s, self.far_s = LEAST_AHEAD * drive.settings.dt_s, MOST_AHEAD * drive.settings.dt_s
        self.facet = NEAR
        self.clear_rad, self.walled = CLEAR_STEPS * drive.settings.dt_s, scene.wall is not None
        self.velocity_m_s, self.asked, self.most_friction = (0.0, 0.0), -2, MOST_FRICTION * scene.contact.statue
        self.slow_rad_s = SLOW_STEPS * _fall_rad_s2(scene) * drive.settings.dt_s

    def coming(self, spin_rad_s: float, before_rad_s: float) -> int:
        """The facet whose impact is to be met now at this rate, which was another a step before; else `NEAR` or `FAR`.

        `FAR`: the statue turns on one vertex, no facet is met in the coming steps, and the one left behind is off its support.
        """
        level, turned = self.level_rad, native.get_angle(self.statue)
        if self.pedestal is not None:
            tilt = native.get_angle(self.pedestal)
            if not -TIPPED_RAD <= tilt <= TIPPED_RAD:
                return NEAR
            turned -= tilt
        above = bisect_left(level, turned)
        facet, behind = (above - 1, above) if spin_rad_s < 0.0 else (above, above - 1)
        if 0 <= facet < len(level):
            ahead_s = (level[facet] - turned) / spin_rad_s
            if ahead_s < self.far_s:
                fast = abs(spin_rad_s) > self.least_rad_s[facet]
                steady = abs(spin_rad_s - before_rad_s) <= MOST_GAINED * abs(spin_rad_s)
                return facet if fast and steady and ahead_s >= self.near_s else NEAR
        close = 0 <= behind < len(level) and abs(turned - level[behind]) < self.clear_rad
        return NEAR if close or self.walled or not -STEEPEST_RAD < turned < STEEPEST_RAD else FAR

    def held(self, k: int, free_m_s: Pair) -> bool:
        """Whether the support bore it and kept its vertex from sliding in step k − 1, which would have changed the velocity of a
        free body by `free_m_s`; to be asked before each step.
        """
        velocity, (before_x, before_z) = native.get_velocity(self.statue), self.velocity_m_s
        followed, self.asked = self.asked == k - 1, k
        x, z = self.velocity_m_s = velocity.x, velocity.y
        borne = z - before_z - free_m_s[1]
        return bool(
            followed
            and borne > -LEAST_BORNE * free_m_s[1]
            and abs(x - before_x - free_m_s[0]) < self.most_friction * borne
        )

    def left_rad(self, facet: int) -> float:
        """Rotation left until the facet lies on the support."""
        return float(self.level_rad[facet] - native.get_angle(self.statue) + self.tilt())

    def tilt(self, length_s: float = 0.0) -> float:
        """Rotation of the pedestal, rad, after a further move of `length_s`."""
        if self.pedestal is None:
            return 0.0
        return float(native.get_angle(self.pedestal) + native.get_spin(self.pedestal) * length_s)

    def support(self, x_m: float, length_s: float = 0.0, tilt_rad: float | None = None) -> float:
        """Height of what the statue stands on at x, m, after a further move of `length_s` (and the pedestal's rotation then)."""
        below = self.pedestal
        if below is None:
            if not self.moving:
                return 0.0
            below = self.floor
        place, velocity = native.get_place(below), native.get_velocity(below)
        top = place.y + velocity.y * length_s + self.half_m
        if self.pedestal is not None:
            tilt = self.tilt(length_s) if tilt_rad is None else tilt_rad
            top += (x_m - place.x - velocity.x * length_s) * tilt
        return float(top)

    def gap(self, vertex: int) -> tuple[float, float]:
        """Height of a vertex over its support, m, and its rate, m/s."""
        angle, spin = native.get_angle(self.statue), native.get_spin(self.statue)
        x, z = self.points[vertex]
        cos, sin = math.cos(angle), math.sin(angle)
        rise = 0.0
        if self.pedestal is not None:
            rise = native.get_velocity(self.pedestal).y
        elif self.moving:
            rise = native.get_velocity(self.floor).y
        place = native.get_place(self.statue)
        height = place.y + x * sin + z * cos - self.support(place.x + x * cos - z * sin)
        return float(height), float(native.get_velocity(self.statue).y + spin * (x * cos - z * sin) - rise)

    def keep(self, length_s: float, support_m: float | None = None, *, slow: bool = False) -> None:
        """Place the statue so that a move of `length_s` takes its standing vertex to its depth; at a slow rate only if `slow`.

        `support_m`: the support's height after that move, where the table's own motion gives it.
        """
        body = self.statue
        spin = native.get_spin(body)
        if not slow and -self.slow_rad_s < spin < self.slow_rad_s:
            return
        angle, tilt = native.get_angle(body) + spin * length_s, self.tilt(length_s)
        if abs(angle) > LEANING_RAD or abs(tilt) > TIPPED_RAD:
            return
        level, turned = self.level_rad, angle - tilt
        vertex = bisect_left(level, turned)
        if (vertex > 0 and turned - level[vertex - 1] < LEVEL_RAD) or (
            vertex < len(level) and level[vertex] - turned < LEVEL_RAD
        ):
            return
        x, z = self.points[vertex]
        place, velocity = native.get_place(body), native.get_velocity(body)
        cos, sin = math.cos(angle), math.sin(angle)
        if support_m is None:
            support_m = self.support(place.x + velocity.x * length_s + x * cos - z * sin, length_s, tilt)
        excess = place.y + velocity.y * length_s + x * sin + z * cos - support_m + self.depth_m
        turn = spin * length_s
        if -self.slop_m < excess < RISES * (self.depth_m + self.height_m * turn * turn):
            native.set_place(body, (place.x, place.y - excess))


def base_vertices(scene: Scene) -> Array:
    """Vertices (k, 2) of the silhouette that a level support can touch while the statue stands, from right to left, m from the
    centroid.
    """
    chain = lower_chain(scene.statue.section_m)
    steps = np.diff(chain, axis=0)
    base = np.flatnonzero(np.abs(np.arctan2(steps[:, 1], steps[:, 0])) < STEEPEST_RAD)
    kept = chain[base[0] : base[-1] + 2]
    found: Array = kept[::-1] - np.array([0.0, scene.statue.centroid_height_m])
    return found


def least_rate_rad_s(settings: MunkSettings, length_m: float) -> float:
    """Rate below which an impact on a facet is left to the engine: its far end moves less than its depth of contact in a step."""
    return SLOW_DEPTHS * settings.depth_m / (length_m * settings.dt_s)


def _fall_rad_s2(scene: Scene) -> float:
    """Greatest acceleration of a statue that stands on one corner of its base, under its weight."""
    statue = scene.statue
    arms = ((statue.corner_m(side), scene.pivot_inertia_kg_m2[side]) for side in (-1, 1))
    return max(statue.mass_kg * scene.gravity_m_s2 * arm / inertia for arm, inertia in arms)
