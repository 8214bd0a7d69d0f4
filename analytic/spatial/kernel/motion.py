"""The floor's acceleration as a body in space feels it, and the breaks of its three components."""

from __future__ import annotations

from analytic.kernel.compiler import jit
from analytic.kernel.forcing import acceleration, is_over, next_break_s
from analytic.spatial.kernel.records import Memory, Run
from analytic.spatial.kernel.vectors import Vector


@jit
def field(s: Run, m: Memory, t: float) -> Vector:
    """g_e = (−a_x, −a_y, −g − a_z), table's frame, m/s²."""
    x, y, z = acceleration(m.motions[0], t), acceleration(m.motions[1], t), acceleration(m.motions[2], t)
    return -x, -y, -s.gravity_m_s2 - z


@jit
def pass_breaks(s: Run, m: Memory) -> None:
    """Pass the breaks up to now, and note how far the motions are smooth."""
    s.limit_s = s.duration_s
    for axis in range(3):
        motion = m.motions[axis]
        while next_break_s(motion) <= s.time_s:
            motion.breaks_passed += 1
        s.limit_s = min(s.limit_s, next_break_s(motion))


@jit
def all_over(m: Memory) -> bool:
    """Whether the floor is at rest from now on."""
    return is_over(m.motions[0]) and is_over(m.motions[1]) and is_over(m.motions[2])
