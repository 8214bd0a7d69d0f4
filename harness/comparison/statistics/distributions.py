"""Distributions compared: empirical distances, bootstrap bands, binomial intervals."""

from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from harness.model.history import Array
from harness.records.scores import CONFIDENCE, Interval
from harness.records.validation import DistributionScores, LogPeaks

ROUNDING: Final = 1e-12
"""Of a distance, which is a ratio of counts."""
RESAMPLES: Final = 1000
"""Bootstrap resamples: the 2.5 % quantile then rests on 25 of them, a standard error of 0.5 % in probability."""


def _sample(values: ArrayLike, name: str) -> Array:
    array = np.sort(np.asarray(values, dtype=np.float64).ravel())
    if array.size == 0 or not np.all(np.isfinite(array)):
        raise ValueError(f"sample {name}: at least one value, all finite, wanted; got {array.size} values")
    return array


def _distributions(a: Array, b: Array) -> tuple[Array, Array, Array]:
    """All values in order, and both empirical distribution functions just after each."""
    every = np.sort(np.concatenate((a, b)))
    return (
        every,
        np.searchsorted(a, every, side="right") / a.size,
        np.searchsorted(b, every, side="right") / b.size,
    )


def ks_distance(a: ArrayLike, b: ArrayLike) -> float:
    """Kolmogorov and Smirnov's distance: the largest gap between two empirical distribution functions."""
    _, f_a, f_b = _distributions(_sample(a, "a"), _sample(b, "b"))
    return float(np.max(np.abs(f_a - f_b)))


def area_metric(a: ArrayLike, b: ArrayLike) -> float:
    """The area between two empirical distribution functions (Wasserstein's distance), in the unit of the values."""
    every, f_a, f_b = _distributions(_sample(a, "a"), _sample(b, "b"))
    return float(np.abs(f_a - f_b)[:-1] @ np.diff(every))


def wilson(hits: int, total: int, confidence: float = CONFIDENCE) -> Interval | None:
    """A proportion with Wilson's score interval (JASA 22, 1927); None of an empty set."""
    if total == 0:
        return None
    from statistics import NormalDist

    z = NormalDist().inv_cdf(0.5 + 0.5 * confidence)
    p = hits / total
    centre = (p + z * z / (2.0 * total)) / (1.0 + z * z / total)
    half = z / (1.0 + z * z / total) * float(np.sqrt(p * (1.0 - p) / total + z * z / (4.0 * total * total)))
    return Interval(
        p, min(centre - half, p) if hits else 0.0, max(centre + half, p) if hits < total else 1.0, confidence
    )


def bootstrap(
    score: Callable[[NDArray[np.intp]], float],
    size: int,
    *,
    seed: int = 0,
    resamples: int = RESAMPLES,
) -> Interval | None:
    """Percentile bootstrap of a score of `size` cases, given their indices; None when it is nowhere defined.

    Resamples in which the score is not defined (NaN) are left out.
    """
    if size == 0:
        return None
    value = score(np.arange(size))
    rng = np.random.default_rng(seed)
    scores = np.array([score(rng.integers(0, size, size)) for _ in range(resamples)])
    scores = scores[np.isfinite(scores)]
    if not np.isfinite(value) or scores.size == 0:
        return None
    tail = 0.5 * (1.0 - CONFIDENCE)
    low, high = np.quantile(scores, (tail, 1.0 - tail))
    return Interval(float(value), float(low), float(high), CONFIDENCE)


def compare_logarithms(a: ArrayLike, b: ArrayLike, *, seed: int = 0, resamples: int = RESAMPLES) -> LogPeaks | None:
    """Median and dispersion of positive values of the same cases (n,) in two models; intervals by resampling cases.

    A pair stays a pair, so that what both models share of a motion's luck is in neither interval. None where one has no scatter.
    """
    x, y = (np.log(np.asarray(values, dtype=np.float64)) for values in (a, b))

    def spread(cases: NDArray[np.intp]) -> float:
        own, other = (float(np.std(values[cases], ddof=1)) for values in (x, y))
        return own / other if other > 0.0 else np.nan

    def middle(cases: NDArray[np.intp]) -> float:
        return float(np.exp(np.median(x[cases]) - np.median(y[cases])))

    median, ratio = (bootstrap(each, x.size, seed=seed, resamples=resamples) for each in (middle, spread))
    if median is None or ratio is None:
        return None
    return LogPeaks(x.size, median, float(np.std(x, ddof=1)), float(np.std(y, ddof=1)), ratio)


def compare_distributions(
    a: ArrayLike, b: ArrayLike, *, seed: int = 0, resamples: int = RESAMPLES, paired: bool = False
) -> DistributionScores:
    """Compare two samples (peak rotations of two models over many motions) by distribution.

    What chance does to area and distance is found by shuffling the two together: the area's 95 % quantile, and how often the
    distance is at least as large.

    `paired`: both are of the same cases in one order; the area's interval is then of the cases resampled, each pair as one.
    """
    first, second = (np.asarray(values, dtype=np.float64).ravel() for values in (a, b))
    x, y = _sample(a, "a"), _sample(b, "b")
    rng = np.random.default_rng(seed)
    pooled = np.concatenate((x, y))
    drawn = np.empty(resamples)
    null, gaps = np.empty(resamples), np.empty(resamples)
    for k in range(resamples):
        i = rng.integers(0, x.size, x.size)
        j = i if paired else rng.integers(0, y.size, y.size)
        drawn[k] = area_metric(first[i], second[j])
        shuffled = rng.permutation(pooled)
        parts = shuffled[: x.size], shuffled[x.size :]
        null[k], gaps[k] = area_metric(*parts), ks_distance(*parts)
    tail = 0.5 * (1.0 - CONFIDENCE)
    low, high = np.quantile(drawn, (tail, 1.0 - tail))
    area, distance = area_metric(x, y), ks_distance(x, y)
    # The samples as they are count as one of the shuffles (Phipson & Smyth, 2010): no p is 0.
    p = float(1 + np.sum(gaps >= distance - ROUNDING)) / (1 + resamples)
    return DistributionScores(
        x.size,
        y.size,
        distance,
        p,
        # Resamples of samples that are alike differ more than these do.
        Interval(area, min(float(low), area), max(float(high), area)),
        float(np.quantile(null, CONFIDENCE)),
    )
