"""How far the analytic model can be trusted, for one statue: strength and frequency of its shaking divided by what models say.

The model is asked at every point of the map, engines where its word may change, and at a tenth of the points where they were not.
"""

import csv
import json
import math
import time
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence, Set
from contextlib import ExitStack, closing
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import groupby, pairwise, permutations, takewhile
from pathlib import Path
from typing import Any, Final, Self

import numpy as np
from pydantic import JsonValue

from harness import engines
from harness.accuracy.forecast import run_s
from harness.accuracy.horizon import MODEL, TOLERANCE_RAD
from harness.accuracy.refinement import DEFAULT_ACCURACY_RAD, simulate
from harness.input.files import read_files
from harness.input.scene_file import load_scene
from harness.model import (
    MOST_TIMES,
    Answer,
    Finding,
    History,
    InputError,
    Outcome,
    Run,
    RunOptions,
    Say,
    Scene,
    caution,
    changes_answer,
    check_known,
    grouped,
    info,
    machine,
    require,
    to_plain,
    versions,
)
from harness.questions.assess.probability import (
    SAMPLE_S,
    End,
    assess_models,
    crossing,
    draws_of,
    end_of,
    estimate,
    model_draws,
    row,
    run_of,
    uncertain_inputs,
    varied,
)
from harness.questions.scene.scene_run import Result, check_work, counted, run_scene
from harness.questions.study.cases import BaseScene, Value, filled, refined
from harness.records.assess import Assessment
from harness.records.base import COMING, PAGES, RECORD, Plain, check_folder, check_inputs, part, plain, write_whole
from harness.records.run import STILL_RAD, HorizonRecord, balance_share, has_answer, outcome_family, outside_domain
from harness.records.scene import SceneRecord
from harness.records.scores import Interval, Scores, Verdict
from harness.records.trust import (
    CLASSES,
    CONTOURS,
    HELD,
    MOTIONS,
    Basis,
    Rotation,
    Saved,
    TrustCell,
    TrustClass,
    TrustMap,
    TrustRecord,
    TrustSummary,
    knows_most,
)
from harness.runs.execute import Campaign
from harness.runs.progress import LESS_STORED, duration_words, progress
from harness.runs.runner import DaskPool, LocalPool, Pool
from harness.runs.store import STORE_NAME, Store, check_begun
from harness.runs.task import Task, TaskResult, request_key
from harness.statics.plan import LimitsOfRest, limit_of_rest_m_s2
from harness.statics.standstill import resting_polygon_m

# The points of a map, the scene of each, and where engines are asked: at the ends of what the model says alike, and halved.

WEAKEST_G, STRONGEST_G = 0.05, 1.0
SLOWEST_HZ, FASTEST_HZ = 0.8, 8.0
"""A museum floor's strengths and frequencies in an earthquake."""
RESOLUTION: Final = {False: 1.05, True: 1.25}
"""Ratio of neighbouring strengths, of a whole and of a coarse map: a border between classes is known to that."""
FREQUENCIES: Final = {False: 10, True: 5}
FARTHEST: Final = {False: 2.0, True: 3.0}
"""Engines are asked at least once for each such factor of strength and frequency, whatever the model says."""
RING_DOWN_S: Final = 5.0
"""Time after a pulse in which rocking may still decide."""

Point = tuple[int, ...]
"""Number of the frequency, and of the strength."""


