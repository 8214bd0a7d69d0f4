"""What a run says of one point of the map, and the class that follows: by the rules of the run's own answer, no others."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

from harness.accuracy.horizon import TOLERANCE_RAD
from harness.model.history import Outcome
from harness.model.run import Run, to_plain
from harness.model.scene import Scene
from harness.probability.by_model import assess_models
from harness.records.base import Plain
from harness.records.run import has_answer
from harness.records.scores import Interval, Verdict
from harness.records.trust import TrustClass
from harness.runs.task import Answer
from harness.scene_run.answer import STILL_RAD, outcome_family
from harness.scene_run.scene_run import Result, run_scene

MODEL: Final = "analytic"
DRAWS: Final = 2000
"""Draws of a probability: ± 2 % at a half."""
CHANGED: Final = "outcome_not_predictable"


@dataclass(frozen=True)
class Said:
    """What the models that ran say of a point."""

    kind: TrustClass
    answer: str
    why: Sequence[str]
    outcomes: dict[str, str]
    still: bool
    flips: bool
    left_domain: str
    peak_rad: float | None
    peaks_apart_rad: float | None
    agree_until_s: float | None
    horizon_s: float | None
    whole: bool
    """Whether the model's own horizon reaches the end."""

    @property
    def alike(self) -> tuple[object, ...]:
        """What the model alone says, as far as a class may follow from it: engines are asked where it changes."""
        return self.outcomes.get(MODEL), self.still, self.flips, self.left_domain, self.whole

    @property
    def found(self) -> tuple[object, ...]:
        """What engines add: between two points that say the same it is not asked again."""
        return self.kind, self.peak_confirmed

    @property
    def peak_confirmed(self) -> bool:
        """Whether the peaks are as near each other as a prediction is asked to be (`horizon.TOLERANCE_RAD`); of a fall there is
        none to confirm."""
        return self.peaks_apart_rad is None or self.peaks_apart_rad <= TOLERANCE_RAD


@dataclass(frozen=True)
class Question:
    """A point's scene, and who is asked: one engine states its horizon, several are compared; none: the model's probability."""

    scene: Scene
    engines: tuple[str, ...]


def ask(question: Question) -> Answer:
    """What a worker does; its cost is the processor time, s, that it took."""
    begin, scene = time.process_time(), question.scene
    if question.engines:
        alone = len(question.engines) == 1
        plain = to_plain(said(run_scene(scene, question.engines, horizon=alone)))
    else:
        found = assess_models(scene, DRAWS).get(MODEL)
        plain = {} if found is None else to_plain([found.probability_overturned, found.low, found.high, found.level])
        plain = {"interval": plain or None}
    return Answer("point", plain, time.process_time() - begin)


def said(result: Result) -> Said:
    """What a finished run says of its point."""
    answer, model = result.answer(), result.runs[MODEL]
    codes = {found.code: found.values for found in answer.findings}
    known = {name: run for name, run in result.runs.items() if has_answer(run)}
    kind, why = class_of(result, answer.code, codes.get(CHANGED, {}).get("outcomes", []))
    horizon = result.horizons.get(MODEL)
    fell = any(run.outcome.overturned for run in known.values())
    peaks = [abs(run.peak_theta_rad) for run in known.values()]
    until = [values["until_s"] for values in codes.values() if values.get("until_s") is not None]
    finite = [time_s for time_s in until if math.isfinite(time_s)]
    return Said(
        kind=kind,
        answer=answer.code,
        why=why,
        outcomes={
            name: run.outcome.value if run.outcome.failed else outcome_family(run.outcome)
            for name, run in result.runs.items()
        },
        still=_still(model),
        flips=CHANGED in codes,
        left_domain=_left(model),
        peak_rad=None if fell or MODEL not in known else abs(model.peak_theta_rad),
        peaks_apart_rad=None if fell or len(known) < 2 else max(peaks) - min(peaks),
        agree_until_s=min(finite, default=model.end_s if answer.code == "agree" else None),
        horizon_s=None if horizon is None else horizon.intrinsic_s,
        whole=horizon is not None and horizon.intrinsic_s >= model.end_s,
    )


def class_of(result: Result, code: str, others: Sequence[str]) -> tuple[TrustClass, list[str]]:
    """The class of a run's answer, and why: engines that differ robustly refute whatever else is true.

    `others`: the outcomes that the smallest changes have, where it is more than one.
    """
    known = {name: run for name, run in result.runs.items() if has_answer(run)}
    judged = {name: each for name, each in result.scores.items() if each.a in known and each.b in known}

    def pairs(verdict: Verdict) -> list[str]:
        return [name for name, each in judged.items() if each.verdict is verdict]

    model = result.runs[MODEL]
    left = pairs(Verdict.DOMAIN)
    if code == "differ_by_model":
        return "refuted", pairs(Verdict.MODEL)
    if code == "plane_left_out":
        causes = [
            str(each.values["cause"])
            for score in judged.values()
            for each in score.findings
            if each.code == "plane_cause"
        ]
        return "plane_left_out", list(dict.fromkeys(causes)) or ["motion_across"]
    if left:
        reasons = [judged[name].evidence.left_domain_by for name in left]
        return "left_domain", list(dict.fromkeys(filter(None, reasons)))
    if MODEL not in known and _left(model):
        return "left_domain", [_left(model)]
    if len(known) < 2 or MODEL not in known:
        ends = {run.outcome for name, run in result.runs.items() if name not in known}
        return "probability" if Outcome.UNDECIDED in ends else "no_answer", sorted(end.value for end in ends)
    if others or code in ("unpredictable", "outcome_differs"):
        return "probability", sorted({*others, *(outcome_family(run.outcome) for run in known.values())})
    if code == "agree":
        return ("nothing_moves" if _still(model) else "confirmed"), []
    return "outcome_confirmed", sorted({each.verdict.name.lower() for each in judged.values()} - {"agree"})


def _still(run: Run) -> bool:
    """Whether neither the statue nor its pedestal moves."""
    return not run.outcome.failed and abs(run.peak_theta_rad) < STILL_RAD and run.peak_slip_m == 0.0


def _left(run: Run) -> str:
    """By what the model left its domain; empty: it did not."""
    by = run.validity.get("left_domain_by")
    return str(by) if by else run.outcome.value if run.outcome in (Outcome.LIFT_OFF, Outcome.FRICTION_PARADOX) else ""


def interval_of(plain: Plain | None) -> Interval | None:
    """The probability in what a worker gave back, None where there is none."""
    numbers: Any = None if plain is None else plain["interval"]
    return None if numbers is None else Interval(*numbers)
