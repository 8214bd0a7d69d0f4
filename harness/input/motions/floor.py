"""The building's filter: the acceleration of a floor from that of the ground, by one or several oscillators.

a_floor = (1 − Σφᵢ) a + Σ φᵢ (q̈ᵢ + a), with qᵢ the i-th mode's relative displacement and φᵢ its share (participation factor
times shape at the floor): docs/motions.md, "The building's filter".
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from analytic.excitation import Excitation, SampledAcceleration
from harness.input.motions.oscillator import exact_step
from harness.input.motions.series import Floats
from harness.input.motions.spec import Oscillator

POINTS_PER_PERIOD: Final = 70
"""Samples in the shortest period: straight lines miss a sine by at most (2π/70)²/8 = 0.1 % of its amplitude."""
RING_DOWN: Final = 1e-3
"""The floor is followed until its slowest mode has decayed to this share."""
_JUMP_S = 1e-9
"""A jump of the floor's acceleration (Σφ ≠ 1 under a pulse) is drawn over this time."""


def ring_down_s(modes: Sequence[Oscillator]) -> float:
    """Time in which the slowest mode decays to RING_DOWN after the ground has stopped, s."""
    return max(-math.log(RING_DOWN) * mode.period_s / (2.0 * math.pi * mode.damping) for mode in modes)


def floor_motion(ground: Excitation, modes: Sequence[Oscillator], until_s: float) -> SampledAcceleration:
    """The floor's acceleration from 0 to `until_s`, sampled so finely that straight lines between samples hold.

    Exact at the samples for grounds of straight lines (records, rectangular pulses).
    """
    shortest = min(mode.period_s for mode in modes)
    t_s, before, after = _nodes(ground, shortest / POINTS_PER_PERIOD, until_s)
    rigid = 1.0 - sum(mode.share for mode in modes)
    moving = np.zeros(t_s.size)
    for mode in modes:
        moving += mode.share * _absolute(t_s, before, after, mode)
    return _drawn(t_s, rigid * before + moving, rigid * after + moving)


def _nodes(ground: Excitation, longest_step_s: float, until_s: float) -> tuple[Floats, Floats, Floats]:
    """Times that hold every break of the ground, and its acceleration just before and just after each."""
    breaks = np.concatenate([[0.0], ground.breaks_s(until_s), [until_s]])
    if ground.end_s < until_s:
        breaks = np.append(breaks, ground.end_s)
    breaks = np.unique(breaks)
    pieces = [
        np.linspace(
            start, end, max(1, math.ceil((end - start) / _harmonic_step(ground, longest_step_s))), endpoint=False
        )
        for start, end in zip(breaks[:-1].tolist(), breaks[1:].tolist(), strict=True)
    ]
    t_s = np.append(np.concatenate(pieces), until_s)
    gap = np.diff(t_s)
    inside = 1e-7 * np.concatenate([[gap[0]], np.minimum(gap[:-1], gap[1:]), [gap[-1]]])
    before, after = ground.accel_m_s2(np.maximum(t_s - inside, 0.0)), ground.accel_m_s2(t_s + inside)
    at = ground.accel_m_s2(t_s)
    smooth = np.abs(after - before) <= 1e-4 * max(ground.peak_m_s2, 1e-300)
    before, after = np.where(smooth, at, before), np.where(smooth, at, after)
    return t_s, before, after


def _harmonic_step(ground: Excitation, longest_step_s: float) -> float:
    """The longest step that also follows a ground which is not made of straight lines."""
    omega = getattr(ground, "omega_rad_s", 0.0)
    return min(longest_step_s, 2.0 * math.pi / omega / POINTS_PER_PERIOD) if omega > 0.0 else longest_step_s


def _absolute(t_s: Floats, before: Floats, after: Floats, mode: Oscillator) -> Floats:
    """Absolute acceleration of one oscillator at every node (n,), from rest, exact for straight lines between nodes."""
    result = np.zeros(t_s.size)
    displacement = velocity = 0.0
    steps = np.diff(t_s)
    dt_s, row = -1.0, (0.0, 0.0)
    p00 = p01 = p10 = p11 = s0 = s1 = e0 = e1 = 0.0
    for i, step_s in enumerate(steps.tolist()):
        if abs(step_s - dt_s) > 1e-12 * step_s:
            dt_s = step_s
            step = exact_step(mode.period_s, mode.damping, dt_s)
            (p00, p01), (p10, p11) = step.phi.tolist()
            (s0, s1), (e0, e1) = step.b0.tolist(), step.b1.tolist()
            row = (float(step.row_absolute[0]), float(step.row_absolute[1]))
        start, end = after[i], before[i + 1]
        displacement, velocity = (
            p00 * displacement + p01 * velocity + s0 * start + e0 * end,
            p10 * displacement + p11 * velocity + s1 * start + e1 * end,
        )
        result[i + 1] = row[0] * displacement + row[1] * velocity
    return result


def _drawn(t_s: Floats, before: Floats, after: Floats) -> SampledAcceleration:
    """A record through all nodes, its jumps drawn over _JUMP_S."""
    jumps = np.flatnonzero(np.abs(after - before) > 0.0)
    jumps = jumps[(jumps > 0) & (jumps < t_s.size - 1)]
    times = np.insert(t_s, jumps, t_s[jumps] - _JUMP_S)
    values = np.insert(after, jumps, before[jumps])
    values[-1] = before[-1]
    return SampledAcceleration(times, values)
