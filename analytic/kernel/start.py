"""The first instant of a run (docs/model.md, section 2)."""

from __future__ import annotations

import math

from analytic.kernel.compiler import jit
from analytic.kernel.forcing import prepare
from analytic.kernel.layout import (
    ALONG_X,
    ALONG_Z,
    AX,
    FACET,
    FACET_RAD,
    GE,
    LEAST_N,
    LEAST_V,
    LEFT_TIME,
    NO_RETURN,
    OMEGA0,
    OUTCOME_MARGIN,
    OVERTURN_TIME,
    PEAK,
    PIVOT,
    S_OM,
    S_TH,
    THETA0,
    TIP_MARGIN,
    TIP_MARGIN_IMPACT,
    Task,
)
from analytic.kernel.memory import peek


@jit
def _support(task: Task, theta: float, omega: float) -> tuple[int, int]:
    """Pivot (−1 on a facet at rest) and facet of a statue that starts at theta with omega."""
    last = task.length[FACET_RAD]
    pivot = 0
    for j in range(last):
        angle = peek(task.address[FACET_RAD], j)
        if theta == angle:
            if omega == 0.0:
                return -1, j
            return (j + 1 if omega > 0.0 else j), j
        if theta > angle:
            pivot = j + 1
    return pivot, min(pivot, last - 1)


@jit
def begin(task: Task) -> None:
    """Clear the results and set the initial state: u = u' = 0, side = sgn θ, else sgn θ'."""
    p, s, q, r = task.p, task.s, task.q, task.r
    s[:], r[:] = 0.0, 0.0
    q[:], task.c[:] = 0, 0
    task.w[AX, :], task.w[GE, :] = 0.0, 0.0
    prepare(task, ALONG_X)
    prepare(task, ALONG_Z)
    s[S_TH], s[S_OM] = p[THETA0], p[OMEGA0]
    q[PIVOT], q[FACET] = _support(task, p[THETA0], p[OMEGA0])
    r[PEAK] = p[THETA0]
    r[LEAST_V], r[LEAST_N], r[OUTCOME_MARGIN] = math.inf, math.inf, math.inf
    r[TIP_MARGIN], r[TIP_MARGIN_IMPACT] = math.inf, math.inf
    r[OVERTURN_TIME], r[NO_RETURN], r[LEFT_TIME] = math.nan, math.nan, math.nan
