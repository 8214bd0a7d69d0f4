"""The record of a study: models against a reference, what its page shows, taken from the store, and its answer."""

import csv
import math
import sys
from collections import Counter, defaultdict
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice, pairwise
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from harness.comparison.comparator import judge, shares, side_of
from harness.comparison.scores import LEAST_VALUES, excursions_of, lost_j
from harness.comparison.statistics import (
    RESAMPLES,
    Prediction,
    compare_distributions,
    compare_logarithms,
    score_outcomes,
)
from harness.input.tables import ContactTable
from harness.model import (
    NUMBERS,
    RUN_FIELDS,
    Answer,
    Finding,
    History,
    Outcome,
    Scene,
    caution,
    grouped,
    info,
    machine,
    pair,
    translated,
    versions,
    writing,
)
from harness.questions.study import claims
from harness.questions.study.cases import BaseScene, StudyFile, base_of, expand, recheck
from harness.questions.study.claims import WALL_RAD
from harness.questions.study.study_run import COLUMNS, Summary, rows_of, study_name
from harness.records.base import same_fields
from harness.records.run import PLAIN, in_domain, left_early
from harness.records.scene import SceneRecord
from harness.records.scores import Verdict
from harness.records.study import (
    CaseRun,
    Panel,
    StudyRecord,
    StudyRow,
    StudySummary,
    StudyWitness,
    SupportRecord,
    TableRecord,
    ThinnedHistory,
    Value,
    impacts,
)
from harness.records.validation import SetScores
from harness.runs.store import STORE_NAME, PlannedRow, Store

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
        if row.kind != COLUMNS or row.key is None or row.run is None:
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
        if row.kind != COLUMNS or row.run is None:
            return None
        outcomes.update(row.run["outcomes"])  # type: ignore[arg-type]
    counts = dict(sorted(outcomes.items()))
    return TableRecord(STORE_NAME, outcomes.total(), shown, counts, sum(store.engine_seconds(study).values()))


# Outcomes, verdicts and distributions of each model against a reference model, over many cases.

Answered = tuple[CaseRun, str | None]
"""A run, and the key of its history in the store."""

ROCKS_RAD: Final = 1e-4
"""A statue that leans by less is at rest: what a contact engine gives (some 1e-5 rad) is no rocking."""
MANY: Final = 1000
"""From here on a fifth of the bootstrap's resamples do: each costs the sorting of all cases."""


def score_sets(
    rows: Sequence[KeyedRow], reference: str = "analytic", history: Callable[[str], History | None] = lambda key: None
) -> dict[str, SetScores]:
    """Scores of every other model against the reference over the cases that both answered, by model's name.

    `history(key)` gives a run's history where one was kept: verdicts then rest on the histories, otherwise on peaks and
    outcomes alone. The distributions of the peaks are compared from 8 cases on.
    """
    cases: dict[int, dict[str, Answered]] = defaultdict(dict)
    for row in rows:
        if row.run is not None and not row.run.outcome.failed:
            cases[row.number][row.engine] = row.run, row.key
    names = sorted({row.engine for row in rows} - {reference})
    return {name: _score(name, reference, cases.values(), history) for name in names}


