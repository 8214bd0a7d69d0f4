"""Spectra of acceleration: responses of linear oscillators, the building codes' targets, and histories that follow one."""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from harness.input.motions.recordfile import (
    STANDARD_GRAVITY_M_S2,
    Floats,
    Series,
    at_rest,
    displacement_m,
    velocity_m_s,
)
from harness.input.motions.spec import Target
from harness.model import info

# Linear oscillators under straight-line accelerations: exact steps, response spectra, absolute accelerations.
#
# Relative displacement d of q̈ + 2ζω q̇ + ω² q = −a(t); Nigam and Jennings (1969) is this recurrence written out.


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


def relative_displacement_m(accel_m_s2: Floats, dt_s: float, period_s: float, damping: float) -> Floats:
    """Relative displacement (n,) at the samples, m, from rest at the first, by the recurrence's transfer function."""
    from scipy.signal import lfilter

    (phi, b0, b1), row = exact_step(period_s, damping, dt_s), np.array([1.0, 0.0])
    trace, det = float(np.trace(phi)), float(np.linalg.det(phi))
    carry = phi - trace * np.eye(2)
    taps = np.array([row @ b1, row @ (b0 + carry @ b1), row @ carry @ b0])
    start = accel_m_s2[0] * np.array([-taps[0], row @ b0 - taps[1]])
    response, _ = lfilter(taps, [1.0, -trace, det], accel_m_s2, zi=start)
    return np.asarray(response)


@dataclass(frozen=True, eq=False)
class Peaks:
    """Per period: pseudo-acceleration ω²|d| (m/s²) with the sign of −d at its peak, and the time of that peak (s)."""

    accel_m_s2: Floats
    t_s: Floats
    sign: Floats


def peak_responses(accel_m_s2: Floats, dt_s: float, periods_s: ArrayLike, damping: float) -> Peaks:
    """Peak responses of oscillators of `periods_s` (k,) from rest, at no fewer than POINTS_PER_PERIOD samples a period."""
    periods = np.asarray(periods_s, dtype=np.float64)
    accel, at, sign = np.empty(periods.size), np.empty(periods.size), np.empty(periods.size)
    n = accel_m_s2.size
    finer: dict[int, Floats] = {}
    for i, period in enumerate(periods.tolist()):
        needed = max(1, math.ceil(POINTS_PER_PERIOD * dt_s / period - 1e-9))
        factor = 1 << (needed - 1).bit_length()
        if factor not in finer:
            # The same straight lines with that many times as many samples.
            finer[factor] = np.interp(np.arange((n - 1) * factor + 1) / factor, np.arange(n), accel_m_s2)
        samples = finer[factor]
        response = relative_displacement_m(samples, dt_s / factor, period, damping)
        largest = int(np.argmax(np.abs(response)))
        accel[i] = abs(response[largest]) * (2.0 * math.pi / period) ** 2
        at[i], sign[i] = largest * dt_s / factor, -math.copysign(1.0, response[largest])
    return Peaks(accel, at, sign)


def spectrum_m_s2(accel_m_s2: Floats, dt_s: float, periods_s: ArrayLike, damping: float = 0.05) -> Floats:
    """Pseudo-acceleration response spectrum (k,), m/s²; the peak acceleration itself at period 0."""
    periods = np.atleast_1d(np.asarray(periods_s, dtype=np.float64))
    result = np.full(periods.size, float(np.abs(accel_m_s2).max()))
    moving = periods > 0.0
    result[moving] = peak_responses(accel_m_s2, dt_s, periods[moving], damping).accel_m_s2
    return result


# Elastic design spectra of NTC 2008, NTC 2018 and Eurocode 8 (EN 1998-1:2004), horizontal and vertical.
#
# All are one shape (EN 1998-1, 3.2.2.2; NTC 3.2.3.2.1): with p the peak acceleration, A the amplification and
# η = √(10/(5 + ξ)) ≥ 0.55,
#
#     0..TB: p [1 + T/TB (η A − 1)]      TB..TC: p η A      TC..TD: p η A TC/T      from TD: p η A TC TD/T².
#
# Horizontal: p = a_g S, A = F0 (2.5 in Eurocode 8). Vertical: docs/motions.md, "Target spectra".

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


