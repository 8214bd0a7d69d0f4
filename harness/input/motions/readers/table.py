"""Any text of numbers, as the user says that it is laid out; and the options that fit a text no reader knows."""

from __future__ import annotations

import re
import shlex
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.input.motions.clock import clock_of
from harness.input.motions.layout import WHOLE, Layout
from harness.input.motions.orientation import Orientation, parse_orientation
from harness.input.motions.recordfile import (
    STANDARD_GRAVITY_M_S2,
    UNIT_NAMES,
    UNITS_M_S2,
    Channel,
    RecordFile,
    unit_named,
)
from harness.input.motions.text import free_format, mistake
from harness.model.errors import InputError

Floats = NDArray[np.float64]

_LEAST_NUMBERS: Final = 16
"""Fewer numbers in a row of lines are a header's."""
_HEADER_ROWS: Final = 8
"""Lines of as many numbers as the columns that a header may hold; more are data before a damaged line."""
_PLAUSIBLE_G: Final = (0.005, 3.0)
_STEPS: Final = (
    (re.compile(r"\b(?:dt|delta\s*t|step|interval)\b[^0-9.\n]{0,20}(\d*\.\d+(?:[eE][-+]?\d+)?)", re.IGNORECASE), False),
    (re.compile(r"(\d*\.\d+)\s*s(?:ec)?\b", re.IGNORECASE), False),
    (re.compile(r"(\d+(?:\.\d+)?)\s*(?:hz|sps|samples?\s*(?:/|per)\s*s)", re.IGNORECASE), True),
)
_UNIT_WORDS = re.compile(r"(?<![\w/])(?:c?m+/s\S*|gals?|g)(?![\w/])", re.IGNORECASE)


def read(text: str, where: str, *, unit: str | None, layout: Layout) -> RecordFile:
    """The channels of a text whose layout and unit the user gives; InputError naming what is missing, and the line at fault."""
    if unit is None:
        raise mistake(where, "unit", UNIT_NAMES, "none", "say --unit, or unit = in a scene")
    if (layout.dt_s is None) == (layout.time_column is None):
        got = "neither" if layout.dt_s is None else "both"
        raise mistake(where, "dt, time_column", "the step, or the column of times", got, "say --dt or --time-column")
    skip = layout.skip_lines or 0
    rows, places = _rows(text.splitlines(), skip, where)
    if layout.columns == WHOLE:
        if layout.dt_s is None:
            raise mistake(
                where, "columns", "--dt beside --columns all", "a time column", "numbers that run on have none"
            )
        named, table = {0: "1"}, np.concatenate(rows)[:, None]
    else:
        table = _even_rows(rows, places, where)
        named = _named(layout, table.shape[1], where)
    if layout.time_column is None:
        dt_s, start_s = float(layout.dt_s or 0.0), 0.0
        said: tuple[str, ...] = ()
    else:
        clock = clock_of(table[:, layout.time_column - 1], where, tuple(places))
        table = np.column_stack([clock.on(table[:, column]) for column in range(table.shape[1])])
        dt_s, start_s, said = clock.dt_s, clock.start_s, clock.said
    channels = [
        Channel.read(name, _direction(name), dt_s, table[:, column], unit, start_s=start_s)
        for column, name in named.items()
    ]
    return RecordFile(where, "numbers as described", True, unit, tuple(channels), {}, warnings=said)


def _direction(name: str) -> Orientation:
    return Orientation() if name.isdigit() and len(name) < 3 else parse_orientation(name)


def _cells(line: str) -> list[str]:
    """The words of a line, with semicolons, tabs or commas between them; decimal commas where no comma can stand between."""
    plain = line.strip().strip(";,")
    if ";" in plain or "\t" in plain or all(word.count(",") == 1 for word in plain.split()):
        return re.split(r"[;\s]+", plain.replace(",", "."))
    return re.split(r"\s*,\s*|\s+", plain)


def _numbers(line: str, where: str, number: int) -> Floats:
    """All numbers of a line; InputError at anything else."""
    return free_format([" ".join(_cells(line))], where=where, first_line=number)


def _rows(lines: Sequence[str], skip: int, where: str) -> tuple[list[Floats], list[int]]:
    """The numbers of every line below the first `skip`, and the lines' places; comments and blank lines are left out."""
    used = [
        (i + 1, line) for i, line in enumerate(lines) if i >= skip and line.strip() and line.lstrip()[0] not in "#%"
    ]
    rows = [_numbers(line, where, number) for number, line in used]
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
        if not number.strip().isdigit() or not 1 <= int(number) <= width or int(number) == time:
            wanted = f'columns from 1 to {width} but the times\', such as "2,3" or "2:N,3:E", or "{WHOLE}"'
            raise mistake(where, "columns", wanted, repr(layout.columns))
        named[int(number) - 1] = name.strip() or number.strip()
    if len(set(named.values())) < len(layout.columns.split(",")):
        raise mistake(where, "columns", "columns and names that differ", repr(layout.columns))
    return named


def proposal(text: str, where: str) -> str:
    """What to type so that the text is read as the table of numbers that it seems to be; "" where it seems to be none."""
    lines = text.splitlines()
    block = _block(lines)
    if block is None:
        return ""
    skip, rows = block
    width = rows[0].size
    even = [row for row in rows if row.size == width]
    table, head = np.array(even), "\n".join(lines[:skip])
    steps = np.diff(table[:, 0])
    if width > 1 and len(even) == len(rows) > 2 and (steps > 0.0).all() and steps.max() < 1.5 * steps.min():
        layout = Layout(skip_lines=skip, time_column=1)
        samples = table[:, 1:]
    else:
        samples = np.concatenate(rows)
        runs_on = width > 1 and (
            len(even) < len(rows) or _rough(samples) < float(np.mean([_rough(c) for c in table.T]))
        )
        layout = Layout(_step(head), skip, WHOLE if runs_on or width == 1 else None)
    unit, remark = _unit(head, float(np.abs(samples).max()))
    if not (layout.time_column or layout.dt_s):
        layout, remark = replace(layout, dt_s=0.01), f"--dt as its source says{remark and f'; {remark}'}"
    command = f"rockcheck motion inspect {shlex.quote(where)} {layout.options()} --unit {unit}"
    return f"{command} ({remark})" if remark else command


def _rough(values: Floats) -> float:
    """Mean step from number to number in standard deviations: small where neighbours follow each other in time."""
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
        return _numbers(line, "", 0)
    except InputError:
        return None


def _step(head: str) -> float | None:
    """The step in seconds that the lines above the numbers speak of."""
    for pattern, rate in _STEPS:
        for text in pattern.findall(head):
            value = float(text)
            if value > 0.0 and 1e-4 <= (dt_s := 1.0 / value if rate else value) <= 0.1:
                return dt_s
    return None


def _unit(head: str, largest: float) -> tuple[str, str]:
    """The unit that the lines above the numbers name, else the first in which they would be an earthquake, and the others."""
    for word in _UNIT_WORDS.findall(head):
        if unit := unit_named(word):
            return unit, ""
    low, high = _PLAUSIBLE_G
    peaks = {name: largest * factor / STANDARD_GRAVITY_M_S2 for name, factor in UNITS_M_S2.items()}
    fits = [name for name, peak in peaks.items() if low <= peak <= high] or ["g"]
    said = ", ".join(f"{peaks[name]:.2g} g in {name}" for name in fits)
    return fits[0], f"--unit as its source says: the peak is {said}"