@dataclass(frozen=True)
class Plane:
    """Strengths, g, and frequencies, Hz (one None: the scene's own motion), and the scenes at them."""

    base: BaseScene
    scene: Scene
    motion: str
    amplitudes_g: Sequence[float]
    frequencies_hz: Sequence[float | None]
    farthest_ratio: float = FARTHEST[False]
    on_floor: bool = False

    @classmethod
    def of(cls, scene: Scene, motion: str, *, coarse: bool) -> Self:
        """The map of a loaded scene. Raises `InputError` for an own motion that is none, or a statue not on its base."""
        require(scene.initial.pose is None, str(scene.source), "a statue on its base", "a pose in space", key="initial")
        require(
            motion != "scene" or scene.base_excitation.x.peak_m_s2 > 0.0,
            str(scene.source),
            "a motion along x to make stronger",
            "none",
            key="motion.x",
        )
        limits_g = [limit_of_rest_m_s2(each) / scene.gravity_m_s2 for each in (scene, replace(scene, pedestal=None))]
        low, high = min(WEAKEST_G, 0.8 * min(limits_g)), max(STRONGEST_G, 2.0 * max(limits_g))
        steps = math.ceil(math.log(high / low) / math.log(RESOLUTION[coarse]))
        frequencies: list[float | None] = [None]
        if motion != "scene":
            frequencies = [*_rounded(np.geomspace(SLOWEST_HZ, FASTEST_HZ, FREQUENCIES[coarse]))]
        amplitudes = _rounded(np.geomspace(low, high, steps + 1))
        return cls(BaseScene(scene.source, scene.given), scene, motion, amplitudes, frequencies, FARTHEST[coarse])

    def without_pedestal(self) -> Self:
        """The same plane for the statue on the floor. Raises `InputError` where that is no scene."""
        floor = replace(self, on_floor=True)
        return replace(floor, scene=self.base.scene({"pedestal": "none", **floor._known()}))

    @property
    def points(self) -> list[Point]:
        """All points, frequency by frequency."""
        return [(i, j) for i in range(len(self.frequencies_hz)) for j in range(len(self.amplitudes_g))]

    def setting(self, point: Point) -> dict[str, Value]:
        """The keys of the scene at a point: `rockcheck run SCENE --set` takes the same."""
        return {**({"pedestal": "none"} if self.on_floor else {}), **self._shaking(point), **self._known()}

    def command(self, point: Point) -> list[str]:
        """The same as `--set` takes it."""
        return [f"{key}={value if value == 'none' else _toml(value)}" for key, value in self.setting(point).items()]

    def _shaking(self, point: Point) -> dict[str, Any]:
        amplitude, frequency = self.amplitudes_g[point[1]], self.frequencies_hz[point[0]]
        if frequency is None:
            factor = amplitude * self.scene.gravity_m_s2 / self.scene.base_excitation.x.peak_m_s2
            motion = self.base.content["motion"]
            own = motion.get("scale", 1.0) if isinstance(motion, Mapping) else 1.0
            return {"motion.scale": factor * float(own)}  # type: ignore[arg-type]
        if self.motion == "sine":
            return {"motion": {"x": {"kind": "harmonic", "amplitude_g": amplitude, "frequency_hz": frequency}}}
        duration_s = 1.0 / frequency
        x = {"kind": "pulse", "shape": "one_sine", "amplitude_g": amplitude, "duration_s": duration_s}
        return {"motion": {"x": x}, "duration_s": max(self.scene.duration_s, duration_s + RING_DOWN_S)}

    def _known(self) -> dict[str, Any]:
        """The scene's table of uncertainties without what is not there: its own motion where another shakes, its pedestal."""
        unknown = self.base.content.get("uncertainty")
        there = {"motion.": self.motion == "scene", "pedestal.": not self.on_floor}
        gone = tuple(name for name, kept in there.items() if not kept)
        if not isinstance(unknown, Mapping) or not gone:
            return {}
        kept = {key: item for key, item in unknown.items() if not key.startswith(gone)}
        return {"uncertainty": {key: _alone(item, kept.keys()) for key, item in kept.items()}}

    def at(self, point: Point) -> Scene:
        """The scene at a point. Raises `InputError` where it is none."""
        return self.base.scene(self.setting(point))

    def at_rest(self, point: Point) -> bool:
        """Whether nothing can move there: the floor's peaks, all at once, are below the limits of a statue at rest."""
        scene = self.at(point)
        polygon = resting_polygon_m(scene.statue) if scene.initial.still else None
        if polygon is None:
            return False
        floor = scene.base_excitation
        x, y, z = floor.x.peak_m_s2, floor.y.peak_m_s2, floor.z.peak_m_s2
        peaks = np.array([[a, b, z] for a in (x, -x) for b in (y, -y)])
        times = np.linspace(0.0, 0.5 * scene.duration_s, len(peaks))
        return LimitsOfRest(scene, polygon, times, peaks).until_s(0.0) >= scene.duration_s

    @cached_property
    def shaken(self) -> Scene:
        """The scene under what shakes it on this map: nothing in it is of a motion whose place another takes."""
        return self.scene if self.motion == "scene" else self.at(self.points[0])

    def without_dimension(self, point: Point) -> tuple[float, float | None]:
        """Strength over g tan α of the weaker side, frequency over p of that side, 1/s."""
        statue = self.scene.statue
        side = 1 if statue.corner_right_m <= statue.corner_left_m else -1
        corner, height = statue.corner_m(side), statue.centroid_height_m
        arm, gravity = math.hypot(corner, height), self.scene.gravity_m_s2
        p = math.sqrt(statue.mass_kg * gravity * arm / self.scene.pivot_inertia_kg_m2[side])
        frequency = self.frequencies_hz[point[0]]
        strength = self.amplitudes_g[point[1]] * height / corner
        return strength, None if frequency is None else frequency / p

    @property
    def farthest(self) -> tuple[int, int]:
        """How many frequencies and strengths may lie from one at which engines were asked to the next."""
        return _steps(self.frequencies_hz, self.farthest_ratio), _steps(self.amplitudes_g, self.farthest_ratio)


