"""GeoNet's V1A and V2A: per channel 16 text and 10 number lines, then accelerations (V2A: also velocities, displacements)."""

import re

from harness.input.motions.recordfile import NUMERIC, Channel, Header, RecordFile, block, check_rows
from harness.model import caution, require

MARK = re.compile(r"[^\S\n]*(un)?corrected accelerogram\b.*\bGNS|(?:.*\n){12}Component.*\n.*mm/s/s", re.IGNORECASE)
"""The first line of a channel names an accelerogram of GNS; or, where it was lost, the 13th and 14th are of their form."""
_TEXT_LINES, _NUMBER_LINES, _WIDTH, _PER_LINE = 16, 10, 8, 10


def read(lines: list[str], where: str) -> RecordFile:
    """All channels of a V1A or V2A file; InputError where values are missing."""
    name = "GeoNet V1A" if lines[0].lower().lstrip().startswith("un") else "GeoNet V2A"
    channels: list[Channel] = []
    start = 0
    while sum(bool(line.strip()) for line in lines[start:]) > _TEXT_LINES + _NUMBER_LINES:  # less is a note
        channel, used = _channel(lines, start, where, blocks=3 if name == "GeoNet V2A" else 1)
        channels.append(channel)
        start += used
    rest = next((line for line in lines[start:] if line.strip()), "")
    require(
        channels and not MARK.match(rest) and not NUMERIC.fullmatch(rest),
        where,
        "a channel, or the end",
        repr(rest.strip()),
        "the file is cut off, or a line is there twice: download it again",
        key=f"line {start + 1}",
    )
    site = lines[1].split()
    facts = {"event": lines[7].strip(), "station": f"{site[1] if len(site) > 1 else ''}, {lines[2].strip()}"}
    found = (caution("record_uncorrected"),) if name == "GeoNet V1A" else ()
    return RecordFile(where, name, "mm/s2", tuple(channels), facts, findings=found)


def _channel(lines: list[str], start: int, where: str, blocks: int) -> tuple[Channel, int]:
    head = Header(lines[start : start + _TEXT_LINES], where, start)
    count = head.count(r"^\s*Number of points\s+(\S+)", "'Number of points' and how many")
    dt_s = head.number(
        r"(?:data at|intervals of)\s+(\S+)\s*s", "a step, 'at intervals of 0.005 s' or 'data at 0.020 sec'"
    )
    name = head.needed(r"^Component\s+(\S+)", "'Component' and a direction")[0]
    first = start + _TEXT_LINES + _NUMBER_LINES
    shifted = NUMERIC.fullmatch(lines[start + _TEXT_LINES - 1])
    require(
        not shifted and all(NUMERIC.fullmatch(line) for line in lines[start + _TEXT_LINES : first]),
        where,
        f"{_TEXT_LINES} lines of text, then {_NUMBER_LINES} of numbers",
        "others",
        "lines are missing, or too many",
        key=f"lines {start + 1} to {first}",
    )
    rows = -(-count // _PER_LINE)
    check_rows(lines, first, blocks * rows, where)
    values = block(lines, first, count, (_PER_LINE, _WIDTH), where)
    if head.find(r"(Raw readings)")[0]:
        values = values * head.number(r"in units of\s+(\S+)\s*mm/s/s", "a unit of so many mm/s/s")
    peak = head.peak(r"^Acceleration:\s+peak\s+([-+.\deEdD]+)\s*\S+\s+at\s+(\S+)\s+s")
    channel = Channel.read(name, None, dt_s, values, "mm/s2", peak)
    return channel, first - start + blocks * rows