# Histories whose response spectrum follows a target: artificial from a seed, and any history matched by wavelets.
#
# Artificial: random phases under an envelope, amplitudes corrected by target over response (Gasparini and Vanmarcke 1976).
# Matching: tapered cosines added at each oscillator's peak, their sizes from the linear system of cross responses
# (Lilhanand and Tseng 1988; wavelet of Al Atik and Abrahamson 2010, eq. 6), repeated; each pass ends at rest.


BAND_S: Final = (0.05, 2.0)
"""Periods between which the misfit is promised."""
MISFIT: Final = 0.10
STEP_S: Final = 0.005
"""Step of every compatible history: ten samples in the shortest promised period."""
DEFAULT_DURATION_S: Final = 25.0
"""With the envelope below, 11 s of strong shaking: Eurocode 8 asks for 10 s at least (3.2.3.1.2)."""

_BAND_PERIODS_S: Final = np.geomspace(*BAND_S, 60)
_CONTROL_S: Final = np.geomspace(0.045, 2.4, 200)  # 2 % apart: wider, the spectrum dips between them
_AIM, _SOFTER_AIM = 0.05, 0.075  # misfit at the control periods that ends matching, at first and later
_FFT_PASSES, _HARD_PASSES, _PASSES = 8, 12, 30
_RELAX = 0.5  # share of the missing response asked of one pass, since peaks move to other times
_WIDTH = 3.0  # wavelets 2.5 times as long as the paper's 1.178: narrow dips of the spectrum need a narrow band
_RIDGE = 0.02  # neighbouring oscillators ask nearly the same: without damping the amounts grow without bound
_RISE, _STRONG = 0.15, 0.60  # shares of the duration: quadratic rise, strong part until, exponential decay after
_DECAYED = 0.05
_LOWEST_HZ = 0.15  # an artificial motion has no energy below
_DRIFT_HZ, _DRIFT_PAD = 0.12, 1.5  # and zeros around it, in its periods
_EDGE = 0.02  # share of the duration that fades in and out
_NEGLIGIBLE_WAVELET, _NEGLIGIBLE_RESPONSE = 3.2, 9.0  # exponents' root and value: below 1e-4, corrected by later passes


class NoMatchError(ValueError):
    """No history was found within the promised misfit; the sentence says how near it came."""


def misfit(series: Series, spectrum: DesignSpectrum) -> float:
    """Largest |S/target − 1| over BAND_S at 200 periods."""
    periods = np.geomspace(*BAND_S, 200)
    response = spectrum_m_s2(series.accel_m_s2, series.dt_s, periods, spectrum.damping)
    return float(np.abs(response / spectrum.accel_m_s2(periods) - 1.0).max())


def envelope(n: int) -> Floats:
    """Strength over the duration (n,): a quadratic rise, a plateau, an exponential decay (Jennings et al. 1968)."""
    share = np.linspace(0.0, 1.0, n)
    decay = np.exp(math.log(_DECAYED) * np.clip((share - _STRONG) / (1.0 - _STRONG), 0.0, 1.0))
    return np.minimum(1.0, (share / _RISE) ** 2) * decay * _edges(n)


def _edges(n: int) -> Floats:
    """Ones that fade to zero at both ends by half a cosine (n,)."""
    share = np.linspace(0.0, 1.0, n)
    return 0.5 - 0.5 * np.cos(np.pi * np.clip(np.minimum(share, 1.0 - share) / _EDGE, 0.0, 1.0))