def to_ask(alike: Sequence[Hashable | None], found: Mapping[int, Hashable], farthest: int) -> set[int]:
    """Where engines are to be asked next along one frequency: at the ends of each stretch that the model says `alike` (None:
    decided without), and between two neighbours of what was `found` there that differ or lie too far apart."""
    wanted: set[int] = set()
    for key, stretch in groupby(range(len(alike)), key=lambda j: alike[j]):
        if key is None:
            continue
        inside = list(stretch)
        ends = {inside[0], inside[-1]}
        wanted |= ends - found.keys()
        if ends <= found.keys():
            known = [j for j in inside if j in found]
            wanted |= {
                (a + b) // 2 for a, b in pairwise(known) if b > a + 1 and (found[a] != found[b] or b - a > farthest)
            }
    return wanted


def _alone(spread: JsonValue, kept: Set[str]) -> JsonValue:
    """The distribution of a number without its correlation with what is not there."""
    if isinstance(spread, dict) and spread.get("correlated_with", "") not in ("", *kept):
        return {key: value for key, value in spread.items() if key not in ("correlated_with", "rho")}
    return spread


def _toml(value: object) -> str:
    """A value as TOML writes it in one line."""
    if isinstance(value, Mapping):
        items = (f"{json.dumps(key) if '.' in key else key}={_toml(item)}" for key, item in value.items())
        return f"{{{','.join(items)}}}"
    return f"[{','.join(map(_toml, value))}]" if isinstance(value, list) else json.dumps(value)


def _steps(values: Sequence[float | None], ratio: float) -> int:
    """How many values lie within a factor."""
    low, high = values[0], values[-1]
    return (
        max(1, round(math.log(ratio) * (len(values) - 1) / math.log(high / low))) if low and high and high > low else 1
    )


def _rounded(values: np.ndarray[tuple[int], np.dtype[np.float64]]) -> list[float]:
    """Three digits: a point reads the same in a table, on a command line and in the store."""
    return [float(f"{value:.3g}") for value in values]


# What a run says of one point of the map, and the class that follows: by the rules of the run's own answer, no others.

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
PAIRED_BATCH: Final = 8
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

    return estimate(model_draws(scene, values), fell, half_width=HALF_WIDTH, most_runs=PAIRED, batch=PAIRED_BATCH)


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
    until = (values.get("until_s") for values in codes.values())
    finite = [time_s for time_s in until if time_s is not None and math.isfinite(time_s)]
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


# The whole map: the model everywhere, engines where they are needed, a tenth of what they were not asked checked.

CELLS_NAME: Final = "cells.csv"
CHECKED: Final = 0.1
"""Share of the points without engine runs that is run all the same."""
MOST_CHECKS: Final = 3
"""Where a check finds another class its surroundings are refined and a tenth of the rest is checked, so often at most."""
BATCH: Final = 8
"""Points of the model alone, some 40 ms each, that a worker takes at a time."""
DOUBTFUL: Final = (0.05, 0.95)
"""Probabilities between which an engine is asked for its own."""
SAME: Final = ""
"""The engines in space change nothing of what those in the plane say."""
PLANAR: Final = 2
POINT_S: Final = 0.06
"""Processor seconds of a point by the model, in a forecast: its run, its horizon and its probability."""
ASKED: Final = {2: 0.55, 3: 0.4}
"""Share of the points at which an engine in the plane, and one in space, is asked: 0.41 to 0.57, and 0.2 to 0.43, of the shipped
statue's maps."""
COARSE_TIMES: Final = 8.0
"""What a climb of a coarse map may take: half of the time, and here and there a whole motion is not confirmed to its end."""
CHANCE_S: Final = 6.0
"""Of an engine's probability, at one point of each frequency of a whole map."""
TRIALS: Final = 16
"""Drawn points of each map whose runs are forecast."""


