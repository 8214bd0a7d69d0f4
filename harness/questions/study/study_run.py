"""Many scenes, several engines: which case is sent to which engine and why, very many cases of the model in blocks; results are
cached, what is finished is never lost. Beside it a witness of a tenth of its scenes, one scene's sweep, and how long it may take.
"""

import hashlib
import itertools
import json
import math
import random
import time
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from operator import itemgetter
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from analytic.block import AnalyticInputError
from analytic.excitation import SampledAcceleration
from analytic.problem import LEFT_BY, OUTCOMES, peak_is_ahead
from analytic.sweep import CertifiedRows, certify_rows
from harness import engines
from harness.accuracy.forecast import CERTIFIED_S, START_S, expected_steps, run_s, timed_step_s
from harness.accuracy.refinement import DEFAULT_ACCURACY_RAD, check_target, first_level, simulate
from harness.engines import analytic as twoblock
from harness.engines.base import RELIABLE_RAD, EngineFailure, own_settings
from harness.engines.stepping.loop import refuse_steering
from harness.input.tables import plain
from harness.model import (
    NUMBERS,
    BaseExcitation,
    InputError,
    Mistake,
    Outcome,
    RunOptions,
    RunSet,
    Scene,
    column_of,
    must_be_scene,
    require,
    to_plain,
    versions,
)
from harness.model.run_set import run_set
from harness.questions.scene.scene_run import LONGEST_S
from harness.questions.scene.witness import BUDGET, findings_of, plain_names, witnesses
from harness.questions.study.cases import (
    COARSEST,
    EVERY,
    NOT_SENT,
    REFERENCE,
    SAME_CELL,
    BaseScene,
    Case,
    CaseScenes,
    Place,
    PlaceAnswer,
    StillScene,
    StudyFile,
    Value,
    base_of,
    expand,
    map_axes,
    near_boundary,
    rechecked,
    refined,
)
from harness.records.base import Plain, part
from harness.records.run import PLAIN, Witness
from harness.records.study import CaseRun, StudySummary, StudyWitness, UsageRecord, WitnessCount
from harness.runs.execute import Campaign, OnProgress, execute, silent
from harness.runs.progress import counted, duration_words
from harness.runs.runner import Pool
from harness.runs.store import Store
from harness.runs.task import RUN, RunRequest, Task, TaskResult, key_of, run_request, scene_key

# Very many cases by the analytic model alone: blocks of neighbouring cases, each run in two compiled sweeps.

Columns = dict[str, NDArray[Any]]
COLUMNS: Final = "columns"
"""Kind of a result that is a block."""
LEAST_RUNS: Final = 2_000
"""From so many runs on a study's results stand in columns: a tenth of the bytes, two thirds of the processor time (of 2520
runs). Rows are shared between studies, and what is the same by its physics is computed once."""
BLOCK: Final = 16_384
"""Cases of a block: some seconds of work, a megabyte to send."""
MOST_SAMPLES: Final = 4_000_000
"""Samples of records that are run together, 64 MB of them."""


def in_columns(study: StudyFile, base: BaseScene) -> bool:
    """Whether a study's results stand in columns: very many runs of the analytic model, for their outcomes alone."""
    own = {name for variant in study.variant for name in variant.engines} == {REFERENCE}
    bare = study.ask.cases == "all" and not study.ask.histories and study.claims is None
    # A file that a case names is no part of its block's name, and what begins from a pose fails run by run.
    values = [value for item in study.vary for value in item.values or ()]
    named = any(isinstance(value, str) and value not in ("keep", "none") for value in values)
    initial = base.content.get("initial")
    posed = isinstance(initial, Mapping) and "position_m" in initial
    return study.runs >= LEAST_RUNS and own and bare and not named and not posed


@dataclass(frozen=True)
class CaseBlock:
    """Neighbouring cases of a study: everything that a worker on another machine needs."""

    study: StudyFile
    base: BaseScene
    numbers: range


def block_tasks(study: StudyFile, base: BaseScene) -> Iterator[Task]:
    """The blocks of a study, in order; each is named by the study's content, its scene's (files included), and versions."""
    asked = study.asked_rad.get(REFERENCE, DEFAULT_ACCURACY_RAD)
    request = RunRequest(lambda: base.scene({}), REFERENCE, asked)
    keys = [request.task(base.scene(variant.set)).key for variant in study.variant]
    name = key_of(study.model_dump_json(), base.content, keys)
    for start in range(0, study.runs, BLOCK):
        block = CaseBlock(study, base, range(start, min(start + BLOCK, study.runs)))
        yield Task(key_of(name, start, BLOCK), run_block, block, REFERENCE, runs=len(block.numbers))


