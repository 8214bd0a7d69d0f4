"""Floor motions: acceleration with its exact integrals, and the instants at which it is not smooth.

Every motion starts from rest at t = 0 and is immutable. At a jump the value from the right counts, except at a
record's last sample, which is its own.
"""

import math
from abc import ABC, abstractmethod
from bisect import bisect_right
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, Literal, Self, final, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.block import require

# What every floor motion offers, and the motion that is none.

Floats = NDArray[np.float64]

LEAST_JUMP: Final = 1e-6
"""A jump of less than this share of a motion's peak is the rounding of its numbers."""
OF_A_CYCLE: Final = 256
"""Instants of a cycle between which a formula is straight but for"""
BOW: Final = 2e-4
"""this share of its peak: a sine's is (2π/256)²/8 = 7.5e-5, a Ricker pulse's 1.1e-4, a ramp's 2e-5 more."""
MOST_CYCLES: Final = 1000.0
"""A motion of more is not looked at so."""


def require_finite(name: str, value: float, *, positive: bool = False, least: float = -math.inf) -> None:
    """Raise AnalyticInputError unless value is finite, positive if asked, and at least least."""
    wanted = "a positive number" if positive else "a finite number"
    wanted += f" of at least {least:g}" if math.isfinite(least) else ""
    require(
        math.isfinite(value) and value >= least and (value > 0.0 or not positive),
        "{}: {} is wanted, {!r} came.",
        name,
        wanted,
        value,
    )


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
    def _integrals(self, t_s: ArrayLike) -> tuple[Floats, Floats]:
        """Velocity, m/s, and displacement, m, at the times t_s (any shape, s ≥ 0): the exact integrals from rest at t = 0."""

    def velocity_m_s(self, t_s: ArrayLike) -> Floats:
        """Velocity at the times t_s (any shape, s ≥ 0), in m/s: the exact integral from rest at t = 0."""
        return self._integrals(t_s)[0]

    def velocity_at(self, t_s: float) -> float:
        """Velocity at one instant, m/s."""
        return float(self.velocity_m_s(t_s))

    def displacement_m(self, t_s: ArrayLike) -> Floats:
        """Displacement at the times t_s (any shape, s ≥ 0), in m: the exact double integral from rest at t = 0."""
        return self._integrals(t_s)[1]

    @abstractmethod
    def breaks_s(self, duration_s: float) -> Floats:
        """Sorted instants in (0, duration_s), s, at which a or a' jumps: no integrator step crosses them."""

    def jumps_s(self, duration_s: float) -> Floats:
        """Those of `breaks_s` at which a itself jumps."""
        breaks = self.breaks_s(duration_s)
        beside = 4.0 * np.spacing(breaks)
        apart = np.abs(self.accel_m_s2(breaks + beside) - self.accel_m_s2(breaks - beside))
        return np.asarray(breaks[apart > LEAST_JUMP * self.peak_m_s2])

    def straight_s(self, duration_s: float) -> Floats | None:
        """Instants, s, some outside the duration, between which a is a straight line but for `BOW` of its peak, both sides of
        every jump among them; None where it is not known of this motion.
        """
        return None

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

    end_s = 0.0
    peak_m_s2 = 0.0

    def accel_m_s2(self, t_s: ArrayLike) -> Floats:
        """Zeros of the shape of t_s."""
        return np.zeros_like(np.asarray(t_s, dtype=np.float64))

    def _integrals(self, t_s: ArrayLike) -> tuple[Floats, Floats]:
        return self.accel_m_s2(t_s), self.accel_m_s2(t_s)

    def breaks_s(self, duration_s: float) -> Floats:
        """None."""
        return np.empty(0)

    def straight_s(self, duration_s: float) -> Floats:
        """None are needed."""
        return np.empty(0)

    def scaled(self, factor: float) -> Self:
        """Itself."""
        require_finite("factor", factor)
        return self


