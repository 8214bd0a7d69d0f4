"""What every floor motion offers, and the motion that is none."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Final, Self, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.errors import AnalyticInputError

Floats = NDArray[np.float64]

LEAST_JUMP: Final = 1e-6
"""A jump of less than this share of a motion's peak is the rounding of its numbers."""


def require_finite(name: str, value: float, *, positive: bool = False, least: float = -math.inf) -> None:
    """Raise AnalyticInputError unless value is finite, positive if asked, and at least least."""
    if not math.isfinite(value) or (positive and value <= 0.0) or value < least:
        wanted = "a positive number" if positive else "a finite number"
        wanted += f" of at least {least:g}" if math.isfinite(least) else ""
        raise AnalyticInputError(f"{name}: {wanted} is wanted, {value!r} came.")


@dataclass(frozen=True, eq=False)
class Excitation(ABC):
    """A floor acceleration a(t) in m/s², zero before t = 0.

    To add a motion: give the members below; if the compiled kernel is to follow it exactly, give it a code in
    ``analytic.kernel.forcing``; otherwise sample it into a ``SampledAcceleration``.
    """

    @abstractmethod
    def accel_m_s2(self, t_s: ArrayLike) -> Floats:
        """Acceleration at the times t_s (any shape, s), in m/s²."""

    @abstractmethod
    def velocity_m_s(self, t_s: ArrayLike) -> Floats:
        """Velocity at the times t_s (any shape, s ≥ 0), in m/s: the exact integral from rest at t = 0."""

    def velocity_at(self, t_s: float) -> float:
        """Velocity at one instant, m/s."""
        return float(self.velocity_m_s(t_s))

    @abstractmethod
    def displacement_m(self, t_s: ArrayLike) -> Floats:
        """Displacement at the times t_s (any shape, s ≥ 0), in m: the exact double integral from rest at t = 0."""

    @abstractmethod
    def breaks_s(self, duration_s: float) -> Floats:
        """Sorted instants in (0, duration_s), s, at which a or a' jumps: no integrator step crosses them."""

    def jumps_s(self, duration_s: float) -> Floats:
        """Those of `breaks_s` at which a itself jumps."""
        breaks = self.breaks_s(duration_s)
        beside = 4.0 * np.spacing(breaks)
        apart = np.abs(self.accel_m_s2(breaks + beside) - self.accel_m_s2(breaks - beside))
        return np.asarray(breaks[apart > LEAST_JUMP * self.peak_m_s2])

    @property
    @abstractmethod
    def end_s(self) -> float:
        """Instant after which the acceleration is exactly zero, s (infinite if there is none)."""

    @property
    @abstractmethod
    def peak_m_s2(self) -> float:
        """Largest absolute acceleration, m/s²."""

    @abstractmethod
    def scaled(self, factor: float) -> Self:
        """The same motion with every acceleration multiplied by factor."""


@final
@dataclass(frozen=True)
class ZeroExcitation(Excitation):
    """No motion."""

    def accel_m_s2(self, t_s: ArrayLike) -> Floats:
        """Zeros of the shape of t_s."""
        return np.zeros_like(np.asarray(t_s, dtype=np.float64))

    velocity_m_s = accel_m_s2
    displacement_m = accel_m_s2

    def breaks_s(self, duration_s: float) -> Floats:
        """None."""
        return np.empty(0)

    @property
    def end_s(self) -> float:
        """Zero."""
        return 0.0

    @property
    def peak_m_s2(self) -> float:
        """Zero."""
        return 0.0

    def scaled(self, factor: float) -> Self:
        """Itself."""
        require_finite("factor", factor)
        return self
