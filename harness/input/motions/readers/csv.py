"""CSV and plain columns: a time column and one column or more of acceleration, the unit in the headers or given."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.input.motions.orientation import Orientation, parse_orientation
from harness.input.motions.recordfile import UNITS_M_S2, Channel, RecordFile
from harness.input.motions.text import mistake
from harness.input.text_file import decimal, decimals

NAME: Final = "CSV"
TESTED_ON_ORIGINALS: Final = True

_UNIT_ENDINGS: Final = {
    "ms2": "m/s2", "m/s2": "m/s2", "m/s^2": "m/s2", "m/s/s": "m/s2", "mps2": "m/s2", "m/s²": "m/s2",
    "cms2": "cm/s2", "cm/s2": "cm/s2", "cm/s^2": "cm/s2", "cm/s/s": "cm/s2", "cm/s²": "cm/s2", "gal": "cm/s2",
    "mms2": "mm/s2", "mm/s2": "mm/s2", "mm/s^2": "mm/s2", "mm/s/s": "mm/s2", "mm/s²": "mm/s2",
    "g": "g",
}  # fmt: skip
_TIME = re.compile(r"^(t|time|zeit|tempo)([\s_\-]*[\[(]?(s|sec|seconds)?[\])]?)$", re.IGNORECASE)
_PREFIX = re.compile(r"^(acc(el(eration)?)?|a)[\s_\-]+", re.IGNORECASE)
_COMMENT: Final = ("#", "%")
_JITTER = 0.02  # of a step: times printed with few digits
_GAP = 5.0  # steps


@dataclass(frozen=True)
class _Table:
    """Headers, values (n, k) and the file's line of every row."""

    headers: tuple[str, ...]
    values: NDArray[np.float64]
    lines: tuple[int, ...]


def recognises(text: str) -> bool:
    """Whether the last row that is no comment begins with a number."""
    rows = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith(_COMMENT)]
    return bool(rows) and bool(re.match(r"^\s*[+-]?\.?\d", rows[-1]))


def read(text: str, where: str, *, unit: str | None = None) -> RecordFile:
    """Every acceleration column; `unit` is used where the headers name none. InputError for gaps, NaN, unsorted times."""
    table = _table(text, where)
    time = _time_column(table, where)
    t_s, dt_s, warnings = _uniform(table, time, where)
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
        samples = table.values[:, column] * UNITS_M_S2[used] * orientation.sign
        if t_s is not None:
            uneven = table.values[:, time]
            samples = np.interp(t_s, uneven, samples)
        start = float(table.values[0, time])
        channels.append(Channel(header, orientation, dt_s, samples, start))
    if not channels:
        raise mistake(where, "", "a time column and an acceleration column", f"only {table.headers[time]!r}")
    return RecordFile(where, NAME, TESTED_ON_ORIGINALS, "/".join(sorted(units)), tuple(channels), {}, warnings=warnings)


def _column(header: str) -> tuple[str, Orientation, str | None]:
    """Direction's name, direction and unit stated by a column's header such as a_N28W_ms2 or "UP (g)"."""
    unit: str | None = None
    name = header
    for ending in sorted(_UNIT_ENDINGS, key=len, reverse=True):
        match = re.match(r"^(.*?)[\s_\-]*[\[(\s_\-]" + re.escape(ending) + r"[\])]?$", header, re.IGNORECASE)
        if match:
            name, unit = match.group(1), _UNIT_ENDINGS[ending]
            break
    name = _PREFIX.sub("", name)
    return name, parse_orientation(name), unit


def _split(line: str) -> list[str]:
    for mark in (";", "\t", ","):
        if mark in line:
            return [part.strip() for part in line.split(mark)]
    return line.split()


def _numeric(part: str) -> bool:
    try:
        decimal(part)
    except ValueError:
        return False
    return True


def _table(text: str, where: str) -> _Table:
    every = [(i + 1, line) for i, line in enumerate(text.splitlines()) if line.strip()]
    rows = [(i, line) for i, line in every if not line.lstrip().startswith(_COMMENT)]
    first = _split(rows[0][1])
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
        parts = _split(line)[:-1] if trailing else _split(line)
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


def _uniform(table: _Table, column: int, where: str) -> tuple[NDArray[np.float64] | None, float, tuple[str, ...]]:
    """New uniform times where the file's are uneven (else None), the step, and what was found."""
    t_s = table.values[:, column]
    steps = np.diff(t_s)
    if (steps <= 0.0).any():
        row = int(np.flatnonzero(steps <= 0.0)[0]) + 1
        got = f"{t_s[row]:g} s after {t_s[row - 1]:g} s"
        raise mistake(where, f"line {table.lines[row]}", "increasing times", got, "sort the rows and drop doubled ones")
    dt_s = float(np.median(steps))
    if steps.max() > _GAP * dt_s:
        row = int(np.argmax(steps)) + 1
        got = f"a gap of {steps[row - 1]:g} s from {t_s[row - 1]:g} s"
        raise mistake(
            where, f"line {table.lines[row]}", f"a step of about {dt_s:g} s", got, "cut the record there or fill it"
        )
    exact = float((t_s[-1] - t_s[0]) / (t_s.size - 1))
    if np.abs(t_s - t_s[0] - exact * np.arange(t_s.size)).max() <= _JITTER * exact:
        return None, round(exact, 9), ()
    fine = float(steps.min())
    count = round(float(t_s[-1] - t_s[0]) / fine) + 1
    fine = float((t_s[-1] - t_s[0]) / (count - 1))
    said = f"uneven steps, {steps.min():g} to {steps.max():g} s: interpolated linearly at {fine:.6g} s"
    return t_s[0] + fine * np.arange(count), fine, (said,)
