"""What a run says of one point of the map, and the class that follows: by the rules of the run's own answer, no others."""

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import permutations
from typing import Any, Final

import numpy as np

from harness import engines
from harness.accuracy.horizon import TOLERANCE_RAD
from harness.model import MOST_TIMES, History, Outcome, Run, RunOptions, Scene, to_plain
from harness.questions.assess.model_draws import draws_of, model_draws, row, uncertain_inputs, varied
from harness.questions.assess.probability import End, assess_models, end_of, estimate, run_of
from harness.questions.scene.answer import counted
from harness.questions.scene.scene_run import Result, run_scene
from harness.records.assess import Assessment
from harness.records.base import Plain, plain
from harness.records.run import STILL_RAD, HorizonRecord, balance_share, has_answer, outcome_family, outside_domain
from harness.records.scores import Interval, Scores, Verdict
from harness.records.trust import CONTOURS, Rotation, TrustClass
from harness.runs.task import TaskResult

MODEL: Final = "analytic"
DRAWS: Final = {False: 500, True: 200}
"""Draws of a probability, of a whole and of a coarse map: ± 4 and 7 % at a half."""
FIRST_DRAWS: Final = 100
"""So many of them are enough where their interval holds none of"""
LEVELS: Final = [level for name, level in CONTOURS.items() if name.startswith("probability")]
"""the probabilities that a map has contours of."""
PAIRED: Final = 40
"""Of them at most are also run by an engine, where it is asked."""
HALF_WIDTH: Final = 0.1
"""To which an engine's probability is asked."""
BATCH: Final = 8
"""Runs between two looks at the interval."""
STRETCHES: Final = 60
"""Of a history that a map keeps the first of the least and largest rotation of each: what a small picture shows."""
CHANGED: Final = "outcome_not_predictable"


@dataclass(frozen=True)
class Said:
    """What the models that ran say of a point."""

    kind: TrustClass
    answer: str
    why: Sequence[str]
    outcomes: dict[str, str]
    still: bool
    alike: tuple[object, ...]
    """What the model alone says, as far as a class may follow from it: engines are asked where it changes."""
    peak_rad: float | None
    balance_share: float | None
    peaks_apart_rad: float | None
    agree_until_s: float | None
    horizon_s: float | None

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
class Kept:
    """What is kept of a point: runs with their histories thinned (`paths`), scores of each pair and horizons. Its class is none
    of it, and follows anew whenever it is read.
    """

    runs: Mapping[str, Run]
    scores: Mapping[str, Scores]
    horizons: Mapping[str, HorizonRecord]
    paths: Mapping[str, Rotation]

    def said(self, scene: Scene, names: Sequence[str]) -> Said:
        """What those of these models that ran say of the point, whose scene that is."""
        runs = {name: run for name, run in self.runs.items() if name in names}
        scores = {pair: each for pair, each in self.scores.items() if each.a in runs and each.b in runs}
        result = Result(scene, runs, scores | explained(runs, scores), [], 0.0, self.horizons)
        return said(result, self.paths.get(MODEL))


@dataclass(frozen=True)
class Question:
    """A point's scene, and who is asked: one engine states its horizon, several are compared; what a climb may take, how many
    draws a probability, and horizons that are known already.
    """

    scene: Scene
    engines: tuple[str, ...]
    most_times: float = MOST_TIMES
    draws: int = DRAWS[False]
    horizons: Mapping[str, HorizonRecord] = field(default_factory=dict)


def run_point(question: Question) -> TaskResult:
    """What a worker does for a point's class; its cost is the processor time, s, that it took."""
    begin = time.process_time()
    options = RunOptions(most_times=question.most_times)
    result = run_scene(
        question.scene,
        question.engines,
        options=options,
        horizon=len(question.engines) == 1,
        stored_horizons=question.horizons,
    )
    paths = {name: path_of(run.history) for name, run in result.runs.items() if run.history is not None}
    kept = Kept(result.runs, result.scores, result.horizons, paths)
    return TaskResult("point", plain(kept), time.process_time() - begin)


def path_of(history: History) -> Rotation:
    """A history as a map keeps it: of each of `STRETCHES` the least and largest rotation in their order, to three digits."""
    theta = history.theta_rad
    if theta.size > 2 * STRETCHES:
        parts = np.array_split(theta, STRETCHES)
        theta = np.concatenate([part[np.sort([part.argmin(), part.argmax()])] for part in parts])
    return Rotation(history.duration_s, [float(f"{value:.3g}") for value in theta.tolist()])


def assess_point(question: Question) -> TaskResult:
    """What a worker does for a point's probability: the model's, or that of an engine from few draws that both have run."""
    begin, (name, *_) = time.process_time(), question.engines
    found = _by_model(question) if name == MODEL else _paired(question, name)
    told = [] if found is None else [found.probability_overturned, found.low, found.high, found.level]
    return TaskResult("probability", {"interval": to_plain(told)}, time.process_time() - begin)


def _by_model(question: Question) -> Assessment | None:
    """The model's probability, by few draws where these tell on which side of each contour it lies."""
    few = assess_models(question.scene, min(FIRST_DRAWS, question.draws)).get(MODEL)
    if few is None or not any(few.low <= level <= few.high for level in LEVELS):
        return few
    return assess_models(question.scene, question.draws)[MODEL]


