"""The networks' volumes: for each channel lines of text, of whole numbers and of reals, then blocks of numbers of one width."""

import re
from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.input.motions.process import SampleClock, clock_of
from harness.input.motions.recordfile import (
    CUT_OFF,
    NOT_NUMBERS,
    NUMERIC,
    STATED_PEAK_TOLERANCE,
    Channel,
    ChannelOrientation,
    Floats,
    Header,
    RecordFile,
    block,
    check_rows,
    first_of,
    fixed_width,
    fortran_format,
    free_format,
    header_count,
    header_number,
    mistake,
    parse_orientation,
    unit_named,
)
from harness.model import Finding, caution, info, require, required

# GeoNet's V1A and V2A: per channel 16 text and 10 number lines, then accelerations (V2A: also velocities, displacements).

GEONET = re.compile(r"[^\S\n]*(un)?corrected accelerogram\b.*\bGNS|(?:.*\n){12}Component.*\n.*mm/s/s", re.IGNORECASE)
"""The first line of a channel names an accelerogram of GNS; or, where it was lost, the 13th and 14th are of their form."""
_GEONET_TEXT_LINES, _GEONET_NUMBER_LINES, _GEONET_WIDTH, _GEONET_PER_LINE = 16, 10, 8, 10


def geonet(lines: list[str], where: str) -> RecordFile:
    """All channels of a V1A or V2A file; InputError where values are missing."""
    name = "GeoNet V1A" if lines[0].lower().lstrip().startswith("un") else "GeoNet V2A"
    channels: list[Channel] = []
    start = 0
    while (
        sum(bool(line.strip()) for line in lines[start:]) > _GEONET_TEXT_LINES + _GEONET_NUMBER_LINES
    ):  # less is a note
        channel, used = _geonet_channel(lines, start, where, blocks=3 if name == "GeoNet V2A" else 1)
        channels.append(channel)
        start += used
    rest = next((line for line in lines[start:] if line.strip()), "")
    require(
        channels and not GEONET.match(rest) and not NUMERIC.fullmatch(rest),
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


def _geonet_channel(lines: list[str], start: int, where: str, blocks: int) -> tuple[Channel, int]:
    head = Header(lines[start : start + _GEONET_TEXT_LINES], where, start)
    count = head.count(r"^\s*Number of points\s+(\S+)", "'Number of points' and how many")
    dt_s = head.number(
        r"(?:data at|intervals of)\s+(\S+)\s*s", "a step, 'at intervals of 0.005 s' or 'data at 0.020 sec'"
    )
    name = head.needed(r"^Component\s+(\S+)", "'Component' and a direction")[0]
    first = start + _GEONET_TEXT_LINES + _GEONET_NUMBER_LINES
    shifted = NUMERIC.fullmatch(lines[start + _GEONET_TEXT_LINES - 1])
    require(
        not shifted and all(NUMERIC.fullmatch(line) for line in lines[start + _GEONET_TEXT_LINES : first]),
        where,
        f"{_GEONET_TEXT_LINES} lines of text, then {_GEONET_NUMBER_LINES} of numbers",
        "others",
        "lines are missing, or too many",
        key=f"lines {start + 1} to {first}",
    )
    rows = -(-count // _GEONET_PER_LINE)
    check_rows(lines, first, blocks * rows, where)
    values = block(lines, first, count, (_GEONET_PER_LINE, _GEONET_WIDTH), where)
    if head.find(r"(Raw readings)")[0]:
        values = values * head.number(r"in units of\s+(\S+)\s*mm/s/s", "a unit of so many mm/s/s")
    peak = head.peak(r"^Acceleration:\s+peak\s+([-+.\deEdD]+)\s*\S+\s+at\s+(\S+)\s+s")
    channel = Channel.read(name, None, dt_s, values, "mm/s2", peak)
    return channel, first - start + blocks * rows


# USGS SMC: 11 text lines, 48 integers, 50 reals, comments, then accelerations in cm/s², even or in pairs with their times.

"""The first line is "2 CORRECTED ACCELEROGRAM", or another kind's, and the second begins with *."""
_SMC_TEXT_LINES, _INTEGER_LINES, _REAL_LINES = 11, 6, 10
_VERTICAL, _AZIMUTH, _COMMENTS, _COUNT = 12, 13, 15, 16  # places among the integers, from 0
_RATE, _TIMES_AND_PEAKS = 1, (28, 32)  # places among the reals, from 0
_NO_REAL = 1e38
_INTEGERS, _REALS, _VALUES = (8, 10), (5, 15), (8, 10)  # numbers in a line, and characters in a number
_LARGEST_INTEGER: Final = 1e10


def smc(lines: list[str], where: str) -> RecordFile:
    """The one channel of an SMC file; InputError where it holds no accelerations, or header or values are incomplete."""
    kind = lines[0].split()[0]
    require(
        kind in ("1", "2"),
        where,
        "1 UNCORRECTED or 2 CORRECTED ACCELEROGRAM",
        repr(lines[0].strip()),
        "take the file whose first line says ACCELEROGRAM",
        key="line 1",
    )
    ints = block(lines, _SMC_TEXT_LINES, 48, _INTEGERS, where, "integer header")
    largest = float(np.max(np.abs(ints)))
    require(largest <= _LARGEST_INTEGER, where, "integers of at most ten digits", f"{largest:g}", key="integer header")
    reals = block(lines, _SMC_TEXT_LINES + _INTEGER_LINES, 50, _REALS, where, "real header")
    first = _SMC_TEXT_LINES + _INTEGER_LINES + _REAL_LINES + max(int(ints[_COMMENTS]), 0)
    count, rate = int(ints[_COUNT]), float(reals[_RATE])
    paired = kind == "1" and rate >= _NO_REAL
    require(
        count >= 2 and (paired or 0.0 < rate < 1e5),
        where,
        "a number of values and a sampling rate",
        f"{count} and {rate:g} per second",
        key="header",
    )
    values = block(lines, first, count, _VALUES, where)
    head = Header(lines[:_SMC_TEXT_LINES], where)
    name = head.words(r"component\s*=\s*(\S+)") or str(int(ints[_AZIMUTH]))
    clock = SampleClock(0.0, 1.0 / rate, count)
    if paired:
        times, values = values[: count // 2 * 2].reshape(-1, 2).T
        clock = clock_of(times, where, largest=int(np.argmax(np.abs(values))))
    peak, start_s = _smc_peak(reals, clock.start_s), clock.start_s
    channel = Channel.read(name, _smc_direction(name, ints), clock.dt_s, clock.on(values), "cm/s2", peak, start_s)
    facts = {"event": lines[3].strip(), "station": head.words(r"station\s*=\s*(.*?)\s*component\s*=")}
    raw = () if kind == "2" else (caution("record_uncorrected"),)
    form = "USGS SMC" if kind == "2" else "USGS SMC, uncorrected"
    group = f"{facts['event']}|{facts['station']}"
    return RecordFile(where, form, "cm/s2", (channel,), facts, group, (*raw, *clock.of(name)))


def _smc_direction(name: str, ints: Floats) -> ChannelOrientation:
    from_vertical, azimuth = float(ints[_VERTICAL]), float(ints[_AZIMUTH])
    if from_vertical in (0.0, 180.0):
        return ChannelOrientation(vertical=True, sign=1 if from_vertical == 0.0 else -1)
    return ChannelOrientation(azimuth % 360.0) if 0.0 <= azimuth <= 360.0 else parse_orientation(name)


def _smc_peak(reals: Floats, start_s: float) -> tuple[float | None, float | None]:
    """The larger of the header's two peaks, and its time after the first sample."""
    time_max, peak_max, time_min, peak_min = (float(value) for value in reals[slice(*_TIMES_AND_PEAKS)])
    if max(abs(value) for value in (time_max, peak_max, time_min, peak_min)) >= _NO_REAL:
        return None, None
    return (peak_max, time_max - start_s) if abs(peak_max) >= abs(peak_min) else (peak_min, time_min - start_s)


# Volume 1 of CSMIP, USC, RENADIC and BHRC: per channel 13 text, 7 integer and 7 real lines, then uncorrected accelerations.
#
# One layout of the 1970s, kept by four networks: pairs of time and g/10 with three decimals; BHRC writes even steps in g/10,
# CSMIP today even steps in g below a line that says so.

VOLUME1 = re.compile(r"\s*(FILE\s+\d+ OF )?UNCORRECTED\s+ACCELEROGRAM\s+DATA|\s*\* ?VOL1DS", re.IGNORECASE)
"""The first line of a channel."""
_VOLUME1_TEXT_LINES, _VOLUME1_NUMBER_LINES, _VOLUME1_HEADER_LINES = 13, 14, 27
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


def volume1(lines: list[str], where: str) -> RecordFile:
    """All channels of a volume 1 file; InputError where a header or values are missing."""
    starts = [i for i, line in enumerate(lines) if VOLUME1.match(line)]
    channels = [
        _volume1_channel(lines, start, end, where) for start, end in zip(starts, [*starts[1:], len(lines)], strict=True)
    ]
    first, head = lines[starts[0]].upper(), Header(lines[: starts[0] + _VOLUME1_HEADER_LINES], where)
    network = "BHRC" if "VOL1DS" in first else "USC" if "FILE" in first else "CSMIP"
    name = "RENADIC V1" if head.words("(RENADIC)") else f"{network} V1"
    event, station = (2, 7) if network == "BHRC" else (1, 5)
    facts = {"event": lines[event].strip(), "station": re.split(r"\s{2,}", lines[station].strip())[0]}
    found = (caution("record_uncorrected"), *(said for _, more in channels for said in more))
    group = "|".join((*facts.values(), lines[4].strip())) if network == "USC" else ""
    return RecordFile(where, name, "g", tuple(channel for channel, _ in channels), facts, group, found)


def _volume1_channel(lines: list[str], start: int, end: int, where: str) -> tuple[Channel, tuple[Finding, ...]]:
    units = next((i for i in range(start, end) if _UNITS.match(lines[i])), start)
    head = Header(lines[start : max(start + _VOLUME1_TEXT_LINES, units + 1)], where, start)
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
    usual = start + _VOLUME1_HEADER_LINES
    if all(line.strip() for line in lines[start:usual]):
        return usual
    numbers = [i for i in range(units, end) if NUMERIC.fullmatch(lines[i])]
    return numbers[_VOLUME1_NUMBER_LINES - 1] + 1 if len(numbers) >= _VOLUME1_NUMBER_LINES else usual


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


# Volume 2 of CSMIP and USC: per channel a text, an integer and a real header, then accelerations, velocities, displacements.

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


def volume2(lines: list[str], where: str) -> RecordFile:
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
    channels = [_volume2_channel(lines, head, *place, where) for head, place in zip(heads, blocks, strict=False)]
    facts = {"event": lines[2].strip(), "station": lines[6].strip() if len(lines) > 6 else ""}
    name = "CSMIP V2" if all(said[2].upper() == "ACCEL" for _, said in blocks) else "USC V2"
    return RecordFile(where, name, "cm/s2", tuple(channels), facts)


def _volume2_channel(lines: list[str], head_from: int, start: int, said: re.Match[str], where: str) -> Channel:
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


# COSMOS volume 0 to 2 (V0C, V1C, V2C): self-describing header and data blocks, one or more channels in a file.

_HEADER = re.compile(
    r"^\s*(\d{1,9})\s+(Integer|Real)-header values follow on\s+(\d{1,9})\s+lines?,?\s*Format\s*=\s*(\(.*\))",
    re.IGNORECASE,
)
_DATA = re.compile(
    r"^\s*(\d{1,9})\s+(?:raw\s+)?accel\S*\s+(?:pts|points|counts),?\s*approx\s+(\d{1,9})\s*secs,?"
    r"\s*units\s*=\s*([^,(]+?)\s*(?:\(\s*(\d{1,9})\s*\))?\s*,?\s*Format\s*=\s*(\(.*\))",
    re.IGNORECASE,
)
_CODES: Final = {"2": "g", "4": "cm/s2", "10": "cm/s2"}
"""Units by the number beside their name (COSMOS table 2); 50 are counts."""
_COUNTS = "counts"
_AT_DIRECTION, _STEP = 53, (61, 33)  # places in the integer and the real header, from 0: of the data, of the raw file
_LEAST_UV, _VOLTS_PER_G, _GAIN = 21, 41, 46  # of the real header: µV in a count, the sensor's sensitivity and gain
_PEAK, _PEAK_TIME = 63, 64
_UNKNOWN = -999.0
_UP, _DOWN = 400, 401
_DURATION_TOLERANCE_S = 1.5  # "approx" is in whole seconds


def cosmos(lines: list[str], where: str) -> RecordFile:
    """All acceleration channels of a COSMOS file; InputError where a block is incomplete."""
    channels: list[Channel] = []
    found: list[Finding] = []
    numbers: dict[str, Floats] = {}
    text_from, unit = 0, "cm/s2"
    for i, line in enumerate(lines):
        if header := _HEADER.match(line):
            count, kind, rows, form = header.groups()
            _, width = fortran_format(form, where, f"line {i + 1}")
            numbers[kind.lower()] = fixed_width(
                lines[i + 1 : i + 1 + int(rows)],
                width,
                int(count),
                where=where,
                first_line=i + 2,
                what=f"{kind} header",
            )
        elif data := _DATA.match(line):
            channel, unit = _cosmos_channel(
                lines, i, data, numbers, Header(lines[text_from:i], where, text_from), found
            )
            channels.append(channel)
            numbers, text_from = {}, i + 1
    require(
        not numbers and not any("text lines" in line for line in lines[text_from:]),
        where,
        "a whole channel after its header",
        "the file's end",
        CUT_OFF,
        key=f"line {len(lines)}",
    )
    if not channels:
        got = next((line.strip() for line in lines if re.search(r"\bunits\s*=", line)), "none")
        wanted = "a block of accelerations, 'N acceleration pts, approx … units=…'"
        raise mistake(where, "", wanted, repr(got), "the file is cut off, or holds none")
    facts = {"event": " ".join(lines[1].split()), "station": " ".join(lines[4].split()) if len(lines) > 4 else ""}
    place = Header(lines, where).words(r"<SCNL>[^.\s]*\.\w{3}\.(\S*)")  # network and location: a building has many
    group = f"{facts['event']}|{facts['station']}|{place}" if len(channels) == 1 else ""
    name = "COSMOS V0" if unit == _COUNTS else "COSMOS"
    shown = "g" if unit == _COUNTS else unit
    return RecordFile(where, name, shown, tuple(channels), facts, group, tuple(found))


def _cosmos_channel(
    lines: list[str], i: int, data: re.Match[str], numbers: dict[str, Floats], head: Header, found: list[Finding]
) -> tuple[Channel, str]:
    where, place = head.where, f"line {i + 1}"
    count, duration = int(data.group(1)), float(data.group(2))
    written, code = data.group(3), (data.group(4) or "").lstrip("0")
    counted = code == "50" or written.lower().startswith("count")
    known = _COUNTS if counted else unit_named(written) or _CODES.get(code)
    unit = required(known, where, "accelerations in cm/s², g or counts", repr(written), key=place)
    form = fortran_format(data.group(5), where, place)
    integers, reals = (numbers.get(kind, np.empty(0)) for kind in ("integer", "real"))
    require(
        integers.size > _AT_DIRECTION and reals.size > _PEAK_TIME and count >= 2,
        where,
        "whole integer and real headers before the data",
        "shorter ones",
        key=place,
    )
    dt_s = _step_s([float(reals[at]) for at in _STEP], count, duration, where)
    values = block(lines, i + 1, count, form, where)
    name, orientation = _cosmos_direction(int(integers[_AT_DIRECTION]), head, found)
    if unit == _COUNTS:
        values, rest_g = _in_g(values, reals, where)
        found += [
            info("record_rest_taken_off", channel=name, rest_g=rest_g),
            caution("record_uncorrected", channel=name),
        ]
        return Channel.read(name, orientation, dt_s, values, "g"), unit
    stated = (float(reals[_PEAK]), float(reals[_PEAK_TIME]))
    peak = (None, None) if _UNKNOWN in stated else stated
    return Channel.read(name, orientation, dt_s, values, unit, peak), unit


def _in_g(counts: Floats, reals: Floats, where: str) -> tuple[Floats, float]:
    """Counts about their mean, and the mean, in g by the recorder's µV for a count and the sensor's V for g."""
    microvolts, sensitivity, gain = (float(reals[at]) for at in (_LEAST_UV, _VOLTS_PER_G, _GAIN))
    require(
        microvolts > 0.0 and sensitivity > 0.0,
        where,
        "the recorder's µV for a count and the sensor's V/g (real headers 22 and 42)",
        f"{microvolts:g} µV and {sensitivity:g} V/g",
        "take the V1 or V2 file of this record",
        key="counts (V0)",
    )
    factor = microvolts * 1e-6 / sensitivity / (gain if gain > 0.0 else 1.0)
    mean = float(counts.mean())
    return (counts - mean) * factor, mean * factor


def _step_s(stated: list[float], count: int, duration_s: float, where: str) -> float:
    """The step in seconds, which some networks write in seconds and some in milliseconds: the stated duration decides."""
    for dt_s in (value * unit for value in stated for unit in (1e-3, 1.0)):
        if dt_s > 0.0 and abs(count * dt_s - duration_s) <= _DURATION_TOLERANCE_S:
            return dt_s
    got = " and ".join(f"{value:g}" for value in stated)
    wanted = f"a step with which {count} points last about {duration_s:g} s"
    raise mistake(where, "real headers 62 and 34", wanted, got)


def _cosmos_direction(code: int, head: Header, found: list[Finding]) -> tuple[str, ChannelOrientation]:
    """By the integer header, unless the channel's SEED name (<SCNL>STATION.BNZ.…) says that it is vertical."""
    seed = head.words(r"<SCNL>[^.\s]*\.(\w{3})\b")
    if code == _DOWN:
        return "DOWN", ChannelOrientation(vertical=True, sign=-1)
    if code == _UP or parse_orientation(seed).vertical:
        if code != _UP:
            found.append(caution("record_vertical_by_name", channel="UP", seed=seed, stated=code))
        return "UP", ChannelOrientation(vertical=True)
    if 0 <= code <= 360:
        return f"{code % 360:03d}", ChannelOrientation(code % 360.0)
    name = head.words(r"Sta Chan?:?\s+\S+:\s*(\S+)") or seed or str(code)
    return name, parse_orientation(seed) if parse_orientation(name) == ChannelOrientation() else parse_orientation(name)
