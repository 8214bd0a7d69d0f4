"""Any text of numbers, as the user says that it is laid out; and the options that fit a text no reader knows."""

from __future__ import annotations

import re
import shlex
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from harness.input.motions.clock import clock_of
from harness.input.motions.orientation import Orientation, parse_orientation
from harness.input.motions.recordfile import (
    STANDARD_GRAVITY_M_S2,
    UNIT_NAMES,
    UNITS_M_S2,
    WHOLE,
    Channel,
    Layout,
    RecordFile,
    unit_named,
)
from harness.input.motions.series import Floats
from harness.input.motions.text import free_format, mistake
from harness.model.errors import InputError

_LEAST_NUMBERS: Final = 16
"""Fewer numbers in a row of lines are a header's."""
_HEADER_ROWS: Final = 8
"""Lines of as many numbers as the columns that a header may hold; more are data before a damaged line."""
_PLAUSIBLE_G: Final = (0.005, 3.0)
_SHORTEST_S, _LONGEST_S = 1e-4, 0.1
"""Between the steps of accelerographs, 1 to 50 ms, and what no text means by a step."""
_PLACE = re.compile(r"[0-9]{1,9}")
_DATE = re.compile(r"\d{1,4}[-/.]\d{1,2}[-/.]\d{1,4}(?:[T_]\d\S*)?|\d{1,2}:\d\d(?::\d\d(?:[.,]\d*)?)?Z?")
LABEL = re.compile(r"(?!(?:nan|inf|infinity|null|none|na|n/a)$)[^\W\d_]", re.IGNORECASE)
"""How a word of a column of flags, stations or remarks begins, which is no number that is missing."""
_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+(?:[eE][-+]?\d+)?")
_TIME_OF_DAY = re.compile(r"(?<!\d)(\d{1,2}):(\d\d):(\d\d(?:[.,]\d+)?)")
_STEPS: Final = (
    (re.compile(r"\b(?:dt|delta\s*t|step|interval)\b[^0-9.\n]{0,20}(\d*\.\d+(?:[eE][-+]?\d+)?)", re.IGNORECASE), False),
    (re.compile(r"(\d*\.\d+)\s*s(?:ec)?\b", re.IGNORECASE), False),
    (re.compile(r"(\d+(?:\.\d+)?)\s*(?:hz|sps|samples?\s*(?:/|per)\s*s)", re.IGNORECASE), True),
)
_UNIT_WORDS = re.compile(r"(?<![\w/])(?:c?m+/s\S*|gals?|%?g|(?<=[(\[])mg)(?![\w/])", re.IGNORECASE)


def read(text: str, where: str, *, unit: str | None, layout: Layout) -> RecordFile:
    """The channels of a text whose layout and unit the user gives; InputError naming what is missing, and the line at fault."""
    if unit is None:
        raise mistake(where, "unit", UNIT_NAMES, "none", "say --motion-unit, or unit = in a scene")
    if (layout.dt_s is None) == (layout.time_column is None):
        got = "neither" if layout.dt_s is None else "both"
        raise mistake(where, "dt, time_column", "the step, or the column of times", got, "say --dt or --time-column")
    skip = layout.skip_lines or 0
    chosen = layout.columns not in (None, WHOLE)
    rows, places = _rows(text.splitlines(), skip, where, other=chosen)
    if layout.columns == WHOLE:
        if layout.dt_s is None:
            raise mistake(
                where, "columns", "--dt beside --columns all", "a time column", "numbers that run on have none"
            )
        named, table = {0: "1"}, np.concatenate(rows)[:, None]
    else:
        table = _even_rows(rows, places, where)
        named = _named(layout, table.shape[1], where)
        if dated := [name for column, name in named.items() if np.isnan(table[:, column]).any()]:
            raise mistake(where, "columns", "columns of numbers", f"dates, times of day or words in {', '.join(dated)}")
    if layout.time_column is None:
        dt_s, start_s = float(layout.dt_s or 0.0), 0.0
        said: tuple[str, ...] = ()
    else:
        times = table[:, layout.time_column - 1]
        if np.isnan(times).any():
            raise mistake(where, "time_column", "times in seconds", "dates, times of day or words", "say --dt instead")
        clock = clock_of(times, where, tuple(places))
        table = np.column_stack([clock.on(table[:, column]) for column in range(table.shape[1])])
        dt_s, start_s, said = clock.dt_s, clock.start_s, clock.said
    channels = [
        Channel.read(name, _direction(name), dt_s, table[:, column], unit, start_s=start_s)
        for column, name in named.items()
    ]
    return RecordFile(where, "numbers as described", unit, tuple(channels), {}, warnings=said)


def _direction(name: str) -> Orientation:
    return Orientation() if name.isdigit() and len(name) < 3 else parse_orientation(name)