def _paired(question: Question, name: str) -> Assessment:
    """An engine's probability: the model's on all draws, corrected by its runs of some (`probability.estimate`)."""
    scene = question.scene
    values, engine = draws_of(scene, uncertain_inputs(scene), question.draws, 0), engines.load(name)

    def fell(numbers: Sequence[int]) -> list[End]:
        return [end_of(run_of(engine, varied(scene, row(values, number)))) for number in numbers]

    return estimate(model_draws(scene, values), fell, half_width=HALF_WIDTH, most_runs=PAIRED, batch=BATCH)


def said(result: Result, path: Rotation | None = None) -> Said:
    """What a finished run says of its point; `path` is what is kept of the model's history."""
    answer, model = result.answer(), result.runs[MODEL]
    codes = {found.code: found.values for found in answer.findings}
    known = {name: run for name, run in result.runs.items() if has_answer(run)}
    kind, why = class_of(result, answer.code, codes.get(CHANGED, {}).get("outcomes", []))
    horizon = result.horizons.get(MODEL)
    fell = any(run.outcome.overturned for run in known.values())
    peaks = [abs(run.peak_theta_rad) for run in known.values()]
    alone = not fell and MODEL in known
    path = path or (None if model.history is None else path_of(model.history))
    until = [values["until_s"] for values in codes.values() if values.get("until_s") is not None]
    finite = [time_s for time_s in until if math.isfinite(time_s)]
    outcomes = {
        name: "left_domain" if outside_domain(run) else outcome_family(run.outcome) for name, run in result.runs.items()
    }
    still, whole = _still(model), horizon is not None and horizon.intrinsic_s >= model.end_s
    return Said(
        kind=kind,
        answer=answer.code,
        why=why,
        outcomes=outcomes,
        still=still,
        alike=(outcomes.get(MODEL), still, CHANGED in codes, _left(model), whole),
        peak_rad=abs(model.peak_theta_rad) if alone else None,
        balance_share=_balance_share(result.scene, model, path) if alone and path is not None else None,
        peaks_apart_rad=None if fell or len(known) < 2 else max(peaks) - min(peaks),
        agree_until_s=min(finite, default=model.end_s if answer.code == "agree" else None),
        horizon_s=None if horizon is None else horizon.intrinsic_s,
    )


def _balance_share(scene: Scene, model: Run, path: Rotation) -> float:
    """The largest share of a side's balance angle: an unsymmetric statue may lean further to the side that bears more.

    The largest rotation has no side, and a path is rounded.
    """
    theta = np.array(path.theta_rad)
    side = 1 if theta.max() >= -theta.min() else -1
    leans = np.append(theta[side * theta < 0.0], side * abs(model.peak_theta_rad))
    return balance_share(model, leans, scene.statue.slenderness_rad)


def class_of(result: Result, code: str, others: Sequence[str]) -> tuple[TrustClass, list[str]]:
    """The class of a run's answer, and why: engines that differ robustly refute whatever else is true.

    `others`: the outcomes that the smallest changes have, where it is more than one.
    """
    known = {name: run for name, run in result.runs.items() if has_answer(run)}
    judged = counted(result.runs, result.scores)

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
    if code == "agree" and _still(model):
        return "nothing_moves", []
    # One engine whose error is bounded to the end is enough: no other says otherwise.
    if code == "agree" and any(run.bounded_until_s >= run.end_s for name, run in known.items() if name != MODEL):
        return "confirmed", []
    parted = {each.verdict.name.lower() for each in judged.values()} - {"agree"}
    return "outcome_confirmed", sorted(parted or {"unbounded"})


def explained(runs: Mapping[str, Run], scores: Mapping[str, Scores]) -> dict[str, Scores]:
    """Pairs of which the wider statement explains the difference, as pairs whose error is not bounded: two engines whose events
    one layer locates may carry one error, so where they agree each is held against the model by the larger of what both state.
    """
    found = {}
    layered = [name for name in runs if (can := engines.load(name).capabilities).own_impact and not can.certifies]
    for name, other in permutations(layered, 2):
        pair, beside = (
            scores.get(f"{MODEL}_vs_{name}"),
            scores.get(f"{name}_vs_{other}") or scores.get(f"{other}_vs_{name}"),
        )
        if pair is None or beside is None or pair.verdict is not Verdict.MODEL or beside.verdict is Verdict.MODEL:
            continue
        one, two, seen = runs[name], runs[other], pair.evidence
        turned = seen.coverage * max(
            (two.numerical_uncertainty_rad or 0.0) - (one.numerical_uncertainty_rad or 0.0), 0.0
        )
        slid = seen.coverage * max((two.slip_uncertainty_m or 0.0) - (one.slip_uncertainty_m or 0.0), 0.0)
        rotation = seen.largest_reliable_difference_rad <= seen.limit_rad + turned
        if rotation and seen.largest_reliable_slip_difference_m <= seen.slip_limit_m + slid:
            found[f"{MODEL}_vs_{name}"] = replace(pair, verdict=Verdict.UNBOUNDED)
    return found


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
    return Interval(*numbers) if numbers else None
