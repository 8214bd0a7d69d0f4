"""Intensity measures of one history: peaks, Arias intensity and its build-up, durations."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from harness.input.motions.recordfile import STANDARD_GRAVITY_M_S2
from harness.input.motions.series import Floats, Series, displacement_m, velocity_m_s

BRACKET_G: Final = 0.05
"""Threshold of the bracketed duration (Bolt 1973)."""


@dataclass(frozen=True)
class Measures:
    """PGA (g), PGV (m/s), PGD (m), PGV/PGA (s), Arias intensity (m/s), durations (s) and what remains at the end."""

    pga_g: float
    pgv_m_s: float
    pgd_m: float
    pgv_to_pga_s: float
    arias_m_s: float
    significant_5_95_s: float
    significant_5_75_s: float
    bracketed_s: float
    end_velocity_m_s: float
    end_displacement_m: float


def arias_share(squares: Floats) -> Floats:
    """Share of the integral of `squares` (n,) (trapezium rule) gathered at every sample (n,), from 0 to 1."""
    gathered = np.concatenate([[0.0], np.cumsum(0.5 * (squares[1:] + squares[:-1]))])
    return np.asarray(gathered / gathered[-1])


def arias_m_s(series: Series) -> float:
    """Arias intensity π/(2g) ∫a² dt, m/s, by the trapezium rule."""
    squares = series.accel_m_s2**2
    integral = float((0.5 * (squares[1:] + squares[:-1])).sum()) * series.dt_s
    return 0.5 * math.pi / STANDARD_GRAVITY_M_S2 * integral


def peak_velocity_m_s(series: Series) -> float:
    """Largest |velocity|, m/s, also between samples, where the straight line of the acceleration crosses zero."""
    accel, velocity = series.accel_m_s2, velocity_m_s(series)
    crossing = np.flatnonzero(accel[:-1] * accel[1:] < 0.0)
    start, end = accel[crossing], accel[crossing + 1]
    between = velocity[crossing] + 0.5 * start**2 / (start - end) * series.dt_s
    return float(np.abs(np.concatenate([velocity, between])).max())


def significant_s(series: Series, low: float, high: float) -> float:
    """Time in which the Arias intensity grows from the share `low` to the share `high`, s, interpolated."""
    build, t_s = arias_share(series.accel_m_s2**2), series.t_s
    return float(np.interp(high, build, t_s) - np.interp(low, build, t_s))


def bracketed_s(series: Series) -> float:
    """Time from the first to the last sample above BRACKET_G, s."""
    above = np.flatnonzero(np.abs(series.accel_m_s2) >= BRACKET_G * STANDARD_GRAVITY_M_S2)
    return float((above[-1] - above[0]) * series.dt_s) if above.size else 0.0


def measures(series: Series) -> Measures:
    """All of them."""
    velocity, displacement = velocity_m_s(series), displacement_m(series)
    pga = float(np.abs(series.accel_m_s2).max())
    pgv = peak_velocity_m_s(series)
    return Measures(
        pga / STANDARD_GRAVITY_M_S2,
        pgv,
        float(np.abs(displacement).max()),
        pgv / pga,
        arias_m_s(series),
        significant_s(series, 0.05, 0.95),
        significant_s(series, 0.05, 0.75),
        bracketed_s(series),
        float(velocity[-1]),
        float(displacement[-1]),
    )
