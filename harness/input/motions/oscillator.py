"""Linear oscillators under straight-line accelerations: exact steps, response spectra, absolute accelerations.

Relative displacement d of q̈ + 2ζω q̇ + ω² q = −a(t); Nigam and Jennings (1969) is this recurrence written out.
"""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from harness.input.motions.recordfile import Floats

POINTS_PER_PERIOD: Final = 20
"""Samples of the response in a period: the peak between two of them is missed by at most 1 − cos(π/20) = 1.2 %."""


def exact_step(period_s: float, damping: float, dt_s: float) -> tuple[Floats, Floats, Floats]:
    """The step of an oscillator of `period_s` > 0 and 0 < `damping` < 1 over `dt_s`, exact for a linear in time.

    Φ (2, 2), b₀ and b₁ (2,) of x⁺ = Φ x + b₀ a + b₁ a⁺ for x = (displacement, velocity).
    """
    w = 2.0 * math.pi / period_s
    wd = w * math.sqrt(1.0 - damping**2)
    decay, sin, cos = math.exp(-damping * w * dt_s), math.sin(wd * dt_s), math.cos(wd * dt_s)
    f = damping * w / wd
    phi = decay * np.array([[cos + f * sin, sin / wd], [-(w**2) * sin / wd, cos - f * sin]])
    system_inverse = np.array([[-2.0 * damping / w, -1.0 / w**2], [1.0, 0.0]])
    force = np.array([0.0, -1.0])
    held = system_inverse @ (phi - np.eye(2)) @ force
    ramp = system_inverse @ (held / dt_s - force)
    return phi, held - ramp, ramp


def displacement_m(accel_m_s2: Floats, dt_s: float, period_s: float, damping: float) -> Floats:
    """Relative displacement (n,) at the samples, m, from rest at the first, by the recurrence's transfer function."""
    from scipy.signal import lfilter

    (phi, b0, b1), row = exact_step(period_s, damping, dt_s), np.array([1.0, 0.0])
    trace, det = float(np.trace(phi)), float(np.linalg.det(phi))
    carry = phi - trace * np.eye(2)
    taps = np.array([row @ b1, row @ (b0 + carry @ b1), row @ carry @ b0])
    start = accel_m_s2[0] * np.array([-taps[0], row @ b0 - taps[1]])
    response, _ = lfilter(taps, [1.0, -trace, det], accel_m_s2, zi=start)
    return np.asarray(response)


def _finer(accel_m_s2: Floats, factor: int) -> Floats:
    """The same straight lines with `factor` times as many samples."""
    n = accel_m_s2.size
    return np.interp(np.arange((n - 1) * factor + 1) / factor, np.arange(n), accel_m_s2)


@dataclass(frozen=True, eq=False)
class Peaks:
    """Per period: pseudo-acceleration ω²|d| (m/s²) with the sign of −d at its peak, and the time of that peak (s)."""

    accel_m_s2: Floats
    t_s: Floats
    sign: Floats


def peaks(accel_m_s2: Floats, dt_s: float, periods_s: ArrayLike, damping: float) -> Peaks:
    """Peak responses of oscillators of `periods_s` (k,) from rest, at no fewer than POINTS_PER_PERIOD samples a period."""
    periods = np.asarray(periods_s, dtype=np.float64)
    accel, at, sign = np.empty(periods.size), np.empty(periods.size), np.empty(periods.size)
    finer: dict[int, Floats] = {}
    for i, period in enumerate(periods.tolist()):
        needed = max(1, math.ceil(POINTS_PER_PERIOD * dt_s / period - 1e-9))
        factor = 1 << (needed - 1).bit_length()
        if factor not in finer:
            finer[factor] = _finer(accel_m_s2, factor)
        samples = finer[factor]
        response = displacement_m(samples, dt_s / factor, period, damping)
        largest = int(np.argmax(np.abs(response)))
        accel[i] = abs(response[largest]) * (2.0 * math.pi / period) ** 2
        at[i], sign[i] = largest * dt_s / factor, -math.copysign(1.0, response[largest])
    return Peaks(accel, at, sign)


def spectrum_m_s2(accel_m_s2: Floats, dt_s: float, periods_s: ArrayLike, damping: float = 0.05) -> Floats:
    """Pseudo-acceleration response spectrum (k,), m/s²; the peak acceleration itself at period 0."""
    periods = np.atleast_1d(np.asarray(periods_s, dtype=np.float64))
    result = np.full(periods.size, float(np.abs(accel_m_s2).max()))
    moving = periods > 0.0
    result[moving] = peaks(accel_m_s2, dt_s, periods[moving], damping).accel_m_s2
    return result
