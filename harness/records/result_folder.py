"""Whose a folder is: only what an own `result.json` lists there is replaced or removed, and nothing that a run reads."""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Final, TypeVar

from harness.model.errors import InputError, Mistake
from harness.model.run import write_json
from harness.records.base import Plain, Record, Table, as_file

R = TypeVar("R", bound=Record)
RECORD: Final = "result.json"
COMING: Final = ".coming.json"
"""The record of a result while its files are moved into place: until then the files of both are the folder's own."""
PAGES: Final = ("report.html", "conservator.html")
"""Written of a record alone, by whoever reads it: listed without a checksum."""
KINDS: Final = (
    "run", "assess", "study", "effects3d", "rocking_spectrum", "bench", "stress", "validation", "tosses", "compare"
)  # fmt: skip
UNFINISHED: Final = (
    "store.sqlite",
    "store.sqlite-wal",
    "store.sqlite-shm",
    "searches.jsonl",
    "parts",
    "replay",
    "outcomes",
)
"""What stands in a folder before its first record is whole, and"""
INSPECTED: Final = ("motion.png", "motion.json")
"""what an inspected motion leaves there: neither makes a folder another's."""
PLAIN_NAME: Final = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.+-]{0,199}")
"""Every file that is ever written into a result folder has such a name."""
FRESH: Final = ".writing-"
MARK: Final = b"made by rockcheck"
"""Stands in every picture that is written beside a result: such a picture may be written again."""

Sums = dict[str, set[str | None]]


def named_after(file: Path) -> str:
    """The name of a file's result folder. Raises `InputError` for a name such as `...toml`, which names none."""
    name = file.stem.strip(".")
    if not name:
        raise InputError(Mistake(str(file), "", "a file whose name can name a folder", repr(file.name), "give --out"))
    return name


def checksum(path: Path) -> str:
    """SHA-256 of a file's bytes."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def listing(files: Iterable[Path], pages: bool = True) -> dict[str, str | None]:
    """What a record says of its folder's files: checksums by name; None for the pages, which may be written again."""
    return {path.name: checksum(path) for path in files} | (dict.fromkeys(PAGES) if pages else {})


def check_folder(folder: Path, kinds: tuple[str, ...] = KINDS, names: Iterable[str] = ()) -> None:
    """Raise `InputError` unless results can be written into `folder` (which may not exist yet) without a loss.

    It is new or empty, or holds a result of its own of one of these `kinds`, or what one that was interrupted left; and of the
    `names` that will be written none is a file that this result does not list, or that was changed since.
    """
    try:
        existing = next((path for path in (folder, *folder.parents) if path.exists()), None)
        if existing is not None and not existing.is_dir():
            raise InputError(Mistake("--out", "", "a folder", f"the file {existing}"))
        if existing is not None and not os.access(existing, os.W_OK | os.X_OK):
            raise InputError(Mistake("--out", "", "a folder that can be written", f"the read-only folder {existing}"))
        inside = sorted(path.name for path in folder.iterdir()) if existing == folder else []
    except (OSError, ValueError) as error:  # a name that is too long, or no name at all
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise InputError(Mistake("--out", "", "a folder that can be written", f"{str(folder)!r}: {reason}")) from error
    kind = _kind(folder)
    others = [name for name in inside if name not in (*UNFINISHED, *INSPECTED) and not name.startswith(".")]
    if kind is None and others:
        got = f"{folder}, where {_some(others)} stand{'s' * (len(others) == 1)} without a result of rockcheck"
        raise InputError(Mistake("--out", "", "a new or an empty folder, or one with a result of its own", got))
    if kind is not None and kind not in kinds:
        got = f"{folder}, which holds a {kind}"
        raise InputError(Mistake("--out", "", f"a folder of a {' or '.join(kinds)}", got, "give another folder"))
    foreign = [name for name in names if not _own(folder / name, owned(folder))]
    if foreign:
        got = f"{folder}, where {_some(foreign)} would be lost: not in its result.json, or changed since"
        raise InputError(Mistake("--out", "", "a folder whose files are those of its result.json", got, "move them"))


def check_inputs(folder: Path, names: Iterable[str], inputs: Iterable[Path]) -> None:
    """Raise `InputError` where a file to be written into `folder` is one that the run reads."""
    wanted = {(folder / name).resolve() for name in names}
    for path in inputs:
        if path.resolve() in wanted:
            raise InputError(Mistake("--out", "", "another folder than its input's", f"{path} would be lost"))


