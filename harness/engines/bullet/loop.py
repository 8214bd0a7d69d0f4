"""The loop: whole steps, sub-steps through impacts, when to stop."""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from harness.contact.spatial import fallen
from harness.engines.bullet import imposing
from harness.engines.bullet.schedule import Schedule, Vector
from harness.engines.bullet.stepper import Record, Row, Stepper, axis_of
from harness.engines.bullet.world import World
from harness.scene import Scene

AHEAD: Final = 1.5
"""An impact expected within this many steps is passed in sub-steps: the rate changes little in so short a time."""
LEAST_RATE_RAD_S: Final = 3e-3
"""A slower approach is no impact: what such a rate can lift is below a hundred-thousandth of a radian."""
LEAST_LEAN_RAD: Final = 1e-5
"""With a rate below `LEAST_RATE_RAD_S`, a lean that counts as none."""
LEAST_SHARE: Final = 0.1
"""Share of kinetic friction's deceleration below which a change of the pedestal's velocity is the solver's remainder."""
ALONE: Final = 13
"""Numbers in a row without a pedestal."""
RESTING_FREE: Final = 4
"""Steps taken at once at rest: an uplift and its return inside them are below a step's own error."""
MOST_FREE: Final = 16
"""Steps taken at once at most: so often are overturning, rest and the pedestal's edge looked at."""
LEANING: Final = 0.2
"""An axis whose vertical component is larger is far from overturned."""
STILL_LEAN_RAD: Final = 1e-4
"""A statue at rest on its base leans less than this from its pose at rest."""
STILL_M_S: Final = 1e-5
"""Velocity, m/s and rad/s, below which everything counts as still."""
LOOK_STEPS: Final = 64
"""Steps between two questions whether the run may end."""
STILL_CHECK: Final = 64
STILL_CHECKS: Final = 16
"""A run may end when everything was still at this many checks in a row, `STILL_CHECK` steps apart."""


@dataclass(frozen=True, eq=False)
class Watch:
    """What the loop looks at: the statue's `axis` in its principal frame and in the world at `rest`, when and what to end.

    `impose` says that impacts are the model's. `quiet_from` is the number of the step from which the table is still (None: the
    run is not ended at rest). `halt` is asked now and then whether the statue would touch what this world leaves out, `stop` with
    time and rotation whether the run may end.
    """

    axis: Vector
    rest: Vector
    quiet_from: int | None
    impose: bool
    halt: Callable[[Row], bool] | None = None
    stop: Callable[[float, float], bool] | None = None


def integrate(world: World, scene: Scene, schedule: Schedule, watch: Watch, first: Row, start: int) -> Record:
    """Run from step `start` with state `first` to the schedule's end, an overturn, rest, or a halt."""
    stepper = Stepper(world, scene, schedule)
    record = Record(len(first), [start * schedule.step_s], array("d", first))
    pull = _greatest_pull(scene)
    bound, kinetic = 2.0 * pull / scene.statue.centroid_height_m, scene.contact.floor_kinetic * scene.gravity_m_s2
    number, row, was_near, fine_before, still, cut, look = start, first, False, False, Still(watch), -1, start
    while number < schedule.count:
        zx, zy, zz = axis_of(row, watch.axis)
        if zz < LEANING and fallen(zx, zy, zz):
            break
        if watch.halt is not None and watch.halt(row):
            break
        if watch.stop is not None and number >= look:
            look = number + LOOK_STEPS
            if watch.stop(record.t_s[-1], math.atan2(zx, zz)):
                break
        if still.lasts(number, row, zx, zy):
            record.rested = True
            break
        free = _free_steps(row, zx - watch.rest[0], zy - watch.rest[1], schedule.step_s, bound)
        if len(row) > ALONE and len(record.t_s) > 1:
            free = min(free, _free_of_halt(stepper, record, row, pull, kinetic))
        if free == 0 or was_near or number == cut:
            row = _through(stepper, scene, watch, record, number, row, fine_before)
            was_near, fine_before = free == 0, True
            number += 1
            continue
        if fine_before:
            world.set_step(schedule.step_s)
            row = _whole(stepper, record, [schedule.after_fine(number)], number, row)
            fine_before, number = False, number + 1
            continue
        begin = number - schedule.first
        taken = len(record.t_s)
        row = _whole(stepper, record, schedule.coarse[begin : begin + free], number, row)
        number += len(record.t_s) - taken
        # A step that ends earlier found the pedestal let loose inside it: that step is taken again in sub-steps.
        cut = number if len(record.t_s) - taken < free else -1
    record.repeated = stepper.repeated
    return record


