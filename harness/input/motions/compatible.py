"""Histories whose response spectrum follows a target: artificial from a seed, and any history matched by wavelets.

Artificial: random phases under an envelope, amplitudes corrected by target over response (Gasparini and Vanmarcke 1976).
Matching: tapered cosines added at each oscillator's peak, their sizes from the linear system of cross responses
(Lilhanand and Tseng 1988; wavelet of Al Atik and Abrahamson 2010, eq. 6), repeated; each pass ends at rest.
"""

import math
from typing import Final

import numpy as np

from harness.input.motions import oscillator
from harness.input.motions.recordfile import Floats, Series, at_rest
from harness.input.motions.spectra import DesignSpectrum
from harness.model import info

BAND_S: Final = (0.05, 2.0)
"""Periods between which the misfit is promised."""
MISFIT: Final = 0.10
STEP_S: Final = 0.005
"""Step of every compatible history: ten samples in the shortest promised period."""
DEFAULT_DURATION_S: Final = 25.0
"""With the envelope below, 11 s of strong shaking: Eurocode 8 asks for 10 s at least (3.2.3.1.2)."""

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
    response = oscillator.spectrum_m_s2(series.accel_m_s2, series.dt_s, periods, spectrum.damping)
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
    accel = _shaken(amplitude, phase, shape, spectrum)
    wanted = spectrum.accel_m_s2(_CONTROL_S)
    for _ in range(_FFT_PASSES):
        reached = oscillator.spectrum_m_s2(accel, STEP_S, _CONTROL_S, spectrum.damping)
        amplitude *= np.interp(np.log(periods), np.log(_CONTROL_S), wanted / reached)
        accel = _shaken(amplitude, phase, shape, None)
    step = info("step_artificial", seed=seed, duration_s=duration_s, dt_s=STEP_S, corrections=_FFT_PASSES)
    return match(Series(STEP_S, accel, (step,)), spectrum)


def _shaken(amplitude: Floats, phase: np.ndarray, shape: Floats, scale_to: DesignSpectrum | None) -> Floats:
    noise = np.fft.irfft(amplitude * phase)[: shape.size]
    accel = at_rest(noise * shape, STEP_S)
    if scale_to is None:
        return accel
    reached = oscillator.spectrum_m_s2(accel, STEP_S, _CONTROL_S, scale_to.damping)
    return np.asarray(accel * float(np.exp(np.mean(np.log(scale_to.accel_m_s2(_CONTROL_S) / reached)))))


def best_factor(series: Series, spectrum: DesignSpectrum) -> float:
    """The factor that brings the mean of log(S/target) over BAND_S to zero."""
    periods = np.geomspace(*BAND_S, 60)
    response = oscillator.spectrum_m_s2(series.accel_m_s2, series.dt_s, periods, spectrum.damping)
    return float(np.exp(np.mean(np.log(spectrum.accel_m_s2(periods) / response))))


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
        peaks = oscillator.peaks(accel, STEP_S, _CONTROL_S, spectrum.damping)
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

    def change(self, peaks: oscillator.Peaks, wanted: Floats) -> Floats:
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
