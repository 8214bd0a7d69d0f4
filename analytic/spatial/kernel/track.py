"""What a run leaves behind: samples, events, intervals of one mode, the balance of energy; and what watches for events."""

from __future__ import annotations

import math
from typing import Final

from analytic.kernel.compiler import inlined, jit, store_double
from analytic.kernel.records import Floats
from analytic.spatial.kernel import codes
from analytic.spatial.kernel.contact import UNLIMITED, Rows, edge_margin, normal, tangent
from analytic.spatial.kernel.flat import flat_margin
from analytic.spatial.kernel.holding import vertex_place
from analytic.spatial.kernel.rates import contact_forces, kinetic_energy, touches_flat
from analytic.spatial.kernel.records import EVENT_HEAD, INTERVAL_HEAD, LOST, STATE, WORK, Memory, Run
from analytic.spatial.kernel.vectors import (
    axes,
    cross,
    dot,
    field,
    plus,
    row3,
    to_table,
    touched,
    vector,
)

# What ends a mode of motion: functions that are positive while it lasts (of rest: `resting.rest_margin`).


ROUNDED_M: Final = 2e-15
"""Rounding of a gap, the difference of heights of some metres."""
ROUNDED: Final = 1e-10
"""The same of forces, in the body's weight: they are differences of accelerations, solved for."""


@inlined
def _note(m: Memory, n: int, kind: int, vertex: int, value: float) -> int:
    m.watch[n], m.watch_kind[n], m.watch_vertex[n] = value, kind, vertex
    return n + 1


@jit
def heading_speed(m: Memory, y: Floats, rows: Rows, i: int) -> float:
    """Vertex i's velocity along its direction of sliding at the start of the step, m/s."""
    x = plus(to_table(rows, cross(vector(y, 10), row3(m.at, i))), vector(y, 7))
    return float(x[0] * m.heading[i, 0] + x[1] * m.heading[i, 1])


@jit
def _watch_flat(s: Run, m: Memory, y: Floats, rows: Rows, n: int, ok: bool) -> int:
    if s.mode == codes.FLAT_PIVOT:
        n = _note(m, n, codes.WATCH_SPEED, -1, s.sign * dot(rows[2], vector(y, 10)))
        if s.friction_static < UNLIMITED:
            n = _note(m, n, codes.WATCH_FRICTION, s.a, s.friction_static * normal(m, rows, s.a) - tangent(m, rows, s.a))
    else:
        for i in touched(s, m):
            n = _note(m, n, codes.WATCH_SPEED, i, heading_speed(m, y, rows, i))
    return _note(m, n, codes.WATCH_NORMAL, -1, flat_margin(s, m, ok))


@jit
def watch(s: Run, m: Memory, y: Floats, t: float) -> int:
    """Write the mode's event functions at a state; their number."""
    rows, n = axes(y), 0
    n = _note(m, n, codes.WATCH_TILT, -1, rows[2][2] - s.overturn_cos)
    for i in range(m.vertices):
        # Only a vertex in the air can come down: the gap of one that touches is rounding, of either sign.
        if m.down[i] == 0:
            n = _note(m, n, codes.WATCH_GAP, i, vertex_place(m, y, i)[2])
    if s.mode == codes.FLIGHT:
        return n
    ok = contact_forces(s, m, y, rows, field(s, m, t))
    if touches_flat(s.mode):
        return _watch_flat(s, m, y, rows, n, ok)
    a, b = s.a, s.b
    two = s.mode != codes.VERTEX_STICK and s.mode != codes.VERTEX_SLIDE
    n = _note(m, n, codes.WATCH_NORMAL, a, normal(m, rows, a))
    if two:
        n = _note(m, n, codes.WATCH_NORMAL, b, normal(m, rows, b))
    if s.mode == codes.EDGE_PIVOT:
        n = _note(m, n, codes.WATCH_SPEED, b, s.sign * dot(rows[2], vector(y, 10)))
    if s.mode == codes.EDGE_SLIDE or s.mode == codes.VERTEX_SLIDE:
        n = _note(m, n, codes.WATCH_SPEED, a, heading_speed(m, y, rows, a))
        if two:
            n = _note(m, n, codes.WATCH_SPEED, b, heading_speed(m, y, rows, b))
    elif s.friction_static < UNLIMITED:
        if s.mode == codes.EDGE_STICK:
            n = _note(m, n, codes.WATCH_FRICTION, -1, edge_margin(m, rows, a, b))
        else:
            n = _note(m, n, codes.WATCH_FRICTION, a, s.friction_static * normal(m, rows, a) - tangent(m, rows, a))
    return n


