"""Restitution: what an impact gives back of the normal velocities of the vertices that strike.

After it every vertex' normal velocity is at least −e times that before, and just that where its impulse pushes; friction goes by
the tangential velocity after it (Moreau's law). That is the plastic impact of a body whose vertices come down 1 + e times as fast
and slide as they do. As all of them lie in one level plane that is a velocity of a rigid body again.
"""

from __future__ import annotations

import math
from typing import Final

from analytic.kernel.compiler import jit
from analytic.spatial.kernel.choose import choose
from analytic.spatial.kernel.contact import Rows, vertex_velocities
from analytic.spatial.kernel.records import Memory, Run
from analytic.spatial.kernel.vectors import Vector, apply, dot, plus, put, row3, times, to_body, to_table, vector

LEAST_RISE_M: Final = 1e-6
"""An impact after which no vertex would rise higher is plastic: bounces that die out come to an end."""
GAIN: Final = 1e-9
"""Share of the kinetic energy by which it may grow: what solving for the impulses leaves open."""


@jit
def strike(s: Run, m: Memory, rows: Rows, size: float) -> tuple[bool, bool]:
    """Set the impulses and the mode of an impact: whether there are any, and whether they give something back.

    Plastic where too little would come back to be seen, and where a friction that turns a vertex round would add energy.
    """
    v0, w0 = vector(m.y, 7), vector(m.y, 10)
    if s.restitution > 0.0:
        deepest = 0.0
        for k in range(s.touching):
            deepest = min(deepest, dot(rows[2], row3(m.u, m.touch[k])))
        if s.restitution * -deepest > math.sqrt(2.0 * s.gravity_m_s2 * LEAST_RISE_M):
            _come_faster(s, m, rows, v0, w0)
            vertex_velocities(s, m, m.y)
            returns = choose(s, m, rows, to_body(rows, vector(m.y, 7)), True, (1.0 + s.restitution) * size)
            put(m.y, 7, v0)
            put(m.y, 10, w0)
            if returns and not _gains(s, m, to_body(rows, v0), w0):
                return True, True
            # The plastic impact is chosen by what the vertices really do, and the trial left its own in memory.
            vertex_velocities(s, m, m.y)
    return choose(s, m, rows, to_body(rows, v0), True, size), False


@jit
def _come_faster(s: Run, m: Memory, rows: Rows, v0: Vector, w0: Vector) -> None:
    """Give the body the velocity with which what touches comes down 1 + e times as fast and slides as it does."""
    spin, z, e = to_table(rows, w0), to_table(rows, row3(m.at, m.touch[0]))[2], s.restitution
    put(m.y, 7, plus(v0, (-e * spin[1] * z, e * spin[0] * z, e * v0[2])))
    put(m.y, 10, plus(w0, to_body(rows, (e * spin[0], e * spin[1], 0.0))))


@jit
def _gains(s: Run, m: Memory, v0: Vector, w0: Vector) -> bool:
    """Whether the impulses in memory would add kinetic energy (velocities in the body's frame)."""
    dv, dw = vector(m.response, 0), vector(m.response, 3)
    before = s.mass_kg * dot(v0, v0) + dot(w0, apply(m.inertia, w0))
    half_v, half_w = plus(v0, times(0.5, dv)), plus(w0, times(0.5, dw))
    gained: float = 2.0 * (s.mass_kg * dot(half_v, dv) + dot(half_w, apply(m.inertia, dw)))
    return gained > GAIN * before
