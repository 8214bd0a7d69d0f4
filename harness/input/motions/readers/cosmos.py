"""COSMOS volume 0 to 2 (V0C, V1C, V2C): self-describing header and data blocks, one or more channels in a file."""

import re
from typing import Final

import numpy as np

from harness.input.motions.recordfile import (
    CUT_OFF,
    Channel,
    ChannelOrientation,
    Floats,
    Header,
    RecordFile,
    block,
    fixed_width,
    fortran_format,
    mistake,
    parse_orientation,
    unit_named,
)
from harness.model import Finding, caution, info, require, required

MARK = re.compile(r"(?s:.*?)(?:Integer|Real)-header values follow on", re.IGNORECASE)
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
_DIRECTION, _STEP = 53, (61, 33)  # places in the integer and the real header, from 0: of the data, of the raw file
_LEAST_UV, _VOLTS_PER_G, _GAIN = 21, 41, 46  # of the real header: µV in a count, the sensor's sensitivity and gain
_PEAK, _PEAK_TIME = 63, 64
_UNKNOWN = -999.0
_UP, _DOWN = 400, 401
_DURATION_TOLERANCE_S = 1.5  # "approx" is in whole seconds


def read(lines: list[str], where: str) -> RecordFile:
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
            channel, unit = _channel(lines, i, data, numbers, Header(lines[text_from:i], where, text_from), found)
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


def _channel(
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
        integers.size > _DIRECTION and reals.size > _PEAK_TIME and count >= 2,
        where,
        "whole integer and real headers before the data",
        "shorter ones",
        key=place,
    )
    dt_s = _step_s([float(reals[at]) for at in _STEP], count, duration, where)
    values = block(lines, i + 1, count, form, where)
    name, orientation = _direction(int(integers[_DIRECTION]), head, found)
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


def _direction(code: int, head: Header, found: list[Finding]) -> tuple[str, ChannelOrientation]:
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