@dataclass
class Points:
    """Asks what the store does not hold; `most_times` is what an engine's climb may take (`RunOptions`), `draws` how many draws a
    probability has.
    """

    store: Store
    campaign: Campaign
    most_times: float = MOST_TIMES
    draws: int = DRAWS[False]

    def kept(
        self,
        plane: Plane,
        points: Iterable[Point],
        names: tuple[str, ...],
        horizons: Mapping[Point, Mapping[str, HorizonRecord]] | None = None,
    ) -> dict[Point, Kept | None]:
        """What the runs of these models are at each point; None where the process died. `horizons` are known already."""
        found = self._ask(run_point, plane, points, names, horizons or {})
        return {point: None if each is None else part(Kept, each, self.store.path) for point, each in found.items()}

    def chances(self, plane: Plane, points: Iterable[Point], name: str) -> dict[Point, Interval]:
        """The probability of a fall by one model, where it has any."""
        found = self._ask(assess_point, plane, points, (name,), {})
        told: dict[Point, Any] = {point: each["interval"] for point, each in found.items() if each is not None}
        return {point: Interval(*numbers) for point, numbers in told.items() if numbers}

    def _ask(
        self,
        work: Callable[[Question], TaskResult],
        plane: Plane,
        points: Iterable[Point],
        names: tuple[str, ...],
        horizons: Mapping[Point, Mapping[str, HorizonRecord]],
    ) -> dict[Point, Plain | None]:
        asked = "trust", work.__name__, names, self.draws, STRETCHES, DEFAULT_ACCURACY_RAD, self.most_times
        group = MODEL if names == (MODEL,) else ""
        scenes = {point: plane.at(point) for point in points}
        tasks = [
            Task(
                request_key(scene, None, *asked),
                work,
                Question(scene, names, self.most_times, self.draws, horizons.get(point, {})),
                group,
            )
            for point, scene in scenes.items()
        ]
        return dict(zip(scenes, self.campaign.ask(tasks), strict=True))


@dataclass
class Map:
    """What is known of the plane: the model's word everywhere, and what was found where engines ran: by those in the plane
    (`ran`, whose borders are halved along each frequency), and by all (`whole`), where one in space takes seconds for a point.

    That one is asked as a study's adaptive map is: on a coarse grid, refined where it says another class than those in the plane.
    """

    plane: Plane
    names: tuple[str, ...]
    model: Mapping[Point, Said]
    rest: set[Point]
    ran: dict[Point, Said] = field(default_factory=dict)
    whole: dict[Point, Said] = field(default_factory=dict)
    checks: set[Point] = field(default_factory=set)
    changed: set[Point] = field(default_factory=set)
    paths: dict[Point, Mapping[str, Rotation]] = field(default_factory=dict)
    horizons: Mapping[Point, Mapping[str, HorizonRecord]] = field(default_factory=dict)

    @property
    def quick(self) -> tuple[str, ...]:
        """The model and the engines in the plane; all, where that is nobody beside it or there is one frequency only."""
        quick = tuple(name for name in self.names if engines.load(name).capabilities.dimensions == PLANAR)
        return quick if len(quick) > 1 and len(self.plane.frequencies_hz) > 1 else self.names

    def unasked(self, names: tuple[str, ...]) -> set[Point]:
        """Where those engines are to be asked next."""
        if names != self.quick:
            wanted = refined(self.plane.points, self._changes(), (0, 1), self.plane.farthest)
            return wanted.keys() - self.rest - self.whole.keys()
        points: set[Point] = set()
        for i in range(len(self.plane.frequencies_hz)):
            alike = [
                None if (i, j) in self.rest else self.model[i, j].alike for j in range(len(self.plane.amplitudes_g))
            ]
            points |= {(i, j) for j in to_ask(alike, self._along(i), self.plane.farthest[1])}
        return points

    def take(self, names: tuple[str, ...], kept: Mapping[Point, Kept | None]) -> None:
        """Take in what was kept of their runs: where all ran, also what those in the plane say by themselves."""
        for point, each in kept.items():
            scene = self.plane.at(point)
            said = {who: _died(who) if each is None else each.said(scene, who) for who in (names, self.quick)}
            self.ran[point] = said[self.quick]
            if each is not None:
                self.paths[point] = each.paths
            if names == self.names:
                self.whole[point] = said[names]

    def words(self) -> dict[Point, tuple[TrustClass, Basis, Said]]:
        """The class of each point, what it rests on, and the run that says so, here or nearby."""
        changes = self._changes()
        fill = filled(self.plane.points, changes, (0, 1), self.plane.farthest)
        return {point: self._word(point, changes, fill.get(point, SAME)) for point in self.plane.points}

    def _word(self, point: Point, changes: Mapping[Point, str], fill: str) -> tuple[TrustClass, Basis, Said]:
        """What is less known of the two counts: what those in the plane say, what an engine in space makes of it around."""
        if point in self.whole:
            return self.whole[point].kind, self._basis(point), self.whole[point]
        kind, basis, said = self._in_plane(point)
        if fill == SAME or _doubt(fill) < _doubt(kind):
            return kind, basis, said
        alike = (each for each in self.whole if changes[each] == fill)
        nearest = self.whole[min(alike, key=lambda at: math.dist(at, point))]
        return nearest.kind, "between", nearest

    def _in_plane(self, point: Point) -> tuple[TrustClass, Basis, Said]:
        """What those in the plane say."""
        if point in self.ran:
            return self.ran[point].kind, self._basis(point), self.ran[point]
        if point in self.rest:
            return "nothing_moves", "rest", self.model[point]
        i, j = point
        # The nearest strength under it at which engines were asked.
        other = self.ran[i, max(asked for asked in self._along(i) if asked < j)]
        return other.kind, "between", other

    def _basis(self, point: Point) -> Basis:
        return "checked" if point in self.checks else "runs"

    def check(self, points: Sequence[Point], kept: Mapping[Point, Kept | None]) -> None:
        """Take checks in; where one is not what was said, its surroundings are no longer decided."""
        said = self.words()
        self.take(self.names, kept)
        self.checks |= set(points)
        for point in points:
            if self.whole[point].kind != said[point][0]:
                self.changed.add(point)
                self.rest = {each for each in self.rest if each[0] != point[0]}

    def _changes(self) -> dict[Point, str]:
        """Where all ran: which class they say instead of that of those in the plane. At rest nobody says another."""
        said = {
            point: all_of.kind if all_of.found != self.ran[point].found else SAME
            for point, all_of in self.whole.items()
        }
        return dict.fromkeys(self.rest, SAME) | said

    def _along(self, i: int) -> dict[int, tuple[object, ...]]:
        """What engines in the plane found along a frequency, by strength."""
        return {point[1]: said.found for point, said in self.ran.items() if point[0] == i}