def _cells(line: str) -> list[str]:
    """The words of a line, with semicolons, tabs or commas between them; decimal commas where no comma can stand between."""
    plain = line.strip().strip(";,")
    if ";" in plain or "\t" in plain or all(map(_DECIMAL_COMMA.fullmatch, plain.split())):
        return re.split(r"[;\s]+", plain.replace(",", "."))
    return re.split(r"\s*,\s*|\s+", plain)


def _numbers(line: str, where: str, number: int, *, dates: bool = False, words: bool = False) -> Floats:
    """All numbers of a line; NaN for dates and times of day, or words, where they may stand; InputError at anything else."""
    cells = _cells(line)
    other = {
        place for place, cell in enumerate(cells) if (dates and _DATE.fullmatch(cell)) or (words and LABEL.match(cell))
    }
    if not other or len(other) == len(cells):
        return free_format([" ".join(cells)], where=where, first_line=number)
    values = np.full(len(cells), np.nan)
    for place in set(range(len(cells))) - other:
        values[place : place + 1] = free_format([cells[place]], where=where, first_line=number)[:1]
    return values


def _rows(lines: Sequence[str], skip: int, where: str, *, other: bool) -> tuple[list[Floats], list[int]]:
    """The numbers of every line below the first `skip`, and the lines' places; comments and blank lines are left out.

    Where `other` than numbers may stand in columns that are not asked for, dates, times of day and words are NaN.
    """
    used = [
        (i + 1, line) for i, line in enumerate(lines) if i >= skip and line.strip() and line.lstrip()[0] not in "#%"
    ]
    rows = [_numbers(line, where, number, dates=other, words=other) for number, line in used]
    if sum(row.size for row in rows) < 2:
        raise mistake(where, "skip_lines", "numbers below the lines skipped", f"{len(lines)} lines in all")
    return rows, [number for number, _ in used]


def _even_rows(rows: list[Floats], places: list[int], where: str) -> Floats:
    width = rows[0].size
    for row, place in zip(rows, places, strict=True):
        if row.size != width:
            advice = f"say --columns {WHOLE} where the numbers of one channel run on from line to line"
            raise mistake(where, f"line {place}", f"{width} columns, as the first line has", str(row.size), advice)
    return np.array(rows)


def _named(layout: Layout, width: int, where: str) -> dict[int, str]:
    """The columns (from 0) that hold accelerations, with their names."""
    time = layout.time_column
    if time is not None and not 1 <= time <= width:
        raise mistake(where, "time_column", f"a column from 1 to {width}", str(time))
    if layout.columns is None:
        return {column: str(column + 1) for column in range(width) if column + 1 != time}
    named: dict[int, str] = {}
    for part in layout.columns.split(","):
        number, _, name = part.strip().partition(":")
        if not _PLACE.fullmatch(number.strip()) or not 1 <= int(number) <= width or int(number) == time:
            wanted = f'columns from 1 to {width} but the times\', such as "2,3" or "2:N,3:E", or "{WHOLE}"'
            raise mistake(where, "columns", wanted, repr(layout.columns))
        named[int(number) - 1] = name.strip() or number.strip()
    if len(set(named.values())) < len(layout.columns.split(",")):
        raise mistake(where, "columns", "columns and names that differ", repr(layout.columns))
    return named


def proposal(text: str, where: str, *, headed: bool = False) -> str:
    """What to type so that the text is read as the table of numbers that it seems to be; "" where it seems to be none.

    Where it is `headed` by names, one of them the times', no line above the numbers may be one of theirs, damaged.
    """
    lines = text.splitlines()
    block = _block(lines)
    if block is None or (headed and any(_or_none(cell) is not None for cell in _cells(lines[block[0] - 1]))):
        return ""
    skip, rows = block
    head = "\n".join(lines[:skip])
    layout, samples = _layout(rows, skip, head)
    if not samples.size:
        return ""
    if samples.ndim == 2 and np.isnan(rows[0]).any():
        layout = replace(layout, dt_s=_dated_step([line for line in lines[skip:] if line.strip()][: len(rows)]))
    unit, remark = likely_unit(head, float(np.abs(samples).max()))
    if not unit:
        return ""
    if not (layout.time_column or layout.dt_s):
        layout, remark = (
            replace(layout, dt_s=0.01),
            f"--dt as its source says{remark and f'; --motion-unit if {remark}'}",
        )
    elif remark:
        remark = f"--motion-unit if {remark}"
    command = f"rockcheck motion inspect {shlex.quote(where)} {layout.options()} --motion-unit {unit}"
    return f"{command} ({remark})" if remark else command


