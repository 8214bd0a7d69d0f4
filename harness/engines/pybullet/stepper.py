"""One step of Bullet: a gravity or a moving table, friction with two numbers, and the row of numbers read after it."""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from struct import Struct
from typing import Final

import numpy as np
import pybullet
from numpy.typing import NDArray

from harness.engines.contact.coulomb import SLIP_ONSET
from harness.engines.event_stepping.interventions import Ledger
from harness.engines.pybullet.gyroscopic import Gyroscope
from harness.engines.pybullet.heading import puller, reader
from harness.engines.pybullet.schedule import Schedule, Vector
from harness.engines.pybullet.world import World
from harness.engines.pybullet.writing import ALONE, RowWriter
from harness.model.scene import Scene

Array = NDArray[np.float64]
Row = tuple[float, ...]

SATURATED: Final = 0.998
"""Friction counts as at its limit from this share of it: the solver's iterations end before the last digits."""
GRIP: Final = 0.5
"""Share of the statue's friction limit from which on its feet are not taken to stand, and"""
GRIP_AGAIN: Final = 0.35
"""below which they are again."""
STEPS_OFF: Final = 2.0
"""A body's reach over the square of its turning in a step, at least: half of that is what a step takes a foot off its support."""
WIDER: Final = 4.0
"""How many times as wide it is made as that, when it is too narrow, and"""
NARROWER: Final = 256.0
"""how many times too wide it may be."""
REVERSAL: Final = "friction_reversal"
"""Kind of what is written where the pedestal's velocity passed zero, and static friction may hold."""
RESTING_M_S: Final = 1e-3
"""Velocity, m/s and rad/s, below which statue and pedestal rest: one that rocks is slower for a hundredth of a half-cycle."""
STICKS_BELOW: Final = 0.3
"""Share of a step's loss of velocity that may be left of it when the pedestal counts as stuck."""


@dataclass(eq=False)
class StepLog:
    """What the loop saw: times, and per time one row (place, quaternion, velocity, angular velocity of statue and pedestal).

    `t_s` are times of the places, `kick_s` of the velocities, at most half a step before; `at_rest` counts the samples that no
    step made, as nothing could move.
    """

    width: int
    t_s: list[float] = field(default_factory=list)
    kick_s: list[float] = field(default_factory=list)
    flat: array[float] = field(default_factory=lambda: array("d"))
    ledger: Ledger = field(default_factory=Ledger)
    rested: bool = False
    at_rest: int = 0

    @property
    def rows(self) -> Array:
        """The rows, shape (n, 13) or (n, 26)."""
        return np.frombuffer(self.flat, dtype=np.float64).reshape(-1, self.width)

    @cached_property
    def pack(self) -> Callable[..., bytes]:
        """The bytes of a row's numbers: an array takes these five times as fast as the numbers one by one."""
        return Struct(f"{self.width}d").pack

    def keep(self, t_s: float, kick_s: float, row: Row) -> None:
        """Append a sample."""
        self.t_s.append(t_s)
        self.kick_s.append(kick_s)
        self.flat.frombytes(self.pack(*row))

    def row(self, index: int) -> Row:
        """A row, counted from the last (-1) backwards."""
        end = len(self.flat) + (index + 1) * self.width
        return tuple(self.flat[end - self.width : end])

    @property
    def rate_before(self) -> Sequence[float]:
        """The statue's angular velocity in the row before the last."""
        begin = 10 - 2 * self.width
        return self.flat[begin : begin + 3]

    @property
    def last(self) -> Row:
        """The last row."""
        return self.row(-1)


def _advancer(world: World, read: Callable[[], Row], gyroscope: Gyroscope) -> Callable[[Vector], Row]:
    """Bullet's own step under a gravity, and the row after it."""
    set_gravity, step, client = puller(world), pybullet.stepSimulation, world.client

    def advance(gravity: Vector) -> Row:
        set_gravity(*gravity, client)
        gyroscope.act()
        step(client)
        return read()

    return advance


