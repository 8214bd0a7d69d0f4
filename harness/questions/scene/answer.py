"""The headline of a run: what happens and whether the models agree, how probable a fall is, until when, and what decides."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Final, Literal

import numpy as np

from harness.model import Answer, Finding, Outcome, Run, Scene, changes_answer, grouped, info, number
from harness.records.assess import Assessment
from harness.records.run import (
    STILL_RAD,
    HorizonRecord,
    balance_share,
    has_answer,
    known_until_s,
    outcome_family,
    outside_domain,
    peak_lean_rad,
    unconfirmed,
)
from harness.records.scores import ROBUST, Scores, Verdict

Code = Literal[
    "agree",
    "agree_until",
    "outcome_differs",
    "plane_left_out",
    "differ_by_model",
    "unpredictable",
    "one_model",
    "no_answer",
]
LATE: Final = (Verdict.HORIZON, Verdict.UNBOUNDED, Verdict.DOMAIN)
"""Verdicts of histories that agree up to some instant, and part for a reason that is no model's."""
NOT_FOLLOWED: Final = (Outcome.LIFT_OFF, Outcome.FRICTION_PARADOX)
"""Ends of a perturbed run that are none of the statue: it may fall or stand there as it does elsewhere."""


def answer_of(
    scene: Scene,
    runs: Mapping[str, Run],
    scores: Mapping[str, Scores],
    horizons: Mapping[str, HorizonRecord],
    assessment: Mapping[str, Assessment],
    decided: Sequence[Finding] = (),
) -> Answer:
    """The headline, in the order in which a validation asks; `decided`: laws whose choice decides the outcome."""
    known = {name: run for name, run in runs.items() if has_answer(run)}
    judged = [*counted(runs, scores).values()]
    parts = [_what(scene, known, runs)]
    if outside := unconfirmed(known):
        first = known[min(outside, key=lambda name: number(known[name].validity, "left_domain_s"))].validity
        left = {"at_s": first["left_domain_s"], "by": first["left_domain_by"]}
        parts.append(changes_answer("outcome_outside_domain", models=outside, **left))
    if assessment:
        from harness.questions.assess.answer import probability  # not for a run that asks for none

        # Whether two models end differently by what the plane leaves out.
        parted = any(
            outcome_family(runs[each.a].outcome) != outcome_family(runs[each.b].outcome)
            for each in judged
            if each.verdict is Verdict.PLANE
        )
        parts.append(probability(assessment, contradicted=parted))
    parts += _until(known, judged)
    parts += [*_plane(judged), *decided]
    flipping = [each for name, each in horizons.items() if name in known and len(_reached(each)) > 1]
    if flipping:
        # A small change of start or motion changes the outcome by one model itself.
        change = min((each.outcome_from for each in flipping if each.outcome_from is not None), default=None)
        outcomes = sorted(set().union(*map(_reached, flipping)))
        parts.append(changes_answer("outcome_not_predictable", outcomes=outcomes, change=change))
    return Answer(_code(known, judged), parts)


def _reached(horizon: HorizonRecord) -> set[str]:
    """What becomes of the statue in perturbed runs of one model."""
    reached = {outcome_family(end) for end in horizon.outcomes if end not in NOT_FOLLOWED}
    # What is undecided beside a fall still falls as the scene ends.
    return reached - {Outcome.UNDECIDED.value} if "overturned" in reached else reached


def counted(runs: Mapping[str, Run], scores: Mapping[str, Scores]) -> dict[str, Scores]:
    """The pairs that an answer rests on: of models that tell what becomes of the statue, and those that differ robustly while one
    of them still did.
    """
    return {
        pair: each
        for pair, each in scores.items()
        if each.verdict in ROBUST or (has_answer(runs[each.a]) and has_answer(runs[each.b]))
    }


def _code(known: Mapping[str, Run], scores: Sequence[Scores]) -> Code:
    verdicts = {each.verdict for each in scores}
    if not known:
        return "no_answer"
    if Verdict.MODEL in verdicts:
        return "differ_by_model"
    if Verdict.PLANE in verdicts:
        return "plane_left_out"
    if len(known) < 2:
        return "one_model"
    if len({outcome_family(run.outcome) for run in known.values()}) > 1:
        flips = all(each.verdict in LATE or each.evidence.outcome_flips_within_uncertainty for each in scores)
        return "unpredictable" if flips else "outcome_differs"
    return "agree_until" if verdicts & set(LATE) else "agree"


