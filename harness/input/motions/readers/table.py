"""Any text of numbers: columns that its header names, or as a user says that it is laid out; and the options that fit one."""

import re
import shlex
from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.input.files import fortran, is_decimal, numbers, numbers_at_once
from harness.input.motions.process import SampleClock, clock_of
from harness.input.motions.recordfile import (
    STANDARD_GRAVITY_M_S2,
    UNIT_NAMES,
    UNITS_M_S2,
    WHOLE,
    Channel,
    ChannelOrientation,
    Floats,
    Layout,
    RecordFile,
    check,
    free_format,
    mistake,
    parse_orientation,
    refuse_fillers,
    unit_named,
)
from harness.model import InputError, info, require, required

_LEAST_NUMBERS: Final = 16
"""Fewer numbers in a row of lines are a header's."""
_HEADER_ROWS: Final = 8
"""Lines of as many numbers as the columns that a header may hold; more are data before a damaged line."""
_PLAUSIBLE_G: Final = (0.005, 3.0)
_SHORTEST_S, _LONGEST_S = _STEP = 1e-4, 0.1
"""Between the steps of accelerographs, 1 to 50 ms, and what no text means by a step."""
_LONGEST_LINE, _MOST_LINES = 500, 200
"""Of a header: what searching for words in it may cost."""
_ONE: Final = (1.0, np.inf)
"""Steps of a column of samples' numbers, or of milliseconds."""
_HEADER_NUMBERS: Final = 3
"""Lines of numbers alone, a count or a step, that stand under a header."""
CONTRADICTS: Final = "the file contradicts itself: look into its source"
_PLACE = re.compile(r"[0-9]{1,9}")
_DATE = re.compile(r"\d{1,4}[-/.]\d{1,2}[-/.]\d{1,4}(?:[T_]\d\S*)?|\d{1,2}:\d\d(?::\d\d(?:[.,]\d*)?)?Z?")
LABEL = re.compile(r"(?!(?:nan|inf|infinity|null|none|na|n/a)$)[^\W\d_]", re.IGNORECASE)
"""How a word of a column of flags, stations or remarks begins, which is not a missing number."""
_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+(?:[eEdD][-+]?\d+)?")
_TIME_OF_DAY = re.compile(r"(?<!\d)(\d{1,2}):(\d\d):(\d\d(?:[.,]\d+)?)")
_NUMBER = r"(?<![\d.])(\d{1,9}(?:\.\d{0,12})?(?:[eEdD][-+]?\d{1,3})?|\.\d{1,12}(?:[eEdD][-+]?\d{1,3})?)(?!\d)"
_NAMED_STEP = re.compile(
    r"\b(?:dt|delta[ _]*t|(?:time|sampling|sample)?[ _]*(?:step|interval|increment))\b[^0-9.]{0,20}"
    rf"{_NUMBER}\s*(m(?:illi)?s\w*)?"
    rf"|\b\d{{1,9}}[\s,]+{_NUMBER}[\s,]+NPTS\s*,\s*DT\b",
    re.IGNORECASE,
)
_RATE = re.compile(
    rf"{_NUMBER}\s*(?:hz|sps|samples?\s*(?:/|per)\s*s|(?:points|pts)\s*(?:/|per)\s*s)"
    rf"|(?:\brate|\bfs|\bsps|frequency|samples?\s*(?:/|per)\s*s\w*)\b[^0-9.]{{0,20}}{_NUMBER}",
    re.IGNORECASE,
)
_SECONDS = re.compile(rf"{_NUMBER}\s*s(?:ec\w*)?\b", re.IGNORECASE)
_OTHER_TIMES = re.compile(
    r"filt|pass|corner|cut|natural|period|damp|peak|max|min|pga|freq|instr|durat|length", re.IGNORECASE
)
"""Lines that speak of a filter, an instrument or a peak have hertz and seconds that are no step's."""
_SAMPLING = re.compile(r"sampl|\brate|\bsps\b|\bfs\b|points|pts", re.IGNORECASE)
_COUNT = re.compile(
    r"(?:\bnpts|\bndata|\bnpoints|(?:no\.?|number|num\.?) of (?:points|samples|data|values)(?: points)?)\b"
    r"[^0-9\n]{0,12}(\d{1,9})\b"
    r"|\b(\d{1,9})[\s,]+\S{1,20}[\s,]+NPTS\s*,\s*DT\b|\b(\d{1,9})\s+(?:data )?(?:points|samples|values|pts)\b(?!\s*(?:/|per))",
    re.IGNORECASE,
)
SECONDS: Final = {"s": 1.0, "sec": 1.0, "seconds": 1.0, "ms": 1e-3, "msec": 1e-3, "us": 1e-6, "min": 60.0}
"""Units of a column of times."""
_SAME: Final = 0.01
"""Steps that differ by less are one, rounded."""
_RISING: Final = 0.95
"""Share of a clock's steps that do not fall; an acceleration's do in half of them."""
NO_COMPONENT = re.compile(
    r"^(index|sample|absolute|total|magnitude|vel|disp)|[\[(]([cm]?m(/s(ec)?)?|volts?|m?v|counts?)[\])]$|_[cm]?ms?$",
    re.IGNORECASE,
)
"""Headers of a sample's number, a resultant, a velocity, a displacement, or a recorder's volts and counts."""
_PREFIX = re.compile(r"^(acc(el(eration)?)?|a)[\s_\-]+", re.IGNORECASE)
_UNIT = re.compile(r"^(.*?)[\s_\-]*[\[(\s_\-]([cm]?m_s2|[cm]?m ?s\^?-2|[a-z%]+[a-z0-9²⁻·^/*]*)[\])]?$", re.IGNORECASE)
_UNIT_WORDS = re.compile(
    r"(?<![\w/.])(?<!\d\s)(?:c?m+/s\S*|c?m+ ?s\^?-2|gals?|%?g|(?<=[(\[])mg)(?![\w/])", re.IGNORECASE
)
"""Units, but of a number that stands before them: a peak of 0.3 g says nothing of the samples."""


