"""The readers of record files: the format is recognised by its content.

To add a format: one file beside this one with NAME, TESTED_ON_ORIGINALS, recognises(text) and read(text, where), and its
line in _READERS, the strictest first.
"""

from __future__ import annotations

from pathlib import Path
from typing import Final, Protocol

from harness.input.motions import check
from harness.input.motions.readers import at2, cosmos, csv, esm, smc, v2, v2a
from harness.input.motions.recordfile import UNITS_M_S2, RecordFile
from harness.input.motions.text import mistake, read_text
from harness.model.errors import InputError


class Reader(Protocol):
    """What a format's file offers."""

    NAME: str
    TESTED_ON_ORIGINALS: bool

    def recognises(self, text: str) -> bool:
        """Whether `text` is of this format."""

    def read(self, text: str, where: str) -> RecordFile:
        """Its channels; InputError where it is damaged."""


_READERS: Final[tuple[Reader, ...]] = (v2a, v2, cosmos, smc, esm, at2)
FORMATS: Final[tuple[tuple[str, bool], ...]] = tuple((r.NAME, r.TESTED_ON_ORIGINALS) for r in (*_READERS, csv))
"""Every format's name and whether its reader was tried on originals of the network."""

_ALIKE = 0.5  # share of two file names' letters (without the ending) that agree at their ends, for files of one record


def read_file(path: Path, *, unit: str | None = None) -> RecordFile:
    """The channels of one file; `unit` where the file does not state one (CSV). InputError names the line at fault."""
    text = read_text(path)
    where = str(path)
    for reader in _READERS:
        if reader.recognises(text):
            record = reader.read(text, where)
            if unit is not None and unit != record.unit:
                raise mistake(
                    where, "unit", f"the unit of a {record.format} file, {record.unit}", unit, "leave unit out"
                )
            return record
    if not csv.recognises(text):
        names = ", ".join(name for name, _ in FORMATS)
        raise mistake(
            where, "", f"one of {names}", repr(text.splitlines()[0][:60]), "columns of numbers with t_s also do"
        )
    if unit is not None and unit not in UNITS_M_S2:
        raise mistake(where, "unit", " or ".join(UNITS_M_S2), unit)
    return csv.read(text, where, unit=unit)


def read_record(path: Path, *, unit: str | None = None) -> RecordFile:
    """The whole record: this file's channels, those of its sister files where a file holds one, and all findings."""
    record = read_file(path, unit=unit)
    sisters, unread = _read_sisters(record, path) if record.group else ([], [])
    channels = (*record.channels, *(channel for other in sisters for channel in other.channels))
    warnings = (*record.warnings, *(said for other in sisters for said in other.warnings), *unread)
    names = [channel.name for channel in channels]
    if len(set(names)) < len(names):
        channels, warnings = record.channels, (*record.warnings, "sister files repeat a component: they are left out")
    whole = RecordFile(
        record.path, record.format, record.tested, record.unit, channels, record.facts, record.group, warnings
    )
    said = check.check(whole)
    return RecordFile(
        record.path, record.format, record.tested, record.unit, channels, record.facts, record.group, (*warnings, *said)
    )


def _read_sisters(record: RecordFile, path: Path) -> tuple[list[RecordFile], list[str]]:
    """Other files of the same record, and what is to be said of those beside it that are damaged."""
    sisters: list[RecordFile] = []
    unread: list[str] = []
    for other in _sisters(path):
        try:
            sister = read_file(other)
            check.check(sister)
        except InputError as error:
            name = ascii(other.name)[1:-1]
            unread.append(f"{name} beside it is left out: {str(error).splitlines()[0].removeprefix(f'{other}: ')}")
            continue
        if sister.group == record.group and sister.format == record.format:
            sisters.append(sister)
    return sisters, unread


def _sisters(path: Path) -> list[Path]:
    """Files beside this one whose names differ in their middle only, sorted."""
    found: list[Path] = []
    try:
        beside = sorted(path.parent.iterdir())
    except OSError:  # a folder that may be entered but not listed: the file itself was read
        beside = []
    for other in beside:
        if other == path or other.suffixes[-1:] != path.suffixes[-1:] or not other.is_file():
            continue
        same = _alike(path.stem, other.stem)
        same += _alike(path.stem[same:][::-1], other.stem[same:][::-1])
        if same >= _ALIKE * max(len(path.stem), len(other.stem)):
            found.append(other)
    return found


def _alike(one: str, other: str) -> int:
    """Number of letters with which both begin."""
    pairs = zip(one, other, strict=False)
    return next((i for i, (a, b) in enumerate(pairs) if a != b), min(len(one), len(other)))