# A floor motion known by its samples.


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
        require(
            t.ndim == 1 and t.shape == a.shape and t.size > 1,
            "record: two equally long rows of at least 2 are wanted, {}, {} came.",
            t.shape,
            a.shape,
        )
        finite = np.isfinite(t) & np.isfinite(a)
        bad = int(np.argmin(finite))
        require(finite.all(), "record: finite numbers are wanted, sample {} is ({}, {}).", bad, t[bad], a[bad])
        later = np.append(t[0] >= 0.0, np.diff(t) > 0.0)
        bad = int(np.argmin(later))
        require(
            later.all(),
            "record: strictly increasing times from 0 are wanted, sample {} is at {} s: sort them.",
            bad,
            t[bad],
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
    def _at_samples(self) -> tuple[Floats, Floats, Floats]:
        """Slope of each segment (n − 1,), velocity and displacement at each sample (n,)."""
        step, a = np.diff(self.t_s), self.samples_m_s2
        slope = np.diff(a) / step
        velocity = np.concatenate([[0.0], np.cumsum(0.5 * (a[1:] + a[:-1]) * step)])
        gained = velocity[:-1] * step + (a[:-1] / 2.0 + slope * step / 6.0) * step**2
        return slope, velocity, np.concatenate([[0.0], np.cumsum(gained)])

    def _integrals(self, t_s: ArrayLike) -> tuple[Floats, Floats]:
        t, a = np.asarray(t_s, dtype=np.float64), self.samples_m_s2
        slope, velocity, displacement = self._at_samples
        i = np.clip(np.searchsorted(self.t_s, t, side="right") - 1, 0, slope.size - 1)
        tau = np.clip(t, self.t_s[0], self.t_s[-1]) - self.t_s[i]
        v = velocity[i] + (a[i] + 0.5 * slope[i] * tau) * tau
        d = displacement[i] + (velocity[i] + (a[i] / 2.0 + slope[i] * tau / 6.0) * tau) * tau
        return np.asarray(v), np.asarray(d + velocity[-1] * np.maximum(t - self.t_s[-1], 0.0))

    @cached_property
    def _numbers(self) -> tuple[list[float], list[tuple[float, float, float]]]:
        """Times of the samples, and velocity, acceleration and half the slope from each on, none from the last: for one instant
        an array takes ten times as long as a number."""
        slope, velocity, _ = self._at_samples
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

    def breaks_s(self, duration_s: float) -> Floats:
        """Every sample's time."""
        return np.array(self.t_s[(self.t_s > 0.0) & (self.t_s < duration_s)])

    def straight_s(self, duration_s: float) -> Floats:
        """Every sample's time, and before the first and after the last."""
        return np.concatenate(
            [[np.nextafter(self.t_s[0], -math.inf)], self.t_s, [np.nextafter(self.t_s[-1], math.inf)]]
        )

    @property
    def end_s(self) -> float:
        """The last sample's time, s."""
        return float(self.t_s[-1])

    @cached_property
    def peak_m_s2(self) -> float:
        """Largest absolute sample, m/s²."""
        return float(np.abs(self.samples_m_s2).max())

    def scaled(self, factor: float) -> Self:
        """The same times with every sample multiplied by factor."""
        require_finite("factor", factor)
        require_finite("factor times the peak", factor * self.peak_m_s2)
        # The times were checked already, which takes longer than all else.
        scaled, samples = object.__new__(type(self)), self.samples_m_s2 * factor
        samples.setflags(write=False)
        vars(scaled).update(t_s=self.t_s, samples_m_s2=samples, peak_m_s2=abs(factor) * self.peak_m_s2)
        return scaled


__all__ = ["Excitation", "Harmonic", "Pulse", "Record", "Rest", "SampledAcceleration", "ZeroExcitation"]

Rest = ZeroExcitation
"""The zero excitation, by the name that scenes give it."""
Record = SampledAcceleration
"""A sampled acceleration, by its everyday name."""


def _instants(from_s: float, to_s: float, cycles: float) -> Floats:
    """So many instants of each cycle, both ends among them."""
    return np.linspace(from_s, to_s, math.ceil(OF_A_CYCLE * cycles) + 1)


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

    def _integrals(self, t_s: ArrayLike) -> tuple[Floats, Floats]:
        t = np.maximum(np.asarray(t_s, dtype=np.float64), 0.0)
        start = self.ramp_s
        v0, d0 = self._ramped(np.asarray(start)) if start > 0.0 else (np.zeros(()), np.zeros(()))
        w, amplitude = self.omega_rad_s, self.amplitude_m_s2
        angle0 = w * start + self.phase_rad
        tau = t - start
        velocity = v0 + amplitude * (math.cos(angle0) - np.cos(self._angle(t))) / w
        displacement = d0 + (v0 + amplitude * math.cos(angle0) / w) * tau
        displacement = displacement - amplitude * (np.sin(self._angle(t)) - math.sin(angle0)) / w**2
        if start > 0.0:
            v_ramp, d_ramp = self._ramped(t)
            velocity, displacement = np.where(t < start, v_ramp, velocity), np.where(t < start, d_ramp, displacement)
        return np.asarray(velocity), np.asarray(displacement)

    def velocity_m_s(self, t_s: ArrayLike) -> Floats:
        """Velocity, m/s: without a ramp alone, which engines ask for at every step."""
        if self.ramp_s > 0.0:
            return self._integrals(t_s)[0]
        t = np.maximum(np.asarray(t_s, dtype=np.float64), 0.0)
        return np.asarray(self.amplitude_m_s2 * (math.cos(self.phase_rad) - np.cos(self._angle(t))) / self.omega_rad_s)

    def breaks_s(self, duration_s: float) -> Floats:
        """The end of the ramp."""
        return np.array([self.ramp_s]) if 0.0 < self.ramp_s < duration_s else np.empty(0)

    def straight_s(self, duration_s: float) -> Floats | None:
        """See `Excitation.straight_s`."""
        cycles = self.frequency_hz * duration_s
        ramp = np.linspace(0.0, self.ramp_s, OF_A_CYCLE + 1)
        return None if cycles > MOST_CYCLES else np.append(_instants(0.0, duration_s, cycles), ramp)

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
        known = get_args(PulseShape)
        require(self.shape in known, "shape: one of {} is wanted, {!r} came.", ", ".join(known), self.shape)
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
        if self.shape != "ricker":
            raise NotImplementedError(f"Pulse has no formula for {self.shape!r}")
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

    def _integrals(self, t_s: ArrayLike) -> tuple[Floats, Floats]:
        tau = np.asarray(t_s, dtype=np.float64) - self.start_s
        _, first, second = self._shape(np.clip(tau, 0.0, self.duration_s))
        after = np.maximum(tau - self.duration_s, 0.0)
        return np.asarray(self.amplitude_m_s2 * first), np.asarray(self.amplitude_m_s2 * (second + first * after))

    def breaks_s(self, duration_s: float) -> Floats:
        """The pulse's start and end."""
        ends = np.array([self.start_s, self.end_s])
        return ends[(ends > 0.0) & (ends < duration_s)]

    def straight_s(self, duration_s: float) -> Floats:
        """See `Excitation.straight_s`."""
        inside = _instants(self.start_s, self.end_s, self.duration_s / self.period_s)
        return np.append(inside, np.nextafter([self.start_s, self.end_s], -math.inf))

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
