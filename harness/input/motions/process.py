"""Processing of one history, a step at a time, on an even clock and through a building's floor; each step adds to the result's
`done` what it did and what that changed.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Final, Literal

import numpy as np

from analytic.excitation import Excitation, SampledAcceleration
from harness.input.mistakes import agree
from harness.input.motions.recordfile import (
    STANDARD_GRAVITY_M_S2,
    Floats,
    Series,
    at_rest,
    ends,
)
from harness.input.motions.spec import Oscillator
from harness.input.motions.spectra import arias_share, exact_step, peak_velocity_m_s
from harness.model import Finding, caution, info, require

# The building's filter: the acceleration of a floor from that of the ground, by one or several oscillators.
#
# a_floor = (1 − Σφᵢ) a + Σ φᵢ (q̈ᵢ + a), with qᵢ the i-th mode's relative displacement and φᵢ its share (participation factor
# times shape at the floor): docs/motions.md, "The building's filter".

POINTS_PER_PERIOD: Final = 70
"""Samples in the shortest period: straight lines miss a sine by at most (2π/70)²/8 = 0.1 % of its amplitude."""
RING_DOWN: Final = 1e-3
"""The floor is followed until its slowest mode has decayed to this share."""
_JUMP_S = 1e-9
"""A jump of the floor's acceleration (Σφ ≠ 1 under a pulse) is drawn over this time."""


def ring_down_s(modes: Sequence[Oscillator]) -> float:
    """Time in which the slowest mode decays to RING_DOWN after the ground has stopped, s."""
    return max(-math.log(RING_DOWN) * mode.period_s / (2.0 * math.pi * mode.damping) for mode in modes)


def floor_motion(ground: Excitation, modes: Sequence[Oscillator], until_s: float) -> SampledAcceleration:
    """The floor's acceleration from 0 to `until_s`, sampled so finely that straight lines between samples hold.

    Exact at the samples for grounds of straight lines (records, rectangular pulses).
    """
    shortest = min(mode.period_s for mode in modes)
    t_s, before, after = _nodes(ground, shortest / POINTS_PER_PERIOD, until_s)
    rigid = 1.0 - sum(mode.share for mode in modes)
    moving = np.zeros(t_s.size)
    for mode in modes:
        moving += mode.share * _absolute(t_s, before, after, mode)
    return _drawn(t_s, rigid * before + moving, rigid * after + moving)


def _nodes(ground: Excitation, longest_step_s: float, until_s: float) -> tuple[Floats, Floats, Floats]:
    """Times that hold every break of the ground, and its acceleration just before and just after each."""
    # A formula is followed, too, where it is faster than the building.
    period_s = 2.0 * math.pi / max(getattr(ground, "omega_rad_s", 0.0), 1e-300)
    step_s = min(longest_step_s, period_s / POINTS_PER_PERIOD)
    breaks = np.unique([0.0, *ground.breaks_s(until_s), min(ground.end_s, until_s), until_s])
    pieces = [
        np.linspace(start, end, max(1, math.ceil((end - start) / step_s)), endpoint=False)
        for start, end in zip(breaks[:-1].tolist(), breaks[1:].tolist(), strict=True)
    ]
    t_s = np.append(np.concatenate(pieces), until_s)
    gap = np.diff(t_s)
    inside = 1e-7 * np.concatenate([[gap[0]], np.minimum(gap[:-1], gap[1:]), [gap[-1]]])
    before, after = ground.accel_m_s2(np.maximum(t_s - inside, 0.0)), ground.accel_m_s2(t_s + inside)
    at = ground.accel_m_s2(t_s)
    smooth = np.abs(after - before) <= 1e-4 * max(ground.peak_m_s2, 1e-300)
    before, after = np.where(smooth, at, before), np.where(smooth, at, after)
    return t_s, before, after


def _absolute(t_s: Floats, before: Floats, after: Floats, mode: Oscillator) -> Floats:
    """Absolute acceleration of one oscillator at every node (n,), from rest, exact for straight lines between nodes."""
    result = np.zeros(t_s.size)
    displacement = velocity = 0.0
    w = 2.0 * math.pi / mode.period_s
    dt_s = -1.0
    p00 = p01 = p10 = p11 = s0 = s1 = e0 = e1 = 0.0
    for i, step_s in enumerate(np.diff(t_s).tolist()):
        if abs(step_s - dt_s) > 1e-12 * step_s:
            dt_s = step_s
            phi, b0, b1 = exact_step(mode.period_s, mode.damping, dt_s)
            (p00, p01), (p10, p11) = phi.tolist()
            (s0, s1), (e0, e1) = b0.tolist(), b1.tolist()
        start, end = after[i], before[i + 1]
        displacement, velocity = (
            p00 * displacement + p01 * velocity + s0 * start + e0 * end,
            p10 * displacement + p11 * velocity + s1 * start + e1 * end,
        )
        result[i + 1] = -(w**2) * displacement - 2.0 * mode.damping * w * velocity
    return result