def heading(header: str) -> tuple[ChannelOrientation, str | None]:
    """Direction and unit stated by a column's header such as a_N28W_ms2 or "UP (g)"."""
    if len(header) > _LONGEST_LINE:
        return ChannelOrientation(), None
    match = _UNIT.match(header)
    unit = unit_named(match.group(2)) if match else None
    name = _PREFIX.sub("", match.group(1) if match and unit else header)
    return parse_orientation(name), unit


def is_unit(cell: str) -> bool:
    """Whether a cell names a unit of time or of acceleration."""
    bare = cell.strip("[]() ").lower()
    return bare in SECONDS or unit_named(bare) is not None


def described(text: str, where: str, *, unit: str | None, layout: Layout) -> RecordFile:
    """The channels of a text whose layout and unit the user gives; InputError naming what is missing, and the line at fault."""
    unit = required(unit, where, UNIT_NAMES, "none", "say --motion-unit, or unit = in a scene", key="unit")
    require(
        (layout.dt_s is None) != (layout.time_column is None),
        where,
        "the step, or the column of times",
        "neither" if layout.dt_s is None else "both",
        "say --dt or --time-column",
        key="dt, time_column",
    )
    skip = layout.skip_lines or 0
    chosen = layout.columns not in (None, WHOLE)
    rows, places = _rows(text.splitlines(), skip, where, other=chosen)
    if layout.columns == WHOLE:
        require(
            layout.dt_s is not None,
            where,
            "--dt beside --columns all",
            "a time column",
            "numbers that run on have none",
            key="columns",
        )
        named, table = {0: "1"}, np.concatenate(rows)[:, None]
    else:
        table = _even_rows(rows, places, where)
        named = _named(layout, table.shape[1], where)
        if dated := [name for column, name in named.items() if np.isnan(table[:, column]).any()]:
            raise mistake(where, "columns", "columns of numbers", f"dates, times of day or words in {', '.join(dated)}")
    headers = _headers("\n".join(text.splitlines()[:skip]), table.shape[1])
    for column, name in named.items():
        stated = heading(headers[column])[1]
        require(
            stated in (None, unit),
            where,
            f"the unit that the file states, {stated}",
            unit,
            "say that one",
            key=headers[column],
        )
        refuse_fillers(
            table[:, column],
            where,
            lambda row, name=name: f"number {row + 1}" if layout.columns == WHOLE else f"line {places[row]}, {name}",  # type: ignore[misc]
        )
    clock = SampleClock(0.0, float(layout.dt_s or 0.0), len(table))
    if layout.time_column is not None:
        times = table[:, layout.time_column - 1]
        require(
            not np.isnan(times).any(),
            where,
            "times in seconds",
            "dates, times of day or words",
            "say --dt instead",
            key="time_column",
        )
        clock = clock_of(times, where, tuple(places))
    channels = [
        Channel.read(name, _direction(name), clock.dt_s, clock.on(table[:, column]), unit, start_s=clock.start_s)
        for column, name in named.items()
    ]
    return RecordFile(where, "numbers as described", unit, tuple(channels), {}, findings=clock.said)


