"""The page of a measured set that is told by tables."""

from __future__ import annotations

import shlex
from pathlib import Path

from harness.records.measured import Cell, MeasuredRecord, MeasuredTable
from reports.messages import ENGLISH
from reports.text.wording import Verdict


def context(folder: Path, record: MeasuredRecord) -> dict[str, object]:
    """Everything that the template shows."""
    said = [] if record.answer is None else [each.text for each in record.answer.findings]
    tone = "differ" if record.answer is not None and record.answer.code == "drops_not_told" else "agree"
    return {
        "verdict": Verdict(
            said[0] if said else record.title, tone, [*said[1:], *(each.text for each in record.findings)]
        ),
        "tables": [(caption(table), heads(table)[1:], keyed(table)) for table in record.tables],
        "command": command(record),
    }


def caption(table: MeasuredTable) -> str:
    """What the rows of a table are."""
    return ENGLISH.strings[f"measured.{table.name}"]


def heads(table: MeasuredTable) -> list[str]:
    """The columns' names in words, their units last."""
    return [ENGLISH.word(name).replace("_", " ") for name in table.columns]


def keyed(table: MeasuredTable) -> list[tuple[str, list[str]]]:
    """Each row's first cell and the others, numbers to three digits."""
    return [(cell(first), [cell(each) for each in rest]) for first, *rest in table.rows]


def cell(value: Cell) -> str:
    """A number to three digits, a name as a word."""
    if value is None or isinstance(value, str):
        return "–" if value is None else ENGLISH.word(value)
    return ENGLISH.short(value, 3)


def command(record: MeasuredRecord) -> str:
    """The command that repeats it."""
    parts = [f"rockcheck validate {shlex.quote(record.source)}"]
    if record.body is not None:
        models = [row[0] for row in record.tables[0].rows if row[-1] is not None]
        parts += [
            f"--body {shlex.quote(record.body)}",
            *(f"-e {name}" for name in models),
            f"--samples {record.samples}",
        ]
    return " ".join([*parts, f"--seed {record.seed}"] if record.seed else parts)
