"""How far the digits that a file holds leave its numbers open: half a unit of the last one written."""

from __future__ import annotations

from collections.abc import Sequence
from decimal import Decimal
from typing import Final

import numpy as np

from harness.model.history import Array

UNIFORM: Final = 1e-9
"""Steps of a time column that differ by less than this share are equal: rounding of doubles, where rounded times jump a unit."""


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
    return float(0.5 * 10.0 ** (leading - digits))


def resolution_of_times(cells: Sequence[str], t_s: Array) -> float:
    """The same of a column of times; 0 where the steps are equal: times of such a grid were not rounded."""
    step = np.diff(t_s)
    if step.size == 0 or np.ptp(step) <= UNIFORM * max(float(np.max(step)), float(np.max(np.abs(t_s)))):
        return 0.0
    return resolution(cells)


def of_rate(values: Array, t_s: Array) -> float:
    """The largest rate of change between samples: what an open time makes of a value."""
    return float(np.max(np.abs(np.diff(values) / np.diff(t_s)))) if t_s.size > 1 else 0.0
