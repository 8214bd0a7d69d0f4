"""What all records share: one frozen typed class is the writer, the reader and the JSON Schema of a record; and its folder.

Parts are plain frozen dataclasses, so that writing one costs nothing; pydantic validates them once, on reading, strictly.
"""

import json
import os
import re
import shlex
import shutil
import tempfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, fields, replace
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any, ClassVar, Final, Self, TypeVar

from pydantic import ConfigDict, Field, JsonValue, TypeAdapter, ValidationError
from pydantic.json_schema import GenerateJsonSchema
from pydantic_core import ErrorDetails

from harness.input.mistakes import TYPE_NAME, Contradiction, got_of, wanted_of
from harness.model import (
    FRESH,
    MARK,
    NO_ROOM,
    OMITTED,
    SCHEMA_VERSION,
    Answer,
    Finding,
    InputError,
    Mistake,
    Say,
    checksum,
    is_own,
    is_sealed,
    require,
    texted,
    to_plain,
    translated,
    weighed,
    write_json,
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
        return replace(
            self, answer=self.answer and self.answer.texted(say), findings=texted(weighed(self.findings), say)
        )

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
        text = LONE.sub(lambda mark: f"\\\\u{ord(mark.group()):04x}", json.dumps(json.loads(text), ensure_ascii=False))
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
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": name,
        **shape,
        "properties": {"$schema": {"const": name}, **properties, "seal": SEAL},
    }


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


# A result's folder: only what an own `result.json` lists there is replaced or removed, and nothing that a run reads; its record
# is read by its kind.


R = TypeVar("R", bound=Record)
RECORD: Final = "result.json"
COMING: Final = ".coming.json"
"""The record of a result while its files are moved into place: until then the files of both are the folder's own."""
PAGES: Final = ("report.html", "conservator.html")
"""Written of a record alone, by whoever reads it: each is sealed, and goes with the record of which it was made."""
KINDS: Final[Mapping[str, str]] = {
    "run": "harness.records.run",
    "assess": "harness.records.assess",
    "study": "harness.records.study",
    "effects3d": "harness.records.effects3d",
    "rocking_spectrum": "harness.records.study",
    "bench": "harness.records.bench",
    "stress": "harness.records.bench",
    "validation": "harness.records.validation",
    "trust": "harness.records.trust",
    "measured": "harness.records.validation",
    "compare": "harness.records.scores",
}
"""The module of the class of each kind of record, wherever it stands: a new kind is a line here."""
STORE: Final = "store.sqlite"
STORE_KINDS: Final = (
    "study",
    "effects3d",
    "assess",
    "validation",
    "bench",
    "bench --quick",
    "stress",
    "stress --quick",
    "trust",
)
"""What a store may be of, in the order of their numbers in its head."""
STORE_NUMBER: Final = 0x526F6300
"""`application_id` of a store of the first kind."""
GOES_ON: Final = {
    "study": "study STUDY", "effects3d": "study STUDY", "assess": "assess SCENE", "trust": "trust SCENE",
    "validation": "validate EXPERIMENTS"
}  # fmt: skip
"""The command that goes on with what was begun of a kind, where it is not the kind itself."""
INSPECTED: Final = ("motion.png", "motion.json")
"""What an inspected motion leaves in a folder: neither makes it another's."""
PLAIN_NAME: Final = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.+-]{0,199}")
"""Every file that is ever written into a result folder has such a name."""

Sums = dict[str, set[str]]


def named_after(file: Path) -> str:
    """The name of a file's result folder. Raises `InputError` for a name such as `...toml`, which names none."""
    name = file.stem.strip(".")
    require(name, str(file), "a file whose name can name a folder", repr(file.name), "give --out")
    return name


def listing(files: Iterable[Path]) -> dict[str, str | None]:
    """What a record says of its folder's files: checksums by name."""
    return {path.name: checksum(path) for path in files}


