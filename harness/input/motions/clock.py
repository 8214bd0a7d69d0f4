"""Times of samples as files print them: even within their digits, or put on an even clock that keeps every sample it can."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from harness.input.motions.series import Floats
from harness.input.motions.text import mistake
from harness.model.finding import Finding, caution, info

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
class Clock:
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


def clock_of(t_s: Floats, where: str, lines: tuple[int, ...] | None = None, *, largest: int | None = None) -> Clock:
    """The clock of samples at t_s (n,), s; InputError for times that do not increase and for gaps.

    `lines` are the rows' lines, for messages. With `largest`, the place of the largest sample, the trace is film or the like:
    times printed alike are spread, gaps are allowed, and that sample stays on the clock.
    """
    if t_s.size < 2:
        raise mistake(where, "", "two samples or more", str(t_s.size), "the file holds no motion")
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
        return Clock(start_s, round(exact, 9), t_s.size, None, doubled)
    forward = largest is None and bool((steps >= 0.0).all())
    if forward and (even := _of_rounded(t_s)):
        return even
    if forward and steps.max() > GAP_STEPS * dt_s:
        row = int(np.argmax(steps)) + 1
        got = f"a gap of {steps[row - 1]:g} s from {t_s[row - 1]:g} s"
        raise mistake(where, place(row), f"a step of about {dt_s:g} s", got, "cut the record there or fill it")
    if (steps <= 0.0).any():
        row = int(np.flatnonzero(steps <= 0.0)[0]) + 1
        got = f"{t_s[row]:g} s after {t_s[row - 1]:g} s"
        raise mistake(
            where,
            place(row),
            "increasing times",
            got,
            "sort the rows, drop doubled ones, or print the times with more digits",
        )
    fine = _common_step(t_s)
    if fine is None:
        fine = float(steps.min()) if largest is None else 0.5 * dt_s
        if largest is None:  # the clock ends with the last sample
            fine = (end_s - start_s) / max(round((end_s - start_s) / fine), 1)
        else:
            start_s += (float(t_s[largest]) - start_s) % fine
    if (end_s - start_s) / fine > MOST_SAMPLES:
        got = f"{steps.min():g} to {steps.max():g} s"
        raise mistake(
            where, "", f"steps that make at most {MOST_SAMPLES:.0e} samples when evened", got, "cut the record"
        )
    count = int((end_s - start_s) / fine + 1e-6) + 1
    at_s = float(t_s[np.argmax(steps)])
    least_s, most_s = float(steps.min()), float(steps.max())
    said = caution("record_times_uneven", least_s=least_s, most_s=most_s, at_s=at_s, dt_s=fine)
    return Clock(start_s, fine, count, t_s, (*doubled, said))


def _of_rounded(t_s: Floats) -> Clock | None:
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
            return Clock(float(t_s[0]), fits[0], t_s.size, None, (said,)) if len(fits) == 1 else None
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
    step = float(t_s[-1] - t_s[0]) / max(t_s.size - 1, 1)
    ends = np.append(first, t_s.size), np.append(t_s[first], t_s[-1] + step * (t_s.size - first[-1]))
    return np.asarray(np.interp(np.arange(t_s.size), *ends))
