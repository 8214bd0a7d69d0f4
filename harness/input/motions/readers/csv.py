"""CSV and plain columns: a time column and one column or more of acceleration, the unit in the headers or given."""

import re
from collections import Counter
from collections.abc import Collection, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.input.files import is_decimal, numbers, numbers_at_once
from harness.input.motions.process import clock_of
from harness.input.motions.readers.table import (
    LABEL,
    NO_COMPONENT,
    SECONDS,
    content_lines,
    heading,
    is_unit,
    likely_unit,
)
from harness.input.motions.recordfile import UNIT_NAMES, Channel, RecordFile, mistake, refuse_fillers
from harness.model import info, require

_WORD = re.compile(r"\b(?!nan|inf|null)[^\W\d_]{3}", re.IGNORECASE)
_HEAD: Final = 2000
"""Characters at a file's beginning that may speak of a unit."""
UNIT: Final = "an acceleration unit"
_TIME = re.compile(
    rf"^(?:t|times?|elapsed(?:[\s_]time)?|seconds?|secs?|zeit|tempo|temps|tiempo|epoch|timestamp)[\s_\-]*[\[(]?({'|'.join(SECONDS)})?[\])]?$",
    re.IGNORECASE,
)
_OTHER_UNIT = re.compile(
    r"[\[(]([a-zµ]+/s\S*2|[a-zµ]+/s/s|[a-zµ]+ ?s-2)[\])]$|_((?:in|ft|km|um|nm|dm)_?s2)$", re.IGNORECASE
)
"""A unit of acceleration that is none of those which are read."""
_DECIMAL_COMMA = re.compile(r"[+-]?[0-9]*,[0-9]+(?:[eEdD][+-]?[0-9]+)?|[+-]?[0-9]+")


def recognises(text: str) -> bool:
    """Whether the last row that is no comment begins with a number."""
    rows = content_lines(text.splitlines())
    return bool(rows) and re.match(r"^\s*[+-]?[.,]?\d", rows[-1][1]) is not None


def names_times(text: str) -> bool:
    """Whether a line names a column of times among as many as most lines have: a table with headers, damaged or not."""
    lines = [_split(line.lstrip(" #%")) for line in text.splitlines() if line.strip()]
    usual = max(Counter(map(len, lines)).items(), key=lambda item: item[1], default=(0, 0))[0]
    return any(len(cells) == usual and _names_times(cells) for cells in lines)


def _names_times(cells: Sequence[str]) -> bool:
    return any(_TIME.match(cell) for cell in cells)


def read(text: str, where: str, *, unit: str | None = None) -> RecordFile:
    """Every acceleration column; `unit` is used where the headers name none. InputError for gaps, NaN, unsorted times."""
    headers, words, table, lines = _table(text, where)
    time = _time_column(headers, words, table, where)
    clock = clock_of(table[:, time] * _seconds(headers[time]), where, lines)
    channels: list[Channel] = []
    units: set[str] = set()
    counts = (np.diff(table, axis=0) == 1.0).all(axis=0) & (len(table) > 2)
    others = [
        header
        for header, counted in zip(headers, counts, strict=True)
        if header != headers[time] and (counted or header in words or NO_COMPONENT.search(header))
    ]
    for column, header in enumerate(headers):
        if column == time or header in others:
            continue
        orientation, stated = heading(header)
        wanted = f"the unit that the file states, {stated}"
        require(stated is None or unit in (None, stated), where, wanted, str(unit), "leave unit out", key=header)
        if stated is None and (other := _OTHER_UNIT.search(header)):
            raise mistake(where, header, UNIT_NAMES, other.group().strip("_()[]"), "convert the column")
        used = stated or unit
        if used is None:
            likely, said_so = likely_unit(text[:_HEAD], float(np.abs(table[:, column]).max()))
            advice = f'say --motion-unit {likely}, or unit = "{likely}" in a scene, if {said_so}' if likely else said_so
            raise mistake(where, header, UNIT, "none in the header and none given", advice)
        units.add(used)
        refuse_fillers(
            table[:, column],
            where,
            lambda row, name=header: f"line {lines[row]}, {name}",  # type: ignore[misc]
        )
        values = clock.on(table[:, column])
        channels.append(Channel.read(header, orientation, clock.dt_s, values, used, start_s=clock.start_s))
    require(channels, where, "a time column and an acceleration column", f"the columns {', '.join(headers)}")
    left_out = (info("record_column_left_out", column=each, words=each in words) for each in others)
    return RecordFile(where, "CSV", "/".join(sorted(units)), tuple(channels), {}, findings=(*clock.said, *left_out))


def _seconds(header: str) -> float:
    """The factor from the unit that a column of times names to seconds, one where it names none."""
    match = _TIME.match(header)
    return SECONDS[match.group(1).casefold()] if match and match.group(1) else 1.0


def _split(line: str, decimal_comma: bool = False) -> list[str]:
    """The cells of a line; commas are decimal ones where `decimal_comma`."""
    return [part.strip().strip('"') for part in line.split(_mark(line, decimal_comma))]


def _mark(line: str, decimal_comma: bool) -> str | None:
    """What stands between the cells of a line; None for blanks."""
    return next((each for each in (";", "\t", "|", *(() if decimal_comma else ",")) if each in line), None)


def _has_decimal_commas(line: str) -> bool:
    """Whether the cells of a line between semicolons, tabs or blanks are words, whole numbers, or ones with a decimal comma."""
    cells = [cell for cell in _split(line, True) if cell and not LABEL.match(cell)]
    return "," in line and len(cells) > 1 and all(_DECIMAL_COMMA.fullmatch(cell) for cell in cells)


