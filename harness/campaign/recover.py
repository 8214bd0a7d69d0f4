"""What can still be read of a damaged store, copied into a new one."""

from __future__ import annotations

import shutil
import sqlite3
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from harness.campaign.serialization import history_sum, record_sum
from harness.campaign.store import Store
from harness.model.errors import InputError, Mistake


@dataclass(frozen=True)
class Recovered:
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


def recover(damaged: Path, fresh: Path) -> Recovered:
    """Copy every result of a damaged store that is whole into a new one: its record and its history as they were stored.

    Raises `InputError` when the new file exists or nothing can be read.
    """
    if fresh.exists():
        raise InputError(Mistake(str(fresh), "", "a file that does not exist yet", "an existing one"))
    if not damaged.is_file():
        raise InputError(Mistake(str(damaged), "", "an existing store", "nothing"))
    room = next(path for path in fresh.absolute().parents if path.is_dir())
    with TemporaryDirectory(dir=room, prefix=".salvage-") as folder:
        whole = _copied(damaged, Path(folder))
        rows = {table: list(_readable(whole, table)) for table in ("result", "timing", "history", "plan")}
    readable = len(rows["result"])
    rows["history"] = [row for row in rows["history"] if _is_whole(row, history_sum)]
    with_history = {row[0] for row in rows["history"]}
    rows["result"] = [
        row for row in rows["result"] if _is_whole(row, record_sum) and (not row[3] or row[0] in with_history)
    ]
    if not rows["result"]:
        wanted = "a store of this version of which something can be read"
        raise InputError(Mistake(str(damaged), "", wanted, "nothing readable"))
    with Store(fresh):
        pass
    with closing(sqlite3.connect(fresh)) as db, db:
        for table, readable_rows in rows.items():
            if readable_rows:
                marks = ",".join("?" * len(readable_rows[0]))
                db.executemany(f"INSERT OR IGNORE INTO {table} VALUES ({marks})", readable_rows)
    return Recovered(len(rows["result"]), readable - len(rows["result"]))


def _copied(damaged: Path, folder: Path) -> Path:
    """A copy to read, with what a killed process left beside it; of a file that was cut off the header counts the pages left.

    SQLite refuses every page of a file that is shorter than its header says.
    """
    copy = folder / damaged.name
    shutil.copyfile(damaged, copy)
    beside = damaged.with_name(f"{damaged.name}-wal")
    if beside.is_file():
        shutil.copyfile(beside, copy.with_name(beside.name))
    with copy.open("r+b") as file:
        header = file.read(32)
        size = int.from_bytes(header[16:18], "big") or 1
        size = 65_536 if size == 1 else size
        pages = copy.stat().st_size // size
        if int.from_bytes(header[28:32], "big") > pages:
            file.seek(28)
            file.write(pages.to_bytes(4, "big"))
    return copy


def _is_whole(row: tuple[Any, ...], checksum: Callable[..., int]) -> bool:
    """Whether a row has the checksum that it was stored with; not so one of another version, or of other types."""
    try:
        return bool(checksum(*row[:-1]) == row[-1])
    except (TypeError, ValueError):
        return False


def _readable(path: Path, table: str) -> Iterator[tuple[Any, ...]]:
    """Rows of a table to the first damaged page, then from its last page backwards; by key where rows have no number."""
    seen: set[tuple[Any, ...]] = set()
    for order in ("rowid ASC", "rowid DESC", "1 ASC", "1 DESC"):
        try:
            with closing(sqlite3.connect(path)) as db:
                for row in db.execute(f"SELECT * FROM {table} ORDER BY {order}"):
                    if row[:3] in seen:
                        break
                    seen.add(row[:3])
                    yield row
        except (sqlite3.Error, UnicodeDecodeError):
            continue
