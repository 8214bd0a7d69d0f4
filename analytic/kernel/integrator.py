"""The event-driven run: one Taylor step after another, each cut at its first event or at a break of the motion; its entries."""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np

from analytic.kernel import codes
from analytic.kernel.compiler import cell_at, inlined, jit, load_double
from analytic.kernel.dynamics import expand
from analytic.kernel.energy import decide, skip_quiet
from analytic.kernel.events import first_event
from analytic.kernel.forcing import is_jump, look_ahead, next_break_s, prepare
from analytic.kernel.impact import land
from analytic.kernel.joint_state import start_series
from analytic.kernel.polynomial import TANGENT_LEVEL, coarse_root
from analytic.kernel.records import (
    BASE,
    COUNTS,
    INVERSE,
    MOTION_PARAMS,
    PARAMS,
    RESULTS,
    STATE,
    TABLES,
    TASK,
    Base,
    Counts,
    MotionParams,
    Params,
    Results,
    State,
    Task,
    row,
)
from analytic.kernel.track import advance, change_state, note_event, note_step, sample_end

MAX_STALL: Final = 50
"""Events in a row without the clock moving, after which a run is given up as undecided: at one instant an impact, a stick onset
and a slip onset at either corner may follow each other, but not fifty."""
SHORTER: Final = 0.9
"""Share of the step at which the last two terms fall to the tolerance: a margin for the terms left out."""
MAX_STEPS: Final = 5_000_000
"""Steps after which a run is given up as undecided: hours of shaking at the finest accuracy."""

BLANK: Final = np.zeros(1, TASK)
"""A run before its start: the same memory serves many runs one after another."""
BLANK["results"] = row(Results())


@inlined
def _size(task: Task, k: int) -> float:
    """Size of the step's term k, rad s^-k."""
    series, params, time_s = task.series, task.params, task.params.time_scale_s
    if task.state.pivot < 0:
        return float(time_s * time_s * (abs(series.floor_accel[k]) + abs(series.gravity[k])) / params.centroid_height_m)
    slip = abs(series.slip_rate[k]) / params.centroid_height_m if task.state.slide != 0 else 0.0
    return float(time_s * max(abs(series.theta_rate[k]), slip))


@inlined
def _length(task: Task, n: int, h: float) -> float:
    """Step at which the last two terms fall below the tolerance, at most h (Jorba and Zou's rule)."""
    before, last = _size(task, n - 1), _size(task, n)
    tol, step = task.params.tolerance_rad, h / SHORTER
    if before > 0.0:
        step = min(step, coarse_root(tol / before, INVERSE[n - 1]))
    if last > 0.0 and last * step > before:  # else the last term is the smaller one there
        step = min(step, coarse_root(tol / last, INVERSE[n]))
    return min(h, SHORTER * step)


@inlined
def _expand_step(task: Task, h: float) -> tuple[int, float]:
    """Coefficients of the step that starts now: their order, and the length for which they hold, at most h."""
    state = task.state
    n = task.params.order
    start_series(task)
    if state.pivot < 0 and max(task.motion_x.degree, task.motion_z.degree) <= 1:
        n = 3  # the motion itself is a cubic then: no higher term is left
    reached, h = expand(task, state.pivot, state.slide, n, h)
    if reached == task.params.order:
        h = _length(task, reached, h)
    task.counts.steps += 1
    task.counts.coefficients += reached
    return reached, h


ENDINGS: Final = (codes.OVERTURNED_RIGHT, codes.TOUCHES_WALL, codes.LIFT_OFF, codes.FRICTION_PARADOX)
"""Outcomes of the events from `AT_LIMIT` to `NO_SOLUTION`; to the left another one overturns."""


@inlined
def _share(left: float, terms: float) -> float:
    """What an event's function has left, relative to its terms."""
    return abs(left) / terms if terms > 0.0 else 0.0


