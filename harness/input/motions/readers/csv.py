"""CSV and plain columns: a time column and one column or more of acceleration, the unit in the headers or given."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.input.motions.clock import clock_of
from harness.input.motions.orientation import Orientation, parse_orientation
from harness.input.motions.recordfile import UNITS_M_S2, Channel, RecordFile, unit_named
from harness.input.motions.text import mistake
from harness.input.text_file import decimal, decimals

FORMATS: Final = {"CSV": True}

_TIME = re.compile(r"^(t|time|zeit|tempo|temps|tiempo)([\s_\-]*[\[(]?(s|sec|seconds)?[\])]?)$", re.IGNORECASE)
_PREFIX = re.compile(r"^(acc(el(eration)?)?|a)[\s_\-]+", re.IGNORECASE)
_UNIT = re.compile(r"^(.*?)[\s_\-]*[\[(\s_\-]([cm]?m_s2|[a-z]+[a-z0-9²^/*]*)[\])]?$", re.IGNORECASE)
_COMMENT: Final = ("#", "%")
_DECIMAL_COMMA = re.compile(r"[+-]?[0-9]*,[0-9]+(?:[eE][+-]?[0-9]+)?|[+-]?[0-9]+")


@dataclass(frozen=True)
class _Table:
    """Headers, values (n, k) and the file's line of every row."""

    headers: tuple[str, ...]
    values: NDArray[np.float64]
    lines: tuple[int, ...]


def recognises(text: str) -> bool:
    """Whether the last row that is no comment begins with a number."""
    rows = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith(_COMMENT)]
    return bool(rows) and bool(re.match(r"^\s*[+-]?[.,]?\d", rows[-1]))


def names_times(text: str) -> bool:
    """Whether a line names a column of times, so that the file is a table with headers, whatever else is wrong with it."""
    return any(_TIME.match(part.strip('" ')) for line in text.splitlines() for part in _split(line.lstrip(" #%")))


def read(text: str, where: str, *, unit: str | None = None) -> RecordFile:
    """Every acceleration column; `unit` is used where the headers name none. InputError for gaps, NaN, unsorted times."""
    table = _table(text, where)
    time = _time_column(table, where)
    clock = clock_of(table.values[:, time], where, table.lines)
    channels: list[Channel] = []
    units: set[str] = set()
    for column, header in enumerate(table.headers):
        if column == time:
            continue
        name, orientation, stated = _column(header)
        if stated is not None and unit is not None and stated != unit:
            raise mistake(where, header, f"the unit that the file states, {stated}", unit, "leave unit out")
        used = stated or unit
        if used is None:
            advice = f"say unit = one of {', '.join(UNITS_M_S2)}, or name the column such as a_{name or 'x'}_ms2"
            raise mistake(where, header, "an acceleration unit", "none in the header and none given", advice)
        units.add(used)
        values = clock.on(table.values[:, column])
        channels.append(Channel.read(header, orientation, clock.dt_s, values, used, start_s=clock.start_s))
    if not channels:
        raise mistake(where, "", "a time column and an acceleration column", f"only {table.headers[time]!r}")
    return RecordFile(where, "CSV", True, "/".join(sorted(units)), tuple(channels), {}, warnings=clock.said)


def _column(header: str) -> tuple[str, Orientation, str | None]:
    """Direction's name, direction and unit stated by a column's header such as a_N28W_ms2 or "UP (g)"."""
    match = _UNIT.match(header)
    unit = unit_named(match.group(2)) if match else None
    name = _PREFIX.sub("", match.group(1) if match and unit else header)
    return name, parse_orientation(name), unit


def _split(line: str, decimal_comma: bool = False) -> list[str]:
    """The cells of a line; commas are decimal ones where `decimal_comma`."""
    for mark in (";", "\t", *(() if decimal_comma else ",")):
        if mark in line:
            return [part.strip() for part in line.split(mark)]
    return line.split()


def _has_decimal_commas(line: str) -> bool:
    """Whether the cells of a line between semicolons, tabs or blanks are all numbers with a decimal comma, or whole ones."""
    cells = [cell for cell in _split(line, True) if cell]
    return "," in line and len(cells) > 1 and all(_DECIMAL_COMMA.fullmatch(cell) for cell in cells)


def _numeric(part: str) -> bool:
    try:
        decimal(part)
    except ValueError:
        return False
    return True


def _table(text: str, where: str) -> _Table:
    every = [(i + 1, line) for i, line in enumerate(text.splitlines()) if line.strip()]
    rows = [(i, line) for i, line in every if not line.lstrip().startswith(_COMMENT)]
    comma = _has_decimal_commas(rows[-1][1])

    def cells(line: str) -> list[str]:
        return [part.replace(",", ".") for part in _split(line, True)] if comma else _split(line)

    first = _split(rows[0][1]) if comma and not _has_decimal_commas(rows[0][1]) else cells(rows[0][1])
    trailing = first[-1] == ""  # every line ends with the separator
    first = first[:-1] if trailing else first
    headed = not all(_numeric(part) for part in first)
    body = rows[1:] if headed else rows
    headers = tuple(part.strip('"') for part in first) if headed else _commented(every, rows[0][0], len(first))
    if len(set(headers)) < len(headers):
        raise mistake(where, f"line {rows[0][0]}", "column headers that differ", ", ".join(headers))
    if len(body) < 2:
        raise mistake(where, "", "two samples or more", str(len(body)), "the file holds no motion")
    values = np.empty((len(body), len(headers)))
    for row, (number, line) in enumerate(body):
        parts = cells(line)[:-1] if trailing else cells(line)
        if len(parts) != len(headers):
            advice = "the file is cut off" if row == len(body) - 1 else "the file is damaged, or has decimal commas"
            raise mistake(where, f"line {number}", f"{len(headers)} columns", str(len(parts)), advice)
        try:
            values[row] = decimals(parts)
        except ValueError:
            header, bad = next(pair for pair in zip(headers, parts, strict=True) if not _numeric(pair[1]))
            place, advice = f"line {number}, {header}", "fill or cut a gap in the program that made the record"
            raise mistake(where, place, "a finite number with a decimal point", repr(bad), advice) from None
    if not np.isfinite(values).all():
        row, column = (int(i[0]) for i in np.nonzero(~np.isfinite(values)))
        advice = "fill or cut the gap in the program that made the record"
        raise mistake(
            where, f"line {body[row][0]}, {headers[column]}", "a finite number", str(values[row, column]), advice
        )
    return _Table(headers, values, tuple(number for number, _ in body))


def _commented(every: list[tuple[int, str]], first: int, count: int) -> tuple[str, ...]:
    """Headers of columns that no header line names: the last comment above row `first` that names `count` of them, one the time.

    Without such a comment the columns are numbered.
    """
    for line in reversed([line for number, line in every if number < first]):
        names = tuple(part.strip('"') for part in _split(line.lstrip(" #%")))
        if len(names) == count and any(_TIME.match(name) for name in names):
            return names
    return tuple(str(place + 1) for place in range(count))


def _time_column(table: _Table, where: str) -> int:
    named = [i for i, header in enumerate(table.headers) if _TIME.match(header)]
    if named:
        return named[0]
    if table.headers[0] == "1" and len(table.headers) > 1:
        return 0
    advice = "name the column of times t_s"
    raise mistake(where, "", "a column of times", f"the columns {', '.join(table.headers)}", advice)
