"""One SQLite file that keeps every result once, by its key: runs with their histories, and any other answer of a task."""

import errno
import json
import os
import sqlite3
import sys
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, closing, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from harness import engines
from harness.model import (
    COLUMNS,
    NO_ROOM,
    Array,
    History,
    InputError,
    Mistake,
    Run,
    Scene,
    require,
    to_plain,
    translated,
    writing,
)
from harness.records.base import STORE, STORE_KINDS, STORE_NUMBER, Plain, part, store_kind
from harness.records.study import Value
from harness.runs.task import RUN, RunRequest, TaskResult

# Results as a store takes them, and histories as bytes and back, exact to the last bit.

NOISE_BYTES: Final = 5
"""Low bytes of a difference of neighbouring samples: no two are alike, so they are kept as they are (half the
time of writing a run would else go into compressing noise)."""


def pack(table: Array, noise: int = NOISE_BYTES) -> bytes:
    """Columns (k, n) as bytes: differences of the numbers' bits along n, byte by byte; all but `noise` low ones compressed."""
    bits = np.ascontiguousarray(table, dtype="<f8").view("<i8")
    steps = np.diff(bits, axis=1, prepend=np.int64(0))
    planes = np.ascontiguousarray(steps.view(np.uint8).reshape(-1, 8).T)
    packer = zlib.compressobj(1, zlib.DEFLATED, zlib.MAX_WBITS, zlib.DEF_MEM_LEVEL, zlib.Z_RLE)
    return planes[:noise].tobytes() + packer.compress(planes[noise:].tobytes()) + packer.flush()


def unpack(data: bytes, columns: int, samples: int, noise: int = NOISE_BYTES) -> Array:
    """The columns (k, n) that were packed. Raises `ValueError` or `zlib.error` for bytes that are damaged."""
    plain = noise * columns * samples
    planes = np.empty((8, columns * samples), dtype=np.uint8)
    planes[:noise] = np.frombuffer(data[:plain], dtype=np.uint8).reshape(noise, columns * samples)
    planes[noise:] = np.frombuffer(zlib.decompress(data[plain:]), dtype=np.uint8).reshape(8 - noise, -1)
    steps = np.ascontiguousarray(planes.T).view("<i8").reshape(columns, samples)
    table: Array = np.cumsum(steps, axis=1).view("<f8")
    return table


def pack_table(table: Mapping[str, NDArray[Any]]) -> tuple[str, int, bytes]:
    """Columns of one length as names, length and bytes: numbers as `pack` has them, texts as places among the distinct ones."""
    heads, body, texts = [], [], []
    for name, column in table.items():
        values, kind = column, column.dtype.str
        if kind == "|O":
            places: dict[object, int] = {}
            values = np.array([places.setdefault(value, len(places)) for value in column.tolist()])
            texts.append(list(places))
        heads.append([name, kind])
        body.append(values.astype("<f8") if kind == "<f8" else values.astype("<i8").view("<f8"))
    words = zlib.compress(json.dumps(texts).encode(), 1)
    return json.dumps(heads), body[0].size, len(words).to_bytes(8, "big") + words + pack(np.stack(body), 0)


def unpack_table(heads: str, samples: int, data: bytes) -> dict[str, NDArray[Any]]:
    """The columns that were packed."""
    kinds, end = json.loads(heads), 8 + int.from_bytes(data[:8], "big")
    texts = iter(json.loads(zlib.decompress(data[8:end])))
    table: dict[str, NDArray[Any]] = {}
    for (name, kind), column in zip(kinds, unpack(data[end:], len(kinds), samples, 0), strict=True):
        whole = column if kind == "<f8" else column.view("<i8")
        table[name] = np.array(next(texts), dtype=object)[whole] if kind == "|O" else whole.astype(kind, copy=False)
    return table


@dataclass(frozen=True)
class Packed:
    """One result as the store takes it: its row, the seconds that it took, its history or table with its checksum.

    Beside it how many of its runs failed, and of this call the seconds that its worker was at it, those inside the engine among
    them.
    """

    columns: tuple[str, str, str, int, int]
    seconds: float
    history: tuple[str, int, bytes, int] | None
    failed: int = 0
    inside_s: float = 0.0
    busy_s: float = 0.0


def record_sum(key: str, kind: str, record: str, has_history: int) -> int:
    """CRC-32 of a result's row."""
    return zlib.crc32(f"{key}\0{kind}\0{has_history}\0{record}".encode())


def history_sum(key: str, columns: str, samples: int, data: bytes) -> int:
    """CRC-32 of a history's row."""
    return zlib.crc32(data, zlib.crc32(f"{key}\0{columns}\0{samples}\0".encode()))


