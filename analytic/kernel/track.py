"""What is kept of a run: output samples, peaks, the crossing of the balance point, and the table of events."""

from __future__ import annotations

from typing import Final

from analytic.kernel import codes
from analytic.kernel.compiler import inlined, jit
from analytic.kernel.joint_state import choose
from analytic.kernel.memory import event_row, set_term, store_double, term
from analytic.kernel.polynomial import first_root, value
from analytic.kernel.records import Floats, Task

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
    history, i, row = task.output.history, task.output.next_sample, task.output.n_samples + 1
    store_double(history, i, time)
    store_double(history, i + row, theta)
    store_double(history, i + 2 * row, theta_rate)
    store_double(history, i + 3 * row, slip)
    store_double(history, i + 4 * row, slip_rate)
    task.output.next_sample += 1


@inlined
def sample_state(task: Task, time: float) -> None:
    """Write the present state as the next output sample."""
    state = task.state
    _sample(task, time, state.theta_rad, state.theta_rate_rad_s, state.slip_m, state.slip_rate_m_s)


@jit
def _sample_step(task: Task, n: int, until: float) -> None:
    """Write the output samples before until."""
    series, state, output, dt = task.series, task.state, task.output, task.params.output_step_s
    while output.next_sample < output.n_samples and output.next_sample * dt < until:
        time = output.next_sample * dt
        at = max(time - state.time_s, 0.0)
        slip, slip_rate = state.slip_m, 0.0
        if state.slide != 0:
            slip, slip_rate = value(series.slip, n, at), value(series.slip_rate, n, at)
        _sample(task, time, value(series.theta, n, at), value(series.theta_rate, n, at), slip, slip_rate)


@jit
def sample_end(task: Task) -> None:
    """Write the last instant after the output samples, or over the last of them if that is as late."""
    state, output, dt = task.state, task.output, task.params.output_step_s
    if output.next_sample > 0 and state.time_s - (output.next_sample - 1) * dt <= SAME_INSTANT * dt:
        output.next_sample -= 1
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


@jit
def note_event(task: Task, kind: int, omega: float, rate: float, energy: float, feasible: int, residual: float) -> None:
    """Write one row of the table of events, if it still has room; omega and rate: θ̇ and u̇ before the event."""
    state, i = task.state, task.counts.events
    task.counts.events += 1
    if i >= task.output.n_events:
        return
    event = event_row(task.output.events, i)
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
            kind = codes.LOST_CONTACT if ending == codes.LIFT_OFF else codes.NO_SOLUTION
    if kind != codes.BREAK or pivot != state.pivot or slide != state.slide:
        note_event(task, kind, omega, rate, energy, feasible, residual)
