"""How far a run stays inside the model (docs/model.md, section 5): extremes kept while the run goes on."""

from __future__ import annotations

import math
from typing import Final

from analytic.kernel.codes import BY_LEAN, BY_LOST_CONTACT, BY_PIVOT_SLIP, BY_TIPPING
from analytic.kernel.compiler import jit
from analytic.kernel.dynamics import complete
from analytic.kernel.memory import load_double
from analytic.kernel.polynomial import value
from analytic.kernel.records import Task

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
        height = params.pedestal_height_m
        # x_r = (x_c V − H_p H − m₁ z₁ A)/N with z₁ = H_p/2: where the floor's force acts, from the pedestal's centre
        moment = contact * v - height * h_force - 0.5 * height * params.pedestal_mass_kg * accel
        margin = 0.5 * params.pedestal_width_m - abs(moment / n)
        results.tipping_margin_m = min(results.tipping_margin_m, margin)
        if margin < 0.0:
            leave(task, time, BY_TIPPING)


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
        height, contact = params.pedestal_height_m, load_double(task.base.x, pivot) - params.pedestal_centre_m
        # the same with impulses
        moment = contact * vertical - height * horizontal - 0.5 * height * params.pedestal_mass_kg * rate_change
        margin = 0.5 * params.pedestal_width_m - abs(moment / vertical)
        results.tipping_margin_at_impact_m = min(results.tipping_margin_at_impact_m, margin)
        if margin < 0.0:
            leave(task, task.state.time_s, BY_TIPPING)
