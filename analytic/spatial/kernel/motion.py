"""The floor's acceleration at any time between two of its breaks."""

from __future__ import annotations

import math

from analytic.kernel.codes import COSINE, HARMONIC, NONE, RECTANGULAR, RICKER, SAMPLED
from analytic.kernel.compiler import jit
from analytic.kernel.forcing import is_over, next_break_s
from analytic.kernel.memory import load_double
from analytic.spatial.kernel.records import Memory, Run
from analytic.spatial.kernel.vectors import Vector


@jit
def accel(m: Memory, axis: int, t: float) -> float:
    """Acceleration of one component, m/s², by the formula of the stretch between the breaks passed and to come."""
    motion = m.motions[axis]
    p, kind, passed = motion.params, motion.params.kind, motion.breaks_passed
    if kind == NONE:
        return 0.0
    if kind == SAMPLED:
        # A record is at rest before its first sample and after its last.
        if passed < 1 or passed >= p.n_samples:
            return 0.0
        start, first = load_double(p.times, passed - 1), load_double(p.samples, passed - 1)
        share = (t - start) / (load_double(p.times, passed) - start)
        return p.scale * (first + share * (load_double(p.samples, passed) - first))
    if kind == HARMONIC:
        value = p.amplitude_m_s2 * math.sin(p.omega_rad_s * t + p.phase_rad)
        return value * t / p.ramp_s if p.ramp_s > 0.0 and passed == 0 else value
    if passed != 1:
        return 0.0
    if kind == RECTANGULAR:
        return p.amplitude_m_s2
    since = t - p.start_s
    if kind == RICKER:
        w = (p.omega_rad_s * (since - 0.5 * (p.end_s - p.start_s))) ** 2
        return p.amplitude_m_s2 * (1.0 - w) * math.exp(-0.5 * w)
    return p.amplitude_m_s2 * (math.cos(p.omega_rad_s * since) if kind == COSINE else math.sin(p.omega_rad_s * since))


@jit
def field(s: Run, m: Memory, t: float) -> Vector:
    """g_e = (−a_x, −a_y, −g − a_z), table's frame, m/s²."""
    return -accel(m, 0, t), -accel(m, 1, t), -s.gravity_m_s2 - accel(m, 2, t)


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
