"""What can still be read of a damaged store, copied into a new one."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

from harness.errors import InputError, Mistake
from harness.studies.store import Store


def salvage(damaged: Path, fresh: Path) -> int:
    """Copy every result of a damaged store that can still be read into a new one; returns how many.

    Raises `InputError` when the new file exists or nothing can be read.
    """
    if fresh.exists():
        raise InputError(Mistake(str(fresh), "", "a file that does not exist yet", "an existing one"))
    if not damaged.is_file():
        raise InputError(Mistake(str(damaged), "", "an existing store", "nothing"))
    rows = {table: list(_readable(damaged, table)) for table in ("run", "timing", "history", "plan")}
    if not rows["run"]:
        raise InputError(Mistake(str(damaged), "", "a store of which something can be read", "nothing readable"))
    with Store(fresh):
        pass
    with closing(sqlite3.connect(fresh)) as db, db:
        for table, found in rows.items():
            if found:
                width = len(db.execute(f"SELECT * FROM {table} LIMIT 0").description)
                # A store of an earlier version kept histories otherwise: its outcomes are still worth having.
                if len(found[0]) == width:
                    marks = ",".join("?" * width)
                    db.executemany(f"INSERT OR IGNORE INTO {table} VALUES ({marks})", found)
    return len(rows["run"])


def _readable(path: Path, table: str) -> Iterator[tuple[Any, ...]]:
    """Rows of a table to the first damaged page, then from its last page backwards; by key where rows have no number."""
    seen: set[tuple[Any, ...]] = set()
    for order in ("rowid ASC", "rowid DESC", "1 ASC", "1 DESC"):
        try:
            with closing(sqlite3.connect(f"file:{path}?mode=ro&immutable=1", uri=True)) as db:
                for row in db.execute(f"SELECT * FROM {table} ORDER BY {order}"):
                    if row[:3] in seen:
                        break
                    seen.add(row[:3])
                    yield row
        except sqlite3.Error:
            continue
