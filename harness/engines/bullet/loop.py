"""The loop: steps, sub-steps through impacts, two coefficients of friction, an imposed impact, when to stop."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final

import numpy as np
import pybullet
from numpy.typing import NDArray

from harness.contact.impact import impact
from harness.engines.bullet.pose import Body
from harness.engines.bullet.schedule import Schedule, Vector
from harness.engines.bullet.world import World
from harness.scene import OVERTURN_RAD, Scene

Array = NDArray[np.float64]
Row = tuple[float, ...]

AHEAD: Final = 1.5
"""An impact expected within this many steps is passed in sub-steps: the rate changes little in so short a time."""
LEAST_RATE_RAD_S: Final = 1e-3
"""A slower approach is no impact: what a step's error could change is below a millionth of a radian."""
SATURATED: Final = 0.998
"""Friction counts as at its limit from this share of it: the solver's sweeps end before the last digits."""
STILL_M_S: Final = 1e-5
"""Velocity, m/s and rad/s, below which everything counts as still."""
STILL_CHECK: Final = 64
STILL_CHECKS: Final = 16
"""A run may end when everything was still at this many checks in a row, `STILL_CHECK` steps apart."""
OVERTURN_TAN: Final = math.tan(OVERTURN_RAD)
OVERTURN_COS: Final = math.cos(OVERTURN_RAD)


@dataclass(eq=False)
class Record:
    """What the loop saw: a row per sample (places, quaternions, velocities of statue and pedestal), gravity per step."""

    t_s: list[float] = field(default_factory=list)
    rows: list[Row] = field(default_factory=list)
    gravity: list[Vector] = field(default_factory=list)
    repeated: int = 0
    imposed: int = 0
    rested: bool = False


@dataclass(frozen=True, eq=False)
class Watch:
    """What the loop looks at: the statue's `axis` in its principal frame and in the world at `rest`, when and what to end.

    `impose` says that impacts are the model's. `quiet_from` is the number of the step from which the table is still (None: the run is not ended at rest). `halt` is asked
    now and then whether the run must end (the statue would touch what this world leaves out).
    """

    axis: Vector
    rest: Vector
    quiet_from: int | None
    impose: bool
    halt: Callable[[Row], bool] | None = None
    halt_every: int = 8


def start_row(world: World) -> Row:
    """The state as it stands in the world."""
    return _reader(world)()


def _reader(world: World) -> Callable[[], Row]:
    pose, speed, client = pybullet.getBasePositionAndOrientation, pybullet.getBaseVelocity, world.client
    statue, pedestal = world.statue, world.pedestal

    def both() -> Row:
        place, turn = pose(statue, client)
        velocity, rate = speed(statue, client)
        below, level = pose(pedestal, client)
        slip, tip = speed(pedestal, client)
        return (*place, *turn, *velocity, *rate, *below, *level, *slip, *tip)

    def alone() -> Row:
        place, turn = pose(statue, client)
        velocity, rate = speed(statue, client)
        return (*place, *turn, *velocity, *rate)

    return alone if pedestal is None else both


def bodies(row: Row) -> tuple[Body, Body | None]:
    """States of statue and pedestal in a row."""
    statue = Body(row[0:3], row[3:7], row[7:10], row[10:13])  # type: ignore[arg-type]
    if len(row) == 13:
        return statue, None
    return statue, Body(row[13:16], row[16:20], row[20:23], row[23:26])  # type: ignore[arg-type]


