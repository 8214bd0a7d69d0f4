"""Outcomes over a set of cases: confusion by side, classification scores with confidence intervals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.comparison.statistics.distributions import bootstrap, wilson
from harness.model.history import Outcome
from harness.records.scores import Interval
from harness.records.sets import OutcomeScores

Flags = NDArray[np.bool_]

FELL: Final = "overturned"
"""An observation that says that the statue fell, not to which side."""

DECIDED: Final = tuple(outcome for outcome in Outcome if outcome.fell is not None)
"""Outcomes that say whether the statue fell; the others (a wall, a lift-off, a failure) are counted apart."""


@dataclass(frozen=True)
class Case:
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


def score_outcomes(cases: Sequence[Case], *, seed: int = 0) -> OutcomeScores:
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
        f1=bootstrap(lambda index: f1(predicted[index], observed[index]), size, seed=seed),
        matthews=bootstrap(lambda index: matthews(predicted[index], observed[index]), size, seed=seed),
        no_return_difference_s=_no_return(sure, seed),
    )


def _no_return(cases: Sequence[Case], seed: int) -> Interval | None:
    """Mean difference of the no-return times over cases that overturn in both."""
    both = [case.no_return_s for case in cases if None not in case.no_return_s]
    differences = np.array([(a or 0.0) - (b or 0.0) for a, b in both])
    return bootstrap(lambda index: float(np.mean(differences[index])), differences.size, seed=seed)


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