def _drawn(t_s: Floats, before: Floats, after: Floats) -> SampledAcceleration:
    """A record through all nodes, its jumps drawn over _JUMP_S."""
    jumps = np.flatnonzero(np.abs(after - before) > 0.0)
    jumps = jumps[(jumps > 0) & (jumps < t_s.size - 1)]
    times = np.insert(t_s, jumps, t_s[jumps] - _JUMP_S)
    values = np.insert(after, jumps, before[jumps])
    values[-1] = before[-1]
    return SampledAcceleration(times, values)


# Times of samples as files print them: even within their digits, or put on an even clock that keeps every sample it can.

JITTER: Final = 0.02
"""Of a step: what times printed with few digits are off by."""
GAP_STEPS: Final = 5.0
"""A hole of more steps in a table is a loss; film is digitised where the trace bends, and may leave more out."""
MOST_SAMPLES: Final = 2e7
"""Twenty hours at 250 a second: more come of times that are damaged."""
_QUANTA: Final = (1e-2, 1e-3, 1e-4, 1e-5)
_USUAL_STEPS_S: Final = tuple(
    1.0 / rate
    for rate in (
        20,
        25,
        40,
        50,
        60,
        64,
        80,
        100,
        120,
        125,
        128,
        160,
        200,
        240,
        250,
        256,
        300,
        400,
        500,
        512,
        600,
        1000,
        1024,
    )
)
_ROUND_STEPS_S: Final = tuple(round(digits * power, 6) for power in (1e-4, 1e-3) for digits in range(10, 100))
"""Steps of accelerographs, and the others that two digits write: one of them is what rounded times stand for."""
_SAME: Final = 1e-6
"""Of a digit, or of a step: rounding of doubles."""
_FINEST: Final = 12
"""An even clock that meets every sample may be finer than the smallest step by this factor, not by more."""


@dataclass(frozen=True, eq=False)
class SampleClock:
    """An even clock of `count` samples from start_s every dt_s; `given_s` (n,) are the file's times where they are uneven."""

    start_s: float
    dt_s: float
    count: int
    given_s: Floats | None = None
    said: tuple[Finding, ...] = ()

    def of(self, channel: str) -> tuple[Finding, ...]:
        """What is said of it, of one channel's."""
        return tuple(replace(each, values={"channel": channel, **each.values}) for each in self.said)

    def on(self, values: Floats) -> Floats:
        """Samples (count,) of the straight lines through `values` (n,) at the file's times."""
        if self.given_s is None:
            return values
        return np.asarray(np.interp(self.start_s + self.dt_s * np.arange(self.count), self.given_s, values))


def clock_of(
    t_s: Floats, where: str, lines: tuple[int, ...] | None = None, *, largest: int | None = None
) -> SampleClock:
    """The clock of samples at t_s (n,), s; InputError for times that do not increase and for gaps.

    `lines` are the rows' lines, for messages. With `largest`, the place of the largest sample, the trace is film or the like:
    times printed alike are spread, gaps are allowed, and that sample stays on the clock.
    """
    require(t_s.size >= 2, where, "two samples or more", str(t_s.size), "the file holds no motion")
    doubled: tuple[Finding, ...] = ()
    if largest is not None and (np.diff(t_s) == 0.0).any():
        t_s, doubled = _spread(t_s), (info("record_times_spread"),)
    steps = np.diff(t_s)
    start_s, end_s = float(t_s[0]), float(t_s[-1])
    exact = (end_s - start_s) / (t_s.size - 1)
    dt_s = float(np.median(steps)) or exact

    def place(row: int) -> str:
        return f"line {lines[row]}" if lines else f"sample {row + 1}"

    if exact > 0.0 and np.abs(t_s - start_s - exact * np.arange(t_s.size)).max() <= JITTER * exact:
        return SampleClock(start_s, round(exact, 9), t_s.size, None, doubled)
    forward = largest is None and bool((steps >= 0.0).all())
    if forward and (even := _of_rounded(t_s)):
        return even
    longest, late = int(np.argmax(steps)), int(np.argmax(steps <= 0.0))
    require(
        not forward or steps[longest] <= GAP_STEPS * dt_s,
        where,
        f"a step of about {dt_s:g} s",
        f"a gap of {steps[longest]:g} s from {t_s[longest]:g} s",
        "cut the record there or fill it",
        key=place(longest + 1),
    )
    require(
        steps[late] > 0.0,
        where,
        "increasing times",
        f"{t_s[late + 1]:g} s after {t_s[late]:g} s",
        "sort the rows, drop doubled ones, or print the times with more digits",
        key=place(late + 1),
    )
    fine = _common_step(t_s)
    if fine is None:
        fine = float(steps.min()) if largest is None else 0.5 * dt_s
        if largest is None:  # the clock ends with the last sample
            fine = (end_s - start_s) / max(round((end_s - start_s) / fine), 1)
        else:
            start_s += (float(t_s[largest]) - start_s) % fine
    require(
        (end_s - start_s) / fine <= MOST_SAMPLES,
        where,
        f"steps that make at most {MOST_SAMPLES:.0e} samples when evened",
        f"{steps.min():g} to {steps.max():g} s",
        "cut the record",
    )
    count = int((end_s - start_s) / fine + 1e-6) + 1
    least_s, most_s = float(steps.min()), float(steps.max())
    said = caution("record_times_uneven", least_s=least_s, most_s=most_s, at_s=float(t_s[longest]), dt_s=fine)
    return SampleClock(start_s, fine, count, t_s, (*doubled, said))