def run_block(block: CaseBlock) -> TaskResult:
    """Run every case of a block: its columns, and what they have in common."""
    begin = time.perf_counter()
    cases = list(expand(block.study, block.base, block.numbers))
    runs = SweptRuns(block.base, block.study.asked_rad.get(REFERENCE, DEFAULT_ACCURACY_RAD))
    for place, case in enumerate(cases):
        runs.add(place, case.setting)
    varied = {key: varied_column(block.study, key, [case.varied[key] for case in cases]) for key in cases[0].varied}
    named = {"number": np.array(block.numbers), "variant": column_of([case.variant for case in cases])}
    table = {**named, **varied, **runs.columns()}
    record = {"settings": runs.settings, "varied": list(varied), "outcomes": Counter(table["outcome"].tolist())}
    seconds = time.perf_counter() - begin
    return TaskResult(COLUMNS, to_plain(record), seconds, inside_s=runs.inside_s, failed=runs.failed, table=table)


class SweptRuns:
    """Cases of a base scene, gathered and run together; one that the model refuses is run, and fails, as any single run does."""

    def __init__(self, base: BaseScene, asked_rad: float) -> None:
        self._base, self._asked = base, asked_rad
        level = first_level(engines.load(REFERENCE).refinement_levels(base.scene({})), asked_rad, 1.0)[0]
        chosen = own_settings(REFERENCE, twoblock.TwoBlockSettings, level)
        self.settings = twoblock.stated_settings(chosen)
        self._scenes = _scenes(base, min(RELIABLE_RAD, chosen.accuracy_rad))
        self._gathered: list[Shaken] = []
        self._samples = 0
        self._parts: list[Columns] = []
        self.inside_s = 0.0
        self.failed = 0

    def add(self, place: int, setting: Mapping[str, Value]) -> None:
        """Gather a case by the keys that it sets, or run it. Raises `InputError` for a case that is no scene."""
        try:
            still = self._scenes.still(setting)
            shaken = Shaken(place, still, self._scenes.motion(setting, still.scene))
        except AnalyticInputError:
            made = partial(self._base.scene, setting)
            answer = run_request(RunRequest(made, REFERENCE, self._asked))
            self.failed += answer.failed
            self._parts.append({"place": np.array([place]), **columns_of_record(answer.record)})
            return
        except (InputError, ValidationError):
            # What is refused in parts is resolved whole, so that the same mistake is told as of a single run.
            self._base.scene(setting)
            raise
        self._gathered.append(shaken)
        axes = shaken.motion.x, shaken.motion.z
        self._samples += sum(item.t_s.size for item in axes if isinstance(item, SampledAcceleration))
        if self._samples > MOST_SAMPLES:
            self._run()

    def columns(self) -> Columns:
        """All that was added, in order."""
        self._run()
        order = np.argsort(np.concatenate([part["place"] for part in self._parts]), kind="stable")
        return {
            name: np.concatenate([part[name] for part in self._parts])[order]
            for name in self._parts[0]
            if name != "place"
        }

    def _run(self) -> None:
        """Run what was gathered in two sweeps."""
        if not self._gathered:
            return
        start = time.perf_counter()
        self._parts.append(swept(self._gathered))
        self.inside_s += time.perf_counter() - start
        self._gathered, self._samples = [], 0


_REMEMBERED: Final[dict[str, CaseScenes]] = {}
"""The scenes of the study at work: what its blocks share is read once in each worker."""


def _scenes(base: BaseScene, accuracy: float) -> CaseScenes:
    name = json.dumps([str(base.path), base.content, accuracy], default=str)
    if name not in _REMEMBERED:
        _REMEMBERED.clear()
        _REMEMBERED[name] = CaseScenes(base, accuracy)
    return _REMEMBERED[name]


# Cases of a study by the analytic model as columns, and columns as the records that a store of single runs holds.

