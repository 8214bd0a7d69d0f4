"""CSMIP volume 2: per channel a text, an integer and a real header, then acceleration, velocity and displacement blocks."""

from __future__ import annotations

import re

from harness.input.motions.recordfile import Channel, RecordFile, unit_named
from harness.input.motions.text import Header, fixed_width, fortran_format, header_count, header_number, mistake

_FLOAT = r"([-+.\deEdD]+)"
_BLOCK = re.compile(
    r"^\s*(\d+)\s+POINTS OF ACCEL DATA EQUALLY SPACED AT\s+(\S+)\s+SEC[.,]\s+(?:\(UNITS:\s*|IN\s+)([^\s).]+)[).]?\.?\s*(\(.*)?",
    re.IGNORECASE,
)
_OLD_FORMAT = "(8F10.3)"
"""Files of today state their format; the older ones all have the same."""


def recognises(text: str) -> bool:
    """Whether the first lines say corrected accelerogram (CSMIP's volume 2; SMC and GeoNet are asked first)."""
    return "CORRECTED ACCELEROGRAM" in text[:200].upper()


def read(text: str, where: str) -> RecordFile:
    """All channels of a CSMIP V2 file; InputError where values are missing or the unit is unknown."""
    lines = text.splitlines()
    blocks = [(i, block) for i, line in enumerate(lines) if (block := _BLOCK.match(line))]
    if not blocks:
        wanted = "a line such as '3251 points of accel data equally spaced at .020 sec, in cm/sec2'"
        raise mistake(where, "", wanted, "none", "the file is cut off, or holds no corrected accelerations")
    channels: list[Channel] = []
    head_from = 0
    for start, block in blocks:
        channels.append(_channel(lines, head_from, start, block, where))
        head_from = start + 1
    facts = {"event": lines[2].strip(), "station": lines[6].strip() if len(lines) > 6 else ""}
    return RecordFile(where, "CSMIP V2", "cm/s2", tuple(channels), facts)


def _channel(lines: list[str], head_from: int, start: int, block: re.Match[str], where: str) -> Channel:
    place, unit = f"line {start + 1}", unit_named(block.group(3))
    count = header_count(block.group(1), where, place, "number of points")
    dt_s = header_number(block.group(2), where, place, "step in seconds")
    if unit is None:
        raise mistake(where, place, "accelerations in cm/sec/sec or g", repr(block.group(3)))
    per_line, width = fortran_format(block.group(4) or _OLD_FORMAT, where, place)
    data = lines[start + 1 : start + 1 + -(-count // per_line)]
    values = fixed_width(data, width, count, where=where, first_line=start + 2)
    head = Header([line for line in lines[head_from:start] if not line.startswith("/&")], where)
    name = head.words(r"CHAN\s+\d+:\s*(\S+)") or "1"
    peak = head.peak(rf"PEAK ACCELERATION\s*=\s*{_FLOAT}\s+\S+\s+AT\s+{_FLOAT}")
    return Channel.read(name, None, dt_s, values, unit, peak)
