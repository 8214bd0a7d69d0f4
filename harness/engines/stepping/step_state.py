"""One step after another: whole ones, and shorter ones around an event. Places and velocities keep clocks of their own.

A step changes velocities first and places after. It is therefore two numbers: how far the places go, and up to when the
velocities are taken (`kick_s`, the middle of a whole step). For an impact the velocities are brought to its instant, the places
to the contact, and the impact takes no time: the engine solves a step in which nothing pulls, and only its velocities are kept.
"""

from __future__ import annotations

import math
from array import array
from dataclasses import dataclass
from typing import Final, Protocol

from harness.engines.stepping.rows import Row, Vector, advanced, crossed
from harness.engines.stepping.step_log import StepLog
from harness.engines.stepping.stepper import AFTER_STEPS, IMPACT, STEP, Stepper

# When static friction gives way inside a step: the coefficient that acts over that step in the mean.


def coefficient(stepper: Stepper, record: StepLog, step_s: float) -> float:
    """Coefficient of a whole step after the last sample, in which the pedestal breaks loose: up to the instant the force that
    holds it, from there on kinetic friction's, both over the normal force.

    The instant is where that force, taken on as a straight line from the two steps before, passes the static limit: at most a
    step ago, as a step is held whose mean is below the limit, and what it was held by too long is taken back. Where these were
    not whole steps, or the floor's acceleration jumped in them, it is taken to be the middle. The static coefficient says that it
    comes after this step.
    """
    static, kinetic, kicks = stepper.static, stepper.kinetic, record.kick_s
    short = len(kicks) < 3 or min(kicks[-1] - kicks[-2], kicks[-2] - kicks[-3]) < stepper.events.whole * step_s
    if short or stepper.schedule.jump_after_s(kicks[-3]) <= kicks[-1]:
        return 0.5 * (static + kinetic)
    before, last = (_held(stepper, record, index) for index in (-2, -1))
    # Both forces are means over their steps: they belong to the middles, half of the two steps apart.
    slope = (last - before) / (0.5 * (kicks[-1] - kicks[-3]))
    now = last + 0.5 * slope * (kicks[-1] - kicks[-2])
    if now + slope * step_s < static:
        return static
    hold_s = max((static - now) / slope, -step_s) if slope > 0.0 else 0.0
    return max((hold_s * (now + 0.5 * slope * hold_s) + (step_s - hold_s) * kinetic) / step_s, 0.0)


def _held(stepper: Stepper, record: StepLog, index: int) -> float:
    """Friction over normal force that would have held the pedestal in the step that ended at a sample.

    Near the limit it gives way a little, as its feet do not all bear the same: what its velocity gained is counted as held.
    """
    before, row = record.row(index - 1), record.row(index)
    pull = stepper.schedule.between(record.kick_s[index - 1], record.kick_s[index], 1.0)
    x, y, normal = stepper.friction(pull, before, row)
    if not stepper.schedule.moving:
        mass = sum(stepper.masses)
        x, y = x - mass * (row[20] - before[20]), y - mass * (row[21] - before[21])
    return math.hypot(x, y) / normal if normal > 0.0 else 0.0


NO_PULL: Final = (0.0, 0.0, 0.0)
LOOK_STEPS: Final = 16
"""Steps after which the bodies' contacts are looked at again."""


class ContactTime(Protocol):
    """When a foot comes down (`contact_time.ContactTimeEstimate`)."""

    def __call__(self) -> float:
        """Time, s, until it is down."""

    def speeds(self) -> tuple[float, float]:
        """That time at its present speed, and its speed when it is down over the present one."""


@dataclass(slots=True)
class HalfCycle:
    """A half-cycle since the impact at `start_s` that left a foot rising: the length of its parts, s, and whether it is known
    yet.
    """

    contact_time: ContactTime
    start_s: float
    part_s: float
    known: bool = False
    parts: int = 0


