"""CSMIP volume 2: per channel 25 text lines, header numbers, then acceleration, velocity and displacement blocks."""

from __future__ import annotations

import re
from typing import Final

from harness.input.motions.orientation import parse_orientation
from harness.input.motions.recordfile import UNITS_M_S2, Channel, RecordFile
from harness.input.motions.text import fixed_width, header_count, header_number, mistake, stated_peak

NAME: Final = "CSMIP V2"
TESTED_ON_ORIGINALS: Final = True

_FLOAT = r"([-+.\deEdD]+)"
_BLOCK = re.compile(
    r"^\s*(\d+)\s+POINTS OF ACCEL DATA EQUALLY SPACED AT\s+"
    + _FLOAT
    + r"\s+SEC[.,]\s+(?:\(UNITS:\s*|IN\s+)([^\s).]+)[).]?\.?\s*(?:\((\d+)F(\d+)\.)?",
    re.MULTILINE | re.IGNORECASE,
)
_CHANNEL = re.compile(r"CHAN\s+\d+:\s*(\S+)", re.IGNORECASE)
_PEAK = re.compile(r"PEAK ACCELERATION\s*=\s*" + _FLOAT + r"\s+\S+\s+AT\s+" + _FLOAT, re.IGNORECASE)
_UNITS: Final = {"CM/SEC/SEC": "cm/s2", "CM/SEC2": "cm/s2", "G": "g"}
_WIDTH, _PER_LINE = 10, 8


def recognises(text: str) -> bool:
    """Whether the first line says corrected accelerogram and a block of CSMIP's wording follows."""
    return "CORRECTED ACCELEROGRAM" in text[:200].upper() and _BLOCK.search(text) is not None


def read(text: str, where: str) -> RecordFile:
    """All channels of a CSMIP V2 file; InputError where values are missing or the unit is unknown."""
    lines = text.splitlines()
    blocks = [(i, block) for i, line in enumerate(lines) if (block := _BLOCK.match(line))]
    channels: list[Channel] = []
    head_from = 0
    for start, block in blocks:
        channels.append(_channel(lines, head_from, start, block, where))
        head_from = start + 1
    facts = {"event": lines[2].strip(), "station": lines[6].strip()}
    return RecordFile(where, NAME, TESTED_ON_ORIGINALS, "cm/s2", tuple(channels), facts)


def _channel(lines: list[str], head_from: int, start: int, block: re.Match[str], where: str) -> Channel:
    place, unit = f"line {start + 1}", block.group(3).strip()
    count = header_count(block.group(1), where, place, "number of points")
    dt_s = header_number(block.group(2), where, place, "step in seconds")
    if unit.upper() not in _UNITS:
        raise mistake(where, f"line {start + 1}", "accelerations in cm/sec/sec or g", repr(unit))
    # Files of today state their format; the older ones all have the same.
    per_line, width = max(int(block.group(4) or _PER_LINE), 1), int(block.group(5) or _WIDTH)
    data = lines[start + 1 : start + 1 + -(-count // per_line)]
    values = fixed_width(data, width, count, where=where, first_line=start + 2)
    head = "\n".join(line for line in lines[head_from:start] if not line.startswith("/&"))
    name = next(iter(_CHANNEL.findall(head)), "1")
    orientation = parse_orientation(name)
    factor = UNITS_M_S2[_UNITS[unit.upper()]] * orientation.sign
    peak = _PEAK.search(head)
    stated = stated_peak(peak, factor)
    return Channel(name, orientation, dt_s, values * factor, 0.0, *stated)
