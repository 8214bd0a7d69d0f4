"""Scores taken sample by sample: differences, peaks, residuals, and how long two histories stay together."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from harness.model.history import Array, History, Pair, first_beyond_s
from harness.model.run import Run
from harness.records.scores import SpragueGeers

# How far two runs are apart.


INSTANTS: Final = 4000
"""Instants at which two histories are compared: the finest features, impacts, last longer than a thousandth of any scene."""


def errors(run: Run, other: Run, until_s: float = math.inf) -> tuple[float, float]:
    """Largest differences of rotation, rad, and slip, m, at a run's samples while both last; infinite without histories."""
    if run.history is None or other.history is None:
        return math.inf, math.inf
    times = run.history.t_s[run.history.t_s <= min(until_s, run.end_s, other.end_s)]
    return (
        float(np.max(np.abs(run.history.at(times) - other.history.at(times)), initial=0.0)),
        float(np.max(np.abs(run.history.slip_at(times) - other.history.slip_at(times)), initial=0.0)),
    )


def error_rad(run: Run, other: Run, until_s: float = math.inf) -> float:
    """Largest difference of two rotations, rad, at `INSTANTS`, up to the earlier end; infinite without histories."""
    if run.history is None or other.history is None:
        return math.inf
    times = np.linspace(0.0, min(run.end_s, other.end_s, until_s), INSTANTS)
    return float(np.max(np.abs(run.history.at(times) - other.history.at(times))))


@dataclass(frozen=True)
class Peak:
    """The largest rotation by size, signed, and its time."""

    theta_rad: float
    time_s: float


def rms(pair: Pair, values: Array) -> float:
    """Root mean square of values (n,) over the window, weighted by time."""
    return math.sqrt(pair.integral(values, values) / float(pair.weights_s.sum()))


def peak(history: History, until_s: float = math.inf) -> Peak:
    """The largest |θ| up to `until_s`, signed; between samples it is the Hermite value where the rate, taken as linear, vanishes.

    A history that begins later than `until_s` gives its first sample.
    """
    count = max(int(np.searchsorted(history.t_s, until_s, side="right")), 1)
    k = int(np.argmax(np.abs(history.theta_rad[:count])))
    best = Peak(float(history.theta_rad[k]), float(history.t_s[k]))
    rate = history.theta_rate_rad_s
    for i in (k - 1, k):
        if i < 0 or i + 1 >= rate.size or rate[i] * rate[i + 1] >= 0.0:
            continue
        share = rate[i] / (rate[i] - rate[i + 1])
        time = float(history.t_s[i] + share * (history.t_s[i + 1] - history.t_s[i]))
        theta = float(history.at(np.array([time]))[0])
        if abs(theta) > abs(best.theta_rad) and time <= until_s:
            best = Peak(theta, time)
    return best


def sprague_geers(pair: Pair) -> SpragueGeers:
    """Sprague and Geers' integral errors, b being the reference (Shock and Vibration Bulletin 60, 1989).

    M = √(∫a²/∫b²) − 1, P = acos(∫ab/√(∫a²∫b²))/π, C = √(M² + P²).
    """
    a, b = pair.theta_a_rad, pair.theta_b_rad
    aa, bb, ab = pair.integral(a, a), pair.integral(b, b), pair.integral(a, b)
    if aa == 0.0 and bb == 0.0:
        return SpragueGeers(0.0, 0.0, 0.0)
    magnitude = None if bb == 0.0 else math.sqrt(aa / bb) - 1.0
    if aa == 0.0 or bb == 0.0:
        return SpragueGeers(magnitude, None, None)
    phase = 0.0 if np.array_equal(a, b) else math.acos(min(max(ab / math.sqrt(aa * bb), -1.0), 1.0)) / math.pi
    return SpragueGeers(magnitude, phase, math.hypot(magnitude or 0.0, phase))


def together_until_s(pair: Pair, tolerance_rad: float) -> float:
    """The time up to which |θ_a − θ_b| has stayed within the tolerance; the window's end when it always does."""
    left = first_beyond_s(pair.t_s, np.abs(pair.difference_rad), tolerance_rad)
    return pair.end_s if left is None else left