class StepState:
    """The run in progress: `t_s` of places, `kick_s` of velocities, `number` of the last whole step reached, the present row.

    `even` says that both clocks stand as after a whole step, so that another one may follow; `velocity_jumped` that the last
    sample is an impact's, `velocity_jumps` how many there were since the last whole step, `jumped_s` when velocities last
    jumped; `pulled_s` when the floor's acceleration last did. `half_cycle` is the short half-cycle in progress, if any.
    """

    def __init__(self, stepper: Stepper, row: Row, start: int, kick_s: float, *, even: bool) -> None:
        self.stepper, self.schedule, self.events, self.row = stepper, stepper.schedule, stepper.events, row
        self.step_s, self.number = stepper.schedule.step_s, start
        self.t_s, self.kick_s = start * self.step_s, kick_s
        self.length_s, self.even = self.step_s, even
        self.record = StepLog(len(row), [self.t_s], [kick_s], array("d", row), stepper.writer.ledger)
        self.velocity_jumped, self.jumped_s, self.velocity_jumps, self.look_from = False, -math.inf, 0, start
        self.pulled_s = -math.inf
        self.half_cycle: HalfCycle | None = None

    @property
    def next_s(self) -> float:
        """The next whole step's time."""
        return (self.number + 1) * self.step_s

    @property
    def smooth(self) -> bool:
        """Whether what velocities changed by up to the last sample tells by what they go on to change."""
        return not self.velocity_jumped and self.kick_s != self.pulled_s

    @property
    def on_grid(self) -> bool:
        """Whether the places stand at a whole step."""
        return self.t_s == self.number * self.step_s

    def to(self, t_s: float, kick_s: float) -> Row:
        """One step of places to `t_s` and of velocities to `kick_s`."""
        length = t_s - self.t_s
        self._set(length)
        gravity = self.schedule.between(self.kick_s, kick_s, length)
        self.stepper.backend.prepare_step(self, kick_s, length)
        self.row = self.stepper.step(gravity, self.t_s, kick_s, length, self.row)
        self.t_s, self.kick_s, self.even, self.velocity_jumped = t_s, kick_s, False, False
        self.record.keep(t_s, kick_s, self.row)
        return self.row

    def kick(self, length_s: float, kick_s: float) -> None:
        """Velocities to `kick_s` by a step of the places over `length_s` that is no sample: their clock goes on by `length_s`."""
        self._set(length_s)
        gravity = self.schedule.between(self.kick_s, kick_s, length_s)
        self.stepper.backend.prepare_step(self, kick_s, length_s)
        self.row = self.stepper.step(gravity, self.t_s, kick_s, length_s, self.row)
        self.t_s, self.kick_s, self.even = self.t_s + length_s, kick_s, False

    def drift(self, seconds: float) -> None:
        """Places go on, or back, with the present velocities, by no step of the engine's."""
        self._write("part_of_step", advanced(self.row, seconds))
        self.t_s += seconds

    def turn(self, seconds: float, foot_m: Vector) -> None:
        """Turn the statue's velocity about a standing foot, `foot_m` from its centroid, as a body that stands there goes on
        turning: (ω × r)' = ω × (ω × r), r from the foot to the centroid, whether the foot slides or not.
        """
        row, spin = self.row, self.row[10:13]
        a, b, c = crossed(spin, crossed(spin, foot_m))
        self.stepper.writer.ledger.of("turn_on").explain(math.hypot(*spin), math.hypot(*foot_m), self.step_s)
        turned = (row[7] - seconds * a, row[8] - seconds * b, row[9] - seconds * c)
        self._write("turn_on", (*row[:7], *turned, *row[10:]))

    def impact(self) -> None:
        """An impact here and now: everything that touches meets at once, and nothing else moves."""
        length = self.events.together * self.step_s
        self._set(length)
        self.stepper.backend.prepare_step(self, self.kick_s, length)
        after = self.stepper.step(NO_PULL, self.t_s, self.kick_s, length, self.row)
        before, stepper = self.row, self.stepper
        impulses = stepper.backend.impulses(before)
        # Only the velocities are kept.
        row = (*before[:7], *after[7:13], *before[13:20], *after[20:26])
        stepper.writer.write(IMPACT, after, row)
        for written in (row, stepper.backend.read()):
            stepper.balance.add(IMPACT, before, written, impulses, NO_PULL)
        self.jump_velocity(row)

    def jump_velocity(self, row: Row) -> None:
        """A sample with other velocities at this instant."""
        shortest = self.events.shortest * self.step_s
        self.row, self.even, self.velocity_jumped = row, False, True
        self.velocity_jumps += 1
        self.t_s = self.kick_s = max(self.t_s, self.record.t_s[-1] + shortest)
        if self.next_s - self.t_s < shortest:
            self.drift(self.next_s - self.t_s)
            self.t_s = self.next_s
            self.number += 1
        self.jumped_s = self.t_s
        self.record.keep(self.t_s, self.kick_s, self.row)

    def to_next(self, kick_s: float | None = None) -> None:
        """To the next whole step, velocities to the middle of the way or to `kick_s`."""
        end = self.next_s
        on_grid = kick_s is None and self.on_grid
        self.to(end, max(0.5 * (self.t_s + end), self.kick_s) if kick_s is None else kick_s)
        self.number += 1
        self.even, self.velocity_jumps = on_grid, 0

    def whole_steps(self, pulls: list[Vector]) -> None:
        """Whole steps, one for each gravity or up to where a vertex comes near.

        One in which static friction gives way acts with the coefficient of its mean.
        """
        self._set(self.step_s)
        self.velocity_jumped, self.velocity_jumps = False, 0
        stepper, record, step_s, before = self.stepper, self.record, self.step_s, self.row
        if stepper.runs:
            stepper.backend.prepare_step(self, (self.number + 0.5) * step_s, step_s)
            self.row = stepper.backend.run(pulls, record)
            record.whole_steps(self.number + 1, len(record.flat) // record.width - len(record.t_s), step_s)
        else:
            for number, gravity in enumerate(pulls, self.number + 1):
                stepper.backend.prepare_step(self, (number - 0.5) * step_s, step_s)
                row = stepper.step(gravity, (number - 1) * step_s, (number - 0.5) * step_s, step_s, self.row)
                if stepper.just_slipped:
                    row = stepper.redo_sliding(coefficient(stepper, record, step_s), gravity, self.row)
                self.row, self.t_s, self.kick_s = row, number * step_s, (number - 0.5) * step_s
                record.keep(self.t_s, self.kick_s, row)
                if stepper.backend.near:
                    break
        made = round(record.t_s[-1] / step_s) - self.number
        self.number += made
        if made > 1 and self.number >= stepper.balance.next:
            # Before anything is looked at: that may make contacts anew.
            self._weigh()
        if self.number >= self.look_from:
            self.look_from = self.number + LOOK_STEPS
            stepper.look(pulls[:made], before, self.row)
        self.t_s, self.kick_s = record.t_s[-1], record.kick_s[-1]

    def _weigh(self) -> None:
        """Hold the last of several whole steps against the balance of momentum."""
        balance, backend, record = self.stepper.balance, self.stepper.backend, self.record
        balance.next = self.number + AFTER_STEPS
        before, (owed_x, owed_z) = record.row(-2), backend.owed_m_s
        begun = (*before[:7], before[7] - owed_x, before[8], before[9] - owed_z, *before[10:])
        pull_m_s = balance.pull_m_s(record.kick_s[-2], record.kick_s[-1])
        balance.add(STEP, begun, self.row, backend.impulses(before), pull_m_s)

    def rest(self, count: int) -> None:
        """So many whole steps in which nothing can move: samples as they are, without velocities, and no step of the engine's."""
        row, record = self.row, self.record
        self.row = (*row[:7], *NO_PULL, *NO_PULL, *row[13:20], *(0.0 for _ in row[20:]))
        record.flat.frombytes(count * record.pack(*self.row))
        record.whole_steps(self.number + 1, count, self.step_s)
        record.at_rest += count
        self.number += count
        self.t_s, self.kick_s = record.t_s[-1], record.kick_s[-1]
        self.velocity_jumped, self.velocity_jumps, self.half_cycle = False, 0, None

    def bring(self, instant_s: float) -> None:
        """Velocities to an instant within the next step at which forces jump: the middle of a step of the places, where these
        leave room for it.
        """
        shortest = self.events.least_rest * self.step_s
        end = self.t_s + max(2.0 * (instant_s - self.t_s), shortest)
        if end <= self.next_s - shortest:
            self.to(end, instant_s)
            return
        begin = min(2.0 * instant_s - self.next_s, self.next_s - shortest)
        if begin >= self.t_s + shortest:
            self.to(begin, max(0.5 * (self.t_s + begin), self.kick_s))
        self.to_next(instant_s)

    def meet_jump(self, instant_s: float) -> None:
        """Velocities to an instant at which the floor's acceleration jumps: what it then pulls at is no step's mean."""
        self.bring(instant_s)
        self.pulled_s, self.half_cycle = self.kick_s, None

    def lower(self, gap_m: float) -> None:
        """Take back what the standing foot has drifted off its support, as a step too short would not close the gap."""
        if gap_m == 0.0:
            return
        place = self.row[2] - gap_m
        self._write("hold", (*self.row[:2], place, *self.row[3:]))

    def _write(self, kind: str, row: Row) -> None:
        self.stepper.writer.write(kind, self.row, row)
        self.row = row

    def _set(self, length_s: float) -> None:
        if length_s != self.length_s:
            self.stepper.backend.set_length(length_s)
            self.length_s = length_s
