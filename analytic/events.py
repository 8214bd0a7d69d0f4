"""The first event of a step: each joint state owns its functions, positive while it lasts (docs/model.md, section 2)."""

from __future__ import annotations

from analytic._jit import jit
from analytic.layout import (
    AT_LIMIT,
    AT_WALL,
    DET,
    EVENT,
    FLIGHT,
    FRESH,
    GE,
    HALT,
    HAS_BASE,
    IMPACT,
    NO_EVENT,
    NO_SOLUTION,
    NORMAL,
    OM,
    OVERTURN,
    PIVOT,
    PIVOT_V,
    POWER,
    RATE,
    SLIDE,
    SLIP_EVENT,
    TH,
    TIME_SCALE,
    UPLIFT,
    WALL_ROTATION,
    WALL_SIDE,
    Task,
)
from analytic.polynomial import NO_ROOT, first_root, leading
from analytic.states import falling, lift_margin, omega_zeros, rate_zeros, stick_margin

Found = tuple[float, int, int, int, float]
"""Fraction of the step, kind, side, depth of the search, residual relative to the function's terms."""


@jit
def _search(task: Task, n: int, lo: int, kind: int, side: int, best: Found) -> Found:
    """The earlier of best and the first root of the function in the EVENT row, of which lo leading terms are zero."""
    w = task.w
    for k in range(n + 1):
        w[EVENT, k] *= w[POWER, k]
    x, level = first_root(w, EVENT, lo, n)
    if x >= best[0]:
        return best[0], best[1], best[2], max(best[3], level), best[4]
    terms, left = 0.0, 0.0
    for k in range(n, -1, -1):
        terms += abs(w[EVENT, k])
        left = left * x + w[EVENT, k]
    return x, kind, side, max(best[3], level), (abs(left) / terms if terms > 0.0 else 0.0)


@jit
def _level(task: Task, row: int, n: int, sign: float, level: float) -> None:
    """EVENT = sign (row − level)."""
    for k in range(n + 1):
        task.w[EVENT, k] = sign * task.w[row, k]
    task.w[EVENT, 0] = sign * (task.w[row, 0] - level)


@jit
def _rotation(task: Task, n: int, best: Found) -> Found:
    """Impact on the facets at either side of the pivot, and the overturning limit."""
    pivot, w = task.q[PIVOT], task.w
    last = task.x.size - 1
    for side in (-1, 1):
        j = pivot if side > 0 else pivot - 1
        if 0 <= j < last:
            _level(task, TH, n, -side, task.facet_rad[j])
            lo = 0
            if w[EVENT, 0] == 0.0:
                lo = 1 if w[OM, 0] != 0.0 else 1 + omega_zeros(task, n)
            best = _search(task, n, lo, IMPACT, j, best)
        else:
            _level(task, TH, n, -side, side * task.p[OVERTURN])
            best = _search(task, n, 0, AT_LIMIT, side, best)
    return best


@jit
def _contact(task: Task, n: int, best: Found) -> Found:
    """Loss of contact and the friction paradox; a statue that already falls may leave its corner without ending the run."""
    q = task.q
    if q[PIVOT] < 0:
        _level(task, GE, n, 1.0, 0.0)
        return _search(task, n, 0, FLIGHT, 0, best)
    if not falling(task):
        _level(task, PIVOT_V, n - 1, 1.0, 0.0)
        best = _search(task, n - 1, 0, FLIGHT, 0, best)
    if task.p[HAS_BASE] > 0.0:
        _level(task, NORMAL, n - 1, 1.0, 0.0)
        best = _search(task, n - 1, 0, FLIGHT, 1, best)
    if q[SLIDE] != 0:
        _level(task, DET, n - 1, 1.0, 0.0)
        best = _search(task, n - 1, 0, NO_SOLUTION, 0, best)
    return best


@jit
def first_event(task: Task, n: int) -> Found:
    """The first event within the step whose coefficients and powers of length stand in the workspace."""
    q, w = task.q, task.w
    best = (NO_ROOT, NO_EVENT, 0, 0, 0.0)
    fresh = q[FRESH] == 1
    time_s = task.p[TIME_SCALE]
    if q[PIVOT] < 0:
        for side in (1, -1):
            scale = lift_margin(task, side, n - 1)
            lo = leading(w, EVENT, n - 1, scale, time_s) if fresh else 0
            best = _search(task, n - 1, lo, UPLIFT, side, best)
    else:
        best = _rotation(task, n, best)
    if task.p[HAS_BASE] > 0.0:
        if q[SLIDE] == 0:
            for side in (1, -1):
                scale = stick_margin(task, side, n - 1)
                lo = leading(w, EVENT, n - 1, scale, time_s) if fresh else 0
                best = _search(task, n - 1, lo, SLIP_EVENT, side, best)
        else:
            lo = rate_zeros(task, n) if w[RATE, 0] == 0.0 else 0
            _level(task, RATE, n, q[SLIDE], 0.0)
            best = _search(task, n, lo, HALT, q[SLIDE], best)
    best = _contact(task, n, best)
    side = int(task.p[WALL_SIDE])
    if side != 0 and q[PIVOT] >= 0:
        _level(task, TH, n, -side, side * task.p[WALL_ROTATION])
        best = _search(task, n, 0, AT_WALL, side, best)
    return best
