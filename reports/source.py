"""A result folder as the pages read it: the record, its histories and its mesh; nothing is computed anew."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from harness.errors import InputError, Mistake
from harness.history import History, read_history
from harness.record import SCHEMA_VERSION

RECORD_NAME: Final = "result.json"
KINDS: Final = ("run", "study", "bench", "stress", "validation")


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
        raise InputError(
            Mistake(
                str(path), "schema_version", str(SCHEMA_VERSION), repr(got), "write the result anew with this version"
            )
        )
    if record.get("kind") not in KINDS:
        raise InputError(Mistake(str(path), "kind", f"one of {', '.join(KINDS)}", repr(record.get("kind"))))
    return record


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
