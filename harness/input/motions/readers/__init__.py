"""The readers of record files: the format is recognised by its content.

To add a format: a function of lines and the file's name in `keyed.py`, `volumes.py` or a file beside them, what it is recognised
by in _READERS, and its name in FORMATS (`recordfile.py`).
"""

import re
import textwrap
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Final

from harness.input.files import read_bytes
from harness.input.motions.readers import keyed, seed, table, volumes
from harness.input.motions.recordfile import (
    CUT_OFF,
    FORMATS,
    UNIT_NAMES,
    Layout,
    RecordFile,
    check,
    mistake,
    text_of,
    unit_named,
)
from harness.model import Finding, InputError, caution, info, require, weighed

Reader = Callable[[list[str], str], RecordFile]
"""What gives the channels of a format's lines; InputError, with the file's name, where they are damaged."""
_READERS: Final[Mapping[Reader, re.Pattern[str]]] = {
    volumes.geonet: volumes.GEONET,
    keyed.knet: re.compile(r"\s*origin time(?s:.{0,2000}?)(?:scale factor|station code)", re.IGNORECASE),
    # The first line is "2 CORRECTED ACCELEROGRAM", or another kind's, and the second begins with *.
    volumes.smc: re.compile(r"[^\S\n]*[1-6]\s.*(?:ACCELEROGRAM|VELOCITY|DISPLACEMENT|SPECTR).*\n\*", re.IGNORECASE),
    volumes.volume1: volumes.VOLUME1,
    # Of CSMIP's volume 2, too; SMC and GeoNet are asked first.
    volumes.volume2: re.compile(r"(?s:.{0,180}?)CORRECTED ACCELEROGRAM", re.IGNORECASE),
    volumes.cosmos: re.compile(r"(?s:.*?)(?:Integer|Real)-header values follow on", re.IGNORECASE),
    keyed.esm: re.compile(r"(?=EVENT[_ ]|NETWORK:)(?:.*\n)*?EVENT[_ ](?:NAME|ID):", re.IGNORECASE),
    # The first line says PEER, or the fourth speaks of the number of points and the step.
    keyed.at2: re.compile(r"PEER .*(?:\n.*){3}|(?:.*\n){3}.*\bNPTS\b.*\bDT\b", re.IGNORECASE),
    keyed.nsmn: re.compile(r"(?s:.{0,170}?)STRONG GROUND MOTION RECORDS OF T", re.IGNORECASE),
    keyed.unam: re.compile(r"(?s:.{0,4000}?)ARCHIVO ESTANDAR DE ACELERACI", re.IGNORECASE),
    keyed.cwb: re.compile(
        r"(?=(?s:.{0,4000}?)#stationcode)(?s:.{0,4000}?)#(?:datasequence|amplitudeunit)", re.IGNORECASE
    ),
}
"""What a file of each format begins with, damaged or not, its lines ending in "\\n"; the strictest first."""
_HEAD: Final = 200
"""Lines in which a format shows itself; those of COSMOS begin with up to a hundred of comments."""
_ALIKE = 0.5  # share of two file names' letters (without the ending) that agree at their ends, for files of one record
_NUMBERS = re.compile(r"[\s0-9.,;|:+\-eEdD]+")
_WORD = re.compile(r"\S+")
_DECIMALS = re.compile(r"[.,]([^.,\s]*)\s*$")
_UNIFORM: Final = 64
"""So many lines whose last numbers have as many decimals, or end in one column, have a format: of a thousand texts whose noughts
at the end are left out one has such lines by chance."""
_ENDINGS: Final = {"K-NET": r"\.(EW|NS|UD)", "KiK-net": r"\.(EW|NS|UD)[12]", "USC V1": r"\.[a-z]\d[a-z]"}
"""Endings by which these networks tell the files of one record apart."""
_NO_RECORD = re.compile(r"RESPONSE AND FOURIER AMPLITUDE SPECTRA|RESPONSE SPECTR", re.IGNORECASE)


def read_file(path: Path, *, unit: str | None = None, layout: Layout | None = None) -> RecordFile:
    """The channels of one file; `unit` and `layout` where the file does not tell them. InputError names the line at fault."""
    where = str(path)
    named = None if unit is None else unit_named(unit)
    require(unit is None or named is not None, where, UNIT_NAMES, str(unit), key="unit")
    raw = read_bytes(path, "an accelerogram")
    if seed.is_binary(raw):
        return seed.read(raw, where, unit=named)
    text = text_of(raw, where)
    if layout is not None and layout != Layout():
        described = table.described(text, where, unit=named, layout=layout)
        _check_end(text, where)
        return described
    if record := _of_a_network(text, where):
        wanted = f"the unit of a {record.format} file, {record.unit}"
        require(named in (None, record.unit), where, wanted, str(named), "leave unit out", key="unit")
        return record
    if spectra := _NO_RECORD.search(text[:400]):
        got = f"a file of spectra ({spectra.group()})"
        raise mistake(where, "", "an accelerogram", got, "take the record's own file (V1, V2)")
    try:
        if table.recognises(text) or table.names_times(text):
            named_columns = table.headed_columns(text, where, unit=named)
            _check_end(text, where)
            return named_columns
        first = next((line.strip() for line in text.splitlines() if line.strip()), "blank lines alone")
        raise mistake(
            where, "", f"one of {', '.join(FORMATS)}", repr(first[:60]), "columns of numbers with t_s also do"
        )
    except InputError as error:
        raise _with_proposal(error, text, where) from None


