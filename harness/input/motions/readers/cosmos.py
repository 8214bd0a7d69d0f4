"""COSMOS volume 1 to 3 (V1, V2, V1C, V2C): self-describing header and data blocks, one or more channels in a file."""

from __future__ import annotations

import re
from typing import Final

from harness.input.motions.orientation import Orientation, parse_orientation
from harness.input.motions.recordfile import UNITS_M_S2, Channel, RecordFile
from harness.input.motions.text import fixed_width, mistake

NAME: Final = "COSMOS"
TESTED_ON_ORIGINALS: Final = False

_HEADER = re.compile(
    r"^\s*(\d+)\s+(Integer|Real)-header values follow on\s+(\d+)\s+lines?,\s*Format\s*=\s*\(\s*\d*[IFE](\d+)",
    re.IGNORECASE,
)
_DATA = re.compile(
    r"^\s*(\d+)\s+accel\S*\s+pts,\s*approx\s+(\d+)\s*secs,\s*units\s*=\s*([^,(]+?)\s*(?:\(\s*\d+\s*\))?\s*,"
    r"\s*Format\s*=\s*\(\s*(\d*)[FEG](\d+)",
    re.IGNORECASE,
)
_CHANNEL = re.compile(r"Sta Chan?:?\s+\S+:\s*(\S+)", re.IGNORECASE)
_UNITS: Final = {"cm/s^2": "cm/s2", "cm/sec2": "cm/s2", "cm/sec/sec": "cm/s2", "cm/s/s": "cm/s2", "g": "g"}
_DIRECTION, _STEP = 53, (61, 33)  # places in the integer and the real header, from 0: of the data, of the raw file
_PEAK, _PEAK_TIME = 63, 64
_UNKNOWN = -999.0
_UP, _DOWN = 400, 401
_DURATION_TOLERANCE_S = 1.5  # "approx" is in whole seconds


def recognises(text: str) -> bool:
    """Whether COSMOS's two header blocks are announced in its words."""
    head = text[:20000]
    return "Integer-header values follow on" in head and "Real-header values follow on" in head


def read(text: str, where: str) -> RecordFile:
    """All acceleration channels of a COSMOS file; InputError where a block is incomplete."""
    lines = text.splitlines()
    channels: list[Channel] = []
    numbers: dict[str, list[float]] = {}
    text_from, unit = 0, "cm/s2"
    for i, line in enumerate(lines):
        if header := _HEADER.match(line):
            count, kind, rows, width = (header.group(k) for k in (1, 2, 3, 4))
            block = lines[i + 1 : i + 1 + int(rows)]
            values = fixed_width(block, int(width), int(count), where=where, first_line=i + 2, what=f"{kind} header")
            numbers[kind.lower()] = values.tolist()
        elif data := _DATA.match(line):
            channel, unit = _channel(lines, i, data, numbers, "\n".join(lines[text_from:i]), where)
            channels.append(channel)
            numbers, text_from = {}, i + 1
    if not channels:
        raise mistake(
            where, "", "an acceleration block in cm/s² or g", "none", "raw counts (V0) cannot be used: take V1 or V2"
        )
    facts = {"event": " ".join(lines[1].split()), "station": " ".join(lines[4].split()) if len(lines) > 4 else ""}
    group = f"{facts['event']}|{facts['station']}" if len(channels) == 1 else ""
    return RecordFile(where, NAME, TESTED_ON_ORIGINALS, unit, tuple(channels), facts, group)


def _channel(
    lines: list[str], i: int, data: re.Match[str], numbers: dict[str, list[float]], head: str, where: str
) -> tuple[Channel, str]:
    count, duration, unit = int(data.group(1)), float(data.group(2)), data.group(3).strip().lower()
    per_line, width = max(int(data.group(4) or 1), 1), int(data.group(5))
    if unit not in _UNITS:
        raise mistake(
            where, f"line {i + 1}", "accelerations in cm/s² or g", repr(unit), "raw counts (V0): take V1 or V2"
        )
    integers, reals = numbers.get("integer", []), numbers.get("real", [])
    if len(integers) <= _DIRECTION or len(reals) <= _PEAK_TIME or count < 2:
        raise mistake(where, f"line {i + 1}", "whole integer and real headers before the data", "shorter ones")
    dt_s = _step_s([reals[place] for place in _STEP], count, duration, where)
    values = fixed_width(lines[i + 1 : i + 1 + -(-count // per_line)], width, count, where=where, first_line=i + 2)
    name, orientation = _direction(int(integers[_DIRECTION]), head)
    factor = UNITS_M_S2[_UNITS[unit]] * orientation.sign
    known = _UNKNOWN not in (reals[_PEAK], reals[_PEAK_TIME])
    stated = (reals[_PEAK] * factor, reals[_PEAK_TIME]) if known else (None, None)
    return Channel(name, orientation, dt_s, values * factor, 0.0, *stated), _UNITS[unit]


def _step_s(stated: list[float], count: int, duration_s: float, where: str) -> float:
    """The step in seconds, which some networks write in seconds and some in milliseconds: the stated duration decides."""
    for dt_s in (value * unit for value in stated for unit in (1e-3, 1.0)):
        if dt_s > 0.0 and abs(count * dt_s - duration_s) <= _DURATION_TOLERANCE_S:
            return dt_s
    got = " and ".join(f"{value:g}" for value in stated)
    wanted = f"a step with which {count} points last about {duration_s:g} s"
    raise mistake(where, "real headers 62 and 34", wanted, got)


def _direction(code: int, head: str) -> tuple[str, Orientation]:
    if code in (_UP, _DOWN):
        return "UP" if code == _UP else "DOWN", Orientation(vertical=True, sign=1 if code == _UP else -1)
    if 0 <= code <= 360:
        return f"{code % 360:03d}", Orientation(code % 360.0)
    match = _CHANNEL.search(head)
    name = match.group(1) if match else str(code)
    return name, parse_orientation(name)
