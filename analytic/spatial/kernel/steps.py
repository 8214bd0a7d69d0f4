"""Steps of order eight in one mode, and the mode that follows where a sign of it vanishes."""

from __future__ import annotations

import math
from typing import Final

from analytic.kernel.compiler import jit
from analytic.kernel.records import Floats
from analytic.spatial.kernel.codes import EDGE_SLIDE, FLAT_SLIDE, VERTEX_SLIDE
from analytic.spatial.kernel.contact import vertex_velocities
from analytic.spatial.kernel.impact import decide, enter, find_mode
from analytic.spatial.kernel.rates import rates
from analytic.spatial.kernel.records import STATE, Memory, Run
from analytic.spatial.kernel.tableau import E3, E5, STAGES, A, B, C
from analytic.spatial.kernel.vectors import axes, row3, to_table

DYNAMIC: Final = 13
"""Items of the state that the error counts: all but the balance of energy."""
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
    for c in range(DYNAMIC):
        e3, e5 = 0.0, 0.0
        for j in range(STAGES):
            e3, e5 = e3 + E3[j] * m.k[j, c], e5 + E5[j] * m.k[j, c]
        allowed = s.tolerance * (1.0 + max(abs(m.y[c]), abs(m.y1[c])))
        fine, coarse = fine + (e5 / allowed) ** 2, coarse + (e3 / allowed) ** 2
    if fine == 0.0 and coarse == 0.0:
        return 0.0
    return h * fine / math.sqrt((fine + 0.01 * coarse) * DYNAMIC)


@jit
def part(s: Run, m: Memory, h: float, out: Floats) -> None:
    """The state at a part of the present step, by a step of its own."""
    m.k1[0] = m.k[0]
    stages(s, m, m.k1, h, out)


@jit
def turning_time_s(s: Run, m: Memory) -> float:
    """Time within which friction turns the slowest vertex whose direction follows its velocity, s; infinite if there is none."""
    if s.mode not in (FLAT_SLIDE, EDGE_SLIDE, VERTEX_SLIDE) or not s.friction_kinetic > 0.0:
        return math.inf
    rows, least_m_s = axes(m.y), math.inf
    vertex_velocities(s, m, m.y)
    for k in range(s.touching):
        x = to_table(rows, row3(m.u, m.touch[k]))
        least_m_s = min(least_m_s, math.sqrt(x[0] * x[0] + x[1] * x[1]))
    return max(least_m_s, s.still_m_s) / (s.friction_kinetic * s.gravity_m_s2)


@jit
def succeed(s: Run, m: Memory) -> None:
    """Choose the mode after one whose own sign has vanished continuously, by its state a moment later."""
    # A slow vertex must not turn or stop within that moment.
    turning_s = turning_time_s(s, m)
    later_s = min(LATER_S, max(SOON * turning_s, LEAST_LATER_S))
    rates(s, m, m.y, s.time_s, m.k1[0])
    stages(s, m, m.k1, later_s, m.y2)
    now_s = s.time_s
    m.y1[:] = m.y
    m.y[:] = m.y2
    s.time_s = now_s + later_s
    possible = find_mode(s, m, s.still_m_s)
    s.time_s = now_s
    m.y[:] = m.y1
    if possible:
        enter(s, m)
    else:
        decide(s, m)
