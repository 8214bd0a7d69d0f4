"""The event-driven run: one Taylor step after another, each cut at its first event or at a break of the motion; its entries."""

import math
from typing import Any, Final, NamedTuple

import numpy as np

from analytic.kernel.compiler import cell_at, inlined, jit, load_double, set_term, term
from analytic.kernel.dynamics import (
    corner,
    expand,
    falling,
    lift_margin,
    slip_rate_zeros,
    start_series,
    stick_margin,
    theta_rate_zeros,
    vertex,
)
from analytic.kernel.energy import decide, skip_quiet
from analytic.kernel.forcing import is_jump, look_ahead, next_break_s, prepare
from analytic.kernel.impact import land
from analytic.kernel.polynomial import NO_ROOT, TANGENT_LEVEL, coarse_root, first_root, leading, value
from analytic.kernel.records import (
    AT_LIMIT,
    AT_WALL,
    BASE,
    BEGIN,
    BREAK,
    COUNTS,
    FINISH,
    FRICTION_PARADOX,
    IMPACT,
    INVERSE,
    LIFT_OFF,
    LOST_CONTACT,
    MOTION_PARAMS,
    NO_EVENT,
    NO_SOLUTION,
    OVERTURNED_LEFT,
    OVERTURNED_RIGHT,
    PARAMS,
    RESULTS,
    RUNNING,
    SLIP_ONSET,
    STANDS,
    STATE,
    STICK_ONSET,
    TABLES,
    TASK,
    TOUCHES_WALL,
    UNDECIDED,
    UPLIFT,
    Base,
    Counts,
    Floats,
    MotionParams,
    Params,
    Results,
    State,
    Task,
    row,
)
from analytic.kernel.track import advance, change_state, note_event, note_step, sample_end

# The first event of a step: each joint state owns its functions, positive while it lasts (docs/model.md, section 2).


class FirstEvent(NamedTuple):
    """The earliest event so far.

    residual: the event function's remainder relative to its terms; of an impact or a stick onset these terms themselves: what is
    left there is what the state has left that is moved to zero anyway.
    """

    fraction: float
    """Of the step; NO_ROOT without an event."""
    kind: int
    side: int
    """1 right, −1 left; of an impact the facet."""
    level: int
    """Depth of the search."""
    residual: float


class Bounds(NamedTuple):
    """How far the terms from the second on can carry a series within the step."""

    theta: float
    pivot_normal: float
    floor_normal: float
    friction: float
    """Of F while the pedestal is stuck, of u̇ while it slides."""


@inlined
def _share(left: float, terms: float) -> float:
    """What an event's function has left, relative to its terms."""
    return abs(left) / terms if terms > 0.0 else 0.0


@inlined
def _search(task: Task, n: int, h: float, lo: int, kind: int, side: int, best: FirstEvent) -> FirstEvent:
    """The earlier of best and the first root of the event function, of which lo leading terms are zero."""
    x, level, terms = first_root(task.series.event, lo, n, h)
    level = max(best.level, level)
    if x >= best.fraction:
        return FirstEvent(best.fraction, best.kind, best.side, level, best.residual)
    if kind != IMPACT and kind != STICK_ONSET:
        terms = _share(value(task.series.event, n, x), terms)
    return FirstEvent(x, kind, side, level, terms)


@inlined
def _seek(
    task: Task,
    row: Floats,
    n: int,
    sign: float,
    level: float,
    h: float,
    lo: int,
    kind: int,
    side: int,
    best: FirstEvent,
) -> FirstEvent:
    """The earlier of best and the first root of sign (row − level), of which lo leading terms are zero."""
    event = task.series.event
    event[0] = sign * (row[0] - level)
    for k in range(1, n + 1):
        set_term(event, k, sign * term(row, k))
    return _search(task, n, h, lo, kind, side, best)


@inlined
def _clear(row: Floats, h: float, sign: float, level: float, rest: float) -> bool:
    """Whether sign (row − level) certainly stays positive, its terms from the second on summing up to rest at most."""
    return bool(sign * (row[0] - level) + min(sign * row[1] * h, 0.0) > rest)