VALIDITY: Final = {
    "energy_gained_j": "energy_gained_j",
    "energy_lost_j": "energy_lost_j",
    "floor_normal_least_n": "least_floor_normal_n",
    "left_domain_s": "left_domain_s",
    "statue_friction_needed": "pivot_friction",
    "statue_friction_needed_at_impact": "pivot_friction_at_impact",
    "statue_normal_least_n": "least_pivot_normal_n",
}
TIPPING: Final = {
    "pedestal_tipping_margin_at_impact_m": "tipping_margin_at_impact_m",
    "pedestal_tipping_margin_m": "tipping_margin_m",
}
"""Names of a run's record, and of what the kernel leaves behind; the last only where there is a pedestal."""
WORK: Final = {"events": "events", "impacts": "impacts", "taylor_coefficients": "coefficients"}
OF_RUN: Final = (*NUMBERS, "outcome", "findings", "skipped", "steps")
"""Columns that stand in the record itself."""
TABLES: Final = ("skipped", "findings")
"""Columns that hold JSON."""
OF_VALIDITY: Final = ("left_domain_by", "peak_over_slenderness", *VALIDITY)


class Shaken(NamedTuple):
    """A case as the model reads it, and its place among others."""

    place: int
    still: StillScene
    motion: BaseExcitation


def swept(cases: Sequence[Shaken]) -> Columns:
    """Run the cases; what their records hold, as columns (n,), with their places."""
    stills = list({id(case.still): case.still for case in cases}.values())
    numbers = {id(still): k for k, still in enumerate(stills)}
    which = np.array([numbers[id(case.still)] for case in cases])
    motions = [(case.motion.x, case.motion.z) for case in cases]
    rows = certify_rows([still.body for still in stills], which, motions, RELIABLE_RAD)
    slender = np.array([[still.scene.statue.slenderness_rad(side) for side in (-1, 1)] for still in stills])[which]
    pedestal = np.array([still.scene.pedestal is not None for still in stills])[which]
    certified = [rows.certified(k) for k in range(len(cases))]
    findings = [
        (*twoblock.findings_of(each), *twoblock.left_out(case.motion))
        for each, case in zip(certified, cases, strict=True)
    ]
    return {
        "place": np.array([case.place for case in cases]),
        **_numbers(rows, slender, pedestal),
        "motion_axes": column_of(["".join(case.motion.axes(2)) for case in cases]),
        "findings": column_of([json.dumps(to_plain(each)) for each in findings]),
        "skipped": column_of([json.dumps(to_plain(twoblock.skipped(each.solution, keep=False))) for each in certified]),
        "record": column_of([None] * len(cases)),
    }


def _numbers(rows: CertifiedRows, slenderness_rad: NDArray[np.float64], pedestal: NDArray[np.bool_]) -> Columns:
    """Of α (n, 2) the left and the right side."""
    states, results, counts = rows.first.states, rows.first.results, rows.first.counts
    signed = results["peak_theta_rad"]
    peak = np.abs(signed)
    ahead = peak_is_ahead(counts["energy_endings"], results["peak_time_s"], states["time_s"])
    falls = np.isin(states["outcome"], [k for k, item in enumerate(OUTCOMES) if Outcome(item.value).overturned])
    columns: Columns = {name: np.full(peak.size, value) for name, value in NUMBERS.items()}
    columns |= {
        "outcome": column_of([OUTCOMES[code].value for code in states["outcome"].tolist()]),
        "end_s": states["time_s"],
        "peak_theta_rad": peak,
        "peak_time_s": np.where(ahead, np.nan, results["peak_time_s"]),
        "residual_slip_m": states["slip_m"],
        "no_return_time_s": np.where(falls, results["no_return_time_s"], np.nan),
        "numerical_uncertainty_rad": rows.uncertainty_rad,
        "slip_uncertainty_m": rows.slip_uncertainty_m,
        "reliable_until_s": rows.reliable_until_s,
        "steps": counts["steps"],
        "left_domain_by": column_of([LEFT_BY[code] for code in results["left_domain_by"].tolist()]),
        "peak_over_slenderness": peak / np.where(signed > 0.0, slenderness_rad[:, 1], slenderness_rad[:, 0]),
        "on_pedestal": pedestal,
        "overturn_time_s": results["overturn_time_s"],
        "peak_slip_m": results["peak_slip_m"],
    }
    columns |= {name: results[source] for name, source in VALIDITY.items()}
    columns |= {name: np.where(pedestal, results[source], np.nan) for name, source in TIPPING.items()}
    return columns | {name: counts[source] for name, source in WORK.items()}