def _doubt(kind: str) -> int:
    """How little a class says is known."""
    return [str(each) for each in CLASSES].index(kind)


def run_trust(
    path: Path,
    folder: Path,
    names: Sequence[str] | None = None,
    overrides: Sequence[str] = (),
    *,
    motion: str = "sine",
    coarse: bool = False,
    jobs: int | None = None,
    resume: bool = False,
    dask: str | None = None,
    seed: int = 0,
    quiet: bool = False,
    pool: Pool | None = None,
    say: Say = lambda finding: "",
) -> TrustRecord:
    """The trust map of a scene into `folder` (store.sqlite, result.json, cells.csv); `say` fills in the sentences.

    `pool` is used, and not closed, where given.

    Raises `InputError` for wrong input, or `resume` where nothing was begun.
    """
    check_known(motion, MOTIONS, "--motion")
    check_folder(folder, ("trust",), [RECORD, COMING, *PAGES, CELLS_NAME])
    scene = load_scene(path, overrides)
    check_inputs(folder, [RECORD, CELLS_NAME], [path, *read_files(scene.given, scene.source)])
    plane = Plane.of(scene, motion, coarse=coarse)
    hardest = plane.at(plane.points[-1])
    chosen = engines_of(hardest, names, coarse=coarse)
    check_work(hardest, {name: engines.load(name).capabilities.dimensions for name in chosen}, str(path))
    if resume:
        check_begun(folder, "a trust map")
    with ExitStack() as stack:
        workers = pool or stack.enter_context(closing(LocalPool(jobs) if dask is None else DaskPool(dask)))
        size = cost_words(plane, chosen, workers.workers, coarse=coarse) + LESS_STORED * (folder / STORE_NAME).exists()
        store = stack.enter_context(Store(folder / STORE_NAME, "trust"))
        on_progress = stack.enter_context(progress(f"{path.stem}, trust map", quiet, size, grows=True))
        campaign = Campaign(store, workers, on_progress, {MODEL: BATCH}, free=(MODEL,))
        points = Points(store, campaign, COARSE_TIMES if coarse else MOST_TIMES, DRAWS[coarse])
        record = trust_map(plane, chosen, points, coarse=coarse, seed=seed)
    record = replace(record, overrides=overrides)
    return write_whole(folder, record.texted(say), lambda fresh: write_cells(record.maps, fresh / CELLS_NAME))


def engines_of(scene: Scene, names: Sequence[str] | None, *, coarse: bool) -> tuple[str, ...]:
    """The analytic model and who is asked beside it: those named; or of a run's own all that are here and no twin of it, of a
    coarse map none that takes seconds for a point.

    Raises `InputError` where there is nobody beside it, or one that was named is not installed.
    """
    others = [engines.load(name) for name in engines.asked(names, engines.default_engines(scene)) if name != MODEL]
    here = [item for item in others if item.missing() is None]
    if not names:
        # A planar scene in three dimensions is the planar answer again.
        quick = [item for item in here if item.capabilities.dimensions == 2 or item.name == engines.EXACT_IN_SPACE]
        here = quick if coarse or scene.planar else here
    got = "; ".join(f"{item.name}: {item.missing()}" for item in others if item not in here) or f"{MODEL} alone"
    wanted = "engines that are installed, one of them beside the analytic model, to hold it against"
    require(here and (not names or here == others), "--engine", wanted, got)
    return (MODEL, *(item.name for item in here))