@inlined
def _bounds(task: Task, n: int, h: float) -> Bounds:
    """Bounds of a step of length h, by the sums of the terms' absolute values: most event functions are cleared by them, without
    a search for a root."""
    series = task.series
    theta, normal = series.theta, series.pivot_normal
    friction = series.floor_force if task.state.slide == 0 else series.slip_rate
    for k in (n, n + 1):  # pairs of terms, without an odd one out
        set_term(series.pivot_normal, k, 0.0)
        set_term(series.floor_force, k, 0.0)
    set_term(series.theta, n + 1, 0.0)
    set_term(series.slip_rate, n + 1, 0.0)
    a, b, c, a1, b1, c1 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    k, power, square = 2, h * h, h * h
    while k <= n:
        power1 = power * h
        a, a1 = a + abs(term(theta, k)) * power, a1 + abs(term(theta, k + 1)) * power1
        b, b1 = b + abs(term(normal, k)) * power, b1 + abs(term(normal, k + 1)) * power1
        c, c1 = c + abs(term(friction, k)) * power, c1 + abs(term(friction, k + 1)) * power1
        power *= square
        k += 2
    of_floor = b + b1
    if task.motion_z.degree > 1:  # else N has no other terms than V from the second on
        of_floor, power = 0.0, h
        for k in range(2, n):
            power *= h
            of_floor += abs(term(series.floor_normal, k)) * power
    return Bounds(a + a1, b + b1, of_floor, c + c1)


@inlined
def _rotation(task: Task, n: int, h: float, rest: float, best: FirstEvent) -> FirstEvent:
    """Impact on the facets at either side of the pivot, and the overturning limit."""
    pivot, series, last, limit = task.state.pivot, task.series, task.base.n_facets, task.params.overturn_rad
    for side in (-1, 1):
        j = pivot if side > 0 else pivot - 1
        if 0 <= j < last:
            angle = load_double(task.base.facets, j)
            if _clear(series.theta, h, -side, angle, rest):
                continue
            lo = 0
            if series.theta[0] == angle:
                lo = 1 if series.theta_rate[0] != 0.0 else 1 + theta_rate_zeros(task, n)
            best = _seek(task, series.theta, n, -side, angle, h, lo, IMPACT, j, best)
        elif not _clear(series.theta, h, -side, side * limit, rest):
            best = _seek(task, series.theta, n, -side, side * limit, h, 0, AT_LIMIT, side, best)
    return best


@inlined
def _solvable(task: Task, n: int) -> bool:
    """Whether the sliding system's determinant is positive at any rotation; if not, EVENT is written with its terms."""
    series, params = task.series, task.params
    kappa = task.state.slide * params.floor_kinetic if params.dynamic_normal else 0.0
    pull = params.mass_kg * params.mass_kg / (params.mass_kg + params.pedestal_mass_kg)
    x, z = series.pivot_x[0], series.pivot_z[0]
    own = series.determinant + pull * z * (z - kappa * x)
    if own > pull * (x * x + z * z) * math.sqrt(1.0 + kappa * kappa):
        return True
    for i in range(n):
        total = 0.0
        for k in range(i + 1):
            total += series.pivot_z[k] * (series.pivot_z[i - k] - kappa * series.pivot_x[i - k])
        series.event[i] = -(pull * total)
    series.event[0] = series.determinant
    return False


@inlined
def _contact(task: Task, n: int, h: float, bounds: Bounds, best: FirstEvent) -> FirstEvent:
    """Loss of contact and the friction paradox; a statue that already falls may leave its corner without ending the run."""
    state, series = task.state, task.series
    if state.pivot < 0:
        if task.motion_z.degree > 0 or series.gravity[0] <= 0.0:
            return _seek(task, series.gravity, n, 1.0, 0.0, h, 0, LOST_CONTACT, 0, best)
        return best
    if not _clear(series.pivot_normal, h, 1.0, 0.0, bounds.pivot_normal) and not falling(task):
        best = _seek(task, series.pivot_normal, n - 1, 1.0, 0.0, h, 0, LOST_CONTACT, 0, best)
    if task.params.has_pedestal and not _clear(series.floor_normal, h, 1.0, 0.0, bounds.floor_normal):
        best = _seek(task, series.floor_normal, n - 1, 1.0, 0.0, h, 0, LOST_CONTACT, 1, best)
    if state.slide != 0 and not _solvable(task, n):
        best = _search(task, n - 1, h, 0, NO_SOLUTION, 0, best)
    return best


