"""A study's rows as a table for other programs."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from harness.errors import InputError, Mistake
from harness.record import impacts
from harness.result_folder import writing
from harness.studies.store import Store


def export_csv(store: Store, study: str, path: Path) -> int:
    """Write a study's rows as CSV (one line per case and engine); returns how many."""
    lines = [flat(row) for row in store.rows(study)]
    names = list(dict.fromkeys(name for line in lines for name in line))
    with writing(path) as fresh, fresh.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, names)
        writer.writeheader()
        writer.writerows(lines)
    return len(lines)


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


def flat(row: Mapping[str, Any]) -> dict[str, Any]:
    """One study row as one line of plain values; lists are counted."""
    line: dict[str, Any] = {"number": row["number"], "engine": row["engine"], "reason": row["reason"], **row["varied"]}
    for name, value in (row["run"] or {}).items():
        if isinstance(value, (int, float, str)) or value is None:
            line[name] = value
        elif name == "impact_times_s":
            line["impacts"] = impacts(row["run"])
    return line
