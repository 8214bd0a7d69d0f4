"""miniSEED and SAC through ObsPy, an extra: the trace's numbers as accelerations in the unit that the user gives."""

import io
from typing import Any, Final

import numpy as np

from harness.input.motions.recordfile import (
    UNIT_NAMES,
    Channel,
    ChannelOrientation,
    RecordFile,
    mistake,
    parse_orientation,
)
from harness.model import require, required, translated

_SAC_VERSION, _SAC_HEADER = slice(304, 308), 632
_SAC_VERSIONS: Final = tuple((v).to_bytes(4, order) for v in (6, 7) for order in ("little", "big"))


def is_binary(raw: bytes) -> bool:
    """Whether `raw` begins as a miniSEED record (number, quality) or holds SAC's header version in its place."""
    seed = raw[:6].isdigit() and raw[6:7] in (b"D", b"R", b"Q", b"M") and raw[7:8] in (b" ", b"\x00")
    return seed or (len(raw) > _SAC_HEADER and raw[_SAC_VERSION] in _SAC_VERSIONS)


def read(raw: bytes, where: str, *, unit: str | None) -> RecordFile:
    """Every trace as a channel; InputError without ObsPy, without a unit, for counts and for traces with gaps."""
    advice = 'pip install "rockcheck[seed]"'
    with translated(ImportError, where, "ObsPy, which reads miniSEED and SAC", "none installed", advice):
        import obspy
    try:
        stream = obspy.read(io.BytesIO(raw))
    except Exception as error:
        # Of bytes it cannot tell apart it says where they stand in memory.
        got = f"{type(error).__name__}: {str(error).partition(': <')[0]}"
        raise mistake(where, "", "a whole miniSEED or SAC file", got) from error
    advice = "these files do not state it: say --motion-unit, or unit = in a scene"
    unit = required(unit, where, UNIT_NAMES, "none", advice, key="unit")
    names = [trace.id for trace in stream]
    require(
        len(set(names)) == len(names),
        where,
        "one trace for each channel",
        f"{', '.join(names)}",
        "merge or cut the gaps in ObsPy",
    )
    channels = tuple(_channel(trace, where, unit) for trace in stream)
    first = stream[0].stats
    station = f"{first.network}.{first.station}.{first.location}"
    group = f"{station}|{first.starttime.strftime('%Y%m%dT%H')}" if len(channels) == 1 else ""
    return RecordFile(where, "miniSEED/SAC", unit, channels, {"station": station}, group)


def _channel(trace: Any, where: str, unit: str) -> Channel:
    name, stats = trace.stats.channel or trace.id, trace.stats
    require(
        not np.issubdtype(trace.data.dtype, np.integer),
        where,
        "accelerations",
        "a digitiser's counts",
        "divide them by the sensitivity (ObsPy: remove_sensitivity), or take the processed file",
        key=name,
    )
    values = np.asarray(trace.data, dtype=np.float64)
    require(
        np.isfinite(values).all(),
        where,
        "finite numbers",
        "NaN or infinity",
        "cut the record or fill the gap",
        key=name,
    )
    orientation, sac = parse_orientation(name), stats.get("sac", {})
    if orientation == ChannelOrientation() and "cmpaz" in sac:
        orientation = ChannelOrientation(float(sac["cmpaz"]) % 360.0)
    return Channel.read(name, orientation, float(stats.delta), values, unit, start_s=float(stats.starttime.timestamp))