def _runner(world: World, read: Callable[[], Row]) -> Callable[[Sequence[Vector], StepLog], Row]:
    """The same for several steps of a body that needs no gyroscopic torque: rows are kept, the last is returned."""
    set_gravity, step, client = puller(world), pybullet.stepSimulation, world.client

    def run(pulls: Sequence[Vector], record: StepLog) -> Row:
        row: Row = ()
        keep, pack = record.flat.frombytes, record.pack
        for gravity in pulls:
            set_gravity(*gravity, client)
            step(client)
            row = read()
            keep(pack(*row))
        return row

    return run


class Stepper:
    """One step at a time: gravity or table, friction's two numbers; keeps the sliding state between steps."""

    def __init__(self, world: World, scene: Scene, schedule: Schedule) -> None:
        self.world, self.schedule = world, schedule
        self.writer = RowWriter(world, scene)
        self.read = reader(world)
        self.gyroscope = Gyroscope(world)
        self.advance = _advancer(world, self.read, self.gyroscope)
        self.run = _runner(world, self.read)
        contact, pedestal = scene.contact, scene.pedestal
        self.static, self.kinetic = contact.floor_static, contact.floor_kinetic
        self.switches = pedestal is not None and self.static != self.kinetic
        self.masses = (scene.statue.mass_kg, 0.0 if pedestal is None else pedestal.mass_kg)
        self.plain = not (schedule.moving or self.switches or self.gyroscope.moments)
        self.stuck = True
        self.grip_limit, self.grips = contact.statue, False
        self._anchor(held=world.feet_over)
        self.least_reach = world.reach
        self.just_slipped = False
        self.table_place: Vector = (0.0, 0.0, 0.0)
        self.table_rate: Vector = (0.0, 0.0, 0.0)
        self.table_before = self.table_rate

    def step(self, gravity: Vector, t_s: float, step_s: float, before: Row) -> Row:
        """Advance the world from `before` at `t_s` by `step_s`."""
        if self.schedule.moving:
            self.table_before = self.table_rate
            self.table_place, self.table_rate = self.schedule.table(t_s, step_s)
            self.world.move_table(self.table_place, self.table_rate)
        self.just_slipped = False
        row = self.advance(gravity)
        if not self.switches:
            return row
        pull = (gravity[0] * step_s, gravity[1] * step_s, gravity[2] * step_s)
        if self.stuck:
            row = self._slip_onset(gravity, pull, before, row)
            self.just_slipped = not self.stuck
            return row
        if not self._saturated(self.kinetic, pull, before, row) and self._sticks(before, row):
            self._hold(self.static)
        elif self._reversed(before, row):
            # The velocity passed zero: the step again with the static limit, which may hold.
            self._hold(self.static)
            self._again(before, REVERSAL)
            row = self._slip_onset(gravity, pull, before, self.advance(gravity))
        return row

    def _slip_onset(self, gravity: Vector, pull: Vector, before: Row, row: Row) -> Row:
        """A step computed with the static limit, or, where it reached the limit, once more with kinetic friction.

        One that brings the pedestal to rest, from a slip or a blow, reaches the limit too: static friction has it then.
        """
        gaining = self._speed(row, self.table_rate) > self._speed(before, self.table_before)
        stopped = not gaining and (self._sticks(before, row) or self._reversed(before, row))
        if stopped or not self._saturated(self.static, pull, before, row):
            return row
        self._hold(self.kinetic)
        self._again(before)
        return self.advance(gravity)

    def _again(self, before: Row, kind: str = SLIP_ONSET) -> None:
        """Back to where the step began, which is to be solved again."""
        self.writer.restore(before)
        self.writer.ledger.of(kind).steps_again += 1

    def look(self, pulls: Sequence[Vector], before: Row, after: Row) -> None:
        """After whole steps under `pulls`: what the bodies' contacts need next."""
        turning = after[10] * after[10] + after[11] * after[11]
        if len(after) > ALONE:
            x, y, z = self.table_rate
            table = (x, y, z, 0.0, 0.0, 0.0)
            moving = (abs(v - w) for k in (7, 20) for v, w in zip(after[k : k + 6], table, strict=True))
            self.world.solver.rest(not self.world.in_plane and max(moving) < RESTING_M_S)
            turning = max(turning, after[23] * after[23] + after[24] * after[24])
        needed = STEPS_OFF * turning * self.schedule.step_s**2
        if needed > self.world.reach or needed * NARROWER < self.world.reach > self.least_reach:
            self.world.set_reach(max(WIDER * needed, self.least_reach))
        if self.world.feet_over:
            self._look_at_grip(pulls, before, after)

    def _look_at_grip(self, pulls: Sequence[Vector], before: Row, after: Row) -> None:
        """Let the statue's feet keep their places only while its friction is far from its limit."""
        first, last, half_s = pulls[0], pulls[-1], 0.5 * len(pulls) * self.schedule.step_s
        x = after[7] - before[7] - half_s * (first[0] + last[0])
        y = after[8] - before[8] - half_s * (first[1] + last[1])
        z = after[9] - before[9] - half_s * (first[2] + last[2])
        share = GRIP if self.grips else GRIP_AGAIN
        if (math.hypot(x, y) < share * self.grip_limit * z) != self.grips:
            self._anchor(held=not self.grips)

    def _anchor(self, *, held: bool) -> None:
        self.grips = held
        if self.world.feet_over:
            self.world.anchor(held=held)

    def let_loose(self, friction: float, gravity: Vector, before: Row) -> Row:
        """A step in which the pedestal was let loose again, with the coefficient that acts over it: the static one holds it."""
        self._again(before)
        self.world.set_floor_friction(friction)
        row = self.advance(gravity)
        self._hold(self.static if friction == self.static else self.kinetic)
        return row

    def let_slide(self, sliding: bool) -> None:
        """The pedestal slides, or is held, from now on, as an impact that is not Bullet's left it."""
        if self.switches:
            self._hold(self.kinetic if sliding else self.static)

    def _hold(self, friction: float) -> None:
        self.world.set_floor_friction(friction)
        self.stuck = friction == self.static

    def _saturated(self, friction: float, pull: Vector, before: Row, row: Row) -> bool:
        """Whether the floor's friction in this step, from the balance of momentum, reached its limit."""
        x, y, normal = self.friction(pull, before, row)
        return math.hypot(x, y) >= SATURATED * friction * normal

    def friction(self, pull: Vector, before: Row, row: Row) -> Vector:
        """The floor's impulse on the pedestal in a step, N s, from the balance of momentum, less what `pull` gives."""
        statue, pedestal = self.masses
        x, y, z = (
            statue * (row[7 + k] - before[7 + k] - pull[k]) + pedestal * (row[20 + k] - before[20 + k] - pull[k])
            for k in range(3)
        )
        return x, y, z

    def _speed(self, row: Row, table: Vector) -> float:
        return math.hypot(row[20] - table[0], row[21] - table[1])

    def _sticks(self, before: Row, row: Row) -> bool:
        """Whether friction took nearly all of the velocity that it could take in this step: solver iterations leave a little."""
        here, there = self._speed(row, self.table_rate), self._speed(before, self.table_before)
        return here <= STICKS_BELOW * max(there - here, 0.0)

    def _reversed(self, before: Row, row: Row) -> bool:
        x, y = self.table_rate[0], self.table_rate[1]
        return (before[20] - x) * (row[20] - x) + (before[21] - y) * (row[21] - y) < 0.0


def axis_of(row: Row, axis: Vector) -> Vector:
    """World components of the statue's vertical axis."""
    x, y, z, w = row[3], row[4], row[5], row[6]
    a, b, c = axis
    return (
        (1.0 - 2.0 * (y * y + z * z)) * a + 2.0 * (x * y - z * w) * b + 2.0 * (x * z + y * w) * c,
        2.0 * (x * y + z * w) * a + (1.0 - 2.0 * (x * x + z * z)) * b + 2.0 * (y * z - x * w) * c,
        2.0 * (x * z - y * w) * a + 2.0 * (y * z + x * w) * b + (1.0 - 2.0 * (x * x + y * y)) * c,
    )