class Stepper:
    """One step at a time: gravity or table, friction's two numbers; keeps the sliding state between steps."""

    def __init__(self, world: World, scene: Scene, schedule: Schedule) -> None:
        self.world, self.schedule = world, schedule
        self.read = _reader(world)
        contact, pedestal = scene.contact, scene.pedestal
        self.static, self.kinetic = contact.floor_static, contact.floor_kinetic
        self.switches = pedestal is not None and self.static != self.kinetic
        self.masses = (scene.statue.mass_kg, 0.0 if pedestal is None else pedestal.mass_kg)
        self.stuck = True
        self.repeated = 0
        self.table_rate: Vector = (0.0, 0.0, 0.0)

    def step(self, gravity: Vector, t_s: float, step_s: float, before: Row) -> Row:
        """Advance the world from `before` at `t_s` by `step_s`."""
        if self.schedule.moving:
            place, self.table_rate = self.schedule.table(t_s, step_s)
            self.world.move_table(place, self.table_rate)
        row = self._advance(gravity)
        if not self.switches:
            return row
        pull = (gravity[0] * step_s, gravity[1] * step_s, gravity[2] * step_s)
        if self.stuck:
            return self._released(gravity, pull, before, row)
        if not self._saturated(self.kinetic, pull, before, row):
            self._hold(self.static)
        elif self._reversed(before, row):
            # The velocity passed zero: the step again with the static limit, which may hold.
            self._hold(self.static)
            self.restore(before)
            row = self._released(gravity, pull, before, self._advance(gravity))
        return row

    def _released(self, gravity: Vector, pull: Vector, before: Row, row: Row) -> Row:
        """A step computed with the static limit, or, where it reached the limit, once more with kinetic friction."""
        if not self._saturated(self.static, pull, before, row):
            return row
        self._hold(self.kinetic)
        self.restore(before)
        self.repeated += 1
        return self._advance(gravity)

    def _hold(self, friction: float) -> None:
        self.world.set_floor_friction(friction)
        self.stuck = friction == self.static

    def _saturated(self, friction: float, pull: Vector, before: Row, row: Row) -> bool:
        """Whether the floor's friction in this step, from the balance of momentum, reached its limit."""
        statue, pedestal = self.masses
        along, across, normal = (
            statue * (row[7 + k] - before[7 + k] - pull[k]) + pedestal * (row[20 + k] - before[20 + k] - pull[k])
            for k in range(3)
        )
        return math.hypot(along, across) >= SATURATED * friction * normal

    def _advance(self, gravity: Vector) -> Row:
        client = self.world.client
        pybullet.setGravity(*gravity, client)
        pybullet.stepSimulation(client)
        return self.read()

    def restore(self, row: Row) -> None:
        """Put both bodies back into a row's state."""
        statue, pedestal = bodies(row)
        self.world.place(self.world.statue, statue)
        if pedestal is not None and self.world.pedestal is not None:
            self.world.place(self.world.pedestal, pedestal)

    def _reversed(self, before: Row, row: Row) -> bool:
        x, y = self.table_rate[0], self.table_rate[1]
        return (before[20] - x) * (row[20] - x) + (before[21] - y) * (row[21] - y) < 0.0


def integrate(world: World, scene: Scene, schedule: Schedule, watch: Watch, first: Row, start: int) -> Record:
    """Run from step `start` with state `first` to the schedule's end, an overturn, rest, or a halt."""
    stepper = Stepper(world, scene, schedule)
    record = Record([start * schedule.step_s], [first])
    step_s, row, was_near, still = schedule.step_s, first, False, 0
    coarse, offset = schedule.coarse, schedule.first
    t_list, rows, pulls = record.t_s, record.rows, record.gravity
    for number in range(start, schedule.count):
        zx, zy, zz = axis_of(row, watch.axis)
        near = _near(row, zx - watch.rest[0], zy - watch.rest[1], step_s)
        if near or was_near:
            row = _through(stepper, scene, watch, record, number, row)
            was_near = near
        else:
            gravity = coarse[number - offset]
            if len(pulls) and t_list[-1] - t_list[-2] < 0.75 * step_s:
                gravity = schedule.after_fine(number)
                world.set_step(step_s)
            row = stepper.step(gravity, number * step_s, step_s, row)
            t_list.append((number + 1) * step_s)
            rows.append(row)
            pulls.append(gravity)
        if zz < 0.2 and _overturned(zx, zy, zz):
            break
        if number % watch.halt_every == 0 and watch.halt is not None and watch.halt(row):
            break
        if watch.quiet_from is not None and number >= watch.quiet_from and number % STILL_CHECK == 0:
            still = still + 1 if _still(row, zx - watch.rest[0], zy - watch.rest[1]) else 0
            if still >= STILL_CHECKS:
                record.rested = True
                break
    record.repeated = stepper.repeated
    return record


def _through(stepper: Stepper, scene: Scene, watch: Watch, record: Record, number: int, row: Row) -> Row:
    """One step in sub-steps."""
    schedule = stepper.schedule
    sub_s, start_s = schedule.substep_s, number * schedule.step_s
    after_fine = len(record.gravity) > 0 and record.t_s[-1] - record.t_s[-2] < 0.75 * schedule.step_s
    if not after_fine:
        stepper.world.set_step(sub_s)
    for index, gravity in enumerate(schedule.fine(number, after_fine)):
        if watch.impose:
            row = _imposed(stepper, scene, watch, record, row, sub_s)
        row = stepper.step(gravity, start_s + index * sub_s, sub_s, row)
        record.t_s.append(start_s + (index + 1) * sub_s)
        record.rows.append(row)
        record.gravity.append(gravity)
    return row


