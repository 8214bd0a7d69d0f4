"""The door into compiled code: many runs one after another, or one; called by addresses (`analytic.machine_code`)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from analytic.kernel.integrator import run_one
from analytic.kernel.layout import BASE, COUNTS, MOTION_PARAMS, PARAMS, RESULTS, STATE, TASK
from analytic.kernel.memory import row_at, set_row
from analytic.kernel.records import Base, Counts, MotionParams, Params, Results, State, Task
from analytic.kernel.track import sample_end

task_row: Final[Callable[[int, int], Task]] = row_at(TASK)
params_row: Final[Callable[[int, int], Params]] = row_at(PARAMS)
motion_row: Final[Callable[[int, int], MotionParams]] = row_at(MOTION_PARAMS)
base_row: Final[Callable[[int, int], Base]] = row_at(BASE)
state_row: Final[Callable[[int, int], State]] = row_at(STATE)
results_row: Final[Callable[[int, int], Results]] = row_at(RESULTS)
counts_row: Final[Callable[[int, int], Counts]] = row_at(COUNTS)


def run(
    task_at: int,
    params: int,
    motion_x: int,
    motion_z: int,
    bases: int,
    start: int,
    stop: int,
    states: int,
    results: int,
    counts: int,
) -> None:
    """Run the rows start to stop − 1 in the memory of one task, whose address is given as those of the tables are.

    Without tables (0) the task is run as it stands, history and events included.
    """
    task = task_row(task_at, 0)
    for i in range(start, stop):
        # One entry for both: another would be compiled from the first line to the last once more.
        if params != 0:
            task.params, task.base = params_row(params, i), base_row(bases, i)
            task.motion_x.params, task.motion_z.params = motion_row(motion_x, i), motion_row(motion_z, i)
        run_one(task)
        if task.params.output_step_s > 0.0:
            sample_end(task)
        if params != 0:
            set_row(state_row(states, i), task.state)
            set_row(results_row(results, i), task.results)
            set_row(counts_row(counts, i), task.counts)