def _direction(name: str) -> ChannelOrientation:
    return ChannelOrientation() if name.isdigit() and len(name) < 3 else parse_orientation(name)


def _cells(line: str) -> list[str]:
    """The words of a line, with semicolons, tabs or commas between them; decimal commas where no comma can stand between."""
    plain = line.strip().strip(";,")
    if ";" in plain or "\t" in plain or all(map(_DECIMAL_COMMA.fullmatch, plain.split())):
        return re.split(r"[;\s]+", plain.replace(",", "."))
    return re.split(r"\s*,\s*|\s+", plain)


def _numbers(line: str, where: str, number: int, *, dates: bool = False, words: bool = False) -> Floats:
    """All numbers of a line; NaN for dates and times of day, or words, where they may stand; InputError at anything else."""
    cells = _cells(line)
    known = [not (dates and _DATE.fullmatch(cell)) and not (words and LABEL.match(cell)) for cell in cells]
    if all(known) or not any(known):
        return free_format([" ".join(cells)], where=where, first_line=number)
    numbers = free_format([" ".join(np.array(cells)[known])], where=where, first_line=number)
    wanted = f"{sum(known)} numbers beside its words or dates"
    require(numbers.size == sum(known), where, wanted, str(numbers.size), key=f"line {number}")
    values = np.full(len(cells), np.nan)
    values[known] = numbers
    return values


def _rows(lines: Sequence[str], skip: int, where: str, *, other: bool) -> tuple[list[Floats], list[int]]:
    """The numbers of every line below the first `skip`, and the lines' places; comments and blank lines are left out.

    Where `other` than numbers may stand in columns that are not asked for, dates, times of day and words are NaN.
    """
    used = content_lines(lines, skip)
    plain = [line.strip().strip(";,") for _, line in used]
    mark = "," if plain and "," in plain[0] else None
    # A comma may be a decimal one where no point stands.
    if mark is None or all("." in line for line in plain):
        bulk = numbers_at_once(plain, mark)
        if bulk is not None and bulk.size > 1:
            return list(bulk), [number for number, _ in used]
    rows = [_numbers(line, where, number, dates=other, words=other) for number, line in used]
    require(
        sum(row.size for row in rows) >= 2,
        where,
        "numbers below the lines skipped",
        f"{len(lines)} lines in all",
        key="skip_lines",
    )
    return rows, [number for number, _ in used]


def _even_rows(rows: list[Floats], places: list[int], where: str) -> Floats:
    width = rows[0].size
    odd = next((i for i, row in enumerate(rows) if row.size != width), 0)
    require(
        rows[odd].size == width,
        where,
        f"{width} columns, as the first line has",
        str(rows[odd].size),
        f"say --columns {WHOLE} where the numbers of one channel run on from line to line",
        key=f"line {places[odd]}",
    )
    return np.array(rows)


def _named(layout: Layout, width: int, where: str) -> dict[int, str]:
    """The columns (from 0) that hold accelerations, with their names."""
    time = layout.time_column
    require(time is None or 1 <= time <= width, where, f"a column from 1 to {width}", str(time), key="time_column")
    if layout.columns is None:
        return {column: str(column + 1) for column in range(width) if column + 1 != time}
    named: dict[int, str] = {}
    for part in layout.columns.split(","):
        number, _, name = part.strip().partition(":")
        require(
            _PLACE.fullmatch(number.strip()) and 1 <= int(number) <= width and int(number) != time,
            where,
            f'columns from 1 to {width} but the times\', such as "2,3" or "2:N,3:E", or "{WHOLE}"',
            repr(layout.columns),
            key="columns",
        )
        named[int(number) - 1] = name.strip() or number.strip()
    require(
        len(set(named.values())) == len(layout.columns.split(",")),
        where,
        "columns and names that differ",
        repr(layout.columns),
        key="columns",
    )
    return named


