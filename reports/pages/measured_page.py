"""The page of a measured set that is told by tables."""

from pathlib import Path

from harness.records.validation import MeasuredRecord, MeasuredTable
from reports.blocks import Block, Table, command_line, repeat, section, verdict
from reports.messages import Language


def blocks(_folder: Path, record: MeasuredRecord, say: Language) -> list[Block]:
    """The blocks of the page."""
    return [
        verdict(record, more=[each.text for each in record.findings]),
        *section(say, "tables", *(measured_table(each, say) for each in record.tables)),
        *repeat(say, record, command(record)),
    ]


def measured_table(table: MeasuredTable, say: Language) -> Table:
    """A table with its columns' names in words and its numbers to three digits."""
    rows = [[say.plain(value, 3) for value in row] for row in table.rows]
    # Cells of words stand as those of claims do, from the left.
    style = "claims" if all(isinstance(value, str) for row in table.rows for value in row) else ""
    return Table(say(f"measured.{table.name}"), [*map(say.label, table.columns)], rows, style)


def command(record: MeasuredRecord) -> str:
    """The command that repeats it."""
    if record.about == "checked":
        return "python -m tests.measures.checked"
    rows = record.tables[0].rows if record.body else ()
    models = dict.fromkeys(str(row[0]) for row in rows if row[-1] is not None and "published" not in row)
    samples = record.samples if record.body else None
    return command_line("validate", record.source, body=record.body, e=[*models], samples=samples, seed=record.seed)
