"""Floor motions: acceleration with its exact integrals, and the instants at which it is not smooth.

Every motion starts from rest at t = 0 and is immutable. At a jump the value from the right counts, except at a
record's last sample, which is its own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final, Literal, Self, final, get_args

import numpy as np
from numpy.typing import ArrayLike

from analytic.errors import AnalyticInputError
from analytic.motion import Excitation, Floats, ZeroExcitation, require_finite
from analytic.sampled import SampledAcceleration

__all__ = ["Excitation", "Harmonic", "Pulse", "Record", "Rest", "SampledAcceleration", "ZeroExcitation"]

Rest = ZeroExcitation
"""The zero excitation, by the name that scenes give it."""
Record = SampledAcceleration
"""A sampled acceleration, by its everyday name."""

PulseShape = Literal["rectangular", "one_sine", "one_cosine", "ricker"]

RICKER_PERIODS: Final = 4.0
"""A Ricker pulse's duration in its dominant periods: at its ends it has fallen to 6e-16 of its peak."""


@final
@dataclass(frozen=True)
class Harmonic(Excitation):
    """a = ρ(t) A sin(2πft + phase) for ever, ρ growing linearly from 0 to 1 over ramp_s (1 throughout if it is 0)."""

    amplitude_m_s2: float
    frequency_hz: float
    phase_rad: float = 0.0
    ramp_s: float = 0.0

    def __post_init__(self) -> None:
        """Reject what is not a motion."""
        require_finite("amplitude_m_s2", self.amplitude_m_s2)
        require_finite("frequency_hz", self.frequency_hz, positive=True)
        require_finite("phase_rad", self.phase_rad)
        require_finite("ramp_s", self.ramp_s, least=0.0)

    @property
    def omega_rad_s(self) -> float:
        """Circular frequency, rad/s."""
        return 2.0 * math.pi * self.frequency_hz

    def _angle(self, t: Floats) -> Floats:
        return np.asarray(self.omega_rad_s * t + self.phase_rad)

    def accel_m_s2(self, t_s: ArrayLike) -> Floats:
        """Acceleration, m/s²."""
        t = np.asarray(t_s, dtype=np.float64)
        ramp = np.clip(t / self.ramp_s, 0.0, 1.0) if self.ramp_s > 0.0 else np.where(t < 0.0, 0.0, 1.0)
        return np.asarray(ramp * self.amplitude_m_s2 * np.sin(self._angle(t)))

    def _ramped(self, t: Floats) -> tuple[Floats, Floats]:
        """Velocity and displacement within the ramp."""
        w, scale = self.omega_rad_s, self.amplitude_m_s2 / self.ramp_s
        sin, cos = np.sin(self._angle(t)), np.cos(self._angle(t))
        sin0, cos0 = math.sin(self.phase_rad), math.cos(self.phase_rad)
        velocity = scale * (-t * cos / w + (sin - sin0) / w**2)
        displacement = scale * (-t * sin / w**2 - 2.0 * (cos - cos0) / w**3 - sin0 * t / w**2)
        return np.asarray(velocity), np.asarray(displacement)

    def _state(self, t_s: ArrayLike) -> tuple[Floats, Floats]:
        t = np.maximum(np.asarray(t_s, dtype=np.float64), 0.0)
        start, v0, d0 = self.ramp_s, np.float64(0.0), np.float64(0.0)
        if self.ramp_s > 0.0:
            v_end, d_end = self._ramped(np.asarray(self.ramp_s))
            v0, d0 = np.float64(v_end), np.float64(d_end)
        w, amplitude = self.omega_rad_s, self.amplitude_m_s2
        angle0 = w * start + self.phase_rad
        tau = t - start
        velocity = v0 + amplitude * (math.cos(angle0) - np.cos(self._angle(t))) / w
        displacement = d0 + (v0 + amplitude * math.cos(angle0) / w) * tau
        displacement = displacement - amplitude * (np.sin(self._angle(t)) - math.sin(angle0)) / w**2
        if self.ramp_s > 0.0:
            v_ramp, d_ramp = self._ramped(t)
            velocity, displacement = np.where(t < start, v_ramp, velocity), np.where(t < start, d_ramp, displacement)
        return np.asarray(velocity), np.asarray(displacement)

    def velocity_m_s(self, t_s: ArrayLike) -> Floats:
        """Velocity, m/s."""
        if self.ramp_s > 0.0:
            return self._state(t_s)[0]
        t = np.maximum(np.asarray(t_s, dtype=np.float64), 0.0)
        return np.asarray(self.amplitude_m_s2 * (math.cos(self.phase_rad) - np.cos(self._angle(t))) / self.omega_rad_s)

    def displacement_m(self, t_s: ArrayLike) -> Floats:
        """Displacement, m."""
        return self._state(t_s)[1]

    def breaks_s(self, duration_s: float) -> Floats:
        """The end of the ramp."""
        return np.array([self.ramp_s]) if 0.0 < self.ramp_s < duration_s else np.empty(0)

    @property
    def end_s(self) -> float:
        """Never, unless the amplitude is zero."""
        return math.inf if self.amplitude_m_s2 != 0.0 else 0.0

    @property
    def peak_m_s2(self) -> float:
        """The amplitude's absolute value."""
        return abs(self.amplitude_m_s2)

    def scaled(self, factor: float) -> Self:
        """The same motion with its amplitude multiplied by factor."""
        require_finite("factor", factor)
        return replace(self, amplitude_m_s2=self.amplitude_m_s2 * factor)


