"""Chipmunk behind the layer that locates events: its own step, and how a statue that turns on a vertex is kept in contact.

Chipmunk moves bodies with the velocities that they have, finds what touches there, and then solves velocities: it is read one
move later. Its step size never changes, as that would corrupt the impulses that it starts from: for a step of another length
gravity is scaled and the bodies are placed.
"""

import math
from bisect import bisect_left
from collections.abc import Sequence
from itertools import pairwise
from typing import Final

import numpy as np
from pymunk._chipmunk_cffi import lib

from harness.engines.pymunk.settings import MunkSettings
from harness.engines.pymunk.world import State, World, contacts_of
from harness.engines.stepping.step_state import StepState
from harness.engines.stepping.trajectory import ALONE, Account, Impulse, Ledger, Pair, Row, StepLog, Vector
from harness.model import Array, Scene
from meshes.footprint import lower_chain

# How a statue that turns on a vertex of its base is kept in contact: Chipmunk knows a contact by its penetration alone.
#
# A step moves a turning body along the tangent of its vertex's circle, ω² h dt²/2 off the support. A contact that is lost so for
# one step lets the statue fall freely and comes back as a blow: an impact met in such a step has the wrong ratio, by up to a
# tenth.


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


# Its own step.

STICKS_AHEAD: Final = 4.0
"""Steps to a stick onset from which on it is looked for in each: its deceleration may grow as much as fourfold in one."""
LEAST_SLIDES_M_S2: Final = 1e-2
"""Velocity over the step above which a pedestal has slid: solver iterations leave a hundredth of it at rest."""
ONE_STEP: Final = 1e-9
"""Share of a step by which its length may differ and be a whole step's."""


