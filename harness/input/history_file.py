"""Histories from CSV files of any software, and how far the digits written there leave them open."""

import csv
import io
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import Final

import numpy as np

from harness.input.files import decoded, is_decimal, numbers, read_bytes
from harness.input.mistakes import MOST_MISTAKES, unsaid
from harness.model import COLUMNS, Array, History, InputError, Mistake, hermites, refuse, require, translated

REQUIRED: Final = ("t_s", "theta_rad")
UNITS: Final[Mapping[str, tuple[str, float]]] = {
    "t_ms": ("t_s", 1e-3),
    "theta_deg": ("theta_rad", math.pi / 180.0),
    "theta_mrad": ("theta_rad", 1e-3),
    "theta_rate_deg_s": ("theta_rate_rad_s", math.pi / 180.0),
    "slip_cm": ("slip_m", 1e-2),
    "slip_mm": ("slip_m", 1e-3),
    "slip_rate_cm_s": ("slip_rate_m_s", 1e-2),
    "slip_rate_mm_s": ("slip_rate_m_s", 1e-3),
}
"""Columns in other units than the contract's: what they become, and the factor."""
SEPARATORS: Final = (",", ";", "\t")
_PLAIN: Final = str.maketrans({",": ".", "d": "e", "D": "E"})
"""Decimal commas, and Fortran's exponents of double precision."""
ENDLESS: Final = ("nan", "inf", "infinity")
MOST_BYTES: Final = 2**30
"""Largest history read: an hour at 1 ms with ten columns takes half of it."""
MOST_RAD: Final = 10.0
"""A statue that has turned further has tumbled more than once: the numbers are degrees."""
GAP_STEPS: Final = 20.0
"""A step longer than this many usual ones, in which the statue moves, is a gap rather than a choice of the software."""
GAP_RAD: Final = 1e-3
"""Change of the rotation over a long step below which nothing can be missing in it: the software wrote no step at rest."""


@dataclass(frozen=True)
class _Table:
    """Cells of a file by row; `lines` are the rows' numbers in the file, from 1."""

    names: list[str]
    rows: list[list[str]]
    lines: list[int]
    comma: bool


def read_history(path: Path | str) -> History:
    """Read a history from CSV: `t_s` and `theta_rad` (or `t_ms`, `theta_deg`, ...) wanted, the others optional.

    >>> theirs = harness.read_history("theirs.csv")

    Columns may be separated by commas, semicolons or tabs; with the latter two a decimal comma is read as well. Lines that
    begin with # are comments. Rates that are not given are differences. Half a unit of the last digit written, in the file's own
    unit, is the history's resolution. Raises `InputError` naming file, line and column.
    """
    path, wanted = Path(path), "a CSV file with a header line and at least one row"
    table = _table(path, decoded(read_bytes(path, "a history", MOST_BYTES), str(path), wanted))
    meant = _meant(path, table.names)
    values = _numbers(path, table)
    columns = {name: values[:, index] * factor for index, (name, factor) in enumerate(meant)}
    t_s = columns["t_s"]
    late = np.flatnonzero(np.diff(t_s) <= 0.0)
    if late.size:
        # Said before rates are formed: a difference over no time is no rate.
        k = int(late[0]) + 1
        got = f"times that do not increase: {t_s[k]:.9g} s after {t_s[k - 1]:.9g} s"
        raise InputError(Mistake(str(path), f"line {table.lines[k]}", "increasing times", got))
    for value, rate in (("theta_rad", "theta_rate_rad_s"), ("slip_m", "slip_rate_m_s")):
        columns.setdefault(value, np.zeros_like(t_s))
        columns.setdefault(rate, np.gradient(columns[value], t_s) if t_s.size > 1 else np.zeros_like(t_s))
    extra = {name: values for name, values in columns.items() if name not in COLUMNS}
    largest = float(np.max(np.abs(columns["theta_rad"])))
    require(
        largest <= MOST_RAD,
        str(path),
        f"rotations of at most {MOST_RAD:g} rad",
        f"{largest:g} rad",
        "name a column in degrees theta_deg",
        key="theta_rad",
    )
    t_s, theta, theta_rate, slip, slip_rate = (columns[name] for name in COLUMNS)
    return History(t_s, theta, theta_rate, slip, slip_rate, extra, *_resolutions(table, meant, t_s, theta, slip))