def artificial(spectrum: DesignSpectrum, *, seed: int, duration_s: float = DEFAULT_DURATION_S) -> Series:
    """A history of `duration_s` from `seed`: the same seed gives the same samples; NoMatchError beyond MISFIT."""
    n = round(duration_s / STEP_S) + 1
    rng = np.random.Generator(np.random.PCG64(seed))
    size = 1 << (n - 1).bit_length()
    frequency = np.fft.rfftfreq(size, STEP_S)
    phase = np.exp(2j * np.pi * rng.random(frequency.size))
    shape = envelope(n)
    periods = 1.0 / np.maximum(frequency, 0.5 * _LOWEST_HZ)
    amplitude = spectrum.accel_m_s2(periods) / np.sqrt(np.maximum(frequency, _LOWEST_HZ))
    amplitude *= np.clip((frequency / _LOWEST_HZ - 0.5) * 2.0, 0.0, 1.0)
    accel = _shaken(amplitude, phase, shape)
    accel *= best_factor(Series(STEP_S, accel), spectrum, _CONTROL_S)
    wanted = spectrum.accel_m_s2(_CONTROL_S)
    for _ in range(_FFT_PASSES):
        reached = spectrum_m_s2(accel, STEP_S, _CONTROL_S, spectrum.damping)
        amplitude *= np.interp(np.log(periods), np.log(_CONTROL_S), wanted / reached)
        accel = _shaken(amplitude, phase, shape)
    step = info("step_artificial", seed=seed, duration_s=duration_s, dt_s=STEP_S, corrections=_FFT_PASSES)
    return match(Series(STEP_S, accel, (step,)), spectrum)


def _shaken(amplitude: Floats, phase: np.ndarray, shape: Floats) -> Floats:
    return at_rest(np.fft.irfft(amplitude * phase)[: shape.size] * shape, STEP_S)


def best_factor(series: Series, spectrum: DesignSpectrum, periods_s: Floats = _BAND_PERIODS_S) -> float:
    """The factor that brings the mean of log(S/target) over `periods_s` to zero."""
    response = spectrum_m_s2(series.accel_m_s2, series.dt_s, periods_s, spectrum.damping)
    return float(np.exp(np.mean(np.log(spectrum.accel_m_s2(periods_s) / response))))


def match(series: Series, spectrum: DesignSpectrum) -> Series:
    """`series` (at STEP_S) changed by wavelets until its spectrum follows `spectrum`; it ends at rest.

    Raises NoMatchError where the largest misfit in BAND_S stays above MISFIT.
    """
    wanted = spectrum.accel_m_s2(_CONTROL_S)
    fade = _edges(series.accel_m_s2.size)
    accel = at_rest(series.accel_m_s2 * fade, STEP_S, fade)
    wavelets = _Wavelets(accel.size, spectrum.damping)
    best, best_off, passes = accel, math.inf, 0
    for passes in range(_PASSES + 1):
        peaks = peak_responses(accel, STEP_S, _CONTROL_S, spectrum.damping)
        off = float(np.abs(peaks.accel_m_s2 / wanted - 1.0).max())
        if off < best_off:
            best, best_off = accel, off
        if best_off <= (_AIM if passes < _HARD_PASSES else _SOFTER_AIM) or passes == _PASSES:
            break
        change = _without_drift(wavelets.change(peaks, wanted) * fade) * fade
        accel = at_rest(accel + change, STEP_S, fade)
    result = Series(STEP_S, best)
    largest = misfit(result, spectrum)
    if largest > MISFIT:
        raise NoMatchError(f"the nearest history is {largest:.1%} off {spectrum.name}, more than {MISFIT:.0%}")
    band = {"from_s": BAND_S[0], "to_s": BAND_S[1]}
    return series.changed(best, info("step_matched", target=spectrum.name, passes=passes, off=largest, **band))


def _without_drift(accel: Floats) -> Floats:
    """Less what is slower than _DRIFT_HZ: wavelets cut by the record's ends would leave it drifting by decimetres."""
    from scipy.signal import butter, sosfiltfilt

    pad = round(_DRIFT_PAD / _DRIFT_HZ / STEP_S)
    filtered = sosfiltfilt(butter(2, _DRIFT_HZ, "highpass", fs=1.0 / STEP_S, output="sos"), np.pad(accel, pad))
    return np.asarray(filtered[pad : pad + accel.size])