def _imposed(stepper: Stepper, scene: Scene, watch: Watch, record: Record, row: Row, step_s: float) -> Row:
    """Replace the impact that the coming step would hold by the model's: both bodies upright, with its velocities."""
    zx, _, _ = axis_of(row, watch.axis)
    lean, rate = zx - watch.rest[0], row[11]
    if lean * rate >= 0.0 or abs(rate) <= LEAST_RATE_RAD_S or abs(lean) > abs(rate) * step_s:
        return row
    side = 1 if lean > 0.0 else -1
    x, y = stepper.table_rate[0], stepper.table_rate[1]
    pedestal = len(row) > 13
    slip = row[20] - x if pedestal else 0.0
    found = impact(scene, old_side=side, theta_rate_rad_s=rate, slip_rate_m_s=slip, stuck=stepper.stuck)
    statue = scene.statue
    old, new = side * statue.corner_m(side), -side * statue.corner_m(-side)
    # The old corner stays where it stands; the centroid comes to lie over the base again.
    sin, cos = math.sin(lean), math.cos(lean)
    corner_x = row[0] + old * cos - statue.centroid_height_m * sin
    top = row[15] + 0.5 * scene.pedestal.height_m if pedestal and scene.pedestal is not None else 0.0
    place = (corner_x - old, row[1], top + statue.centroid_height_m)
    base_rate = found.slip_rate_m_s + x
    after = found.theta_rate_rad_s
    velocity = (base_rate + after * statue.centroid_height_m, y, after * new)
    upright = Body(place, _level(row, lean), velocity, (0.0, after, 0.0))
    stepper.world.place(stepper.world.statue, upright)
    if pedestal and stepper.world.pedestal is not None:
        below = bodies(row)[1]
        if below is not None:
            moved = Body(below.place_m, below.turn, (base_rate, y, 0.0), (0.0, 0.0, 0.0))
            stepper.world.place(stepper.world.pedestal, moved)
    record.imposed += 1
    return stepper.read()


def _level(row: Row, lean_rad: float) -> tuple[float, float, float, float]:
    """The statue's quaternion turned back by its lean about y."""
    x, y, z, w = row[3:7]
    s, c = math.sin(-0.5 * lean_rad), math.cos(-0.5 * lean_rad)
    return (c * x + s * z, c * y + s * w, c * z - s * x, c * w - s * y)


def axis_of(row: Row, axis: Vector) -> Vector:
    """World components of the statue's vertical axis."""
    x, y, z, w = row[3], row[4], row[5], row[6]
    a, b, c = axis
    return (
        (1.0 - 2.0 * (y * y + z * z)) * a + 2.0 * (x * y - z * w) * b + 2.0 * (x * z + y * w) * c,
        2.0 * (x * y + z * w) * a + (1.0 - 2.0 * (x * x + z * z)) * b + 2.0 * (y * z - x * w) * c,
        2.0 * (x * z - y * w) * a + 2.0 * (y * z + x * w) * b + (1.0 - 2.0 * (x * x + y * y)) * c,
    )


def _near(row: Row, zx: float, zy: float, step_s: float) -> bool:
    """Whether the base's edge along or across the plane comes down within the next steps."""
    wx, wy = row[10], row[11]
    reach = AHEAD * step_s
    if zx * wy < 0.0 and abs(wy) > LEAST_RATE_RAD_S and abs(zx) <= abs(wy) * reach:
        return True
    return zy * wx > 0.0 and abs(wx) > LEAST_RATE_RAD_S and abs(zy) <= abs(wx) * reach


def _overturned(zx: float, zy: float, zz: float) -> bool:
    if abs(zx) >= abs(zy):
        return abs(zx) >= zz * OVERTURN_TAN
    return zz <= OVERTURN_COS


def _still(row: Row, zx: float, zy: float) -> bool:
    moving = row[7:13] if len(row) == 13 else row[7:13] + row[20:26]
    return max(map(abs, moving)) < STILL_M_S and abs(zx) < 1e-4 and abs(zy) < 1e-4
