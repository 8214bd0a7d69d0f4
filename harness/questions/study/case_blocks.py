"""Studies of very many cases by the analytic model alone: blocks of neighbouring cases, each run in two compiled sweeps, and
the columns in which their results stand.
"""

from __future__ import annotations

import json
import math
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.block import AnalyticInputError
from analytic.excitation import SampledAcceleration
from analytic.solution import LEFT_BY, OUTCOMES, peak_is_ahead
from analytic.sweep import CertifiedRows, certify_rows
from harness import engines
from harness.accuracy.refinement import DEFAULT_ACCURACY_RAD, first_level
from harness.engines import analytic as twoblock
from harness.engines.base import RELIABLE_RAD, own_settings
from harness.model import NUMBERS, BaseExcitation, Outcome, column_of, to_plain
from harness.questions.study.cases import REFERENCE, BaseScene, CaseScenes, StillScene, StudyFile, Value, expand
from harness.records.base import Plain
from harness.records.study import CaseRun, StudyRow, TableRecord
from harness.runs.store import STORE_NAME, PlannedRow, Store
from harness.runs.task import RunRequest, Task, TaskResult, key_of, run_request

# The rows of a study as its store holds them, one by one or in blocks: typed once, for all that is counted and shown of them.

Chosen = Callable[[NDArray[np.int64]], NDArray[np.bool_]]
MOST_WHOLE: Final = 110_000
"""Rows that a page and its record still hold whole: a map of 330 × 330, a record of 110 MB; beyond it"""
MOST_SHOWN: Final = 20_000
"""they hold a coarser grid of so many."""


@dataclass(frozen=True, kw_only=True, eq=False)
class KeyedRow(StudyRow):
    """A row with the key of its result in the store, and why it failed."""

    key: str | None
    message: str = ""


def every_row(store: Store, study: str, chosen: Chosen | None = None) -> Iterator[PlannedRow]:
    """All rows of a study in order, one block in memory at a time; of a block those that are `chosen` by their numbers (n,)."""
    for row in store.rows(study):
        if row.kind != KIND or row.key is None or row.run is None:
            yield row
            continue
        table = store.table(row.key)
        if chosen is not None:
            kept = chosen(table["number"])
            table = {name: values[kept] for name, values in table.items()}
        for number, varied, run in rows_of(table, row.run):
            yield PlannedRow(number, row.engine, None, row.reason, varied, run)


def study_rows(store: Store, study: str, chosen: Chosen | None = None) -> list[KeyedRow]:
    """All rows of a study; words that many rows share are one string, for there may be a million of them."""
    return [
        KeyedRow(
            number=row.number,
            engine=row.engine,
            reason=sys.intern(row.reason),
            varied={sys.intern(key): value for key, value in row.varied.items()},
            run=None if row.run is None else CaseRun.stored(row.run),
            key=row.key,
            message="" if row.run is None else sys.intern(str(row.run.get("message", ""))),
        )
        for row in every_row(store, study, chosen)
    ]


def coarser(study: StudyFile, most: int | None = None) -> Chosen:
    """Every row of a study that is shown whole, else those of a coarser grid of at most so many, thinned where it is longest."""
    most = most or (study.runs if study.runs <= MOST_WHOLE else MOST_SHOWN)
    sizes = study.sizes
    strides = [1] * len(sizes)
    while math.prod(-(-n // k) for n, k in zip(sizes, strides, strict=True)) * len(study.variant) > most:
        longest = max(range(len(sizes)), key=lambda axis: -(-sizes[axis] // strides[axis]))
        strides[longest] += 1

    def chosen(numbers: NDArray[np.int64]) -> NDArray[np.bool_]:
        places = np.unravel_index(numbers, [*sizes, len(study.variant)])
        on_grid = [place % stride == 0 for place, stride in zip(places, strides, strict=False)]
        return np.asarray(np.logical_and.reduce(on_grid))

    return chosen


def table(store: Store, study: str, shown: int) -> TableRecord | None:
    """What blocks hold, counted over all of them; None of a study whose rows stand one by one."""
    outcomes: Counter[str] = Counter()
    for row in store.rows(study):
        if row.kind != KIND or row.run is None:
            return None
        outcomes.update(row.run["outcomes"])  # type: ignore[arg-type]
    counts = dict(sorted(outcomes.items()))
    return TableRecord(STORE_NAME, outcomes.total(), shown, counts, sum(store.engine_seconds(study).values()))


KIND: Final = "columns"
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
    outcomes = Counter(table["outcome"].tolist())
    record = {"settings": runs.settings, "varied": list(varied), "outcomes": outcomes}
    seconds = time.perf_counter() - begin
    return TaskResult(KIND, to_plain(record), seconds, inside_s=runs.inside_s, failed=runs.failed, table=table)


class SweptRuns:
    """Cases of a base scene, gathered and run together; one that the model refuses is run, and fails, as any single run does."""

    def __init__(self, base: BaseScene, asked_rad: float) -> None:
        self._base, self._asked = base, asked_rad
        levels = engines.load(REFERENCE).refinement_levels(base.scene({}))
        level = first_level(levels, self._asked, 1.0)[0]
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

Columns = dict[str, NDArray[Any]]
RUN: Final = {name: name for name in ("overturn_time_s", "peak_slip_m")}
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
        "findings": column_of([_json(each) for each in findings]),
        "skipped": column_of([_json(twoblock.skipped(each.solution, keep=False)) for each in certified]),
        "record": column_of([None] * len(cases)),
    }


def _json(value: object) -> str:
    return json.dumps(to_plain(value))


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
    }
    columns |= {name: results[source] for name, source in {**RUN, **VALIDITY}.items()}
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
