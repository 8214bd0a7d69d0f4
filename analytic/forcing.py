"""Floor motions as the compiled kernel sees them: one row of numbers, and exact Taylor coefficients of any order.

A motion is smooth between its breaks; ``seg`` counts the breaks already passed. To add a motion: a code in
``analytic.layout``, a branch in ``encode``, ``break_at`` and ``coefficients``.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from analytic._jit import jit
from analytic.errors import AnalyticInputError
from analytic.excitation import Excitation, Harmonic, Pulse, Record, Rest
from analytic.layout import (
    AMPLITUDE,
    COSINE,
    END,
    HARMONIC,
    INVERSE,
    KIND,
    N_FORCING,
    NONE,
    OMEGA,
    PHASE,
    RAMP,
    RECTANGULAR,
    RICKER,
    SAMPLED,
    SCALE,
    SINE,
    START,
    Floats,
)

_PULSES: Final = {"rectangular": RECTANGULAR, "one_sine": SINE, "one_cosine": COSINE, "ricker": RICKER}


def encode(motion: Excitation) -> tuple[Floats, Floats, Floats]:
    """The motion's row of numbers (8,), and its samples' times (n,) and accelerations (n,), empty unless it is a record.

    Raises AnalyticInputError for a motion that the kernel does not know.
    """
    row, empty = np.zeros(N_FORCING), np.empty(0)
    if isinstance(motion, Rest) or motion.peak_m_s2 == 0.0:
        return row, empty, empty
    row[AMPLITUDE], row[SCALE] = motion.peak_m_s2, 1.0
    if isinstance(motion, Harmonic):
        row[:5] = HARMONIC, motion.amplitude_m_s2, motion.omega_rad_s, motion.phase_rad, motion.ramp_s
    elif isinstance(motion, Pulse):
        row[:4] = _PULSES[motion.shape], motion.amplitude_m_s2, motion.omega_rad_s, 0.0
        row[START], row[END] = motion.start_s, motion.end_s
    elif isinstance(motion, Record):
        row[KIND] = SAMPLED
        # Copies: a read-only array is another type, for which the whole kernel would be compiled again.
        return row, np.array(motion.t_s), np.array(motion.samples_m_s2)
    else:
        known = "Rest, Harmonic, Pulse or Record"
        raise AnalyticInputError(f"motion: {known} is wanted, {type(motion).__name__} came: sample it into a Record.")
    return row, empty, empty


@jit
def break_at(f: Floats, t: Floats, seg: int) -> float:
    """Time of break number seg, s; infinite after the last."""
    kind = int(f[KIND])
    if kind == SAMPLED:
        return float(t[seg]) if seg < t.size else math.inf
    if kind == HARMONIC:
        return float(f[RAMP]) if seg == 0 and f[RAMP] > 0.0 else math.inf
    if kind == NONE or seg > 1:
        return math.inf
    return float(f[START] if seg == 0 else f[END])


@jit
def is_jump(f: Floats, t: Floats, seg: int) -> bool:
    """Whether a itself may jump at the break after which seg breaks are passed."""
    kind = int(f[KIND])
    return kind != HARMONIC and (kind != SAMPLED or seg == 1 or seg == t.size)


@jit
def is_over(f: Floats, t: Floats, seg: int) -> bool:
    """Whether the motion is exactly zero from break seg on."""
    kind = int(f[KIND])
    if kind == SAMPLED:
        return seg >= t.size
    return kind == NONE or (kind != HARMONIC and seg >= 2)


@jit
def sampled_at(f: Floats, t: Floats, a: Floats, seg: int, time: float) -> float:
    """A record's acceleration at a time within segment seg; the sample itself at its own time."""
    if seg < 1 or seg >= t.size:
        return 0.0
    since = time - t[seg - 1]
    return float(f[SCALE] * (a[seg - 1] + (a[seg] - a[seg - 1]) / (t[seg] - t[seg - 1]) * since))


@jit
def _oscillation(w: Floats, row: int, n: int, amplitude: float, omega: float, sine: float, cosine: float) -> None:
    """amplitude sin(ωτ + φ) with sine = sin φ, cosine = cos φ."""
    power = amplitude
    for k in range(n + 1):
        turn = k % 4
        part = sine if turn % 2 == 0 else cosine
        w[row, k] = power * part if turn < 2 else -(power * part)
        power *= omega * INVERSE[k + 1]


@jit
def _ricker(w: Floats, row: int, n: int, amplitude: float, omega: float, xi: float) -> None:
    """amplitude (1 − w²ξ²) exp(−w²ξ²/2) about ξ."""
    w2 = omega * omega
    e0, e1, e2 = amplitude * math.exp(-0.5 * w2 * xi * xi), 0.0, 0.0
    for k in range(n + 1):
        w[row, k] = (1.0 - w2 * xi * xi) * e0 - 2.0 * w2 * xi * e1 - w2 * e2
        e0, e1, e2 = -w2 * (xi * e0 + e1) / (k + 1), e0, e1


@jit
def coefficients(f: Floats, t: Floats, a: Floats, seg: int, time: float, w: Floats, row: int, n: int) -> int:
    """Write the Taylor coefficients w[row, 0..n] of the acceleration about time, within segment seg; return the degree."""
    kind = int(f[KIND])
    for k in range(n + 1):
        w[row, k] = 0.0
    if kind == SAMPLED:
        if seg < 1 or seg >= t.size:
            return 0
        w[row, 0] = sampled_at(f, t, a, seg, time)
        w[row, 1] = f[SCALE] * (a[seg] - a[seg - 1]) / (t[seg] - t[seg - 1])
        return 1
    if kind == NONE or (kind != HARMONIC and seg != 1):
        return 0
    if kind == RECTANGULAR:
        w[row, 0] = f[AMPLITUDE]
        return 0
    since = time - f[START]
    if kind == RICKER:
        _ricker(w, row, n, f[AMPLITUDE], f[OMEGA], since - 0.5 * (f[END] - f[START]))
        return n
    angle = f[OMEGA] * since + f[PHASE]
    if kind == COSINE:
        _oscillation(w, row, n, f[AMPLITUDE], f[OMEGA], math.cos(angle), -math.sin(angle))
        return n
    _oscillation(w, row, n, f[AMPLITUDE], f[OMEGA], math.sin(angle), math.cos(angle))
    if kind == HARMONIC and seg == 0 and f[RAMP] > 0.0:
        for k in range(n, 0, -1):
            w[row, k] = (w[row, k] * since + w[row, k - 1]) / f[RAMP]
        w[row, 0] = w[row, 0] * since / f[RAMP]
    return n
