"""Polynomials of a Taylor step: value, slope and the first root, isolated by bounds on the second derivative."""

from __future__ import annotations

from typing import Final

from analytic._jit import inlined, jit
from analytic.layout import Floats

NO_ROOT: Final = 2.0
"""Returned where the polynomial keeps its sign on [0, 1]."""
DEEPEST: Final = 40
"""Bisections after which an interval counts as a point: 2⁻⁴⁰ of a step is below 1e-12 of any step's length."""
CONVERGED: Final = 1e-9
"""Newton's step, in the bracket's width, whose square is below rounding: the slope there is at least the bend times the width."""
TANGENT_LEVEL: Final = 12
"""An interval this small left undecided means that the function came within 2⁻²⁷ of its curvature to zero."""


@inlined
def value(w: Floats, row: int, n: int, x: float) -> float:
    """Value at x of the polynomial with coefficients w[row, 0..n]."""
    s = float(w[row, n])
    for k in range(n - 1, -1, -1):
        s = s * x + w[row, k]
    return s


@inlined
def slope(w: Floats, row: int, lo: int, n: int, x: float) -> float:
    """First derivative at x of Σ w[row, lo + k] x^k."""
    s = 0.0
    for k in range(n, lo, -1):
        s = s * x + (k - lo) * w[row, k]
    return s


@inlined
def _stripped(w: Floats, row: int, lo: int, n: int, x: float) -> float:
    s = float(w[row, n])
    for k in range(n - 1, lo - 1, -1):
        s = s * x + w[row, k]
    return s


@jit
def _refine(w: Floats, row: int, lo: int, n: int, a: float, b: float, fa: float, fb: float) -> float:
    """The one root of a monotone polynomial that is fa > 0 at a and fb ≤ 0 at b: Newton's steps kept inside the bracket."""
    width = b - a
    x = a + width * fa / (fa - fb) if fa > fb else b
    for _ in range(60):
        f, d = float(w[row, n]), 0.0
        for k in range(n - 1, lo - 1, -1):
            d = d * x + f
            f = f * x + w[row, k]
        if f > 0.0:
            a = x
        else:
            b = x
        new = x - f / d if d != 0.0 else 0.5 * (a + b)
        if not (a <= new <= b):
            new = 0.5 * (a + b)
        elif abs(new - x) <= CONVERGED * width:
            return new
        if abs(new - x) <= 1e-16 * b:
            return new
        x = new
    return x


@jit
def first_root(w: Floats, row: int, lo: int, n: int) -> tuple[float, int]:
    """First x in [0, 1] at which Σ w[row, lo + k] x^k, k = 0..n − lo, is not positive, and the depth of the search.

    The search is exact: an interval is left only when the bound min(f(a), f(b)) − B w²/8 > 0 or a slope beyond B w/2
    proves it free of roots, B being the sum of the second derivative's terms; a touch closer than the deepest interval
    counts as none.
    """
    if lo > n:
        return NO_ROOT, 0
    if w[row, lo] < 0.0:
        return 0.0, 0
    bend, rest = 0.0, 0.0
    for k in range(lo + 2, n + 1):
        size = abs(w[row, k])
        rest += size
        bend += (k - lo) * (k - lo - 1) * size
    first = w[row, lo + 1] if lo < n else 0.0
    if w[row, lo] + min(first, 0.0) > rest:
        return NO_ROOT, 0
    level, i, deepest = 0, 0, 0
    left, width = 0.0, 1.0
    f_left = w[row, lo]
    while True:
        right = (i + 1) * width
        f_right = _stripped(w, row, lo, n, right)
        clear = f_right > 0.0 and min(f_left, f_right) > 0.125 * bend * width * width
        if not clear and abs(slope(w, row, lo, n, left + 0.5 * width)) >= 0.5 * bend * width:
            if f_right <= 0.0:
                return _refine(w, row, lo, n, left, right, f_left, f_right), level
            clear = True
        if not clear and level < DEEPEST:
            level, i, width = level + 1, 2 * i, 0.5 * width
            deepest = max(deepest, level)
            continue
        if f_right <= 0.0:
            return right, level
        i, left, f_left = i + 1, right, f_right
        while level > 0 and i % 2 == 0:
            level, i, width = level - 1, i // 2, 2.0 * width
        if level == 0 and i == 1:
            return NO_ROOT, deepest


@inlined
def leading(w: Floats, row: int, n: int, scale: float, time_s: float) -> int:
    """Index of the first coefficient that is more than rounding: |w[row, k]| time_s^k above 1e-10 of scale; n + 1 if none."""
    power = 1.0
    for k in range(n + 1):
        if abs(w[row, k]) * power > 1e-10 * scale:
            return k
        power *= time_s
    return n + 1
