"""USGS SMC: 11 text lines, 48 integers, 50 reals, comments, then accelerations in cm/s², one channel in a file."""

from __future__ import annotations

import re
from typing import Final

import numpy as np

from harness.input.motions.orientation import Orientation, parse_orientation
from harness.input.motions.recordfile import UNITS_M_S2, Channel, RecordFile
from harness.input.motions.text import fixed_width, mistake

NAME: Final = "USGS SMC"
TESTED_ON_ORIGINALS: Final = False

_KIND = re.compile(r"^\s*(\d)\s+(UN)?CORRECTED ACCELEROGRAM", re.IGNORECASE)
_COMPONENT = re.compile(r"component\s*=\s*(\S+)", re.IGNORECASE)
_STATION = re.compile(r"station\s*=\s*(.*?)\s*component\s*=", re.IGNORECASE)
_TEXT_LINES, _INTEGER_LINES, _REAL_LINES = 11, 6, 10
_VERTICAL, _AZIMUTH, _COMMENTS, _COUNT = 12, 13, 15, 16  # places among the integers, from 0
_RATE, _TIMES_AND_PEAKS = 1, (28, 32)  # places among the reals, from 0
_NO_REAL = 1e38
_WIDTH, _PER_LINE = 10, 8
_LARGEST_INTEGER: Final = 1e10


def recognises(text: str) -> bool:
    """Whether the first line is SMC's "2 CORRECTED ACCELEROGRAM" (or "1 UNCORRECTED …") and the second begins with *."""
    lines = text.splitlines()[:2]
    return len(lines) == 2 and bool(_KIND.match(lines[0])) and lines[1].startswith("*")


def read(text: str, where: str) -> RecordFile:
    """The one channel of an SMC file; InputError where the header or values are incomplete."""
    lines = text.splitlines()
    integers_from, reals_from = _TEXT_LINES, _TEXT_LINES + _INTEGER_LINES
    comments_from = reals_from + _REAL_LINES
    integers = fixed_width(
        lines[integers_from:reals_from], 10, 48, where=where, first_line=integers_from + 1, what="integer header"
    )
    largest = float(np.max(np.abs(integers)))
    if largest > _LARGEST_INTEGER:
        raise mistake(where, "integer header", "integers of at most ten digits", f"{largest:g}")
    ints = integers.astype(np.int64)
    reals = fixed_width(
        lines[reals_from:comments_from], 15, 50, where=where, first_line=reals_from + 1, what="real header"
    )
    count, rate = int(ints[_COUNT]), float(reals[_RATE])
    if count < 2 or not 0.0 < rate < 1e5:
        raise mistake(where, "header", "a number of values and a sampling rate", f"{count} and {rate:g} per second")
    first = comments_from + int(ints[_COMMENTS])
    rows = -(-count // _PER_LINE)
    values = fixed_width(lines[first : first + rows], _WIDTH, count, where=where, first_line=first + 1)
    name, orientation = _direction(lines, ints)
    factor = UNITS_M_S2["cm/s2"] * orientation.sign
    channel = Channel(name, orientation, 1.0 / rate, values * factor, 0.0, *_stated(reals, factor))
    station = _STATION.search("\n".join(lines[:_TEXT_LINES]))
    facts = {"event": lines[3].strip(), "station": station.group(1).strip() if station else ""}
    warnings = (
        () if lines[0].lstrip().startswith("2") else ("uncorrected accelerogram: baseline and instrument as recorded",)
    )
    group = f"{facts['event']}|{facts['station']}"
    return RecordFile(where, NAME, TESTED_ON_ORIGINALS, "cm/s2", (channel,), facts, group, warnings)


def _direction(lines: list[str], ints: np.ndarray[tuple[int, ...], np.dtype[np.int64]]) -> tuple[str, Orientation]:
    match = _COMPONENT.search("\n".join(lines[:_TEXT_LINES]))
    name = match.group(1) if match else str(ints[_AZIMUTH])
    from_vertical, azimuth = int(ints[_VERTICAL]), int(ints[_AZIMUTH])
    if from_vertical in (0, 180):
        return name, Orientation(vertical=True, sign=1 if from_vertical == 0 else -1)
    return name, Orientation(azimuth % 360.0) if 0 <= azimuth <= 360 else parse_orientation(name)


def _stated(
    reals: np.ndarray[tuple[int, ...], np.dtype[np.float64]], factor: float
) -> tuple[float | None, float | None]:
    time_max, peak_max, time_min, peak_min = (float(value) for value in reals[slice(*_TIMES_AND_PEAKS)])
    if max(abs(value) for value in (time_max, peak_max, time_min, peak_min)) >= _NO_REAL:
        return None, None
    largest = (peak_max, time_max) if abs(peak_max) >= abs(peak_min) else (peak_min, time_min)
    return largest[0] * factor, largest[1]
