"""How a statue that turns on a vertex of its base is kept in contact: Chipmunk knows a contact by its penetration alone.

A step moves a turning body along the tangent of its vertex's circle, ω² h dt²/2 off the support. A contact that is lost so for
one step lets the statue fall freely and comes back as a blow: an impact met in such a step has the wrong ratio, by up to a tenth.
"""

import math
from bisect import bisect_left
from itertools import pairwise
from typing import Final

import numpy as np

from harness.engines.pymunk.settings import MunkSettings
from harness.engines.pymunk.world import State
from harness.engines.stepping.step_log import Ledger
from harness.model import Array, Scene
from meshes.footprint import lower_chain

Pair = tuple[float, float]

STILL: Final[State] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
STEEPEST_RAD: Final = 1.0
"""Facets of the silhouette that are steeper belong to its flanks: a statue that lies on them has fallen."""
TIPPED_RAD: Final = 1e-3
"""On a pedestal tilted by more the statue is left to the engine."""
RISES: Final = 4.0
"""A vertex that goes this many times as far as its circle takes it, and"""
LIFTED: Final = 0.1
"""this share of what falls freely in a step, lifts off: it is left alone."""
HELD_SHARE: Final = 1e-3
"""Share of its rate about the centroid below which a vertex is held by its support: the solver leaves 1e-9 of it."""
REST_SHARE: Final = 0.03
"""Share of a step's fall by which a statue at rest does not turn, and"""
RISE_SHARE: Final = 0.02
"""Share of that rate from which on it begins to rise."""
REST_STEPS: Final = 1e-3
"""rotation over the step, rad/s, by which it does not lean."""
AHEAD: Final = 2.5
"""Steps to an impact from which on it is looked for in each: more than one apart, as what falls is faster in each step."""


def base_vertices(scene: Scene) -> Array:
    """Vertices (k, 2) of the silhouette that a level support can touch while the statue stands, from right to left, m from the
    centroid.
    """
    chain = lower_chain(scene.statue.section_m)
    steps = np.diff(chain, axis=0)
    base = np.flatnonzero(np.abs(np.arctan2(steps[:, 1], steps[:, 0])) < STEEPEST_RAD)
    facets = chain[base[0] : base[-1] + 2]
    return np.asarray(facets[::-1] - np.array([0.0, scene.statue.centroid_height_m]))


