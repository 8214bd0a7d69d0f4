"""The first event of a step: each joint state owns its functions, positive while it lasts (docs/model.md, section 2)."""

from __future__ import annotations

import math
from typing import NamedTuple

from analytic.kernel import codes
from analytic.kernel.compiler import inlined, jit, load_double, set_term, term
from analytic.kernel.dynamics import vertex
from analytic.kernel.joint_state import corner, falling, lift_margin, slip_rate_zeros, stick_margin, theta_rate_zeros
from analytic.kernel.polynomial import NO_ROOT, first_root, leading, value
from analytic.kernel.records import Floats, Task


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
def _search(task: Task, n: int, h: float, lo: int, kind: int, side: int, best: FirstEvent) -> FirstEvent:
    """The earlier of best and the first root of the event function, of which lo leading terms are zero."""
    x, level, terms = first_root(task.series.event, lo, n, h)
    level = max(best.level, level)
    if x >= best.fraction:
        return FirstEvent(best.fraction, best.kind, best.side, level, best.residual)
    residual = terms
    if kind != codes.IMPACT and kind != codes.STICK_ONSET:
        residual = abs(value(task.series.event, n, x)) / terms if terms > 0.0 else 0.0
    return FirstEvent(x, kind, side, level, residual)


@inlined
def _measure(task: Task, row: Floats, n: int, sign: float, level: float) -> None:
    """Make sign (row − level) the event function."""
    event = task.series.event
    event[0] = sign * (row[0] - level)
    for k in range(1, n + 1):
        set_term(event, k, sign * term(row, k))


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
    _measure(task, row, n, sign, level)
    return _search(task, n, h, lo, kind, side, best)


@inlined
def _clear(row: Floats, h: float, sign: float, level: float, rest: float) -> bool:
    """Whether sign (row − level) certainly stays positive, its terms from the second on summing up to rest at most."""
    start, first = sign * (row[0] - level), sign * row[1] * h
    return bool(start + min(first, 0.0) > rest)


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
            best = _seek(task, series.theta, n, -side, angle, h, lo, codes.IMPACT, j, best)
        elif not _clear(series.theta, h, -side, side * limit, rest):
            best = _seek(task, series.theta, n, -side, side * limit, h, 0, codes.AT_LIMIT, side, best)
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
            return _seek(task, series.gravity, n, 1.0, 0.0, h, 0, codes.LOST_CONTACT, 0, best)
        return best
    if not _clear(series.pivot_normal, h, 1.0, 0.0, bounds.pivot_normal) and not falling(task):
        best = _seek(task, series.pivot_normal, n - 1, 1.0, 0.0, h, 0, codes.LOST_CONTACT, 0, best)
    if task.params.has_pedestal and not _clear(series.floor_normal, h, 1.0, 0.0, bounds.floor_normal):
        best = _seek(task, series.floor_normal, n - 1, 1.0, 0.0, h, 0, codes.LOST_CONTACT, 1, best)
    if state.slide != 0 and not _solvable(task, n):
        best = _search(task, n - 1, h, 0, codes.NO_SOLUTION, 0, best)
    return best


@inlined
def _uplift(task: Task, n: int, h: float, best: FirstEvent) -> FirstEvent:
    """Uplift of the resting statue to either side."""
    for side in (1, -1):
        scale = lift_margin(task, side, n - 1)
        lo = leading(task.series.event, n - 1, scale, task.params.time_scale_s) if task.state.fresh else 0
        best = _search(task, n - 1, h, lo, codes.UPLIFT, side, best)
    return best


@inlined
def _friction(task: Task, n: int, h: float, bounds: Bounds, best: FirstEvent) -> FirstEvent:
    """Slip onset of the stuck pedestal to either side, or stick onset of the sliding one."""
    state, series, params = task.state, task.series, task.params
    if state.slide != 0:
        if not _clear(series.slip_rate, h, state.slide, 0.0, bounds.friction):
            lo = slip_rate_zeros(task, state.pivot, n) if series.slip_rate[0] == 0.0 else 0
            best = _seek(task, series.slip_rate, n, state.slide, 0.0, h, lo, codes.STICK_ONSET, state.slide, best)
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
        best = _search(task, n - 1, h, lo, codes.SLIP_ONSET, side, best)
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
        best = _seek(task, series.slip, n, -side, side * params.wall_pedestal_m, h, 0, codes.AT_WALL, side, best)
    pivot = state.pivot if rocks else state.facet
    x, z = vertex(task, pivot)
    pivot_x, pivot_z = series.pivot_x[0], series.pivot_z[0]
    if not rocks:
        xc, zc, _ = corner(task, state.facet, -1)
        pivot_x, pivot_z = xc, zc
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
        best = _search(task, n, h, 0, codes.AT_WALL, side, best)
    return best


@jit
def first_event(task: Task, n: int, h: float) -> FirstEvent:
    """The first event within the step of length h whose coefficients stand in the workspace."""
    state = task.state
    best = FirstEvent(NO_ROOT, codes.NO_EVENT, 0, 0, 0.0)
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
