"""The door into compiled code: many runs one after another, or one; called by addresses (`analytic.machine_code`)."""

from __future__ import annotations

from collections.abc import Callable

from analytic.kernel.memory import row_at
from analytic.spatial.kernel.integrator import run_one
from analytic.spatial.kernel.records import MEMORY, RUN, Memory, Run

run_row: Callable[[int, int], Run] = row_at(RUN)
memory_row: Callable[[int, int], Memory] = row_at(MEMORY)


def run(runs: int, memories: int, start: int, stop: int) -> None:
    """Run the rows start to stop − 1 of the tables at these addresses; memories know the callers' arrays."""
    # One entry for one run and for many: another would be compiled from the first line to the last once more.
    for i in range(start, stop):
        run_one(run_row(runs, i), memory_row(memories, i))
