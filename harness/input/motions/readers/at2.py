"""PEER's AT2: four header lines, then accelerations in g, one channel in a file."""

from __future__ import annotations

import re
from typing import Final

from harness.input.motions.orientation import parse_orientation
from harness.input.motions.recordfile import UNITS_M_S2, Channel, RecordFile
from harness.input.motions.text import free_format, header_count, header_number, mistake

NAME: Final = "PEER AT2"
TESTED_ON_ORIGINALS: Final = False

_NAMED = re.compile(r"NPTS\s*=\s*([^\s,]*)[\s,]*DT\s*=\s*([^\s,]*?)(?=[\s,]|SEC|$)", re.IGNORECASE)
_TRAILING = re.compile(r"^\s*(\S+)\s+(\S+)\s+NPTS\s*,\s*DT", re.IGNORECASE)
_UNITS = re.compile(r"UNITS?\s+OF\s+(\S+)", re.IGNORECASE)
_HEADER_LINES = 4


def recognises(text: str) -> bool:
    """Whether the number of points and the step stand on the fourth line, below one that speaks of acceleration."""
    head = text.splitlines()[:_HEADER_LINES]
    return len(head) == _HEADER_LINES and _points(head[3]) is not None and "ACCEL" in head[2].upper()


def _points(line: str) -> tuple[str, str] | None:
    """Number of points and step, as they are written."""
    match = _NAMED.search(line) or _TRAILING.search(line)
    return (match.group(1), match.group(2)) if match else None


def read(text: str, where: str) -> RecordFile:
    """The one channel of an AT2 file; InputError where values are missing or the unit is not g."""
    lines = text.splitlines()
    points = _points(lines[3])
    if points is None:
        raise mistake(where, "line 4", "NPTS= …, DT= … with a positive step", repr(lines[3].strip()))
    count = header_count(points[0], where, "line 4", "NPTS")
    dt_s = header_number(points[1], where, "line 4", "DT in seconds")
    unit = _UNITS.search(lines[2])
    if unit is None or unit.group(1).upper().strip(".,") != "G":
        raise mistake(where, "line 3", "an acceleration in units of g", repr(lines[2].strip()), "AT2 is always in g")
    values = free_format(lines[_HEADER_LINES:], where=where, first_line=_HEADER_LINES + 1)
    warnings: tuple[str, ...] = ()
    if values.size < count:
        raise mistake(
            where, "accelerations", f"{count} (NPTS)", f"{values.size}", "the file is cut off: download it again"
        )
    if values.size > count:
        warnings = (f"{values.size} values where NPTS says {count}: those after NPTS are left out",)
    parts = [part.strip() for part in lines[1].split(",")]
    name = parts[-1] or "1"
    orientation = parse_orientation(name)
    samples = values[:count] * UNITS_M_S2["g"] * orientation.sign
    channel = Channel(name, orientation, dt_s, samples)
    facts = {"event": parts[0], "station": ", ".join(parts[2:-1]) if len(parts) > 3 else parts[1] if parts[1:] else ""}
    return RecordFile(
        where, NAME, TESTED_ON_ORIGINALS, "g", (channel,), facts, group="|".join(parts[:-1]), warnings=warnings
    )
