"""Many cases, several models: outcomes, verdicts and distributions of each model against a reference model."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

from harness.comparison.scores.pointwise import Peak
from harness.comparison.statistics.distributions import RESAMPLES, compare_distributions
from harness.comparison.statistics.outcomes import Case, score_outcomes
from harness.comparison.verdict import ACROSS, Side, judge, shares
from harness.model.history import History, Outcome
from harness.model.history_pair import Pair, pair
from harness.records.scores import Verdict
from harness.records.sets import SetScores

LEAST: Final = 8
"""Fewer cases than this have no distribution worth comparing: a quartile would rest on two values."""
MANY: Final = 1000
"""From here on a fifth of the bootstrap's resamples do: each costs the sorting of all cases."""

Row = Mapping[str, Any]
"""One run of a set: `number` and `varied.variant` name the case, `engine`, `key`, and `run` (its record, or None)."""


def score_sets(
    rows: Sequence[Row], reference: str = "analytic", history: Callable[[str], History | None] = lambda key: None
) -> dict[str, SetScores]:
    """Scores of every other model against the reference over the cases that both answered, by model's name.

    `history(key)` gives a run's history where one was kept: verdicts then rest on the histories, otherwise on peaks and
    outcomes alone. The distributions of the peaks are compared from 8 cases on.
    """
    cases: dict[tuple[Any, Any], dict[str, Row]] = defaultdict(dict)
    for row in rows:
        if row["run"] is not None and not Outcome(row["run"]["outcome"]).failed:
            cases[row["number"], row["varied"].get("variant")][row["engine"]] = row
    names = sorted({row["engine"] for row in rows} - {reference})
    return {name: _score(name, reference, cases.values(), history) for name in names}


def _score(name: str, reference: str, cases: Any, history: Callable[[str], History | None]) -> SetScores:
    both = [(case[name], case[reference]) for case in cases if name in case and reference in case]
    judged = [_judged(a, b, history) for a, b in both]
    peaks = None
    if len(both) >= LEAST:
        sides = [[abs(run["run"]["peak_theta_rad"]) for run in side] for side in zip(*both, strict=True)]
        peaks = compare_distributions(*sides, resamples=RESAMPLES if len(both) <= MANY else RESAMPLES // 5)
    return SetScores(
        reference=reference,
        cases=len(both),
        outcomes=score_outcomes([case for case, _ in judged]),
        verdicts=shares([verdict for _, verdict in judged]),
        flips=sum(case.within_uncertainty for case, _ in judged),
        peaks=peaks,
    )


def _judged(a: Row, b: Row, history: Callable[[str], History | None]) -> tuple[Case, Verdict]:
    run_a, run_b = a["run"], b["run"]
    peaks = (
        Peak(run_a["peak_theta_rad"], run_a["peak_time_s"]),
        Peak(run_b["peak_theta_rad"], run_b["peak_time_s"]),
    )
    judgement = judge(_side(a), _side(b), _paired(a, b, history), peaks)
    case = Case(
        Outcome(run_a["outcome"]),
        Outcome(run_b["outcome"]),
        judgement.evidence.outcome_flips_within_uncertainty,
        judgement.evidence.side_flips_within_uncertainty,
        (run_a["no_return_time_s"], run_b["no_return_time_s"]),
    )
    return case, judgement.verdict


def _paired(a: Row, b: Row, history: Callable[[str], History | None]) -> Pair | None:
    first, second = (None if row["key"] is None else history(row["key"]) for row in (a, b))
    if first is None or second is None:
        return None
    holds = [Outcome(row["run"]["outcome"]) is Outcome.STANDS for row in (a, b)]
    return pair(first, second, hold_a=holds[0], hold_b=holds[1])


def _side(row: Row) -> Side:
    """What the verdict needs, from a record of plain values (see `harness.comparison.verdict.side_of`)."""
    run = row["run"]
    outcome = Outcome(run["outcome"])
    left_s, by = run["validity"].get("left_domain_s"), run["validity"].get("left_domain_by") or ""
    if left_s is None and outcome in (Outcome.LIFT_OFF, Outcome.FRICTION_PARADOX):
        left_s, by = run["end_s"], outcome.sentence
    return Side(
        row["engine"],
        outcome,
        run["numerical_uncertainty_rad"],
        run.get("slip_uncertainty_m"),
        run["reliable_until_s"],
        left_domain_s=left_s,
        left_domain_by=by,
        axes=None if run.get("motion_axes") is None else tuple(run["motion_axes"]),
        across_s=run["no_return_time_s"] if outcome in ACROSS else None,
    )