def _of_rounded(t_s: Floats) -> SampleClock | None:
    """The even clock of which these times are what few digits left; None where no usual one is, or several are."""
    quantum = next(
        (each for each in (1.0, 0.1, *_QUANTA) if np.abs(t_s / each - np.round(t_s / each)).max() < 1e-4), None
    )
    if quantum is None:
        return None
    count = t_s.size - 1
    least, most = ((float(t_s[-1] - t_s[0]) + off) / count for off in (-quantum, quantum))
    for steps in (_USUAL_STEPS_S, _ROUND_STEPS_S):
        fits = [
            step
            for step in steps
            # Times of a whole number of digits to a step lose nothing by rounding: where they stray, samples are missing.
            if least <= step <= most and abs(step / quantum - round(step / quantum)) > _SAME * max(step / quantum, 1.0)
            and np.ptp(t_s - step * np.arange(t_s.size)) <= quantum * (1.0 + _SAME)
        ]  # fmt: skip
        if fits:
            said = info("record_times_rounded", digit_s=quantum, dt_s=fits[0])
            return SampleClock(float(t_s[0]), fits[0], t_s.size, None, (said,)) if len(fits) == 1 else None
    return None


def _common_step(t_s: Floats) -> float | None:
    """The largest step whose multiples meet every time, None where it would be far finer than the times themselves."""
    least = float(np.diff(t_s).min())
    for quantum in _QUANTA:
        ticks = (t_s - t_s[0]) / quantum
        if ticks[-1] < MOST_SAMPLES * _FINEST and np.abs(ticks - np.round(ticks)).max() < 1e-4:
            step = quantum * float(np.gcd.reduce(np.diff(np.round(ticks)).astype(np.int64)))
            return step if step * _FINEST >= least else None
    return None


def _spread(t_s: Floats) -> Floats:
    """Times that do not decrease, those printed alike drawn apart evenly towards the next."""
    first = np.flatnonzero(np.concatenate([[True], np.diff(t_s) != 0.0]))
    step = float(t_s[-1] - t_s[0]) / max(int(first[-1]), 1)  # of the samples before those that are printed as the last
    ends = np.append(first, t_s.size), np.append(t_s[first], t_s[-1] + step * (t_s.size - first[-1]))
    return np.asarray(np.interp(np.arange(t_s.size), *ends))


Baseline = Literal["none", "mean", "linear", "quadratic", "rest"]

_DEGREE: Final = {"mean": 0, "linear": 1, "quadratic": 2}
FILTER_ORDER: Final = 4
PAD_PERIODS: Final = 1.5 * FILTER_ORDER
"""Zeros before and after, in periods of the low corner: 1.5 times the order, halved at each side by two passes' symmetry."""
LEAST_PERIODS: Final = 0.1
"""Of the low corner's period in a record: no filter tells a slower motion from an offset."""
_RATIO_LIMIT = 2000
_DECAY = 1e-9


