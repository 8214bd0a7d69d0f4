"""A study's rows as a table for other programs."""

from __future__ import annotations

import csv
from collections.abc import Collection, Iterator
from itertools import islice
from pathlib import Path
from typing import Any, Final

from harness.campaign.store import PlannedRow, Store
from harness.model.errors import InputError, Mistake
from harness.model.files import writing
from harness.records.study import Value, impacts
from harness.studies.column_rows import ColumnRows

GROUP: Final = 16_384
"""Rows of a row group."""
FORMULA: Final = ("=", "+", "-", "@", "\t", "\r", "\n", "＝", "＋", "－", "＠")
"""Beginnings of a text that spreadsheets take for a formula, their wide forms of East Asian keyboards among them."""


def export_csv(store: Store | ColumnRows, study: str, path: Path, sums: Collection[str] = ()) -> int:
    """Write a study's rows as CSV (one line per case and engine), read twice and never held; returns how many."""
    names = list(dict.fromkeys(name for row in store.rows(study) for name in flat(row)))
    written = 0
    with writing(path, sums) as fresh, fresh.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(map(cell, names))
        for line in map(flat, store.rows(study)):
            writer.writerow([cell(line.get(name)) for name in names])
            written += 1
    return written


def cell(value: Any) -> Any:
    """A value for a cell of a spreadsheet: text that it would take for a formula begins with an apostrophe, which it hides.

    Numbers stay numbers (OWASP, CSV injection: = + - @, tab, carriage return and line feed at the start of a text).
    """
    return f"'{value}" if isinstance(value, str) and value.startswith(FORMULA) else value


def export_parquet(store: Store | ColumnRows, study: str, path: Path, sums: Collection[str] = ()) -> int:
    """Write a study's rows as Parquet, read twice and never held; needs the extra [parquet]. Returns how many."""
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError as error:
        raise InputError(Mistake("--export", "", "a CSV file, or the extra [parquet]", "no pyarrow here")) from error

    def tables() -> Iterator[pyarrow.Table]:
        lines = map(flat, store.rows(study))
        while some := list(islice(lines, GROUP)):
            names = dict.fromkeys(name for line in some for name in line)
            yield pyarrow.table({name: [line.get(name) for line in some] for name in names})

    schema = pyarrow.unify_schemas([each.schema for each in tables()], promote_options="permissive")
    written = 0
    with writing(path, sums) as fresh, parquet.ParquetWriter(fresh, schema) as writer:
        for each in tables():
            absent = {name: pyarrow.nulls(each.num_rows) for name in schema.names if name not in each.column_names}
            for name, values in absent.items():
                each = each.append_column(name, values)
            writer.write_table(each.select(schema.names).cast(schema))
            written += each.num_rows
    return written


def flat(row: PlannedRow) -> dict[str, Value | None]:
    """One study row as one line of plain values; lists are counted."""
    line: dict[str, Value | None] = {"number": row.number, "engine": row.engine, "reason": row.reason, **row.varied}
    for name, value in (row.run or {}).items():
        if isinstance(value, (int, float, str)) or value is None:
            line[name] = value
        elif name == "impact_times_s":
            line["impacts"] = impacts(row.run or {})
    return line
