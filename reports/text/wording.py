"""The verdict in plain words, every clause computed from the record."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from harness.model.history import Array, History, Outcome
from harness.model.tilted import support_m
from harness.records.assess import draws_of, not_answered
from harness.records.run import EngineRunRecord, RunRecord
from harness.records.scores import ROBUST
from reports.drawing.kinematics import section
from reports.source import RunSource
from reports.text.chance import tone_of_outcomes, worse_tone, worst
from reports.text.language import ENGLISH
from reports.text.limits import TIPS_RAD, tilt_rad
from reports.text.numbers import angle, length, spread, unit
from reports.text.study_rows import family

SIDES = {1: "right", -1: "left"}
FELL: Final = "overturns"
AT_REST_RAD: Final = 1e-5
"""Rotations below this are the give of a contact engine at rest (some 0.01 mm at the top of a statue of one metre)."""
STUCK_M: Final = 1e-5
"""The same for the slip of a pedestal."""


@dataclass(frozen=True)
class Verdict:
    """What a page says first: `tone` is `agree`, `differ` or `failed`; `points` are the sentences under the headline."""

    headline: str
    tone: str
    points: Sequence[str]


def run_verdict(source: RunSource) -> Verdict:
    """The verdict on one scene: how probable a fall is, where the record says so, and what the models say of it as given."""
    nominal = _nominal(source)
    answers = source.record.assessment
    if not answers:
        # One run is one draw: a shaking that it stands is no reason for green, and agreeing on a fall is none either.
        over = all(run.outcome.overturned for run in source.runs.values() if not run.outcome.failed)
        known = nominal.tone != "agree" or not source.record.motion.accel_m_s2
        return nominal if known else replace(nominal, tone="failed" if over else "differ")
    item = worst(answers)
    given = f"As given, once: {nominal.headline[0].lower()}{nominal.headline[1:]}."
    draws = draws_of(answers)
    each = [f"By {name} it {other.sentence}, from {draws[name]}." for name, other in answers.items()]
    if len(answers) == 1:
        each = [f"The probability is that of {name}, from {draws[name]}." for name in answers]
    beyond = not_answered(answers, source.scene.file, pedestal=source.scene.pedestal is not None)
    points = [*each, *beyond, given, *nominal.points]
    return Verdict(f"The statue {item.sentence}", worse_tone(answers, nominal.tone), points)


def _nominal(source: RunSource) -> Verdict:
    answered = {name: run for name, run in source.runs.items() if not run.outcome.failed}
    silent = [f"{name} gave no answer: {source.runs[name].message}" for name in source.runs if name not in answered]
    if not answered:
        return Verdict("No model could compute this scene", "failed", silent)
    groups: dict[str, list[str]] = {}
    for name, run in answered.items():
        groups.setdefault(run.outcome, []).append(name)
    points = [
        *motion_given(answered),
        *_outcome_times(answered),
        *_lean(source, answered),
        *_reach(source),
        *_slip(source, answered),
    ]
    points += [*_scores(source.record), *_trust(source, answered), *silent]
    headline = _headline(groups, len(answered), len(source.runs))
    headline += ", given unlike motions" if motion_given(answered) else ""
    agree = len({_class(outcome) for outcome in groups}) == 1
    apart = [scores for scores in source.record.scores.values() if scores.verdict in ROBUST]
    if agree and apart:
        return Verdict(f"{headline}; their motions differ", "differ", points)
    if len(answered) == 1:
        # One model alone agrees with nobody: the colour is that of what it says.
        return Verdict(headline, tone_of_outcomes(family(run.outcome) for run in answered.values()), points)
    return Verdict(headline, "agree" if agree else "differ", points)


def _class(outcome: str) -> str:
    """What a model says happens: falls to different sides are one outcome."""
    return FELL if Outcome(outcome).overturned else outcome


def _headline(groups: Mapping[str, list[str]], count: int, asked: int) -> str:
    if len(groups) == 1:
        sentence = Outcome(next(iter(groups))).sentence
        if count == 1:
            did = "was run" if asked == 1 else "answered"
            return f"One model {did} ({next(iter(groups.values()))[0]}): {sentence}"
        return f"{_those(count, asked)} agree on the outcome: {sentence}"
    if {_class(outcome) for outcome in groups} == {FELL}:
        sides = "; ".join(
            f"{Outcome(outcome).sentence.removeprefix('the statue overturns ')} ({', '.join(names)})"
            for outcome, names in groups.items()
        )
        return f"{_those(count, asked)} agree that the statue overturns, to different sides: {sides}"
    parts = [
        f"{Outcome(outcome).sentence} ({', '.join(names)})"
        for outcome, names in sorted(groups.items(), key=lambda item: -len(item[1]))
    ]
    return "The models disagree: " + "; ".join(parts)


def _those(count: int, asked: int) -> str:
    """The models that answered, which need not be all that were asked."""
    models = "Both models" if count == 2 else f"All {ENGLISH.count(count)} models"
    return models if count == asked else f"{models} that answered"


def motion_given(answered: Mapping[str, EngineRunRecord]) -> list[str]:
    """Who was given which axes of the floor's motion, where that is not the same for all."""
    axes = {name: run.motion_axes for name, run in answered.items() if run.motion_axes is not None}
    every = {axis for given in axes.values() for axis in given}
    lacking = {name: sorted(every - set(given)) for name, given in axes.items() if every - set(given)}
    return [
        f"Not all models got the same motion: {ENGLISH.listed(names)} without that along {along}."
        for along in sorted({" and ".join(left) for left in lacking.values()})
        for names in [[name for name, left in lacking.items() if " and ".join(left) == along]]
    ]


