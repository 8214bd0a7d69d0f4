"""What a command prints: at most 16 lines of at most 100 columns; the rest stands in the record and on the pages."""

from __future__ import annotations

import math
import textwrap
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

from harness.input.mesh_statue import findings_of, steps_of
from harness.model import Finding, Run, Severity, grouped, number, printable, texted, weighed
from harness.records.base import Record
from harness.records.run import STILL_RAD, RunRecord, outside_domain, peak_lean_rad, peak_slip_m, standing
from harness.records.scene import SceneRecord
from harness.records.scores import Interval, Scores, Verdict
from harness.statics.standstill import STILL_M
from reports.blocks import Table, owned
from reports.messages import ENGLISH

if TYPE_CHECKING:
    from harness.input.motions.inspect import MotionInspection
    from harness.records.assess import AssessRecord
    from harness.records.study import StudyRecord
    from harness.records.trust import TrustRecord
    from harness.records.validation import BaselineRecord, MeasuredRecord, ModelRecord, ValidationRecord
    from meshes.prepare import Inspection as Scan

LINES: Final = 16
COLUMNS: Final = 100
ANSWER_LINES: Final = 5
LONG_ANSWER_LINES: Final = 7
SHORT_ANSWER_LINES: Final = 3
"""Beside a table that leaves no more."""
PAIR_LINES: Final = 3
MODEL_LINES: Final = 6
"""Lines of a study's table of models, its heading among them."""
TOLD_COLUMNS: Final = 7
"""Of a measured set's table: more are on the page."""
LAST_LINES: Final = 2
"""How many findings there are beside those shown, and where the pages are."""
MARK: Final = {Severity.CHANGES_ANSWER: "!!", Severity.CAUTION: "! ", Severity.INFO: "  "}


def record_lines(record: Record, *, verbose: bool = False) -> list[str]:
    """What is printed of a record: title, answer, the rows of its kind, what to beware of; `verbose`: every finding."""
    if isinstance(record, RunRecord):
        pairs = list(record.scores.values())
        heading = ["engine", "outcome", "peak lean", "slip", "numerical error", "CPU time"]
        engines = table([heading, *([name, *_engine_cells(run, record.scene)] for name, run in record.runs.items())])
        lines = [_cut(record.title), *_answer(record, ANSWER_LINES), *engines]
        lines += _pair_rows(pairs, len(pairs) if verbose else min(PAIR_LINES, LINES - LAST_LINES - len(lines)))
        # Each pair's verdict has a row of its own.
        told = [each.findings[0] for each in pairs if each.findings]
    else:
        rows = ROWS[record.kind](record, verbose) if record.kind in ROWS else []
        room = max(LINES - LAST_LINES - 1 - len(rows), SHORT_ANSWER_LINES)
        lines = [_cut(record.title), *_answer(record, min(room, LONG_ANSWER_LINES)), *rows]
        told = []
    if verbose:
        return [*lines, *finding_lines(record.findings)]
    said = [each for each in record.findings if each.severity is not Severity.INFO and each not in told]
    return [*lines, *beware_lines(said, len(record.findings), LINES - len(lines) - 1)]


def _assess_rows(record: AssessRecord, _verbose: bool) -> list[str]:
    """A row for each model."""
    from reports.pages.assess_page import models_table

    return _block(models_table(record, ENGLISH))


def _block(shown: Table | None) -> list[str]:
    """The first columns of a page's table."""
    rows = [] if shown is None else [shown.heads, *shown.rows]
    return table([[str(cell) for cell in row[:TOLD_COLUMNS]] for row in rows])


def _study_rows(record: StudyRecord, verbose: bool) -> list[str]:
    """How many runs of each model ended how."""
    from reports.source import told_family

    runs = grouped((row.model, told_family(row.run)) for row in record.rows if row.run is not None)
    ends = {model: Counter(families) for model, families in runs.items()}
    kinds = list(dict.fromkeys(kind for count in ends.values() for kind in count))
    cells = [[model, str(count.total()), *(str(count[kind]) for kind in kinds)] for model, count in ends.items()]
    heading = ["model", "runs", *(ENGLISH.strings[f"ends.{kind}"] for kind in kinds)]
    return _first([heading], cells, None if verbose else MODEL_LINES - 1, "model models")


