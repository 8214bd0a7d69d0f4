"""The first event of a step: each joint state owns its functions, positive while it lasts (docs/model.md, section 2)."""

from __future__ import annotations

import math

from analytic.kernel.compiler import inlined, jit
from analytic.kernel.joint_state import falling, lift_margin, omega_zeros, rate_zeros, stick_margin
from analytic.kernel.layout import (
    AT_LIMIT,
    AT_WALL,
    BASE_MASS,
    DEGREE,
    DET,
    DYNAMIC,
    EVENT,
    FACET_RAD,
    FLIGHT,
    FLOOR,
    FRESH,
    GE,
    HALT,
    HAS_BASE,
    IMPACT,
    MASS,
    MU_KINETIC,
    MU_STATIC,
    NO_EVENT,
    NO_SOLUTION,
    NORMAL,
    OM,
    OVERTURN,
    PIVOT,
    PIVOT_V,
    PX,
    PZ,
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
from analytic.kernel.memory import peek, set_term, term
from analytic.kernel.polynomial import NO_ROOT, first_root, leading, remainder

Found = tuple[float, int, int, int, float]
"""Fraction of the step, kind, side, depth of the search, and the residual relative to the function's terms; of an impact or a
halt these terms themselves: its residual is what the state has left that is moved there anyway."""

Rests = tuple[float, float, float, float]
"""How far the terms from the second on can carry θ, V, N, and F (stuck) or u̇ (sliding)."""


@inlined
def _search(task: Task, n: int, h: float, lo: int, kind: int, side: int, best: Found) -> Found:
    """The earlier of best and the first root of the function in the EVENT row, of which lo leading terms are zero."""
    x, level, terms = first_root(task.w, EVENT, lo, n, h)
    if x >= best[0]:
        return best[0], best[1], best[2], max(best[3], level), best[4]
    residual = terms
    if kind != IMPACT and kind != HALT:
        residual = remainder(task.w, EVENT, n, x) / terms if terms > 0.0 else 0.0
    return x, kind, side, max(best[3], level), residual


@inlined
def _level(task: Task, row: int, n: int, sign: float, level: float) -> None:
    """EVENT = sign (row − level)."""
    w = task.w
    w[EVENT, 0] = sign * (w[row, 0] - level)
    for k in range(1, n + 1):
        set_term(w, EVENT, k, sign * term(w, row, k))


@inlined
def _clear(task: Task, row: int, h: float, sign: float, level: float, rest: float) -> bool:
    """Whether sign (row − level) certainly stays positive, its terms from the second on summing up to rest at most."""
    start, first = sign * (task.w[row, 0] - level), sign * task.w[row, 1] * h
    return bool(start + min(first, 0.0) > rest)


@inlined
def _rests(task: Task, n: int, h: float) -> Rests:
    w = task.w
    row = FLOOR if task.q[SLIDE] == 0 else RATE
    theta, pivot, third, theta1, pivot1, third1 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for column in (n, n + 1):  # pairs of terms, without an odd one out
        set_term(w, PIVOT_V, column, 0.0)
        set_term(w, FLOOR, column, 0.0)
    set_term(w, TH, n + 1, 0.0)
    set_term(w, RATE, n + 1, 0.0)
    k, power, square = 2, h * h, h * h
    while k <= n:
        power1 = power * h
        theta, theta1 = theta + abs(term(w, TH, k)) * power, theta1 + abs(term(w, TH, k + 1)) * power1
        pivot, pivot1 = pivot + abs(term(w, PIVOT_V, k)) * power, pivot1 + abs(term(w, PIVOT_V, k + 1)) * power1
        third, third1 = third + abs(term(w, row, k)) * power, third1 + abs(term(w, row, k + 1)) * power1
        power *= square
        k += 2
    theta, pivot, third, normal = theta + theta1, pivot + pivot1, third + third1, pivot + pivot1
    if task.q[DEGREE + 1] > 1:  # else N has no other terms than V from the second on
        normal, power = 0.0, h
        for k in range(2, n):
            power *= h
            normal += abs(term(w, NORMAL, k)) * power
    return theta, pivot, normal, third


@inlined
def _rotation(task: Task, n: int, h: float, rest: float, best: Found) -> Found:
    """Impact on the facets at either side of the pivot, and the overturning limit."""
    pivot, w, last = task.q[PIVOT], task.w, task.length[FACET_RAD]
    for side in (-1, 1):
        j = pivot if side > 0 else pivot - 1
        if 0 <= j < last:
            angle = peek(task.address[FACET_RAD], j)
            if _clear(task, TH, h, -side, angle, rest):
                continue
            _level(task, TH, n, -side, angle)
            lo = 0
            if w[EVENT, 0] == 0.0:
                lo = 1 if w[OM, 0] != 0.0 else 1 + omega_zeros(task, n)
            best = _search(task, n, h, lo, IMPACT, j, best)
        elif not _clear(task, TH, h, -side, side * task.p[OVERTURN], rest):
            _level(task, TH, n, -side, side * task.p[OVERTURN])
            best = _search(task, n, h, 0, AT_LIMIT, side, best)
    return best


@inlined
def _solvable(task: Task, n: int) -> bool:
    """Whether the sliding system's determinant is positive at any rotation; if not, EVENT is written with its terms."""
    w, p = task.w, task.p
    kappa, pull = task.q[SLIDE] * p[MU_KINETIC] * p[DYNAMIC], p[MASS] * p[MASS] / (p[MASS] + p[BASE_MASS])
    x, z = w[PX, 0], w[PZ, 0]
    own = w[DET, 0] + pull * z * (z - kappa * x)
    if own > pull * (x * x + z * z) * math.sqrt(1.0 + kappa * kappa):
        return True
    for i in range(n):
        total = 0.0
        for k in range(i + 1):
            total += w[PZ, k] * (w[PZ, i - k] - kappa * w[PX, i - k])
        w[EVENT, i] = -(pull * total)
    w[EVENT, 0] = w[DET, 0]
    return False


@inlined
def _contact(task: Task, n: int, h: float, rests: Rests, best: Found) -> Found:
    """Loss of contact and the friction paradox; a statue that already falls may leave its corner without ending the run."""
    q = task.q
    if q[PIVOT] < 0:
        if task.q[DEGREE + 1] > 0 or task.w[GE, 0] <= 0.0:
            _level(task, GE, n, 1.0, 0.0)
            return _search(task, n, h, 0, FLIGHT, 0, best)
        return best
    if not _clear(task, PIVOT_V, h, 1.0, 0.0, rests[1]) and not falling(task):
        _level(task, PIVOT_V, n - 1, 1.0, 0.0)
        best = _search(task, n - 1, h, 0, FLIGHT, 0, best)
    if task.p[HAS_BASE] > 0.0 and not _clear(task, NORMAL, h, 1.0, 0.0, rests[2]):
        _level(task, NORMAL, n - 1, 1.0, 0.0)
        best = _search(task, n - 1, h, 0, FLIGHT, 1, best)
    if q[SLIDE] != 0 and not _solvable(task, n):
        best = _search(task, n - 1, h, 0, NO_SOLUTION, 0, best)
    return best


@inlined
def _uplift(task: Task, n: int, h: float, best: Found) -> Found:
    """Uplift of the resting statue to either side."""
    for side in (1, -1):
        scale = lift_margin(task, side, n - 1)
        lo = leading(task.w, EVENT, n - 1, scale, task.p[TIME_SCALE]) if task.q[FRESH] == 1 else 0
        best = _search(task, n - 1, h, lo, UPLIFT, side, best)
    return best


@inlined
def _friction(task: Task, n: int, h: float, rests: Rests, best: Found) -> Found:
    """Start of the stuck pedestal to either side, or halt of the sliding one."""
    q, w, p = task.q, task.w, task.p
    if q[SLIDE] != 0:
        if not _clear(task, RATE, h, q[SLIDE], 0.0, rests[3]):
            lo = rate_zeros(task, n) if w[RATE, 0] == 0.0 else 0
            _level(task, RATE, n, q[SLIDE], 0.0)
            best = _search(task, n, h, lo, HALT, q[SLIDE], best)
        return best
    rest = math.inf if p[DYNAMIC] == 0.0 or q[PIVOT] < 0 else p[MU_STATIC] * rests[2] + rests[3]
    held, change = p[MU_STATIC] * w[NORMAL, 0], p[MU_STATIC] * w[NORMAL, 1]
    for side in (1, -1):
        if held + side * w[FLOOR, 0] + min(h * (change + side * w[FLOOR, 1]), 0.0) > rest:
            continue
        scale = stick_margin(task, side, n - 1)
        lo = leading(w, EVENT, n - 1, scale, p[TIME_SCALE]) if q[FRESH] == 1 else 0
        best = _search(task, n - 1, h, lo, SLIP_EVENT, side, best)
    return best


@jit
def first_event(task: Task, n: int, h: float) -> Found:
    """The first event within the step of length h whose coefficients stand in the workspace."""
    q = task.q
    best = (NO_ROOT, NO_EVENT, 0, 0, 0.0)
    rests = (0.0, 0.0, 0.0, 0.0)
    if q[PIVOT] < 0:
        best = _uplift(task, n, h, best)
    else:
        rests = _rests(task, n, h)
        best = _rotation(task, n, h, rests[0], best)
    if task.p[HAS_BASE] > 0.0:
        if q[PIVOT] < 0 and q[SLIDE] != 0:
            rests = (0.0, 0.0, 0.0, math.inf)
        best = _friction(task, n, h, rests, best)
    best = _contact(task, n, h, rests, best)
    side = int(task.p[WALL_SIDE])
    if side != 0 and q[PIVOT] >= 0 and not _clear(task, TH, h, -side, side * task.p[WALL_ROTATION], rests[0]):
        _level(task, TH, n, -side, side * task.p[WALL_ROTATION])
        best = _search(task, n, h, 0, AT_WALL, side, best)
    return best
