"""PEER's AT2: four header lines, then accelerations in g, one channel in a file."""

import re

from harness.input.motions.recordfile import (
    Channel,
    RecordFile,
    first_of,
    free_format,
    header_count,
    header_number,
)
from harness.model import caution, require, required

MARK = re.compile(r"PEER .*(?:\n.*){3}|(?:.*\n){3}.*\bNPTS\b.*\bDT\b", re.IGNORECASE)
"""The first line says PEER, or the fourth speaks of the number of points and the step."""
_NAMED = re.compile(
    r"NPTS\s*=\s*([^\s,]*)[\s,]*DT\s*=\s*([^\s,]*?(?:\s+(?:[ED]?[+-]?\d|M(?:ILLI)?S)[^\s,]*)?)(?=[\s,]|SEC|$)",
    re.IGNORECASE,
)
"""A step goes on to the next word where that is the rest of its number, or a unit that is not the second: neither is left out."""
_TRAILING = re.compile(r"^\s*(\S+?),?\s+(\S+?),?\s+NPTS\s*,\s*DT", re.IGNORECASE)
_ACCELERATION = re.compile(r"ACCEL.*UNITS?\s+OF\s+G\b", re.IGNORECASE)
_HEADER_LINES = 4


def _points(line: str) -> tuple[str, str] | None:
    """Number of points and step, as they are written."""
    match = _NAMED.search(line) or _TRAILING.search(line)
    return (match.group(1), match.group(2)) if match else None


def read(lines: list[str], where: str) -> RecordFile:
    """The one channel of an AT2 file; InputError where values are missing or are no accelerations in g."""
    points = required(
        _points(lines[3]), where, "NPTS= …, DT= … with a positive step", repr(lines[3].strip()), key="line 4"
    )
    count = header_count(points[0], where, "line 4", "NPTS")
    dt_s = header_number(points[1], where, "line 4", "DT in seconds")
    require(
        _ACCELERATION.search(lines[2]),
        where,
        "an acceleration in units of g",
        repr(lines[2].strip()),
        "AT2 is always in g; VT2 and DT2 hold velocities and displacements",
        key="line 3",
    )
    every = free_format(lines[_HEADER_LINES:], where=where, first_line=_HEADER_LINES + 1)
    values = first_of(every, count, where, "accelerations")
    found = (caution("record_values_left_out", values=every.size, stated=count),) if every.size > count else ()
    parts = [part.strip() for part in lines[1].split(",")]
    name = parts[-1] or "1"
    channel = Channel.read(name, None, dt_s, values, "g")
    facts = {"event": parts[0], "station": ", ".join(parts[2:-1]) if len(parts) > 3 else parts[1] if parts[1:] else ""}
    return RecordFile(where, "PEER AT2", "g", (channel,), facts, group="|".join(parts[:-1]), findings=found)
