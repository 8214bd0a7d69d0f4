"""A floor motion known by its samples."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property
from typing import Self, final

import numpy as np
from numpy.typing import ArrayLike

from analytic.errors import AnalyticInputError
from analytic.motion import Excitation, Floats, require_finite


@final
@dataclass(frozen=True, eq=False)
class SampledAcceleration(Excitation):
    """Samples joined by straight lines, zero before the first and after the last.

    t_s (n,) strictly increasing from ≥ 0, s; accel_m_s2 of the samples (n,), m/s², kept as ``samples_m_s2``.
    """

    t_s: Floats
    samples_m_s2: Floats

    def __init__(self, t_s: ArrayLike, accel_m_s2: ArrayLike) -> None:
        """Copy the samples; raise AnalyticInputError unless they are a record."""
        t, a = (np.array(values, dtype=np.float64) for values in (t_s, accel_m_s2))
        if t.ndim != 1 or t.shape != a.shape or t.size < 2:
            raise AnalyticInputError(
                f"record: two equally long rows of at least 2 are wanted, {t.shape}, {a.shape} came."
            )
        if not (np.isfinite(t).all() and np.isfinite(a).all()):
            bad = int(np.flatnonzero(~(np.isfinite(t) & np.isfinite(a)))[0])
            raise AnalyticInputError(f"record: finite numbers are wanted, sample {bad} is ({t[bad]}, {a[bad]}).")
        if t[0] < 0.0 or (np.diff(t) <= 0.0).any():
            bad = 0 if t[0] < 0.0 else int(np.flatnonzero(np.diff(t) <= 0.0)[0]) + 1
            raise AnalyticInputError(
                f"record: strictly increasing times from 0 are wanted, sample {bad} is at {t[bad]} s: sort them."
            )
        for name, values in (("t_s", t), ("samples_m_s2", a)):
            values.setflags(write=False)
            object.__setattr__(self, name, values)

    def __eq__(self, other: object) -> bool:
        """Equal samples at equal times."""
        if not isinstance(other, SampledAcceleration):
            return NotImplemented
        return np.array_equal(self.t_s, other.t_s) and np.array_equal(self.samples_m_s2, other.samples_m_s2)

    def __hash__(self) -> int:
        """Hash of the samples' bytes."""
        return hash((self.t_s.tobytes(), self.samples_m_s2.tobytes()))

    def accel_m_s2(self, t_s: ArrayLike) -> Floats:
        """Acceleration, m/s²."""
        return np.asarray(
            np.interp(np.asarray(t_s, dtype=np.float64), self.t_s, self.samples_m_s2, left=0.0, right=0.0)
        )

    @cached_property
    def _integrals(self) -> tuple[Floats, Floats, Floats]:
        """Slope of each segment (n − 1,), velocity and displacement at each sample (n,)."""
        step, a = np.diff(self.t_s), self.samples_m_s2
        slope = np.diff(a) / step
        velocity = np.concatenate([[0.0], np.cumsum(0.5 * (a[1:] + a[:-1]) * step)])
        gained = velocity[:-1] * step + (a[:-1] / 2.0 + slope * step / 6.0) * step**2
        return slope, velocity, np.concatenate([[0.0], np.cumsum(gained)])

    def _state(self, t_s: ArrayLike) -> tuple[Floats, Floats]:
        t, a = np.asarray(t_s, dtype=np.float64), self.samples_m_s2
        slope, velocity, displacement = self._integrals
        i = np.clip(np.searchsorted(self.t_s, t, side="right") - 1, 0, slope.size - 1)
        tau = np.clip(t, self.t_s[0], self.t_s[-1]) - self.t_s[i]
        v = velocity[i] + (a[i] + 0.5 * slope[i] * tau) * tau
        d = displacement[i] + (velocity[i] + (a[i] / 2.0 + slope[i] * tau / 6.0) * tau) * tau
        return np.asarray(v), np.asarray(d + velocity[-1] * np.maximum(t - self.t_s[-1], 0.0))

    def velocity_m_s(self, t_s: ArrayLike) -> Floats:
        """Velocity, m/s."""
        return self._state(t_s)[0]

    @cached_property
    def _numbers(self) -> tuple[list[float], list[tuple[float, float, float]]]:
        """Times of the samples, and velocity, acceleration and half the slope from each on, none from the last: for one instant
        an array takes ten times as long as a number."""
        slope, velocity, _ = self._integrals
        numbers = np.column_stack([velocity, self.samples_m_s2, np.append(0.5 * slope, 0.0)])
        numbers[-1, 1] = 0.0
        return self.t_s.tolist(), [(v, a, half) for v, a, half in numbers.tolist()]

    def velocity_at(self, t_s: float) -> float:
        """See `Excitation.velocity_at`."""
        times, numbers = self._numbers
        i = bisect_right(times, t_s) - 1
        if i < 0:
            return 0.0
        velocity, accel, half_slope = numbers[i]
        tau = t_s - times[i]
        return velocity + (accel + half_slope * tau) * tau

    def displacement_m(self, t_s: ArrayLike) -> Floats:
        """Displacement, m."""
        return self._state(t_s)[1]

    def breaks_s(self, duration_s: float) -> Floats:
        """Every sample's time."""
        return np.array(self.t_s[(self.t_s > 0.0) & (self.t_s < duration_s)])

    @property
    def end_s(self) -> float:
        """The last sample's time, s."""
        return float(self.t_s[-1])

    @property
    def peak_m_s2(self) -> float:
        """Largest absolute sample, m/s²."""
        return float(np.abs(self.samples_m_s2).max())

    def scaled(self, factor: float) -> Self:
        """The same times with every sample multiplied by factor."""
        require_finite("factor", factor)
        return type(self)(self.t_s, self.samples_m_s2 * factor)
