"""Processing of one history, a step at a time; each adds to the result's `done` what it did and what that changed."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Final, Literal

import numpy as np

from harness.input.motions.clock import MOST_SAMPLES
from harness.input.motions.measures import arias_share, peak_velocity_m_s
from harness.input.motions.recordfile import STANDARD_GRAVITY_M_S2
from harness.input.motions.series import Floats, Series, at_rest, displacement_m, velocity_m_s
from harness.model.finding import info

Baseline = Literal["none", "mean", "linear", "quadratic", "rest"]

_DEGREE: Final = {"mean": 0, "linear": 1, "quadratic": 2}
FILTER_ORDER: Final = 4
PAD_PERIODS: Final = 1.5 * FILTER_ORDER
"""Zeros before and after, in periods of the low corner: 1.5 times the order, halved at each side by two passes' symmetry."""
LEAST_PERIODS: Final = 0.1
"""Of the low corner's period in a record: no filter tells a slower motion from an offset."""
_RATIO_LIMIT = 2000
_DECAY = 1e-9


class ProcessError(ValueError):
    """A step that this history cannot take: the key that asks for it, what was wanted there and what came."""

    def __init__(self, key: str, wanted: str, got: str) -> None:
        super().__init__(f"{key}: wanted {wanted}, got {got}")
        self.key, self.wanted, self.got = key, wanted, got


def window(series: Series, start_s: float, end_s: float) -> Series:
    """The samples from start_s to end_s, the first becoming t = 0; ProcessError where fewer than two remain."""
    first = math.ceil(start_s / series.dt_s - 1e-9)
    last = min(math.floor(end_s / series.dt_s + 1e-9), series.accel_m_s2.size - 1)
    if last - first < 1:
        got = f"{start_s:g} to {end_s:g} s, where nothing is left"
        raise ProcessError("window_s", f"a part of the {series.duration_s:g} s that the record lasts", got)
    step = info("step_window", from_s=first * series.dt_s, to_s=last * series.dt_s)
    return series.changed(series.accel_m_s2[first : last + 1], step)


def baseline(series: Series, kind: Baseline) -> Series:
    """Less a polynomial fitted to the acceleration, or ("rest") changed so that the motion ends at rest where it began."""
    if kind == "none":
        return series
    if kind == "rest":
        accel = at_rest(series.accel_m_s2, series.dt_s)
    else:
        place = np.linspace(-1.0, 1.0, series.accel_m_s2.size)
        fit = np.polynomial.Polynomial.fit(place, series.accel_m_s2, _DEGREE[kind], domain=[-1.0, 1.0])
        accel = series.accel_m_s2 - fit(place)
    changed = np.asarray(accel, dtype=np.float64)
    (before_m_s, before_m), (after_m_s, after_m) = _ends(series), _ends(Series(series.dt_s, changed))
    most = float(np.abs(changed - series.accel_m_s2).max())
    ends = {"before_m_s": before_m_s, "before_m": before_m, "after_m_s": after_m_s, "after_m": after_m}
    return series.changed(changed, info("step_baseline", kind=kind, most_m_s2=most, **ends))


def _ends(series: Series) -> tuple[float, float]:
    """Velocity, m/s, and displacement, m, at the last sample."""
    return float(velocity_m_s(series)[-1]), float(displacement_m(series)[-1])