def packed(key: str, answer: TaskResult) -> Packed:
    """Pack an answer: what costs time is done where it was computed, and the store only writes."""
    # Of a run the order of keys says nothing; of another record it may be that of a table's columns.
    text = json.dumps(answer.record, sort_keys=answer.kind == RUN, allow_nan=False, separators=(",", ":"))
    table = None if answer.history is None else answer.history.columns()
    row = key, answer.kind, text, int(table is not None or answer.table is not None)
    kept = None
    if answer.table is not None:
        kept = pack_table(answer.table)
    elif table is not None:
        kept = ",".join(table), len(table["t_s"]), pack(np.stack(list(table.values())))
    history = None if kept is None else (*kept, history_sum(key, *kept))
    return Packed((*row, record_sum(*row)), answer.seconds, history, answer.failed, answer.inside_s)


STORE_NAME: Final = STORE
STORE_VERSION: Final = 5
BESIDE: Final = {
    "-wal": (b"\x37\x7f\x06\x82", b"\x37\x7f\x06\x83"),
    "-shm": ((3_007_000).to_bytes(4, sys.byteorder),),
    "-journal": (b"\xd9\xd5\x05\xf9",),
}
"""What SQLite keeps beside a store while it is open, and how each file begins (its file format, sections 3 and 4)."""
FULL: Final = ("SQLITE_FULL", "SQLITE_IOERR_WRITE", "SQLITE_IOERR_SHM", "SQLITE_IOERR_TRUNCATE", "SQLITE_IOERR_FSYNC")
"""How the names begin of what SQLite says where there is no room, or a file may not grow."""
MEMORY: Final = ":memory:"
"""The path of a store in no file."""
BUSY_MS: Final = 60_000
"""Longest wait for another writer: many workers share one file, each holding it for well under a millisecond."""

MAKE_ROOM: Final = "free some space (or allow larger files) and give the command again: what was finished is kept"
RECOVER: Final = "move the file away and run the same command again: its results are computed anew"

# Results stand in the order in which they came: in a tree of keys each row of a kilobyte would take a page of its own.
_SCHEMA: Final = """
CREATE TABLE result (
    key TEXT PRIMARY KEY, kind TEXT NOT NULL, record TEXT NOT NULL, has_history INTEGER NOT NULL, crc32 INTEGER NOT NULL
);
CREATE TABLE timing (key TEXT PRIMARY KEY, seconds REAL NOT NULL, clock_s REAL NOT NULL) WITHOUT ROWID;
CREATE TABLE history (
    key TEXT PRIMARY KEY, columns TEXT NOT NULL, samples INTEGER NOT NULL, data BLOB NOT NULL, crc32 INTEGER NOT NULL
);
CREATE TABLE plan (
    study TEXT NOT NULL, number INTEGER NOT NULL, engine TEXT NOT NULL, key TEXT, reason TEXT NOT NULL, settings TEXT NOT NULL,
    PRIMARY KEY (study, number, engine)
) WITHOUT ROWID;
"""


@dataclass(frozen=True)
class PlannedRow:
    """One case of a study by one engine: what varies, and the stored record of its run, where there is one."""

    number: int
    engine: str
    key: str | None
    reason: str
    varied: dict[str, Value]
    run: Plain | None
    kind: str | None = None


def check_begun(folder: Path, what: str) -> None:
    """Raise `InputError` where there is nothing to `--resume`: no store in `folder`."""
    begun = (folder / STORE_NAME).exists()
    require(begun, "--resume", f"{what} that was begun in {folder}", "no store there", "leave --resume out to begin")


def _begin(path: Path, kind: str) -> None:
    """Make a store where there is none, whole or not at all; raises `InputError` for what is no store of this kind.

    What a file is stands in its head, and its head is read before SQLite is: of another program's nothing is touched. Of two
    calls that begin at once the second takes the store of the first.
    """
    fresh_store = not os.path.lexists(path)
    for end, heads in BESIDE.items():
        beside = path.with_name(path.name + end)
        own = not os.path.lexists(beside) or (not fresh_store and beside.is_file() and _begins(beside, heads))
        require(own, str(beside), "nothing that SQLite would write over", "a file", "move it away")
    if fresh_store:
        with writing(path, new=True) as fresh, closing(sqlite3.connect(fresh)) as db:
            db.executescript(_SCHEMA)
            db.execute(f"PRAGMA application_id={STORE_NUMBER + STORE_KINDS.index(kind)}")
            db.execute(f"PRAGMA user_version={STORE_VERSION}")
    found_kind = store_kind(path)
    got = "no store of this version" if found_kind is None else f"that of a {found_kind}"
    require(found_kind == kind, str(path), f"the store of a {kind}", got, "use another folder")