def _table(text: str, where: str) -> tuple[tuple[str, ...], set[str], NDArray[np.float64], tuple[int, ...]]:
    """Headers, those of columns without numbers, values (n, k) and the file's line of every row."""
    every = [(number, line) for number, line in enumerate(text.splitlines(), 1) if line and not line.isspace()]
    rows = content_lines(text.splitlines())
    comma = _has_decimal_commas(rows[-1][1])

    def cells(line: str) -> list[str]:
        return [part.replace(",", ".") if comma else part for part in _split(line, comma)]

    rows = rows[_titles([line for _, line in rows], len(cells(rows[-1][1]))) :]
    first = _split(rows[0][1]) if comma and not _has_decimal_commas(rows[0][1]) else cells(rows[0][1])
    if not any(map(is_decimal, first)):
        first = _headers(rows[0][1], len(cells(rows[-1][1])))
    trailing = first[-1] == ""  # every line ends with the separator
    first = first[:-1] if trailing else first
    headed = not all(map(is_decimal, first)) and not _alike(first, cells(rows[min(1, len(rows) - 1)][1]))
    body = rows[1:] if headed else rows
    headers = tuple(first) if headed else _commented(every, rows[0][0], len(first))
    if headed and body and len(units := cells(body[0][1])[: len(headers)]) == len(headers) and all(map(is_unit, units)):
        headers, body = tuple(f"{name} ({unit})" for name, unit in zip(headers, units, strict=True)), body[1:]
    require(
        len(set(headers)) == len(headers),
        where,
        "column headers that differ",
        ", ".join(headers),
        key=f"line {rows[0][0]}",
    )
    require(len(body) >= 2, where, "two samples or more", str(len(body)), "the file holds no motion")
    places = tuple(number for number, _ in body)
    plain = [line.replace(",", ".") if comma else line for _, line in body]
    if (
        not trailing
        and (bulk := numbers_at_once(plain, _mark(body[0][1], comma))) is not None
        and bulk.shape[1] == len(headers)
    ):
        return headers, set(), bulk, places
    values = np.empty((len(body), len(headers)))
    split = [cells(line)[:-1] if trailing else cells(line) for _, line in body]
    words = _of_words(split, len(headers))
    for row, ((number, line), parts) in enumerate(zip(body, split, strict=True)):
        if not any(map(is_decimal, parts)) and _WORD.search(line):
            advice = f"words among numbers: take out line {number}, and what is not a number below it"
            raise mistake(where, f"line {number}", "numbers", repr(line.strip()[:60]), advice)
        if len(parts) != len(headers):
            damage = (
                "the file is damaged, or has decimal commas" if re.search(r"\d,\d", line) else "the file is damaged"
            )
            advice = "the file is cut off" if row == len(body) - 1 else damage
            raise mistake(where, f"line {number}", f"{len(headers)} columns", str(len(parts)), advice)
        parts = ["0" if column in words else part for column, part in enumerate(parts)] if words else parts
        values[row] = numbers(parts)
        if not (finite := np.isfinite(values[row])).all():
            column = int(np.argmin(finite))
            advice = "fill or cut a gap in the program that made the record"
            wanted = "a finite number with a decimal point"
            raise mistake(where, f"line {number}, {headers[column]}", wanted, repr(parts[column]), advice)
    return headers, {headers[column] for column in words}, values, places


def _alike(first: Sequence[str], second: Sequence[str]) -> bool:
    """Whether two lines hold words, and numbers too, in the same columns: then the first is no line of headers."""
    kinds = [
        ["number" if is_decimal(cell) else LABEL.match(cell) and "word" for cell in line] for line in (first, second)
    ]
    return kinds[0] == kinds[1] and {"number", "word"} == set(kinds[0])


def _of_words(rows: Sequence[Sequence[str]], width: int) -> set[int]:
    """The columns that hold words or nothing in every row, and words in one: flags, stations, remarks."""
    return {
        column
        for column in range(width)
        if all(len(row) == width and (not row[column] or LABEL.match(row[column])) for row in rows)
        and any(row[column] for row in rows)
    }


def _headers(line: str, width: int) -> list[str]:
    """The names in a line above `width` columns: where blanks stand between the columns, those with blanks of their own too."""
    names, apart = _split(line), re.split(r"\s{2,}|(?<=[\])])\s+", line.strip())
    return apart if len(names) > width == len(apart) > 1 else names


def _titles(lines: Sequence[str], width: int) -> int:
    """Number of lines of words above the one that names the columns, a column of times among them."""
    for place, line in enumerate(lines):
        names = _headers(line, width)
        if any(map(is_decimal, names)):
            return 0
        if len(names) == width and _names_times(names):
            return place
    return 0


def _commented(every: list[tuple[int, str]], first: int, count: int) -> tuple[str, ...]:
    """Headers of columns that no header line names: the last comment above row `first` that names `count` of them, one the time.

    Without such a comment the columns are numbered.
    """
    for line in reversed([line for number, line in every if number < first]):
        names = tuple(_headers(line.lstrip(" #%"), count))
        if len(names) == count and _names_times(names):
            return names
    return tuple(str(place + 1) for place in range(count))


def _time_column(headers: Sequence[str], words: Collection[str], table: NDArray[np.float64], where: str) -> int:
    named = [i for i, header in enumerate(headers) if _TIME.match(header) and header not in words]
    if named:
        return named[0]
    advice = "name the column of times t_s"
    if headers[0] == "1" and len(headers) > 1:
        if not (np.diff(table[:, 0]) == 1.0).all():
            return 0
        raise mistake(where, "column 1", "a column of times", "the samples' numbers, in steps of one", advice)
    raise mistake(where, "", "a column of times", f"the columns {', '.join(headers)}", advice)
