"""Volume 2 of CSMIP and USC: per channel a text, an integer and a real header, then accelerations, velocities, displacements."""

import re

import numpy as np

from harness.input.motions.recordfile import (
    CUT_OFF,
    STATED_PEAK_TOLERANCE,
    Channel,
    Header,
    RecordFile,
    block,
    check_rows,
    fortran_format,
    header_count,
    header_number,
    unit_named,
)
from harness.model import require, required

MARK = re.compile(r"(?s:.{0,180}?)CORRECTED ACCELEROGRAM", re.IGNORECASE)
"""Of CSMIP's volume 2, too; SMC and GeoNet are asked first."""
_FLOAT = r"([-+.\deEdD]+)"
_BLOCK = re.compile(
    r"^\s*(\d{1,9})\s+POINTS OF (?:[A-Z ,&]*\s)?(ACC(?:EL\w*)?)\.?\s+DATA,?\s+EQUALLY SPACED AT\s+(\S+)\s+SEC(?:ONDS?)?\b[.,]?\s*"
    r"(?:\(?\s*UNITS?\s*(?::|=|ARE)?\s*|IN\s+|\((?=[A-Z]))?(?:([A-Z/*^²2]*?)[).]?\.?)?\s*(\(\s*\d.*)?$",
    re.IGNORECASE,
)
_PART = re.compile(r"^\s*(\d{1,9})\s+POINTS OF .*?\bDATA\b.*?(\(\s*\d[^()]*\))?\s*$", re.IGNORECASE)
"""Accelerations, velocities or displacements."""
_OLD_FORMAT = "(8F10.3)"
"""Files of today state their format; the older ones all have the same."""


def read(lines: list[str], where: str) -> RecordFile:
    """All channels of a CSMIP V2 file; InputError where values are missing or the unit is unknown."""
    blocks = [(i, said) for i, line in enumerate(lines) if (said := _BLOCK.match(line))]
    require(
        blocks,
        where,
        "a line such as '3251 points of accel data equally spaced at .020 sec, in cm/sec2'",
        "none",
        "the file is cut off, or holds no corrected accelerations",
    )
    parts = [(i, part) for i, line in enumerate(lines) if (part := _PART.match(line))]
    last, part = parts[-1]
    per_line, _ = fortran_format(part.group(2) or _OLD_FORMAT, where, f"line {last + 1}")
    rows = -(-int(part.group(1)) // per_line)
    check_rows(lines, last + 1, rows, where)
    require(
        not len(parts) % len(blocks) and not any("ACCELEROGRAM" in line.upper() for line in lines[last + 1 + rows :]),
        where,
        "as many in each",
        f"{len(parts)} blocks of numbers in {len(blocks)} channels",
        CUT_OFF,
        key=f"line {len(lines)}",
    )
    heads = [0, *(start + 1 for start, _ in blocks)]
    channels = [_channel(lines, head, *place, where) for head, place in zip(heads, blocks, strict=False)]
    facts = {"event": lines[2].strip(), "station": lines[6].strip() if len(lines) > 6 else ""}
    name = "CSMIP V2" if all(said[2].upper() == "ACCEL" for _, said in blocks) else "USC V2"
    return RecordFile(where, name, "cm/s2", tuple(channels), facts)


def _channel(lines: list[str], head_from: int, start: int, said: re.Match[str], where: str) -> Channel:
    place = f"line {start + 1}"
    count = header_count(said.group(1), where, place, "number of points")
    dt_s = header_number(said.group(3), where, place, "step in seconds")
    head = Header([line for line in lines[head_from:start] if not line.startswith("/&")], where)
    # USC's lines need not name the unit: their peak does.
    written = said.group(4) or head.words(rf"PEAK\s+ACC\w*\.?\s*=\s*{_FLOAT.replace('(', '(?:')}\s+(\S+?),?\s+AT\b")
    unit = required(unit_named(written), where, "accelerations in cm/sec/sec or g", repr(written), key=place)
    form = fortran_format(said.group(5) or _OLD_FORMAT, where, place)
    values = block(lines, start + 1, count, form, where)
    name = head.words(r"CHAN\s+\d+:\s*(\S+)") or head.words(r"\bCOMP(?:ONENT)?\s*:?\s+(\S+)") or "1"
    peak = head.peak(rf"PEAK\s+ACC\w*\.?\s*=\s*{_FLOAT}\s+\S+\s+AT\s+{_FLOAT}")
    largest = float(np.abs(values).max())
    require(
        said.group(4) or abs(largest - abs(peak[0] or 0.0)) <= STATED_PEAK_TOLERANCE * largest,
        where,
        f"accelerations in the unit of their peak, {peak[0]} {written}",
        f"a peak of {largest:g}",
        key=place,
    )
    return Channel.read(name, None, dt_s, values, unit, peak)
