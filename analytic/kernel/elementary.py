"""Sine and cosine together, and a coarse root: what every step needs, compiled into it instead of called from the C library."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from analytic.kernel.compiler import inlined

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
