"""The equations of motion of each mode, and the forces that go with them."""

from __future__ import annotations

import math
from typing import Final

from analytic.kernel.compiler import inlined, jit
from analytic.kernel.records import Floats
from analytic.spatial.kernel import codes
from analytic.spatial.kernel.choose import pivot_directions
from analytic.spatial.kernel.contact import Rows, clear, columns, free_accelerations, solve_columns
from analytic.spatial.kernel.flat import solve_flat
from analytic.spatial.kernel.records import LOST, WORK, Memory, Run
from analytic.spatial.kernel.vectors import (
    Vector,
    apply,
    axes,
    cross,
    dot,
    field,
    length,
    minus,
    plus,
    put,
    row3,
    times,
    to_body,
    to_table,
    touched,
    vector,
)

SHIFT: Final = 4.0
"""Of the slowest sliding: friction turns round beyond where a vertex that stops is seen to have stopped (`track.arm`)."""


@inlined
def touches_flat(mode: int) -> bool:
    """Whether a facet lies on the floor."""
    return codes.KEEPS[mode] == codes.FACET


@jit
def set_slides(s: Run, m: Memory, y: Floats, rows: Rows) -> None:
    """Directions of sliding at a state; a vertex slower than `still_m_s` keeps the one that it began with, and one that comes
    straight back keeps it to the step's end: where it stops is found on a velocity that goes on smoothly.

    In a slow step all vertices have SHIFT of that speed more, each in its direction at the start: then the directions are smooth.
    """
    spin, v, shift = vector(y, 10), to_body(rows, vector(y, 7)), SHIFT * s.still_m_s
    first = to_table(rows, row3(m.at, m.touch[0]))
    for i in touched(s, m):
        x = plus(v, cross(spin, row3(m.at, i)))
        dx, dy = dot(rows[0], x), dot(rows[1], x)
        if s.slow:
            arm = minus(to_table(rows, row3(m.at, i)), first)
            dx += shift * m.heading[i, 0] + m.bent[0] - m.bent[2] * arm[1]
            dy += shift * m.heading[i, 1] + m.bent[1] + m.bent[2] * arm[0]
        speed = math.sqrt(dx * dx + dy * dy)
        along, across = dx * m.heading[i, 0] + dy * m.heading[i, 1], dy * m.heading[i, 0] - dx * m.heading[i, 1]
        back = along < 0.0 and abs(across) <= s.still_m_s
        if speed > (s.still_m_s if not s.slow else 0.0) and not back:
            m.slide[i, 0], m.slide[i, 1] = dx / speed, dy / speed
        else:
            m.slide[i, 0], m.slide[i, 1] = m.heading[i, 0], m.heading[i, 1]


@jit
def contact_forces(s: Run, m: Memory, y: Floats, rows: Rows, g: Vector) -> bool:
    """Write the contact forces and the response of the present mode of motion; False where its equations have no solution."""
    clear(s, m)
    m.response[:] = 0.0
    if s.mode == codes.FLIGHT:
        return True
    free_accelerations(s, m, y, g)
    if s.mode == codes.FLAT_PIVOT:
        pivot_directions(s, m, rows, s.a, s.sign)
        return solve_flat(s, m, rows, s.mode, s.a)
    if s.mode == codes.FLAT_SLIDE:
        set_slides(s, m, y, rows)
        return solve_flat(s, m, rows, s.mode, -1)
    if s.mode == codes.EDGE_SLIDE or s.mode == codes.VERTEX_SLIDE:
        set_slides(s, m, y, rows)
    return solve_columns(s, m, columns(m, rows, s.mode, s.a, s.b, s.sign))


@jit
def rates(s: Run, m: Memory, y: Floats, t: float, out: Floats) -> None:
    """Write the state's rates in the present mode."""
    rows, spin, v = axes(y), vector(y, 10), vector(y, 7)
    g = field(s, m, t)
    lost = 0.0
    if s.mode == codes.FLAT_REST:
        out[:] = 0.0
        return
    momentum = cross(apply(m.inertia, spin), spin)
    if s.mode == codes.FLIGHT:
        accel, alpha = g, apply(m.inverse, momentum)
    elif s.mode == codes.VERTEX_STICK or s.mode == codes.EDGE_STICK:
        arm = row3(m.at, s.a)
        down = to_body(rows, g)
        # About the fixed vertex O, r from it to the centroid −arm: I_O ω̇ + ω × I_O ω = m r × g_e.
        turn = times(s.mass_kg, cross(down, arm))
        if s.mode == codes.VERTEX_STICK:
            about = minus(momentum, times(s.mass_kg, cross(spin, cross(arm, cross(spin, arm)))))
            alpha = apply(m.about[s.a], plus(turn, about))
        else:
            edge = minus(row3(m.at, s.b), arm)
            edge = times(1.0 / length(edge), edge)
            reach = cross(edge, arm)
            inertia = dot(edge, apply(m.inertia, edge)) + s.mass_kg * dot(reach, reach)
            alpha = times(dot(edge, turn) / inertia, edge)
        accel = to_table(rows, minus(times(-1.0, cross(alpha, arm)), cross(spin, cross(spin, arm))))
    else:
        contact_forces(s, m, y, rows, g)
        pull, twist = vector(m.response, 0), vector(m.response, 3)
        accel = plus(g, to_table(rows, pull))
        alpha = plus(apply(m.inverse, momentum), twist)
        lost = sliding_power(s, m, y, rows)
    put(out, 0, v)
    w, x, y_, z = y[3], y[4], y[5], y[6]
    out[3] = 0.5 * (-x * spin[0] - y_ * spin[1] - z * spin[2])
    out[4] = 0.5 * (w * spin[0] + y_ * spin[2] - z * spin[1])
    out[5] = 0.5 * (w * spin[1] + z * spin[0] - x * spin[2])
    out[6] = 0.5 * (w * spin[2] + x * spin[1] - y_ * spin[0])
    put(out, 7, accel)
    put(out, 10, alpha)
    out[WORK] = s.mass_kg * dot(g, v)
    out[LOST] = lost


@jit
def sliding_power(s: Run, m: Memory, y: Floats, rows: Rows) -> float:
    """Work lost in a second by the forces in memory where they slide: −Σ F · v, W."""
    spin, v, total = vector(y, 10), to_body(rows, vector(y, 7)), 0.0
    for i in touched(s, m):
        x = plus(v, cross(spin, row3(m.at, i)))
        total -= dot(row3(m.force, i), x)
    return total


@jit
def kinetic_energy(s: Run, m: Memory, y: Floats) -> float:
    """Of the body in the table's frame, J."""
    v, spin = vector(y, 7), vector(y, 10)
    return 0.5 * (s.mass_kg * dot(v, v) + dot(spin, apply(m.inertia, spin)))
