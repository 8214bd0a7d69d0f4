"""What can still be read of a damaged store, copied into a new one."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from harness.model.errors import InputError, Mistake
from harness.studies.store import Store, history_sum, run_sum


@dataclass(frozen=True)
class Salvaged:
    """How many results are whole in the new store, and how many were left out: changed, or without their histories."""

    results: int
    left_out: int

    def __str__(self) -> str:
        if not self.left_out:
            return f"{self.results} results are whole"
        return (
            f"{self.results} results are whole; {self.left_out} were left out, changed or without their histories: "
            "`rockcheck study … --resume` computes these again, and what could not be read at all"
        )


def salvage(damaged: Path, fresh: Path) -> Salvaged:
    """Copy every result of a damaged store that is whole into a new one: its record and its history as they were stored.

    Raises `InputError` when the new file exists or nothing can be read.
    """
    if fresh.exists():
        raise InputError(Mistake(str(fresh), "", "a file that does not exist yet", "an existing one"))
    if not damaged.is_file():
        raise InputError(Mistake(str(damaged), "", "an existing store", "nothing"))
    rows = {table: list(_readable(damaged, table)) for table in ("run", "timing", "history", "plan")}
    readable = len(rows["run"])
    rows["history"] = [row for row in rows["history"] if _is_whole(row, history_sum, row[:-1])]
    kept = {row[0] for row in rows["history"]}
    rows["run"] = [row for row in rows["run"] if _is_whole(row, run_sum, (row[0], *row[-3:-1]))]
    rows["run"] = [row for row in rows["run"] if not row[-2] or row[0] in kept]
    if not rows["run"]:
        wanted = "a store of this version of which something can be read"
        raise InputError(Mistake(str(damaged), "", wanted, "nothing readable"))
    with Store(fresh):
        pass
    with closing(sqlite3.connect(fresh)) as db, db:
        for table, found in rows.items():
            if found:
                marks = ",".join("?" * len(found[0]))
                db.executemany(f"INSERT OR IGNORE INTO {table} VALUES ({marks})", found)
    return Salvaged(len(rows["run"]), readable - len(rows["run"]))


def _is_whole(row: tuple[Any, ...], checksum: Callable[..., int], stored: tuple[Any, ...]) -> bool:
    """Whether a row has the checksum that it was stored with; not so one of another version, or of other types."""
    try:
        return bool(checksum(*stored) == row[-1])
    except (TypeError, ValueError):
        return False


def _readable(path: Path, table: str) -> Iterator[tuple[Any, ...]]:
    """Rows of a table to the first damaged page, then from its last page backwards; by key where rows have no number."""
    seen: set[tuple[Any, ...]] = set()
    for order in ("rowid ASC", "rowid DESC", "1 ASC", "1 DESC"):
        try:
            with closing(sqlite3.connect(f"{path.resolve().as_uri()}?mode=ro&immutable=1", uri=True)) as db:
                for row in db.execute(f"SELECT * FROM {table} ORDER BY {order}"):
                    if row[:3] in seen:
                        break
                    seen.add(row[:3])
                    yield row
        except (sqlite3.Error, UnicodeDecodeError):
            continue