def columns_of_record(record: Plain) -> Columns:
    """One run's record as columns of one row: what of it other rows have too, and the whole as text."""
    numbers = {name: record.get(name) for name in OF_RUN if name not in TABLES}
    own = {name: np.array([np.nan if value is None else value]) for name, value in numbers.items()}
    lists = {name: column_of([json.dumps(record[name])]) for name in TABLES}
    words = {"outcome": record["outcome"], "left_domain_by": "", "motion_axes": "", "record": json.dumps(record)}
    said = {name: column_of([value]) for name, value in words.items()}
    nothing = {name: np.array([np.nan]) for name in (*VALIDITY, *TIPPING, "peak_over_slenderness")}
    counts = {name: np.array([0]) for name in WORK}
    return {**own, **nothing, **counts, **said, **lists, "on_pedestal": np.array([False])}


def varied_column(study: StudyFile, key: str, values: list[Value]) -> NDArray[Any]:
    """What varies as a column: numbers of one kind as they are, anything else as JSON; alike in every block of the study."""
    given = next((item.values for item in study.vary if item.key == key), None)
    kinds = {type(value) for value in given} if given is not None else {float}
    return np.array(values) if kinds in ({float}, {int}) else column_of([json.dumps(value) for value in values])


def rows_of(table: Columns, block: Plain) -> Iterator[tuple[int, dict[str, Value], Plain]]:
    """Number, what varies and record of each row of a block: the record that a store of single runs would hold."""
    named = {name: _plain(values) for name, values in table.items()}
    keys: Any = block["varied"]
    for row in (dict(zip(named, values, strict=True)) for values in zip(*named.values(), strict=True)):
        varied = {key: json.loads(row[key]) if isinstance(row[key], str) else row[key] for key in keys}
        record = _record(row, block["settings"]) if row["record"] is None else json.loads(row["record"])
        # By name, as a store has them.
        yield row["number"], dict(sorted({"variant": row["variant"], **varied}.items())), dict(sorted(record.items()))


def _plain(values: NDArray[Any]) -> list[Any]:
    """A column's values; a number that is not finite is None, as it is in a record."""
    if values.dtype.kind != "f":
        return list(values.tolist())
    column = values.astype(object)
    column[~np.isfinite(values)] = None
    return list(column)


def _record(row: Mapping[str, Any], settings: Any) -> Plain:
    """The record of one run; what it has that no outcome of the model has is empty."""
    validity = {name: row[name] for name in OF_VALIDITY}
    if row["on_pedestal"]:
        validity |= {name: row[name] for name in TIPPING}
    if row["outcome"] == Outcome.TOUCHES_WALL.value and row["peak_time_s"] is not None:
        validity["wall_touch_time_s"] = row["end_s"]
    return {
        "engine": twoblock.TwoBlock.name,
        "impact_times_s": [],
        "interventions": {},
        "labels": [],
        "message": "",
        "motion_axes": list(str(row["motion_axes"])),
        "patterns": [],
        "settings": settings,
        "uplift_times_s": [],
        "validity": {**validity, "impact_ratios": [], "several_joint_states_s": []},
        "work": {name: row[name] for name in WORK},
        **{name: row[name] for name in OF_RUN if name not in TABLES},
        **{name: json.loads(str(row[name])) for name in TABLES},
    }


# Which case is sent to which engine, and why: a plan of any size is made as it is run.

BATCH: Final = {"analytic": 64}
"""Runs handed to a worker at a time: a run of a fraction of a millisecond is not worth a message of its own."""
PlanRow = tuple[int, str, str | None, str, Mapping[str, Value]]


@dataclass(frozen=True, kw_only=True)
class Summary(StudySummary):
    """What a call of a study did, and where its seconds went."""

    usage: UsageRecord


def run_study(
    study: StudyFile,
    path: Path,
    store: Store,
    pool: Pool,
    on_progress: OnProgress = silent,
    *,
    singly: bool = False,
) -> Summary:
    """Run what the study asks and the store does not hold; `on_progress(done, all)` hears of progress.

    The analytic model runs first where the question needs its answers, then the others in as many rounds as it takes. Every
    result is in the store as soon as it is finished. Many runs of the model alone are computed in blocks, unless each is wanted
    `singly`, as a witness judges them. Raises `InputError` for a case that is no scene.
    """
    base = base_of(study, path)
    rows: Iterable[PlanRow]
    if in_columns(study, base) and not singly:
        # To know which of very many cases are the same by their physics would take as long.
        campaign, tasks = Campaign(store, pool, on_progress), list(block_tasks(study, base))
        campaign.run(tasks, study.runs)
        rows = [(task.argument.numbers.start, REFERENCE, task.key, EVERY, {}) for task in tasks]
        counts = dict.fromkeys(("cases", "wanted", "distinct"), study.runs)
        counts["found"] = study.runs - campaign.computed
    else:
        plan = StudyPlan(study, base, store)
        campaign = Campaign(store, pool, on_progress, BATCH, free=plan.free)
        for expected, asked in plan.rounds():
            campaign.run(asked, expected)
        rows, counts = plan.rows(), plan.counts()
        counts["found"] = len(campaign.reused)
    store.write_plan(study_name(study), rows)
    return Summary(**counts, computed=campaign.computed, failed=campaign.failed, usage=campaign.usage())


