"""Türkiye's strong-motion network (AFAD, NSMN): "KEY : value" lines, then three columns in gal under N-S, E-W, U-D."""

import re

from harness.input.motions.recordfile import Channel, Header, RecordFile, columns
from harness.model import require, required

MARK = re.compile(r"(?s:.{0,170}?)STRONG GROUND MOTION RECORDS OF T", re.IGNORECASE)
_NAMES = re.compile(r"^\s*([NSEWUD]-[NSEWUD])\s+([NSEWUD]-[NSEWUD])\s+([NSEWUD]-[NSEWUD])\s*$", re.IGNORECASE)


def read(lines: list[str], where: str) -> RecordFile:
    """The three channels; InputError where the header or a column is incomplete."""
    named = required(
        next((i for i, line in enumerate(lines) if _NAMES.match(line)), None),
        where,
        "a line that names the columns, 'N-S E-W U-D'",
        "none",
        "the file is damaged",
    )
    names = lines[named].upper().split()
    head = Header(lines[:named], where)
    count = head.count(r"^NUMBER OF DATA\s*:(.*)", "'NUMBER OF DATA' and how many")
    dt_s = head.number(r"^SAMPLING INTERVAL\s*\((?i:sec)\)\s*:(.*)", "'SAMPLING INTERVAL (sec)' and a step")
    require(
        head.words(r"PGA VALUES\s*\((gal)\)"),
        where,
        "'PGA VALUES (gal)', which says the unit",
        "none",
        "the header is damaged",
        key="header",
    )
    values = columns(lines[named + 1 :], len(names), where=where, first_line=named + 2)
    require(
        len(values) == count,
        where,
        f"{count} lines of numbers",
        str(len(values)),
        "the file is cut off",
        key="NUMBER OF DATA",
    )
    channels = [
        Channel.read(
            name, None, dt_s, values[:, i], "cm/s2",
            head.peak(rf"PGA VALUES.*\({re.escape(name)}\)\s*([-+.\d]+)"),
        )
        for i, name in enumerate(names)
    ]  # fmt: skip
    facts = {"event": head.words(r"^EARTHQUAKE DATE\s*:(.*)"), "station": head.words(r"^STATION ID\s*:(.*)")}
    return RecordFile(where, "NSMN (AFAD)", "cm/s2", tuple(channels), facts)
