"""Uplifts and impacts of a history, found in the same way on both sides, and matched between two histories."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from harness.comparison.statistics import area_metric, compare_distributions, ks_distance
from harness.model import Array, History, Pair
from harness.records.scores import AfterHorizon, Apart, PeaksApart

# Two histories beyond the horizon, where no instant of one can be asked of the other: their distributions.

LEAST_VALUES: Final = 8
"""Fewer values than this have no distribution worth a probability: a quartile would rest on two values."""
RESAMPLES: Final = 200
"""Resamples for the interval and for what chance alone gives: the 95 % quantile then rests on 10 of them."""
INSTANTS: Final = 1001
"""Equally spaced instants that stand for the rotation's distribution: a thousandth in probability."""


def after_horizon(excursions: tuple[Excursions, Excursions], both: Pair, until_s: float) -> AfterHorizon | None:
    """Distributions of the excursions' peaks and of the rotation after `until_s`; None when it is not passed.

    `peaks` holds the distances of the peaks' distributions, with their interval and what chance alone would give from 8
    excursions on (as if excursions did not depend on each other); `rotation` those of |θ| over time.
    """
    if until_s >= both.end_s:
        return None
    begin_s = max(until_s, both.start_s)
    peaks = [np.abs(each.peak_rad[each.uplift_s > begin_s]) for each in excursions]
    # Equally spaced instants, so that every one stands for the same time.
    t_s = np.linspace(begin_s, both.end_s, INSTANTS)
    rotation = [np.abs(np.interp(t_s, both.t_s, theta)) for theta in (both.theta_a_rad, both.theta_b_rad)]
    largest = [
        max(float(theta.max()), float(peak.max(initial=0.0))) for theta, peak in zip(rotation, peaks, strict=True)
    ]
    return AfterHorizon(
        from_s=begin_s,
        until_s=both.end_s,
        largest_a_rad=largest[0],
        largest_b_rad=largest[1],
        last_difference_rad=float(both.theta_a_rad[-1] - both.theta_b_rad[-1]),
        last_slip_difference_m=float(both.slip_a_m[-1] - both.slip_b_m[-1]),
        rotation=Apart(area_metric(*rotation), ks_distance(*rotation)),
        excursions_a=peaks[0].size,
        excursions_b=peaks[1].size,
        peaks=_peaks(*peaks),
    )


def _peaks(a: Array, b: Array) -> PeaksApart | None:
    if min(a.size, b.size) >= LEAST_VALUES:
        scores = compare_distributions(a, b, resamples=RESAMPLES)
        return PeaksApart(
            area_rad=scores.area.value,
            area_interval_rad=scores.area,
            area_by_chance_rad=scores.area_null,
            ks=scores.ks,
            ks_p=scores.ks_p,
        )
    if min(a.size, b.size) == 0:
        return None
    return PeaksApart(area_rad=area_metric(a, b), ks=ks_distance(a, b))


Signs = NDArray[np.int8]

UPLIFT_RAD: Final = 1e-4
"""Rotation beyond which a statue counts as rocking: above the chatter of a contact engine at rest (slop over base width,
some 1e-5 rad), and 0.1 mm at the top of a statue of one metre."""
DOWN: Final = 0.1
"""Share of that rotation at which an excursion has landed: contact engines rest there, a little off θ = 0."""
CHATTER_RAD: Final = 1e-9
"""Rotations of a statue at rest that are a contact engine's own: some 1e-12 rad, and of no side."""


@dataclass(frozen=True, eq=False)
class Excursions:
    """The stretches during which a statue leans on one corner further than the threshold; arrays of shape (k,).

    `side` is ±1, `uplift_s` when the rotation first passes the threshold, `from_rest` whether another excursion did not run
    straight into it, `peak_rad` its largest rotation (signed), `impact_s` when it is back at θ = 0 (NaN: not within the
    history, or not before it leans further again), `rate_before_rad_s` and `rate_after_rad_s` the angular velocities at that
    instant from either side (NaN: too few samples to the next impact), and `length_s` its duration.
    """

    side: Signs
    uplift_s: Array
    from_rest: NDArray[np.bool_]
    peak_rad: Array
    impact_s: Array
    rate_before_rad_s: Array
    rate_after_rad_s: Array
    length_s: Array

    @property
    def landed(self) -> NDArray[np.bool_]:
        """Which excursions end with an impact within the history."""
        return np.isfinite(self.impact_s)