def _of_a_network(text: str, where: str) -> RecordFile | None:
    """The record by the reader that knows its layout, if need be without what programs add; None where none knows it."""
    refused: tuple[Reader, InputError] | None = None
    for version, said in _versions(text):
        lines = version.splitlines()
        head = "\n".join(lines[:_HEAD])
        reader = next((each for each, mark in _READERS.items() if mark.match(head)), None)
        if reader is None:
            continue
        try:
            record = reader(lines, where)
            _check_end(text, where)
        except InputError as error:
            # The same reader's first refusal counts the file's own lines.
            if refused is None or refused[0] is not reader:
                refused = reader, error
            continue
        return replace(record, findings=(*record.findings, *said))
    if refused:
        raise refused[1]
    return None


def _check_end(text: str, where: str) -> None:
    """Raise InputError where a file ends within its last number: no end of a line, and fewer decimals than all lines above have,
    or an end left of the column of characters in which their numbers at its place end.
    """
    *above, last = text.splitlines()[-_UNIFORM - 1 :]
    if text[-1:].isspace() or len(above) < _UNIFORM or not all(map(_NUMBERS.fullmatch, (*above, last))):
        return
    decimals = [len(match[1]) if (match := _DECIMALS.search(line)) else 0 for line in (*above, last)]
    place = len(last.split())
    padded = all(line[0] == " " and len(line.split()) >= place for line in above)
    ends = [[word.end() for word in _WORD.finditer(line)][place - 1] for line in (*above, last)] if padded else [0]
    for *others, own in (decimals, ends):
        if own < min(others, default=0) == max(others, default=0):
            wanted = "a last number as long as in the lines above"
            raise mistake(where, f"line {len(text.splitlines())}", wanted, repr(last.split()[-1]), CUT_OFF)


def _versions(text: str) -> Iterator[tuple[str, tuple[Finding, ...]]]:
    """The text; without its blank lines; with the blanks at the left that all lines share taken off; what is said of each."""
    yield text, ()
    lines = text.splitlines()
    indented = next((line for line in lines if line.strip()), "")[:1].isspace()
    if indented or not all(map(str.strip, lines)):
        filled = "\n".join(line for line in lines if line.strip())
        yield filled, (info("record_blank_lines"),)
        yield textwrap.dedent(filled.expandtabs()), (info("record_blanks"),)


def _with_proposal(error: InputError, text: str, where: str) -> InputError:
    """The error with the options that would read the text as plain numbers, where no unit is all that is missing."""
    first, headed = error.mistakes[0], table.names_times(text)
    if first.wanted == table.UNIT:
        return error
    try:
        said = table.proposal(text, where, headed=headed)
    except InputError as contradiction:
        return error if headed else contradiction
    if not said:
        return error
    advice = f"its numbers alone are read by: {said}; new and assess take the same options"
    return InputError(replace(first, advice=advice))


def read_record(path: Path, *, unit: str | None = None, layout: Layout | None = None) -> RecordFile:
    """The whole record: this file's channels, those of its sister files where a file holds one, and all findings."""
    record = read_file(path, unit=unit, layout=layout)
    sisters, unread = _read_sisters(record, path) if record.group else ([], [])
    channels = (*record.channels, *(channel for other in sisters for channel in other.channels))
    found = [*record.findings, *(each for other in sisters for each in other.findings), *unread]
    names = [channel.name for channel in channels]
    if len(set(names)) < len(names):
        channels, found = record.channels, [*record.findings, caution("record_sisters_repeat")]
    whole = replace(record, channels=channels)
    return replace(whole, findings=tuple(weighed([*found, *check(whole)])))


def _read_sisters(record: RecordFile, path: Path) -> tuple[list[RecordFile], list[Finding]]:
    """Other files of the same record, and what is to be said of those beside it that are damaged."""
    sisters: list[RecordFile] = []
    unread: list[Finding] = []
    for other in _sisters(path, _ENDINGS.get(record.format)):
        try:
            sister = read_file(other)
            check(sister)
        except InputError as error:
            name = ascii(other.name)[1:-1]
            message = str(error).splitlines()[0].removeprefix(f"{other}: ")
            unread.append(caution("record_sister_unread", file=name, message=message))
            continue
        if sister.group == record.group and sister.format == record.format:
            sisters.append(sister)
    return sisters, unread


def _sisters(path: Path, endings: str | None) -> list[Path]:
    """Files beside this one, sorted, whose names differ in their middle only, or in one of their network's `endings`."""

    def is_sister(other: Path) -> bool:
        if endings and re.fullmatch(endings, other.suffix, re.IGNORECASE):
            return other.stem == path.stem
        same = _alike(path.stem, other.stem)
        same += _alike(path.stem[same:][::-1], other.stem[same:][::-1])
        return other.suffix == path.suffix and same >= _ALIKE * max(len(path.stem), len(other.stem))

    # Of a folder that may be entered but not listed it gives none: the file itself was read.
    return [other for other in sorted(path.parent.glob("*")) if other != path and other.is_file() and is_sister(other)]


def _alike(one: str, other: str) -> int:
    """Number of letters with which both begin."""
    pairs = zip(one, other, strict=False)
    return next((i for i, (a, b) in enumerate(pairs) if a != b), min(len(one), len(other)))
