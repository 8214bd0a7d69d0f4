"""Which class is the record of each kind, and their JSON Schemas: `python -m harness.records.kinds` writes them anew."""

from __future__ import annotations

import json
from collections.abc import Mapping
from importlib import import_module
from typing import Final

from harness.model.run import write_text
from harness.records.base import SCHEMAS, Record, schema_name, schema_of

CLASSES: Final[Mapping[str, str]] = {
    "run": "harness.records.run:RunRecord",
    "assess": "harness.records.assess:AssessRecord",
}
"""By kind the module and the class of its record, imported where one is read."""


def class_of(kind: str) -> type[Record]:
    """The class of a kind's record. Raises `KeyError` for a kind that has none."""
    module, _, name = CLASSES[kind].partition(":")
    record: type[Record] = getattr(import_module(module), name)
    return record


def schema_text(kind: str) -> str:
    """The JSON Schema of a kind, as it is published."""
    schema = {"$id": schema_name(kind), **schema_of(class_of(kind))}
    return json.dumps(schema, indent=1, ensure_ascii=False) + "\n"


def publish() -> None:
    """Write the JSON Schemas of all kinds."""
    SCHEMAS.mkdir(exist_ok=True)
    for kind in CLASSES:
        write_text(SCHEMAS / f"{kind}.schema.json", schema_text(kind))


if __name__ == "__main__":
    publish()