def planes_of(plane: Plane) -> tuple[list[Plane], list[Finding]]:
    """The plane, and of a statue on a pedestal that without it; or why there is none."""
    if plane.scene.pedestal is None:
        return [plane], []
    try:
        return [plane, plane.without_pedestal()], []
    except InputError as error:
        return [plane], [caution("trust_without_floor", reason=str(error))]


def cost_words(plane: Plane, names: Sequence[str], workers: int, *, coarse: bool) -> str:
    """How many points a map has, and what it is expected to take, nothing being stored yet: by the runs of drawn points."""
    planes, cpu_s = planes_of(plane)[0], 0.0
    for each in planes:
        drawn = np.random.default_rng(0).permutation(len(each.points))[:TRIALS].tolist()
        scenes = [each.at(each.points[k]) for k in drawn]
        asked = {name: ASKED[engines.load(name).capabilities.dimensions] for name in names if name != MODEL}
        runs_s = sum(share * run_s(name, scene).middle for name, share in asked.items() for scene in scenes)
        # A probability has an engine's draws where the model leaves its domain.
        left = sum(not has_answer(simulate(scene, MODEL)) for scene in scenes)
        cpu_s += len(each.points) * (POINT_S + (runs_s + SAMPLE_S * left) / len(scenes))
        cpu_s += 0.0 if coarse else CHANCE_S * len(each.frequencies_hz)
    points, spent, clock = len(planes) * len(plane.points), duration_words(cpu_s), duration_words(cpu_s / workers)
    return f"{points} points: about {spent} of processor time, {clock} by the clock (workers: {workers})"


def trust_map(plane: Plane, names: tuple[str, ...], points: Points, *, coarse: bool, seed: int) -> TrustRecord:
    """The record of a map whose answers are kept in a store; of a statue on a pedestal also that of the map without it."""
    start = time.perf_counter()
    planes, alone = planes_of(plane)
    found = [explored(each, names, points, seed) for each in planes]
    maps = [map_of(each, points, coarse=coarse) for each in found]
    summary = TrustSummary(
        points=sum(len(each.plane.points) for each in found),
        asked=sum(len(each.ran) for each in found),
        checked=sum(len(each.checks) for each in found),
        changed=sum(len(each.changed) for each in found),
        found=len(points.campaign.reused),
        cpu_s=points.campaign.asked_s,
        failed=points.campaign.failed,
        whole=sum(len(each.whole) for each in found),
    )
    saved = saved_by(names, maps)
    return TrustRecord(
        title=plane.scene.title,
        answer=answer_of(plane, names, maps, saved),
        findings=[*findings_of(maps, saved, summary, seed), *alone, *plane.shaken.findings],
        scene=SceneRecord.of(plane.scene),
        motion=plane.motion,
        coarse=coarse,
        engines=names,
        seed=seed,
        maps=maps,
        saved=saved,
        summary=summary,
        seconds=time.perf_counter() - start,
        versions=versions(),
        machine=machine(),
    )


def explored(plane: Plane, names: tuple[str, ...], points: Points, seed: int) -> Map:
    """What is known of a plane once engines were asked where they may say another class than is told without."""
    every = plane.points
    alone = points.kept(plane, every, (MODEL,))
    model = {at: _died((MODEL,)) if kept is None else kept.said(plane.at(at), (MODEL,)) for at, kept in alone.items()}
    rest = {point for point in every if model[point].still and plane.at_rest(point)}
    paths = {at: kept.paths for at, kept in alone.items() if kept is not None}
    horizons = {at: kept.horizons for at, kept in alone.items() if kept is not None}
    found = Map(plane, names, model, rest, paths=paths, horizons=horizons)
    _refine(found, points)
    stream = np.random.default_rng(seed)
    for _ in range(MOST_CHECKS):
        left = [point for point in every if point not in found.ran]
        chosen = stream.permutation(len(left))[: round(CHECKED * len(left))]
        checks, before = sorted(left[k] for k in chosen.tolist()), len(found.changed)
        found.check(checks, points.kept(plane, checks, names, found.horizons))
        _refine(found, points)
        if len(found.changed) == before:
            break
    return found


def _refine(found: Map, points: Points) -> None:
    """Ask until nothing is left that may be another class."""
    tiers = dict.fromkeys((found.names, found.quick))
    while wanted := {names: asked for names in tiers if (asked := found.unasked(names))}:
        for names, asked in wanted.items():
            # Where all run, those in the plane say by themselves what they would.
            left = asked if names == found.names else asked - wanted.get(found.names, set())
            found.take(names, points.kept(found.plane, sorted(left), names, found.horizons))


