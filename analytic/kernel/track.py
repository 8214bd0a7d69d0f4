"""What is kept of a run: output samples, peaks, the crossing of the balance point, the table of events, and how far it stays
inside the model.
"""

import math
from typing import Final

from analytic.kernel.compiler import cell_at, inlined, jit, load_double, set_term, store_double, term
from analytic.kernel.dynamics import choose, complete
from analytic.kernel.polynomial import first_root, value
from analytic.kernel.records import (
    BREAK,
    BY_LEAN,
    BY_LOST_CONTACT,
    BY_PIVOT_SLIP,
    BY_TIPPING,
    EVENT_ROW,
    LIFT_OFF,
    LOST_CONTACT,
    NO_SOLUTION,
    EventRow,
    Floats,
    Task,
)

# How far a run stays inside the model (docs/model.md, section 5): extremes kept while the run goes on.


SAMPLES: Final = 8
"""Instants at which a step's forces are looked at, its ends included: a step spans a fraction of a half-cycle."""
HALVINGS: Final = 30
"""Of the time between two of them, to where a limit is passed: to 1e-10 of a step."""


@jit
def leave(task: Task, time: float, by: int) -> None:
    """The run leaves the model's domain, if it has not left it before."""
    if math.isnan(task.results.left_domain_s):
        task.results.left_domain_s, task.results.left_domain_by = time, by


@jit
def _tipping(
    task: Task, time: float, contact: float, vertical: float, horizontal: float, accel: float, floor: float
) -> float:
    """How far inside the pedestal's foot the floor's force acts, m, of forces, or of impulses and the change of velocity.

    contact is where the statue's force meets the pedestal, from its centre, m; floor the floor's normal force.
    """
    height = task.params.pedestal_height_m
    # x_r = (x_c V − H_p H − m₁ z₁ A)/N with z₁ = H_p/2: where the floor's force acts, from the pedestal's centre
    moment = contact * vertical - height * horizontal - 0.5 * height * task.params.pedestal_mass_kg * accel
    margin = 0.5 * task.params.pedestal_width_m - abs(moment / floor)
    if margin < 0.0:
        leave(task, time, BY_TIPPING)
    return margin


@jit
def _note(task: Task, time: float, h_force: float, v: float, n: float, contact: float, accel: float) -> None:
    """Keep the extremes; contact is where the statue's force meets the pedestal, from its centre, m."""
    results, params = task.results, task.params
    results.least_pivot_normal_n = min(results.least_pivot_normal_n, v)
    results.least_floor_normal_n = min(results.least_floor_normal_n, n)
    if v > 0.0:
        results.pivot_friction = max(results.pivot_friction, abs(h_force) / v)
        if abs(h_force) > params.statue_friction * v:
            leave(task, time, BY_PIVOT_SLIP)
    else:
        leave(task, time, BY_LOST_CONTACT)
    if params.has_pedestal and n > 0.0:
        margin = _tipping(task, time, contact, v, h_force, accel, n)
        results.tipping_margin_m = min(results.tipping_margin_m, margin)


@jit
def note_rest(task: Task, time: float, accel: float, gravity: float) -> None:
    """Forces on a statue at rest on a support of absolute acceleration accel, m/s², under effective gravity, m/s²."""
    params = task.params
    height = params.centroid_height_m - load_double(task.base.z, task.state.facet)
    # the moments of H and V about the centroid balance at rest: V meets the base at −h H/V from below it
    contact = -(accel * height) / gravity - params.pedestal_centre_m if gravity > 0.0 else 0.0
    m = params.mass_kg
    _note(task, time, m * accel, m * gravity, (m + params.pedestal_mass_kg) * gravity, contact, accel)


@jit
def note_step(task: Task, n: int, tau: float) -> None:
    """Forces during a step of length tau whose coefficients stand in the workspace to order n − 1."""
    inside = math.isnan(task.results.left_domain_s)
    if task.state.pivot >= 0:
        complete(task, n - 1)
    for i in range(SAMPLES):
        _note_at(task, n, tau * i / (SAMPLES - 1))
        if i > 0 and inside and not math.isnan(task.results.left_domain_s):
            inside = False
            _locate_exit(task, n, tau * (i - 1) / (SAMPLES - 1), tau * i / (SAMPLES - 1))


@jit
def _locate_exit(task: Task, n: int, within: float, beyond: float) -> None:
    """Move the instant at which the domain is left from the sample that saw it, at `beyond`, to where a limit is passed."""
    results = task.results
    for _ in range(HALVINGS):
        at, by = 0.5 * (within + beyond), results.left_domain_by
        results.left_domain_s = math.nan
        _note_at(task, n, at)
        if math.isnan(results.left_domain_s):
            within, results.left_domain_by = at, by
        else:
            beyond = at
    results.left_domain_s = task.state.time_s + beyond


