"""What all records share: one frozen typed class is the writer, the reader and the JSON Schema of a record.

Parts are plain frozen dataclasses, so that writing one costs nothing; pydantic validates them once, on reading, strictly.
"""

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Annotated, Any, ClassVar, Final, Self, TypeVar

from pydantic import ConfigDict, Field, JsonValue, TypeAdapter, ValidationError
from pydantic.json_schema import GenerateJsonSchema
from pydantic_core import ErrorDetails

from harness.input.mistakes import TYPE_NAME, Contradiction, got_of, wanted_of
from harness.model import (
    MARK,
    OMITTED,
    SCHEMA_VERSION,
    Answer,
    Finding,
    InputError,
    Mistake,
    Say,
    texted,
    to_plain,
    weighed,
)

REWRITE: Final = "write the result anew with this version"
MOST_MISTAKES: Final = 10
"""Mistakes told of one record: more say nothing that these do not."""
SEAL: Final = {"type": "string", "pattern": f"^{MARK}[0-9a-f]{{64}}$"}
LONE: Final = re.compile("[\ud800-\udfff]")
Plain = dict[str, JsonValue]
"""What stands in a file of JSON."""
Table = Mapping[str, JsonValue]
"""An open table: what stands in it is an engine's or a user's own."""
Positive = Annotated[float, Field(gt=0.0)]
T = TypeVar("T")
_ADAPTERS: Final[dict[type, TypeAdapter[Any]]] = {}


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Record:
    """The head of every `result.json`; a kind of record derives from it, with its own `kind`."""

    __pydantic_config__: ClassVar[ConfigDict] = ConfigDict(strict=True, allow_inf_nan=False)

    schema_version: int = SCHEMA_VERSION
    kind: str
    title: str
    answer: Answer | None = field(default=None, metadata=OMITTED)
    """The headline, on every page and terminal."""
    asked: Sequence[str] | None = field(default=None, metadata=OMITTED)
    """Options of its command that change what it computes, as it takes them; files and engines stand elsewhere."""
    findings: Sequence[Finding] = ()
    """All that is to be known of the result, by severity."""
    versions: Mapping[str, str]
    machine: Table
    files: Mapping[str, str | None] | None = field(default=None, metadata=OMITTED)
    """SHA-256 of each other file of the result, None of one that is written anew at each report; absent before it is written."""

    def texted(self, say: Say) -> Self:
        """The record with the sentences of its answer and findings."""
        answer = None if self.answer is None else self.answer.texted(say)
        return replace(self, answer=answer, findings=texted(weighed(self.findings), say))

    def plain(self) -> Plain:
        """The record as plain JSON values in the order of its fields; one of many rows writes these by itself."""
        return plain(self)


def option_words(**options: object) -> list[str]:
    """Options of a command as it takes them, each once for every item of a list; those that are not given are left out."""
    words: list[str] = []
    for name, value in options.items():
        flag = f"-{name}" if len(name) == 1 else f"--{name.replace('_', '-')}"
        for each in value if isinstance(value, (list, tuple)) else [value]:
            words += [flag, *([] if each is True else [str(each)])] if each else []
    return words


@dataclass(frozen=True)
class RunCounts:
    """Runs of a call: those that were asked, and those that had to be computed."""

    wanted: int
    computed: int


def same_fields(kind: type, source: object) -> Any:
    """The arguments that a record takes as they stand from an object with fields of the same names."""
    return {each.name: getattr(source, each.name) for each in fields(kind) if hasattr(source, each.name)}


def plain(record: Any) -> Plain:
    """A record, or a part of one, as plain JSON values in the order of its fields."""
    values: Plain = to_plain(record)
    return values


def as_file(record: Record) -> Plain:
    """A record as it stands in a `result.json`, which names its JSON Schema."""
    values = record.plain()
    # What the result is comes before where it was computed.
    last: Plain = {name: values.pop(name) for name in ("versions", "machine", "files") if name in values}
    return {"$schema": schema_name(record.kind), **values, **last}


def schema_name(kind: str) -> str:
    """The name of a kind's JSON Schema, which `rockcheck schema KIND` prints."""
    return f"urn:rockcheck:schema:{kind}:{SCHEMA_VERSION}"


def validated(kind: type[T], text: str | bytes, where: Path) -> T:
    """A record from its JSON text. Raises `InputError` naming file and key of what is absent or of another form."""
    text = text.decode("utf-8") if isinstance(text, bytes) else text
    if "\\ud" in text or "\\uD" in text:
        # Bytes of a file's name that are no UTF-8 as their escapes: json writes them, pydantic does not read them.
        whole = json.dumps(json.loads(text), ensure_ascii=False)
        text = LONE.sub(lambda mark: f"\\\\u{ord(mark.group()):04x}", whole)
    try:
        return _adapter(kind).validate_json(text)
    except ValidationError as error:
        mistakes = dict.fromkeys(_mistake(detail, str(where)) for detail in error.errors(include_url=False))
        raise InputError(list(mistakes)[:MOST_MISTAKES]) from error


def part(kind: type[T], values: Any, where: Path) -> T:
    """A record, or a part of one, from plain values that were read already. Raises `InputError` as `validated`."""
    return validated(kind, json.dumps(values), where)


def schema_of(kind: type[Record]) -> Plain:
    """The JSON Schema of a kind of record as it stands in a file: beside its fields the name of the schema, and the seal."""
    shape = _adapter(kind).json_schema(schema_generator=_Written)
    properties = shape.pop("properties")
    name = schema_name(properties["kind"]["const"])
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "$id": name}
    return {**head, **shape, "properties": {"$schema": {"const": name}, **properties, "seal": SEAL}}


class _Written(GenerateJsonSchema):
    """The schema of what is written: no field that is in no file; a field's key says what it is, no title repeats it."""

    def field_is_present(self, field: Any) -> bool:
        """Whether it is written."""
        return not field.get("serialization_exclude")

    def field_title_should_be_set(self, schema: object) -> bool:
        """Never."""
        return False


def _adapter(kind: type[T]) -> TypeAdapter[T]:
    """Made once, where it is first needed: some 20 ms for the record of a run."""
    if kind not in _ADAPTERS:
        _ADAPTERS[kind] = TypeAdapter(kind)
    return _ADAPTERS[kind]


def _mistake(detail: ErrorDetails, where: str) -> Mistake:
    path = [str(part) for part in detail["loc"] if isinstance(part, int) or not TYPE_NAME.fullmatch(part)]
    cause = detail.get("ctx", {}).get("error")
    if isinstance(cause, Contradiction):
        return Mistake(where, ".".join([*path, cause.key]), cause.wanted, cause.got, REWRITE)
    return Mistake(where, ".".join(path), wanted_of(detail), got_of(detail), REWRITE)
