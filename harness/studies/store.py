"""One SQLite file that keeps every result once, keyed by the content of scene, engine, settings and version."""

from __future__ import annotations

import json
import sqlite3
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from harness.model.errors import InputError, Mistake
from harness.model.history import COLUMNS, History
from harness.model.run import Run, to_plain
from harness.records.base import part
from harness.records.run import EngineRunRecord
from harness.studies.serialization import pack, unpack

STORE_NAME: Final = "store.sqlite"
STORE_VERSION: Final = 3
BUSY_MS: Final = 60_000
"""Longest wait for another writer: many workers share one file, each holding it for well under a millisecond."""

# Runs stand in the order in which they came: in a tree of keys each row of a kilobyte would take a page of its own.
_SCHEMA: Final = """
CREATE TABLE IF NOT EXISTS run (
    key TEXT PRIMARY KEY, engine TEXT NOT NULL, outcome TEXT NOT NULL, peak_theta_rad REAL, no_return_time_s REAL,
    overturn_time_s REAL, peak_slip_m REAL, uncertainty_rad REAL, reliable_until_s REAL, record TEXT NOT NULL,
    has_history INTEGER NOT NULL, crc32 INTEGER NOT NULL
);
CREATE TABLE IF NOT EXISTS timing (key TEXT PRIMARY KEY, seconds REAL NOT NULL) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS history (
    key TEXT PRIMARY KEY, columns TEXT NOT NULL, samples INTEGER NOT NULL, data BLOB NOT NULL, crc32 INTEGER NOT NULL
);
CREATE TABLE IF NOT EXISTS plan (
    study TEXT NOT NULL, number INTEGER NOT NULL, engine TEXT NOT NULL, key TEXT, reason TEXT NOT NULL, settings TEXT NOT NULL,
    PRIMARY KEY (study, number, engine)
) WITHOUT ROWID;
"""


@dataclass(frozen=True)
class Row:
    """One stored result: its key and its record (a run as plain values)."""

    key: str
    record: Mapping[str, Any]


@dataclass(frozen=True)
class Packed:
    """One result as the store takes it: its row, the seconds that it took, its history as names, samples, bytes and checksum."""

    columns: tuple[Any, ...]
    seconds: float
    history: tuple[str, int, bytes, int] | None


def run_sum(key: str, record: str, has_history: int) -> int:
    """CRC-32 of what counts of a run's row."""
    return zlib.crc32(f"{key}\0{has_history}\0{record}".encode())


def history_sum(key: str, columns: str, samples: int, data: bytes) -> int:
    """CRC-32 of a history's row."""
    return zlib.crc32(data, zlib.crc32(f"{key}\0{columns}\0{samples}\0".encode()))


def packed(key: str, run: Run, histories: bool = False) -> Packed:
    """Pack a finished run: what costs time is done where it ran, and the store only writes."""
    plain = to_plain(EngineRunRecord.of(run))
    # Times differ from run to run: they stand apart, so that two stores of one study are equal row for row.
    seconds = plain.pop("wall_s")
    text = json.dumps(plain, sort_keys=True, allow_nan=False, separators=(",", ":"))
    has_history = int(histories and run.history is not None)
    columns = (
        key,
        run.engine,
        run.outcome.value,
        run.peak_theta_rad,
        run.no_return_time_s,
        run.overturn_time_s,
        run.peak_slip_m,
        run.numerical_uncertainty_rad,
        run.reliable_until_s,
        text,
        has_history,
        run_sum(key, text, has_history),
    )
    history = None
    if histories and run.history is not None:
        table = run.history.columns()
        kept = ",".join(table), run.history.t_s.size, pack(np.stack(list(table.values())))
        history = (*kept, history_sum(key, *kept))
    return Packed(columns, seconds, history)


