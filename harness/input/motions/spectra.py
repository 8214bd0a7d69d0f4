"""Elastic design spectra of NTC 2008, NTC 2018 and Eurocode 8 (EN 1998-1:2004), horizontal and vertical.

All are one shape (EN 1998-1, 3.2.2.2; NTC 3.2.3.2.1): with p the peak acceleration, A the amplification and
η = √(10/(5 + ξ)) ≥ 0.55,

    0..TB: p [1 + T/TB (η A − 1)]      TB..TC: p η A      TC..TD: p η A TC/T      from TD: p η A TC TD/T².

Horizontal: p = a_g S, A = F0 (2.5 in Eurocode 8). Vertical: docs/motions.md, "Target spectra".
"""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from harness.input.motions.recordfile import STANDARD_GRAVITY_M_S2, Floats, Series, displacement_m, velocity_m_s
from harness.input.motions.spec import Target

EC8_AMPLIFICATION: Final = 2.5
_EC8_SOILS: Final = {  # EN 1998-1 tables 3.2 and 3.3: S, TB, TC, TD
    1: {"A": (1.0, 0.15, 0.4, 2.0), "B": (1.2, 0.15, 0.5, 2.0), "C": (1.15, 0.2, 0.6, 2.0),
        "D": (1.35, 0.2, 0.8, 2.0), "E": (1.4, 0.15, 0.5, 2.0)},
    2: {"A": (1.0, 0.05, 0.25, 1.2), "B": (1.35, 0.05, 0.25, 1.2), "C": (1.5, 0.1, 0.25, 1.2),
        "D": (1.8, 0.1, 0.3, 1.2), "E": (1.6, 0.05, 0.25, 1.2)},
}  # fmt: skip
_EC8_VERTICAL: Final = {1: 0.9, 2: 0.45}  # EN 1998-1 table 3.4: a_vg/a_g; TB, TC, TD below
_EC8_VERTICAL_AMPLIFICATION: Final = 3.0
_VERTICAL_PERIODS: Final = (0.05, 0.15, 1.0)
_NTC_SS: Final = {  # NTC table 3.2.IV (2008: 3.2.V): greatest, constant, slope in F0 a_g/g, least
    "A": (1.0, 1.0, 0.0, 1.0), "B": (1.2, 1.4, 0.4, 1.0), "C": (1.5, 1.7, 0.6, 1.0),
    "D": (1.8, 2.4, 1.5, 0.9), "E": (1.6, 2.0, 1.1, 1.0),
}  # fmt: skip
_NTC_CC: Final = {"A": (1.0, 0.0), "B": (1.1, -0.2), "C": (1.05, -0.33), "D": (1.25, -0.5), "E": (1.15, -0.4)}
_LEAST_ETA = 0.55


@dataclass(frozen=True)
class DesignSpectrum:
    """Peak acceleration p (m/s²), amplification A, corner periods (s), damping (share of critical) and a name."""

    peak_m_s2: float
    amplification: float
    TB_s: float
    TC_s: float
    TD_s: float
    damping: float
    name: str

    @property
    def eta(self) -> float:
        """Damping's factor η."""
        return max(math.sqrt(10.0 / (5.0 + 100.0 * self.damping)), _LEAST_ETA)

    def accel_m_s2(self, periods_s: ArrayLike) -> NDArray[np.float64]:
        """Spectral acceleration at periods_s (any shape, s ≥ 0), m/s²."""
        T = np.asarray(periods_s, dtype=np.float64)
        plateau = self.eta * self.amplification
        safe = np.maximum(T, self.TB_s)
        falling = np.minimum(1.0, self.TC_s / safe) * np.minimum(1.0, self.TD_s / safe)
        rising = 1.0 + T / self.TB_s * (plateau - 1.0)
        return np.asarray(self.peak_m_s2 * np.where(self.TB_s > T, rising, plateau * falling))


def design_spectrum(target: Target) -> DesignSpectrum:
    """The spectrum of a validated target (either its own shape or that of its site)."""
    ag = target.ag_g * STANDARD_GRAVITY_M_S2
    TB, TC, TD = _VERTICAL_PERIODS
    if not target.vertical:
        (S, TB, TC, TD), site = _horizontal(target)
        peak, amplification = ag * S, EC8_AMPLIFICATION if target.code == "ec8" else target.F0 or 1.0
    elif target.code == "ec8":
        kind = target.type or 1
        peak, amplification, site = ag * _EC8_VERTICAL[kind], _EC8_VERTICAL_AMPLIFICATION, f"type {kind}"
    else:
        amplification = target.F0 or 1.0
        peak = ag * (target.topography or 1.0) * 1.35 * math.sqrt(target.ag_g)
        site = f"F0 = {amplification:g}"
    code = {"ntc2008": "NTC 2008", "ntc2018": "NTC 2018", "ec8": "Eurocode 8"}[target.code]
    name = f"{code}, {site}, a_g = {target.ag_g:g} g{', vertical' if target.vertical else ''}"
    return DesignSpectrum(peak, amplification, TB, TC, TD, target.damping, name)


def _horizontal(target: Target) -> tuple[tuple[float, float, float, float], str]:
    """S, TB, TC and TD of a horizontal spectrum, and what they follow from."""
    if target.soil is None:
        S, TB, TC, TD = (key or 0.0 for key in (target.S, target.TB_s, target.TC_s, target.TD_s))
        return (S, TB, TC, TD), f"S = {S:g}"
    if target.code == "ec8":
        return _EC8_SOILS[target.type or 1][target.soil], f"type {target.type}, soil {target.soil}"
    most, constant, slope, least = _NTC_SS[target.soil]
    S = (target.topography or 1.0) * min(max(constant - slope * (target.F0 or 1.0) * target.ag_g, least), most)
    factor, power = _NTC_CC[target.soil]
    star = target.TC_star_s or 1.0
    TC = factor * star**power * star
    return (S, TC / 3.0, TC, 4.0 * target.ag_g + 1.6), f"soil {target.soil}, S = {S:.4g}"


# Intensity measures of one history: peaks, Arias intensity and its build-up, durations.

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
