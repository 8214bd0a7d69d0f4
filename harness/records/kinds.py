"""Which class is the record of each kind."""

from __future__ import annotations

import json
from importlib import import_module
from pathlib import Path

from harness.model.errors import InputError, Mistake
from harness.model.run import SCHEMA_VERSION
from harness.records.base import REWRITE, Record, validated
from harness.records.result_folder import KINDS, RECORD


def class_of(kind: str) -> type[Record]:
    """The class of a kind's record."""
    module = import_module(KINDS[kind])
    return next(
        each for each in vars(module).values() if isinstance(each, type) and getattr(each, "kind", None) == kind
    )


def read_result(folder: Path | str) -> Record:
    """The record of a result folder. Raises `InputError` when it is absent, damaged, or of another schema.

    >>> record = harness.read_result("out/paestum_floor")
    """
    path = Path(folder) / RECORD
    if not path.is_file():
        advice = "run `rockcheck run SCENE --out DIR` first"
        raise InputError(Mistake(str(folder), "", f"a result folder with {RECORD}", "none there", advice))
    try:
        text = path.read_bytes()
        record = json.loads(text.decode("utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(Mistake(str(path), "", "a readable JSON record", str(error))) from error
    if not isinstance(record, dict) or record.get("schema_version") != SCHEMA_VERSION:
        got = record.get("schema_version") if isinstance(record, dict) else type(record).__name__
        raise InputError(Mistake(str(path), "schema_version", str(SCHEMA_VERSION), repr(got), REWRITE))
    kind = record.get("kind")
    if not isinstance(kind, str) or kind not in KINDS:
        raise InputError(Mistake(str(path), "kind", f"one of {', '.join(KINDS)}", repr(kind)))
    return validated(class_of(kind), text, path)