def bandpass(series: Series, low_hz: float, high_hz: float) -> Series:
    """Butterworth of order 4 in both directions (no phase shift), padded with zeros.

    ProcessError above Nyquist, and for a low corner of which the record holds no tenth of a period.
    """
    from scipy.signal import butter, sosfiltfilt

    nyquist = 0.5 / series.dt_s
    if high_hz >= nyquist:
        wanted = f"a high corner below {nyquist:g} Hz (its step is {series.dt_s:g} s)"
        raise ProcessError("bandpass_hz", wanted, f"{high_hz:g} Hz")
    lowest = max(LEAST_PERIODS / series.duration_s, 2.0 * PAD_PERIODS / (MOST_SAMPLES * series.dt_s))
    if low_hz < lowest:
        wanted = f"a low corner of at least {lowest:.4g} Hz (the record lasts {series.duration_s:g} s)"
        raise ProcessError("bandpass_hz", wanted, f"{low_hz:g} Hz")
    pad = math.ceil(PAD_PERIODS / low_hz / series.dt_s)
    padded = np.pad(series.accel_m_s2, pad)
    filtered = sosfiltfilt(
        butter(FILTER_ORDER, (low_hz, high_hz), "bandpass", fs=1.0 / series.dt_s, output="sos"), padded
    )
    passed = np.asarray(filtered[pad : pad + series.accel_m_s2.size], dtype=np.float64)
    lost = 1.0 - float((passed**2).sum() / (series.accel_m_s2**2).sum())
    return series.changed(passed, info("step_bandpass", low_hz=low_hz, high_hz=high_hz, order=FILTER_ORDER, lost=lost))


def resample(series: Series, dt_s: float) -> Series:
    """The same straight lines at a finer step, or low-pass filtered (polyphase) at a coarser one."""
    ratio = Fraction(series.dt_s / dt_s).limit_denominator(_RATIO_LIMIT)
    if ratio == 1:
        return series
    if abs(float(ratio) * dt_s / series.dt_s - 1.0) > _DECAY:
        raise ProcessError("resample_dt_s", f"a simple ratio of the record's step of {series.dt_s:g} s", f"{dt_s:g} s")
    if ratio > 1:
        count = math.floor((series.accel_m_s2.size - 1) * ratio + 1e-9) + 1
        if count > MOST_SAMPLES:
            wanted = f"a step that makes at most {MOST_SAMPLES:.0e} samples of {series.duration_s:g} s"
            raise ProcessError("resample_dt_s", wanted, f"{dt_s:g} s")
        t_s = np.arange(count) * dt_s
        accel = np.interp(t_s, series.t_s, series.accel_m_s2)
        whole = ratio.denominator == 1
        step = info("step_resampled", how="whole" if whole else "cut", from_s=series.dt_s, to_s=dt_s)
        return series.changed(accel, step, dt_s=dt_s)
    from scipy.signal import resample_poly

    low = np.asarray(resample_poly(series.accel_m_s2, ratio.numerator, ratio.denominator), dtype=np.float64)
    step = info("step_resampled", how="lowpass", from_s=series.dt_s, to_s=dt_s, lowpass_hz=0.5 / dt_s)
    return series.changed(low, step, dt_s=dt_s)


def significant(series: Series, shares: tuple[float, float], joint: Floats) -> Series:
    """The window in which the Arias intensity of `joint` (n,) (the sum of squares of all channels) grows between `shares`."""
    build = arias_share(joint)
    first, last = (int(np.searchsorted(build, share)) for share in shares)
    last = min(max(last, first + 1), series.accel_m_s2.size - 1)
    times = {"from_s": first * series.dt_s, "to_s": last * series.dt_s}
    step = info("step_significant", from_share=shares[0], to_share=shares[1], **times)
    return series.changed(series.accel_m_s2[first : last + 1], step)


def scaled(series: Series, factor: float, why: str, target: float | str = "") -> Series:
    """Every sample times `factor`, unless it is 1: `why` is the key that asks for it, `target` what it is to reach."""
    if factor == 1.0:
        return series
    return series.changed(series.accel_m_s2 * factor, info("step_scaled", factor=factor, why=why, target=target))


def to_pga(series: Series, pga_g: float) -> Series:
    """Scaled to a peak acceleration of `pga_g`."""
    peak = float(np.abs(series.accel_m_s2).max())
    return scaled(series, pga_g * STANDARD_GRAVITY_M_S2 / peak, "pga_g", pga_g)


def to_pgv(series: Series, pgv_m_s: float) -> Series:
    """Scaled to a peak velocity of `pgv_m_s`."""
    return scaled(series, pgv_m_s / peak_velocity_m_s(series), "pgv_m_s", pgv_m_s)