class Store:
    """A store in one file; every write is one transaction, so a killed process loses nothing that was finished.

    Raises `InputError` when the file cannot be opened, written or is no store; the message says what can still be read.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        with self._told("opened"):
            path.parent.mkdir(parents=True, exist_ok=True)
            self._db = sqlite3.connect(path, isolation_level=None, timeout=BUSY_MS / 1000.0)
        try:
            self._prepare(path)
        except BaseException:
            # Else the files beside a store that is refused would stay.
            self._db.close()
            raise

    def _prepare(self, path: Path) -> None:
        with self._told("read"):
            self._db.execute(f"PRAGMA busy_timeout={BUSY_MS}")
            self._db.execute("PRAGMA journal_mode=WAL")
            # In WAL mode NORMAL survives a killed process; only a power cut may lose the last results, never damage the file.
            self._db.execute("PRAGMA synchronous=NORMAL")
            version = self._db.execute("PRAGMA user_version").fetchone()[0]
            if version not in (0, STORE_VERSION):
                wanted = f"a store of version {STORE_VERSION}"
                raise InputError(Mistake(str(path), "", wanted, f"version {version}", "use another file"))
            self._db.executescript(_SCHEMA)
            self._db.execute(f"PRAGMA user_version={STORE_VERSION}")

    def __enter__(self) -> Store:
        return self

    def __exit__(self, *details: object) -> None:
        self._db.close()

    def known(self, keys: Iterable[str]) -> set[str]:
        """Which of the keys have a result."""
        return self.keys().intersection(keys)

    def keys(self) -> set[str]:
        """All keys that have a result, with its history where one belongs to it: a run whose history is lost counts as none."""
        query = (
            "SELECT key FROM run WHERE NOT has_history OR EXISTS (SELECT 1 FROM history WHERE history.key = run.key)"
        )
        with self._told("read"):
            return {key for (key,) in self._db.execute(query)}

    def put(self, results: Sequence[tuple[str, Run]], histories: bool = False) -> None:
        """Store finished runs, each in a transaction of its own; a key that is there already is kept as it is."""
        for key, run in results:
            self.add([packed(key, run, histories)])

    def add(self, results: Sequence[Packed]) -> None:
        """Store packed results in one transaction; a key that is there already is kept as it is."""
        kept = [(item.columns[0], *item.history) for item in results if item.history is not None]
        with self._told("written"), self._transaction():
            self._db.executemany(
                "INSERT OR IGNORE INTO run VALUES (?,?,?,?,?,?,?,?,?,?,?,?)", [r.columns for r in results]
            )
            seconds = [(item.columns[0], item.seconds) for item in results]
            self._db.executemany("INSERT OR IGNORE INTO timing VALUES (?,?)", seconds)
            self._db.executemany("INSERT OR IGNORE INTO history VALUES (?,?,?,?,?)", kept)

    def get(self, key: str) -> Row | None:
        """The stored result of a key, or None."""
        with self._told("read"):
            found = self._db.execute("SELECT record, has_history, crc32 FROM run WHERE key=?", (key,)).fetchone()
        return None if found is None else Row(key, self._decoded_record(key, *found))

    def _decoded_record(self, key: str, record: str, has_history: int, crc32: int) -> dict[str, Any]:
        """A run's record, as it was stored."""
        with self._decoded():
            if run_sum(key, record, has_history) != crc32:
                raise ValueError(f"the record of {key[:12]} is not as it was stored")
            found = json.loads(record)
            if not isinstance(found, dict):
                raise TypeError(f"the record of {key[:12]} is no table")
            return found

    def seconds(self, key: str) -> float | None:
        """What the run took when it was computed."""
        with self._told("read"):
            found = self._db.execute("SELECT seconds FROM timing WHERE key=?", (key,)).fetchone()
        return None if found is None else float(found[0])

    def history(self, key: str) -> History | None:
        """The stored history of a key, or None."""
        with self._told("read"):
            query = "SELECT columns, samples, data, crc32 FROM history WHERE key=?"
            found = self._db.execute(query, (key,)).fetchone()
        if found is None:
            return None
        with self._decoded():
            if history_sum(key, *found[:3]) != found[3]:
                raise ValueError(f"the history of {key[:12]} is not as it was stored")
            names = found[0].split(",")
            columns = dict(zip(names, unpack(found[2], len(names), found[1]), strict=True))
            extra = {name: values for name, values in columns.items() if name not in COLUMNS}
            return History(**{name: columns[name] for name in COLUMNS}, extra=extra)

    def run(self, key: str) -> Run | None:
        """The run of a key as it was when it was stored, None where there is none or its history was not kept."""
        row, history = self.get(key), self.history(key)
        if row is None or history is None:
            return None
        seconds = self.seconds(key) or 0.0
        return part(EngineRunRecord, {**row.record, "wall_s": seconds}, self.path).run(history)

    def write_plan(self, study: str, rows: Iterable[tuple[int, str, str | None, str, Mapping[str, Any]]]) -> None:
        """Replace the plan of a study: (number, engine, key or None, reason, what varies) in one transaction."""
        plain = (
            (study, n, engine, key, why, json.dumps(to_plain(what), sort_keys=True))
            for n, engine, key, why, what in rows
        )
        with self._told("written"), self._transaction():
            self._db.execute("DELETE FROM plan WHERE study=?", (study,))
            self._db.executemany("INSERT INTO plan VALUES (?,?,?,?,?,?)", plain)

    def rows(self, study: str) -> Iterator[dict[str, Any]]:
        """All planned cases of a study in order: number, engine, reason, what varies, and the record where there is one."""
        with self._told("read"):
            query = (
                "SELECT plan.number, plan.engine, plan.key, plan.reason, plan.settings, "
                "run.record, run.has_history, run.crc32 FROM plan "
                "LEFT JOIN run ON run.key = plan.key WHERE study=? ORDER BY plan.number, plan.engine"
            )
            for number, engine, key, reason, what, record, *sums in self._db.execute(query, (study,)):
                found = None if record is None else self._decoded_record(key, record, *sums)
                with self._decoded():
                    varied = dict(json.loads(what))
                yield {
                    "number": number,
                    "engine": engine,
                    "key": key,
                    "reason": reason,
                    "varied": varied,
                    "run": found,
                }

    def check(self) -> str | None:
        """What SQLite says of the file's integrity: None when whole, else its first finding."""
        with self._told("read"):
            found = self._db.execute("PRAGMA quick_check(1)").fetchone()[0]
        return None if found == "ok" else str(found)

    @contextmanager
    def _transaction(self) -> Iterator[None]:
        self._db.execute("BEGIN IMMEDIATE")
        try:
            yield
        except BaseException:
            # A full disk may already have rolled it back.
            if self._db.in_transaction:
                self._db.execute("ROLLBACK")
            raise
        self._db.execute("COMMIT")

    @contextmanager
    def _decoded(self) -> Iterator[None]:
        """A result whose bytes SQLite gave back but that no longer says anything: a damaged page it did not notice."""
        try:
            yield
        except (zlib.error, ValueError, KeyError, TypeError, AttributeError) as error:  # None where text was, too
            advice = "`rockcheck store salvage FILE NEW` copies what can still be read into a new store"
            raise InputError(
                Mistake(str(self.path), "", "a store whose results can be read", str(error), advice)
            ) from error

    @contextmanager
    def _told(self, done: str) -> Iterator[None]:
        try:
            yield
        except (sqlite3.Error, OSError, UnicodeDecodeError) as error:  # a damaged schema is quoted as it stands
            advice = (
                "free some space (or allow larger files) and run again with --resume: what was finished is kept"
                if "full" in str(error) or getattr(error, "sqlite_errorname", "").startswith("SQLITE_IOERR_WRITE")
                else "`rockcheck store salvage FILE NEW` copies what can still be read into a new store"
            )
            raise InputError(Mistake(str(self.path), "", f"a store that can be {done}", str(error), advice)) from error