def _layout(rows: list[Floats], skip: int, head: str) -> tuple[Layout, Floats]:
    """How `rows` below the lines `head` seem to be laid out, and the samples: in columns (n, k), or of one channel (n,)."""
    width = rows[0].size
    even = [row for row in rows if row.size == width]
    table = np.array(even)
    dated = np.isnan(table).any(axis=0)
    if dated.any() and len(even) == len(rows):
        names = _names(head, width)
        columns = ",".join(f"{i + 1}{names[i]}" for i in np.flatnonzero(~dated))
        return Layout(None, skip, columns), table[:, ~dated]
    steps = np.diff(table[:, 0])
    if width > 1 and len(even) == len(rows) > 2 and (steps > 0.0).all() and steps.max() < 1.5 * steps.min():
        return Layout(skip_lines=skip, time_column=1), table[:, 1:]
    samples = np.concatenate(rows)
    runs_on = width > 1 and (len(even) < len(rows) or _rough(samples) < float(np.mean([_rough(c) for c in table.T])))
    return Layout(_step(head, samples.size), skip, WHOLE if runs_on or width == 1 else None), samples


def _names(head: str, width: int) -> list[str]:
    """For every column ":" and the word that the last line above it names it by, or "" where that line names none."""
    last = re.sub(r"\s*[\[(][^\])]*[\])]", "", head.splitlines()[-1]) if head else ""
    words = [cell if re.fullmatch(r"\w+", cell) else "" for cell in _cells(last)]
    return [word and f":{word}" for word in words] if len(words) == width else [""] * width


def _dated_step(lines: Sequence[str]) -> float | None:
    """The step in seconds between lines that each hold a time of day, from the first and the last of them."""
    first, last = (_TIME_OF_DAY.search(line) for line in (lines[0], lines[-1]))
    if first is None or last is None:
        return None
    start, end = (3600.0 * float(m[1]) + 60.0 * float(m[2]) + float(m[3].replace(",", ".")) for m in (first, last))
    step = round((end - start) % 86400.0 / (len(lines) - 1), 6)
    return step if _SHORTEST_S <= step <= _LONGEST_S else None


def _rough(values: Floats) -> float:
    """Mean step from number to number in standard deviations: small where neighbours follow each other in time."""
    largest = float(np.abs(values).max(initial=0.0))
    if not 0.0 < largest < np.inf:
        return 0.0
    # Squares of what a damaged file may hold overflow; a share does not depend on the unit.
    values = values / largest
    spread = float(values.std())
    return float(np.abs(np.diff(values)).mean()) / spread if spread > 0.0 else 0.0


def _block(lines: Sequence[str]) -> tuple[int, list[Floats]] | None:
    """The last block of lines that hold numbers only, and the lines above it; None where such lines stand above it, too."""
    read = [_or_none(line) if line.strip() else np.empty(0) for line in lines]
    first = next((i + 1 for i in range(len(lines) - 1, -1, -1) if read[i] is None), 0)
    rows = [row for row in read[first:] if row is not None and row.size]
    wide = max((row.size for row in rows), default=0)
    while rows and rows[0].size < wide:  # a header's last line may be a number
        first += 1
        rows = [row for row in read[first:] if row is not None and row.size]
    above = sum(row is not None and row.size == wide for row in read[:first])
    few = sum(row.size for row in rows) < _LEAST_NUMBERS
    return None if few or above > _HEADER_ROWS else (first, rows)


def _or_none(line: str) -> Floats | None:
    try:
        return _numbers(line, "", 0, dates=True)
    except InputError:
        return None


def _step(head: str, count: int) -> float | None:
    """The step in seconds that the lines above the numbers speak of, or that stands beside their `count`."""
    for pattern, rate in _STEPS:
        for text in pattern.findall(head):
            value = float(text)
            if value > 0.0 and _SHORTEST_S <= (dt_s := 1.0 / value if rate else value) <= _LONGEST_S:
                return dt_s
    beside = [row for row in map(_or_none, head.splitlines()) if row is not None and count in row]
    return next((float(v) for row in beside for v in row if _SHORTEST_S <= v <= _LONGEST_S), None)


def likely_unit(head: str, largest: float) -> tuple[str, str]:
    """The unit that the lines above the numbers name, else the first in which they would be an earthquake, and the others.

    "" and why where they would be none in any unit.
    """
    for word in _UNIT_WORDS.findall(head):
        if unit := unit_named(word):
            return unit, ""
    low, high = _PLAUSIBLE_G
    peaks = {name: largest * factor / STANDARD_GRAVITY_M_S2 for name, factor in UNITS_M_S2.items()}
    fits = [name for name, peak in peaks.items() if low <= peak <= high]
    if not fits:
        return "", f"the largest, {largest:.3g}, is an earthquake's in none: counts need the recorder's factor first"
    return fits[0], f"its source says so: the peak is {', '.join(f'{peaks[name]:.2g} g in {name}' for name in fits)}"
