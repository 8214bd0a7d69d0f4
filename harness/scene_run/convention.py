"""Whether a choice between conventions decided that two answers part: the model is run with the other choice, and tells.

Two choices are nobody's error. Where an impact breaks the pedestal loose, kinetic friction acts in the model, static friction in
an engine that exchanges the two between its steps (`harness.engines.contact.friction.followed`); and of several joint states that
are possible the model takes the stuck one. A choice decided where one of two answers is the model's, and the other the model's
with the other choice: nothing else of it changes. It decides, too, what two answers share that agree with the model and not with
the model of the other choice.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final, Literal

from harness.comparison.distance import errors
from harness.engines.analytic import chosen
from harness.engines.base import EngineFailure
from harness.model.run import Run
from harness.model.scene import Scene
from harness.records.scores import Evidence, Scores, Verdict

SHARE: Final = 0.5
"""An answer is the one of two that it is less than half as far from as these are apart."""
WORDS: Final[Mapping[Literal["static_impact", "moving"], str]] = {
    "static_impact": "which of the two coefficients acts as an impact breaks the pedestal loose",
    "moving": "which of several joint states that were possible is taken",
}


@dataclass(frozen=True)
class Choice:
    """Which choice decided, when, s, and what the model gives with the other one."""

    words: str
    at_s: float
    other: str


def choice_between(scene: Scene, a: Run, b: Run, parts_s: float) -> Choice | None:
    """The choice that decided that two runs part at `parts_s`; None where none did, or the model refuses the scene."""
    until_s = parts_s + scene.output_dt_s  # between two samples of the histories the instant is interpolated
    best, nearest_m = None, SHARE * _apart_m(scene, a, b, until_s)
    try:
        model, _ = chosen(scene, "stuck")
        far_m = {run.engine: _apart_m(scene, model, run, until_s) for run in (a, b)}
        if min(far_m.values()) > nearest_m:
            return None
        with_other = max((a, b), key=lambda run: far_m[run.engine])
        for name, words in WORDS.items():
            other, first_s = chosen(scene, name)
            left_m = _apart_m(scene, other, with_other, until_s)
            if first_s is not None and first_s < until_s and left_m <= nearest_m:
                best, nearest_m = _choice(words, first_s, other), left_m
    except EngineFailure:
        return None
    return best


def shared_choices(scene: Scene, a: Run, b: Run, evidence: Evidence) -> list[Choice]:
    """The choices that two answers took as the model does, and with the other of which it parts from both before they part."""
    if scene.pedestal is None:
        return []
    until_s = min(math.inf if known is None else known for known in (evidence.exceeded_s, evidence.horizon_s))

    def parts(model: Run, run: Run) -> bool:
        turned_rad, slid_m = errors(model, run, until_s)
        return turned_rad > evidence.limit_rad or slid_m > evidence.slip_limit_m

    try:
        model, _ = chosen(scene, "stuck")
        if parts(model, a) or parts(model, b):
            return []
        others = [(words, *chosen(scene, name)) for name, words in WORDS.items()]
    except EngineFailure:
        return []
    decided = [
        _choice(words, at_s, other)
        for words, other, at_s in others
        if at_s is not None and parts(other, a) and parts(other, b)
    ]
    return sorted(decided, key=lambda choice: choice.at_s)


def _choice(words: str, at_s: float, other: Run) -> Choice:
    gives = f"{other.outcome.sentence}, after a peak of {other.peak_theta_rad:.3g} rad by {other.end_s:.4g} s"
    return Choice(words, at_s, gives)


def _apart_m(scene: Scene, a: Run, b: Run, until_s: float) -> float:
    """How far two centroids are apart at most, m, by the rotation at their height or by the slip."""
    turned_rad, slid_m = errors(a, b, until_s)
    return max(scene.statue.centroid_height_m * turned_rad, slid_m)


def with_conventions(scene: Scene, runs: Mapping[str, Run], scores: Mapping[str, Scores]) -> dict[str, Scores]:
    """The scores of pairs, told where a choice between conventions decided that they differ, or what both say."""
    return {pair: _judged(scene, runs, each) for pair, each in scores.items()}


def _judged(scene: Scene, runs: Mapping[str, Run], scores: Scores) -> Scores:
    a, b, parts_s = runs[scores.a], runs[scores.b], scores.evidence.exceeded_s
    if scores.verdict is Verdict.MODEL and parts_s is not None:
        choice = choice_between(scene, a, b, parts_s)
        if choice is not None:
            by = f"differ by convention, at {choice.at_s:.4g} s: {choice.words}"
            sentence = scores.verdict_sentence.replace("differ by their models", by)
            sentence += f" With the other choice the model says: {choice.other}."
            return replace(scores, verdict=Verdict.CONVENTION, verdict_sentence=sentence)
    shared = (
        f" By convention of both, at {choice.at_s:.4g} s: {choice.words}. With the other choice the model says: {choice.other}."
        for choice in shared_choices(scene, a, b, scores.evidence)
    )
    return replace(scores, verdict_sentence=scores.verdict_sentence + "".join(shared))