def _score(
    name: str, reference: str, cases: Iterable[Mapping[str, Answered]], history: Callable[[str], History | None]
) -> SetScores:
    both = [(case[name], case[reference]) for case in cases if name in case and reference in case]
    judged = [_judged(a, b, history) for a, b in both]
    told = [(a, b) for (a, _), (b, _) in both if in_domain(a) and in_domain(b)]
    peaks = None
    if len(told) >= LEAST_VALUES:
        sides = [[_peak_rad(run) for run in side] for side in zip(*told, strict=True)]
        peaks = compare_distributions(*sides, paired=True, resamples=RESAMPLES if len(told) <= MANY else RESAMPLES // 5)
    rocked = [[_peak_rad(run) for run in pair] for pair in told if all(map(_rocks, pair))]
    log_peaks = compare_logarithms(*zip(*rocked, strict=True)) if len(rocked) >= LEAST_VALUES else None
    return SetScores(
        reference=reference,
        cases=len(told),
        same=sum(a.outcome.same_as(b.outcome) for a, b in told),
        outcomes=score_outcomes([case for case, _ in judged]),
        verdicts=shares([verdict for _, verdict in judged]),
        flips=sum(case.within_uncertainty for case, _ in judged),
        peaks=peaks,
        log_peaks=log_peaks,
    )


def _peak_rad(run: CaseRun) -> float:
    """The largest rotation; none at rest, where what a contact engine gives would come after every zero of the model."""
    peak_rad = abs(run.peak_theta_rad)
    return peak_rad if peak_rad > ROCKS_RAD else 0.0


def _rocks(run: CaseRun) -> bool:
    """Whether the statue rocks and stands: at rest it has no logarithm, falling no largest rotation."""
    return run.outcome is Outcome.STANDS and _peak_rad(run) > 0.0


def _judged(a: Answered, b: Answered, history: Callable[[str], History | None]) -> tuple[Prediction, Verdict]:
    (first, key_a), (second, key_b) = a, b
    history_a, history_b = (None if key is None else history(key) for key in (key_a, key_b))
    sides = side_of(first, first.engine), side_of(second, second.engine)
    both = None
    if history_a is not None and history_b is not None:
        both = pair(history_a, history_b, hold_a=sides[0].rests, hold_b=sides[1].rests)
    verdict, evidence, _ = judge(*sides, both)
    flips = evidence.outcome_flips_within_uncertainty, evidence.side_flips_within_uncertainty
    times = first.no_return_time_s, second.no_return_time_s
    predicted, observed = (run.outcome if in_domain(run) else Outcome.UNDECIDED for run in (first, second))
    return Prediction(predicted, observed, *flips, times), verdict


# What a study says: the claims where it judges any, else how often the statue overturns; how often the models agree.

MOST_FINDINGS: Final = 30
"""Kinds of findings of runs that a study keeps, the most frequent ones."""


def answer_of(record: StudyRecord) -> Answer:
    """The headline, and what was run."""
    pairs = [
        info("same_outcome", model=name, reference=each.reference, same=each.same, cases=each.cases)
        for name, each in (record.scores or {}).items()
        if each.cases
    ]
    code = "claims" if record.headline else "agreement" if pairs else "overturning"
    claimed = grouped((verdict, claim) for claim, verdict in (record.headline or {}).items())
    found = [info("claims", groups=claimed)] if claimed else []
    fell = _falls(record.rows)
    if pairs:  # of models that mostly agree the one that knows most
        fell = [max(fell, key=lambda each: each.values["cases"] - (each.values["open"] or 0))]
    found += [*fell, *pairs]
    done = vars(record.summary)
    return Answer(code, [*found, info("study_done", **done, alike=record.summary.wanted - record.summary.distinct)])


def findings_of(record: StudyRecord) -> list[Finding]:
    """All that is to be known beside the headline."""
    found = [*_left_domain(record.rows), *_of_runs(record.rows)]
    found += [each for name, item in (record.scores or {}).items() for each in item.findings(name)]
    if record.audit is not None:
        values = vars(record.audit)
        found.append(caution("rechecked", **values) if record.audit.differ else info("rechecked", **values))
    if (blocks := record.table) is not None:
        share = sum(n for name, n in blocks.outcomes.items() if Outcome(name).overturned) / max(blocks.rows, 1)
        shown = blocks.shown if blocks.shown < blocks.rows else None
        found.append(info("in_columns", rows=blocks.rows, folder=blocks.folder, share=share, shown=shown))
    if (witness := record.witness) is not None:
        found.append(info("study_witness", scenes=witness.scenes, of=witness.of))
        for name, count in witness.counts.items():
            found.append(info("study_witness_count", witness=name.removesuffix(PLAIN), **vars(count)))
        found += witness.differing
    if record.usage is not None and record.usage.utilisation is not None:
        found.append(info("study_usage", **vars(record.usage)))
    return found


def _falls(rows: Sequence[StudyRow]) -> list[Finding]:
    """In how many cases each model lets the statue overturn or touch the wall, and in how many it does not say."""
    ends = grouped((row.model, row.run.outcome if in_domain(row.run) else None) for row in rows if row.run is not None)
    found = []
    for model, each in ends.items():
        fell = [None if end is None else end.fell for end in each]
        wall = each.count(Outcome.TOUCHES_WALL)
        left = {"wall": wall or None, "open": fell.count(None) - wall or None}
        found.append(info("overturns_in", falls=fell.count(True), cases=len(fell), **left, model=model))
    return found


def _left_domain(rows: Sequence[StudyRow]) -> Iterator[Finding]:
    """In how many runs each model left its own domain, and by what: there its outcome cannot be relied on."""
    for model in dict.fromkeys(row.model for row in rows):
        runs = [row.run for row in rows if row.run is not None and row.model == model]
        # Where a fall was decided before, nothing hangs on it.
        causes = Counter(cause for run in runs if (cause := run.validity.get("left_domain_by")) and left_early(run))
        if causes:
            counts = dict(causes.most_common())
            yield caution("left_domain_in_runs", left=causes.total(), cases=len(runs), causes=counts).of(model)


def _of_runs(rows: Sequence[StudyRow]) -> list[Finding]:
    """Each kind of finding of the runs once, with the number of runs that have it and the median of its numbers; a domain that
    was left is counted by its cause.
    """
    told = [(row.engine, found) for row in rows if row.run is not None for found in row.run.findings]
    kinds = grouped(((engine, found.code), found) for engine, found in told if found.code != "left_domain")
    ordered = sorted(kinds.items(), key=lambda item: -len(item[1]))[:MOST_FINDINGS]
    return [replace(found[0], values=_medians(found), engine=engine) for (engine, _), found in ordered]


def _medians(found: Sequence[Finding]) -> dict[str, Any]:
    """The values of findings of one code: of numbers the median, else the first's; and how many runs they are of."""
    values = dict(found[0].values)
    for key in values:
        # Of some runs a number may not be known.
        known = [number for each in found if isinstance(number := each.values.get(key), float)]
        if known:
            values[key] = float(np.median(known))
    return values | {"in_runs": len(found)}


# A study's rows as a table for other programs.

GROUP: Final = 16_384
"""Rows of a row group."""
FORMULA: Final = ("=", "+", "-", "@", "\t", "\r", "\n", "＝", "＋", "－", "＠")
"""Beginnings of a text that spreadsheets take for a formula, their wide forms of East Asian keyboards among them."""


EXPORTED: Final = sorted(
    {*(each.name for each in RUN_FIELDS if each.single), "impacts"} - {"engine", "wall_s", "cpu_s"}
)
"""Columns of a run, by name; what it took is in no store beside it."""


def export_csv(store: Store, study: str, path: Path, sums: Collection[str] = ()) -> None:
    """Write a study's rows as CSV (one line per case and engine), read twice and never held."""
    names = list(dict.fromkeys(name for row in every_row(store, study) for name in flat(row)))
    with writing(path, sums) as fresh, fresh.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(map(cell, names))
        for line in map(flat, every_row(store, study)):
            writer.writerow([cell(line.get(name)) for name in names])


def cell(value: Any) -> Any:
    """A value for a cell of a spreadsheet: text that it would take for a formula begins with an apostrophe, which it hides.

    Numbers stay numbers (OWASP, CSV injection: = + - @, tab, carriage return and line feed at the start of a text).
    """
    return f"'{value}" if isinstance(value, str) and value.startswith(FORMULA) else value


def export_parquet(store: Store, study: str, path: Path, sums: Collection[str] = ()) -> None:
    """Write a study's rows as Parquet, read twice and never held; needs the extra [parquet]."""
    with translated(ImportError, "--export", "a CSV file, or the extra [parquet]", "no pyarrow here"):
        import pyarrow
        from pyarrow import parquet

    def groups() -> Iterator[list[dict[str, Any]]]:
        lines = map(flat, every_row(store, study))
        while some := list(islice(lines, GROUP)):
            yield some

    schemas = []
    for some in groups():
        names = dict.fromkeys(name for line in some for name in line)
        schemas.append(pyarrow.table({name: [line.get(name) for line in some] for name in names}).schema)
    schema = pyarrow.unify_schemas(schemas, promote_options="permissive")
    with writing(path, sums) as fresh, parquet.ParquetWriter(fresh, schema) as writer:
        for some in groups():
            writer.write_table(pyarrow.Table.from_pylist(some, schema=schema))


def flat(row: PlannedRow) -> dict[str, Any]:
    """One study row as one line of plain values, impacts counted; one that failed has no numbers, as in every table of runs."""
    line = {"number": row.number, "engine": row.engine, "reason": row.reason, **row.varied}
    if row.run is not None:
        nothing = NUMBERS if Outcome(str(row.run["outcome"])).failed else ()
        run = {**row.run, "impacts": impacts(row.run)}
        line |= {name: None if name in nothing else run.get(name) for name in EXPORTED}
    return line


CURVE_POINTS: Final = 400
"""Points of a curve in a small panel: least and largest of each of half as many stretches, so that no peak is lost."""


def study_record(
    study: StudyFile,
    path: Path,
    store: Store,
    summary: Summary,
    seconds: float,
    witness: StudyWitness | None = None,
) -> StudyRecord:
    """Everything that the page of a study holds."""
    base = base_of(study, path)
    scene = base.scene({})
    name = study_name(study)
    rows = study_rows(store, name, coarser(study))
    if study.claims:
        rows = _weighed(rows, store, scene)
    verdicts = claims.judge(rows, top_displacement_m(scene, WALL_RAD), study.claims) if study.claims else None
    made = StudyRecord(
        title=study.title,
        file=path.name,
        scene=SceneRecord.of(scene),
        findings=scene.findings,
        vary={
            item.key: sorted({row.varied[item.key] for row in rows}, key=lambda value: (isinstance(value, str), value))
            for item in study.vary
        },
        supports=supports(study, base, sorted({row.number for row in rows})),
        summary=StudySummary(**same_fields(StudySummary, summary)),
        usage=summary.usage,
        seconds=seconds,
        engine_seconds=store.engine_seconds(name),
        scores=score_sets(rows, history=store.history),
        audit=recheck(study, rows),
        witness=witness,
        versions=versions(),
        machine=machine(),
        claims=verdicts,
        headline=None if verdicts is None else claims.headline(verdicts),
        panels=panels(rows, store) if study.claims == "paper" else None,
        rows=rows,
        table=table(store, name, len(rows)),
    )
    return replace(made, answer=answer_of(made), findings=[*_failures(rows), *findings_of(made), *made.findings])


def _failures(rows: Sequence[KeyedRow]) -> Iterator[Finding]:
    """In how many cases each engine failed, and the most frequent reason."""
    failed = [(row.engine, row.message) for row in rows if row.run is not None and row.run.outcome.failed]
    for engine, reasons in grouped(failed).items():
        yield caution("runs_failed", count=len(reasons), reason=Counter(reasons).most_common(1)[0][0]).of(engine)


def top_displacement_m(scene: Scene, theta_rad: float) -> float:
    """Horizontal displacement of the silhouette's topmost point at a rotation about the wider side's corner."""
    section = scene.statue.section_m
    side = -1 if scene.statue.corner_left_m > scene.statue.corner_right_m else 1
    top = section[np.argmax(section[:, 1])] - [side * scene.statue.corner_m(side), 0.0]
    # Clockwise positive: x' = x cos θ + z sin θ.
    turned = top[0] * np.cos(theta_rad) + side * top[1] * np.sin(theta_rad)
    return float(abs(turned - top[0]))


CONDITION: Final = ("contact.restitution", "motion.x.amplitude_g", "motion.x.frequency_hz")
"""The keys of a condition of the paper's figures."""


def panels(rows: Sequence[KeyedRow], store: Store) -> list[Panel]:
    """Curves in the arrangement of the paper's figures: for each condition, by model, without and with pedestal."""
    by_condition: dict[tuple[float, float, float], dict[str, dict[str, ThinnedHistory]]] = {}
    drawn = {key: _curve(history) for key, history in _histories(rows, store)}
    for row in rows:
        if row.key in drawn:
            restitution, amplitude_g, frequency_hz = (float(row.varied[key]) for key in CONDITION)
            condition = restitution, amplitude_g, frequency_hz
            setting = "floor" if row.varied.get("pedestal") == "none" else "pedestal"
            by_condition.setdefault(condition, {}).setdefault(row.model, {})[setting] = drawn[row.key]
    return [Panel(*condition, by_condition[condition]) for condition in sorted(by_condition)]


def _curve(history: History) -> ThinnedHistory:
    """The first and the last sample, and of each of `CURVE_POINTS`/2 stretches the least and largest rotation and slip."""
    size = history.t_s.size
    curves = history.theta_rad, history.slip_m
    keep = {0, size - 1} if size > CURVE_POINTS else {*range(size)}
    for low, high in pairwise(np.linspace(0, size, CURVE_POINTS // 2 + 1).astype(int)):
        for part in (curve[low:high] for curve in curves if size > CURVE_POINTS):
            keep |= {low + int(part.argmin()), low + int(part.argmax())}
    shown = sorted(keep)
    theta, slip = ([float(f"{value:.5g}") for value in curve[shown]] for curve in curves)
    return ThinnedHistory([round(float(value), 4) for value in history.t_s[shown]], theta, slip)


def _histories(rows: Sequence[KeyedRow], store: Store) -> Iterator[tuple[str | None, History]]:
    """The histories that were kept of the rows, by key, each once."""
    for key in dict.fromkeys(row.key for row in rows if row.key is not None):
        if (history := store.history(key)) is not None:
            yield key, history


def _weighed(rows: Sequence[KeyedRow], store: Store, scene: Scene) -> list[KeyedRow]:
    """The rows, each run with a history told what an impact costs in the mean, and when the last one was."""
    weighed: dict[str | None, dict[str, Any]] = {}
    for key, history in _histories(rows, store):
        told = excursions_of(history)
        losses_j, impacts_s = (
            each[np.isfinite(each)] for each in (lost_j(told, scene.pivot_inertia_kg_m2), told.impact_s)
        )
        weighed[key] = {
            "impact_loss_j": float(losses_j.mean()) if losses_j.size else None,
            "last_impact_s": float(impacts_s[-1]) if impacts_s.size else 0.0,
        }
    return [replace(row, run=row.run and replace(row.run, **weighed.get(row.key, {}))) for row in rows]


def supports(study: StudyFile, base: BaseScene, numbers: Iterable[int]) -> SupportRecord:
    """Of the cases of these numbers: whether they have a pedestal, least and greatest static frictions, keys of the statue."""
    scene, settings = base.scene({}), [case.setting for case in expand(study, base, numbers)]
    keys = {key for setting in settings for key in setting}
    # A pedestal that the scene lacks may be built of keys of its own.
    there = scene.pedestal is not None or any(key.startswith("pedestal.") for key in keys)
    on_pedestal = [setting for setting in settings if there and setting.get("pedestal") != "none"]
    floor = {_friction(setting, "floor_static", scene.contact.floor_static) for setting in on_pedestal}
    statue = {_friction(setting, "statue", scene.contact.statue) for setting in settings}
    return SupportRecord(
        pedestal=sorted({there and setting.get("pedestal") != "none" for setting in settings}),
        floor_static=(min(floor), max(floor)) if floor else None,
        statue=(min(statue), max(statue)),
        statue_keys=sorted(key for key in keys if key.startswith("statue.")),
    )


def _friction(setting: Mapping[str, Value], name: str, own: float) -> float:
    """A case's coefficient; left as the scene has it, or taken away, which leaves the default of a scene file."""
    value = setting.get(f"contact.{name}", "keep")
    if value == "none":
        value = ContactTable.model_fields[name].default
    return own if value == "keep" else float(value)