def _outcome_times(answered: Mapping[str, EngineRunRecord]) -> list[str]:
    times = {name: run.no_return_time_s for name, run in answered.items() if run.no_return_time_s is not None}
    if not times:
        return []
    each = ENGLISH.listed(f"{unit(value, 's')} ({name})" for name, value in times.items())
    return [f"The statue passes its balance point for the last time at {each}."]


def _lean(source: RunSource, answered: Mapping[str, EngineRunRecord]) -> list[str]:
    standing = [name for name in answered if answered[name].outcome == Outcome.STANDS and name in source.histories]
    causes = []
    for name in standing:
        theta = source.histories[name].theta_rad
        if np.abs(theta).max() < AT_REST_RAD:
            continue
        side = 1 if theta[np.argmax(np.abs(theta))] > 0.0 else -1
        causes.append((float(np.abs(theta).max()), side, name))
    if not causes:
        if not standing:
            return []
        where = "The" if len(standing) == len(answered) else f"In {ENGLISH.listed(standing)} the"
        return [f"{where} statue does not rock."]
    sides = {side for _, side, _ in causes}
    if len(sides) > 1:
        each = ENGLISH.listed(f"{angle(peak)} to the {SIDES[side]} ({name})" for peak, side, name in causes)
        return [f"Largest lean: {each}."]
    side = sides.pop()
    balance = source.scene.statue.slenderness_rad(side)
    peaks = [peak for peak, _, _ in causes]
    share = spread([100.0 * peak / balance for peak in peaks], "%", 2)
    by = "" if len(causes) == len(answered) else f" ({', '.join(name for _, _, name in causes)})"
    return [
        f"Largest lean{by}: {spread(peaks, 'rad')} ({spread([math.degrees(peak) for peak in peaks], '°', 2)}) to the "
        f"{SIDES[side]}, {share} of the {angle(balance)} at which the statue balances on that edge."
    ]


