"""ITACA and ESM (DYNA): header lines "KEY: value", then one acceleration per line, one channel in a file."""

import re
from datetime import datetime
from typing import Final

from harness.input.motions.recordfile import UNITS_M_S2, Channel, Header, RecordFile, free_format, mistake
from harness.model import require

MARK = re.compile(r"(?=EVENT[_ ]|NETWORK:)(?:.*\n)*?EVENT[_ ](?:NAME|ID):", re.IGNORECASE)
_KEY = re.compile(r"^\s*([A-Z][A-Z0-9_/^() ]*):(.*)$", re.IGNORECASE)
_EPOCH: Final = datetime(1970, 1, 1)
_STAMPS: Final = ("%Y%m%d_%H%M%S.%f", "%d/%m/%Y %H:%M:%S.%f", "%Y/%m/%d %H:%M:%S.%f", "%Y-%m-%d %H:%M:%S.%f")
"""Of DYNA as a rule; the second in files of its version 1.2."""
_CLOCK_KEY = "DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS"


def read(lines: list[str], where: str) -> RecordFile:
    """The one channel of an ESM file; InputError where keys or values are missing."""
    first = next((i for i, line in enumerate(lines) if line.strip() and not _KEY.match(line)), len(lines))
    head = Header(lines[:first], where)
    kind = _words(head, "DATA_TYPE") or "ACCELERATION"
    require(
        kind.upper() == "ACCELERATION",
        where,
        "ACCELERATION",
        kind,
        "take the file whose name holds .ACC.",
        key="DATA_TYPE",
    )
    dt_s = head.number(_key("SAMPLING_INTERVAL_S"), "SAMPLING_INTERVAL_S and a step")
    count = head.count(_key("NDATA"), "NDATA and how many")
    stream = head.needed(_key("STREAM|COMPONENT|CHANNEL_CODE|CHANNEL"), "STREAM and a channel such as HNE")[0]
    unit = head.unit(_key("UNITS"), "UNITS of cm/s^2, m/s^2 or g")
    values = free_format(lines[first:], where=where, first_line=first + 1)
    require(
        values.size == count,
        where,
        f"{count} accelerations",
        str(values.size),
        "the file is cut off: download it again" if values.size < count else "",
        key="NDATA",
    )
    peak, _ = head.peak(_key(r"PGA_CM/S\^2"))
    peak_s, _ = head.peak(_key("TIME_PGA_S"))
    stated = None if peak is None else peak * UNITS_M_S2["cm/s2"] / UNITS_M_S2[unit]
    start_s = _clock_s(_words(head, _CLOCK_KEY), where)
    channel = Channel.read(stream, None, dt_s, values, unit, (stated, peak_s), start_s)
    facts = {
        "event": _words(head, "EVENT_NAME"),
        "station": f"{_words(head, 'NETWORK')}.{_words(head, 'STATION_CODE')}",
    }
    group = "|".join((_words(head, "EVENT_ID"), facts["station"], _words(head, "LOCATION"), _words(head, "PROCESSING")))
    return RecordFile(where, "ITACA/ESM ASCII", unit, (channel,), facts, group)


def _key(names: str) -> str:
    """The pattern of a line's value by its key, blanks or underscores between the key's words."""
    return rf"^\s*(?:{names.replace('_', '[_ ]')})\s*:(.*)$"


def _words(head: Header, key: str) -> str:
    return head.words(_key(key))


def _clock_s(stamp: str, where: str) -> float:
    """Time of the first sample since _EPOCH, s, so that a record's three files share one clock; 0 where it is not said."""
    if not stamp:
        return 0.0
    whole = stamp if "." in stamp else stamp + ".0"
    for form in _STAMPS:
        try:
            return (datetime.strptime(whole, form) - _EPOCH).total_seconds()
        except ValueError:
            continue
    raise mistake(where, _CLOCK_KEY, "YYYYMMDD_HHMMSS.sss, or DD/MM/YYYY HH:MM:SS.sss", repr(stamp))
