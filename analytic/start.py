"""The first instant of a run (docs/model.md, section 2)."""

from __future__ import annotations

import math

from analytic._jit import jit
from analytic.layout import (
    FACET,
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


@jit
def _support(task: Task, theta: float, omega: float) -> tuple[int, int]:
    """Pivot (−1 on a facet at rest) and facet of a statue that starts at theta with omega."""
    last = task.x.size - 1
    pivot = 0
    for j in range(last):
        angle = task.facet_rad[j]
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
    for values in (task.s, task.r):
        values[:] = 0.0
    for counts in (task.q, task.c):
        counts[:] = 0
    p, s, q, r = task.p, task.s, task.q, task.r
    s[S_TH], s[S_OM] = p[THETA0], p[OMEGA0]
    q[PIVOT], q[FACET] = _support(task, p[THETA0], p[OMEGA0])
    r[PEAK] = p[THETA0]
    for i in (LEAST_V, LEAST_N, TIP_MARGIN, TIP_MARGIN_IMPACT, OUTCOME_MARGIN):
        r[i] = math.inf
    for i in (OVERTURN_TIME, NO_RETURN, LEFT_TIME):
        r[i] = math.nan
