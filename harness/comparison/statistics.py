"""Many cases instead of one history: distributions compared, outcomes counted and scored, fragility fitted.

Pure functions of numbers and outcomes; `harness.comparison.scores` compares the histories of one case.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from statistics import NormalDist
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from harness.model import Array, Outcome
from harness.records.scores import CONFIDENCE, Interval
from harness.records.validation import DistributionScores, FragilityCurve, LogPeaks, OutcomeScores, ReliabilityBin

Flags = NDArray[np.bool_]

# Distributions compared: empirical distances, bootstrap bands, binomial intervals.

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


# Outcomes over a set of cases: confusion by side, scores with their intervals; probabilities held against outcomes.

FELL: Final = "overturned"
"""An observation that says that the statue fell, not to which side."""

DECIDED: Final = tuple(outcome for outcome in Outcome if outcome.fell is not None)
"""Outcomes that say whether the statue fell; the others (a wall, a lift-off, a failure) are counted apart."""


@dataclass(frozen=True)
class Prediction:
    """One case: what is predicted, what is true (observed, or the reference model's).

    `observed` is an outcome, or `FELL` where the side is not known.
    `within_uncertainty`: the predicted outcome flips within its stated uncertainty, so that it decides nothing.
    `side_within_uncertainty`: both overturn, and only the side does, so that `side_accuracy` leaves it out.
    `no_return_s` are the two no-return times, None where there was none.
    """

    predicted: Outcome
    observed: Outcome | str
    within_uncertainty: bool = False
    side_within_uncertainty: bool = False
    no_return_s: tuple[float | None, float | None] = (None, None)

    @property
    def fell(self) -> bool:
        """Whether the statue truly overturned, whichever way."""
        return self.observed == FELL or (isinstance(self.observed, Outcome) and self.observed.overturned)

    @property
    def decided(self) -> bool:
        """Whether both outcomes say if the statue fell."""
        return self.predicted in DECIDED and (self.observed in DECIDED or self.observed == FELL)


def score_outcomes(cases: Sequence[Prediction]) -> OutcomeScores:
    """Score predicted outcomes against observed ones."""
    decided = [case for case in cases if case.decided]
    sure = [case for case in decided if not case.within_uncertainty]
    names = [outcome.value for outcome in DECIDED]
    confusion = {observed: dict.fromkeys(names, 0) for observed in (*names, FELL)}
    for case in sure:
        confusion[str(case.observed)][case.predicted.value] += 1
    predicted = np.array([case.predicted.overturned for case in sure], dtype=np.bool_)
    observed = np.array([case.fell for case in sure], dtype=np.bool_)
    hits = int(np.sum(predicted & observed))
    size = len(sure)
    sided = [case for case in sure if case.observed != FELL and not case.side_within_uncertainty]
    return OutcomeScores(
        cases=len(cases),
        undecided=len(cases) - len(decided),
        within_uncertainty=len(decided) - size,
        confusion=confusion,
        accuracy=wilson(int(np.sum(predicted == observed)), size),
        side_accuracy=wilson(sum(case.predicted is case.observed for case in sided), len(sided)),
        precision=wilson(hits, int(predicted.sum())),
        recall=wilson(hits, int(observed.sum())),
        f1=bootstrap(lambda index: f1(predicted[index], observed[index]), size),
        matthews=bootstrap(lambda index: matthews(predicted[index], observed[index]), size),
        no_return_difference_s=_no_return(sure),
    )


def _no_return(cases: Sequence[Prediction]) -> Interval | None:
    """Mean difference of the no-return times over cases that overturn in both."""
    both = [case.no_return_s for case in cases if None not in case.no_return_s]
    differences = np.array([(a or 0.0) - (b or 0.0) for a, b in both])
    return bootstrap(lambda index: float(np.mean(differences[index])), differences.size)


def f1(predicted: Flags, observed: Flags) -> float:
    """Harmonic mean of precision and recall, 2TP/(2TP + FP + FN); NaN when nothing is positive on either side."""
    positives = int(predicted.sum()) + int(observed.sum())
    return 2.0 * int(np.sum(predicted & observed)) / positives if positives else float("nan")


def matthews(predicted: Flags, observed: Flags) -> float:
    """Matthews' correlation of two classifications (BBA 405, 1975); NaN when either has one class only."""
    if predicted.size == 0 or predicted.all() or observed.all() or not predicted.any() or not observed.any():
        return float("nan")
    tp, tn = float(np.sum(predicted & observed)), float(np.sum(~predicted & ~observed))
    fp, fn = float(np.sum(predicted & ~observed)), float(np.sum(~predicted & observed))
    return (tp * tn - fp * fn) / float(np.sqrt((tp + fp) * (tp + fn) * (tn + fp) * (tn + fn)))


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


def area_under_curve(probability: ArrayLike, observed: ArrayLike) -> Interval | None:
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

    return bootstrap(area, p.size)


def reliability(
    probability: ArrayLike,
    observed: ArrayLike,
    edges: Sequence[float] = EDGES,
    confidence: float = CONFIDENCE,
    possible: NDArray[np.bool_] | None = None,
) -> list[ReliabilityBin]:
    """Cases in bins of their probability: mean probability, share that fell, and the band within which true ones keep that share.

    `possible` (draws, cases) are outcomes of all cases together as what gave the probabilities draws them (Bröcker and Smith
    2007): where cases share something that is not known they are right or wrong together, and the band is wider. Without them
    cases are taken to be independent. Bins without a case are left out; the last includes its upper edge.
    """
    p, o = np.asarray(probability, dtype=np.float64), np.asarray(observed, dtype=np.bool_)
    number = np.clip(np.searchsorted(edges, p, side="right") - 1, 0, len(edges) - 2)
    bins = []
    for k in range(len(edges) - 1):
        inside = number == k
        share = wilson(int(o[inside].sum()), int(inside.sum()), confidence)
        if share is not None:
            if possible is None:
                low, high = _band(p[inside], confidence)
            else:
                tails = 0.5 * (1.0 - confidence), 0.5 * (1.0 + confidence)
                low, high = np.quantile(possible[:, inside].mean(axis=1), tails, method="inverted_cdf").tolist()
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


# Fragility curves: the probability of overturning against the intensity of the motion, lognormal, by maximum likelihood.

STEPS: Final = 60
"""Newton steps allowed; probit likelihoods are concave and take some 6 to 10 from the start used, separated ones the most."""
CONVERGED: Final = 1e-10
"""Newton stops when no coefficient moves by more than this of the largest, or of one; the next step would be rounding."""


@dataclass(frozen=True, eq=False)
class Fragility:
    """P(overturned | x) = Φ(ln(x/median)/dispersion), with the covariance of (intercept, slope) of its linear predictor.

    `separated`: every case that fell was stronger than every one that stood, so that no likelihood has a maximum; `median` is
    then halfway (in the logarithm) between the two that bound it, dispersion 0 and the covariance None. With one class only
    the median is None and nothing can be said beyond `fell` of `cases`.
    """

    cases: int
    fell: int
    median: float | None
    dispersion: float | None
    separated: bool
    bounds: tuple[float, float] | None
    covariance: Array | None

    def probability(self, intensity: ArrayLike) -> Array:
        """P at intensities > 0; NaN where nothing can be said."""
        x = np.asarray(intensity, dtype=np.float64)
        if self.median is None:
            return np.full(x.shape, np.nan)
        if not self.dispersion:
            return np.where(x < self.median, 0.0, 1.0)
        return _phi(np.log(x / self.median) / self.dispersion)

    def band(self, intensity: ArrayLike, confidence: float = CONFIDENCE) -> tuple[Array, Array]:
        """Pointwise confidence band of P from the Fisher information; 0…1 inside the gap where the classes are separated."""
        x = np.asarray(intensity, dtype=np.float64)
        if self.median is None:
            return np.zeros(x.shape), np.ones(x.shape)
        if self.covariance is None or not self.dispersion:
            low, high = self.bounds or (self.median, self.median)
            return np.where(x < high, 0.0, 1.0), np.where(x <= low, 0.0, 1.0)
        design = np.stack((np.ones_like(x), np.log(x)), axis=-1)
        spread = np.sqrt(np.einsum("...i,ij,...j->...", design, self.covariance, design))
        middle = np.log(x / self.median) / self.dispersion
        z = NormalDist().inv_cdf(0.5 + 0.5 * confidence)
        return _phi(middle - z * spread), _phi(middle + z * spread)

    def curve(self, intensity: ArrayLike) -> FragilityCurve:
        """The record, with the curve and its band at intensities."""
        low, high = self.band(intensity)
        probability = [None if math.isnan(p) else p for p in self.probability(intensity).tolist()]
        return FragilityCurve(
            cases=self.cases,
            fell=self.fell,
            median=self.median,
            dispersion=self.dispersion,
            separated=self.separated,
            bounds=self.bounds,
            intensity=np.asarray(intensity).tolist(),
            probability=probability,
            low=low.tolist(),
            high=high.tolist(),
        )


def fit_fragility(intensity: ArrayLike, fell: ArrayLike) -> Fragility:
    """Fit a lognormal fragility curve to cases of one intensity and one outcome each (shape (n,)).

    Maximum likelihood of the Bernoulli outcomes (Baker, Earthquake Spectra 31, 2015), by Newton on the probit's concave
    likelihood. Raises `ValueError` for intensities that are not positive and finite, or no case.
    """
    x, y = np.asarray(intensity, dtype=np.float64).ravel(), np.asarray(fell, dtype=np.float64).ravel()
    if x.size == 0 or x.size != y.size or not np.all(np.isfinite(x) & (x > 0.0)):
        raise ValueError(f"positive intensities, one for each outcome, wanted; got {x.size} for {y.size} outcomes")
    total = int(y.sum())
    if total in (0, x.size):
        return Fragility(x.size, total, None, None, False, None, None)
    low, high = float(x[y == 0].max()), float(x[y == 1].min())
    if low <= high:
        return Fragility(x.size, total, math.sqrt(low * high), 0.0, True, (low, high), None)
    logs = np.log(x)
    centre = float(logs.mean())
    beta, information = probit(np.column_stack((np.ones_like(logs), logs - centre)), y)
    back = np.array([[1.0, -centre], [0.0, 1.0]])
    intercept, slope = (back @ beta).tolist()
    if slope <= 0.0:
        # Stronger motions overturn less often here: no fragility curve rises through these cases.
        return Fragility(x.size, total, None, None, False, None, None)
    return Fragility(
        x.size,
        total,
        math.exp(-intercept / slope),
        1.0 / slope,
        False,
        None,
        back @ np.linalg.inv(information) @ back.T,
    )


def probit(design: Array, y: Array, ridge: float = 0.0) -> tuple[Array, Array]:
    """Coefficients (k,) of greatest likelihood of P = Φ(design β), design (n, k) with its constant first, and the information
    (k, k) there; by damped Newton steps. A `ridge` on the coefficients keeps them finite where a line parts the outcomes."""
    beta = np.zeros(design.shape[1])
    beta[0] = NormalDist().inv_cdf(float(y.mean()))
    information = np.eye(beta.size)

    def value(at: Array) -> float:
        return _probit_terms(design @ at, y)[2] - 0.5 * ridge * float(at @ at)

    for _ in range(STEPS):
        gradient, weight, _ = _probit_terms(design @ beta, y)
        information = design.T @ (weight[:, None] * design) + ridge * np.eye(beta.size)
        step = np.linalg.solve(information, design.T @ gradient - ridge * beta)
        while value(beta + step) < value(beta) - 1e-12 * y.size:
            step = 0.5 * step
        beta = beta + step
        if np.max(np.abs(step)) < CONVERGED * max(1.0, float(np.max(np.abs(beta)))):
            break
    return beta, information


def _probit_terms(eta: Array, y: Array) -> tuple[Array, Array, float]:
    """First derivative of each case's log-likelihood under P = Φ(η), minus the second, and the sum of all."""
    from scipy.special import log_ndtr

    sign = 2.0 * y - 1.0
    signed = sign * eta
    logs = log_ndtr(signed)
    mills = np.exp(-0.5 * signed**2 - 0.5 * math.log(2.0 * math.pi) - logs)
    return sign * mills, mills * (mills + signed), float(np.sum(logs))


def _phi(x: Array) -> Array:
    from scipy.special import ndtr

    return np.asarray(ndtr(x))
