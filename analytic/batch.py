"""Many runs in one compiled call, none of which keeps a history."""

from __future__ import annotations

import numpy as np

from analytic._jit import jit
from analytic.borrowed import borrow
from analytic.kernel import run_borrowed
from analytic.layout import (
    MAX_ORDER,
    N_COUNT,
    N_DISCRETE,
    N_EVENT,
    N_RESULT,
    N_ROWS,
    N_STATE,
    OUTCOME,
    Floats,
    Ints,
    T,
    Task,
)


@jit
def run_rows(
    p: Floats,
    x: Floats,
    z: Floats,
    facet_rad: Floats,
    fx: Floats,
    fz: Floats,
    tx: Floats,
    sx: Floats,
    tz: Floats,
    sz: Floats,
    start: int,
    stop: int,
    outcomes: Ints,
    ends: Floats,
    results: Floats,
    counts: Ints,
) -> None:
    """Run the rows start to stop − 1 of the parameters p, the base x, z, facet_rad and the motions fx, fz; records are shared."""
    w, s, r = np.zeros((N_ROWS, MAX_ORDER + 2)), np.zeros(N_STATE), np.zeros(N_RESULT)
    q, c = np.zeros(N_DISCRETE, dtype=np.int64), np.zeros(N_COUNT, dtype=np.int64)
    grid, events = np.zeros((0, 4)), np.zeros((0, N_EVENT))
    for i in range(start, stop):
        run_borrowed(
            Task(
                borrow(p)[i],
                borrow(x)[i],
                borrow(z)[i],
                borrow(facet_rad)[i],
                borrow(fx)[i],
                borrow(fz)[i],
                borrow(tx),
                borrow(sx),
                borrow(tz),
                borrow(sz),
                borrow(w),
                borrow(s),
                borrow(q),
                borrow(r),
                borrow(c),
                borrow(grid),
                borrow(events),
            )
        )
        outcomes[i], ends[i] = q[OUTCOME], s[T]
        results[i, :] = r
        counts[i, :] = c
