"""Volume 1 of CSMIP, USC, RENADIC and BHRC: per channel 13 text, 7 integer and 7 real lines, then uncorrected accelerations.

One layout of the 1970s, kept by four networks: pairs of time and g/10 with three decimals; BHRC writes even steps in g/10,
CSMIP today even steps in g below a line that says so.
"""

import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from harness.input.motions.process import clock_of
from harness.input.motions.recordfile import (
    NOT_NUMBERS,
    NUMERIC,
    Channel,
    ChannelOrientation,
    Header,
    RecordFile,
    first_of,
    fixed_width,
    fortran_format,
    free_format,
    header_number,
    mistake,
    parse_orientation,
)
from harness.model import Finding, caution

MARK = re.compile(r"\s*(FILE\s+\d+ OF )?UNCORRECTED\s+ACCELEROGRAM\s+DATA|\s*\* ?VOL1DS", re.IGNORECASE)
"""The first line of a channel."""
_TEXT_LINES, _NUMBER_LINES, _HEADER_LINES = 13, 14, 27
_UNITS = re.compile(r"\s*UNITS\b", re.IGNORECASE)
_PAIRED = re.compile(r"[-+]?[0-9]*\.[0-9]{3}")
"""Three decimals, so that a time of 100 s and more may touch the value before it."""
_EVEN = re.compile(
    r"\s*\d+\s+(?:accelerogram points at\s+(?P<rate>\S+)\s+pts/sec in units of\s+"
    r"|points of accel data equally spaced at\s+(?P<step>\S+)\s+sec\.?,?\s+(?:\(units:|in)\s*)"
    r"g(?P<tenths>/10)?[\s.)]*(?:Format:\s*)?(?P<form>\(.*\))?",
    re.IGNORECASE,
)
"""The line above even steps, of today and of the 1990s."""


def read(lines: list[str], where: str) -> RecordFile:
    """All channels of a volume 1 file; InputError where a header or values are missing."""
    starts = [i for i, line in enumerate(lines) if MARK.match(line)]
    channels = [
        _channel(lines, start, end, where) for start, end in zip(starts, [*starts[1:], len(lines)], strict=True)
    ]
    first, head = lines[starts[0]].upper(), Header(lines[: starts[0] + _HEADER_LINES], where)
    network = "BHRC" if "VOL1DS" in first else "USC" if "FILE" in first else "CSMIP"
    name = "RENADIC V1" if head.words("(RENADIC)") else f"{network} V1"
    event, station = (2, 7) if network == "BHRC" else (1, 5)
    facts = {"event": lines[event].strip(), "station": re.split(r"\s{2,}", lines[station].strip())[0]}
    found = (caution("record_uncorrected"), *(said for _, more in channels for said in more))
    group = "|".join((*facts.values(), lines[4].strip())) if network == "USC" else ""
    return RecordFile(where, name, "g", tuple(channel for channel, _ in channels), facts, group, found)


def _channel(lines: list[str], start: int, end: int, where: str) -> tuple[Channel, tuple[Finding, ...]]:
    units = next((i for i in range(start, end) if _UNITS.match(lines[i])), start)
    head = Header(lines[start : max(start + _TEXT_LINES, units + 1)], where, start)
    count = head.count(r"NO\. OF POINTS\s*=\s*(\d+)", "'NO. OF POINTS =' and how many")
    name = head.needed(r"^\s*(?:CHAN\s+\d+:|COMP\s)\s*(\S+)", "'CHAN 1:' or 'COMP' and a direction")[0]
    peak = head.peak(r"MAX\s*=\s*([-+.\d]+)\s*G\s*,\s*AT\s*([-+.\d]+)")
    first = _data_from(lines, start, units, end)
    data = [line for line in lines[first:end] if not line.lstrip().startswith("/&")]
    if data and (even := _EVEN.match(data[0])):
        place = f"line {first + 1}"
        spacing = header_number(even["rate"] or even["step"], where, place, "points per second, or a step")
        dt_s = 1.0 / spacing if even["rate"] else spacing
        per_line, width = fortran_format(even["form"] or "(8F9.6)", where, place)
        values = fixed_width(data[1 : 1 + -(-count // per_line)], width, count, where=where, first_line=first + 2)
        values = values / 10.0 if even["tenths"] else values
        return Channel.read(name, None, dt_s, values, "g", peak), ()
    head.needed(r"UNITS.*SEC.*(G/10)", "'UNITS … SEC AND G/10'")
    if "VOL1DS" in lines[start].upper():
        dt_s = head.number(r"DURATION\s*=\s*([\d.]+)", "'DURATION =' and seconds") / count
        values = first_of(free_format(data, where=where, first_line=first + 1), count, where, name)
        return Channel.read(name, _bhrc_direction(name, head), dt_s, values / 10.0, "g", peak), ()
    pairs = first_of(_pairs(data, where, first + 1), 2 * count, where, name).reshape(-1, 2)
    clock = clock_of(pairs[:, 0], where, largest=int(np.argmax(np.abs(pairs[:, 1]))))
    values = clock.on(pairs[:, 1]) / 10.0
    channel = Channel.read(name, None, clock.dt_s, values, "g", peak, clock.start_s)
    return channel, clock.of(name)


def _data_from(lines: list[str], start: int, units: int, end: int) -> int:
    """The place of the first line below a channel's header: the 28th; where some are blank, below its 14 of numbers."""
    usual = start + _HEADER_LINES
    if all(line.strip() for line in lines[start:usual]):
        return usual
    numbers = [i for i in range(units, end) if NUMERIC.fullmatch(lines[i])]
    return numbers[_NUMBER_LINES - 1] + 1 if len(numbers) >= _NUMBER_LINES else usual


def _pairs(data: Sequence[str], where: str, first_line: int) -> NDArray[np.float64]:
    """Times and values of all lines; InputError at anything but numbers of three decimals."""
    for i, line in enumerate(data):
        if rest := _PAIRED.sub("", line).strip():
            place = f"line {first_line + i}"
            raise mistake(where, place, "times and values with three decimals", repr(rest[:40]), NOT_NUMBERS)
    return np.array([float(number) for line in data for number in _PAIRED.findall(line)])


def _bhrc_direction(name: str, head: Header) -> ChannelOrientation:
    """BHRC names its channels L, V and T, and gives the azimuths of L and T in one line."""
    if name[:1].upper() == "V":
        return ChannelOrientation(vertical=True)
    return parse_orientation(head.words(rf"Azimuth.*\b{re.escape(name[:1])}\s+(\d+)"))