class ChipmunkBackend:
    """One of Chipmunk's spaces (`harness.engines.stepping.step_state.Backend`); a `support` keeps the statue in contact."""

    def __init__(self, world: World, settings: MunkSettings, support: SupportVertex | None = None) -> None:
        self.settings, self.step_s = settings, settings.dt_s
        # pymunk's objects own Chipmunk's, which go with them.
        self.world = world
        self.space, self.floor_body, self.floor_shape = world.space._space, world.floor._body, world.floor_shape._shape
        self.bodies = [body._body for body in (world.statue, world.pedestal) if body is not None]
        self.support = support
        self.floor: State | None = None
        self.floor_m_s = (0.0, 0.0)
        # What a step must be told of the one before is known here.
        self.runs, self.depth_m = True, settings.depth_m
        self.length_s, self.whole_lags_s = self.step_s, (0.5 * self.step_s, 0.5 * self.step_s)
        self.read_states = world.reader.states
        self.states: list[State] = self.read_states()
        # Whether Chipmunk's places are one move before those of `states`.
        self.lagging = False
        self.solved_s: float | None = None
        self.since_s, self.lags_s, self.gained = 0.0, (0.0, 0.0), 0.0
        self.holds, self.slip_m_s, self.least_m_s = False, 0.0, LEAST_SLIDES_M_S2 * self.step_s
        self.near: bool | None = False
        self.iterations, self.owed_m_s = -1, (0.0, 0.0)
        self.ledger = Ledger(Account)

    def read(self) -> Row:
        """The bodies' state."""
        return row_of(self.states)

    def place(self, row: Row) -> None:
        """Let the next step begin in the state of a row, and on a table that Chipmunk has not moved on."""
        self.states, self.lagging, self.gained = states_of(row), False, 0.0
        if self.floor is not None:
            self._place_floor(self.floor[0], self.floor[1])

    def set_length(self, length_s: float) -> None:
        """Length of the steps that follow, s."""
        self.length_s = length_s

    def impulses(self, places: Row) -> list[Impulse]:
        """What the contacts gave each body in the last step; empty where one that was lost came back."""
        given = [contacts_of(body) for body in self.bodies]
        return [each for each in given if each is not None] if None not in given else []

    def set_floor_friction(self, friction: float) -> None:
        """Coefficient of the pedestal on the floor from now on."""
        lib.cpShapeSetFriction(self.floor_shape, friction)

    def move_table(self, place_m: Vector, velocity_m_s: Vector) -> None:
        """Put the floor to where it is after Chipmunk's move."""
        (x, _, z), (u, _, w) = place_m, velocity_m_s
        # Until it is solved the statue has the velocity of the step before.
        self.floor, self.floor_m_s = (x, z, 0.0, *self.floor_m_s, 0.0), (u, w)
        lib.cpBodySetVelocity(self.floor_body, (u, w))
        self._place_floor(x, z)

    def _place_floor(self, x: float, z: float) -> None:
        """Where Chipmunk's move takes it to this place."""
        (u, w), step_s = self.floor_m_s, self.step_s
        lib.cpBodySetPosition(self.floor_body, (x - u * step_s, z - w * step_s))

    def prepare_step(self, state: StepState, kick_s: float, length_s: float) -> None:
        """What the next step's velocities lag behind, and will."""
        solved_s = state.t_s if self.solved_s is None else self.solved_s
        self.since_s = state.t_s - solved_s
        self.lags_s = (state.kick_s - solved_s, kick_s - state.t_s)
        self.solved_s, self.ledger = state.t_s, state.record.ledger
        # At an impact the layer has brought velocities and places to its instant.
        self.holds = self.support is not None and kick_s > state.kick_s

    def advance(self, gravity: Vector) -> Row:
        """One step under a gravity; the row after it."""
        share = self.length_s / self.step_s
        if abs(share - 1.0) < ONE_STEP:
            return self._whole(gravity)
        self._solve(self._held(), (gravity[0] * share, gravity[2] * share), self.settings.impact_iterations)
        self.lagging, self.gained = False, 0.0
        return row_of(self.states)

    def run(self, pulls: Sequence[Vector], record: StepLog) -> Row:
        """Whole steps one after the other; rows are recorded, the last is returned."""
        keep, pack, step_s = record.flat.frombytes, record.pack, self.step_s
        row: Row = ()
        solved_s = (self.solved_s or 0.0) - step_s
        for gravity in pulls:
            row = self._whole(gravity)
            keep(pack(*row))
            solved_s += step_s
            self.since_s, self.lags_s = step_s, self.whole_lags_s
            if self.near:
                break
        self.solved_s = solved_s
        return row

    def _whole(self, gravity: Vector) -> Row:
        states, own = self._held(), self.settings
        # Impulses of another state, or none, are no guess for the next ones.
        iterations = own.iterations if self.lagging and not self.near else own.impact_iterations
        self._solve(states, (gravity[0], gravity[2]), iterations)
        after = self.states[0]
        self.gained, self.lagging = after[5] - states[0][5], True
        if self.support is not None:
            below = self.states[1] if len(states) > 1 else STILL
            self.near = self.support.contact_within_steps(after, below) or (
                below is not STILL and self._sticks_within_steps(below[3] - self.floor_m_s[0])
            )
        return row_of(self.states)

    def _sticks_within_steps(self, slip_m_s: float) -> bool:
        """Whether the pedestal, slowing as it does, sticks within some steps, or has done so in this one."""
        before, self.slip_m_s = self.slip_m_s, slip_m_s
        lost = before - slip_m_s
        if slip_m_s * before <= 0.0:
            return abs(before) > self.least_m_s
        return 0.0 < slip_m_s < STICKS_AHEAD * lost or STICKS_AHEAD * lost < slip_m_s < 0.0

    def _solve(self, states: list[State], pull: Pair, iterations: int) -> None:
        """Chipmunk's own step from these states, places going on by its length afterwards."""
        if not self.lagging:
            self._write(states)
        elif states is not self.states:
            x, z, angle, u, w, spin = states[0]
            lib.cpBodySetVelocity(self.bodies[0], (u, w))
            lib.cpBodySetPosition(self.bodies[0], (x - u * self.step_s, z - w * self.step_s))
            if angle != self.states[0][2]:
                lib.cpBodySetAngle(self.bodies[0], angle - spin * self.step_s)
        if iterations != self.iterations:
            lib.cpSpaceSetIterations(self.space, iterations)
            self.iterations = iterations
        lib.cpSpaceSetGravity(self.space, pull)
        lib.cpSpaceStep(self.space, self.step_s)
        # Chipmunk's places are now those at which contacts were found.
        self.states = self.read_states(self.length_s)

    def look(self, pulls: Sequence[Vector], before: Row, after: Row, table_m_s: Vector) -> None:
        """Nothing: contacts need no other settings."""

    def _held(self) -> list[State]:
        if not self.holds or self.support is None:
            self.owed_m_s = (0.0, 0.0)
            return self.states
        below = self.states[1] if len(self.states) > 1 else self.floor
        before = self.states[0]
        state = self.support.held(before, below, self.since_s, self.lags_s, self.gained, self.ledger)
        self.owed_m_s = (before[3] - state[3], before[4] - state[4])
        return self.states if state is before else [state, *self.states[1:]]

    def _write(self, states: list[State]) -> None:
        """Bodies one move before these states."""
        step_s, parts = self.step_s, self.ledger["part_of_step"]
        for body, now, (x, z, angle, u, w, spin) in zip(self.bodies, self.read_states(), states, strict=True):
            old_x, old_z, old_angle, *_ = now
            moved_m = math.hypot(x - u * step_s - old_x, z - w * step_s - old_z)
            parts.write(moved_m, abs(angle - spin * step_s - old_angle), 0.0, 0.0, 0.0)
            lib.cpBodySetPosition(body, (x - u * step_s, z - w * step_s))
            lib.cpBodySetAngle(body, angle - spin * step_s)
            lib.cpBodySetVelocity(body, (u, w))
            lib.cpBodySetAngularVelocity(body, spin)


def row_of(states: Sequence[State]) -> Row:
    """The layer's row of planar states: a rotation about y, clockwise as the model counts."""
    x, z, angle, u, w, spin = states[0]
    sin, cos = -math.sin(0.5 * angle), math.cos(0.5 * angle)
    if len(states) == 1:
        return x, 0.0, z, 0.0, sin, 0.0, cos, u, 0.0, w, 0.0, -spin, 0.0
    px, pz, tilt, pu, pw, rate = states[1]
    below, level = -math.sin(0.5 * tilt), math.cos(0.5 * tilt)
    return (
        x, 0.0, z, 0.0, sin, 0.0, cos, u, 0.0, w, 0.0, -spin, 0.0,
        px, 0.0, pz, 0.0, below, 0.0, level, pu, 0.0, pw, 0.0, -rate, 0.0,
    )  # fmt: skip


def states_of(row: Row) -> list[State]:
    """Planar states of a row."""
    return [
        (row[k], row[k + 2], -2.0 * math.atan2(row[k + 4], row[k + 6]), row[k + 7], row[k + 9], -row[k + 11])
        for k in range(0, len(row), ALONE)
    ]