@final
@dataclass(frozen=True)
class Pulse(Excitation):
    """One pulse of amplitude A from start_s to start_s + duration_s, with τ = t − start_s and T = duration_s.

    rectangular: A. one_sine: A sin(2πτ/T). one_cosine: A cos(2πτ/T). ricker: A (1 − w²ξ²) exp(−w²ξ²/2) about the
    middle, ξ = τ − T/2, w = √2 π / period_s, where period_s = T/4 is the dominant period.
    """

    shape: PulseShape
    amplitude_m_s2: float
    duration_s: float
    start_s: float = 0.0

    def __post_init__(self) -> None:
        """Reject what is not a pulse."""
        if self.shape not in get_args(PulseShape):
            wanted = ", ".join(get_args(PulseShape))
            raise AnalyticInputError(f"shape: one of {wanted} is wanted, {self.shape!r} came.")
        require_finite("amplitude_m_s2", self.amplitude_m_s2)
        require_finite("duration_s", self.duration_s, positive=True)
        require_finite("start_s", self.start_s, least=0.0)

    @property
    def period_s(self) -> float:
        """Dominant period, s: the duration of a sine or cosine, a quarter of it for ricker."""
        return self.duration_s / (RICKER_PERIODS if self.shape == "ricker" else 1.0)

    @property
    def omega_rad_s(self) -> float:
        """2π/T for a sine or cosine, w of the class's equation for ricker, 0 for a rectangle, rad/s."""
        if self.shape == "rectangular":
            return 0.0
        return (math.sqrt(2.0) if self.shape == "ricker" else 2.0) * math.pi / self.period_s

    def _shape(self, tau: Floats) -> tuple[Floats, Floats, Floats]:
        """Shape of unit amplitude at 0 ≤ tau ≤ duration_s, and its first and second integral from tau = 0."""
        w, half = self.omega_rad_s, 0.5 * self.duration_s
        if self.shape == "rectangular":
            return np.ones_like(tau), tau, 0.5 * tau**2
        if self.shape == "one_sine":
            return np.sin(w * tau), (1.0 - np.cos(w * tau)) / w, (tau - np.sin(w * tau) / w) / w
        if self.shape == "one_cosine":
            return np.cos(w * tau), np.sin(w * tau) / w, (1.0 - np.cos(w * tau)) / w**2
        xi = tau - half
        bell, bell0 = np.exp(-0.5 * (w * xi) ** 2), math.exp(-0.5 * (w * half) ** 2)
        first = xi * bell + half * bell0
        return (1.0 - (w * xi) ** 2) * bell, first, (bell0 - bell) / w**2 + half * bell0 * tau

    def accel_m_s2(self, t_s: ArrayLike) -> Floats:
        """Acceleration, m/s²; zero from the pulse's end on."""
        tau = np.asarray(t_s, dtype=np.float64) - self.start_s
        inside = (tau >= 0.0) & (tau < self.duration_s)
        shape = self._shape(np.clip(tau, 0.0, self.duration_s))[0]
        return np.asarray(np.where(inside, self.amplitude_m_s2 * shape, 0.0))

    def velocity_m_s(self, t_s: ArrayLike) -> Floats:
        """Velocity, m/s."""
        tau = np.asarray(t_s, dtype=np.float64) - self.start_s
        return np.asarray(self.amplitude_m_s2 * self._shape(np.clip(tau, 0.0, self.duration_s))[1])

    def displacement_m(self, t_s: ArrayLike) -> Floats:
        """Displacement, m."""
        tau = np.asarray(t_s, dtype=np.float64) - self.start_s
        _, first, second = self._shape(np.clip(tau, 0.0, self.duration_s))
        return np.asarray(self.amplitude_m_s2 * (second + first * np.maximum(tau - self.duration_s, 0.0)))

    def breaks_s(self, duration_s: float) -> Floats:
        """The pulse's start and end."""
        ends = np.array([self.start_s, self.end_s])
        return ends[(ends > 0.0) & (ends < duration_s)]

    @property
    def end_s(self) -> float:
        """Start plus duration, s."""
        return self.start_s + self.duration_s if self.amplitude_m_s2 != 0.0 else 0.0

    @property
    def peak_m_s2(self) -> float:
        """The amplitude's absolute value."""
        return abs(self.amplitude_m_s2)

    def scaled(self, factor: float) -> Self:
        """The same pulse with its amplitude multiplied by factor."""
        require_finite("factor", factor)
        return replace(self, amplitude_m_s2=self.amplitude_m_s2 * factor)