def _validation_rows(record: ValidationRecord, verbose: bool) -> list[str]:
    """How often each model and the bare threshold are right, and the same by body."""
    scored: dict[str, ModelRecord | BaselineRecord] = {**record.models, "PGV threshold": record.baseline}
    drawn = {name: item.by_probability for name, item in record.models.items()}
    cells = [
        [
            name, rate(item.outcomes.accuracy), rate(None if (by := drawn.get(name)) is None else by.accuracy),
            ENGLISH.digits(item.probability.brier),
            ENGLISH.digits(None if (area := item.probability.area) is None else area.value),
        ]
        for name, item in scored.items()
    ]  # fmt: skip
    if record.repeats is not None:
        best = f"{ENGLISH.percent(record.repeats.best_accuracy)} at most"
        cells.append(["best by repeats", best, best, ENGLISH.digits(record.repeats.best_brier), "–"])
    heading = ["model", "right", "right by P ≥ 1/2", "Brier score", "area under the curve"]
    shown = cells if verbose or len(cells) <= MODEL_LINES else [*cells[: MODEL_LINES - 1], cells[-1]]
    room = LINES - LAST_LINES - SHORT_ANSWER_LINES - len(shown) - 4
    return [*table([heading, *shown]), *_body_rows(record, None if verbose else max(room, 0))]


def _body_rows(record: ValidationRecord, most: int | None) -> list[str]:
    """How many tests of each body every model has right, of `most` bodies: by P ≥ ½ where there are draws."""
    by_body = grouped((each.body, each) for item in record.models.values() for each in item.by_body)
    rows = [
        [body, str(by_model[0].tests), str(by_model[0].fell)]
        + [
            ENGLISH.percent(known.value) if (known := each.by_probability or each.accuracy) else "–"
            for each in by_model
        ]
        for body, by_model in by_body.items()
    ]
    return _first([["body", "tests", "fell", *record.models]], rows, most, "body bodies") if len(rows) > 1 else []


def rate(item: Interval | None) -> str:
    """A share with its interval, in per cent."""
    return ENGLISH.value(item and [item.value, item.low, item.high], "rate")


def _trust_rows(record: TrustRecord, _verbose: bool) -> list[str]:
    """The share of each class."""
    kinds = [kind for kind in record.maps[0].shares if any(each.shares[kind] for each in record.maps)]
    rows = [[ENGLISH.word(kind), *(ENGLISH.percent(each.shares[kind]) for each in record.maps)] for kind in kinds]
    return table([["class", *(f"on the {each.stands_on}" for each in record.maps)], *rows])


def _measured_rows(record: MeasuredRecord, _verbose: bool) -> list[str]:
    """The first columns of its first table."""
    from reports.pages.validation_page import measured_table

    return _block(measured_table(record.tables[0], ENGLISH))


ROWS: Final[Mapping[str, Callable[[Any, bool], list[str]]]] = {
    "assess": _assess_rows,
    "study": _study_rows,
    "validation": _validation_rows,
    "trust": _trust_rows,
    "measured": _measured_rows,
}
"""What stands between the answer and the findings, by the kind of record."""


def _answer(record: Record, most: int) -> list[str]:
    return [] if record.answer is None else wrapped(record.answer.text, most)


def wrapped(text: str, most: int, indent: str = "") -> list[str]:
    """A text in at most so many lines."""
    return textwrap.wrap(
        printable(text).replace("\u00a0", " "), COLUMNS, max_lines=most, placeholder=" …",
        subsequent_indent=indent,
    )  # fmt: skip


def _cut(text: str) -> str:
    text = printable(text)
    return text if len(text) <= COLUMNS else f"{text[: COLUMNS - 1]}…"


