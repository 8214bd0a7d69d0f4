"""USGS SMC: 11 text lines, 48 integers, 50 reals, comments, then accelerations in cm/s², even or in pairs with their times."""

import re
from typing import Final

import numpy as np

from harness.input.motions.process import SampleClock, clock_of
from harness.input.motions.recordfile import (
    Channel,
    ChannelOrientation,
    Floats,
    Header,
    RecordFile,
    block,
    parse_orientation,
)
from harness.model import caution, require

MARK = re.compile(r"[^\S\n]*[1-6]\s.*(?:ACCELEROGRAM|VELOCITY|DISPLACEMENT|SPECTR).*\n\*", re.IGNORECASE)
"""The first line is "2 CORRECTED ACCELEROGRAM", or another kind's, and the second begins with *."""
_TEXT_LINES, _INTEGER_LINES, _REAL_LINES = 11, 6, 10
_VERTICAL, _AZIMUTH, _COMMENTS, _COUNT = 12, 13, 15, 16  # places among the integers, from 0
_RATE, _TIMES_AND_PEAKS = 1, (28, 32)  # places among the reals, from 0
_NO_REAL = 1e38
_INTEGERS, _REALS, _VALUES = (8, 10), (5, 15), (8, 10)  # numbers in a line, and characters in a number
_LARGEST_INTEGER: Final = 1e10


def read(lines: list[str], where: str) -> RecordFile:
    """The one channel of an SMC file; InputError where it holds no accelerations, or header or values are incomplete."""
    kind = lines[0].split()[0]
    require(
        kind in ("1", "2"),
        where,
        "1 UNCORRECTED or 2 CORRECTED ACCELEROGRAM",
        repr(lines[0].strip()),
        "take the file whose first line says ACCELEROGRAM",
        key="line 1",
    )
    ints = block(lines, _TEXT_LINES, 48, _INTEGERS, where, "integer header")
    largest = float(np.max(np.abs(ints)))
    require(largest <= _LARGEST_INTEGER, where, "integers of at most ten digits", f"{largest:g}", key="integer header")
    reals = block(lines, _TEXT_LINES + _INTEGER_LINES, 50, _REALS, where, "real header")
    first = _TEXT_LINES + _INTEGER_LINES + _REAL_LINES + max(int(ints[_COMMENTS]), 0)
    count, rate = int(ints[_COUNT]), float(reals[_RATE])
    paired = kind == "1" and rate >= _NO_REAL
    require(
        count >= 2 and (paired or 0.0 < rate < 1e5),
        where,
        "a number of values and a sampling rate",
        f"{count} and {rate:g} per second",
        key="header",
    )
    values = block(lines, first, count, _VALUES, where)
    head = Header(lines[:_TEXT_LINES], where)
    name = head.words(r"component\s*=\s*(\S+)") or str(int(ints[_AZIMUTH]))
    clock = SampleClock(0.0, 1.0 / rate, count)
    if paired:
        times, values = values[: count // 2 * 2].reshape(-1, 2).T
        clock = clock_of(times, where, largest=int(np.argmax(np.abs(values))))
    peak, start_s = _stated(reals, clock.start_s), clock.start_s
    channel = Channel.read(name, _direction(name, ints), clock.dt_s, clock.on(values), "cm/s2", peak, start_s)
    facts = {"event": lines[3].strip(), "station": head.words(r"station\s*=\s*(.*?)\s*component\s*=")}
    raw = () if kind == "2" else (caution("record_uncorrected"),)
    form = "USGS SMC" if kind == "2" else "USGS SMC, uncorrected"
    group = f"{facts['event']}|{facts['station']}"
    return RecordFile(where, form, "cm/s2", (channel,), facts, group, (*raw, *clock.of(name)))


def _direction(name: str, ints: Floats) -> ChannelOrientation:
    from_vertical, azimuth = float(ints[_VERTICAL]), float(ints[_AZIMUTH])
    if from_vertical in (0.0, 180.0):
        return ChannelOrientation(vertical=True, sign=1 if from_vertical == 0.0 else -1)
    return ChannelOrientation(azimuth % 360.0) if 0.0 <= azimuth <= 360.0 else parse_orientation(name)


def _stated(reals: Floats, start_s: float) -> tuple[float | None, float | None]:
    """The larger of the header's two peaks, and its time after the first sample."""
    time_max, peak_max, time_min, peak_min = (float(value) for value in reals[slice(*_TIMES_AND_PEAKS)])
    if max(abs(value) for value in (time_max, peak_max, time_min, peak_min)) >= _NO_REAL:
        return None, None
    return (peak_max, time_max - start_s) if abs(peak_max) >= abs(peak_min) else (peak_min, time_min - start_s)
