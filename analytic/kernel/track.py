"""What is kept of a run: output samples, peaks, the crossing of the balance point, and the table of events."""

from __future__ import annotations

from typing import Final

from analytic.kernel.compiler import inlined, jit
from analytic.kernel.joint_state import choose
from analytic.kernel.layout import (
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
    HISTORY,
    LIFT_OFF,
    N_EVENT,
    NO_RETURN,
    NO_SOLUTION,
    OM,
    OUTCOME,
    PEAK,
    PEAK_SLIP,
    PEAK_TIME,
    PIVOT,
    PX,
    PZ,
    RATE,
    S_OM,
    S_TH,
    S_U,
    S_V,
    SLIDE,
    SLIP,
    TABLE,
    TH,
    TIES,
    Floats,
    T,
    Task,
)
from analytic.kernel.memory import poke, set_term, term
from analytic.kernel.polynomial import first_root, value

SAME_INSTANT: Final = 1e-9
"""Share of the output step below which the last instant counts as the sample before it."""


@jit
def _crossing(task: Task, row: int, n: int, tau: float, sign: float) -> float:
    """Time within the step at which sign × row, positive at its start, reaches zero."""
    for k in range(n + 1):
        set_term(task.w, EVENT, k, sign * term(task.w, row, k))
    x, _, _ = first_root(task.w, EVENT, 0, n, tau)
    return min(x, 1.0) * tau


@inlined
def _peak(task: Task, theta: float, time: float) -> None:
    if abs(theta) > abs(task.r[PEAK]):
        task.r[PEAK], task.r[PEAK_TIME] = theta, time


@inlined
def _two(w: Floats, a: int, b: int, n: int, x: float) -> tuple[float, float]:
    """Values at x of the polynomials with coefficients w[a, 0..n] and w[b, 0..n], even and odd powers apart."""
    y, k = x * x, n
    even, odd, even1, odd1 = 0.0, 0.0, 0.0, 0.0
    if n % 2 == 0:
        even, even1, k = term(w, a, n), term(w, b, n), n - 1
    while k > 0:
        odd, odd1 = odd * y + term(w, a, k), odd1 * y + term(w, b, k)
        even, even1 = even * y + term(w, a, k - 1), even1 * y + term(w, b, k - 1)
        k -= 2
    return even + x * odd, even1 + x * odd1


@inlined
def _move(task: Task, n: int, tau: float) -> None:
    """Set what moves to the step's polynomials at tau."""
    s = task.s
    if task.q[PIVOT] >= 0:
        s[S_TH], s[S_OM] = _two(task.w, TH, OM, n, tau)
    if task.q[SLIDE] != 0:
        s[S_U], s[S_V] = _two(task.w, SLIP, RATE, n, tau)


@inlined
def sample(task: Task, i: int, time: float, theta: float, omega: float, slip: float, rate: float) -> None:
    """Write output sample i."""
    history, row = task.address[HISTORY], task.length[HISTORY] + 1
    poke(history, i, time)
    poke(history, i + row, theta)
    poke(history, i + 2 * row, omega)
    poke(history, i + 3 * row, slip)
    poke(history, i + 4 * row, rate)


@jit
def _fill(task: Task, n: int, until: float) -> None:
    """Write the output samples before until."""
    w, q, dt = task.w, task.q, task.p[GRID_STEP]
    while q[GRID] < task.length[HISTORY] and q[GRID] * dt < until:
        time = q[GRID] * dt
        at = max(time - task.s[T], 0.0)
        slip, rate = task.s[S_U], 0.0
        if q[SLIDE] != 0:
            slip, rate = value(w, SLIP, n, at), value(w, RATE, n, at)
        sample(task, q[GRID], time, value(w, TH, n, at), value(w, OM, n, at), slip, rate)
        q[GRID] += 1


@jit
def close(task: Task) -> None:
    """Write the last instant after the output samples, or over the last of them if that is as late."""
    s, q, dt = task.s, task.q, task.p[GRID_STEP]
    if q[GRID] > 0 and s[T] - (q[GRID] - 1) * dt <= SAME_INSTANT * dt:
        q[GRID] -= 1
    sample(task, q[GRID], s[T], s[S_TH], s[S_OM], s[S_U], s[S_V])
    q[GRID] += 1


@inlined
def _note_balance(task: Task, n: int, tau: float) -> None:
    """Note when the centroid passes over the corner rocked about: the last time before a fall is that of no return."""
    w = task.w
    start, turned = w[PX, 0], abs(task.s[S_TH] - w[TH, 0])
    side = 1.0 if start > 0.0 else -1.0
    # the centroid moves on a circle: no further than the turn times its radius
    if start != 0.0 and abs(start) <= (abs(start) + abs(w[PZ, 0])) * turned and side * value(w, PX, n, tau) <= 0.0:
        task.r[NO_RETURN] = task.s[T] + _crossing(task, PX, n, tau, side)


@inlined
def follow(task: Task, n: int, tau: float, until: float) -> None:
    """Move the state to the end of a step of length tau, at until, and keep what is wanted of it; the clock stays."""
    w, s, q, r = task.w, task.s, task.q, task.r
    if task.p[GRID_STEP] > 0.0:
        _fill(task, n, until)
    _move(task, n, tau)
    r[PEAK_SLIP] = max(r[PEAK_SLIP], abs(s[S_U]))
    if q[PIVOT] < 0:
        return
    theta, omega = s[S_TH], s[S_OM]
    reach = max(abs(w[TH, 0]), abs(theta)) + tau * max(abs(w[OM, 0]), abs(omega))
    if w[OM, 0] * omega < 0.0 and reach > abs(r[PEAK]):
        at = _crossing(task, OM, n, tau, 1.0 if w[OM, 0] > 0.0 else -1.0)
        _peak(task, value(w, TH, n, at), s[T] + at)
    _peak(task, theta, until)
    _note_balance(task, n, tau)


@jit
def record(task: Task, kind: int, omega: float, rate: float, energy: float, tied: int, residual: float) -> None:
    """Write one row of the event table, if it still has room: omega and rate are those before the event."""
    s, q, i = task.s, task.q, task.c[EVENTS]
    task.c[EVENTS] += 1
    if i >= task.length[TABLE]:
        return
    table, i = task.address[TABLE], i * N_EVENT
    poke(table, i + E_TIME, s[T])
    poke(table, i + E_KIND, float(kind))
    poke(table, i + E_PIVOT, float(q[PIVOT]))
    poke(table, i + E_FACET, float(q[FACET]))
    poke(table, i + E_SLIDE, float(q[SLIDE]))
    poke(table, i + E_THETA, s[S_TH])
    poke(table, i + E_OMEGA_BEFORE, omega)
    poke(table, i + E_OMEGA_AFTER, s[S_OM])
    poke(table, i + E_SLIP, s[S_U])
    poke(table, i + E_RATE_BEFORE, rate)
    poke(table, i + E_RATE_AFTER, s[S_V])
    poke(table, i + E_ENERGY, energy)
    poke(table, i + E_TIED, float(tied))
    poke(table, i + E_RESIDUAL, residual)


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
