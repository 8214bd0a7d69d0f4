"""A result folder as the pages read it: the record, its histories and its mesh; nothing is computed anew."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, Final, TypeVar

from jinja2 import UndefinedError

from harness.input.history_file import read_history
from harness.model.errors import InputError, Mistake
from harness.model.history import History, history_file
from harness.model.run import SCHEMA_VERSION
from harness.records.base import REWRITE, validated
from harness.records.kinds import CLASSES, class_of
from harness.records.result_folder import KINDS, RECORD, as_written, owned

T = TypeVar("T")
RECORD_NAME: Final = RECORD
DAMAGE: Final = (LookupError, TypeError, ValueError, AttributeError, ArithmeticError, StopIteration, UndefinedError)

_TEXT, _TABLE, _LIST, _NUMBER = (str, "a text"), (dict, "a table"), (list, "a list"), ((int, float), "a number")
_EVERY: Final = {
    "title": _TEXT,
    "scene": _TABLE,
    "notes": _LIST,
    "seconds": _NUMBER,
    "versions": _TABLE,
    "machine": _TABLE,
}
PARTS: Final[Mapping[str, Mapping[str, tuple[Any, str]]]] = {
    "study": _EVERY | {"file": _TEXT, "vary": _TABLE, "summary": _TABLE, "engine_seconds": _TABLE, "rows": _LIST},
    "effects3d": _EVERY
    | {
        "file": _TEXT,
        "study": _TABLE,
        "rows": _LIST,
        "static": _LIST,
        "bands": _LIST,
        "departures": _LIST,
        "effects": _LIST,
    }
    | {"left_out": _TABLE, "summary": _TABLE},
}
"""What a record of each kind must hold for its page, and in which form."""


@dataclass(frozen=True, eq=False)
class RunSource:
    """The record of one run with the histories that it names; `mesh` is the statue's mesh file, None without one."""

    folder: Path
    record: Mapping[str, Any]
    histories: Mapping[str, History]
    mesh: Path | None

    @property
    def scene(self) -> Mapping[str, Any]:
        """The resolved scene as plain values."""
        scene: Mapping[str, Any] = self.record["scene"]
        return scene

    @property
    def runs(self) -> Mapping[str, Any]:
        """All engines' answers by name."""
        runs: Mapping[str, Any] = self.record["runs"]
        return runs


def read_record(folder: Path) -> dict[str, Any]:
    """The record of a result folder; raises `InputError` when it is absent, broken or of another schema."""
    return _read(folder)[0]


def read_typed(folder: Path, kind: type[T]) -> T:
    """The record of a result folder as a kind's class; raises `InputError` also where it is of another kind."""
    record, text = _read(folder)
    if record["kind"] not in CLASSES or class_of(record["kind"]) is not kind:
        wanted = next(name for name in CLASSES if class_of(name) is kind)
        raise InputError(Mistake(str(folder / RECORD_NAME), "kind", wanted, repr(record["kind"])))
    return validated(kind, text, folder / RECORD_NAME)


def _read(folder: Path) -> tuple[dict[str, Any], bytes]:
    path = folder / RECORD_NAME
    if not path.is_file():
        advice = "run `rockcheck run SCENE --out DIR` first"
        raise InputError(Mistake(str(folder), "", f"a result folder with {RECORD_NAME}", "none there", advice))
    try:
        text = path.read_bytes()
        record = json.loads(text.decode("utf-8"))
    except (OSError, UnicodeDecodeError, json.JSONDecodeError, RecursionError) as error:
        raise InputError(Mistake(str(path), "", "a readable JSON record", str(error))) from error
    if not isinstance(record, dict) or record.get("schema_version") != SCHEMA_VERSION:
        got = record.get("schema_version") if isinstance(record, dict) else type(record).__name__
        raise InputError(Mistake(str(path), "schema_version", str(SCHEMA_VERSION), repr(got), REWRITE))
    if record.get("kind") not in KINDS:
        raise InputError(Mistake(str(path), "kind", f"one of {', '.join(KINDS)}", repr(record.get("kind"))))
    if record["kind"] not in CLASSES:
        _check_parts(path, record)
    return record, text


def _check_parts(path: Path, record: dict[str, Any]) -> None:
    """Raise `InputError` naming every part that a page needs and the record lacks or holds in another form."""
    mistakes = [
        Mistake(str(path), key, words, "nothing" if key not in record else type(record[key]).__name__, REWRITE)
        for key, (form, words) in PARTS.get(record["kind"], {}).items()
        if not isinstance(record.get(key), form)
    ]
    if mistakes:
        raise InputError(mistakes)


@contextmanager
def telling_damage(folder: Path, page: str = "") -> Iterator[None]:
    """Turn what a page or picture meets where a part deep inside a record is absent or of another form into an `InputError`."""
    try:
        yield
    except InputError:
        raise
    except DAMAGE as error:
        told = f"{type(error).__name__}: {error}"
        advice = f"{REWRITE}; if it comes again, it is a fault of rockcheck: please report it"
        wanted = f"a whole record for {page}" if page else "a whole record"
        raise InputError(Mistake(str(folder / RECORD_NAME), "", wanted, told, advice)) from error


def run_source(folder: Path) -> RunSource:
    """The record of a run and its histories; raises `InputError` for a broken folder."""
    record = read_record(folder)
    if record["kind"] != "run":
        raise InputError(Mistake(str(folder / RECORD_NAME), "kind", "run", repr(record["kind"])))
    # Records of older versions do not say which histories they kept: what lies there is all.
    kept = record.get("histories")
    names = record["runs"] if kept is None else kept
    paths = {name: folder / history_file(name) for name in names}
    lost = [path for path in paths.values() if kept is not None and not path.is_file()]
    mesh = folder / "statue.glb"
    if record["scene"].get("statue", {}).get("mesh") is not None and not mesh.is_file():
        lost.append(mesh)
    if lost:
        raise InputError(
            [Mistake(str(path), "", "the file that result.json names", "none there", REWRITE) for path in lost]
        )
    sums = owned(folder)
    changed = [path for path in (*paths.values(), mesh) if path.is_file() and not as_written(path, sums)]
    if changed:
        wanted = "the file that result.json lists"
        raise InputError([Mistake(str(path), "", wanted, "another content", REWRITE) for path in changed])
    histories = {name: _history(path, path.stat().st_mtime_ns) for name, path in paths.items() if path.is_file()}
    return RunSource(folder, record, histories, mesh if mesh.is_file() else None)


@lru_cache(maxsize=8)
def _history(path: Path, _changed_ns: int) -> History:
    """A history, read once for both pages of a run; its arrays are the callers' to read only."""
    return read_history(path)