_NONE: Final = np.zeros(0)
NO_EXCURSIONS: Final = Excursions(
    np.zeros(0, dtype=np.int8), _NONE, np.zeros(0, dtype=np.bool_), _NONE, _NONE, _NONE, _NONE, _NONE
)


def excursions(history: History, threshold_rad: float = UPLIFT_RAD) -> Excursions:
    """All excursions of a history beyond `threshold_rad`, in the order of time."""
    t, theta, rate = history.t_s, history.theta_rad, history.theta_rate_rad_s
    side = np.zeros(theta.size + 2, dtype=np.int8)
    side[1:-1] = (theta > threshold_rad).view(np.int8) - (theta < -threshold_rad).view(np.int8)
    change = np.flatnonzero(side[1:] != side[:-1])
    first = change[side[change + 1] != 0]
    last = change[side[change] != 0] - 1
    sign = side[first + 1]
    if first.size == 0:
        return NO_EXCURSIONS
    uplift = _crossing(t, theta, first, sign * threshold_rad)
    landing = _landing(theta, sign, last, DOWN * threshold_rad)
    landed = landing < np.append(first[1:], t.size - 1)
    impact = np.where(landed, _impacts(t, theta, rate, landing), np.nan)
    # From the side before: samples of the excursion itself but its first, which the impact before it may still hold; as far
    # from the impact as those after it, so that what the lines miss of a bend is the same on both sides.
    before = _extrapolated(t, rate, impact, landing - 1, -1, landing - 1 - first)
    after = _after(t, theta, rate, impact)
    peak = sign * np.maximum.reduceat(np.abs(theta), first)
    # Samples between two excursions are below the threshold, so they never hold the maximum.
    end = np.where(np.isfinite(impact), impact, t[last])
    return Excursions(
        sign, uplift, _from_rest(rate, first, last), peak, impact, before, after, np.maximum(end - uplift, 0.0)
    )