def _begins(path: Path, heads: tuple[bytes, ...]) -> bool:
    """Whether a file is empty, or begins with one of these."""
    with path.open("rb") as stream:
        head = stream.read(len(heads[0]))
    return not head or head in (*heads, bytes(len(heads[0])))


class Store:
    """A store in one file; every write is one transaction, so a killed process loses nothing that was finished.

    `kind` is what its results are of (see `STORE_KINDS`): no other command may take them for its own. Raises `InputError` when
    the file cannot be opened, written or is no store of that kind, `OSError` where there is no room; another program's is not
    opened.
    """

    def __init__(self, path: Path, kind: str = "study") -> None:
        self.path = path
        with self._naming_damage("opened"):
            path.parent.mkdir(parents=True, exist_ok=True)
            if str(path) != MEMORY:
                _begin(path, kind)
            self._db = sqlite3.connect(path, isolation_level=None, timeout=BUSY_MS / 1000.0)
        try:
            with self._naming_damage("read"):
                if str(path) == MEMORY:
                    self._db.executescript(_SCHEMA)
                version = self._db.execute("PRAGMA user_version").fetchone()[0]
                wanted, advice = f"a store of version {STORE_VERSION}", "use another folder"
                require(version in (0, STORE_VERSION), str(path), wanted, f"version {version}", advice)
                self._db.execute("PRAGMA journal_mode=WAL")
                # In WAL mode NORMAL survives a killed process; a power cut may lose the last results, never damage the file.
                self._db.execute("PRAGMA synchronous=NORMAL")
        except BaseException:
            # Else the files beside a store that is refused would stay.
            self._db.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *details: object) -> None:
        self._db.close()

    def keys(self) -> set[str]:
        """All keys that have a result, with its history where one belongs to it: a run whose history is lost counts as none."""
        with self._naming_damage("read"):
            found = self._db.execute(
                "SELECT key FROM result WHERE NOT has_history "
                "OR EXISTS (SELECT 1 FROM history WHERE history.key = result.key)"
            )
            return {key for (key,) in found}

    def add(self, results: Sequence[Packed], clock_s: float = 0.0) -> None:
        """Store packed results in one transaction; a key that is there already is kept as it is.

        `clock_s` is the time by the clock since the results before: that of many workers together.
        """
        histories = [(item.columns[0], *item.history) for item in results if item.history is not None]
        seconds = [(item.columns[0], item.seconds, clock_s / len(results)) for item in results]
        with self._writing():
            self._db.executemany("INSERT OR IGNORE INTO result VALUES (?,?,?,?,?)", [item.columns for item in results])
            self._db.executemany("INSERT OR IGNORE INTO timing VALUES (?,?,?)", seconds)
            self._db.executemany("INSERT OR IGNORE INTO history VALUES (?,?,?,?,?)", histories)

    def remove(self, keys: Iterable[str]) -> None:
        """Remove results, to have them computed anew."""
        gone = [(key,) for key in keys]
        with self._writing():
            for table in ("result", "timing", "history"):
                self._db.executemany(f"DELETE FROM {table} WHERE key=?", gone)

    def get(self, key: str) -> Plain | None:
        """The stored record of a key as plain values, or None."""
        with self._naming_damage("read"):
            row = self._db.execute("SELECT kind, record, has_history, crc32 FROM result WHERE key=?", (key,)).fetchone()
        return None if row is None else self._decoded_record(key, *row)

    def _decoded_record(self, key: str, kind: str, record: str, has_history: int, crc32: int) -> Plain:
        """A record, as it was stored."""
        with self._decoded():
            if record_sum(key, kind, record, has_history) != crc32:
                raise ValueError(f"the record of {key[:12]} is not as it was stored")
            plain = json.loads(record)
            if not isinstance(plain, dict):
                raise TypeError(f"the record of {key[:12]} is no table")
            return plain

    def seconds(self, key: str) -> float | None:
        """What the result took when it was computed."""
        return None if (timing := self.timing(key)) is None else timing[0]

    def timing(self, key: str) -> tuple[float, float] | None:
        """What the result took when it was computed: its own seconds, and its share of the clock's."""
        with self._naming_damage("read"):
            row = self._db.execute("SELECT seconds, clock_s FROM timing WHERE key=?", (key,)).fetchone()
        return None if row is None else (float(row[0]), float(row[1]))

    def history(self, key: str) -> History | None:
        """The stored history of a key, or None."""
        with self._decoded():
            if (kept := self._kept(key)) is None:
                return None
            names = kept[0].split(",")
            columns = dict(zip(names, unpack(kept[2], len(names), kept[1]), strict=True))
            extra = {name: values for name, values in columns.items() if name not in COLUMNS}
            return History(**{name: columns[name] for name in COLUMNS}, extra=extra)

    def table(self, key: str) -> dict[str, NDArray[Any]]:
        """The stored columns of a key, by name."""
        with self._decoded():
            if (kept := self._kept(key)) is None:
                raise ValueError(f"the columns of {key[:12]} are gone")
            return unpack_table(*kept)

    def _kept(self, key: str) -> tuple[str, int, bytes] | None:
        with self._naming_damage("read"):
            row = self._db.execute("SELECT columns, samples, data, crc32 FROM history WHERE key=?", (key,)).fetchone()
        if row is not None and history_sum(key, *row[:3]) != row[3]:
            raise ValueError(f"what belongs to {key[:12]} is not as it was stored")
        return None if row is None else row[:3]

    def run(self, key: str) -> Run | None:
        """The run of a key as it was when it was stored, None where there is none or its history was not kept."""
        record, history = self.get(key), self.history(key)
        if record is None or history is None:
            return None
        return replace(part(Run, {**record, "wall_s": self.seconds(key) or 0.0}, self.path), history=history)

    def write_plan(self, study: str, rows: Iterable[tuple[int, str, str | None, str, Mapping[str, Value]]]) -> None:
        """Replace the plan of a study: (number, engine, key or None, reason, what varies) in one transaction."""
        plain = (
            (study, n, engine, key, why, json.dumps(to_plain(what), sort_keys=True))
            for n, engine, key, why, what in rows
        )
        with self._writing():
            self._db.execute("DELETE FROM plan WHERE study=?", (study,))
            self._db.executemany("INSERT INTO plan VALUES (?,?,?,?,?,?)", plain)

    def rows(self, study: str) -> Iterator[PlannedRow]:
        """All planned cases of a study in order."""
        with self._naming_damage("read"):
            query = (
                "SELECT plan.number, plan.engine, plan.key, plan.reason, plan.settings, "
                "result.kind, result.record, result.has_history, result.crc32 FROM plan "
                "LEFT JOIN result ON result.key = plan.key WHERE study=? ORDER BY plan.number, plan.engine"
            )
            for number, engine, key, reason, what, *result in self._db.execute(query, (study,)):
                run = None if result[0] is None else self._decoded_record(key, *result)
                with self._decoded():
                    varied = dict(json.loads(what))
                yield PlannedRow(number, engine, key, reason, varied, run, result[0])

    def engine_seconds(self, study: str) -> dict[str, float]:
        """What the results of a study took when they were computed, by engine."""
        query = (
            "SELECT engine, TOTAL(seconds) FROM (SELECT DISTINCT engine, key FROM plan WHERE study=? AND key NOT NULL) "
            "LEFT JOIN timing USING (key) GROUP BY engine"
        )
        with self._naming_damage("read"):
            return dict(self._db.execute(query, (study,)))

    @contextmanager
    def _writing(self) -> Iterator[None]:
        """One transaction, undone where it comes to no end."""
        with self._naming_damage("written"), self._db:
            self._db.execute("BEGIN IMMEDIATE")
            yield

    def _decoded(self) -> AbstractContextManager[None]:
        """A result whose bytes SQLite gave back but that no longer says anything: a damaged page it did not notice."""
        kinds = zlib.error, ValueError, KeyError, TypeError, AttributeError  # None where text was, too
        return translated(kinds, str(self.path), "a store whose results can be read", advice=RECOVER)

    @contextmanager
    def _naming_damage(self, done: str) -> Iterator[None]:
        try:
            yield
        except (sqlite3.Error, OSError, UnicodeDecodeError) as error:  # a damaged schema is quoted as it stands
            number = getattr(error, "errno", None)
            if number in NO_ROOM or getattr(error, "sqlite_errorname", "").startswith(FULL):
                # No mistake of the input's.
                said = f"{getattr(error, 'strerror', error)}; {MAKE_ROOM}"
                raise OSError(number or errno.ENOSPC, said, str(self.path)) from error
            raise InputError(Mistake(str(self.path), "", f"a store that can be {done}", str(error), RECOVER)) from error


def stored_runs(store: Store, scene: Scene) -> dict[str, Run]:
    """The runs of a scene that a study has stored with their histories, by engine."""
    keys = {name: RunRequest(lambda: scene, name, history=True).task(scene).key for name in engines.DEFAULT_ENGINES}
    return {name: run for name, key in keys.items() if (run := store.run(key)) is not None}