def proposal(text: str, where: str, *, headed: bool = False) -> str:
    """What to type so that the text is read as the table of numbers that it seems to be; "" where it seems to be none.

    Where it is `headed` by names, one of them the times', only times of day keep it from being read. InputError, naming it,
    for what contradicts itself in the text: what is typed would not cure that.
    """
    lines = text.splitlines()
    block = _block(lines)
    if block is None or (headed and any(_or_none(cell) is not None for cell in _cells(lines[block[0] - 1]))):
        return ""
    skip, rows = block
    head = "\n".join(line[:_LONGEST_LINE] for line in lines[max(skip - _MOST_LINES, 0) : skip])
    headers = _headers(head, rows[0].size)
    if headed and not np.isnan(rows[0]).any():
        return ""
    layout, samples = _layout(rows, skip, headers)
    if not samples.size:
        return ""
    _must_count(head, rows, where)
    if samples.ndim == 2 and np.isnan(rows[0]).any():
        layout = replace(layout, dt_s=_dated_step([line for line in lines[skip:] if line.strip()][: len(rows)]))
    steps = _steps(head, rows)
    if layout.time_column:
        places = tuple(number for number, _ in content_lines(lines, skip))
        clock = clock_of(np.array(rows)[:, layout.time_column - 1], where, places)
        steps = [clock.dt_s, *steps]
    elif layout.dt_s is None and steps:
        layout = replace(layout, dt_s=steps[0])
    else:
        steps = [layout.dt_s, *steps] if layout.dt_s else []
    require(
        not steps or max(steps) <= (1.0 + _SAME) * min(steps),
        where,
        "one step",
        " and ".join(f"{each:g} s" for each in dict.fromkeys(steps)),
        CONTRADICTS,
    )
    used = [] if samples.ndim == 1 or layout.columns == WHOLE else sorted(_named(layout, rows[0].size, ""))
    stated = {unit for column in used if (unit := heading(headers[column])[1])} or set(_units(head))
    unit, remark = (stated.pop(), "") if len(stated) == 1 else likely_unit(head, float(np.abs(samples).max()))
    require(not stated, where, "one unit in all columns", " and ".join(sorted(stated)), "read them one by one")
    if not unit:
        return ""
    record = described(
        text, where, unit=unit, layout=layout if layout.time_column or layout.dt_s else replace(layout, dt_s=0.01)
    )
    check(record)
    remark = f"--motion-unit if {remark}" if remark else ""
    options = layout.options()
    if not (layout.time_column or layout.dt_s):
        options, remark = (
            f"{options} --dt STEP",
            "; ".join(filter(None, ("STEP in seconds as its source says", remark))),
        )
    command = f"rockcheck motion inspect {shlex.quote(where)} {options} --motion-unit {unit}"
    return f"{command} ({remark})" if remark else command


def _layout(rows: list[Floats], skip: int, headers: Sequence[str]) -> tuple[Layout, Floats]:
    """How `rows` under these `headers` seem to be laid out, and the samples: in columns (n, k), or of one channel (n,)."""
    width = rows[0].size
    even = [row for row in rows if row.size == width]
    table = np.array(even)
    dated = [bool(each.any()) for each in np.isnan(table).T]
    if len(even) == len(rows) > 2 and width > 1:
        clock, counted = (next((i for i in range(width) if _rises(table[:, i], by)), None) for by in (_STEP, _ONE))
        left = [
            i
            for i in range(width)
            if not dated[i] and i not in (clock, counted) and not NO_COMPONENT.search(headers[i])
        ]
        whole = len(left) == width - (clock is not None)
        columns = None if whole else ",".join(f"{i + 1}{_named_by(headers[i])}" for i in left)
        if clock is not None and not any(dated):
            return Layout(skip_lines=skip, time_column=clock + 1, columns=columns), table[:, left]
        if any(dated) or counted is not None:
            return Layout(skip_lines=skip, columns=columns), table[:, left]
    samples = np.concatenate(rows)
    runs_on = width > 1 and (len(even) < len(rows) or _rough(samples) < float(np.mean([_rough(c) for c in table.T])))
    return Layout(
        skip_lines=skip, columns=WHOLE if runs_on or width == 1 else None
    ), samples if runs_on or width == 1 else table