def check_folder(
    folder: Path, kinds: tuple[str, ...] | None = None, names: Iterable[str] = (RECORD, COMING, *PAGES)
) -> None:
    """Raise `InputError` unless results can be written into `folder` (which may not exist yet) without a loss.

    It is new or empty, or holds a result of its own of one of these `kinds` (None: of any), or the store of one that was
    interrupted; and of the `names` that will be written none is a file that this result does not list, or that was changed since.
    """
    try:
        there = next((path for path in (folder, *folder.parents) if path.exists() or path.is_symlink()), folder)
        is_folder, open_to_us = there.is_dir(), os.access(there, os.W_OK | os.X_OK)
        inside = [path.name for path in folder.iterdir()] if there == folder and is_folder and open_to_us else []
    except (OSError, ValueError) as error:  # a name that is too long, or no name at all
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise InputError(Mistake("--out", "", "a folder that can be written", f"{str(folder)!r}: {reason}")) from error
    got = f"the link {there} to nothing" if there.is_symlink() and not there.exists() else f"the file {there}"
    require(is_folder, "--out", "a folder", got)
    require(open_to_us, "--out", "a folder that can be written", f"the read-only folder {there}")
    own = ((path, read_own(path)) for path in (folder / RECORD, folder / COMING))
    ended = (full_kind(str(each["kind"]), each.get("command")) for path, each in own if each and is_sealed(path))
    finished, begun = next(ended, None), store_kind(folder / STORE)
    found = [kind for kind in (finished, begun) if kind is not None]
    others = [name for name in inside if name not in INSPECTED and not name.startswith(".")]
    others.sort(key=lambda name: (name != RECORD, name))
    got = f"{folder}, where {_some(others)} stand{'s' * (len(others) == 1)} without a result as rockcheck wrote it"
    require(found or not others, "--out", "a new or an empty folder, or one with a result of its own", got)
    for kind in found:
        if kinds is not None and kind not in kinds:
            got = f"{folder}, which holds {'a result' if kind == finished else 'what was begun'} of this kind: {kind}"
            advice = "give another folder"
            if kind == begun:
                goes_on = shlex.join(["rockcheck", *GOES_ON.get(kind, kind).split(), "--out", str(folder)])
                advice = f"{advice}; `{goes_on}` goes on with this one"
            raise InputError(Mistake("--out", "", f"a folder of this kind: {' or '.join(kinds)}", got, advice))
    sums = owned(folder)
    foreign = [name for name in names if not is_own(folder / name, sums.get(name, ()))]
    got = f"{folder}, where {_some(foreign)} would be lost: not in its {RECORD}, or changed since"
    require(not foreign, "--out", f"a folder whose files are those of its {RECORD}", got, "move them")


def check_inputs(folder: Path, names: Iterable[str], inputs: Iterable[Path]) -> None:
    """Raise `InputError` where a file to be written into `folder`, or removed with the result that is there, is an input."""
    # Not Path.resolve, which raises where links go round.
    wanted = {os.path.realpath(folder / name) for name in (*names, *owned(folder))}
    for path in inputs:
        require(
            os.path.realpath(path) not in wanted, "--out", "another folder than its input's", f"{path} would be lost"
        )


def owned(folder: Path) -> Sums:
    """The files that the folder's own record lists, with the checksums they may have."""
    sums = listed(folder / RECORD)
    for name, of_coming in listed(folder / COMING).items():
        sums.setdefault(name, set()).update(of_coming)
    return sums


def listed(path: Path) -> Sums:
    """The files that a record lists, with their checksums; none where the record is not as it was written."""
    record = _read(path)
    files = record.get("files") if record is not None and is_sealed(path) else None
    sums = files.items() if isinstance(files, Mapping) else ()
    # Nothing but a plain name: what a record says of other folders, or of itself, is not believed.
    return {name: {value} for name, value in sums if PLAIN_NAME.fullmatch(name) and isinstance(value, str)}


def as_written(path: Path, record: Record) -> bool:
    """Whether a file has the checksum that the record beside it lists; one of which none is listed is taken as it is."""
    known = (record.files or {}).get(path.name)
    return known is None or checksum(path) == known