def _from_rest(rate: Array, first: NDArray[np.intp], last: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Whether the statue paused before each excursion: between two arcs of rocking the rate never falls to a fifth."""
    paused = np.ones(first.size, dtype=np.bool_)
    for k in range(1, first.size):
        between = rate[last[k - 1] + 1 : first[k]]
        paused[k] = between.size > 0 and np.abs(between).min() < 0.2 * abs(rate[first[k]])
    return paused


def _crossing(t: Array, theta: Array, first: NDArray[np.intp], level: Array) -> Array:
    """When θ passes `level` between sample `first − 1` and `first`, linearly (the first sample's time at a start)."""
    previous = np.maximum(first - 1, 0)
    rise = theta[first] - theta[previous]
    share = np.divide(level - theta[previous], rise, out=np.ones_like(rise), where=rise != 0.0)
    return np.asarray(t[previous] + np.clip(share, 0.0, 1.0) * (t[first] - t[previous]))


def _landing(theta: Array, sign: Signs, last: NDArray[np.intp], down_rad: float) -> NDArray[np.intp]:
    """The last sample of each excursion before it is back at `down_rad`: impacts too small to count may follow it, after which
    the statue leans to the same side again."""
    landing = np.empty_like(last)
    for side in (-1, 1):
        of = sign == side
        down = np.append(np.flatnonzero(side * theta <= down_rad), theta.size)
        landing[of] = down[np.searchsorted(down, last[of])] - 1
    return landing


def _impacts(t: Array, theta: Array, rate: Array, i: NDArray[np.intp]) -> Array:
    """Time of θ = 0 after sample `i`, the last before it.

    The velocity jumps between two samples, so the side before is extrapolated by its own parabola: θ + θ̇τ + θ̈τ²/2 = 0 with
    θ̈ from the last two samples before.
    """
    following = np.minimum(i + 1, t.size - 1)
    step = t[following] - t[i]
    accel = _slope(t, rate, np.maximum(i - 1, 0), i)
    # The least τ ≥ 0 of that, by the form that does not cancel.
    root = np.sqrt(np.maximum(rate[i] * rate[i] - 2.0 * accel * theta[i], 0.0))
    q = -(rate[i] + np.copysign(root, rate[i]))
    wait = np.abs(np.divide(2.0 * theta[i], q, out=np.zeros_like(q), where=q != 0.0))
    # Sinking to rest takes a few samples: allow the fall from there.
    crossed = theta[following] * np.sign(theta[i]) <= 0.0
    longest = np.where(crossed, step, 3.0 * step + np.abs(theta[i]) / np.maximum(np.abs(rate[i]), 1e-12))
    return np.asarray(t[i] + np.minimum(wait, longest))


def _after(t: Array, theta: Array, rate: Array, impact: Array) -> Array:
    """The rate just after each impact, shape (k,), from the samples until the next one, seen or too small to be.

    A contact engine's impact takes one to three of its own steps, so the sample beside it may lie inside the impact: it is left
    out.
    """
    beside = np.minimum(np.searchsorted(t, np.where(np.isfinite(impact), impact, t[-1]), side="right"), t.size - 1)
    side = np.where(np.abs(theta) > CHATTER_RAD, np.sign(theta), 0.0)
    ends = np.append(np.flatnonzero(np.diff(side)), t.size - 1)
    return _extrapolated(
        t, rate, impact, np.minimum(beside + 1, t.size - 1), 1, ends[np.searchsorted(ends, beside)] - beside
    )


def _extrapolated(
    t: Array, rate: Array, to_s: Array, start: NDArray[np.intp], towards: int, count: NDArray[np.intp]
) -> Array:
    """The rate at `to_s` by the line through sample `start` and the next one away from it; NaN where `count` allows no two.

    A line, though a parabola would be nearer where θ̈ changes: a contact engine loses its contact for single steps, and three
    samples magnify what that leaves in the rate fivefold.
    """
    i = np.clip(start, 0, t.size - 1)
    j = np.clip(start + towards, 0, t.size - 1)
    at = rate[i] + _slope(t, rate, np.minimum(i, j), np.maximum(i, j)) * (to_s - t[i])
    return np.where(count >= 2, at, np.nan)


def _slope(t: Array, rate: Array, i: NDArray[np.intp], j: NDArray[np.intp]) -> Array:
    step = t[j] - t[i]
    return np.divide(rate[j] - rate[i], step, out=np.zeros_like(step), where=step > 0.0)


@dataclass(frozen=True, eq=False)
class Matched:
    """Events of two histories that are the same event: indices into each, and how many have no partner."""

    index_a: NDArray[np.intp]
    index_b: NDArray[np.intp]
    alone_a: int
    alone_b: int


ALWAYS: Final = (-math.inf, math.inf)
Events = tuple[Array, Signs, Array]
"""Of each event its time, s, its side, and how far from it the same event of another history may be, s."""


def match(a: Events, b: Events, common_s: tuple[float, float] = ALWAYS) -> Matched:
    """Pair events that are each other's nearest on the same side and no further apart than both allow.

    Pairs whose event in b, and events alone, come before or after the stretch `common_s` are left out. Mutual nearest neighbours
    on a line never cross, so the order of time is kept.
    """
    (time_a, side_a, window_a), (time_b, side_b, window_b) = a, b
    pairs = [np.zeros((2, 0), dtype=np.intp)]
    for side in (-1, 1):
        of_a, of_b = np.flatnonzero(side_a == side), np.flatnonzero(side_b == side)
        if of_a.size and of_b.size:
            to_b, to_a = _nearest(time_a[of_a], time_b[of_b]), _nearest(time_b[of_b], time_a[of_a])
            mutual = to_a[to_b] == np.arange(of_a.size)
            i, j = of_a[mutual], of_b[to_b[mutual]]
            close = np.abs(time_a[i] - time_b[j]) <= np.minimum(window_a[i], window_b[j])
            pairs.append(np.stack([i[close], j[close]]))
    matched = np.concatenate(pairs, axis=1)
    index_a, index_b = matched[:, np.argsort(matched[0], kind="stable")]
    there_a, there_b = ((common_s[0] <= times) & (times <= common_s[1]) for times in (time_a, time_b))
    alone = (int(np.delete(there, index).sum()) for there, index in ((there_a, index_a), (there_b, index_b)))
    inside = there_b[index_b]
    return Matched(index_a[inside], index_b[inside], *alone)


def _nearest(from_s: Array, to_s: Array) -> NDArray[np.intp]:
    right = np.clip(np.searchsorted(to_s, from_s), 0, to_s.size - 1)
    left = np.maximum(right - 1, 0)
    return np.where(np.abs(to_s[left] - from_s) <= np.abs(to_s[right] - from_s), left, right)


# Scores of events: matched uplifts and impacts.


def event_scores(
    a: Excursions, b: Excursions, inertia: Inertia | None, common_s: tuple[float, float] = ALWAYS
) -> dict[str, Any]:
    """Matched uplifts and impacts of two histories, and the energy that each matched impact takes; pairs whose event in b, and
    events alone, come before or after the stretch `common_s` are left out."""
    rise_a, rise_b = a.from_rest, b.from_rest
    up_a, up_b = a.uplift_s[rise_a], b.uplift_s[rise_b]
    uplifts = match((up_a, a.side[rise_a], a.length_s[rise_a]), (up_b, b.side[rise_b], b.length_s[rise_b]), common_s)
    down_a, down_b = a.landed, b.landed
    times_a, times_b = a.impact_s[down_a], b.impact_s[down_b]
    # An impact is the same one when it is off by less than half the excursion that it ends.
    impacts = match(
        (times_a, a.side[down_a], 0.5 * a.length_s[down_a]),
        (times_b, b.side[down_b], 0.5 * b.length_s[down_b]),
        common_s,
    )
    index_a, index_b = np.flatnonzero(down_a)[impacts.index_a], np.flatnonzero(down_b)[impacts.index_b]
    share_a, share_b = share_lost(a, inertia)[index_a], share_lost(b, inertia)[index_b]
    return {
        "uplift_time_differences_s": _list(up_a[uplifts.index_a] - up_b[uplifts.index_b]),
        "uplifts_alone_a": uplifts.alone_a,
        "uplifts_alone_b": uplifts.alone_b,
        "impact_times_a_s": _list(times_a[impacts.index_a]),
        "impact_time_differences_s": _list(times_a[impacts.index_a] - times_b[impacts.index_b]),
        "impacts_alone_a": impacts.alone_a,
        "impacts_alone_b": impacts.alone_b,
        "impact_energy_share_lost_a": _list(share_a),
        "impact_energy_share_lost_b": _list(share_b),
        "impact_energy_lost_a_j": None if inertia is None else _list(lost_j(a, inertia)[index_a]),
        "impact_energy_lost_b_j": None if inertia is None else _list(lost_j(b, inertia)[index_b]),
    }


def _list(values: Array) -> tuple[float | None, ...]:
    return tuple(None if math.isnan(value) else value for value in values.tolist())


Inertia = Mapping[int, float]
"""J_s about the corner on each side (+1 right, −1 left), for the energy of rocking, ½ J_s θ̇² (docs/model.md, section 1)."""


def _about(inertia: Inertia, side: NDArray[Any]) -> Array:
    """J of the corner on each side, shape of `side`."""
    return np.where(side > 0, inertia[1], inertia[-1])


def share_lost(excursions: Excursions, inertia: Inertia | None) -> Array:
    """Share of the rocking energy lost in each impact, shape (k,); NaN where the history ends before it, or has too few
    samples to tell a rate before or after it.

    At θ = 0 both corners touch and the potential energy is the same, so the share is 1 − J_new θ̇⁺²/(J_old θ̇⁻²). Without
    inertias J_new = J_old is taken (a symmetric body). When the statue falls back on the corner that it came from, or
    rests, the new corner is the side of θ̇⁺.
    """
    before, after = excursions.rate_before_rad_s, excursions.rate_after_rad_s
    ratio = np.ones_like(before)
    if inertia is not None:
        ratio = _about(inertia, np.sign(after)) / _about(inertia, excursions.side)
    energy = before * before
    lost: Array = 1.0 - np.divide(ratio * after * after, energy, out=np.full_like(energy, np.nan), where=energy > 0.0)
    return lost


def lost_j(excursions: Excursions, inertia: Inertia) -> Array:
    """Energy in J that each impact takes from the rocking motion, shape (k,)."""
    before = 0.5 * _about(inertia, excursions.side) * excursions.rate_before_rad_s**2
    taken: Array = share_lost(excursions, inertia) * before
    return taken
