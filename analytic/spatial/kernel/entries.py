"""The doors into compiled code: one run, and many one after another."""

from __future__ import annotations

from analytic.kernel.compiler import entry
from analytic.kernel.records import Floats, Records
from analytic.spatial.kernel.integrator import run_one


@entry
def run(
    runs: Records, memories: Records, times: Floats, samples: Floats, history: Floats, events: Floats, intervals: Floats
) -> None:
    """Run the one record in its memory, with the caller's arrays."""
    m = memories[0]
    # Addresses, not arrays: a record's layout must not depend on the length of a motion or a history.
    m.times, m.samples = times.ctypes.data, samples.ctypes.data
    m.history, m.instants = history.ctypes.data, history.shape[0]
    m.event_table, m.interval_table, m.rows = events.ctypes.data, intervals.ctypes.data, events.shape[0]
    run_one(runs[0], m)


@entry
def run_rows(runs: Records, memories: Records, start: int, stop: int) -> None:
    """Run the rows start to stop − 1, whose memories know the callers' arrays; no history and no events are kept."""
    for i in range(start, stop):
        run_one(runs[i], memories[i])
