"""K-NET and KiK-net ASCII (NIED): 17 header lines, then counts times a scale factor; one component in a file."""

import re
from typing import Final

from harness.input.motions.recordfile import (
    STANDARD_GRAVITY_M_S2,
    UNITS_M_S2,
    Channel,
    ChannelOrientation,
    Header,
    RecordFile,
    free_format,
    header_number,
)
from harness.model import info, require, required

MARK = re.compile(r"\s*origin time(?s:.{0,2000}?)(?:scale factor|station code)", re.IGNORECASE)
_SCALE = re.compile(r"([0-9.]+)\s*\(gal\)\s*/\s*([0-9.]+)", re.IGNORECASE)
# NIED's manual: north, east and up are positive. KiK-net numbers its components: 1 to 3 in the borehole, 4 to 6 above it.
_DIRECTIONS: Final = {
    "N-S": ChannelOrientation(0.0), "E-W": ChannelOrientation(90.0), "U-D": ChannelOrientation(vertical=True),
    **{str(place + add): ChannelOrientation(90.0 * place) for place in (0, 1) for add in (1, 4)},
    "3": ChannelOrientation(vertical=True), "6": ChannelOrientation(vertical=True),
}  # fmt: skip
_NAMES: Final = {"1": "NS1", "2": "EW1", "3": "UD1", "4": "NS2", "5": "EW2", "6": "UD2"}
_HEADER_LINES: Final = 17


def read(lines: list[str], where: str) -> RecordFile:
    """The one component of a K-NET or KiK-net file, its mean taken off as NIED does for its peak; InputError where incomplete."""
    first = next((i + 1 for i, line in enumerate(lines) if line.lower().startswith("memo")), _HEADER_LINES)
    head = Header(lines[:first], where)
    dt_s = 1.0 / head.number(r"^Sampling Freq\D*([0-9.]+)", "'Sampling Freq(Hz)' and the rate")
    scale, place = head.needed(r"^Scale Factor\s+(.*)", "'Scale Factor' and gal for a number of counts")
    factor = "a factor such as 3920(gal)/6182761"
    match = required(_SCALE.fullmatch(scale), where, factor, repr(scale), "the header is damaged", key=place)
    gal, counts = (header_number(part, where, place, "a part of the scale factor") for part in match.groups())
    values = free_format(lines[first:], where=where, first_line=first + 1) * (gal / counts)
    code = head.needed(r"^Dir\.\s+(\S+)", "'Dir.' and N-S, E-W, U-D or 1 to 6")[0].upper()
    require(code in _DIRECTIONS, where, "N-S, E-W, U-D or 1 to 6", repr(code), "the header is damaged", key="Dir.")
    seconds = head.number(r"^Duration Time\D*([0-9.]+)", "'Duration Time(s)' and the length")
    require(
        values.size >= round(seconds / dt_s),
        where,
        f"{round(seconds / dt_s)} numbers, as {seconds:g} s at {dt_s:g} s have",
        str(values.size),
        "the file is cut off",
        key="accelerations",
    )
    mean = float(values.mean())
    kik = code in _NAMES
    channel = Channel.read(
        _NAMES.get(code, code), _DIRECTIONS[code], dt_s, values - mean, "cm/s2", head.peak(r"^Max\. Acc\.\D*([0-9.]+)")
    )
    facts = {"event": head.words(r"^Origin Time\s+(.*)"), "station": head.words(r"^Station Code\s+(.*)")}
    if kik:
        facts["sensor"] = "borehole" if code in "123" else "surface"
    found = (
        info("record_rest_taken_off", channel=channel.name, rest_g=mean * UNITS_M_S2["cm/s2"] / STANDARD_GRAVITY_M_S2),
    )
    name = "KiK-net" if kik else "K-NET"
    group = "|".join((*facts.values(), head.words(r"^Record Time\s+(.*)")))
    return RecordFile(where, name, "cm/s2", (channel,), facts, group, found)
