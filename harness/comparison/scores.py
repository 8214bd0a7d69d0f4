"""Scores of two rotation histories: sample by sample, by their uplifts and impacts, and by distribution; none knows an engine."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from harness.comparison.statistics import area_metric, compare_distributions, ks_distance
from harness.model import Array, Finding, History, Pair, Run, caution, first_beyond_s, info, require, translated
from harness.records.scores import AfterHorizon, Apart, ComparisonError, IsoRating, PeaksApart

# Sample by sample: differences, peaks, how long two histories stay together.

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


def peak_of(history: History, until_s: float = math.inf) -> Peak:
    """The largest |θ| up to `until_s`, signed; between samples it is the Hermite value where the rate, taken as linear, vanishes.

    A history that begins later than `until_s` gives its first sample.
    """
    count = max(int(np.searchsorted(history.t_s, until_s, side="right")), 1)
    k = int(np.argmax(np.abs(history.theta_rad[:count])))
    best = Peak(float(history.theta_rad[k]), float(history.t_s[k]))
    rate = history.theta_rate_rad_s
    for i in (k - 1, k):
        if 0 <= i < rate.size - 1 and rate[i] * rate[i + 1] < 0.0:
            share = rate[i] / (rate[i] - rate[i + 1])
            time = float(history.t_s[i] + share * (history.t_s[i + 1] - history.t_s[i]))
            theta = float(history.at(np.array([time]))[0])
            if abs(theta) > abs(best.theta_rad) and time <= until_s:
                best = Peak(theta, time)
    return best


def sprague_geers(pair: Pair) -> dict[str, Any]:
    """Sprague and Geers' integral errors, b being the reference (Shock and Vibration Bulletin 60, 1989).

    M = √(∫a²/∫b²) − 1, P = acos(∫ab/√(∫a²∫b²))/π, C = √(M² + P²).
    """
    a, b = pair.theta_a_rad, pair.theta_b_rad
    aa, bb, ab = pair.integral(a, a), pair.integral(b, b), pair.integral(a, b)
    if aa == 0.0 and bb == 0.0:
        return {"magnitude": 0.0, "phase": 0.0, "combined": 0.0}
    magnitude = None if bb == 0.0 else math.sqrt(aa / bb) - 1.0
    if aa == 0.0 or bb == 0.0:
        return {"magnitude": magnitude, "phase": None, "combined": None}
    phase = 0.0 if np.array_equal(a, b) else math.acos(min(max(ab / math.sqrt(aa * bb), -1.0), 1.0)) / math.pi
    return {"magnitude": magnitude, "phase": phase, "combined": math.hypot(magnitude or 0.0, phase)}


def together_until_s(pair: Pair, tolerance_rad: float) -> float:
    """The time up to which |θ_a − θ_b| has stayed within the tolerance; the window's end when it always does."""
    left = first_beyond_s(pair.t_s, np.abs(pair.difference_rad), tolerance_rad)
    return pair.end_s if left is None else left


# ISO/TS 18571 by the library of TU Graz (extra `iso`), on a stated resampling; loaded only when asked.

ISO_SAMPLES: Final = 1001
"""Samples after resampling: the rating's time warping costs the square of their number in time and memory."""

WEIGHTS: Final = {"corridor": 0.4, "phase": 0.2, "magnitude": 0.2, "slope": 0.2}
"""Weights of the overall rating (ISO/TS 18571, also the library's defaults)."""


def rate_by_iso(pair: Pair, samples: int = ISO_SAMPLES) -> IsoRating:
    """Corridor, phase, magnitude, slope and overall rating (1 is perfect) of θ_a against θ_b.

    The specification was made for signals at 10 kHz; here both histories are resampled linearly to `samples` equal steps over
    the window, and that step is stated. Raises `InputError` when the extra is not installed, the window is too short, or a
    history does not move (the rating divides by its norm).
    """
    advice = 'install it: pip install "rockcheck[iso]"'
    with translated(ImportError, "--iso", "the extra `iso`", "no objective_rating_metrics", advice):
        from objective_rating_metrics.rating import ISO18571
    require(pair.t_s.size >= 10, "--iso", "at least 10 common samples", f"{pair.t_s.size}")
    require(
        np.ptp(pair.theta_a_rad) > 0.0 and np.ptp(pair.theta_b_rad) > 0.0,
        "--iso",
        "two histories that move",
        "one that stays at a constant rotation",
    )
    curves, step = resampled(pair, samples)
    rating = ISO18571(reference_curve=curves[1], comparison_curve=curves[0], dt=step)
    # Each rating once: the library's own overall_rating computes them all again.
    parts = {
        "corridor": float(rating.corridor_rating(-1)),
        "phase": float(rating.phase_rating(-1)),
        "magnitude": float(rating.magnitude_rating(-1)),
        "slope": float(rating.slope_rating(-1)),
    }
    overall = sum(WEIGHTS[name] * value for name, value in parts.items())
    return IsoRating(**parts, overall=overall, resampled_dt_s=step, samples=samples)


