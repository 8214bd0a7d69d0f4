"""Steps of order eight in one mode, and the mode that follows where a sign of it vanishes."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from scipy.integrate import DOP853

from analytic.kernel.compiler import jit
from analytic.kernel.records import Floats
from analytic.spatial.kernel.impact import decide, enter, find_mode
from analytic.spatial.kernel.rates import rates
from analytic.spatial.kernel.records import STATE, WORK, Memory, Run
from analytic.spatial.kernel.slow import slow_step, turning_time_s

# The coefficients of DOP853: an explicit Runge-Kutta step of order 8 with errors of order 5 and 3 inside
# it.
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
