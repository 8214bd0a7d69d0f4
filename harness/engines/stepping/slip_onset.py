"""When static friction gives way inside a step: the coefficient that acts over that step in the mean."""

from __future__ import annotations

import math

from harness.engines.stepping.step_log import StepLog
from harness.engines.stepping.stepper import Stepper


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
