"""Numbers as people read them: units always, three digits, no false zeros."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Final

ROUNDING: Final = 1e-15
"""Rounding of numbers near one: a size below it is none."""
SMALLEST_SHARE: Final = 5e-7
"""A smaller share is told as none: its digits are rounding's."""


def digits(value: float | None, count: int = 3) -> str:
    """A number to `count` significant digits, in plain form between 0.001 and 100 000; an en dash for None."""
    if value is None or not math.isfinite(value):
        return "–"
    size = abs(value)
    if size < ROUNDING:
        return "0"
    if size < 1e-3 or size >= 1e5:
        mantissa, exponent = f"{value:.{count - 1}e}".split("e")
        mantissa = mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa
        return f"{mantissa}·10{_raised(int(exponent))}".replace("-", "−")
    places = max(0, count - 1 - int(f"{size:e}".partition("e")[2]))
    return f"{value:.{places}f}".replace("-", "−")


def _raised(exponent: int) -> str:
    return str(exponent).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


def unit(value: float | None, name: str, count: int = 3) -> str:
    """A number with its unit, a no-break space between."""
    return digits(value, count) if value is None else f"{digits(value, count)}\u00a0{name}"


def length(value_m: float, count: int = 3) -> str:
    """A length in the unit in which a person would say it: m, cm or mm."""
    size = abs(value_m)
    if size < 5e-7:
        return "0\u00a0mm"
    value, name = (value_m, "m") if size >= 1.0 else (100.0 * value_m, "cm")
    if size < 0.01:
        value, name = 1000.0 * value_m, "mm"
    count -= size < 0.1
    return f"{short(value, count)}\u00a0{name}"


def short(value: float, count: int = 4) -> str:
    """A number as given: no zeros at its end."""
    text = digits(value, count)
    return text.rstrip("0").rstrip(".") if "." in text and "·" not in text else text


def given(value: float, name: str) -> str:
    """A given number, as short as it was given, with its unit."""
    return f"{short(value)}\u00a0{name}"


def angle(value_rad: float) -> str:
    """A rotation in rad with degrees beside it."""
    return f"{unit(value_rad, 'rad')} ({digits(math.degrees(value_rad), 2)}°)"


def percent(share: float, count: int = 2) -> str:
    """A push as a share of the statue's weight."""
    return f"{short(100.0 * share if abs(share) >= SMALLEST_SHARE else 0.0, count)} %"


def plain(value: Any, count: int = 4) -> str:
    """Any value of a record in one table cell, its numbers to `count` digits."""
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return digits(value, count)
    if isinstance(value, Mapping):
        return ", ".join(_pair(key, item) for key, item in value.items())
    if isinstance(value, (list, tuple)):
        shown = [plain(item, count) for item in value[:12]]
        return (", ".join(shown) or "–") + (f", … ({len(value)})" if len(value) > 12 else "")
    return str(value)


def _pair(key: str, value: Any) -> str:
    words, name = split_unit(key)
    return f"{words} {short(value)}\u00a0{name}" if name and isinstance(value, float) else f"{words} {plain(value)}"


UNITS = {
    "m_s2": "m/s²",
    "m_s": "m/s",
    "rad_s": "rad/s",
    "kg_m2": "kg m²",
    "kg_m3": "kg/m³",
    "rad": "rad",
    "kg": "kg",
    "hz": "Hz",
    "deg": "°",
    "s": "s",
    "m": "m",
    "g": "g",
    "j": "J",
    "n": "N",
}


def split_unit(key: str) -> tuple[str, str]:
    """A record's key as words and unit: `peak_theta_rad` → (`peak theta`, `rad`)."""
    for ending, name in UNITS.items():
        if key.lower().endswith(f"_{ending}"):
            return key[: -len(ending) - 1].replace("_", " "), name
    return key.replace("_", " "), ""