def _reach(source: RunSource) -> list[str]:
    shape = section(source.scene)
    wall = source.scene.wall
    sentences = []

    def moved(item: History) -> Array:
        return support_m(source.scene.pedestal, item.slip_m, item.extra)

    tops = {
        name: float(np.abs(shape.top_displacement_m(item.theta_rad, moved(item))).max())
        for name, item in source.histories.items()
        if source.runs[name].outcome == Outcome.STANDS
    }
    if tops and max(tops.values()) > 1e-5:
        name = max(tops, key=lambda item: tops[item])
        where = "" if len(tops) == len(source.histories) else ", where it stands,"
        sentences.append(f"The top of the statue{where} moves at most {length(tops[name])} ({name}).")
    if wall is not None:
        touching = [name for name, run in source.runs.items() if run.outcome == Outcome.TOUCHES_WALL]
        where = f"the wall on the {wall.side}, {length(wall.distance_m)} from the base"
        if touching:
            sentences.append(f"The statue touches {where}, in {ENGLISH.listed(touching)}.")
        elif source.histories:
            side = 1 if wall.side == "right" else -1
            left = min(
                wall.distance_m - float(shape.overhang_m(item.theta_rad, moved(item), side).max())
                for item in source.histories.values()
            )
            sentences.append(
                f"It comes within {length(left)} of {where}."
                if left > 0.0
                else f"Its slip carries it {length(-left)} past {where}: no model followed what the wall does then."
            )
    return sentences


def _slip(source: RunSource, answered: Mapping[str, EngineRunRecord]) -> list[str]:
    if source.scene.pedestal is None:
        return []
    peaks = [run.peak_slip_m for run in answered.values()]
    low, high = length(min(peaks)), length(max(peaks))
    much = low if low == high else f"{low} to {high}, depending on the model"
    slides = "does not slide" if max(peaks) < STUCK_M else f"slides by at most {much}"
    tilts = {name: tilt_rad(run, source.histories.get(name)) for name, run in answered.items()}
    most = max(tilts, key=lambda name: tilts[name])
    tips = f", and tips by up to {angle(tilts[most])} in {most}" if tilts[most] > TIPS_RAD else ""
    return [f"The pedestal {slides}{tips}."]


def _scores(record: RunRecord) -> list[str]:
    """What the scores say, differences that no numerical error explains first."""
    return [
        scores.verdict_sentence
        if pair.partition("_vs_")[0] in scores.verdict_sentence
        else f"{pair.replace('_vs_', ' against ')}: {scores.verdict_sentence}"
        for pair, scores in sorted(record.scores.items(), key=lambda item: item[1].verdict not in ROBUST)
    ]


def _trust(source: RunSource, answered: Mapping[str, EngineRunRecord]) -> list[str]:
    known = {name: run for name, run in answered.items() if run.numerical_uncertainty_rad is not None}
    if not known:
        return []
    each = ENGLISH.listed(f"±{unit(run.numerical_uncertainty_rad, 'rad', 2)} ({name})" for name, run in known.items())
    sentences = [f"Numerical error of the rotations: {each}."]
    duration_s = source.scene.duration_s
    until, predictable_s = horizon_s(source), prediction_s(source)
    if until is not None and until < duration_s:
        names = ENGLISH.listed(name for name, run in known.items() if run.reliable_until_s == until)
        sentences.append(
            f"After {unit(until, 's')} the histories are not to be compared instant by instant: from there the numerical error "
            f"of {names} is not bounded."
        )
    if predictable_s is not None and predictable_s < duration_s:
        sentences.append(
            f"The horizon of prediction is {unit(predictable_s, 's')}: the problem's own sensitivity lets the least difference "
            "grow so far by then. Peaks, and outcomes decided later, are one possibility among several."
        )
    return sentences


def prediction_s(source: RunSource) -> float | None:
    """The measured horizon of prediction: from then on nobody can follow the motion; None where none was measured."""
    return min((each.intrinsic_s for each in (source.record.horizons or {}).values()), default=None)


def horizon_s(source: RunSource) -> float | None:
    """Up to when every model's history is reliable: the least `reliable_until_s`; None when no model states one."""
    times = [
        run.reliable_until_s
        for run in source.runs.values()
        if run.reliable_until_s is not None and run.reliable_until_s < run.end_s
    ]
    return min(times) if times else None