def study_name(study: StudyFile) -> str:
    """What names a study in its store: its title and the hash of its content."""
    digest = hashlib.sha256(study.model_dump_json().encode()).hexdigest()
    return f"{study.title} [{digest[:12]}]"


class StudyPlan:
    """What is asked of each engine, as far as is known; what was planned once is not planned again."""

    def __init__(self, study: StudyFile, base: BaseScene, store: Store) -> None:
        self._study, self._base, self._store = study, base, store
        self._cases = list(expand(study, base))
        self._keys: dict[tuple[int, str], str] = {}
        self._reasons: dict[tuple[int, str], str] = {}
        """Keys of what is asked, and why each case is or is not, by case and engine."""
        named = {name for variant in study.variant for name in variant.engines}
        self._others = sorted(named - {REFERENCE})
        self.free = (REFERENCE,) if self._others else ()
        """What costs next to nothing beside the others."""

    def rounds(self) -> Iterator[tuple[int, Iterable[Task]]]:
        """How many tasks that cost something, and the tasks; the next round rests on what the store then holds of the last.

        Contact engines' are in a seeded order, what is stored first: the rate at which they finish tells the time that is left.
        """
        stored = self._store.keys()
        of_reference = 0 if self.free else self._study.runs, self._asked([REFERENCE])
        rests_on_it = self._study.ask.cases != "all"
        if rests_on_it:
            yield of_reference
        # What is the same by its physics is one task.
        while tasks := {task.key: task for task in self._asked(self._others)}:
            order = random.Random(self._study.seed).sample([*tasks.values()], len(tasks))
            yield len(order), sorted(order, key=lambda task: task.key not in stored)
        if not rests_on_it:
            yield of_reference

    def _asked(self, names: Sequence[str]) -> Iterator[Task]:
        """What these engines are asked now and were not asked before."""
        left_out = SAME_CELL if self._study.ask.cases == "adaptive" else NOT_SENT
        for name, variant in itertools.product(names, self._study.variant):
            if name not in variant.engines:
                continue
            cases = [case for case in self._cases if case.variant == variant.name]
            reasons, accuracy_rad = self._why(name, cases), self._study.asked_rad.get(name, DEFAULT_ACCURACY_RAD)
            for case in cases:
                place = case.number, name
                if place in self._keys:
                    continue
                self._reasons[place] = reasons.get(case.position, left_out)
                if case.position in reasons:
                    made = partial(self._base.scene, case.setting)
                    task = RunRequest(made, name, accuracy_rad, history=self._study.ask.histories).task(made())
                    self._keys[place] = task.key
                    yield task

    def _why(self, engine: str, cases: Sequence[Case]) -> dict[Place, str]:
        """Why each of these places is asked of an engine, from what is known so far."""
        ask, places = self._study.ask, [case.position for case in cases]
        if engine == REFERENCE or ask.cases == "all":
            return dict.fromkeys(places, EVERY)
        if ask.cases == "boundary":
            known = self._answers(REFERENCE, cases)
            return near_boundary(known, ask.margin, ask.audit, self._study.seed)
        outcomes = {place: answer.outcome for place, answer in self._answers(engine, cases).items()}
        return refined(places, outcomes, map_axes(self._study)) | rechecked(places, ask.audit, self._study.seed)

    def _answers(self, engine: str, cases: Sequence[Case]) -> dict[Place, PlaceAnswer]:
        """What an engine has said of these cases."""
        answers = {}
        for case in cases:
            key = self._keys.get((case.number, engine))
            record = None if key is None else self._store.get(key)
            if record is not None:
                run = CaseRun.stored(record)
                share = run.validity.get("peak_over_slenderness")
                peak = float(share) if isinstance(share, (int, float)) and share else abs(run.peak_theta_rad)
                answers[case.position] = PlaceAnswer(run.outcome.value, peak)
        return answers

    def rows(self) -> Iterator[PlanRow]:
        """All cases and engines in order: number, engine, key (None: not sent), reason, and what varies."""
        for case in self._cases:
            varied = {"variant": case.variant, **case.varied}
            for place in [(case.number, engine) for engine in sorted(case.engines)]:
                yield *place, self._keys.get(place), self._reasons[place], varied

    def counts(self) -> dict[str, int]:
        """How many cases, runs wanted, distinct ones and those not sent to an engine."""
        wanted, known = len(self._keys), len(self._reasons)
        cases, distinct = len({number for number, _ in self._reasons}), len({*self._keys.values()})
        return {"cases": cases, "wanted": wanted, "distinct": distinct, "not_sent": known - wanted}


