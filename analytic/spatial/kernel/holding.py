"""A state put exactly into its mode: what steps and events leave by rounding is taken away, place and velocity."""

from __future__ import annotations

import math

from analytic.kernel.compiler import jit
from analytic.kernel.records import Floats
from analytic.spatial.kernel import codes
from analytic.spatial.kernel.contact import along_across, set_column, solve_columns, vertex_velocities
from analytic.spatial.kernel.rates import touches_flat
from analytic.spatial.kernel.records import Memory, Run
from analytic.spatial.kernel.vectors import (
    Vector,
    axes,
    cross,
    dot,
    length,
    minus,
    plus,
    put,
    row3,
    times,
    to_table,
    touched,
    turn,
    vector,
)


@jit
def vertex_place(m: Memory, y: Floats, i: int) -> Vector:
    """Place of vertex i in the table's frame."""
    return plus(vector(y, 0), to_table(axes(y), row3(m.at, i)))


@jit
def hold_place(s: Run, m: Memory, y: Floats) -> None:
    """Turn and shift the body so that what touches is on the floor, and what sticks is where it stuck."""
    still = (0.0, 0.0, 0.0)
    if s.mode == codes.FLIGHT or s.mode == codes.VERTEX_STICK or s.mode == codes.VERTEX_SLIDE:
        turn(y, still)
    elif touches_flat(s.mode):
        i, j, k = m.touch[0], m.touch[1], m.touch[2]
        rows = axes(y)
        p = row3(m.at, i)
        up = cross(minus(row3(m.at, j), p), minus(row3(m.at, k), p))
        up = to_table(rows, up)
        up = times(1.0 / length(up), up)
        # What is left is small: the cross product of two unit vectors is the turn from one to the other, to third order.
        turn(y, cross(up, (0.0, 0.0, 1.0)))
    else:
        d = to_table(axes(y), minus(row3(m.at, s.b), row3(m.at, s.a)))
        wanted = (d[0], d[1], 0.0)
        if s.mode == codes.EDGE_STICK:
            wanted = (m.anchor[s.b, 0] - m.anchor[s.a, 0], m.anchor[s.b, 1] - m.anchor[s.a, 1], 0.0)
        turn(y, times(1.0 / (length(d) * length(wanted)), cross(d, wanted)))
    if s.mode == codes.FLIGHT:
        return
    i = s.a if not touches_flat(s.mode) or s.mode == codes.FLAT_PIVOT else m.touch[0]
    x = vertex_place(m, y, i)
    y[2] -= x[2]
    if s.mode in (codes.VERTEX_STICK, codes.EDGE_STICK, codes.EDGE_PIVOT, codes.FLAT_PIVOT):
        y[0] += m.anchor[i, 0] - x[0]
        y[1] += m.anchor[i, 1] - x[1]


@jit
def _stop(s: Run, m: Memory, y: Floats, turning: bool) -> None:
    """Take away the velocities that the mode does not have by impulses where it holds them; that of turning too where asked."""
    rows, n = axes(y), 0
    vertex_velocities(s, m, y)
    a, b = s.a if not touches_flat(s.mode) or s.mode == codes.FLAT_PIVOT else m.touch[0], s.b
    for c in range(0 if s.mode in (codes.VERTEX_STICK, codes.EDGE_STICK, codes.EDGE_PIVOT, codes.FLAT_PIVOT) else 2, 3):
        set_column(m, n, a, rows[c], rows[c])
        n += 1
    if touches_flat(s.mode):
        third = s.touching // 3
        start = 0
        for k in range(s.touching):
            if m.touch[k] == a:
                start = k
        b = m.touch[(start + third) % s.touching]
        for k in (start + third, start + 2 * third):
            set_column(m, n, m.touch[k % s.touching], rows[2], rows[2])
            n += 1
    elif s.mode not in (codes.VERTEX_STICK, codes.VERTEX_SLIDE):
        set_column(m, n, b, rows[2], rows[2])
        n += 1
    if turning:
        across = along_across(m, rows, a, b)[1]
        set_column(m, n, b, across, across)
        n += 1
    if solve_columns(s, m, n):
        put(y, 7, plus(vector(y, 7), to_table(rows, vector(m.response, 0))))
        put(y, 10, plus(vector(y, 10), vector(m.response, 3)))


@jit
def hold_velocity(s: Run, m: Memory, y: Floats) -> None:
    """Take away the velocities that the mode does not have: what that costs in energy is of second order in what is taken."""
    if s.mode == codes.FLIGHT:
        return
    if s.mode == codes.FLAT_REST:
        y[7:13] = 0.0
        return
    _stop(s, m, y, s.mode == codes.EDGE_STICK)
    if s.mode in (codes.EDGE_PIVOT, codes.FLAT_PIVOT) and s.sign * dot(axes(y)[2], vector(y, 10)) < 0.0:
        # What was taken has turned it round, or it did turn the other way: what turns from rest must not.
        _stop(s, m, y, True)


@jit
def hold_level(s: Run, m: Memory, y: Floats) -> None:
    """Take away at once what the vertices that touch still rise by: a rebound dropped at one must not push another down."""
    rows, n = axes(y), min(s.touching, 3)
    vertex_velocities(s, m, y)
    for k in range(n):
        set_column(m, k, m.touch[k * s.touching // n], rows[2], rows[2])
    if solve_columns(s, m, n):
        put(y, 7, plus(vector(y, 7), to_table(rows, vector(m.response, 0))))
        put(y, 10, plus(vector(y, 10), vector(m.response, 3)))


@jit
def take_heading(s: Run, m: Memory, y: Floats) -> None:
    """Note in which direction each touching vertex slides now; a vertex slower than `still_m_s` keeps its direction."""
    rows = axes(y)
    vertex_velocities(s, m, y)
    for i in touched(s, m):
        x = to_table(rows, row3(m.u, i))
        speed = math.sqrt(x[0] * x[0] + x[1] * x[1])
        # The direction of a slower one is rounding.
        if speed > s.still_m_s:
            m.heading[i, 0], m.heading[i, 1] = x[0] / speed, x[1] / speed


@jit
def set_touch(s: Run, m: Memory) -> None:
    """List the vertices that are down in the order of their polygon, by angle about their middle, from above."""
    x, y, n = 0.0, 0.0, 0
    for i in range(m.vertices):
        if m.down[i] != 0:
            m.touch[n] = i
            x, y, n = x + vertex_place(m, m.y, i)[0], y + vertex_place(m, m.y, i)[1], n + 1
    s.touching = n
    if n < 3:
        return
    x, y = x / n, y / n
    for k in range(1, n):
        i = m.touch[k]
        at = vertex_place(m, m.y, i)
        angle, j = math.atan2(at[1] - y, at[0] - x), k
        while j > 0:
            before = vertex_place(m, m.y, m.touch[j - 1])
            if math.atan2(before[1] - y, before[0] - x) <= angle:
                break
            m.touch[j] = m.touch[j - 1]
            j -= 1
        m.touch[j] = i
