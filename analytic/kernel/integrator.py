"""The event-driven run: one Taylor step after another, each cut at its first event or at a break of the motion."""

from __future__ import annotations

import math
from typing import Final

from analytic.kernel.compiler import entry, inlined, jit
from analytic.kernel.dynamics import expand
from analytic.kernel.elementary import coarse_root
from analytic.kernel.energy import decide
from analytic.kernel.events import first_event
from analytic.kernel.forcing import break_at, is_jump, look_ahead
from analytic.kernel.joint_state import load
from analytic.kernel.landing import land
from analytic.kernel.layout import (
    ALONG_X,
    ALONG_Z,
    AT_LIMIT,
    AT_WALL,
    AX,
    BASE_X,
    BASE_Z,
    BEGIN,
    BREAK,
    CENTROID,
    COEFFICIENTS,
    DEGREE,
    DURATION,
    FACET_RAD,
    FINISH,
    FLIGHT,
    FRESH,
    GAVE_UP,
    GE,
    GRID_STEP,
    HALT,
    HISTORY,
    IMPACT,
    INVERSE,
    LIFT_OFF,
    LIMIT,
    LOADED,
    NO_EVENT,
    NO_SOLUTION,
    OM,
    ORDER,
    OUTCOME,
    OVER,
    OVERTURN_TIME,
    OVERTURNED_LEFT,
    OVERTURNED_RIGHT,
    PARADOX,
    PEAK,
    PEAK_SLIP,
    PIVOT,
    PX,
    RATE,
    RESIDUAL,
    RUNNING,
    S_OM,
    S_TH,
    S_V,
    SAMPLES,
    SEG,
    SKIP_ENERGY,
    SKIP_REST,
    SKIP_START,
    SLIDE,
    STALLED,
    STANDS,
    STEP_CAP,
    STEPS,
    TABLE,
    TANGENTS,
    TIME_SCALE,
    TIMES,
    TOLERANCE,
    TOUCHES_WALL,
    UNDECIDED,
    WANT_VALIDITY,
    Floats,
    Runs,
    T,
    Task,
)
from analytic.kernel.memory import peek
from analytic.kernel.polynomial import TANGENT_LEVEL
from analytic.kernel.quiet import quiet
from analytic.kernel.start import begin
from analytic.kernel.track import close, follow, record, settle
from analytic.kernel.validity import note_step

MAX_STALL: Final = 50
"""Events in a row without the clock moving, after which a run is given up as undecided."""
SHORTER: Final = 0.9
"""Share of the step at which the last two terms fall to the tolerance."""
MAX_STEPS: Final = 5_000_000
"""Steps after which a run is given up as undecided."""


@inlined
def _size(task: Task, k: int) -> float:
    """Size of the step's term k, rad s^-k."""
    w, p, time_s = task.w, task.p, task.p[TIME_SCALE]
    if task.q[PIVOT] < 0:
        return float(time_s * time_s * (abs(w[AX, k]) + abs(w[GE, k])) / p[CENTROID])
    slip = abs(w[RATE, k]) / p[CENTROID] if task.q[SLIDE] != 0 else 0.0
    return float(time_s * max(abs(w[OM, k]), slip))


@inlined
def _length(task: Task, n: int, h: float) -> float:
    """Step at which the last two terms fall below the tolerance, at most h (Jorba and Zou's rule)."""
    before, last = _size(task, n - 1), _size(task, n)
    tol, step = task.p[TOLERANCE], h / SHORTER
    if before > 0.0:
        step = min(step, coarse_root(tol / before, INVERSE[n - 1]))
    if last > 0.0 and last * step > before:  # else the last term is the smaller one there
        step = min(step, coarse_root(tol / last, INVERSE[n]))
    return min(h, SHORTER * step)


@inlined
def _expand_step(task: Task, h: float) -> tuple[int, float]:
    """Coefficients of the step that starts now: their order, and the length for which they hold, at most h."""
    q = task.q
    n = int(task.p[ORDER])
    load(task)
    if q[PIVOT] < 0 and max(q[DEGREE], q[DEGREE + 1]) <= 1:
        n = 3
    reached, h = expand(task, q[PIVOT], q[SLIDE], n, h)
    if reached == int(task.p[ORDER]):
        h = _length(task, reached, h)
    task.c[STEPS] += 1
    task.c[COEFFICIENTS] += reached
    return reached, h


@inlined
def _share(left: float, terms: float) -> float:
    """What an event's function has left, relative to its terms."""
    return abs(left) / terms if terms > 0.0 else 0.0


@jit
def _handle(task: Task, kind: int, side: int, residual: float) -> None:
    """What happens at an event; residual: as first_event gives it."""
    s, q, r = task.s, task.q, task.r
    if kind == IMPACT:
        angle = peek(task.address[FACET_RAD], side)
        residual = _share(s[S_TH] - angle, residual + abs(angle))
    elif kind == HALT:
        residual = _share(s[S_V], residual)
    r[RESIDUAL] = max(r[RESIDUAL], residual)
    if kind == IMPACT:
        land(task, side, residual)
    elif kind == HALT:
        before = s[S_V]
        s[S_V] = 0.0
        settle(task, kind, s[S_OM], before, q[PIVOT] < 0, 0.0, residual)
    elif kind == AT_LIMIT:
        r[OVERTURN_TIME] = s[T]
        q[OUTCOME] = OVERTURNED_RIGHT if side > 0 else OVERTURNED_LEFT
    elif kind == AT_WALL:
        q[OUTCOME] = TOUCHES_WALL
    elif kind == FLIGHT:
        q[OUTCOME] = LIFT_OFF
    elif kind == NO_SOLUTION:
        q[OUTCOME] = PARADOX
    else:
        settle(task, kind, s[S_OM], s[S_V], q[PIVOT] < 0, 0.0, residual)
    if kind in (AT_LIMIT, AT_WALL, FLIGHT, NO_SOLUTION):
        record(task, kind, s[S_OM], s[S_V], 0.0, 0, residual)