def _resolutions(
    table: _Table, meant: Sequence[tuple[str, float]], t_s: Array, theta_rad: Array, slip_m: Array
) -> tuple[float, float]:
    """How far the written digits of a value, and of the times at which it changes, leave rotation, rad, and slip, m, open."""
    factors = {name: (index, factor) for index, (name, factor) in enumerate(meant)}

    def cells(name: str) -> list[str]:
        return [row[factors[name][0]].translate(_PLAIN) for row in table.rows]

    def of(name: str, values: Array) -> float:
        own = resolution(cells(name)) * factors[name][1] if name in factors else 0.0
        return own + of_rate(values, t_s) * late_s

    late_s = resolution_of_times(cells("t_s"), t_s) * factors["t_s"][1]
    return of("theta_rad", theta_rad), of("slip_m", slip_m)


def gaps(history: History) -> list[tuple[float, float]]:
    """Begin and end, s, of every step in which samples seem to be missing: scores there rest on interpolation."""
    step = np.diff(history.t_s)
    if step.size == 0:
        return []
    moved = np.abs(np.diff(history.theta_rad)) > GAP_RAD
    moved |= np.maximum(np.abs(history.theta_rad[:-1]), np.abs(history.theta_rad[1:])) > GAP_RAD
    long_steps = np.flatnonzero((step > GAP_STEPS * float(np.median(step))) & moved)
    return [(float(history.t_s[i]), float(history.t_s[i + 1])) for i in long_steps]


def _table(path: Path, text: str) -> _Table:
    numbered = [(number, line) for number, line in enumerate(text.splitlines(), 1) if line.strip()]
    numbered = [(number, line) for number, line in numbered if not line.lstrip().startswith("#")]
    require(len(numbered) >= 2, str(path), "a header line and at least one row of numbers", f"{len(numbered)} lines")
    header = numbered[0][1]
    separator = max(SEPARATORS, key=header.count)
    with translated(csv.Error, str(path), "a readable CSV file"):
        cells = list(csv.reader(io.StringIO("\n".join(line for _, line in numbered)), delimiter=separator))
    require(len(cells) == len(numbered), str(path), "one row in each line", "a quoted cell over several lines")
    if not cells[0][-1].strip() and all(not row[-1].strip() for row in cells[1:]):
        # Every line ends with the separator.
        cells = [row[:-1] for row in cells]
    names = [name.strip() for name in cells[0]]
    require(
        not all(is_decimal(name.replace(",", ".")) for name in names),
        str(path),
        "a header that names the columns",
        "numbers",
        f"put {separator.join(REQUIRED)} in the first line, in the order of the columns",
        key=f"line {numbered[0][0]}",
    )
    return _Table(names, cells[1:], [number for number, _ in numbered[1:]], separator != ",")


def _numbers(path: Path, table: _Table) -> Array:
    """All cells as numbers, shape (rows, columns). Raises `InputError` with the first cells that are none."""
    mistakes: list[Mistake] = []
    values = np.full((len(table.rows), len(table.names)), np.nan)
    for index, (row, line) in enumerate(zip(table.rows, table.lines, strict=True)):
        if len(row) != len(table.names):
            mistakes.append(Mistake(str(path), f"line {line}", f"{len(table.names)} numbers", f"{len(row)} cells"))
            continue
        cells = [cell.replace(",", ".") if table.comma else cell for cell in row]
        values[index] = numbers(cells)
        for column in np.flatnonzero(~np.isfinite(values[index])).tolist():
            place, cell = f"line {line}: {table.names[column]}", row[column].strip()
            if is_decimal(cells[column]) or cell.lstrip("+-").casefold() in ENDLESS:
                mistakes.append(Mistake(str(path), place, "a finite number", f"{cell} (NaN or infinite)"))
            else:
                mistakes.append(Mistake(str(path), place, "a number", repr(cell) if cell else "an empty cell"))
    refuse([*mistakes[:MOST_MISTAKES], *unsaid(str(path), len(mistakes) - MOST_MISTAKES)])
    return values


