"""Polynomials of a Taylor step: value, slope and the first root, isolated by bounds on the second derivative.

Sums of many terms are taken in two halves, even and odd powers, which a processor adds up at the same time.
"""

import math
from typing import Final

import numpy as np

from analytic.kernel.compiler import inlined, jit, set_term, term
from analytic.kernel.records import Floats

# Sine and cosine together, and a coarse root: what every step needs, compiled into it instead of called
# from the C library.


FAR: Final = 1e5
"""Angle, rad, up to which its quarter turns are subtracted exactly; beyond, the C library does it."""
PER_QUARTER: Final = 2.0 / math.pi
TO_WHOLE: Final = 6755399441055744.0
"""1.5 · 2⁵²: added and taken away again, it leaves the nearest whole number, of equal size for either sign."""
QUARTER: Final = (1.57079632673412561417e00, 6.07710050630396597660e-11, 2.02226624879595063154e-21)
"""π/2 in parts; products of the first two, of 33 bits, with a whole number below 2²⁰ are exact (fdlibm, e_rem_pio2.c)."""
SINE: Final = (
    -1.66666666666666324348e-01,
    8.33333333332248946124e-03,
    -1.98412698298579493134e-04,
    2.75573137070700676789e-06,
    -2.50507602534068634195e-08,
    1.58969099521155010221e-10,
)
COSINE: Final = (
    4.16666666666666019037e-02,
    -1.38888888888741095749e-03,
    2.48015872894767294178e-05,
    -2.75573143513906633035e-07,
    2.08757232129817482790e-09,
    -1.13596475577881948265e-11,
)
"""Coefficients from that of x³ and that of x⁴ on, for |x| ≤ π/4, errors below 2⁻⁵⁷ (fdlibm, k_sin.c and k_cos.c)."""


@inlined
def sine_cosine(angle: float) -> tuple[float, float]:
    """Sine and cosine, each within 3e-16 of its own size; the angle of the other sign gives the same bits."""
    if not abs(angle) < FAR:
        return math.sin(angle), math.cos(angle)
    turns = (angle * PER_QUARTER + TO_WHOLE) - TO_WHOLE
    x = ((angle - turns * QUARTER[0]) - turns * QUARTER[1]) - turns * QUARTER[2]
    y = x * x
    y2 = y * y
    s = (SINE[0] + y * SINE[1]) + y2 * ((SINE[2] + y * SINE[3]) + y2 * (SINE[4] + y * SINE[5]))
    c = (COSINE[0] + y * COSINE[1]) + y2 * ((COSINE[2] + y * COSINE[3]) + y2 * (COSINE[4] + y * COSINE[5]))
    half = 0.5 * y
    whole = 1.0 - half
    # (1 − whole) − half is exactly what the rounding of 1 − y/2 lost (fdlibm, k_cos.c).
    sine, cosine = x + x * (y * s), whole + (((1.0 - whole) - half) + y2 * c)
    quadrant = int(turns) & 3
    if quadrant & 1:
        sine, cosine = cosine, -sine
    if quadrant & 2:
        sine, cosine = -sine, -cosine
    return sine, cosine


MANTISSA: Final = (1 << 52) - 1
ONE: Final = 1023 << 52


@inlined
def coarse_root(x: float, inverse: float) -> float:
    """x^inverse of a positive x that is a normal number, 0 < inverse ≤ 1/2, to 1 part in 10 000: enough for a step's length."""
    bits = np.float64(x).view(np.int64)
    f = np.int64((bits & MANTISSA) | ONE).view(np.float64) - 1.0
    log2 = float((bits >> 52) - 1023) + f * (1.4384 + f * (-0.6777 + f * (0.3218 - 0.0826 * f)))
    y = log2 * inverse
    whole = (y + TO_WHOLE) - TO_WHOLE
    g = y - whole
    power = 1.0 + g * (0.69315 + g * (0.24023 + g * (0.0558 + 0.0096 * g)))
    return float(power * np.int64((int(whole) + 1023) << 52).view(np.float64))


