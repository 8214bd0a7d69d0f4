"""What is kept of a run: output samples, peaks, the crossing of the balance point, and the table of events."""

from __future__ import annotations

from analytic._jit import jit
from analytic.layout import (
    BREAK,
    E_ENERGY,
    E_FACET,
    E_KIND,
    E_OMEGA_AFTER,
    E_OMEGA_BEFORE,
    E_PIVOT,
    E_RATE_AFTER,
    E_RATE_BEFORE,
    E_RESIDUAL,
    E_SLIDE,
    E_SLIP,
    E_THETA,
    E_TIED,
    E_TIME,
    EVENT,
    EVENTS,
    FACET,
    FLIGHT,
    FRESH,
    GRID,
    GRID_STEP,
    HAS_BASE,
    LIFT_OFF,
    NO_RETURN,
    NO_SOLUTION,
    OM,
    OUTCOME,
    PEAK,
    PEAK_SLIP,
    PEAK_TIME,
    PIVOT,
    PX,
    RATE,
    S_OM,
    S_TH,
    S_U,
    S_V,
    SLIDE,
    SLIP,
    TH,
    TIES,
    T,
    Task,
)
from analytic.polynomial import first_root, value
from analytic.states import choose


@jit
def _crossing(task: Task, row: int, n: int, tau: float, sign: float) -> float:
    """Time within the step at which sign × row, positive at its start, reaches zero."""
    w, power = task.w, 1.0
    for k in range(n + 1):
        w[EVENT, k] = sign * w[row, k] * power
        power *= tau
    x, _ = first_root(w, EVENT, 0, n)
    return min(x, 1.0) * tau


@jit
def _peak(task: Task, theta: float, time: float) -> None:
    if abs(theta) > abs(task.r[PEAK]):
        task.r[PEAK], task.r[PEAK_TIME] = theta, time


@jit
def follow(task: Task, n: int, tau: float, until: float) -> None:
    """Keep what is wanted of a step of length tau that ends at until."""
    w, s, q, r = task.w, task.s, task.q, task.r
    dt = task.p[GRID_STEP]
    if dt > 0.0:
        while q[GRID] < task.grid.shape[0] and q[GRID] * dt < until:
            at = max(q[GRID] * dt - s[T], 0.0)
            task.grid[q[GRID], 0], task.grid[q[GRID], 1] = value(w, TH, n, at), value(w, OM, n, at)
            task.grid[q[GRID], 2], task.grid[q[GRID], 3] = value(w, SLIP, n, at), value(w, RATE, n, at)
            q[GRID] += 1
    r[PEAK_SLIP] = max(r[PEAK_SLIP], abs(value(w, SLIP, n, tau)))
    if q[PIVOT] < 0:
        return
    omega, theta = value(w, OM, n, tau), value(w, TH, n, tau)
    reach = max(abs(w[TH, 0]), abs(theta)) + tau * max(abs(w[OM, 0]), abs(omega))
    if w[OM, 0] * omega < 0.0 and reach > abs(r[PEAK]):
        at = _crossing(task, OM, n, tau, 1.0 if w[OM, 0] > 0.0 else -1.0)
        _peak(task, value(w, TH, n, at), s[T] + at)
    _peak(task, theta, until)
    side = 1 if q[PIVOT] == task.x.size - 1 else (-1 if q[PIVOT] == 0 else 0)
    if side != 0 and w[PX, 0] * side < 0.0 and value(w, PX, n, tau) * side >= 0.0:
        r[NO_RETURN] = s[T] + _crossing(task, PX, n, tau, -side)


@jit
def record(task: Task, kind: int, omega: float, rate: float, energy: float, tied: int, residual: float) -> None:
    """Write one row of the event table, if it still has room: omega and rate are those before the event."""
    s, q, i = task.s, task.q, task.c[EVENTS]
    task.c[EVENTS] += 1
    if i >= task.events.shape[0]:
        return
    row = task.events[i]
    row[E_TIME], row[E_KIND], row[E_PIVOT], row[E_FACET], row[E_SLIDE] = s[T], kind, q[PIVOT], q[FACET], q[SLIDE]
    row[E_THETA], row[E_OMEGA_BEFORE], row[E_OMEGA_AFTER] = s[S_TH], omega, s[S_OM]
    row[E_SLIP], row[E_RATE_BEFORE], row[E_RATE_AFTER] = s[S_U], rate, s[S_V]
    row[E_ENERGY], row[E_TIED], row[E_RESIDUAL] = energy, tied, residual


@jit
def settle(task: Task, kind: int, omega: float, rate: float, rock_free: bool, energy: float, residual: float) -> None:
    """Choose the joint state after an event or a jump, and record it; omega and rate are those before."""
    s, q = task.s, task.q
    pivot, slide, tied = q[PIVOT], q[SLIDE], 0
    slide_free = task.p[HAS_BASE] > 0.0 and s[S_V] == 0.0
    q[FRESH] = 1
    if not slide_free and task.p[HAS_BASE] > 0.0:
        q[SLIDE] = 1 if s[S_V] > 0.0 else -1
    if rock_free or slide_free:
        tied, ending = choose(task, rock_free)
        task.c[TIES] += 1 if tied > 1 else 0
        if ending != 0:
            q[OUTCOME] = ending
            record(task, kind, omega, rate, energy, tied, residual)
            kind = FLIGHT if ending == LIFT_OFF else NO_SOLUTION
    if kind != BREAK or pivot != q[PIVOT] or slide != q[SLIDE]:
        record(task, kind, omega, rate, energy, tied, residual)