def table(rows: Sequence[Sequence[str]]) -> list[str]:
    """Rows of cells as aligned lines, the first row their heading; nearer to each other where a line would be cut."""
    plain = [[cell.replace("\u00a0", " ") for cell in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(*plain, strict=True)]
    gap = "  " if sum(widths) + 2 * len(widths) <= COLUMNS else " "
    lines = [gap.join(f"{cell:{width}}" for cell, width in zip(row, widths, strict=True)) for row in plain]
    return [_cut(f"  {line}".rstrip()) for line in lines]


def _first(heading: Sequence[Sequence[str]], rows: Sequence[Sequence[str]], most: int | None, what: str) -> list[str]:
    """The first rows under their heading, and how many more there are of `what`, one and several; None: all of them."""
    shown = rows[:most]
    lines = table([*heading, *shown]) if shown else []
    further = len(rows) - len(shown)
    return [*lines, f"  {further} further {what.split()[further > 1]} (--verbose)"] if further else lines


def _engine_cells(run: Run, scene: SceneRecord) -> list[str]:
    """Of a statue on the floor the slip is its own, which the analytic model does not have."""
    outcome = ENGLISH.strings[f"short.{run.outcome.value}"]
    if run.outcome.failed:
        return [outcome, "–", "–", "–", ENGLISH.unit(run.cpu_s, "s", 2)]
    if run.no_return_time_s is not None:
        outcome += f" at {ENGLISH.digits(run.no_return_time_s, 3)} s"
    if outside_domain(run):
        outcome = f"({outcome})"
    lean_rad = peak_lean_rad(run)
    peak = f"{ENGLISH.digits(math.degrees(lean_rad), 3)}° {ENGLISH.digits(lean_rad, 3)} rad"
    if run.outcome.overturned:
        peak = "–"
    elif lean_rad < STILL_RAD:
        peak = "0°"
    elif number(run.validity, "left_domain_s", math.inf) < run.peaks_until_s:
        peak = f"({peak})"
    known = "–"
    if run.numerical_uncertainty_rad is not None and run.reliable_until_s is not None:
        until = min(run.reliable_until_s, run.end_s)
        known = f"{run.numerical_uncertainty_rad:.0e} rad to {ENGLISH.digits(until, 3)} s"
    slip_m = standing(run, "statue_slip_m") if scene.pedestal is None else peak_slip_m(run)
    slip = "–" if slip_m is None else ENGLISH.length(slip_m if slip_m > STILL_M else 0.0)
    if outside_domain(run) and slip_m is not None:
        slip = f"({slip})"
    return [outcome, peak, slip, known, ENGLISH.unit(run.cpu_s, "s", 2)]


def _pair_rows(pairs: Sequence[Scores], most: int) -> list[str]:
    """One line a pair, those that differ first, in at most so many lines."""
    order = sorted(pairs, key=lambda each: each.verdict is Verdict.AGREE)
    rows = [
        [f"{each.a} – {each.b}", ENGLISH.strings[f"pair.{each.verdict.name.lower()}"], _when(each)] for each in order
    ]
    return _first([], rows, most if len(rows) <= most else most - 1, "pair pairs")


def _when(scores: Scores) -> str:
    seen = scores.evidence
    if scores.verdict is Verdict.AGREE:
        return f"within {seen.limit_rad:.0e} rad"
    apart = seen.left_domain_s if scores.verdict is Verdict.DOMAIN and seen.exceeded_s is None else seen.exceeded_s
    since = "until" if scores.verdict in (Verdict.HORIZON, Verdict.UNBOUNDED) else "from"
    times = [time for time in (apart, None if seen.aside else seen.horizon_s) if time is not None]
    return f"{since} {ENGLISH.digits(min(times), 3)} s" if times else ""


def beware_lines(findings: Sequence[Finding], total: int, room: int) -> list[str]:
    """As many of the heaviest findings as there is room for, and how many of the `total` are not shown."""
    lines: list[str] = []
    shown = 0
    for each in findings:
        said = wrapped(f"{MARK[each.severity]} {owned(each)}", 2, "   ")
        if len(lines) + len(said) > room - 1:
            break
        lines += said
        shown += 1
    more = total - shown
    return [*lines, f"  {more} further finding{'s' if more > 1 else ''} (--verbose)"] if more > 0 else lines


def finding_lines(findings: Iterable[Finding]) -> list[str]:
    """Every finding, the heaviest first."""
    return [line for each in findings for line in wrapped(f"{MARK[each.severity]} {owned(each)}", LINES, "   ")]


def motion_lines(found: MotionInspection, findings: Sequence[Finding], *, verbose: bool = False) -> list[str]:
    """A motion: where it came from, its measures, what to beware of (`findings` with their sentences)."""
    source = printable("; ".join(f"{key}: {said}" for key, said in found.source.items() if said))
    head, *measured = found.table()
    named = [["", *head], *([*ENGLISH.named(key), *values] for key, *values in measured)]
    rows = table([[printable(cell) for cell in row] for row in named])
    return [source if verbose else _cut(source), *rows, *found_lines(findings, len(rows) + 2, verbose=verbose)]


def found_lines(findings: Sequence[Finding], beside: int, *, verbose: bool = False) -> list[str]:
    """Findings with their sentences under `beside` other lines: the heaviest, all of them where `verbose`."""
    ordered = weighed(findings)
    return finding_lines(ordered) if verbose else beware_lines(ordered, len(ordered), LINES - beside)


def scan_lines(found: Scan, beside: int, *, verbose: bool = False) -> list[str]:
    """A scan: what it is, what was changed in it, what to beware of, above `beside` further lines."""
    log, facts = found.prepared.log, [printable(fact) for fact in found.facts()]
    findings = texted(findings_of(log.found), ENGLISH.say)
    if verbose:
        return [*facts, *found.rose_lines(), *map(printable, steps_of(log, ENGLISH.say)), *finding_lines(findings)]
    lines = [line for fact in facts for line in wrapped(fact, 2, "  ")]
    steps = ENGLISH.listed(dict.fromkeys(change.step for change in log.changes)) or "nothing"
    lines += wrapped(f"changed: {steps}", 1)
    return [*lines, *found_lines(findings, len(lines) + beside)]