# A seeded tenth of a study's scenes with a witness: do the unmodified engines confirm the answers of the others?

SHARE: Final = 0.1
"""Of the scenes: the run is made again and a witness costs as much at most, so a tenth of them adds a fifth or less."""
KIND: Final = "witness"
"""Kind of its results in a store."""


def witness_scene(asked: tuple[BaseScene, Mapping[str, Value], Mapping[str, float]]) -> TaskResult:
    """Run the engines again, with their histories, to these accuracies, and what the plain ones say of them; by plain engine."""
    begin = time.perf_counter()
    base, setting, accuracy_rad = asked
    scene = base.scene(setting)
    runs = {name: simulate(scene, name, accuracy_rad=target) for name, target in accuracy_rad.items()}
    plain = {name: to_plain(item) for name, item in witnesses(scene, runs, RunOptions()).items()}
    return TaskResult(KIND, plain, time.perf_counter() - begin)


def witness_study(
    study: StudyFile, path: Path, store: Store, pool: Pool, on_progress: OnProgress = silent
) -> StudyWitness | None:
    """What the plain engines say of a tenth of the scenes of a study that was run, drawn with its seed; None: no engine has one.

    What the store holds is not computed again.
    """
    begin = time.perf_counter()
    judged = _answered(store, study)
    base = base_of(study, path)
    cases = (case for case in expand(study, base) if case.number in judged) if judged else ()
    settings = {case.number: case.setting for case in cases if _computable(base.scene(case.setting))}
    chosen = drawn(list(settings), study.seed)
    if not chosen:
        return None
    asked_rad = [{name: study.asked_rad.get(name, DEFAULT_ACCURACY_RAD) for name in judged[each]} for each in chosen]
    tasks = [
        Task(key_of(KIND, judged[number], versions()), witness_scene, (base, settings[number], targets), KIND)
        for number, targets in zip(chosen, asked_rad, strict=True)
    ]
    records = Campaign(store, pool, on_progress).ask(tasks)
    said = {
        number: {name: part(Witness, item, store.path) for name, item in record.items()}
        for number, record in zip(chosen, records, strict=True)
        if record is not None
    }
    return _counted(said, len(settings), time.perf_counter() - begin)


def drawn(numbers: Sequence[int], seed: int) -> list[int]:
    """A seeded tenth of the cases, at least one of any: the same in every call."""
    return sorted(random.Random(f"witness {seed}").sample(sorted(numbers), math.ceil(SHARE * len(numbers))))


def _computable(scene: Scene) -> bool:
    """Whether unmodified engines take a scene at all."""
    try:
        refuse_steering(scene, "")
    except EngineFailure:
        return False
    return True


def _answered(store: Store, study: StudyFile) -> dict[int, dict[str, str]]:
    """By the first case of each distinct scene that an engine with a plain one has answered: keys of its results by engine."""
    by_number: dict[int, dict[str, str]] = {}
    for row in store.rows(study_name(study)):
        # The model's answers are held against the plain engines, too: they cost nothing.
        judged = row.engine == REFERENCE or row.engine + PLAIN in engines.REGISTRY
        if judged and row.key is not None and row.kind == RUN and row.run and row.run["reliable_until_s"] != 0.0:
            by_number.setdefault(row.number, {})[row.engine] = row.key
    first: dict[tuple[tuple[str, str], ...], int] = {}
    for number, keys in by_number.items():
        if plain_names(list(keys)):
            first.setdefault(tuple(sorted(keys.items())), number)
    return {number: by_number[number] for number in sorted(first.values())}