@jit
def _handle(task: Task, kind: int, side: int, residual: float) -> None:
    """What happens at an event; residual: as first_event gives it."""
    state, results = task.state, task.results
    if kind == codes.IMPACT:
        angle = load_double(task.base.facets, side)
        residual = _share(state.theta_rad - angle, residual + abs(angle))
    elif kind == codes.STICK_ONSET:
        residual = _share(state.slip_rate_m_s, residual)
    results.event_residual = max(results.event_residual, residual)
    if kind == codes.IMPACT:
        land(task, side, residual)
    elif kind == codes.STICK_ONSET:
        before = state.slip_rate_m_s
        state.slip_rate_m_s = 0.0
        change_state(task, kind, state.theta_rate_rad_s, before, state.pivot < 0, 0.0, residual)
    elif kind < codes.AT_LIMIT:
        change_state(task, kind, state.theta_rate_rad_s, state.slip_rate_m_s, state.pivot < 0, 0.0, residual)
    else:
        state.outcome = ENDINGS[kind - codes.AT_LIMIT]
        if kind == codes.AT_LIMIT:
            results.overturn_time_s = state.time_s
            state.outcome = state.outcome if side > 0 else codes.OVERTURNED_LEFT
        note_event(task, kind, state.theta_rate_rad_s, state.slip_rate_m_s, 0.0, 0, residual)


@jit
def _support(task: Task, theta: float, omega: float) -> tuple[int, int]:
    """Pivot (−1 on a facet at rest) and facet of a statue that starts at theta with omega."""
    last = task.base.n_facets
    pivot = 0
    for j in range(last):  # facets from left to right, their rotations growing: the pivot lies between two of them
        angle = load_double(task.base.facets, j)
        if theta == angle:
            if omega == 0.0:
                return -1, j
            return (j + 1 if omega > 0.0 else j), j
        if theta > angle:
            pivot = j + 1
    return pivot, min(pivot, last - 1)


@jit
def _begin(task: Task) -> None:
    """Clear the results and set the initial state: u = u' = 0, side = sgn θ, else sgn θ'."""
    task.state, task.results, task.counts = BLANK[0].state, BLANK[0].results, BLANK[0].counts
    task.series.floor_accel[:], task.series.gravity[:] = 0.0, 0.0
    prepare(task.motion_x)
    prepare(task.motion_z)
    state, results, params = task.state, task.results, task.params
    state.theta_rad, state.theta_rate_rad_s = params.theta0_rad, params.theta_rate0_rad_s
    state.pivot, state.facet = _support(task, params.theta0_rad, params.theta_rate0_rad_s)
    results.peak_theta_rad = params.theta0_rad


@inlined
def _pass_breaks(task: Task) -> bool:
    """Count the breaks reached; whether an acceleration may have jumped at one of them."""
    jump = False
    for motion in (task.motion_x, task.motion_z):
        while next_break_s(motion) <= task.state.time_s:
            motion.breaks_passed += 1
            jump = jump or is_jump(motion)
    task.state.floor_loaded = False
    look_ahead(task)
    return jump


@jit
def _finish(task: Task) -> None:
    """The ending of a run that reached its duration."""
    state, series = task.state, task.series
    state.outcome = codes.STANDS
    if state.pivot < 0:
        return
    state.followed = 0  # the last time to ask
    if state.motions_over and decide(task):
        return
    start_series(task)
    expand(task, state.pivot, state.slide, 1, math.inf)
    leans_right = state.pivot == task.base.n_facets and series.pivot_x[0] > 0.0
    leans_left = state.pivot == 0 and series.pivot_x[0] < 0.0
    if leans_right or leans_left:
        state.outcome = codes.UNDECIDED