def check_listed(path: Path, record: Path) -> None:
    """Raise `InputError` unless a file, and the record beside it that lists it, are not there yet or as they were written."""
    if not os.path.lexists(path) and not os.path.lexists(record):
        return
    try:
        files = json.loads(record.read_text(encoding="utf-8"))["files"]
        mine = files == listing([path], pages=False) and not path.is_symlink()
    except (OSError, ValueError, KeyError, TypeError):
        mine = False
    if not mine:
        got = f"{path}, which {record.name} does not list as it is"
        raise InputError(Mistake("--out", "", "a new file, or one that this command wrote", got, "give another name"))


def check_marked(pictures: Iterable[Path]) -> None:
    """Raise `InputError` where a picture to be written would replace a file that is no picture of rockcheck's."""
    for path in pictures:
        if os.path.lexists(path) and not (path.is_file() and not path.is_symlink() and MARK in path.read_bytes()):
            raise InputError(Mistake("--out", "", "a new file, or a picture of rockcheck's to replace", str(path)))


def owned(folder: Path) -> Sums:
    """The files that the folder's own record lists, with the checksums they may have (None: not checked)."""
    sums: Sums = {}
    for record in filter(None, (read_own(folder / name) for name in (RECORD, COMING))):
        files = record.get("files")
        for name, value in (files if isinstance(files, Mapping) else _of_old(record)).items():
            # Nothing but a plain name: what a record says of other folders, or of itself, is not believed.
            if PLAIN_NAME.fullmatch(name) and name != RECORD and isinstance(value, str | None):
                sums.setdefault(name, set()).add(value)
    return sums


def _of_old(record: Table) -> dict[str, str | None]:
    """The files of a record that was written before records listed them."""
    histories = record.get("histories")
    names = [f"history_{name}.csv" for name in histories] if isinstance(histories, list) else []
    return dict.fromkeys([*names, *PAGES, *(["statue.glb"] if record["kind"] == "run" else [])])


def _own(path: Path, sums: Sums) -> bool:
    """Whether a file may be replaced: it is not there, or listed and as it was written."""
    if not os.path.lexists(path) or path.name == RECORD:
        return True
    return path.name in sums and path.is_file() and not path.is_symlink() and as_written(path, sums)


def as_written(path: Path, sums: Sums) -> bool:
    """Whether a file has a checksum that was listed for it; one of which none is listed is taken as it is."""
    known = sums.get(path.name, {None})
    return None in known or checksum(path) in known


def read_own(path: Path) -> Plain | None:
    """A record that rockcheck wrote, None where there is none."""
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return None
    mine = isinstance(record, dict) and record.get("kind") in KINDS and isinstance(record.get("schema_version"), int)
    return record if mine else None


def _kind(folder: Path) -> str | None:
    record = read_own(folder / RECORD) or read_own(folder / COMING)
    return None if record is None else str(record["kind"])


def _some(names: list[str]) -> str:
    return ", ".join(names[:3]) + (" and others" if len(names) > 3 else "")


@contextmanager
def writing(path: Path) -> Iterator[Path]:
    """A name beside `path` that becomes it when all is written, and is removed when not; what was there before goes."""
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=FRESH, suffix=path.suffix)
    os.close(handle)
    try:
        yield Path(name)
        os.chmod(name, 0o644)
        os.replace(name, path)
    finally:
        Path(name).unlink(missing_ok=True)


def write_whole(folder: Path, record: R, write: Callable[[Path], None]) -> R:
    """A record, and the files that `write` makes in a folder beside, become the result in `folder`; its own before goes.

    The record that is returned lists the files. A write that is killed leaves files that one of both records lists. Raises
    `InputError` for a folder that is another's.
    """
    check_folder(folder, (record.kind,))
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(Mistake("--out", "", "a folder that can be written", f"{folder}: {error.strerror}")) from error
    fresh = Path(tempfile.mkdtemp(dir=folder, prefix=FRESH))
    try:
        write(fresh)
        written = sorted(fresh.iterdir())
        check_folder(folder, (record.kind,), [path.name for path in written])
        files = listing(written)
        complete = replace(record, files=files)
        before = owned(folder)
        write_json(fresh / COMING, as_file(complete))
        (fresh / COMING).replace(folder / COMING)
        for path in written:
            path.replace(folder / path.name)
        for name in before.keys() - files.keys():
            if _own(folder / name, before):
                (folder / name).unlink(missing_ok=True)
        (folder / COMING).replace(folder / RECORD)
    finally:
        shutil.rmtree(fresh, ignore_errors=True)
    return complete