@jit
def _note_at(task: Task, n: int, at: float) -> None:
    """Forces at a time after the step's beginning."""
    series, pivot = task.series, task.state.pivot
    time = task.state.time_s + at
    v = value(series.pivot_normal, n - 1, at)
    accel = value(series.support_accel, n - 1, at)
    if pivot < 0:
        note_rest(task, time, accel, v / task.params.mass_kg)
    else:
        contact = load_double(task.base.x, pivot) - task.params.pedestal_centre_m
        horizontal, normal = value(series.pivot_force, n - 1, at), value(series.floor_normal, n - 1, at)
        _note(task, time, horizontal, v, normal, contact, accel)
        theta = value(series.theta, n, at)
        if theta > task.params.base_right_rad or -theta > task.params.base_left_rad:
            leave(task, time, BY_LEAN)


@jit
def note_impact(task: Task, pivot: int, horizontal: float, vertical: float, rate_change: float) -> None:
    """Impulses on the statue at its new corner, N s, and the change of the pedestal's velocity, m/s."""
    if vertical <= 0.0:
        return
    results, params = task.results, task.params
    results.pivot_friction_at_impact = max(results.pivot_friction_at_impact, abs(horizontal) / vertical)
    if abs(horizontal) > params.statue_friction * vertical:
        leave(task, task.state.time_s, BY_PIVOT_SLIP)
    if params.has_pedestal:
        contact = load_double(task.base.x, pivot) - params.pedestal_centre_m
        margin = _tipping(task, task.state.time_s, contact, vertical, horizontal, rate_change, vertical)
        results.tipping_margin_at_impact_m = min(results.tipping_margin_at_impact_m, margin)


SAME_INSTANT: Final = 1e-9
"""Share of the output step below which the last instant counts as the sample before it: a duration that is a multiple of the step
in decimal is one only to rounding in binary."""


@inlined
def _crossing(task: Task, row: Floats, n: int, tau: float, sign: float) -> float:
    """Time within the step at which sign × row, positive at its start, reaches zero."""
    for k in range(n + 1):
        set_term(task.series.event, k, sign * term(row, k))
    x, _, _ = first_root(task.series.event, 0, n, tau)
    return min(x, 1.0) * tau


@inlined
def note_peak(task: Task, theta: float, time: float) -> None:
    """Keep the largest rotation and its time."""
    if abs(theta) > abs(task.results.peak_theta_rad):
        task.results.peak_theta_rad, task.results.peak_time_s = theta, time


@inlined
def _values(a: Floats, b: Floats, n: int, x: float) -> tuple[float, float]:
    """Values at x of two polynomials of order n, even and odd powers apart."""
    y, k = x * x, n
    even, odd, even1, odd1 = 0.0, 0.0, 0.0, 0.0
    if n % 2 == 0:
        even, even1, k = term(a, n), term(b, n), n - 1
    while k > 0:
        odd, odd1 = odd * y + term(a, k), odd1 * y + term(b, k)
        even, even1 = even * y + term(a, k - 1), even1 * y + term(b, k - 1)
        k -= 2
    return even + x * odd, even1 + x * odd1


@inlined
def _move(task: Task, n: int, tau: float) -> None:
    """Set what moves to the step's polynomials at tau."""
    state, series = task.state, task.series
    if state.pivot >= 0:
        state.theta_rad, state.theta_rate_rad_s = _values(series.theta, series.theta_rate, n, tau)
    if state.slide != 0:
        state.slip_m, state.slip_rate_m_s = _values(series.slip, series.slip_rate, n, tau)


@inlined
def _sample(task: Task, time: float, theta: float, theta_rate: float, slip: float, slip_rate: float) -> None:
    """Write the next output sample."""
    history, i, row = task.output.history, task.counts.samples, task.output.n_samples + 1
    store_double(history, i, time)
    store_double(history, i + row, theta)
    store_double(history, i + 2 * row, theta_rate)
    store_double(history, i + 3 * row, slip)
    store_double(history, i + 4 * row, slip_rate)
    task.counts.samples += 1


@inlined
def sample_state(task: Task, time: float) -> None:
    """Write the present state as the next output sample."""
    state = task.state
    _sample(task, time, state.theta_rad, state.theta_rate_rad_s, state.slip_m, state.slip_rate_m_s)


