"""Whether a choice between conventions decided that two answers part: the model is run with the other choice, and tells.

Two choices are nobody's error. Where an impact breaks the pedestal loose, kinetic friction acts in the model, static friction in
an engine that exchanges the two between its steps (`harness.engines.contact.friction.followed`); and of several joint states that
are possible the model takes the stuck one. A choice decided where one of two answers is the model's, and the other the model's
with the other choice: nothing else of it changes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final, Literal

from harness.comparison.distance import errors
from harness.engines.analytic import chosen
from harness.engines.base import EngineFailure
from harness.model.run import Run
from harness.model.scene import Scene
from harness.records.scores import Scores, Verdict

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
                gives = (
                    f"{other.outcome.sentence}, after a peak of {other.peak_theta_rad:.3g} rad by {other.end_s:.4g} s"
                )
                best, nearest_m = Choice(words, first_s, gives), left_m
    except EngineFailure:
        return None
    return best


def _apart_m(scene: Scene, a: Run, b: Run, until_s: float) -> float:
    """How far two centroids are apart at most, m, by the rotation at their height or by the slip."""
    turned_rad, slid_m = errors(a, b, until_s)
    return max(scene.statue.centroid_height_m * turned_rad, slid_m)


def with_conventions(scene: Scene, runs: Mapping[str, Run], scores: Mapping[str, Scores]) -> dict[str, Scores]:
    """The scores of pairs, those that differ by a choice between conventions told so."""
    return {pair: _judged(scene, runs, each) for pair, each in scores.items()}


def _judged(scene: Scene, runs: Mapping[str, Run], scores: Scores) -> Scores:
    parts_s = scores.evidence.exceeded_s
    if scores.verdict is not Verdict.MODEL or parts_s is None:
        return scores
    choice = choice_between(scene, runs[scores.a], runs[scores.b], parts_s)
    if choice is None:
        return scores
    by = f"differ by convention, at {choice.at_s:.4g} s: {choice.words}"
    sentence = scores.verdict_sentence.replace("differ by their models", by)
    sentence += f" With the other choice the model says: {choice.other}."
    return replace(scores, verdict=Verdict.CONVENTION, verdict_sentence=sentence)
