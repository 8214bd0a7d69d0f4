"""Steps of slow sliding, implicit in what is stiff there.

Friction turns a vertex that slides with v within |v|/(μ g), far faster than anything else moves; an explicit step spans only some
of these times. The linearly implicit Euler step with any matrix J has an expansion in its length, and is extrapolated (Hairer and
Wanner, Solving Ordinary Differential Equations II, IV.9). Here J = U V has rank three: V is what the level motion of what touches
(two velocities of its first vertex, and yaw) changes with the state, U what the rates change with it as vertices turn.
"""

from __future__ import annotations

import math
from typing import Final

from analytic.kernel.compiler import inlined, jit
from analytic.kernel.records import Floats
from analytic.spatial.kernel.codes import EDGE_SLIDE, FLAT_SLIDE, VERTEX_SLIDE
from analytic.spatial.kernel.contact import vertex_velocities
from analytic.spatial.kernel.rates import rates
from analytic.spatial.kernel.records import STATE, Memory, Run
from analytic.spatial.kernel.vectors import (
    Vector,
    axes,
    cross,
    dot,
    minus,
    plus,
    row3,
    times,
    to_table,
    touched,
    vector,
)

COARSE: Final = 1e-9
"""Local error from which fewer extrapolations cost less."""
FEW: Final = 4
"""Extrapolations there, and"""
MANY: Final = 5
"""for a finer one: five weights raise the rounding of slow velocities two hundredfold, eight several thousandfold."""
SLOW_S: Final = 3e-5
"""A vertex that friction turns faster than in this is slow: an explicit step spans some six such times; and"""
COARSE_SLOW_S: Final = 1.5e-4
"""where slow steps are longer."""
FINEST: Final = 1e-12
"""Least local error of a slow step: the rounding of slow velocities, raised as above, stays below."""
FIRST: Final = 2
"""Parts of the step in the first of them; one more in each that follows."""
BENT: Final = 1e-4
"""Share of the slowest vertex' speed by which velocities are changed to see how the rates follow."""


@inlined
def extrapolations(s: Run) -> int:
    """How often a slow step is extrapolated: its order."""
    return FEW if s.tolerance >= COARSE else MANY


@inlined
def is_slow(s: Run, turning_s: float) -> bool:
    """Whether slow steps are cheaper than explicit ones."""
    return turning_s < (COARSE_SLOW_S if s.tolerance >= COARSE else SLOW_S)


@jit
def turning_time_s(s: Run, m: Memory) -> float:
    """Time within which friction turns the slowest vertex whose direction follows its velocity, s; infinite if there is none."""
    if s.mode not in (FLAT_SLIDE, EDGE_SLIDE, VERTEX_SLIDE) or not s.friction_kinetic > 0.0:
        return math.inf
    rows, least_m_s = axes(m.y), math.inf
    vertex_velocities(s, m, m.y)
    for i in touched(s, m):
        x = to_table(rows, row3(m.u, i))
        least_m_s = min(least_m_s, math.sqrt(x[0] * x[0] + x[1] * x[1]))
    return max(least_m_s, s.still_m_s) / (s.friction_kinetic * s.gravity_m_s2)


@jit
def _level(m: Memory, rows: tuple[Vector, Vector, Vector], i: int, change: Floats) -> Vector:
    """V: change of the level motion (velocities of vertex i along x and y, yaw) with that of the state, from the present one."""
    spin, arm = vector(m.y, 10), row3(m.at, i)
    # Where the body turns its vertices' velocities do, though its own velocities stay: without that the slow motion is not seen.
    w, axis, turned = m.y[3], vector(m.y, 4), vector(change, 4)
    turn = minus(minus(times(2.0 * w, turned), times(2.0 * change[3], axis)), times(2.0, cross(axis, turned)))
    more = vector(change, 10)
    x = plus(vector(change, 7), to_table(rows, plus(cross(more, arm), cross(turn, cross(spin, arm)))))
    return x[0], x[1], dot(rows[2], plus(more, cross(turn, spin)))


@jit
def bend(s: Run, m: Memory, turning_s: float) -> None:
    """Write U and V U at the present state, by differences."""
    rows, first = axes(m.y), m.touch[0]
    speed, reach = BENT * turning_s * s.friction_kinetic * s.gravity_m_s2, 0.0
    for i in touched(s, m):
        for c in range(3):
            reach = max(reach, abs(m.at[i, c] - m.at[first, c]))
    rates(s, m, m.y, s.time_s, m.k1[0])
    for c in range(3):
        small = speed if c < 2 else speed / max(reach, math.sqrt(dot(row3(m.at, first), row3(m.at, first))))
        m.bent[c] = small
        rates(s, m, m.y, s.time_s, m.k1[1])
        m.bent[c] = 0.0
        for i in range(STATE):
            m.gain[c, i] = (m.k1[1, i] - m.k1[0, i]) / small
        x = _level(m, rows, first, m.gain[c])
        for i in range(3):
            m.returned[i, c] = x[i]


@inlined
def _inverse(m: Memory, h: float) -> tuple[Vector, Vector, Vector]:
    """Rows of (1 − h V U)⁻¹: those of the adjugate are cross products of the columns."""
    a = (1.0 - h * m.returned[0, 0], -h * m.returned[1, 0], -h * m.returned[2, 0])
    b = (-h * m.returned[0, 1], 1.0 - h * m.returned[1, 1], -h * m.returned[2, 1])
    c = (-h * m.returned[0, 2], -h * m.returned[1, 2], 1.0 - h * m.returned[2, 2])
    bc = cross(b, c)
    share = 1.0 / dot(a, bc)
    return times(share, bc), times(share, cross(c, a)), times(share, cross(a, b))


@jit
def slow_step(s: Run, m: Memory, h: float, out: Floats) -> float:
    """A step of length h from the present state, U and V U being there; its error over what is allowed."""
    rows, first, order = axes(m.y), m.touch[0], extrapolations(s)
    for j in range(order):
        parts = FIRST + j
        dt = h / parts
        inverse = _inverse(m, dt)
        # Changes, not states, are extrapolated: the weights raise rounding, here that of what is small.
        m.table[j, :] = 0.0
        for n in range(parts):
            for i in range(STATE):
                m.ys[i] = m.y[i] + m.table[j, i]
            rates(s, m, m.ys, s.time_s + (n + 1) * dt, m.k1[1])
            x = _level(m, rows, first, m.k1[1])
            q = (dot(inverse[0], x), dot(inverse[1], x), dot(inverse[2], x))
            for i in range(STATE):
                back = m.gain[0, i] * q[0] + m.gain[1, i] * q[1] + m.gain[2, i] * q[2]
                m.table[j, i] += dt * (m.k1[1, i] + dt * back)
        for k in range(j - 1, -1, -1):
            share = 1.0 / (parts / (FIRST + k) - 1.0)
            for i in range(STATE):
                m.table[k, i] = m.table[k + 1, i] + share * (m.table[k + 1, i] - m.table[k, i])
    total = 0.0
    for i in range(STATE):
        out[i] = m.y[i] + m.table[0, i]
        scale = s.energy_scale_j if i >= STATE - 2 else 1.0 + max(abs(m.y[i]), abs(out[i]))
        total += ((m.table[0, i] - m.table[1, i]) / (max(s.tolerance, FINEST) * scale)) ** 2
    return math.sqrt(total / STATE)
