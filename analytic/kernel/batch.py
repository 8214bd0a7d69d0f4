"""Many runs in one compiled call, none of which keeps a history."""

from __future__ import annotations

from analytic.kernel.compiler import entry
from analytic.kernel.integrator import run_one
from analytic.kernel.layout import N_MEMORY, OUTCOME, Floats, Ints, Runs, T


@entry
def run_rows(
    runs: Runs,
    p: Floats,
    f: Floats,
    address: Ints,
    stride: Ints,
    length: Ints,
    start: int,
    stop: int,
    outcomes: Ints,
    ends: Floats,
    results: Floats,
    counts: Ints,
) -> None:
    """Run the rows start to stop − 1 of the parameters p and the motions f in the one task of runs.

    Row i's arrays stand at address + i stride, and have length items.
    """
    task = runs[0]
    for i in range(start, stop):
        task.p[:], task.f[:, :] = p[i], f[i]
        for k in range(N_MEMORY):
            task.address[k], task.length[k] = address[k] + i * stride[k], length[k]
        run_one(task)
        outcomes[i], ends[i] = task.q[OUTCOME], task.s[T]
        results[i, :] = task.r
        counts[i, :] = task.c
