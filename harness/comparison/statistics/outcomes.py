"""Outcomes over a set of cases: confusion by side, scores with their intervals; probabilities held against outcomes."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from harness.comparison.statistics.distributions import bootstrap, wilson
from harness.model.history import Array, Outcome
from harness.records.scores import CONFIDENCE, Interval
from harness.records.validation import OutcomeScores, ReliabilityBin

Flags = NDArray[np.bool_]

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