def resampled(pair: Pair, samples: int) -> tuple[tuple[Any, Any], float]:
    """Both rotations as (samples, 2) arrays of time and value on equal steps, and the step in s."""
    t_s = np.linspace(pair.start_s, pair.end_s, samples)
    curves = [np.column_stack((t_s, np.interp(t_s, pair.t_s, x))) for x in (pair.theta_a_rad, pair.theta_b_rad)]
    return (curves[0], curves[1]), float(t_s[1] - t_s[0])


# A simulation against a measurement: the comparison error E = S − D and the uncertainties of both (ASME V&V 20).

RECTANGLE: Final = 1.0 / math.sqrt(3.0)
"""Standard uncertainty of what is only known to lie within ± 1 (GUM, 4.3.7): a stated numerical error is such a bound."""
COVERAGE: Final = 2.0
"""Standard uncertainties within which 95 % of errors lie."""
LARGEST_RAD: Final = 1.0


@dataclass(frozen=True)
class Measured:
    """Standard uncertainties, rad, of a measured rotation, and of a computed one because its inputs are not known."""

    data_rad: float
    input_rad: float = 0.0

    def __post_init__(self) -> None:
        for name, value in (("--measured-uncertainty", self.data_rad), ("--input-uncertainty", self.input_rad)):
            require(0.0 <= value < LARGEST_RAD, name, f"a rotation from 0 to {LARGEST_RAD:g} rad", f"{value!r}")


def comparison_error(
    within: Pair, peaks: tuple[Peak, Peak], numerical_rad: float, measured: Measured, until_s: float | None = None
) -> tuple[ComparisonError, Finding]:
    """E of the largest rotation and over the history of a simulation (first) against a measurement, and what it says.

    `numerical_rad` bounds the simulation's numerical error; `until_s`: up to when they are compared, where that is not to the
    end. ASME V&V 20-2009, section 1: u_val² = u_num² + u_input² + u_D², and the model's own error lies within E ± 2 u_val.
    """
    simulated, seen = (abs(each.theta_rad) for each in peaks)
    own = RECTANGLE * numerical_rad
    total = math.hypot(own, measured.input_rad, measured.data_rad)
    beyond = np.abs(within.difference_rad) > COVERAGE * total
    found = ComparisonError(
        simulated_rad=simulated,
        measured_rad=seen,
        error_rad=simulated - seen,
        rms_error_rad=rms(within, within.difference_rad),
        beyond_share=float(within.weights_s @ beyond / within.weights_s.sum()),
        u_num_rad=own,
        u_input_rad=measured.input_rad,
        u_data_rad=measured.data_rad,
        u_val_rad=total,
    )
    apart = abs(found.error_rad) > COVERAGE * total
    values = {
        "until_s": until_s,
        "error_rad": found.error_rad,
        "u_val_rad": total,
        "beyond_share": found.beyond_share,
        "low_rad": found.error_rad - COVERAGE * total,
        "high_rad": found.error_rad + COVERAGE * total,
        "u_num_rad": own,
        "u_input_rad": measured.input_rad,
        "u_data_rad": measured.data_rad,
    }
    return found, caution("model_error", **values) if apart else info("model_error_not_told", **values)


# Uplifts and impacts of a history, found in the same way on both sides, and matched between two histories.

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


def excursions_of(history: History, threshold_rad: float = UPLIFT_RAD) -> Excursions:
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
    between = [rate[landed + 1 : lifted] for landed, lifted in zip(last[:-1], first[1:], strict=True)]
    paused = [
        each.size > 0 and np.abs(each).min() < 0.2 * abs(rate[lifted])
        for each, lifted in zip(between, first[1:], strict=True)
    ]
    return np.array([True, *paused], dtype=np.bool_)


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

Inertia = Mapping[int, float]
"""J_s about the corner on each side (+1 right, −1 left), for the energy of rocking, ½ J_s θ̇² (docs/model.md, section 1)."""


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
    left = np.divide(ratio * after * after, energy, out=np.full_like(energy, np.nan), where=energy > 0.0)
    return np.asarray(1.0 - left)


def lost_j(excursions: Excursions, inertia: Inertia) -> Array:
    """Energy in J that each impact takes from the rocking motion, shape (k,)."""
    before = 0.5 * _about(inertia, excursions.side) * excursions.rate_before_rad_s**2
    return np.asarray(share_lost(excursions, inertia) * before)


# Two histories beyond the horizon, where no instant of one can be asked of the other: their distributions.

LEAST_VALUES: Final = 8
"""Fewer values than this have no distribution worth a probability: a quartile would rest on two values."""
RESAMPLES: Final = 200
"""Resamples for the interval and for what chance alone gives: the 95 % quantile then rests on 10 of them."""
ROTATION_INSTANTS: Final = 1001
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
    t_s = np.linspace(begin_s, both.end_s, ROTATION_INSTANTS)
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
