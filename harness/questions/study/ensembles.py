"""Many cases, several models: outcomes, verdicts and distributions of each model against a reference model."""

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Final

from harness.comparison.comparator import judge, shares, side_of
from harness.comparison.scores import LEAST_VALUES
from harness.comparison.statistics import (
    RESAMPLES,
    Prediction,
    compare_distributions,
    compare_logarithms,
    score_outcomes,
)
from harness.model import History, Outcome, pair
from harness.questions.study.case_blocks import KeyedRow
from harness.records.run import in_domain
from harness.records.scores import Verdict
from harness.records.study import CaseRun
from harness.records.validation import SetScores

Answered = tuple[CaseRun, str | None]
"""A run, and the key of its history in the store."""

ROCKS_RAD: Final = 1e-4
"""A statue that leans by less is at rest: what a contact engine gives (some 1e-5 rad) is no rocking."""
MANY: Final = 1000
"""From here on a fifth of the bootstrap's resamples do: each costs the sorting of all cases."""


def score_sets(
    rows: Sequence[KeyedRow], reference: str = "analytic", history: Callable[[str], History | None] = lambda key: None
) -> dict[str, SetScores]:
    """Scores of every other model against the reference over the cases that both answered, by model's name.

    `history(key)` gives a run's history where one was kept: verdicts then rest on the histories, otherwise on peaks and
    outcomes alone. The distributions of the peaks are compared from 8 cases on.
    """
    cases: dict[int, dict[str, Answered]] = defaultdict(dict)
    for row in rows:
        if row.run is not None and not row.run.outcome.failed:
            cases[row.number][row.engine] = row.run, row.key
    names = sorted({row.engine for row in rows} - {reference})
    return {name: _score(name, reference, cases.values(), history) for name in names}


def _score(
    name: str, reference: str, cases: Iterable[Mapping[str, Answered]], history: Callable[[str], History | None]
) -> SetScores:
    both = [(case[name], case[reference]) for case in cases if name in case and reference in case]
    judged = [_judged(a, b, history) for a, b in both]
    told = [(a, b) for (a, _), (b, _) in both if in_domain(a) and in_domain(b)]
    peaks = None
    if len(told) >= LEAST_VALUES:
        sides = [[_peak_rad(run) for run in side] for side in zip(*told, strict=True)]
        peaks = compare_distributions(*sides, paired=True, resamples=RESAMPLES if len(told) <= MANY else RESAMPLES // 5)
    rocked = [[_peak_rad(run) for run in pair] for pair in told if all(map(_rocks, pair))]
    log_peaks = compare_logarithms(*zip(*rocked, strict=True)) if len(rocked) >= LEAST_VALUES else None
    return SetScores(
        reference=reference,
        cases=len(told),
        same=sum(a.outcome.same_as(b.outcome) for a, b in told),
        outcomes=score_outcomes([case for case, _ in judged]),
        verdicts=shares([verdict for _, verdict in judged]),
        flips=sum(case.within_uncertainty for case, _ in judged),
        peaks=peaks,
        log_peaks=log_peaks,
    )


def _peak_rad(run: CaseRun) -> float:
    """The largest rotation; none at rest, where what a contact engine gives would come after every zero of the model."""
    peak_rad = abs(run.peak_theta_rad)
    return peak_rad if peak_rad > ROCKS_RAD else 0.0


def _rocks(run: CaseRun) -> bool:
    """Whether the statue rocks and stands: at rest it has no logarithm, falling no largest rotation."""
    return run.outcome is Outcome.STANDS and _peak_rad(run) > 0.0


def _judged(a: Answered, b: Answered, history: Callable[[str], History | None]) -> tuple[Prediction, Verdict]:
    (first, key_a), (second, key_b) = a, b
    history_a, history_b = (None if key is None else history(key) for key in (key_a, key_b))
    sides = side_of(first, first.engine), side_of(second, second.engine)
    both = None
    if history_a is not None and history_b is not None:
        both = pair(history_a, history_b, hold_a=sides[0].rests, hold_b=sides[1].rests)
    verdict, evidence, _ = judge(*sides, both)
    flips = evidence.outcome_flips_within_uncertainty, evidence.side_flips_within_uncertainty
    times = first.no_return_time_s, second.no_return_time_s
    predicted, observed = (run.outcome if in_domain(run) else Outcome.UNDECIDED for run in (first, second))
    return Prediction(predicted, observed, *flips, times), verdict