class _Wavelets:
    """Tapered cosines and the oscillators' responses to them (summed by einsum, whose order no thread count changes)."""

    def __init__(self, n: int, damping: float) -> None:
        w = 2.0 * np.pi / _CONTROL_S
        wd = w * math.sqrt(1.0 - damping**2)
        self._n, self._wd, self._lambda = n, wd, -damping * w + 1j * wd
        self._gain = w**2 / wd * STEP_S
        self._lag = math.atan2(math.sqrt(1.0 - damping**2), damping) / wd
        self._width = _WIDTH * _CONTROL_S**0.93

    def change(self, peaks: Peaks, wanted: Floats) -> Floats:
        """Sum of tapered cosines (n,) that brings the oscillators' peaks towards `wanted` (k,), to first order."""
        missing = (1.0 - peaks.accel_m_s2 / wanted) * peaks.sign
        impulse = self._impulse(peaks.t_s)
        parts = [self._shape(time, j) for j, time in enumerate(peaks.t_s.tolist())]
        cross = np.empty((len(parts), len(parts)))
        for j, (first, shape) in enumerate(parts):
            np.einsum("it,t->i", impulse[:, first : first + shape.size], shape, out=cross[:, j])
        unit = wanted / np.diag(cross)  # amounts for which each wavelet alone makes its own oscillator's target
        amounts = unit * _least_squares(cross * unit[None, :] / wanted[:, None], _RELAX * missing)
        total = np.zeros(self._n)
        for amount, (first, shape) in zip(amounts, parts, strict=True):
            total[first : first + shape.size] += amount * shape
        return total

    def _shape(self, peak_s: float, j: int) -> tuple[int, Floats]:
        """First sample and samples of the wavelet of oscillator j, cut where it is below 1e-6 of its peak."""
        centre, reach = peak_s - self._lag[j], _NEGLIGIBLE_WAVELET * self._width[j]
        first = max(0, math.ceil((centre - reach) / STEP_S))
        last = min(self._n, math.floor((centre + reach) / STEP_S) + 1)
        since = STEP_S * np.arange(first, max(last, first)) - centre
        return first, np.cos(self._wd[j] * since) * np.exp(-((since / self._width[j]) ** 2))

    def _impulse(self, at: Floats) -> Floats:
        """Pseudo-acceleration at each peak's time for a unit sample at every time (k, n)."""
        result = np.zeros((at.size, self._n))
        for row, time, rate, gain in zip(result, at.tolist(), self._lambda, self._gain, strict=True):
            last = min(self._n, math.floor(time / STEP_S + 1e-9) + 1)
            reach = min(last, math.ceil(_NEGLIGIBLE_RESPONSE / -rate.real / STEP_S))
            since = time - STEP_S * np.arange(last - reach, last)
            row[last - reach : last] = gain * np.exp(rate.real * since) * np.sin(rate.imag * since)
        return result


def _least_squares(system: Floats, wanted: Floats) -> Floats:
    """x that minimises |system x − wanted|² + (_RIDGE |x|)², by Cholesky written out: LAPACK's bits change with its threads."""
    rows = np.column_stack([np.einsum("ij,ik->jk", system, system), np.einsum("ij,i->j", system, wanted)])
    n = wanted.size
    rows[np.arange(n), np.arange(n)] += _RIDGE**2
    for k in range(n - 1):
        rows[k + 1 :, k + 1 :] -= (rows[k, k + 1 : n] / rows[k, k])[:, None] * rows[k, k + 1 :]
    x = np.zeros(n)
    for k in range(n - 1, -1, -1):
        x[k] = (rows[k, n] - np.einsum("i,i->", rows[k, k + 1 : n], x[k + 1 :])) / rows[k, k]
    return x