class SupportVertex:
    """The base as vertices from right to left, (x, z) from the centroid; `level_rad` are the rotations (ascending) at which the
    facets between them lie on a level support: turned beyond the first i of them the statue stands on vertex i.
    """

    def __init__(self, scene: Scene, settings: MunkSettings) -> None:
        points = base_vertices(scene)
        self.points = [(float(x), float(z)) for x, z in points]
        self.level_rad = [float(-math.atan2(dz, dx)) for dx, dz in points[:-1] - points[1:]]
        self.between_rad = [0.5 * (low + high) for low, high in pairwise(self.level_rad)]
        # Turned by its weight about one corner: the lever is longest upright, as a lean onto that corner shortens it.
        arms = ((scene.statue.corner_m(side), scene.pivot_inertia_kg_m2[side]) for side in (-1, 1))
        fall_rad_s2 = max(scene.statue.mass_kg * scene.gravity_m_s2 * arm / inertia for arm, inertia in arms)
        self.rest_rad_s = REST_SHARE * fall_rad_s2 * settings.dt_s
        self.height_m, self.depth_m, self.slop_m = scene.statue.centroid_height_m, settings.depth_m, settings.slop_m
        self.half_m = 0.0 if scene.pedestal is None else 0.5 * scene.pedestal.height_m
        self.lifted_m = LIFTED * scene.gravity_m_s2 * settings.dt_s**2
        self.mass_kg, self.gravity_m_s2 = scene.statue.mass_kg, scene.gravity_m_s2
        self.ahead_s = AHEAD * settings.dt_s
        self.near_rad, self.stood, self.step_s = REST_STEPS * settings.dt_s, False, settings.dt_s

    def held(
        self, state: State, below: State | None, since_s: float, lags_s: Pair, gained: float, ledger: Ledger
    ) -> State:
        """The state with the standing vertex at its depth, over a support at rest or in the state `below`.

        `since_s`: time since velocities were solved; `lags_s`: by how much these lag their instant, and will after the step;
        `gained`: what the spin gained in the last whole step, rad/s.
        """
        under = STILL if below is None else below
        lean, leaning = state[2] - under[2], state[5] - under[5]
        if not (-STEEPEST_RAD < lean < STEEPEST_RAD and -TIPPED_RAD <= under[2] <= TIPPED_RAD):
            self.stood = False
            return state
        facet = bisect_left(self.between_rad, lean)
        off = lean - self.level_rad[facet]
        if abs(off) >= self.near_rad:
            return self._on_circle(state, under, facet + (off > 0.0), since_s, lags_s, gained, ledger)
        if -self.rest_rad_s < leaning < self.rest_rad_s:
            # One that begins to rise is not laid down again.
            down = math.copysign(leaning, off * leaning) < RISE_SHARE * self.rest_rad_s
            return self._at_rest(state, under, facet, off, ledger, down=down)
        # Around an impact either end may be the lower: it stands on the one that does not rise.
        rising = state[4] - under[4]
        vertex = min(facet, facet + 1, key=lambda end: abs(rising + leaning * self.points[end][0]))
        return self._on_circle(state, under, vertex, since_s, lags_s, gained, ledger)

    def _at_rest(self, state: State, under: State, facet: int, off: float, ledger: Ledger, *, down: bool) -> State:
        """Both ends of a facet in contact; one that is `down` but for what a step cannot tell is laid flat."""
        x, z, angle, rate_x, rate_z, spin = state
        turned = angle - off if down else angle
        # Flat, either end is as high; else the higher one must be down.
        _, _, excess = self._over(x, z, turned, under, facet + (not down and off <= 0.0))
        self.stood = abs(excess) <= self.slop_m
        if (not down and abs(excess) < 0.5 * self.depth_m) or abs(excess) > self.slop_m:
            return state
        change_j = -self.mass_kg * self.gravity_m_s2 * excess
        ledger["settle"].write(abs(excess), abs(turned - angle), 0.0, 0.0, change_j)
        return x, z - excess, turned, rate_x, rate_z, spin

    def _on_circle(
        self, state: State, under: State, vertex: int, since_s: float, lags_s: Pair, gained: float, ledger: Ledger
    ) -> State:
        """The statue where its standing vertex keeps its place, with the velocity that this takes."""
        x, z, angle, rate_x, rate_z, spin = state
        arm_x, arm_z, excess = self._over(x, z, angle, under, vertex)
        turn = spin * since_s
        most = RISES * self.height_m * turn * turn + self.lifted_m
        # What stood goes on to where the solver's slop leaves it; what lands is not lifted out of the support.
        self.stood = -(max(self.slop_m, most) if self.stood else most) < excess < most
        if not self.stood:
            return state
        owed_x, owed_z = velocity_owed(spin, gained, turn, lags_s, arm_x, arm_z)
        ahead = 0.0
        if abs(rate_x - spin * (arm_z - turn * arm_x) - under[3]) <= HELD_SHARE * abs(spin) * self.height_m:
            # Along the support, too, the arc from the tangent: else the statue would walk over it.
            ahead = 0.5 * turn * turn * arm_x
        else:
            # A vertex that slides along its support is tied to it in height alone.
            owed_x = 0.0
        lost = owed_x * (rate_x - 0.5 * owed_x) + owed_z * (rate_z - 0.5 * owed_z)
        change_j = -self.mass_kg * (self.gravity_m_s2 * excess + lost)
        account = ledger["hold"]
        account.write(math.hypot(ahead, excess), 0.0, math.hypot(owed_x, owed_z), 0.0, change_j)
        account.explain(abs(spin) + abs(gained), self.height_m, self.step_s)
        return x + ahead, z - excess, angle, rate_x - owed_x, rate_z - owed_z, spin

    def _over(self, x: float, z: float, angle: float, under: State, vertex: int) -> tuple[float, float, float]:
        """Where a vertex is from the centroid of a statue turned so, and its height over its depth, m."""
        px, pz = self.points[vertex]
        cos, sin = math.cos(angle), math.sin(angle)
        arm_x, arm_z = px * cos - pz * sin, px * sin + pz * cos
        top = under[1] + self.half_m + (x + arm_x - under[0]) * under[2]
        return arm_x, arm_z, z + arm_z - top + self.depth_m

    def contact_within_steps(self, state: State, under: State) -> bool:
        """Whether the statue, turning on as it does, lies on its next facet within some steps."""
        spin, lean, level = state[5] - under[5], state[2] - under[2], self.level_rad
        following = bisect_left(level, lean) - (spin < 0.0)
        if not 0 <= following < len(level):
            return False
        return (
            (level[following] - lean) < spin * self.ahead_s
            if spin > 0.0
            else (level[following] - lean) > spin * self.ahead_s
        )


def velocity_owed(spin: float, gained: float, turn: float, lags_s: Pair, arm_x: float, arm_z: float) -> Pair:
    """What to take from the centroid's velocity before a step so that support and spin have their own at its end, m/s.

    `spin`, rad/s, and what it `gained` in the last whole step; `turn`, rad; `arm` from the centroid to the vertex, m.

    A velocity is the tangent of the circle where its contact was solved, a lag behind its instant: it lacks lag ω² arm. A
    pedestal that slides shares that momentum, and it and the spin are off by it at first order. What the lack changes by in
    a turn, with arm' for ω × arm over ω, is ω² ((lag₁ − lag₀) arm + lag₀ turn arm') + 2 ω Δω lag₁ arm. Its part across the
    arm is also what the spin would lose: a solution keeps of a velocity only what lies along the new tangent.
    """
    lag_s, after_s = lags_s
    along = spin * (spin * (after_s - lag_s) + 2.0 * gained * after_s)
    across = spin * spin * lag_s * turn
    return along * arm_x - across * arm_z, along * arm_z + across * arm_x