@inlined
def _uplift(task: Task, n: int, h: float, best: FirstEvent) -> FirstEvent:
    """Uplift of the resting statue to either side."""
    for side in (1, -1):
        scale = lift_margin(task, side, n - 1)
        lo = leading(task.series.event, n - 1, scale, task.params.time_scale_s) if task.state.fresh else 0
        best = _search(task, n - 1, h, lo, UPLIFT, side, best)
    return best


@inlined
def _friction(task: Task, n: int, h: float, bounds: Bounds, best: FirstEvent) -> FirstEvent:
    """Slip onset of the stuck pedestal to either side, or stick onset of the sliding one."""
    state, series, params = task.state, task.series, task.params
    if state.slide != 0:
        if not _clear(series.slip_rate, h, state.slide, 0.0, bounds.friction):
            lo = slip_rate_zeros(task, state.pivot, n) if series.slip_rate[0] == 0.0 else 0
            best = _seek(task, series.slip_rate, n, state.slide, 0.0, h, lo, STICK_ONSET, state.slide, best)
        return best
    rest = (
        math.inf
        if not params.dynamic_normal or state.pivot < 0
        else params.floor_static * bounds.floor_normal + bounds.friction
    )
    held, change = params.floor_static * series.floor_normal[0], params.floor_static * series.floor_normal[1]
    for side in (1, -1):
        if held + side * series.floor_force[0] + min(h * (change + side * series.floor_force[1]), 0.0) > rest:
            continue
        scale = stick_margin(task, side, n - 1)
        lo = leading(series.event, n - 1, scale, params.time_scale_s) if state.fresh else 0
        best = _search(task, n - 1, h, lo, SLIP_ONSET, side, best)
    return best


@inlined
def _carried(row: Floats, n: int, h: float) -> float:
    """Bound of what the terms from the first power on carry a series by within the step."""
    total, power = 0.0, 1.0
    for k in range(1, n + 1):
        power *= h
        total += abs(term(row, k)) * power
    return total


@jit
def _wall(task: Task, n: int, h: float, turning: float, best: FirstEvent) -> FirstEvent:
    """Contact of the pedestal's side, or of a point of the statue's outline, with the wall.

    turning bounds the terms of θ from the second on.
    """
    state, series, params, base = task.state, task.series, task.params, task.base
    side, slides, rocks = params.wall_side, state.slide != 0, state.pivot >= 0
    turned = abs(series.theta_rate[0]) * h + turning if rocks else 0.0
    slid = _carried(series.slip, n, h) if slides else 0.0
    if slides and side * series.slip[0] + slid >= params.wall_pedestal_m:
        best = _seek(task, series.slip, n, -side, side * params.wall_pedestal_m, h, 0, AT_WALL, side, best)
    pivot = state.pivot if rocks else state.facet
    x, z = vertex(task, pivot)
    pivot_x, pivot_z = series.pivot_x[0], series.pivot_z[0]
    if not rocks:
        pivot_x, pivot_z, _ = corner(task, state.facet, -1)
    radius2 = x * x + z * z
    room = params.wall_m - side * (load_double(base.stands, pivot) + series.slip[0])
    for i in range(base.n_outline):
        # a point p, q from the centroid turns with it: p cos θ + q sin θ is a sum of X and Z
        p, q = load_double(base.outline_x, i), load_double(base.outline_z, i) - params.centroid_height_m
        by_x, by_z = side * (1.0 + (q * z - p * x) / radius2), side * ((p * z + q * x) / radius2)
        gap = room - (by_x * pivot_x + by_z * pivot_z)
        if gap > params.wall_lever_m * turned + slid:
            continue
        series.event[0] = gap
        for k in range(1, n + 1):
            moved = side * term(series.slip, k) if slides else 0.0
            if rocks:
                moved += by_x * term(series.pivot_x, k) + by_z * term(series.pivot_z, k)
            set_term(series.event, k, -moved)
        best = _search(task, n, h, 0, AT_WALL, side, best)
    return best


