"""Steps in one mode, of order eight or implicit for slow sliding, and the mode that follows where a sign of it vanishes."""

import math
from typing import Final

import numpy as np
from scipy.integrate import DOP853

from analytic.kernel.compiler import inlined, jit
from analytic.kernel.records import Floats
from analytic.spatial.kernel.contact import vertex_velocities
from analytic.spatial.kernel.impact import decide, enter, find_mode
from analytic.spatial.kernel.motion import rates
from analytic.spatial.kernel.records import EDGE_SLIDE, FLAT_SLIDE, STATE, VERTEX_SLIDE, WORK, Memory, Run
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

# Steps of slow sliding, implicit in what is stiff there.
#
# Friction turns a vertex that slides with v within |v|/(μ g), far faster than anything else moves; an explicit step spans only
# some of these times. The linearly implicit Euler step with any matrix J has an expansion in its length, and is extrapolated
# (Hairer and Wanner, Solving Ordinary Differential Equations II, IV.9). Here J = U V has rank three: V is what the level motion
# of what touches (two velocities of its first vertex, and yaw) changes with the state, U what the rates change with it as
# vertices turn.


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


# The coefficients of DOP853: an explicit Runge-Kutta step of order 8 with errors of order 5 and 3 inside it.
#
# Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I, 2nd ed., section II.10.


STAGES: Final = 12
"""Evaluations of a step; the next step's first is one more."""
C: Final[Floats] = DOP853.C[:STAGES].copy()
"""Places of the stages in the step."""
# Contiguous, as compiled code reads them; scipy keeps those of its dense output in the same table.
A: Final[Floats] = np.ascontiguousarray(DOP853.A[:STAGES, :STAGES])
"""What each stage takes of those before it."""
B: Final[Floats] = DOP853.B.copy()
"""What the step takes of its stages."""
# Scipy's weights have one more, of the next step's first stage, which is nought.
E3: Final[Floats] = DOP853.E3[:STAGES].copy()
"""Weights of the error of order 3, and"""
E5: Final[Floats] = DOP853.E5[:STAGES].copy()
"""of order 5."""

SAME_INSTANT_S: Final = 1e-13
"""Width to which an event is located."""
LATER_S: Final = 1e-6
"""A mode whose own sign vanishes is followed by one chosen this much later, where the sign is strictly lost: at the very limit
the successors are borderline too, and one that is impossible an instant later may pass. Far above what an event is located to,
far below the motion's times."""


LEAST_LATER_S: Final = 1e-9
"""Shortest such moment: a sign that is lost more slowly than in this is not told from rounding."""
SOON: Final = 0.1
"""Share of the time within which friction turns a slow vertex that counts as a moment."""


@jit
def stages(s: Run, m: Memory, k: Floats, h: float, out: Floats) -> None:
    """A step of length h from the present state, its first stage being there."""
    for i in range(1, STAGES):
        for c in range(STATE):
            total = 0.0
            for j in range(i):
                total += A[i, j] * k[j, c]
            m.ys[c] = m.y[c] + h * total
        rates(s, m, m.ys, s.time_s + C[i] * h, k[i])
    for c in range(STATE):
        total = 0.0
        for j in range(STAGES):
            total += B[j] * k[j, c]
        out[c] = m.y[c] + h * total


@jit
def error(s: Run, m: Memory, h: float) -> float:
    """The step's error over what is allowed (Hairer, Nørsett and Wanner, equation 10.17)."""
    fine, coarse = 0.0, 0.0
    for c in range(STATE):
        e3, e5 = 0.0, 0.0
        for j in range(STAGES):
            e3, e5 = e3 + E3[j] * m.k[j, c], e5 + E5[j] * m.k[j, c]
        allowed = s.tolerance * (s.energy_scale_j if c >= WORK else 1.0 + max(abs(m.y[c]), abs(m.y1[c])))
        fine, coarse = fine + (e5 / allowed) ** 2, coarse + (e3 / allowed) ** 2
    if fine == 0.0 and coarse == 0.0:
        return 0.0
    return h * fine / math.sqrt((fine + 0.01 * coarse) * STATE)


@jit
def part(s: Run, m: Memory, h: float, out: Floats) -> None:
    """The state at a part of the present step, by a step of its own."""
    if s.slow:
        slow_step(s, m, h, out)
        return
    m.k1[0] = m.k[0]
    stages(s, m, m.k1, h, out)


@jit
def succeed(s: Run, m: Memory) -> None:
    """Choose the mode after one whose own sign has vanished continuously, by its state a moment later."""
    # A slow vertex must not turn or stop within that moment.
    s.slow, turning_s = False, turning_time_s(s, m)
    later_s = min(LATER_S, max(SOON * turning_s, LEAST_LATER_S))
    rates(s, m, m.y, s.time_s, m.k1[0])
    stages(s, m, m.k1, later_s, m.y2)
    now_s, mode, a, b = s.time_s, s.mode, s.a, s.b
    m.y1[:] = m.y
    m.y[:] = m.y2
    s.time_s = now_s + later_s
    possible = find_mode(s, m, s.still_m_s)
    # The same mode a moment later: only the smoothed friction of slow vertices had lost a sign, and it goes on from there.
    same = possible and s.mode == mode and s.a == a and s.b == b
    sampled = s.output_step_s > 0.0 and s.samples * s.output_step_s <= s.time_s
    if not same or sampled or s.time_s >= s.limit_s:
        s.time_s = now_s
        m.y[:] = m.y1
    if possible:
        enter(s, m)
    else:
        decide(s, m, 0.0)