def _counted(said: Mapping[int, Mapping[str, Witness]], scenes: int, seconds: float) -> StudyWitness:
    counts, differing = {}, []
    for name in sorted({name for answers in said.values() for name in answers}):
        mine = {number: answers[name] for number, answers in said.items() if name in answers}
        own = [item.runs.get(name.removesuffix(PLAIN)) for item in mine.values()]
        counts[name] = WitnessCount(
            confirmed=sum(item.agrees is True for item in mine.values()),
            differ=sum(each is not None and not each.agrees for each in own),
            silent=sum(item.agrees is None for item in mine.values()),
        )
        for number, item in mine.items():
            parts = [found for found in findings_of({name: item}) if found.code == "witness_parts"]
            differing += [replace(found, values={**found.values, "case": number}) for found in parts]
    return StudyWitness(scenes=len(said), of=scenes, counts=counts, differing=differing, seconds=seconds)


# Many runs of one scene, over every combination of some values of its keys: one table.


def sweep(
    scene: Scene,
    values: Mapping[str, Iterable[object]],
    engine: str = "analytic",
    *,
    accuracy_rad: float | None = None,
    history: bool = False,
    store: Path | str | None = None,
    jobs: int = 1,
) -> RunSet:
    """Run a scene with every combination of some values of its keys, the last key innermost.

    >>> runs = harness.sweep(scene, {"motion.x.amplitude_g": [0.2, 0.3, 0.4]}, "analytic")
    >>> frame = runs.to_dataframe()

    The analytic model's runs for their outcomes are computed together, on all cores; others, and those that keep their `history`,
    as `harness.execute` does, whose `store` and `jobs` these are. Raises `InputError` for a key or value that makes no scene, an
    unknown engine, or a scene of resolved parts, whose keys are not known.
    """
    check_target(accuracy_rad, None)
    engines.load(engine)
    wanted = 'values by dotted key, such as {"motion.x.amplitude_g": [0.2, 0.3]}'
    require(isinstance(values, Mapping) and values, "sweep", wanted, repr(values), key="values")
    axes = {key: _values(key, given) for key, given in values.items()}
    must_be_scene(scene, "sweep")
    require(scene.given, "sweep", "a scene that was loaded, whose keys are known", "one made of parts", key="scene")
    settings: list[dict[str, Any]] = [
        dict(zip(axes, point, strict=True)) for point in itertools.product(*axes.values())
    ]
    asked = accuracy_rad or DEFAULT_ACCURACY_RAD
    single = all(isinstance(value, Value) for value in itertools.chain(*axes.values()))
    if engine == "analytic" and single and scene.initial.pose is None and not history and store is None:
        runs = SweptRuns(BaseScene(scene.source, scene.given), asked)
        for place, setting in enumerate(settings):
            runs.add(place, setting)
        columns = runs.columns()
        numbers = {name: columns[name] for name in (*NUMBERS, "steps", "impacts")}
        return run_set(scene.title, settings, [engine] * len(settings), columns["outcome"].tolist(), numbers)
    requests = [RunRequest(scene.replace(each), engine, asked, history=history, varied=each) for each in settings]
    return execute(requests, store, title=scene.title, jobs=jobs)


def _values(key: str, given: object) -> list[object]:
    found = plain(list(given) if isinstance(given, range) else given)
    if not isinstance(found, list) or not found:
        raise InputError(Mistake("sweep", key, "a list of values", repr(found)))
    return ["none" if value is None else value for value in found]


# How long a study may take, told before it begins; studies over a day need `--large`.

TRIALS: Final = 16
"""Drawn cases of each variant that are looked at: their mean is off by a sixth where one differs from another by two thirds."""
CASE_S: Final = 5e-3
"""Processor seconds of a case by the analytic model with what is around it: read, named, run, kept, scored and drawn."""
ROW_S: Final = 6e-5
"""The same where results stand in columns, for each second of motion."""
RESULT_S: Final = 4.0
"""To begin, to score, and to write the record and its pages."""
BOUNDARY: Final = 4.0
"""Points of an adaptive map along the line on which the outcome changes, in points along both axes."""
SHORTEST_LIMIT_S: Final = 600.0
"""A worker that has not answered for this long may still be compiling the model, or loading a large scan."""
MOST_CASES: Final = 2_000_000
"""Larger studies, and longer ones, are run only when that is asked for."""


class StudyCost(NamedTuple):
    """Processor seconds that a study is expected to take, and those of a run of a contact engine: 0 where it has none."""

    cpu_s: float
    each_s: float