def read_own(path: Path) -> Plain | None:
    """A record that rockcheck wrote, None where there is none."""
    record = _read(path)
    kind, version = (None, None) if record is None else (record.get("kind"), record.get("schema_version"))
    return record if isinstance(kind, str) and kind in KINDS and isinstance(version, int) else None


def _read(path: Path) -> Plain | None:
    """A table of JSON, None where there is none."""
    with suppress(OSError, ValueError, RecursionError):
        record = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else None
        return record if isinstance(record, dict) else None
    return None


def store_kind(path: Path) -> str | None:
    """What a store is of, None where the file is no store of ours: read from its head, so that SQLite never opens another's."""
    if not path.is_file():
        return None
    with path.open("rb") as stream:
        head = stream.read(100)
    number = int.from_bytes(head[68:72], "big") - STORE_NUMBER
    return STORE_KINDS[number] if head.startswith(b"SQLite format 3\0") and 0 <= number < len(STORE_KINDS) else None


def full_kind(kind: str, command: object) -> str:
    """A kind of record, with `--quick` where its command had it: a few rows are no measurement to replace a whole one."""
    return f"{kind} --quick" if kind in ("bench", "stress") and "--quick" in str(command).split() else kind


def _some(names: list[str]) -> str:
    return ", ".join(names[:3]) + (" and others" if len(names) > 3 else "")


def write_whole(folder: Path, record: R, write: Callable[[Path], None] = lambda fresh: None) -> R:
    """A record, and the files that `write` makes in a folder beside, become the result in `folder`; its own before goes.

    The record that is returned lists the files. A write that is killed leaves files that one of both records lists. Pages of the
    record before go too: no page stands beside a record of which it does not speak. Raises `InputError` for a folder that is
    another's.
    """
    kinds = (full_kind(record.kind, getattr(record, "command", "")),)
    check_folder(folder, kinds)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(Mistake("--out", "", "a folder that can be written", f"{folder}: {error.strerror}")) from error
    fresh = Path(tempfile.mkdtemp(dir=folder, prefix=FRESH))
    try:
        write(fresh)
        written = sorted(fresh.iterdir())
        check_folder(folder, kinds, [RECORD, COMING, *PAGES, *(path.name for path in written)])
        files = listing(written)
        complete = replace(record, files=files)
        before = owned(folder)
        write_json(fresh / COMING, as_file(complete))
        (fresh / COMING).replace(folder / COMING)
        for path in written:
            path.replace(folder / path.name)
        for name in {*PAGES, *before} - files.keys():
            if is_own(folder / name, before.get(name, ())):
                (folder / name).unlink(missing_ok=True)
        (folder / COMING).replace(folder / RECORD)
    except OSError as error:
        if error.errno not in NO_ROOM:
            raise
        raise OSError(error.errno, error.strerror, str(folder)) from error
    finally:
        shutil.rmtree(fresh, ignore_errors=True)
    return complete


# Reading: which class is the record of each kind.


def class_of(kind: str) -> type[Record]:
    """The class of a kind's record."""
    own = vars(import_module(KINDS[kind])).values()
    return next(each for each in own if isinstance(each, type) and getattr(each, "kind", None) == kind)


def read_result(folder: Path | str) -> Record:
    """The record of a result folder. Raises `InputError` when it is absent, damaged, or of another schema.

    >>> record = harness.read_result("out/paestum_floor")
    """
    path = Path(folder) / RECORD
    advice = "run `rockcheck run SCENE --out DIR` first"
    require(path.is_file(), str(folder), f"a result folder with {RECORD}", "none there", advice)
    with translated((OSError, ValueError, RecursionError), str(path), "a readable JSON record"):
        text = path.read_bytes()
        record = json.loads(text.decode("utf-8"))
    version = record.get("schema_version") if isinstance(record, dict) else type(record).__name__
    require(version == SCHEMA_VERSION, str(path), str(SCHEMA_VERSION), repr(version), REWRITE, key="schema_version")
    kind = record.get("kind")
    known = isinstance(kind, str) and kind in KINDS
    require(known, str(path), f"one of {', '.join(KINDS)}", repr(kind), key="kind")
    return validated(class_of(kind), text, path)
