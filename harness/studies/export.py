"""A study's rows as a table for other programs."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any, Final

from harness.campaign.store import PlannedRow, Store
from harness.model.errors import InputError, Mistake
from harness.model.run import impacts
from harness.records.result_folder import writing
from harness.records.study import Value

FORMULA: Final = ("=", "+", "-", "@", "\t", "\r", "\n", "＝", "＋", "－", "＠")
"""Beginnings of a text that spreadsheets take for a formula, their wide forms of East Asian keyboards among them."""


def export_csv(store: Store, study: str, path: Path) -> int:
    """Write a study's rows as CSV (one line per case and engine); returns how many."""
    lines = [flat(row) for row in store.rows(study)]
    names = list(dict.fromkeys(name for line in lines for name in line))
    with writing(path) as fresh, fresh.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(map(cell, names))
        writer.writerows([cell(line.get(name)) for name in names] for line in lines)
    return len(lines)


def cell(value: Any) -> Any:
    """A value for a cell of a spreadsheet: text that it would take for a formula begins with an apostrophe, which it hides.

    Numbers stay numbers (OWASP, CSV injection: = + - @, tab, carriage return and line feed at the start of a text).
    """
    return f"'{value}" if isinstance(value, str) and value.startswith(FORMULA) else value


def export_parquet(store: Store, study: str, path: Path) -> int:
    """Write a study's rows as Parquet; needs the extra [parquet]. Returns how many."""
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError as error:
        raise InputError(Mistake("--export", "", "a CSV file, or the extra [parquet]", "no pyarrow here")) from error
    lines = [flat(row) for row in store.rows(study)]
    names = list(dict.fromkeys(name for line in lines for name in line))
    with writing(path) as fresh:
        parquet.write_table(pyarrow.table({name: [line.get(name) for line in lines] for name in names}), fresh)
    return len(lines)


def flat(row: PlannedRow) -> dict[str, Value | None]:
    """One study row as one line of plain values; lists are counted."""
    line: dict[str, Value | None] = {"number": row.number, "engine": row.engine, "reason": row.reason, **row.varied}
    for name, value in (row.run or {}).items():
        if isinstance(value, (int, float, str)) or value is None:
            line[name] = value
        elif name == "impact_times_s":
            line["impacts"] = impacts(row.run or {})
    return line
