"""The floor's acceleration at any time between two of its breaks."""

from __future__ import annotations

import math

from analytic.kernel.codes import COSINE, HARMONIC, NONE, RECTANGULAR, RICKER, SAMPLED
from analytic.kernel.compiler import jit
from analytic.kernel.memory import load_double
from analytic.spatial.kernel.records import Memory, Run
from analytic.spatial.kernel.vectors import Vector


@jit
def accel(m: Memory, axis: int, t: float) -> float:
    """Acceleration along an axis, m/s², by the formula of the stretch between the breaks passed and to come."""
    kind, passed = m.kinds[axis], m.passed[axis]
    amplitude: float = m.motion[axis, 0]
    if kind == NONE:
        return 0.0
    if kind == SAMPLED:
        i = m.first[axis] + passed
        # A record is at rest before its first sample and after its last.
        if passed < 1 or i >= m.first[axis + 1]:
            return 0.0
        start, first = load_double(m.times, i - 1), load_double(m.samples, i - 1)
        share = (t - start) / (load_double(m.times, i) - start)
        return amplitude * (first + share * (load_double(m.samples, i) - first))
    omega: float = m.motion[axis, 1]
    start = m.motion[axis, 4]
    if kind == HARMONIC:
        ramp: float = m.motion[axis, 3]
        value = amplitude * math.sin(omega * t + m.motion[axis, 2])
        return value * t / ramp if ramp > 0.0 and passed == 0 else value
    if passed != 1:
        return 0.0
    if kind == RECTANGULAR:
        return amplitude
    since = t - start
    if kind == RICKER:
        w: float = (omega * (since - 0.5 * (m.motion[axis, 5] - start))) ** 2
        return amplitude * (1.0 - w) * math.exp(-0.5 * w)
    return amplitude * (math.cos(omega * since) if kind == COSINE else math.sin(omega * since))


@jit
def field(s: Run, m: Memory, t: float) -> Vector:
    """g_e = (−a_x, −a_y, −g − a_z), table's frame, m/s²."""
    return -accel(m, 0, t), -accel(m, 1, t), -s.gravity_m_s2 - accel(m, 2, t)


@jit
def next_break_s(m: Memory, axis: int) -> float:
    """Time of an axis' next break, s; infinite after the last."""
    kind, passed = m.kinds[axis], m.passed[axis]
    if kind == NONE:
        return math.inf
    if kind == SAMPLED:
        i = m.first[axis] + passed
        return load_double(m.times, i) if i < m.first[axis + 1] else math.inf
    if kind == HARMONIC:
        ramp = m.motion[axis, 3]
        return ramp if passed == 0 and ramp > 0.0 else math.inf
    return m.motion[axis, 4 + passed] if passed < 2 else math.inf


@jit
def pass_breaks(s: Run, m: Memory) -> None:
    """Pass the breaks up to now, and note how far the motions are smooth."""
    s.limit_s = s.duration_s
    for axis in range(3):
        while next_break_s(m, axis) <= s.time_s:
            m.passed[axis] += 1
        s.limit_s = min(s.limit_s, next_break_s(m, axis))


@jit
def is_over(m: Memory) -> bool:
    """Whether the floor is at rest from now on."""
    for axis in range(3):
        kind, passed = m.kinds[axis], m.passed[axis]
        if kind == HARMONIC:
            return False
        if kind == SAMPLED and m.first[axis] + passed < m.first[axis + 1]:
            return False
        if kind not in (NONE, SAMPLED) and passed < 2:
            return False
    return True