def window(series: Series, start_s: float, end_s: float) -> Series:
    """The samples from start_s to end_s, the first becoming t = 0; Contradiction where fewer than two remain."""
    first = math.ceil(start_s / series.dt_s - 1e-9)
    last = min(math.floor(end_s / series.dt_s + 1e-9), series.accel_m_s2.size - 1)
    wanted = f"a part of the {series.duration_s:g} s that the record lasts"
    agree((last - first >= 1, "window_s", wanted, f"{start_s:g} to {end_s:g} s, where nothing is left"))
    return series.changed(
        series.accel_m_s2[first : last + 1],
        info("step_window", from_s=first * series.dt_s, to_s=last * series.dt_s),
    )


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
    (before_m_s, before_m), (after_m_s, after_m) = ends(series), ends(Series(series.dt_s, changed))
    return series.changed(
        changed,
        info(
            "step_baseline",
            kind=kind,
            most_m_s2=float(np.abs(changed - series.accel_m_s2).max()),
            before_m_s=before_m_s,
            before_m=before_m,
            after_m_s=after_m_s,
            after_m=after_m,
        ),
    )


def bandpass(series: Series, low_hz: float, high_hz: float) -> Series:
    """Butterworth of order 4 in both directions (no phase shift), padded with zeros.

    Contradiction above Nyquist, and for a low corner of which the record holds no tenth of a period.
    """
    from scipy.signal import butter, sosfiltfilt

    nyquist = 0.5 / series.dt_s
    lowest = max(LEAST_PERIODS / series.duration_s, 2.0 * PAD_PERIODS / (MOST_SAMPLES * series.dt_s))
    below = f"a high corner below {nyquist:g} Hz (its step is {series.dt_s:g} s)"
    above = f"a low corner of at least {lowest:.4g} Hz (the record lasts {series.duration_s:g} s)"
    agree(
        (high_hz < nyquist, "bandpass_hz", below, f"{high_hz:g} Hz"),
        (low_hz >= lowest, "bandpass_hz", above, f"{low_hz:g} Hz"),
    )
    pad = math.ceil(PAD_PERIODS / low_hz / series.dt_s)
    padded = np.pad(series.accel_m_s2, pad)
    filtered = sosfiltfilt(
        butter(FILTER_ORDER, (low_hz, high_hz), "bandpass", fs=1.0 / series.dt_s, output="sos"), padded
    )
    passed = np.asarray(filtered[pad : pad + series.accel_m_s2.size], dtype=np.float64)
    lost = 1.0 - float((passed**2).sum() / ((series.accel_m_s2**2).sum() or 1.0))
    return series.changed(passed, info("step_bandpass", low_hz=low_hz, high_hz=high_hz, order=FILTER_ORDER, lost=lost))


def resample(series: Series, dt_s: float) -> Series:
    """The same straight lines at a finer step, or low-pass filtered (polyphase) at a coarser one."""
    ratio = Fraction(series.dt_s / dt_s).limit_denominator(_RATIO_LIMIT)
    if ratio == 1:
        return series
    wanted = f"a simple ratio of the record's step of {series.dt_s:g} s"
    agree((abs(float(ratio) * dt_s / series.dt_s - 1.0) <= _DECAY, "resample_dt_s", wanted, f"{dt_s:g} s"))
    if ratio > 1:
        count = math.floor((series.accel_m_s2.size - 1) * ratio + 1e-9) + 1
        wanted = f"a step that makes at most {MOST_SAMPLES:.0e} samples of {series.duration_s:g} s"
        agree((count <= MOST_SAMPLES, "resample_dt_s", wanted, f"{dt_s:g} s"))
        t_s = np.arange(count) * dt_s
        accel = np.interp(t_s, series.t_s, series.accel_m_s2)
        how = "whole" if ratio.denominator == 1 else "cut"
        return series.changed(accel, info("step_resampled", how=how, from_s=series.dt_s, to_s=dt_s), dt_s=dt_s)
    from scipy.signal import resample_poly

    low = np.asarray(resample_poly(series.accel_m_s2, ratio.numerator, ratio.denominator), dtype=np.float64)
    step = info("step_resampled", how="lowpass", from_s=series.dt_s, to_s=dt_s, lowpass_hz=0.5 / dt_s)
    return series.changed(low, step, dt_s=dt_s)


def significant(series: Series, shares: tuple[float, float], joint: Floats) -> Series:
    """The window in which the Arias intensity of `joint` (n,) (the sum of squares of all channels) grows between `shares`."""
    build = arias_share(joint)
    first, last = (int(np.searchsorted(build, share)) for share in shares)
    last = min(max(last, first + 1), series.accel_m_s2.size - 1)
    step = info(
        "step_significant",
        from_share=shares[0],
        to_share=shares[1],
        from_s=first * series.dt_s,
        to_s=last * series.dt_s,
    )
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
