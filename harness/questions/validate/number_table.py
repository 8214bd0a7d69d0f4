"""A table (CSV) of a name and numbers a line, under a header that is known word for word."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import Final

import numpy as np

from harness.input.text_file import decimals, decoded, numbers_at_once, read_bytes
from harness.model.errors import InputError, Mistake
from harness.model.history import Array

LARGEST: Final = 1e9
"""No length, time, mass or rate in SI units that was measured is larger, and squares of larger ones may overflow."""


def header(path: Path) -> tuple[str, ...]:
    """The names of a table's columns, however they are parted: of a table of something else too."""
    return tuple(name.strip() for name in _lines(path)[0].split(","))


def read_groups(path: Path, columns: Sequence[str]) -> list[tuple[str, Array]]:
    """The numbers (n, columns − 1) of lines that follow each other with one name in the first column, by that name.

    Raises `InputError` with every line that is wrong, and for a name that comes back after another.
    """
    first, *lines = _lines(path)
    if tuple(name.strip() for name in first.split(",")) != tuple(columns):
        raise InputError(Mistake(str(path), "header", ", ".join(columns), first or "nothing"))
    numbered = [(number, line) for number, line in enumerate(lines, 2) if line.strip()]
    if not numbered:
        raise InputError(Mistake(str(path), "", "at least one line of numbers", "none"))
    table = _numbers(path, numbered, len(columns))
    if (large := np.argwhere(np.abs(table) > LARGEST)).size:
        row, column = large[0].tolist()
        where = f"line {numbered[row][0]}: {columns[column + 1]}"
        raise InputError(Mistake(str(path), where, f"a number of at most {LARGEST:g}", f"{table[row, column]:g}"))
    names = [line.partition(",")[0].strip() for _, line in numbered]
    groups: list[tuple[str, Array]] = []
    seen: set[str] = set()
    start = 0
    for name, same in groupby(names):
        count = sum(1 for _ in same)
        if name in seen:
            wanted = f"all lines of a {columns[0]} after each other"
            raise InputError(Mistake(str(path), f"{columns[0]} {name}", wanted, "others between them"))
        seen.add(name)
        groups.append((name, table[start : start + count]))
        start += count
    return groups


def _numbers(path: Path, lines: Sequence[tuple[int, str]], width: int) -> Array:
    """All cells but the first of each line, at once; line by line only where something is wrong."""
    bare = [line.partition(",")[2] for _, line in lines]
    table = numbers_at_once(bare, ",")
    if table is not None and table.shape[1] == width - 1:
        return table
    mistakes = []
    for number, line in lines:
        cells = line.split(",")
        try:
            decimals(cells[1:])
        except ValueError as error:
            mistakes.append(Mistake(str(path), f"line {number}", "decimal numbers", str(error)))
            continue
        if len(cells) != width:
            mistakes.append(Mistake(str(path), f"line {number}", f"{width} cells", f"{len(cells)}"))
    raise InputError(mistakes or Mistake(str(path), "", "finite decimal numbers", "others"))


def _lines(path: Path) -> list[str]:
    text = decoded(read_bytes(path, "a table"), str(path), "a CSV file with a header")
    return text.splitlines() or [""]