def map_of(found: Map, points: Points, *, coarse: bool) -> TrustMap:
    """The map of a plane with each point's probability of a fall; on a whole map by an engine too, where that is near a half."""
    plane, words = found.plane, found.words()
    moving = [point for point in plane.points if words[point][0] != "nothing_moves"]
    chances = {MODEL: points.chances(plane, moving, MODEL)}
    engine = next(name for name in found.names if name != MODEL)
    if not coarse:
        chances[engine] = points.chances(plane, doubtful(chances[MODEL]), engine)
    by_point = {at: {name: known[at] for name, known in chances.items() if at in known} for at in plane.points}
    cells = [_cell(found, point, words[point], by_point[point]) for point in plane.points]
    return TrustMap(
        stands_on="floor" if plane.scene.pedestal is None else "pedestal",
        shares={kind: sum(cell["class"] == kind for cell in cells) / len(cells) for kind in CLASSES},
        confirmed_up_to_g=confirmed_up_to_g(found, words),
        contours={name: contour(name, cells, plane) for name in CONTOURS},
        cells=cells,
    )


def contour(name: str, cells: Sequence[TrustCell], plane: Plane) -> list[float | None]:
    """The least strength, g, at each frequency at which the value of one of `CONTOURS` is passed."""
    count = len(plane.amplitudes_g)
    line = []
    for i in range(len(plane.frequencies_hz)):
        duration_s = plane.at((i, 0)).duration_s
        heights = {cell["amplitude_g"]: _height(name, cell, duration_s) for cell in cells[i * count : (i + 1) * count]}
        known = {at: height for at, height in heights.items() if height is not None}
        line.append(crossing([*known.values()], CONTOURS[name], [*known]))
    return line


def _height(name: str, cell: TrustCell, duration_s: float) -> float | None:
    """What a contour is of, at one point; None where the model, having left its domain, knows no largest lean."""
    if name.startswith("probability"):
        chance = cell["probability"].get(MODEL)
        return 0.0 if chance is None else chance.value
    if name == "horizon":
        return 0.0 if cell["horizon_s"] is None else 1.0 - cell["horizon_s"] / duration_s
    if cell["peak_over_alpha"] is None:
        return math.inf if cell["outcomes"][MODEL] in ("overturned", "undecided") else None
    return cell["peak_over_alpha"]


def doubtful(chances: Mapping[Point, Interval]) -> list[Point]:
    """Of each frequency the point at which a fall is nearest as probable as not, where any is between `DOUBTFUL`."""
    open_ = (point for point, chance in chances.items() if DOUBTFUL[0] < chance.value < DOUBTFUL[1])
    along = grouped((point[0], point) for point in open_)
    return [min(points, key=lambda point: abs(chances[point].value - 0.5)) for points in along.values()]


def confirmed_up_to_g(found: Map, words: Mapping[Point, tuple[TrustClass, Basis, Said]]) -> float | None:
    """The largest strength up to which outcome and peak are confirmed at every frequency, and the model's outcome stays the same:
    between two strengths where it changes it is a matter of probability.
    """
    strengths, each = found.plane.amplitudes_g, range(len(found.plane.frequencies_hz))

    def confirmed(j: int) -> bool:
        known = all(words[i, j][0] in HELD and words[i, j][2].peak_confirmed for i in each)
        return known and all(found.model[i, j].outcomes == found.model[i, max(j - 1, 0)].outcomes for i in each)

    held = list(takewhile(confirmed, range(len(strengths))))
    return strengths[held[-1]] if held else None


def saved_by(names: Sequence[str], maps: Sequence[TrustMap]) -> dict[str, Saved]:
    """By model: at how many of the points known with and without the pedestal that prevents or causes a fall."""
    if len(maps) < 2:
        return {}
    own, floor = (each.cells for each in maps)
    return {
        name: Saved.of([(falls(without, name), falls(cell, name)) for cell, without in zip(own, floor, strict=True)])
        for name in names
    }


def falls(cell: TrustCell, name: str) -> bool | None:
    """Whether the statue falls by one model's own run, or by the limits of rest; None where it is not known."""
    ends = cell["outcomes"]
    end = ends.get(name if cell["basis"] != "rest" else MODEL)
    return None if end not in ("overturned", "stands") else end == "overturned"