NO_ROOT: Final = 2.0
"""Returned where the polynomial keeps its sign on [0, 1]."""
DEEPEST: Final = 40
"""Bisections after which an interval counts as a point: 2⁻⁴⁰ of a step is below 1e-12 of any step's length."""
CONVERGED: Final = 1e-6
STRAIGHT: Final = 1e-4
"""Halley's step, in the bracket's width, and what the slope changes over it at most, in the slope, at which the next error (the
step's cube times squares of that change) is below rounding."""
ROUNDING: Final = 1e-10
"""Share of its own terms below which a coefficient at an event counts as zero: it stands there for a difference of terms that
cancel to 1e-16, amplified by what an event's place is known to."""
MAX_ITERATIONS: Final = 60
"""Of a root: bisections alone, which Halley's steps fall back to, reach rounding in 53."""
BOWED: Final = 3.999
"""Below four: the second derivative's first term, 2 c₂, is more than the sum of all others, which then cannot change its sign."""
TANGENT_LEVEL: Final = 12
"""An interval this small left undecided means that the function came within 2⁻²⁷ of its curvature to zero."""

Search = tuple[float, int, float]
"""Where the first root lies, the depth of the search, and the sum of the function's terms at the end of the step."""


@inlined
def value(row: Floats, n: int, x: float) -> float:
    """Value at x of the polynomial with coefficients row[0..n]."""
    s = term(row, n)
    for k in range(n - 1, -1, -1):
        s = s * x + term(row, k)
    return s


@inlined
def _stripped(row: Floats, lo: int, n: int, x: float) -> float:
    """Σ row[lo + k] x^k, k = 0..n − lo, which is odd."""
    y, k, even, odd = x * x, n, 0.0, 0.0
    while k > lo:
        odd = odd * y + term(row, k)
        even = even * y + term(row, k - 1)
        k -= 2
    return even + x * odd


@inlined
def _slope(row: Floats, lo: int, n: int, x: float) -> float:
    """First derivative at x of Σ row[lo + k] x^k, k = 0..n − lo, which is odd."""
    y, k, even, odd, even1, odd1 = x * x, n, 0.0, 0.0, 0.0, 0.0
    while k > lo:
        odd1, even1 = odd1 * y + odd, even1 * y + even
        odd, even = odd * y + term(row, k), even * y + term(row, k - 1)
        k -= 2
    return odd + 2.0 * (x * even1 + y * odd1)


@jit
def _refine(row: Floats, lo: int, n: int, bend: float, a: float, b: float, fa: float, fb: float) -> float:
    """The one root of a polynomial that is fa > 0 at a and fb ≤ 0 at b, its second derivative at most bend: Halley's steps kept
    inside the bracket."""
    width = b - a
    x = a + width * fa / (fa - fb) if fa > fb else b
    if a == 0.0 and lo < n:  # the parabola through both ends with the slope of this one
        slope = term(row, lo + 1)
        left = slope * slope - 4.0 * fa * ((fb - fa) / b - slope) / b
        guess = 2.0 * fa / (math.sqrt(left) - slope) if left > 0.0 else x
        x = guess if 0.0 < guess < b else x
    for _ in range(MAX_ITERATIONS):
        y, k = x * x, n
        e, e1, e2, o, o1, o2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        while k > lo:
            o2, e2 = o2 * y + o1, e2 * y + e1
            o1, e1 = o1 * y + o, e1 * y + e
            o, e = o * y + term(row, k), e * y + term(row, k - 1)
            k -= 2
        f = e + x * o
        d = o + 2.0 * (x * e1 + y * o1)
        curve = 2.0 * e1 + 6.0 * x * o1 + 8.0 * y * (e2 + x * o2)
        if f > 0.0:
            a = x
        else:
            b = x
        below = d * d - 0.5 * f * curve
        new = x - f * d / below if below > 0.0 else 0.5 * (a + b)
        if not (a <= new <= b):
            new = 0.5 * (a + b)
        elif abs(new - x) <= CONVERGED * width and abs(new - x) * bend <= STRAIGHT * abs(d):
            return new
        if abs(new - x) <= 1e-16 * b:
            return new
        x = new
    return x