@jit
def _step(task: Task) -> None:
    """One step, cut at its first event."""
    state, params, counts = task.state, task.params, task.counts
    limit = state.limit_s
    room = limit - state.time_s
    n, h = _expand_step(task, min(room, params.step_cap_s))
    first = first_event(task, n, h)
    kind = first.kind
    if first.level >= TANGENT_LEVEL:
        counts.tangents += 1
    tau = h if kind == codes.NO_EVENT else first.fraction * h
    until = limit if kind == codes.NO_EVENT and h == room else state.time_s + tau
    advance(task, n, tau, until)
    if params.keep_validity:
        note_step(task, n, tau)
    counts.stalled = counts.stalled + 1 if until <= state.time_s else 0
    state.time_s = until
    state.fresh, state.floor_loaded = False, False
    if kind != codes.NO_EVENT:
        _handle(task, kind, first.side, first.residual)
    if state.outcome == codes.RUNNING and state.time_s >= limit and _pass_breaks(task):
        change_state(task, codes.BREAK, state.theta_rate_rad_s, state.slip_rate_m_s, state.pivot < 0, 0.0, 0.0)
    if counts.stalled > MAX_STALL or counts.steps > MAX_STEPS:
        state.outcome = codes.UNDECIDED
        counts.given_up = 1


@jit
def _has_moved(task: Task) -> bool:
    """Whether the statue has rocked or the pedestal slid before."""
    return task.results.peak_theta_rad != 0.0 or task.results.peak_slip_m > 0.0


@jit
def run_one(task: Task) -> None:
    """Run from the start to an ending; everything is written into the task and the arrays whose addresses it holds."""
    state, params = task.state, task.params
    _begin(task)
    _pass_breaks(task)
    change_state(task, codes.BEGIN, state.theta_rate_rad_s, state.slip_rate_m_s, state.pivot < 0, 0.0, 0.0)
    while state.outcome == codes.RUNNING:
        if state.pivot < 0 and state.slide == 0 and (params.skip_rest if _has_moved(task) else params.skip_start):
            skip_quiet(task)
            look_ahead(task)
        if params.skip_energy and params.output_step_s == 0.0 and state.motions_over and decide(task):
            return
        if state.time_s < params.duration_s:
            _step(task)
        if state.outcome == codes.RUNNING and state.time_s >= params.duration_s:
            _finish(task)
            note_event(task, codes.FINISH, state.theta_rate_rad_s, state.slip_rate_m_s, 0.0, 0, 0.0)


# The door into compiled code: many runs one after another, or one; called by addresses
# (`analytic.machine_code`).


task_cell: Final = cell_at(TASK, Task)
params_cell: Final = cell_at(PARAMS, Params)
motion_cell: Final = cell_at(MOTION_PARAMS, MotionParams)
base_cell: Final = cell_at(BASE, Base)
state_cell: Final = cell_at(STATE, State)
results_cell: Final = cell_at(RESULTS, Results)
counts_cell: Final = cell_at(COUNTS, Counts)
tables_cell: Final[Any] = cell_at(TABLES, np.void)


def run(task_at: int, tables_at: int) -> None:
    """Run rows of tables in the memory of one task, whose address is given as that of the tables' own (`records.TABLES`) is.

    Without tables (0) the task is run as it stands, history and events included.
    """
    task, tables = task_cell(task_at, 0).item, tables_cell(tables_at, 0).item
    many = tables_at != 0
    start, stop = (tables.start, tables.stop) if many else (0, 1)
    for i in range(start, stop):
        # One entry for both: another would be compiled from the first line to the last once more.
        if many:
            task.params, task.base = params_cell(tables.params, i).item, base_cell(tables.bases, i).item
            task.motion_x.params = motion_cell(tables.motion_x, i).item
            task.motion_z.params = motion_cell(tables.motion_z, i).item
        run_one(task)
        if task.params.output_step_s > 0.0:
            sample_end(task)
        if many:
            state_cell(tables.states, i).item = task.state
            results_cell(tables.results, i).item = task.results
            counts_cell(tables.counts, i).item = task.counts
