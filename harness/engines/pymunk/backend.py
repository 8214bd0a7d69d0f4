"""Chipmunk behind the layer that locates events.

Chipmunk moves bodies with the velocities that they have, finds what touches there, and then solves velocities: it is read one
move later. Its step size never changes, as that would corrupt the impulses that it starts from: for a step of another length
gravity is scaled and the bodies are placed.
"""

import math
from collections.abc import Sequence
from typing import Final

from pymunk._chipmunk_cffi import lib

from harness.engines.pymunk.settings import MunkSettings
from harness.engines.pymunk.support import STILL, SupportVertex
from harness.engines.pymunk.world import State, World, contacts_of
from harness.engines.stepping.step_log import ALONE, Account, Impulse, Ledger, Row, StepLog, Vector
from harness.engines.stepping.step_state import StepState

Pair = tuple[float, float]


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
