"""A uniform acceleration history on its way from a file to an excitation, with the list of what was done to it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from analytic.excitation import SampledAcceleration
from harness.model.finding import Finding

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Series:
    """Samples accel_m_s2 (n,) every dt_s, the first at t = 0, joined by straight lines; `done` says how they came about."""

    dt_s: float
    accel_m_s2: Floats
    done: tuple[Finding, ...] = ()

    @property
    def t_s(self) -> Floats:
        """Times of the samples (n,), s."""
        return np.asarray(self.dt_s * np.arange(self.accel_m_s2.size))

    @property
    def duration_s(self) -> float:
        """Time of the last sample, s."""
        return self.dt_s * (self.accel_m_s2.size - 1)

    def changed(self, accel_m_s2: Floats, step: Finding, *, dt_s: float | None = None) -> Series:
        """Other samples, with what was done to get them."""
        return replace(self, accel_m_s2=accel_m_s2, dt_s=self.dt_s if dt_s is None else dt_s, done=(*self.done, step))

    def excitation(self) -> SampledAcceleration:
        """The same motion for a solver."""
        return SampledAcceleration(self.t_s, self.accel_m_s2)


def velocity_m_s(series: Series) -> Floats:
    """Velocity at the samples (n,), m/s: the exact integral of the straight lines from rest."""
    accel = series.accel_m_s2
    return np.concatenate([[0.0], np.cumsum(0.5 * (accel[1:] + accel[:-1]) * series.dt_s)])


def displacement_m(series: Series) -> Floats:
    """Displacement at the samples (n,), m: the exact double integral of the straight lines from rest."""
    accel, dt = series.accel_m_s2, series.dt_s
    gained = velocity_m_s(series)[:-1] * dt + (accel[:-1] / 3.0 + accel[1:] / 6.0) * dt**2
    return np.concatenate([[0.0], np.cumsum(gained)])


def at_rest(accel_m_s2: Floats, dt_s: float, window: Floats | None = None) -> Floats:
    """Samples changed smoothly so that velocity and displacement are zero at the end (to rounding).

    Subtracts the combination of w(t) and t·w(t), w = sin²(πt/T) (or `window` (n,)), that carries both residuals.
    """
    n = accel_m_s2.size
    share = np.linspace(0.0, 1.0, n)
    shape = np.sin(np.pi * share) ** 2 if window is None else window
    basis = (shape, shape * (share - 0.5))
    result = np.array(accel_m_s2, dtype=np.float64)
    for _ in range(2):  # the second pass removes the first one's rounding
        ends = np.array([_ends(part, dt_s) for part in basis]).T
        result -= np.tensordot(np.linalg.solve(ends, _ends(result, dt_s)), basis, axes=1)
    return result


def _ends(accel_m_s2: Floats, dt_s: float) -> Floats:
    """Velocity and displacement at the last sample."""
    series = Series(dt_s, accel_m_s2)
    return np.array([velocity_m_s(series)[-1], displacement_m(series)[-1]])