@jit
def first_event(task: Task, n: int, h: float) -> FirstEvent:
    """The first event within the step of length h whose coefficients stand in the workspace."""
    state = task.state
    best = FirstEvent(NO_ROOT, NO_EVENT, 0, 0, 0.0)
    bounds = Bounds(0.0, 0.0, 0.0, 0.0)
    if state.pivot < 0:
        best = _uplift(task, n, h, best)
    else:
        bounds = _bounds(task, n, h)
        best = _rotation(task, n, h, bounds.theta, best)
    if task.params.has_pedestal:
        if state.pivot < 0 and state.slide != 0:
            bounds = Bounds(0.0, 0.0, 0.0, math.inf)  # no bound of u̇ was summed up: it is searched
        best = _friction(task, n, h, bounds, best)
    best = _contact(task, n, h, bounds, best)
    if task.params.wall_side != 0 and (state.pivot >= 0 or state.slide != 0):
        best = _wall(task, n, h, bounds.theta, best)
    return best


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


ENDINGS: Final = (OVERTURNED_RIGHT, TOUCHES_WALL, LIFT_OFF, FRICTION_PARADOX)
"""Outcomes of the events from `AT_LIMIT` to `NO_SOLUTION`; to the left another one overturns."""


@jit
def _handle(task: Task, kind: int, side: int, residual: float) -> None:
    """What happens at an event; residual: as first_event gives it."""
    state, results = task.state, task.results
    if kind == IMPACT:
        angle = load_double(task.base.facets, side)
        residual = _share(state.theta_rad - angle, residual + abs(angle))
    elif kind == STICK_ONSET:
        residual = _share(state.slip_rate_m_s, residual)
    results.event_residual = max(results.event_residual, residual)
    if kind == IMPACT:
        land(task, side, residual)
    elif kind == STICK_ONSET:
        before = state.slip_rate_m_s
        state.slip_rate_m_s = 0.0
        change_state(task, kind, state.theta_rate_rad_s, before, state.pivot < 0, 0.0, residual)
    elif kind < AT_LIMIT:
        change_state(task, kind, state.theta_rate_rad_s, state.slip_rate_m_s, state.pivot < 0, 0.0, residual)
    else:
        state.outcome = ENDINGS[kind - AT_LIMIT]
        if kind == AT_LIMIT:
            results.overturn_time_s = state.time_s
            state.outcome = state.outcome if side > 0 else OVERTURNED_LEFT
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
    state.outcome = STANDS
    if state.pivot < 0:
        return
    state.followed = 0  # the last time to ask
    if state.motions_over and decide(task):
        return
    start_series(task)
    expand(task, state.pivot, state.slide, 1, math.inf)
    if (state.pivot == task.base.n_facets and series.pivot_x[0] > 0.0) or (
        state.pivot == 0 and series.pivot_x[0] < 0.0
    ):
        state.outcome = UNDECIDED


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
    tau = h if kind == NO_EVENT else first.fraction * h
    until = limit if kind == NO_EVENT and h == room else state.time_s + tau
    advance(task, n, tau, until)
    if params.keep_validity:
        note_step(task, n, tau)
    counts.stalled = counts.stalled + 1 if until <= state.time_s else 0
    state.time_s = until
    state.fresh, state.floor_loaded = False, False
    if kind != NO_EVENT:
        _handle(task, kind, first.side, first.residual)
    if state.outcome == RUNNING and state.time_s >= limit and _pass_breaks(task):
        change_state(task, BREAK, state.theta_rate_rad_s, state.slip_rate_m_s, state.pivot < 0, 0.0, 0.0)
    if counts.stalled > MAX_STALL or counts.steps > MAX_STEPS:
        state.outcome = UNDECIDED
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
    change_state(task, BEGIN, state.theta_rate_rad_s, state.slip_rate_m_s, state.pivot < 0, 0.0, 0.0)
    while state.outcome == RUNNING:
        if state.pivot < 0 and state.slide == 0 and (params.skip_rest if _has_moved(task) else params.skip_start):
            skip_quiet(task)
            look_ahead(task)
        if params.skip_energy and params.output_step_s == 0.0 and state.motions_over and decide(task):
            return
        if state.time_s < params.duration_s:
            _step(task)
        if state.outcome == RUNNING and state.time_s >= params.duration_s:
            _finish(task)
            note_event(task, FINISH, state.theta_rate_rad_s, state.slip_rate_m_s, 0.0, 0, 0.0)


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