def _what(scene: Scene, known: Mapping[str, Run], runs: Mapping[str, Run]) -> Finding:
    """What happens as given, and who says so."""
    if not known:
        ends = grouped((run.outcome.value, name) for name, run in runs.items() if not outside_domain(run))
        return changes_answer("no_answer", asked=len(runs), ends=ends)
    groups = grouped((outcome_family(run.outcome), name) for name, run in known.items())
    if len(groups) > 1:
        return changes_answer("models_disagree", groups=groups)
    family = next(iter(groups))
    lean = _lean(scene, known)
    still = family == "stands" and max(lean["lean_rad"]) < STILL_RAD
    values = {
        "models": list(known),
        "asked": len(runs),
        "silent": {
            name: "left_domain" if outside_domain(run) else run.outcome.value
            for name, run in runs.items()
            if name not in known
        },
        "outcome": "still" if still else family,
        **lean,
    }
    sides = sorted({run.outcome.value for run in known.values()})
    if family == "overturned":
        times = [run.no_return_time_s for run in known.values() if run.no_return_time_s is not None]
        values |= {"sides": sides, "first_s": min(times, default=None), "last_s": max(times, default=None)}
    return info("model_says" if len(known) == 1 else "models_agree", **values)


def _lean(scene: Scene, known: Mapping[str, Run]) -> dict[str, Any]:
    """The least and the largest of the models' largest leans, rad, and the largest as a share of the balance angle; of a model
    that left its domain those before, where another did not."""
    peaks, shares = [], []
    for name, until_s in known_until_s(known).items():
        run = known[name]
        theta_rad = np.array([run.peak_theta_rad]) if run.history is None else run.history.theta_rad
        if run.peaks_until_s > until_s:
            theta_rad = np.zeros(1) if run.history is None else run.history.until(until_s).theta_rad
            run = replace(run, peak_theta_rad=float(np.abs(theta_rad).max()), validity={})
        peaks.append(peak_lean_rad(run))
        shares.append(balance_share(run, theta_rad, scene.statue.slenderness_rad))
    # A contact engine at rest gives by less.
    leans = [each if each >= STILL_RAD else 0.0 for each in (min(peaks), max(peaks))]
    return {"lean_rad": leans, "balance_share": max(shares)}


def _until(known: Mapping[str, Run], scores: Sequence[Scores]) -> list[Finding]:
    """Until when the histories agree, and why not longer."""
    if not scores:
        return []
    parted = [each for each in scores if each.verdict is not Verdict.AGREE]
    if not parted:
        bounded = min((run.bounded_until_s for run in known.values()), default=0.0)
        if _fell_by(known, bounded):
            return [info("histories_agree_past_return", until_s=bounded)]
        if any(run.bounded_until_s < run.end_s for run in known.values()):
            return [info("histories_known_until", until_s=bounded)]
        return [info("histories_agree")]
    first = min(parted, key=_order)
    until_s, why = _agree_until_s(first), first.verdict
    if first.evidence.aside:
        return [info("histories_agree_in_plane", a=first.a, b=first.b)]
    if why in LATE and _fell_by(known, until_s):
        return [info("histories_agree_past_return", until_s=until_s)]
    return [info("histories_agree_until", until_s=until_s, why=why.name.lower(), a=first.a, b=first.b)]


def _order(scores: Scores) -> tuple[bool, bool, float]:
    """The place of a pair that parts: one that the answer rests on, before one that parts sooner for another reason."""
    return scores.verdict is not Verdict.MODEL, scores.verdict is not Verdict.PLANE, _agree_until_s(scores)


def _plane(scores: Sequence[Scores]) -> list[Finding]:
    """What of that which the plane leaves out makes the pair differ that is told of; else the cause of another pair, by name."""
    for place, pair in enumerate(sorted((each for each in scores if each.verdict is not Verdict.AGREE), key=_order)):
        if causes := [each.values["cause"] for each in pair.findings if each.code == "plane_cause"]:
            named = {"a": pair.a, "b": pair.b} if place else {}
            return [info("plane_decides", causes=causes, **named)]
    return []


def _fell_by(known: Mapping[str, Run], time_s: float) -> bool:
    """Whether every model's statue had passed the point of no return by then."""
    return all(run.no_return_time_s is not None and run.no_return_time_s <= time_s for run in known.values())


def _agree_until_s(scores: Scores) -> float:
    """Until when two answers are known to agree."""
    seen = scores.evidence
    times = [time for time in (seen.exceeded_s, seen.horizon_s) if time is not None]
    if scores.verdict is Verdict.DOMAIN and seen.left_domain_s is not None:
        times.append(seen.left_domain_s)
    return min(times, default=math.inf)