@inlined
def clearance(s: Run, kind: int) -> float:
    """What a function must exceed before its sign counts: less is rounding of the event that began the mode."""
    if kind == codes.WATCH_GAP:
        return ROUNDED_M
    if kind == codes.WATCH_SPEED:
        return s.still_m_s
    return ROUNDED * s.mass_kg * s.gravity_m_s2 if kind != codes.WATCH_TILT else 0.0


@jit
def arm(s: Run, m: Memory, count: int, fresh: bool) -> None:
    """Lift functions that begin at zero, and set down those that have become clear of it."""
    for k in range(count):
        least = clearance(s, m.watch_kind[k])
        if fresh:
            m.offset[k] = max(2.0 * least - m.watch[k], 0.0)
        elif m.watch[k] > least:
            m.offset[k] = 0.0


@jit
def lowest(s: Run, m: Memory, y: Floats, t: float) -> float:
    """Least of the event functions, positive while the mode lasts."""
    least = math.inf
    s.watched = watch(s, m, y, t)
    for k in range(s.watched):
        least = min(least, m.watch[k] + m.offset[k])
    return least


FREE: Final = 0.0
STICKS: Final = 1.0
SLIDES: Final = 2.0


@inlined
def sample(s: Run, m: Memory, time: float, y: Floats) -> None:
    """Write the next output sample."""
    start = s.samples * (STATE - 1)
    store_double(m.history, start, time)
    for c in range(STATE - 2):
        store_double(m.history, start + 1 + c, y[c])
    s.samples += 1


@jit
def _vertex_state(s: Run, m: Memory, i: int) -> float:
    does = codes.DOES[s.mode]
    if m.down[i] == 0 or does == codes.FLIES:
        return FREE
    return STICKS if does == codes.STICKS or (does == codes.PIVOTS and i == s.a) else SLIDES


@jit
def note_interval(s: Run, m: Memory) -> None:
    """Write the present mode as the next interval, if there is room."""
    if s.intervals < m.rows:
        start = s.intervals * (INTERVAL_HEAD + m.vertices)
        store_double(m.interval_table, start, s.time_s)
        store_double(m.interval_table, start + 1, s.mode)
        for i in range(m.vertices):
            store_double(m.interval_table, start + INTERVAL_HEAD + i, _vertex_state(s, m, i))
    s.intervals += 1


@jit
def note_event(s: Run, m: Memory, kind: int, vertex: int, loss: float, cone: float) -> None:
    """Write an event, if there is room; the impulses of an impact are those in memory (table's frame: `m.impulse`)."""
    if s.events < m.rows:
        start = s.events * (EVENT_HEAD + 3 * m.vertices)
        head = (s.time_s, float(kind), float(vertex), float(s.mode), loss, cone)
        for c in range(EVENT_HEAD):
            store_double(m.event_table, start + c, head[c])
        for i in range(m.vertices):
            for c in range(3):
                store_double(m.event_table, start + EVENT_HEAD + 3 * i + c, m.impulse[i, c])
    s.events += 1


@jit
def audit(s: Run, m: Memory, start_j: float) -> None:
    """Keep the largest residual of the balance of energy, relative to m g times the height of the centroid's reach."""
    # Kinetic energy less that at the start is the field's work less what sliding and impacts took.
    balance = kinetic_energy(s, m, m.y) - start_j - m.y[WORK] + m.y[LOST] + s.impact_loss_j
    s.energy_residual = max(s.energy_residual, abs(balance) / s.energy_scale_j)


@jit
def note_peak(s: Run, y: Floats) -> None:
    """Keep the largest tilt of the body's axis from the vertical."""
    # The last item of the rotation matrix is the cosine of the tilt; rounding may take it past one.
    up = y[3] * y[3] + y[6] * y[6] - y[4] * y[4] - y[5] * y[5]
    s.peak_tilt_rad = max(s.peak_tilt_rad, math.acos(min(max(up, -1.0), 1.0)))
