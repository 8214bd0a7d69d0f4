"""How far a run stays inside the model (docs/model.md, section 5): extremes kept while the run goes on."""

from __future__ import annotations

import math
from typing import Final

from analytic.kernel.compiler import jit
from analytic.kernel.dynamics import complete
from analytic.kernel.layout import (
    ABS,
    BASE_CENTRE,
    BASE_HEIGHT,
    BASE_MASS,
    BASE_WIDTH,
    BASE_X,
    BASE_Z,
    BY_FLIGHT,
    BY_PIVOT_SLIP,
    BY_TIPPING,
    CENTROID,
    FACET,
    HAS_BASE,
    LEAST_N,
    LEAST_V,
    LEFT_BY,
    LEFT_TIME,
    MASS,
    NORMAL,
    PIVOT,
    PIVOT_FRICTION,
    PIVOT_FRICTION_IMPACT,
    PIVOT_H,
    PIVOT_V,
    STATUE_FRICTION,
    TIP_MARGIN,
    TIP_MARGIN_IMPACT,
    T,
    Task,
)
from analytic.kernel.memory import peek
from analytic.kernel.polynomial import value

SAMPLES: Final = 8
"""Instants at which a step's forces are looked at, its ends included."""


@jit
def _left(task: Task, time: float, by: int) -> None:
    """The run leaves the model's domain, if it has not left it before."""
    if math.isnan(task.r[LEFT_TIME]):
        task.r[LEFT_TIME], task.r[LEFT_BY] = time, by


@jit
def _note(task: Task, time: float, h_force: float, v: float, n: float, contact: float, accel: float) -> None:
    """Keep the extremes; contact is where the statue's force meets the pedestal, from its centre, m."""
    r, p = task.r, task.p
    r[LEAST_V], r[LEAST_N] = min(r[LEAST_V], v), min(r[LEAST_N], n)
    if v > 0.0:
        r[PIVOT_FRICTION] = max(r[PIVOT_FRICTION], abs(h_force) / v)
        if abs(h_force) > p[STATUE_FRICTION] * v:
            _left(task, time, BY_PIVOT_SLIP)
    else:
        _left(task, time, BY_FLIGHT)
    if p[HAS_BASE] > 0.0 and n > 0.0:
        height = p[BASE_HEIGHT]
        moment = contact * v - height * h_force - 0.5 * height * p[BASE_MASS] * accel
        margin = 0.5 * p[BASE_WIDTH] - abs(moment / n)
        r[TIP_MARGIN] = min(r[TIP_MARGIN], margin)
        if margin < 0.0:
            _left(task, time, BY_TIPPING)


@jit
def note_rest(task: Task, time: float, accel: float, gravity: float) -> None:
    """Forces on a statue at rest on a support of absolute acceleration accel, m/s², under effective gravity, m/s²."""
    p = task.p
    height = p[CENTROID] - peek(task.address[BASE_Z], task.q[FACET])
    contact = -(accel * height) / gravity - p[BASE_CENTRE] if gravity > 0.0 else 0.0
    m = p[MASS]
    _note(task, time, m * accel, m * gravity, (m + p[BASE_MASS]) * gravity, contact, accel)


@jit
def note_step(task: Task, n: int, tau: float) -> None:
    """Forces during a step of length tau whose coefficients stand in the workspace to order n − 1."""
    w, pivot = task.w, task.q[PIVOT]
    if pivot >= 0:
        complete(task, n - 1)
    for i in range(SAMPLES):
        at = tau * i / (SAMPLES - 1)
        time = task.s[T] + at
        v = value(w, PIVOT_V, n - 1, at)
        accel = value(w, ABS, n - 1, at)
        if pivot < 0:
            note_rest(task, time, accel, v / task.p[MASS])
        else:
            contact = peek(task.address[BASE_X], pivot) - task.p[BASE_CENTRE]
            _note(task, time, value(w, PIVOT_H, n - 1, at), v, value(w, NORMAL, n - 1, at), contact, accel)


@jit
def note_impact(task: Task, pivot: int, horizontal: float, vertical: float, rate_change: float) -> None:
    """Impulses on the statue at its new corner, N s, and the change of the pedestal's velocity, m/s."""
    if vertical <= 0.0:
        return
    r, p = task.r, task.p
    r[PIVOT_FRICTION_IMPACT] = max(r[PIVOT_FRICTION_IMPACT], abs(horizontal) / vertical)
    if abs(horizontal) > p[STATUE_FRICTION] * vertical:
        _left(task, task.s[T], BY_PIVOT_SLIP)
    if p[HAS_BASE] > 0.0:
        height, contact = p[BASE_HEIGHT], peek(task.address[BASE_X], pivot) - p[BASE_CENTRE]
        moment = contact * vertical - height * horizontal - 0.5 * height * p[BASE_MASS] * rate_change
        margin = 0.5 * p[BASE_WIDTH] - abs(moment / vertical)
        r[TIP_MARGIN_IMPACT] = min(r[TIP_MARGIN_IMPACT], margin)
        if margin < 0.0:
            _left(task, task.s[T], BY_TIPPING)