@jit
def _isolate(row: Floats, lo: int, n: int, bend: float, f_right: float) -> tuple[float, int]:
    """First root in [0, 1] of the stripped polynomial and the depth of the search; bend: sum of the second derivative's terms,
    f_right: value at 1."""
    level, i, deepest = 0, 0, 0
    left, width, right = 0.0, 1.0, 1.0
    f_left, curve = term(row, lo), (term(row, lo + 2) if lo + 2 <= n else 0.0)
    if f_left > 0.0 and BOWED * abs(curve) > bend and (f_right <= 0.0 or curve < 0.0):  # bowed one way all along
        return (_refine(row, lo, n, bend, 0.0, 1.0, f_left, f_right) if f_right <= 0.0 else NO_ROOT), 0
    while True:
        turn = bend * width  # what the slope can change over the interval
        clear = f_right > 0.0 and min(f_left, f_right) > 0.125 * turn * width
        if not clear:
            chord = abs(f_left - f_right)
            if chord >= turn * width or abs(_slope(row, lo, n, left + 0.5 * width)) >= 0.5 * turn:  # monotone
                if f_right <= 0.0:
                    return _refine(row, lo, n, bend, left, right, f_left, f_right), level
                clear = True
        if not clear and level < DEEPEST:
            level, i, width = level + 1, 2 * i, 0.5 * width
            deepest = max(deepest, level)
        else:
            if f_right <= 0.0:
                return right, level
            i, left, f_left = i + 1, right, f_right
            while level > 0 and i % 2 == 0:
                level, i, width = level - 1, i // 2, 2.0 * width
            if level == 0 and i == 1:
                return NO_ROOT, deepest
        right = (i + 1) * width
        f_right = _stripped(row, lo, n, right)


@jit
def first_root(row: Floats, lo: int, n: int, h: float) -> Search:
    """First x in [0, 1] at which Σ row[lo + k] (x h)^k, k = 0..n − lo, is not positive; the row takes on the powers of h, and
    may get a zero as term n + 1, for which it must have room.

    The search is exact: an interval is left only when the bound min(f(a), f(b)) − B w²/8 > 0 or a slope beyond B w/2
    proves it free of roots, B being the sum of the second derivative's terms; a touch closer than the deepest interval
    counts as none.
    """
    if lo > n:
        return NO_ROOT, 0, 0.0
    if (n - lo) % 2 == 0:  # the sums below go by pairs of terms
        n += 1
        set_term(row, n, 0.0)
    power, terms = 1.0, 0.0
    for k in range(lo):
        c = term(row, k) * power
        set_term(row, k, c)
        terms += abs(c)
        power *= h
    at, slope = term(row, lo) * power, term(row, lo + 1) * (power * h)
    set_term(row, lo, at)
    set_term(row, lo + 1, slope)
    bend, rest, rise, bend1, rest1, rise1 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    k, i, square = lo + 2, 2.0, h * h
    while k < n:
        power *= square
        c, c1 = term(row, k) * power, term(row, k + 1) * (power * h)
        set_term(row, k, c)
        set_term(row, k + 1, c1)
        rise, rise1 = rise + c, rise1 + c1
        rest, rest1 = rest + abs(c), rest1 + abs(c1)
        bend, bend1 = bend + i * (i - 1.0) * abs(c), bend1 + i * (i + 1.0) * abs(c1)
        k, i = k + 2, i + 2.0
    bend, rest, rise = bend + bend1, rest + rest1, rise + rise1
    fall, end = 0.5 * (rise - rest), at + slope + rise
    x, level = 0.0, 0
    if at >= 0.0:
        if at + min(slope, 0.0) + fall > 0.0:
            return NO_ROOT, 0, 0.0
        x, level = _isolate(row, lo, n, bend, end)
        if x > 1.0:
            return x, level, 0.0
    return x, level, terms + abs(at) + abs(slope) + rest


@inlined
def leading(row: Floats, n: int, scale: float, time_s: float) -> int:
    """Index of the first coefficient that is more than rounding: |row[k]| time_s^k above its share of scale; n + 1 if none."""
    power = 1.0
    for k in range(n + 1):
        if abs(term(row, k)) * power > ROUNDING * scale:
            return k
        power *= time_s
    return n + 1
