"""GeoNet's V2A: per channel 16 text and 10 number lines, then accelerations, velocities, displacements in mm and s."""

from __future__ import annotations

import re
from typing import Final

from harness.input.motions.orientation import parse_orientation
from harness.input.motions.recordfile import UNITS_M_S2, Channel, RecordFile
from harness.input.motions.text import fixed_width, header_count, header_number, mistake, stated_peak

NAME: Final = "GeoNet V2A"
TESTED_ON_ORIGINALS: Final = True

_COMPONENT = re.compile(r"^Component\s+(\S+)", re.IGNORECASE)
_POINTS = re.compile(r"Number of points\s+(\d+)", re.IGNORECASE)
_STEP = re.compile(r"data at\s+(\S+)\s+sec", re.IGNORECASE)
_PEAK = re.compile(r"^Acceleration:\s+peak\s+([-+.\deEdD]+)\s*\S+\s+at\s+(\S+)\s+sec", re.IGNORECASE)
_TEXT_LINES, _NUMBER_LINES, _WIDTH, _PER_LINE = 16, 10, 8, 10
_COMPONENT_LINE, _BLOCKS = 12, 3


def recognises(text: str) -> bool:
    """Whether the first channel's 13th line names its component and its 14th an acceleration in mm/s/s."""
    head = text.splitlines()[:_TEXT_LINES]
    return len(head) == _TEXT_LINES and bool(_COMPONENT.match(head[_COMPONENT_LINE])) and "mm/s/s" in head[13]


def read(text: str, where: str) -> RecordFile:
    """All channels of a V2A file; InputError where values are missing."""
    lines = text.splitlines()
    channels: list[Channel] = []
    start = 0
    while start < len(lines) and lines[start].strip():
        channel, used = _channel(lines, start, where)
        channels.append(channel)
        start += used
    facts = {"event": lines[7].strip(), "station": f"{lines[1].split()[1]}, {lines[2].strip()}"}
    return RecordFile(where, NAME, TESTED_ON_ORIGINALS, "mm/s2", tuple(channels), facts)


def _channel(lines: list[str], start: int, where: str) -> tuple[Channel, int]:
    head = lines[start : start + _TEXT_LINES]
    points, step = (_search(pattern, head, where, start) for pattern in (_POINTS, _STEP))
    place = f"lines {start + 1} to {start + len(head)}"
    count = header_count(points.group(1), where, place, "number of points")
    dt_s = header_number(step.group(1), where, place, "step in seconds")
    name = _search(_COMPONENT, head, where, start).group(1)
    orientation = parse_orientation(name)
    factor = UNITS_M_S2["mm/s2"] * orientation.sign
    first = start + _TEXT_LINES + _NUMBER_LINES
    rows = -(-count // _PER_LINE)
    values = fixed_width(lines[first : first + rows], _WIDTH, count, where=where, first_line=first + 1)
    peak = next((match for line in head if (match := _PEAK.match(line))), None)
    stated = stated_peak(peak, factor)
    return Channel(name, orientation, dt_s, values * factor, 0.0, *stated), first - start + _BLOCKS * rows


def _search(pattern: re.Pattern[str], head: list[str], where: str, start: int) -> re.Match[str]:
    for line in head:
        if match := pattern.search(line):
            return match
    raise mistake(where, f"lines {start + 1} to {start + len(head)}", f"a V2A header with {pattern.pattern!r}", "none")
