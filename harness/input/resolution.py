"""How far the digits that a file holds leave its numbers open: half a unit of the last one written."""

from __future__ import annotations

from collections.abc import Sequence
from decimal import Decimal
from typing import Final

import numpy as np

from harness.model.history import Array, hermite

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
    return 0.5 * float(np.abs(hermite(t_s[left_out], t_s[ends], values[ends], slopes) - values[left_out]).max())


def of_rate(values: Array, t_s: Array) -> float:
    """The largest rate of change between samples: what an open time makes of a value."""
    return float(np.max(np.abs(np.diff(values) / np.diff(t_s)))) if t_s.size > 1 else 0.0
