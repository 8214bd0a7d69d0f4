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


def peak_velocity_m_s(series: Series) -> float:
    """Largest |velocity|, m/s, also between samples, where the straight line of the acceleration crosses zero."""
    accel, velocity = series.accel_m_s2, velocity_m_s(series)
    crossing = np.flatnonzero(accel[:-1] * accel[1:] < 0.0)
    start, end = accel[crossing], accel[crossing + 1]
    between = velocity[crossing] + 0.5 * start**2 / (start - end) * series.dt_s
    return float(np.abs(np.concatenate([velocity, between])).max())


def measures(series: Series) -> Measures:
    """All of them; integrals by the trapezium rule, instants of the Arias intensity interpolated."""
    accel, velocity, displacement = series.accel_m_s2, velocity_m_s(series), displacement_m(series)
    squares, sizes = accel**2, np.abs(accel)
    integral = float((0.5 * (squares[1:] + squares[:-1])).sum()) * series.dt_s
    begin, strong, end = np.interp((0.05, 0.75, 0.95), arias_share(squares), series.t_s).tolist()
    above = np.flatnonzero(sizes >= BRACKET_G * STANDARD_GRAVITY_M_S2)
    pga, pgv = float(sizes.max()), peak_velocity_m_s(series)
    return Measures(
        pga_g=pga / STANDARD_GRAVITY_M_S2,
        pgv_m_s=pgv,
        pgd_m=float(np.abs(displacement).max()),
        pgv_to_pga_s=pgv / pga,
        arias_m_s=0.5 * math.pi / STANDARD_GRAVITY_M_S2 * integral,
        significant_5_95_s=end - begin,
        significant_5_75_s=strong - begin,
        bracketed_s=float((above[-1] - above[0]) * series.dt_s) if above.size else 0.0,
        end_velocity_m_s=float(velocity[-1]),
        end_displacement_m=float(displacement[-1]),
    )