def _rises(values: Floats, by: tuple[float, float]) -> bool:
    """Whether a column is a clock's, or counts: it hardly ever falls, by steps within these bounds as most are."""
    steps = np.diff(values)
    if not np.isfinite(steps).all() or (steps >= 0.0).mean() < _RISING:
        return False
    usual = float(np.median(steps)) or float(steps.mean())
    near = (
        (np.abs(steps - usual) <= 0.5 * abs(usual)) | (steps == 0.0) | (np.abs(steps) <= 2.0 * by[1]) & (steps >= 0.0)
    )
    return by[0] <= usual <= by[1] and bool(near.mean() >= _RISING)


def _headers(head: str, width: int) -> list[str]:
    """For every column the words that the last line above it, or the one above that line's units, names it by; or ""."""
    above = [line.lstrip(" #%") for line in head.splitlines() if line.strip()][-2:]
    cells = [_names(line, width) for line in above]
    if not cells or not cells[-1]:
        return [""] * width
    last = cells[-1]
    if len(cells) == 2 and cells[0] and all(map(is_unit, last)):
        return [f"{name} ({unit})" for name, unit in zip(cells[0], last, strict=True)]
    return last


def _names(line: str, width: int) -> list[str]:
    for pattern in (r"[;\t|]", r",", r"\s{2,}|(?<=[\])])\s+", r"\s+"):
        if len(cells := [cell.strip().strip('"') for cell in re.split(pattern, line.strip().strip(";,"))]) == width:
            return cells if not any(_or_none(cell) is not None for cell in cells) else []
    return []


def _named_by(header: str) -> str:
    """ ":" and the word by which a header names its column, or ""."""
    word = re.sub(r"\s*[\[(][^\])]*[\])]", "", header)
    return f":{word}" if re.fullmatch(r"\w+", word) else ""


def content_lines(lines: Sequence[str], skip: int = 0) -> list[tuple[int, str]]:
    """The lines below the first `skip`, by their number in the file; comments and blank lines are left out."""
    return [
        (i + 1, line) for i, line in enumerate(lines) if i >= skip and line.strip() and line.lstrip()[0] not in "#%"
    ]


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
    places = [i for i in range(first, len(lines)) if (row := read[i]) is not None and row.size]
    sizes = [row.size for i in places if (row := read[i]) is not None]
    if sum(sizes) < _LEAST_NUMBERS:
        return None
    usual = max(set(sizes), key=sizes.count)
    above = next((i for i, size in enumerate(sizes) if size == usual), 0)  # a header's last lines may be numbers
    for more in range(above, min(above + _HEADER_NUMBERS, len(sizes))):
        counts = {float(sum(sizes[more:])), float(len(sizes) - more)}
        if any(counts & set(row.tolist()) for i in places[:more] if (row := read[i]) is not None):
            above = more
            break
    rows = [row for i in places[above:] if (row := read[i]) is not None]
    before = sum(row is not None and row.size == usual for row in read[:first])
    return None if before > _HEADER_ROWS or not rows else (places[above], rows)


def _must_count(head: str, rows: list[Floats], where: str) -> None:
    """InputError where the lines above the numbers say how many there are, and there are others."""
    counts = {int(next(filter(None, match.groups()))) for match in _COUNT.finditer(head)}
    for row in map(_or_none, head.splitlines()):
        whole, step = sorted(np.abs(row).tolist(), reverse=True) if row is not None and row.size == 2 else (0.0, 0.0)
        if whole >= _LEAST_NUMBERS and whole % 1.0 == 0.0 and _SHORTEST_S <= step <= _LONGEST_S:
            counts.add(int(whole))
    found = {sum(row.size for row in rows), len(rows)}
    if counts and not counts & found:
        said, there = (" or ".join(map(str, sorted(each))) for each in (counts, found))
        raise mistake(where, "", f"{said} numbers, as the lines above them say", there, CONTRADICTS)


