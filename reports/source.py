"""A result folder as the pages read it: the record, its histories and its mesh; nothing is computed anew."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from harness.errors import InputError, Mistake
from harness.history import History
from harness.history_file import read_history
from harness.record import SCHEMA_VERSION

RECORD_NAME: Final = "result.json"
KINDS: Final = ("run", "study", "effects3d", "bench", "stress", "validation")
REWRITE: Final = "write the result anew with this version"

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
    "run": _EVERY | {"motion": _TABLE, "runs": _TABLE, "scores": _TABLE, "plan": _LIST, "warnings": _LIST},
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
    path = folder / RECORD_NAME
    if not path.is_file():
        advice = "run `rockcheck run SCENE --out DIR` first"
        raise InputError(Mistake(str(folder), "", f"a result folder with {RECORD_NAME}", "none there", advice))
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, json.JSONDecodeError) as error:
        raise InputError(Mistake(str(path), "", "a readable JSON record", str(error))) from error
    if not isinstance(record, dict) or record.get("schema_version") != SCHEMA_VERSION:
        got = record.get("schema_version") if isinstance(record, dict) else type(record).__name__
        raise InputError(Mistake(str(path), "schema_version", str(SCHEMA_VERSION), repr(got), REWRITE))
    if record.get("kind") not in KINDS:
        raise InputError(Mistake(str(path), "kind", f"one of {', '.join(KINDS)}", repr(record.get("kind"))))
    _check_parts(path, record)
    return record


def _check_parts(path: Path, record: dict[str, Any]) -> None:
    """Raise `InputError` naming every part that a page needs and the record lacks or holds in another form."""
    mistakes = [
        Mistake(str(path), key, words, "nothing" if key not in record else type(record[key]).__name__, REWRITE)
        for key, (form, words) in PARTS.get(record["kind"], {}).items()
        if not isinstance(record.get(key), form)
    ]
    if mistakes:
        raise InputError(mistakes)


def run_source(folder: Path) -> RunSource:
    """The record of a run and its histories; raises `InputError` for a broken folder."""
    record = read_record(folder)
    if record["kind"] != "run":
        raise InputError(Mistake(str(folder / RECORD_NAME), "kind", "run", repr(record["kind"])))
    histories = {}
    for name in record["runs"]:
        path = folder / f"history_{name}.csv"
        if path.is_file():
            histories[name] = read_history(path)
    mesh = folder / "statue.glb"
    return RunSource(folder, record, histories, mesh if mesh.is_file() else None)
