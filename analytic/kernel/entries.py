"""The two doors into compiled code: one run, and many one after another; the interpreter writes the tasks by name."""

from __future__ import annotations

from analytic.kernel.compiler import entry
from analytic.kernel.integrator import run_one
from analytic.kernel.records import Floats, Records
from analytic.kernel.track import sample_end


@entry
def run(
    tasks: Records,
    base_x: Floats,
    base_z: Floats,
    facets_rad: Floats,
    times_x: Floats,
    times_z: Floats,
    samples_x: Floats,
    samples_z: Floats,
    history: Floats,
    events: Records,
) -> None:
    """Run the one task, whose parameters are set, with the caller's arrays: base, records, output."""
    task = tasks[0]
    # Addresses, not arrays: an array in a record would have the length with which it was laid out (memory.py).
    task.base.x, task.base.z, task.base.facets = base_x.ctypes.data, base_z.ctypes.data, facets_rad.ctypes.data
    task.base.n_facets = facets_rad.size
    x, z, output = task.motion_x.params, task.motion_z.params, task.output
    x.times, x.samples, x.n_samples = times_x.ctypes.data, samples_x.ctypes.data, times_x.size
    z.times, z.samples, z.n_samples = times_z.ctypes.data, samples_z.ctypes.data, times_z.size
    output.history, output.n_samples = history.ctypes.data, max(history.shape[1] - 1, 0)
    output.events, output.n_events = events.ctypes.data, events.shape[0]
    run_one(task)
    if task.params.output_step_s > 0.0:
        sample_end(task)


@entry
def run_rows(
    tasks: Records,
    params: Records,
    motion_x: Records,
    motion_z: Records,
    bases: Records,
    start: int,
    stop: int,
    states: Records,
    results: Records,
    counts: Records,
) -> None:
    """Run the rows start to stop − 1 in the memory of the one task, for their outcome; no history and no events are kept."""
    task = tasks[0]
    for i in range(start, stop):
        task.params, task.base = params[i], bases[i]
        task.motion_x.params, task.motion_z.params = motion_x[i], motion_z[i]
        run_one(task)
        states[i], results[i], counts[i] = task.state, task.results, task.counts
