"""ITACA and ESM (DYNA): 64 header lines "KEY: value", then one acceleration per line, one channel in a file."""

from __future__ import annotations

import math
import re
from datetime import datetime
from typing import Final

from harness.input.motions.orientation import parse_orientation
from harness.input.motions.recordfile import UNITS_M_S2, Channel, RecordFile
from harness.input.motions.text import free_format, mistake
from harness.input.text_file import decimal

NAME: Final = "ITACA/ESM ASCII"
TESTED_ON_ORIGINALS: Final = False

_KEY = re.compile(r"^([A-Z][A-Z0-9_/^()]*):\s*(.*)$")
_EPOCH: Final = datetime(1970, 1, 1)
_CLOCK_KEY = "DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS"
_UNITS: Final = {"cm/s^2": "cm/s2", "m/s^2": "m/s2", "g": "g"}
_NEEDED: Final = ("SAMPLING_INTERVAL_S", "NDATA", "STREAM", "UNITS")


def recognises(text: str) -> bool:
    """Whether the first line is EVENT_NAME and the header gives a sampling interval."""
    return text.startswith("EVENT_NAME:") and "SAMPLING_INTERVAL_S:" in text[:8000]


def read(text: str, where: str) -> RecordFile:
    """The one channel of an ESM file; InputError where keys or values are missing."""
    lines = text.splitlines()
    header: dict[str, str] = {}
    first = 0  # counted apart from the keys: a damaged file may hold one twice
    while first < len(lines) and (match := _KEY.match(lines[first])):
        header[match.group(1)] = match.group(2).strip()
        first += 1
    for key in _NEEDED:
        if not header.get(key):
            raise mistake(where, key, "a value in the header", "none")
    if header.get("DATA_TYPE", "ACCELERATION") != "ACCELERATION":
        raise mistake(where, "DATA_TYPE", "ACCELERATION", header["DATA_TYPE"], "take the file whose name holds .ACC.")
    if header["UNITS"] not in _UNITS:
        raise mistake(where, "UNITS", " or ".join(_UNITS), repr(header["UNITS"]))
    dt_s, count = _number(header, "SAMPLING_INTERVAL_S", where), int(_number(header, "NDATA", where))
    values = free_format(lines[first:], where=where, first_line=first + 1)
    if values.size != count:
        raise mistake(
            where, "NDATA", f"{count} accelerations", str(values.size), "the file is cut off: download it again"
        )
    unit = _UNITS[header["UNITS"]]
    orientation = parse_orientation(header["STREAM"])
    factor = UNITS_M_S2[unit] * orientation.sign
    peak, peak_s = (_stated(header, key, where) for key in ("PGA_CM/S^2", "TIME_PGA_S"))
    stated = None if peak is None else peak * UNITS_M_S2["cm/s2"] * orientation.sign
    channel = Channel(header["STREAM"], orientation, dt_s, values * factor, _clock_s(header, where), stated, peak_s)
    facts = {
        "event": header.get("EVENT_NAME", ""),
        "station": f"{header.get('NETWORK', '')}.{header.get('STATION_CODE', '')}",
    }
    group = (
        f"{header.get('EVENT_ID', '')}|{facts['station']}|{header.get('LOCATION', '')}|{header.get('PROCESSING', '')}"
    )
    return RecordFile(where, NAME, TESTED_ON_ORIGINALS, unit, (channel,), facts, group)


def _number(header: dict[str, str], key: str, where: str) -> float:
    value = _stated(header, key, where) or 0.0
    if value <= 0.0:
        raise mistake(where, key, "a positive number", repr(header[key]))
    return value


def _stated(header: dict[str, str], key: str, where: str) -> float | None:
    """The number after a key, None where the file leaves it empty."""
    if not header.get(key):
        return None
    try:
        value = decimal(header[key])
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise mistake(where, key, "a number", repr(header[key]))
    return value


def _clock_s(header: dict[str, str], where: str) -> float:
    """Time of the first sample since _EPOCH, s, so that a record's three files share one clock."""
    stamp = header.get(_CLOCK_KEY, "")
    if not stamp:
        return 0.0
    try:
        first = datetime.strptime(stamp if "." in stamp else stamp + ".0", "%Y%m%d_%H%M%S.%f")
    except ValueError:
        raise mistake(where, _CLOCK_KEY, "YYYYMMDD_HHMMSS.sss", repr(stamp)) from None
    return (first - _EPOCH).total_seconds()
