"""Whole steps of an engine as it comes: nothing is located, none is solved again, and no body is written to."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

from harness.engines.contact.friction import floor_friction, followed
from harness.engines.event_stepping.backend import Backend
from harness.engines.event_stepping.rows import ALONE, Row
from harness.engines.event_stepping.schedule import Schedule
from harness.engines.event_stepping.step_log import StepLog

LOOK_STEPS: Final = 64
"""Steps between two looks at whether the run can end: a statue that has fallen stays down."""


def plain_steps(
    backend: Backend, schedule: Schedule, ended: Callable[[float, Row], bool], *, lags: bool = True
) -> StepLog:
    """All steps of a schedule, or those up to a look at which the run has `ended`, asked with time and row.

    `lags`: velocities are half a step behind the places.

    Two coefficients of friction are the one thing that no engine knows: the floor's follows the pedestal's own velocity.
    """
    step_s, friction = schedule.step_s, floor_friction(schedule.scene, schedule.step_s)
    row, acting = backend.read(), friction.static
    switches = len(row) > ALONE and friction.switches
    record = StepLog(len(row))
    record.keep(0.0, 0.0, row)
    lag = 0.5 if lags else 0.0
    for number, gravity in enumerate(schedule.coarse if lags else schedule.level, 1):
        row = backend.advance(gravity)
        record.keep(number * step_s, (number - lag) * step_s, row)
        if switches:
            # Asked after a step, for the next: in the one in which the pedestal breaks loose the static coefficient still acts.
            wanted = followed(friction, math.hypot(row[20], row[21]))
            if wanted != acting:
                backend.set_floor_friction(wanted)
                acting = wanted
        if number % LOOK_STEPS == 0 and ended(number * step_s, row):
            break
    return record