@inlined
def _pass_breaks(task: Task) -> bool:
    """Count the breaks reached; whether an acceleration may have jumped at one of them."""
    jump = False
    for axis in (ALONG_X, ALONG_Z):
        while break_at(task, axis) <= task.s[T]:
            task.q[SEG + axis] += 1
            jump = jump or is_jump(task, axis)
    task.q[LOADED] = 0
    look_ahead(task)
    return jump


@jit
def _finish(task: Task) -> None:
    """The ending of a run that reached its duration."""
    q, w = task.q, task.w
    q[OUTCOME] = STANDS
    if q[PIVOT] < 0:
        return
    if q[OVER] == 1 and decide(task):
        return
    load(task)
    expand(task, q[PIVOT], q[SLIDE], 1, math.inf)
    leans_right = q[PIVOT] == task.length[FACET_RAD] and w[PX, 0] > 0.0
    leans_left = q[PIVOT] == 0 and w[PX, 0] < 0.0
    if leans_right or leans_left:
        q[OUTCOME] = UNDECIDED


@jit
def _step(task: Task) -> None:
    """One step, cut at its first event."""
    s, q, p, c = task.s, task.q, task.p, task.c
    limit = s[LIMIT]
    room = limit - s[T]
    n, h = _expand_step(task, min(room, p[STEP_CAP]))
    x, kind, side, level, residual = first_event(task, n, h)
    if level >= TANGENT_LEVEL:
        c[TANGENTS] += 1
    tau = h if kind == NO_EVENT else x * h
    until = limit if kind == NO_EVENT and h == room else s[T] + tau
    follow(task, n, tau, until)
    if p[WANT_VALIDITY] > 0.0:
        note_step(task, n, tau)
    c[STALLED] = c[STALLED] + 1 if until <= s[T] else 0
    s[T] = until
    q[FRESH], q[LOADED] = 0, 0
    if kind != NO_EVENT:
        _handle(task, kind, side, residual)
    if q[OUTCOME] == RUNNING and s[T] >= limit and _pass_breaks(task):
        settle(task, BREAK, s[S_OM], s[S_V], q[PIVOT] < 0, 0.0, 0.0)
    if c[STALLED] > MAX_STALL or c[STEPS] > MAX_STEPS:
        q[OUTCOME] = UNDECIDED
        c[GAVE_UP] = 1


@jit
def _has_moved(task: Task) -> bool:
    """Whether the statue has rocked or the pedestal slid before."""
    return bool(task.r[PEAK] != 0.0 or task.r[PEAK_SLIP] > 0.0)


@jit
def run_one(task: Task) -> None:
    """Run from the start to an ending; everything is written into the task and the arrays whose addresses it holds."""
    s, q, p = task.s, task.q, task.p
    begin(task)
    _pass_breaks(task)
    settle(task, BEGIN, s[S_OM], s[S_V], q[PIVOT] < 0, 0.0, 0.0)
    while q[OUTCOME] == RUNNING:
        if q[PIVOT] < 0 and q[SLIDE] == 0 and p[SKIP_REST if _has_moved(task) else SKIP_START] > 0.0:
            quiet(task)
            look_ahead(task)
        if p[SKIP_ENERGY] > 0.0 and p[GRID_STEP] == 0.0 and q[OVER] == 1 and decide(task):
            return
        if s[T] < p[DURATION]:
            _step(task)
        if q[OUTCOME] == RUNNING and s[T] >= p[DURATION]:
            _finish(task)
            record(task, FINISH, s[S_OM], s[S_V], 0.0, 0, 0.0)


@entry
def run(
    runs: Runs,
    p: Floats,
    motion_x: Floats,
    motion_z: Floats,
    base_x: Floats,
    base_z: Floats,
    facets: Floats,
    times_x: Floats,
    times_z: Floats,
    samples_x: Floats,
    samples_z: Floats,
    history: Floats,
    events: Floats,
) -> None:
    """Pack the parameters, the two motions and where the caller's arrays stand into the one task of runs, and run it."""
    task = runs[0]
    task.p[:], task.f[ALONG_X, :], task.f[ALONG_Z, :] = p, motion_x, motion_z
    task.address[BASE_X], task.length[BASE_X] = base_x.ctypes.data, base_x.size
    task.address[BASE_Z], task.length[BASE_Z] = base_z.ctypes.data, base_z.size
    task.address[FACET_RAD], task.length[FACET_RAD] = facets.ctypes.data, facets.size
    task.address[TIMES], task.length[TIMES] = times_x.ctypes.data, times_x.size
    task.address[TIMES + 1], task.length[TIMES + 1] = times_z.ctypes.data, times_z.size
    task.address[SAMPLES], task.length[SAMPLES] = samples_x.ctypes.data, samples_x.size
    task.address[SAMPLES + 1], task.length[SAMPLES + 1] = samples_z.ctypes.data, samples_z.size
    task.address[HISTORY], task.length[HISTORY] = history.ctypes.data, max(history.shape[1] - 1, 0)
    task.address[TABLE], task.length[TABLE] = events.ctypes.data, events.shape[0]
    run_one(task)
    if p[GRID_STEP] > 0.0:
        close(task)