@jit
def _sample_step(task: Task, n: int, until: float) -> None:
    """Write the output samples before until."""
    series, state, counts, dt = task.series, task.state, task.counts, task.params.output_step_s
    while counts.samples < task.output.n_samples and counts.samples * dt < until:
        time = counts.samples * dt
        at = max(time - state.time_s, 0.0)
        slip, slip_rate = state.slip_m, 0.0
        if state.slide != 0:
            slip, slip_rate = value(series.slip, n, at), value(series.slip_rate, n, at)
        _sample(task, time, value(series.theta, n, at), value(series.theta_rate, n, at), slip, slip_rate)


@jit
def sample_end(task: Task) -> None:
    """Write the last instant after the output samples, or over the last of them if that is as late."""
    state, counts, dt = task.state, task.counts, task.params.output_step_s
    if counts.samples > 0 and state.time_s - (counts.samples - 1) * dt <= SAME_INSTANT * dt:
        counts.samples -= 1
    sample_state(task, state.time_s)


@inlined
def _note_balance(task: Task, n: int, tau: float) -> None:
    """Note when the centroid passes over the corner rocked about: the last time before a fall is that of no return."""
    series = task.series
    start, turned = series.pivot_x[0], abs(task.state.theta_rad - series.theta[0])
    side = 1.0 if start > 0.0 else -1.0
    # the centroid moves on a circle: no further than the turn times its radius
    in_reach = start != 0.0 and abs(start) <= (abs(start) + abs(series.pivot_z[0])) * turned
    if in_reach and side * value(series.pivot_x, n, tau) <= 0.0:
        task.results.no_return_time_s = task.state.time_s + _crossing(task, series.pivot_x, n, tau, side)


@inlined
def advance(task: Task, n: int, tau: float, until: float) -> None:
    """Move the state to the end of a step of length tau, at until, and keep what is wanted of it; the clock stays."""
    series, state, results = task.series, task.state, task.results
    if task.params.output_step_s > 0.0:
        _sample_step(task, n, until)
    _move(task, n, tau)
    results.peak_slip_m = max(results.peak_slip_m, abs(state.slip_m))
    if state.pivot < 0:
        return
    theta, omega, before = state.theta_rad, state.theta_rate_rad_s, series.theta_rate[0]
    # a peak inside the step is looked for only where the faster of its ends could carry θ beyond the peak so far
    reach = max(abs(series.theta[0]), abs(theta)) + tau * max(abs(before), abs(omega))
    if before * omega < 0.0 and reach > abs(results.peak_theta_rad):
        at = _crossing(task, series.theta_rate, n, tau, 1.0 if before > 0.0 else -1.0)
        note_peak(task, value(series.theta, n, at), state.time_s + at)
    note_peak(task, theta, until)
    _note_balance(task, n, tau)


event_cell: Final = cell_at(EVENT_ROW, EventRow)


@jit
def note_event(task: Task, kind: int, omega: float, rate: float, energy: float, feasible: int, residual: float) -> None:
    """Write one row of the table of events, if it still has room; omega and rate: θ̇ and u̇ before the event."""
    state, i = task.state, task.counts.events
    task.counts.events += 1
    if i >= task.output.n_events:
        return
    event = event_cell(task.output.events, i).item
    event.time_s, event.kind = state.time_s, kind
    event.pivot, event.facet, event.slide = state.pivot, state.facet, state.slide
    event.theta_rad, event.slip_m = state.theta_rad, state.slip_m
    event.theta_rate_before_rad_s, event.theta_rate_after_rad_s = omega, state.theta_rate_rad_s
    event.slip_rate_before_m_s, event.slip_rate_after_m_s = rate, state.slip_rate_m_s
    event.energy_j, event.feasible_states, event.residual = energy, feasible, residual


@jit
def change_state(
    task: Task, kind: int, omega: float, rate: float, rock_free: bool, energy: float, residual: float
) -> None:
    """Choose the joint state after an event or a jump, and note it; omega and rate: θ̇ and u̇ before."""
    state, has_pedestal = task.state, task.params.has_pedestal
    pivot, slide, feasible = state.pivot, state.slide, 0
    slide_free = has_pedestal and state.slip_rate_m_s == 0.0
    state.fresh = True
    if not slide_free and has_pedestal:
        state.slide = 1 if state.slip_rate_m_s > 0.0 else -1
    if rock_free or slide_free:
        feasible, ending = choose(task, rock_free)
        task.counts.ties += 1 if feasible > 1 else 0
        if ending != 0:
            state.outcome = ending
            note_event(task, kind, omega, rate, energy, feasible, residual)
            kind = LOST_CONTACT if ending == LIFT_OFF else NO_SOLUTION
    if kind != BREAK or pivot != state.pivot or slide != state.slide:
        note_event(task, kind, omega, rate, energy, feasible, residual)