def study_cost(study: StudyFile, base: BaseScene, workers: int, *, witness: bool = False) -> StudyCost:
    """What the study is expected to take, nothing of it being stored yet: by drawn cases of each variant.

    What is the same to an engine by its physics counts once.
    """
    rows = study.points * sum(REFERENCE in variant.engines for variant in study.variant)
    if in_columns(study, base) and not witness:
        return StudyCost(RESULT_S + rows * ROW_S * base.scene(study.variant[0].set).duration_s, 0.0)
    stream, spent, contact = random.Random(study.seed), 0.0, 0.0
    steps: dict[tuple[str, bool], float] = defaultdict(float)
    timed: dict[tuple[str, bool], tuple[float, Scene]] = {}
    for variant in range(len(study.variant)):
        drawn = stream.sample(range(study.points), min(TRIALS, study.points))
        for case in expand(study, base, [len(study.variant) * point + variant for point in drawn]):
            scene = base.scene(case.setting)
            for name in sorted(set(case.engines) - {REFERENCE}):
                runs = min(_sent(study), study.points / alike(study, base, case, name)) / len(drawn)
                contact += runs
                if name in CERTIFIED_S:
                    spent += runs * run_s(name, scene).middle
                    continue
                kind = name, scene.pedestal is not None
                each = expected_steps(name, scene, study.asked_rad.get(name)).middle
                steps[kind] += runs * each
                # The longest: in a fall steps take several times as long.
                timed[kind] = max(timed.get(kind, (0.0, scene)), (each, scene), key=itemgetter(0))
    spent += sum(
        count * timed_step_s(kind[0], timed[kind][1], study.asked_rad.get(kind[0])) for kind, count in steps.items()
    )
    spent *= 1.0 + witness * SHARE * (1.0 + BUDGET)
    return StudyCost(RESULT_S + START_S * workers + CASE_S * rows + spent, spent / contact if contact else 0.0)


def alike(study: StudyFile, base: BaseScene, case: Case, name: str) -> float:
    """How many cases of its variant are one run to an engine: the product of how many are along each axis through the case."""
    engine, sizes = engines.load(name), [*study.sizes, len(study.variant)]

    def key(place: tuple[int, ...]) -> str:
        (there,) = expand(study, base, [int(np.ravel_multi_index(place, sizes))])
        return scene_key(base.scene(there.setting), engine.capabilities)

    here = study.place(case.number)
    mine, product = key(here), 1.0
    for axis, size in enumerate(study.sizes):
        others = sorted({0, size // 2, size - 1} - {here[axis]})
        same = [key((*here[:axis], at, *here[axis + 1 :])) == mine for at in others]
        product *= 1.0 + (size - 1) * sum(same) / max(len(same), 1)
    return product


def limit_s(study: StudyFile, scene: Scene) -> float:
    """How long a worker may go without an answer before it is taken to hang: a hundred times the forecast of its longest run."""
    names = {engine for variant in study.variant for engine in variant.engines}
    return SHORTEST_LIMIT_S + 100.0 * max(run_s(name, scene, study.asked_rad.get(name)).middle for name in names)


def _sent(study: StudyFile) -> float:
    """Cases that a contact engine may be asked."""
    if study.ask.cases != "adaptive":
        return float(study.points)
    along = sum(study.vary[axis].count or 1 for axis in map_axes(study))
    return min(study.points * (study.ask.audit + COARSEST**-2.0) + BOUNDARY * along, float(study.points))


def told_size(study: StudyFile, cpu_s: float, workers: int, where: str, *, large: bool = False) -> str:
    """The size of a study in words. Raises `InputError` for more cases or hours than anyone starts without knowing it."""
    cases = study.points * len(study.variant)
    at_most = "at most " if study.ask.cases != "all" else ""
    spent, clock = duration_words(cpu_s), duration_words(cpu_s / workers)
    size = f"{counted(cases, 'case')}, {at_most}{counted(study.runs, 'run')}"
    told = f"{size}: {at_most}about {spent} of processor time, {clock} by the clock (workers: {workers})"
    wanted = f"at most {MOST_CASES} cases and {duration_words(LONGEST_S)}"
    advice = "a coarser grid, fewer samples, [ask] cases = 'adaptive' or 'boundary' for contact engines, or --large to run it all"
    require(large or (cases <= MOST_CASES and cpu_s / workers <= LONGEST_S), where, wanted, told, advice, key="vary")
    return told
