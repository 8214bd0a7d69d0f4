"""Whole steps of an unmodified engine: nothing is located, none is solved again, and no body is written to."""

from __future__ import annotations

import math

from harness.engines.base import MOVING_TABLE, refuse
from harness.engines.stepping.coulomb import followed, stuck_below_m_s
from harness.engines.stepping.frame import fallen
from harness.engines.stepping.loop import LOOK_STEPS, WALL_STEPS, Watch
from harness.engines.stepping.schedule import Schedule
from harness.engines.stepping.step_log import Row, StepLog, axis_of, base_velocity
from harness.engines.stepping.step_state import Backend
from harness.model.scene import Scene

# What a contact engine could compute only by writing to its bodies: unmodified engines refuse it.


def refuse_steering(scene: Scene, name: str) -> None:
    """Raise `EngineFailure`, in the name of the plain engine, for what can be had only by writing to bodies."""
    imposed = "a prescribed ratio at impact (contact.restitution; it would have to be imposed on the bodies)"
    asked = {
        # A body thrown in space bounces by the engine's own coefficient of restitution, without a write.
        imposed: scene.contact.restitution is not None and scene.initial.pose is None,
        MOVING_TABLE: scene.table == "moving",
    }
    refuse(name, asked, name.removesuffix(":plain"))


def plain_steps(backend: Backend, schedule: Schedule, watch: Watch) -> StepLog:
    """All steps of a schedule, or those up to a look at which `watch` ends the run: overturned, stopped, or to leave this world.

    Two coefficients of friction are the one thing that no engine knows: the floor's follows the pedestal's own velocity
    (`followed`).
    """
    step_s, contact = schedule.step_s, schedule.scene.contact
    rest_m_s = stuck_below_m_s(schedule.scene, step_s)
    row, acting, slips = backend.read(), contact.floor_static, (0.0, 0.0)
    pedestal = None if contact.floor_static == contact.floor_kinetic else schedule.scene.pedestal
    record = StepLog.begun(row, 0.0)
    for number, gravity in enumerate(schedule.coarse, 1):
        before, row = row, backend.advance(gravity)
        record.keep(number * step_s, (number - 0.5) * step_s, row)
        if pedestal is not None:
            # Asked after a step, for the next: in the one in which the pedestal breaks loose the static coefficient still acts.
            slipped, slips = slips, base_velocity(pedestal.half_m, before, row)
            wanted = followed(contact, rest_m_s, slipped, slips)
            if wanted != acting:
                backend.set_floor_friction(wanted)
                acting = wanted
        if number % LOOK_STEPS == 0 and _ended(schedule.scene, watch, number * step_s, row):
            break
        if watch.wall is not None and number % WALL_STEPS == 0 and watch.wall.ends(record):
            break
    return record


def _ended(scene: Scene, watch: Watch, t_s: float, row: Row) -> bool:
    x, y, z = axis_of(row, watch.axis)
    if watch.ends_fallen and scene.initial.pose is None and fallen(x, y, z):
        return True
    if watch.stop is not None and watch.stop(t_s, math.atan2(x, z)):
        return True
    return watch.leave is not None and watch.leave(row)
