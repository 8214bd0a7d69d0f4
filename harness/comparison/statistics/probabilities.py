"""Probabilities of falling held against outcomes: Brier's score, area under the curve, reliability by bins."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from harness.comparison.statistics.distributions import bootstrap, wilson
from harness.model.history import Array
from harness.records.scores import CONFIDENCE, Interval
from harness.records.sets import ReliabilityBin

EDGES: Final = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
"""Bins of equal width: with a hundred tests each holds some twenty, whose share is then known to about 0.2."""


def brier(probability: ArrayLike, observed: ArrayLike) -> float:
    """Brier's score, the mean square of probability minus outcome (0 perfect, 0.25 a coin); NaN of an empty set.

    Raises `ValueError` for a probability outside [0, 1].
    """
    p, o = np.asarray(probability, dtype=np.float64), np.asarray(observed, dtype=np.float64)
    if p.shape != o.shape or np.any((p < 0.0) | (p > 1.0) | ~np.isfinite(p)):
        raise ValueError(f"probabilities from 0 to 1, one for each outcome, wanted; got {p.size} for {o.size} outcomes")
    return float(np.mean((p - o) ** 2)) if p.size else float("nan")


def brier_skill(probability: ArrayLike, observed: ArrayLike) -> float:
    """1 − Brier/Brier of the base rate: 1 perfect, 0 no better than always saying the share that fell; NaN of one class."""
    o = np.asarray(observed, dtype=np.float64)
    base = brier(np.full(o.shape, o.mean() if o.size else 0.0), o)
    return 1.0 - brier(probability, o) / base if base > 0.0 else float("nan")


def area_under_curve(probability: ArrayLike, observed: ArrayLike, *, seed: int = 0) -> Interval | None:
    """The chance that a case that fell was given a higher probability than one that stood (ties count half); None of one class.

    Mann and Whitney's statistic, which is the area under the receiver operating characteristic (Hanley and McNeil 1982), with its
    bootstrap interval.
    """
    p, o = np.asarray(probability, dtype=np.float64), np.asarray(observed, dtype=np.bool_)

    def area(index: NDArray[np.intp]) -> float:
        from scipy.stats import rankdata

        fell = o[index]
        first, second = int(fell.sum()), int((~fell).sum())
        if not first or not second:
            return float("nan")
        ranks = rankdata(p[index])
        return float((ranks[fell].sum() - 0.5 * first * (first + 1)) / (first * second))

    return bootstrap(area, p.size, seed=seed)


def reliability(
    probability: ArrayLike, observed: ArrayLike, edges: Sequence[float] = EDGES, confidence: float = CONFIDENCE
) -> list[ReliabilityBin]:
    """Cases in bins of their probability: mean probability, share that fell, and the band within which true ones keep that share.

    Bins without a case are left out; the last includes its upper edge.
    """
    p, o = np.asarray(probability, dtype=np.float64), np.asarray(observed, dtype=np.bool_)
    number = np.clip(np.searchsorted(edges, p, side="right") - 1, 0, len(edges) - 2)
    bins = []
    for k in range(len(edges) - 1):
        inside = number == k
        share = wilson(int(o[inside].sum()), int(inside.sum()), confidence)
        if share is not None:
            low, high = _band(p[inside], confidence)
            mean = float(p[inside].mean())
            bins.append(ReliabilityBin(edges[k], edges[k + 1], int(inside.sum()), mean, share, low, high))
    return bins


def _band(p: Array, confidence: float) -> tuple[float, float]:
    """Where the share that falls lies with this confidence, each case falling with its own probability (Poisson binomial)."""
    counts = np.ones(1)
    for each in p:
        counts = np.convolve(counts, (1.0 - each, each))
    below = np.cumsum(counts)
    tail = 0.5 * (1.0 - confidence)
    low, high = (int(np.searchsorted(below, level)) for level in (tail, 1.0 - tail))
    return low / p.size, min(high, p.size) / p.size
