"""Impacts, uplifts and motion patterns of a recorded rotation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.model.run import Pattern

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

THROUGH_SHARE: Final = 4.0
"""A statue that stays inside the band of rest longer than this many times its passage has come to rest in it."""
SHORTEST_PATTERN_S: Final = 2e-3
"""Shorter stretches of a pattern belong to the one before: a solver's chatter is no motion."""


@dataclass(frozen=True)
class Rocking:
    """Instants, s, of uplift from rest and of impact, and for each impact the rates before and after it, rad/s."""

    uplift_times_s: tuple[float, ...]
    impact_times_s: tuple[float, ...]
    rates_before_rad_s: tuple[float, ...]
    rates_after_rad_s: tuple[float, ...]


def rocking(t_s: Array, theta_rad: Array, theta_rate_rad_s: Array, resolution_rad: float) -> Rocking:
    """Find the excursions of θ out of the band |θ| ≤ `resolution_rad`; each return is an impact, each start from rest an uplift.

    An instant of impact is extrapolated from the last sample outside the band; an instant of uplift from the first one, as the
    start of a power law that has its θ, θ̇ and θ̈.
    """
    starts, stops = _excursions(theta_rad, resolution_rad)
    uplifts: list[float] = []
    impacts: list[float] = []
    before: list[float] = []
    after: list[float] = []
    last = theta_rad.size - 1
    for number, (first, end) in enumerate(zip(starts, stops, strict=True)):
        previous = int(stops[number - 1]) if number else -1
        if first > 0 and (number == 0 or _rested(t_s, theta_rate_rad_s, previous, int(first), resolution_rad)):
            uplifts.append(_uplift_time(t_s, theta_rad, theta_rate_rad_s, int(first)))
        if end >= last:
            continue
        following = int(min(end + 2, last))
        impacts.append(_impact_time(t_s, theta_rad, theta_rate_rad_s, int(end)))
        before.append(_rate_at(impacts[-1], t_s, theta_rate_rad_s, int(end), int(end) - 1))
        after.append(_rate_at(impacts[-1], t_s, theta_rate_rad_s, following, following + 1))
    return Rocking(tuple(uplifts), tuple(impacts), tuple(before), tuple(after))


def _excursions(theta_rad: Array, band: float) -> tuple[Ints, Ints]:
    """First and last sample of each stretch on one side outside the band."""
    side = np.where(theta_rad > band, 1, np.where(theta_rad < -band, -1, 0))
    edges = np.flatnonzero(np.diff(side)) + 1
    starts = np.concatenate([[0], edges]).astype(np.int64)
    stops = np.concatenate([edges - 1, [side.size - 1]]).astype(np.int64)
    out = side[starts] != 0
    return starts[out], stops[out]


def _rested(t_s: Array, rate: Array, end: int, first: int, band: float) -> bool:
    speed = max(abs(float(rate[end])), 1e-12)
    passage = 2.0 * band / speed + 3.0 * float(t_s[min(end + 1, t_s.size - 1)] - t_s[end])
    return float(t_s[first] - t_s[end]) > THROUGH_SHARE * passage


def _impact_time(t_s: Array, theta: Array, rate: Array, end: int) -> float:
    if theta[end] * rate[end] >= 0.0:
        return float(t_s[end + 1])
    return float(min(t_s[end] - theta[end] / rate[end], t_s[end + 1]))


def _rate_at(time_s: float, t_s: Array, rate: Array, sample: int, beside: int) -> float:
    """The rate on one side of an impact, gone on with from two samples there."""
    if not 0 <= beside < t_s.size:
        return float(rate[sample])
    slope = (rate[sample] - rate[beside]) / (t_s[sample] - t_s[beside])
    return float(rate[sample] + slope * (time_s - t_s[sample]))


def _uplift_time(t_s: Array, theta: Array, rate: Array, first: int) -> float:
    k = min(first + 1, t_s.size - 2)
    if theta[k] * rate[k] <= 0.0 or k < 1:
        return float(t_s[first])
    accel = (rate[k + 1] - rate[k - 1]) / (t_s[k + 1] - t_s[k - 1])
    curvature = float(theta[k] * accel / rate[k] ** 2)
    # θ = c τⁿ has θ θ̈/θ̇² = 1 − 1/n: 2 for a jump of the acceleration, 3 for a ramp.
    power = float(np.clip(1.0 / max(1.0 - curvature, 1e-9), 1.0, 4.0))
    return float(max(t_s[k] - power * theta[k] / rate[k], 0.0))


def patterns(
    t_s: Array, theta_rad: Array, slip_rate_m_s: Array, resolution_rad: float, stuck_below_m_s: float
) -> tuple[Pattern, ...]:
    """The stretches of rest, rocking, sliding and both."""
    code = (np.abs(theta_rad) > resolution_rad).astype(np.int64) + 2 * (np.abs(slip_rate_m_s) > stuck_below_m_s)
    # Passing upright is no rest: a short stay in the band between two sides of rocking is rocking.
    names = ("rest", "rocking", "sliding", "both")
    edges = np.concatenate([[0], np.flatnonzero(np.diff(code)) + 1, [code.size - 1]])
    patterns: list[Pattern] = []
    for start, stop in pairwise(edges):
        name = names[int(code[start])]
        begin, end = float(t_s[start]), float(t_s[stop])
        if patterns and (patterns[-1].name == name or end - begin < SHORTEST_PATTERN_S):
            patterns[-1] = Pattern(patterns[-1].start_s, end, patterns[-1].name)
        elif end > begin:
            patterns.append(Pattern(begin, end, name))
    return _merged(patterns)


def _merged(patterns: Sequence[Pattern]) -> tuple[Pattern, ...]:
    result: list[Pattern] = []
    for item in patterns:
        if result and result[-1].name == item.name:
            result[-1] = Pattern(result[-1].start_s, item.end_s, item.name)
        else:
            result.append(item)
    return tuple(result)