def _whole(stepper: Stepper, record: Record, pulls: list[Vector], number: int, row: Row) -> Row:
    """Whole steps from `number` on, one for each gravity; ends before a step in which static friction was passed."""
    step_s, keep, taken = stepper.schedule.step_s, record.flat.extend, len(pulls)
    if stepper.plain:
        advance = stepper.advance
        for gravity in pulls:
            row = advance(gravity)
            keep(row)
    else:
        for index, gravity in enumerate(pulls):
            after = stepper.step(gravity, (number + index) * step_s, step_s, row)
            if stepper.just_released:
                stepper.take_back(row)
                taken = index
                break
            row = after
            keep(row)
    record.t_s.extend((number + index) * step_s for index in range(1, taken + 1))
    return row


def _through(
    stepper: Stepper, scene: Scene, watch: Watch, record: Record, number: int, row: Row, fine_before: bool
) -> Row:
    """One step in sub-steps."""
    schedule = stepper.schedule
    sub_s, start_s = schedule.substep_s, number * schedule.step_s
    if not fine_before:
        stepper.world.set_step(sub_s)
    for index, gravity in enumerate(schedule.fine(number, fine_before)):
        if watch.impose and _comes_down(row, watch, sub_s):
            lean = axis_of(row, watch.axis)[0] - watch.rest[0]
            row = imposing.impose(stepper, scene, row, lean)
            record.imposed += 1
        row = stepper.step(gravity, start_s + index * sub_s, sub_s, row)
        record.t_s.append(start_s + (index + 1) * sub_s)
        record.flat.extend(row)
    return row


def _comes_down(row: Row, watch: Watch, step_s: float) -> bool:
    """Whether the statue passes upright within the coming step."""
    lean, rate = axis_of(row, watch.axis)[0] - watch.rest[0], row[11]
    return lean * rate < 0.0 and abs(rate) > LEAST_RATE_RAD_S and abs(lean) <= abs(rate) * step_s


def _greatest_pull(scene: Scene) -> float:
    """A bound, m/s², on what weight and table together can do."""
    shake = scene.shake
    return scene.gravity_m_s2 + shake.x.peak_m_s2 + shake.y.peak_m_s2 + shake.z.peak_m_s2


def _free_of_halt(stepper: Stepper, record: Record, row: Row, pull: float, kinetic: float) -> int:
    """Number of whole steps in which the pedestal cannot come to a halt: 0 when it is about to, at most `MOST_FREE`.

    `pull` bounds its deceleration, `kinetic` is kinetic friction's, m/s².
    """
    step_s, before = stepper.schedule.step_s, record.flat[-2 * len(row) + 20 : -2 * len(row) + 22]
    vx, vy = row[20] - stepper.table_rate[0], row[21] - stepper.table_rate[1]
    speed = math.hypot(vx, vy)
    if speed <= LEAST_SHARE * kinetic * step_s:
        return RESTING_FREE
    last_s = min(record.t_s[-1] - record.t_s[-2], step_s)
    ax = (vx - before[0] + stepper.table_before[0]) / last_s
    ay = (vy - before[1] + stepper.table_before[1]) / last_s
    slowing = -(vx * ax + vy * ay) / speed
    if slowing > LEAST_SHARE * kinetic and speed <= AHEAD * step_s * slowing:
        return 0
    return min(max(int(speed / (pull * step_s) - AHEAD), 1), MOST_FREE)


def _free_steps(row: Row, zx: float, zy: float, step_s: float, bound: float) -> int:
    """Number of whole steps in which no edge of the base can come down: 0 when one is about to, at most `MOST_FREE`."""
    wx, wy = row[10], row[11]
    lean, rate = math.hypot(zx, zy), math.hypot(wx, wy)
    if rate <= LEAST_RATE_RAD_S and lean <= LEAST_LEAN_RAD:
        return RESTING_FREE
    reach = AHEAD * step_s
    if zx * wy < 0.0 and abs(wy) > LEAST_RATE_RAD_S and abs(zx) <= abs(wy) * reach:
        return 0
    if zy * wx > 0.0 and abs(wx) > LEAST_RATE_RAD_S and abs(zy) <= abs(wx) * reach:
        return 0
    # Time in which the greater lean could be undone, whatever pulls.
    soonest = (math.sqrt(rate * rate + 2.0 * bound * max(abs(zx), abs(zy))) - rate) / bound
    return min(max(int(soonest / step_s - AHEAD), 1), MOST_FREE)


class Still:
    """Counts the checks in a row at which nothing moved, from the step on from which the table is still."""

    def __init__(self, watch: Watch) -> None:
        self.watch, self.next, self.count = watch, watch.quiet_from, 0

    def lasts(self, number: int, row: Row, zx: float, zy: float) -> bool:
        """Whether everything has been still long enough."""
        if self.next is None or number < self.next:
            return False
        self.next = number + STILL_CHECK
        rest = self.watch.rest
        moving = row[7:13] if len(row) == 13 else row[7:13] + row[20:26]
        upright = max(abs(zx - rest[0]), abs(zy - rest[1])) < STILL_LEAN_RAD
        self.count = self.count + 1 if upright and max(map(abs, moving)) < STILL_M_S else 0
        return self.count >= STILL_CHECKS