def answer_of(plane: Plane, names: Sequence[str], maps: Sequence[TrustMap], saved: Mapping[str, Saved]) -> Answer:
    """The headline: up to which strength the model holds, whether space was asked of a scan, the shares of the plane,
    and what the pedestal saves.
    """
    frequencies = [each for each in plane.frequencies_hz if each is not None]
    over = {"from_g": plane.amplitudes_g[0], "to_g": plane.amplitudes_g[-1]}
    # The scene's own motion has no frequency of which to speak.
    every_hz = {"from_hz": frequencies[0], "to_hz": frequencies[-1]} if frequencies else {}
    refuted = [changes_answer("trust_refuted", share=each.shares["refuted"]) for each in maps if each.shares["refuted"]]
    held, told = list[Finding](), list[Finding]()
    for each in maps:
        where, up_to_g = "own" if each is maps[0] else "floor", each.confirmed_up_to_g
        held_where = where if up_to_g is not None else f"{where}_nowhere"
        held.append(info("trust_up_to", where=held_where, strength_g=up_to_g, **every_hz))
        shares = {kind: share for kind, share in each.shares.items() if share}
        shaken = plane.motion if where == "own" else where
        told.append(info("trust_shares", where=shaken, shares=shares, **over, **every_hz))
    planar = all(engines.load(name).capabilities.dimensions == PLANAR for name in names)
    alone = [caution("trust_in_plane")] if planar and not plane.shaken.planar else []
    first = knows_most(saved, MODEL)
    pedestal = [] if first is None else [info("pedestal_saves", model=first, **vars(saved[first]))]
    return Answer("refuted" if refuted else "trust_map", [*refuted[:1], *held, *alone, *pedestal, *told])


def findings_of(
    maps: Sequence[TrustMap], saved: Mapping[str, Saved], summary: TrustSummary, seed: int
) -> list[Finding]:
    """What the maps rest on, why models left their domain or the plane is not enough, and what the pedestal saves by engines."""
    some = summary.whole if summary.whole < summary.asked else None
    checks, first = {"checked": summary.checked, "changed": summary.changed, "seed": seed}, knows_most(saved, MODEL)
    found = [
        info("trust_asked", points=summary.points, asked=summary.asked, some=some),
        caution("trust_checked", **checks) if summary.changed else info("trust_checked", **checks),
        *(info("pedestal_saves", model=name, **vars(each)) for name, each in saved.items() if name != first),
    ]
    cells = [cell for each in maps for cell in each.cells]
    for kind in ("left_domain", "plane_left_out", "no_answer"):
        causes = sorted({cause for cell in cells if cell["class"] == kind for cause in cell["why"]})
        found += [caution("trust_why", kind=kind, causes=causes)] if causes else []
    return found


def write_cells(maps: Sequence[TrustMap], path: Path) -> None:
    """A row for each point of each map; what is of one model has its columns after all others, outcomes first."""
    rows = [_row(each.stands_on, cell) for each in maps for cell in each.cells]
    names = dict.fromkeys(name for row in rows for name in row)
    columns = sorted(names, key=lambda name: (name.startswith("probability_"), name.startswith("outcome_")))
    with path.open("w", newline="", encoding="utf-8") as stream:
        table = csv.DictWriter(stream, columns)
        table.writeheader()
        table.writerows(rows)


def _row(stands_on: str, cell: TrustCell) -> dict[str, object]:
    """A point by its columns: lists as words, and a column for each model's outcome and probability with its interval."""
    single = {name: value for name, value in cell.items() if name not in ("outcomes", "probability", "paths")}
    single |= {"why": " ".join(cell["why"]), "set": " ".join(f"--set '{item}'" for item in cell["set"])}
    outcomes = {f"outcome_{name}": end for name, end in cell["outcomes"].items()}
    chances = {
        f"probability_{name}{end}": value
        for name, chance in cell["probability"].items()
        for end, value in (("", chance.value), ("_low", chance.low), ("_high", chance.high))
    }
    return {"stands_on": stands_on, **single, **outcomes, **chances}


def _cell(found: Map, point: Point, word: tuple[TrustClass, Basis, Said], chances: Mapping[str, Interval]) -> TrustCell:
    """A point as it stands in the record; numbers of runs only where it has its own."""
    kind, basis, by = word
    own, model, plane = point in found.ran, found.model[point], found.plane
    strength, frequency = plane.without_dimension(point)
    return {
        "amplitude_g": plane.amplitudes_g[point[1]],
        "frequency_hz": plane.frequencies_hz[point[0]],
        "class": kind,
        "basis": basis,
        "answer": by.answer if own else "",
        "why": by.why if basis != "rest" else [],
        "outcomes": by.outcomes if own else model.outcomes,
        "peak_rad": model.peak_rad,
        "peak_over_alpha": model.balance_share,
        "peaks_apart_rad": by.peaks_apart_rad if own else None,
        "agree_until_s": by.agree_until_s if own else None,
        "horizon_s": model.horizon_s,
        "probability": chances,
        "amplitude_over_g_tan_alpha": strength,
        "frequency_over_p": frequency,
        "set": plane.command(point),
        "paths": found.paths.get(point, {}),
    }


def _died(names: tuple[str, ...]) -> Said:
    """A point whose process died."""
    ends = dict.fromkeys(names, "crashed")
    alike = ends.get(MODEL), False, False, "", False
    return Said("no_answer", "no_answer", ["crashed"], ends, False, alike, None, None, None, None, None)