def _meant(path: Path, names: Sequence[str]) -> list[tuple[str, float]]:
    """Each column by the contract's name, and its unit as a factor. Raises `InputError` unless each wanted one is there once."""
    meant = [UNITS.get(name, (name, 1.0)) for name in names]
    known = [name for name, _ in meant]
    got = ", ".join(names)
    mistakes = [
        Mistake(str(path), "header", f"{name} (in one unit) once", got) for name in COLUMNS if known.count(name) > 1
    ]
    if not mistakes and len(set(known)) < len(known):
        mistakes.append(Mistake(str(path), "header", "each column once", got))
    for name in REQUIRED:
        if name not in known:
            others = [other for other, (canonical, _) in UNITS.items() if canonical == name]
            advice = "name the columns in the first line, commas, semicolons or tabs between them"
            mistakes.append(Mistake(str(path), "header", f"a column {name} (or {', '.join(others)})", got, advice))
    refuse(mistakes)
    return meant


UNIFORM: Final = 1e-9
"""Steps of a time column that differ by less than this share are equal: rounding of doubles, where rounded times jump a unit."""

FEWEST: Final = 5
"""Samples of which every second one leaves a curve."""


def resolution(cells: Sequence[str]) -> float:
    """Half a unit of the last digit of a column's largest number, in the column's own unit; 0 for a column of bare zeros.

    Software writes a number of decimals or of significant digits, and may drop zeros at the end: the longest cell tells how many
    it writes, the largest number where the last of them stands.
    """
    digits, leading, decimals = 0, None, 0
    for cell in cells:
        sign_digits_exponent = Decimal(cell.strip()).as_tuple()
        exponent = int(sign_digits_exponent.exponent)
        if any(sign_digits_exponent.digits):
            count = len(sign_digits_exponent.digits)
            digits = max(digits, count)
            place = count + exponent
            leading = place if leading is None else max(leading, place)
        else:
            decimals = max(decimals, -exponent)
    if leading is None:
        return 0.5 * 10.0**-decimals if decimals else 0.0
    own = float(0.5 * 10.0 ** (leading - digits))
    return max(own, _of_single_precision(np.array(cells, dtype=np.float64), own))


def _of_single_precision(values: Array, own: float) -> float:
    """Half a step of the largest number where all are numbers of single precision, to the digits written; else 0."""
    single = values.astype(np.float32)
    return 0.5 * float(np.spacing(np.abs(single).max())) if np.abs(values - single).max() <= own else 0.0


def resolution_of_times(cells: Sequence[str], t_s: Array) -> float:
    """The same of a column of times; 0 where the steps are equal: times of such a grid were not rounded."""
    step = np.diff(t_s)
    if step.size == 0 or np.ptp(step) <= UNIFORM * max(float(np.max(step)), float(np.max(np.abs(t_s)))):
        return 0.0
    return resolution(cells)


def between_samples(values: Array, t_s: Array) -> float:
    """How far interpolation may be off: half of what it misses where every second sample is left out, as at a kink."""
    ends, left_out = slice(None, None, 2), slice(1, t_s.size - 1, 2)
    if t_s.size < FEWEST:
        return 0.0
    slopes = np.gradient(values[ends], t_s[ends])
    return 0.5 * float(
        np.abs(hermites(t_s[left_out], t_s[ends], ((values[ends], slopes),))[0] - values[left_out]).max()
    )


def of_rate(values: Array, t_s: Array) -> float:
    """The largest rate of change between samples: what an open time makes of a value."""
    return float(np.max(np.abs(np.diff(values) / np.diff(t_s)))) if t_s.size > 1 else 0.0