def _or_none(line: str) -> Floats | None:
    try:
        return _numbers(line, "", 0, dates=True)
    except InputError:
        return None


def _steps(head: str, rows: list[Floats]) -> list[float]:
    """The steps in seconds that the lines above the numbers speak of, or that stand beside their count."""
    found: list[float] = []
    counts = {float(sum(row.size for row in rows)), float(len(rows))}
    numbers = [row for row in map(_or_none, head.splitlines()) if row is not None and row.size]
    if any(counts & set(row.tolist()) for row in numbers):
        found += [value for row in numbers for value in row.tolist()]
    for line in head.splitlines():
        for match in _NAMED_STEP.finditer(line):
            value = fortran(match[1] or match[3])
            found.append(value / 1000.0 if match[2] else value)
        if not _OTHER_TIMES.search(line) or _SAMPLING.search(line):
            found += [1.0 / rate for match in _RATE.finditer(line) if (rate := fortran(match[1] or match[2])) > 0.0]
        if not _OTHER_TIMES.search(line) and not _NAMED_STEP.search(line):
            found += [fortran(match[1]) for match in _SECONDS.finditer(line)]
    return [value for value in dict.fromkeys(found) if _SHORTEST_S <= value <= _LONGEST_S]


def _units(head: str) -> list[str]:
    """The units that the lines above the numbers name."""
    return list(dict.fromkeys(unit for word in _UNIT_WORDS.findall(head) if (unit := unit_named(word))))


def likely_unit(head: str, largest: float) -> tuple[str, str]:
    """The unit that the lines above the numbers name, else the first in which they would be an earthquake, and the others.

    "" and why where they would be none in any unit.
    """
    if named := _units(head):
        return ("", f"the lines above name {' and '.join(named)}") if named[1:] else (named[0], "")
    low, high = _PLAUSIBLE_G
    peaks = {name: largest * factor / STANDARD_GRAVITY_M_S2 for name, factor in UNITS_M_S2.items()}
    fits = [name for name, peak in peaks.items() if low <= peak <= high]
    if not fits:
        return "", f"the largest, {largest:.3g}, is an earthquake's in none: counts need the recorder's factor first"
    return fits[0], f"its source says so: the peak is {', '.join(f'{peaks[name]:.2g} g in {name}' for name in fits)}"


# CSV and plain columns: a time column and one column or more of acceleration, the unit in the headers or given.


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
_DECIMAL_COMMA_OR_WHOLE = re.compile(r"[+-]?[0-9]*,[0-9]+(?:[eEdD][+-]?[0-9]+)?|[+-]?[0-9]+")


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


def headed_columns(text: str, where: str, *, unit: str | None = None) -> RecordFile:
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
    return "," in line and len(cells) > 1 and all(_DECIMAL_COMMA_OR_WHOLE.fullmatch(cell) for cell in cells)


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
        first = _spaced(rows[0][1], len(cells(rows[-1][1])))
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


def _spaced(line: str, width: int) -> list[str]:
    """The names in a line above `width` columns: where blanks stand between the columns, those with blanks of their own too."""
    names, apart = _split(line), re.split(r"\s{2,}|(?<=[\])])\s+", line.strip())
    return apart if len(names) > width == len(apart) > 1 else names


def _titles(lines: Sequence[str], width: int) -> int:
    """Number of lines of words above the one that names the columns, a column of times among them."""
    for place, line in enumerate(lines):
        names = _spaced(line, width)
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
        names = tuple(_spaced(line.lstrip(" #%"), count))
        if len(names) == count and _names_times(names):
            return names
    return tuple(str(place + 1) for place in range(count))


def _time_column(headers: Sequence[str], words: Collection[str], table: NDArray[np.float64], where: str) -> int:
    named = [i for i, header in enumerate(headers) if _TIME.match(header) and header not in words]
    unnamed = headers[0] == "1" and len(headers) > 1
    counts = unnamed and bool((np.diff(table[:, 0]) == 1.0).all())
    require(
        named or (unnamed and not counts),
        where,
        "a column of times",
        "the samples' numbers, in steps of one" if counts else f"the columns {', '.join(headers)}",
        "name the column of times t_s",
        key="column 1" if counts else "",
    )
    return named[0] if named else 0
