"""From a finished task to its solution."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from analytic import layout as at
from analytic.solution import KINDS, OUTCOMES, Doubts, Event, Outcome, Solution, Validity, Work

LEFT_BY: Final = ("", "the statue slides on its support", "contact is lost", "the pedestal itself tips")
"""Sentence of each of the kernel's codes for a limit passed."""


class Finished(NamedTuple):
    """A task and the arrays that it writes; arrays keeps alive those that it holds by their address."""

    runs: at.Runs
    arrays: tuple[at.Floats, ...]
    p: at.Floats
    s: at.Floats
    q: at.Ints
    r: at.Floats
    c: at.Ints
    grid: at.Floats
    events: at.Floats


def _optional(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def _event(row: at.Floats) -> Event:
    pivot = int(row[at.E_PIVOT])
    return Event(
        time_s=float(row[at.E_TIME]),
        kind=KINDS[int(row[at.E_KIND])],
        pivot=pivot if pivot >= 0 else None,
        facet=int(row[at.E_FACET]),
        slide=int(row[at.E_SLIDE]),
        theta_rad=float(row[at.E_THETA]),
        theta_rate_before_rad_s=float(row[at.E_OMEGA_BEFORE]),
        theta_rate_after_rad_s=float(row[at.E_OMEGA_AFTER]),
        slip_m=float(row[at.E_SLIP]),
        slip_rate_before_m_s=float(row[at.E_RATE_BEFORE]),
        slip_rate_after_m_s=float(row[at.E_RATE_AFTER]),
        energy_j=float(row[at.E_ENERGY]),
        feasible_states=int(row[at.E_TIED]),
        residual=float(row[at.E_RESIDUAL]),
    )


def _history(task: Finished) -> tuple[at.Floats, at.Floats]:
    """Times (n,) and states (n, 4) on the grid up to the end, and at the end itself."""
    if task.p[at.GRID_STEP] == 0.0:
        return np.empty(0), np.empty((0, 4))
    filled = int(task.q[at.GRID])
    dt, end = task.p[at.GRID_STEP], task.s[at.T]
    t, states = np.arange(filled) * dt, task.grid[:filled]
    if filled and end - t[-1] <= 1e-9 * dt:
        t, states = t[:-1], states[:-1]
    return np.append(t, end), np.vstack([states, task.s[at.S_TH : at.S_V + 1]])


def _validity(task: Finished) -> Validity | None:
    r = task.r
    if task.p[at.WANT_VALIDITY] == 0.0:
        return None
    based = task.p[at.HAS_BASE] > 0.0
    return Validity(
        pivot_friction_needed=float(r[at.PIVOT_FRICTION]),
        pivot_friction_needed_at_impact=float(r[at.PIVOT_FRICTION_IMPACT]),
        least_pivot_force_n=float(r[at.LEAST_V]),
        least_floor_force_n=float(r[at.LEAST_N]),
        pedestal_tipping_margin_m=_optional(r[at.TIP_MARGIN]) if based else None,
        pedestal_tipping_margin_at_impact_m=_optional(r[at.TIP_MARGIN_IMPACT]) if based else None,
        left_domain_s=_optional(r[at.LEFT_TIME]),
        left_domain_by=LEFT_BY[int(r[at.LEFT_BY])],
    )


def _work(task: Finished) -> Work:
    c = task.c
    return Work(
        steps=int(c[at.STEPS]),
        taylor_coefficients=int(c[at.COEFFICIENTS]),
        events=int(c[at.EVENTS]),
        impacts=int(c[at.IMPACTS]),
        quiet_samples_skipped=int(c[at.QUIET_SAMPLES]),
        skipped_s=float(task.r[at.SKIPPED_S]),
        ended_by_energy=bool(c[at.BY_ENERGY]),
    )


def _doubts(task: Finished) -> Doubts:
    c = task.c
    return Doubts(
        ambiguous_states=int(c[at.TIES]),
        near_tangent_steps=int(c[at.TANGENTS]),
        dropped_rebounds=int(c[at.ZENO]),
        worst_residual=float(task.r[at.RESIDUAL]),
        outcome_margin=_optional(task.r[at.OUTCOME_MARGIN]),
        gave_up=bool(c[at.GAVE_UP]),
    )


def read(task: Finished) -> Solution:
    """The solution that a finished task holds; its arrays are read-only."""
    r, s = task.r, task.s
    outcome = OUTCOMES[int(task.q[at.OUTCOME])]
    t, states = _history(task)
    columns = [np.ascontiguousarray(column) for column in (t, *states.T)]
    for column in columns:
        column.setflags(write=False)
    fell = outcome in (Outcome.OVERTURNED_LEFT, Outcome.OVERTURNED_RIGHT)
    return Solution(
        outcome=outcome,
        end_s=float(s[at.T]),
        t_s=columns[0],
        theta_rad=columns[1],
        theta_rate_rad_s=columns[2],
        slip_m=columns[3],
        slip_rate_m_s=columns[4],
        peak_theta_rad=float(abs(r[at.PEAK])),
        peak_signed_rad=float(r[at.PEAK]),
        peak_time_s=float(r[at.PEAK_TIME]),
        peak_slip_m=float(r[at.PEAK_SLIP]),
        final_slip_m=float(s[at.S_U]),
        overturn_time_s=_optional(r[at.OVERTURN_TIME]),
        no_return_time_s=_optional(r[at.NO_RETURN]) if fell else None,
        energy_lost_j=float(r[at.ENERGY_LOST]),
        energy_gained_j=float(r[at.ENERGY_GAINED]),
        events=tuple(_event(row) for row in task.events[: task.c[at.EVENTS]]),
        validity=_validity(task),
        work=_work(task),
        doubts=_doubts(task),
    )
