"""A record as a scene asks for it: file, channel or azimuth, and the processing in its fixed order."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np

from harness.input.files import existing_file
from harness.input.mistakes import Contradiction, agree
from harness.input.motions import process
from harness.input.motions.readers import read_record
from harness.input.motions.recordfile import (
    Channel,
    ChannelOrientation,
    Floats,
    RecordFile,
    Series,
    mistake,
    parse_orientation,
)
from harness.input.motions.spec import Source
from harness.model import Finding, info, require

ROUNDING: Final = 1e-12
"""Of a record's peak: what treating samples that are alike leaves of them."""


def load(source: Source, *, base_dir: Path, where: str, key: str) -> tuple[Series, tuple[Finding, ...]]:
    """The processed history, and what the reader said of it; InputError names `key` of `where`, or the file and its line."""
    path = existing_file(source.file, base_dir=base_dir, where=where, key=f"{key}.file")
    record = read_record(path, unit=source.unit, layout=source.layout)
    if source.azimuth_deg is not None:
        others: list[Channel] = []
        series = turned(record, source.azimuth_deg, where=where, key=key)
    else:
        used = channel_named(record, source.column, where=where, key=key)
        others = [channel for channel in record.channels if channel is not used]
        series = aligned(record)[used.name]
    try:
        return _processed(series, record, source), _concerning(record, source, others)
    except Contradiction as error:
        raise mistake(where, f"{key}.{error.key}", error.wanted, error.got, f"the record is {path.name}") from error


def _concerning(record: RecordFile, source: Source, others: Sequence[Channel]) -> tuple[Finding, ...]:
    """What the reader said of the whole file and of its channels but the `others`, which are not used."""
    cured = source.baseline != "none" or source.bandpass_hz is not None
    unused = {channel.name for channel in others}
    return tuple(
        found
        for found in record.findings
        if not (cured and found.code == "record_drifts") and found.values.get("channel") not in unused
    )


def _shaped(series: Series, source: Source) -> Series:
    """The steps that every channel of the record takes alike, before the significant duration is sought."""
    if source.window_s is not None:
        series = process.window(series, *source.window_s)
    series = process.baseline(series, source.baseline)
    if source.bandpass_hz is not None:
        series = process.bandpass(series, *source.bandpass_hz)
    if source.resample_dt_s is not None:
        series = process.resample(series, source.resample_dt_s)
    return series


def _moving(part: Series, whole: Series) -> Series:
    """What is left of a history. Raises `Contradiction` where that is at rest: a factor on it would be one on its rounding."""
    moves = np.abs(part.accel_m_s2).max() > ROUNDING * np.abs(whole.accel_m_s2).max()
    agree((moves, "file", "a record that moves where it is used", "nothing but zeros there"))
    return part


def _processed(series: Series, record: RecordFile, source: Source) -> Series:
    shaped = _moving(_shaped(series, source), series)
    if source.significant is not None:
        every = [_shaped(channel, source).accel_m_s2 for channel in aligned(record).values()]
        joint = np.sum([accel**2 for accel in every], axis=0)
        shaped = _moving(process.significant(shaped, source.significant, joint), series)
    if source.pga_g is not None:
        shaped = process.to_pga(shaped, source.pga_g)
    elif source.pgv_m_s is not None:
        shaped = process.to_pgv(shaped, source.pgv_m_s)
    else:
        shaped = process.scaled(shaped, source.scale, "scale")
    return process.scaled(shaped, float(source.sign), "sign")


AZIMUTH_TOLERANCE_DEG: Final = 0.5
"""Azimuths are published in whole degrees."""
LEAST_CROSSING_DEG: Final = 30.0
"""Two horizontals closer than this to one line amplify each other's errors more than twice when turned."""
_WHOLE_STEP = 1e-3  # of a step: clocks that differ by whole steps
_LEAST_SAMPLES = 2


def aligned(record: RecordFile) -> dict[str, Series]:
    """All channels, by name, on the samples that they have in common; InputError where they share no time.

    Channels that start between each other's samples, or sample at other steps, are interpolated linearly on the finest.
    """
    channels = record.channels
    first = max(channel.start_s for channel in channels)
    last = min(channel.start_s + channel.dt_s * (channel.accel_m_s2.size - 1) for channel in channels)
    dt_s = min(channel.dt_s for channel in channels)
    count = math.floor((last - first) / dt_s + 1e-6) + 1
    require(
        count >= _LEAST_SAMPLES,
        record.path,
        "channels that overlap in time",
        "channels that do not",
        "read them one by one",
    )
    return {channel.name: _on_clock(channel, first, dt_s, count) for channel in channels}


def _on_clock(channel: Channel, first_s: float, dt_s: float, count: int) -> Series:
    offset = (first_s - channel.start_s) / dt_s
    whole = round(offset)
    samples = channel.accel_m_s2
    shares = channel.dt_s == dt_s and abs(offset - whole) < _WHOLE_STEP
    read = info(
        "step_read",
        how="interpolated" if not shares else "cut" if samples.size > count else "whole",
        channel=channel.name,
        orientation=str(channel.orientation),
        samples=samples.size,
        dt_s=channel.dt_s,
        shared=count,
    )
    at_s = first_s + dt_s * np.arange(count)
    shared = samples[whole : whole + count] if shares else np.interp(at_s, channel.t_s, samples)
    return Series(dt_s, shared, (read,))


def channel_named(record: RecordFile, column: str | None, *, where: str, key: str) -> Channel:
    """The channel that `column` names by header, name or azimuth; the only one where `column` is None."""
    available = ", ".join(f"{channel.name} ({channel.orientation})" for channel in record.channels)
    if column is None:
        if len(record.channels) == 1:
            return record.channels[0]
        raise mistake(where, f"{key}.column", f"one of {available}", "no column", f"{record.path} holds several")
    exact = [channel for channel in record.channels if channel.name.casefold() == column.casefold()]
    meant = parse_orientation(column)
    matches = exact or [channel for channel in record.channels if _points_alike(channel.orientation, meant)]
    require(
        len(matches) == 1,
        where,
        f"one of {available}",
        f"{column!r}, which fits {len(matches)} of them" if matches else repr(column),
        f"these are the columns of {record.path}",
        key=f"{key}.column",
    )
    return matches[0]


def _points_alike(one: ChannelOrientation, other: ChannelOrientation) -> bool:
    if one.azimuth_deg is None or other.azimuth_deg is None:
        return one.vertical and other.vertical
    return abs((one.azimuth_deg - other.azimuth_deg + 180.0) % 360.0 - 180.0) <= AZIMUTH_TOLERANCE_DEG


def crossing_deg(one: Channel, two: Channel) -> float:
    """The angle between the lines of two horizontals, 0 to 90."""
    apart = (one.orientation.azimuth_deg or 0.0) - (two.orientation.azimuth_deg or 0.0)
    return math.degrees(math.asin(min(1.0, abs(math.sin(math.radians(apart))))))


def turned(record: RecordFile, azimuth_deg: float, *, where: str, key: str) -> Series:
    """The horizontal acceleration towards `azimuth_deg` (clockwise from north) from the record's two horizontals."""
    horizontals = record.horizontals
    require(
        len(horizontals) == 2,
        where,
        "two horizontal channels with known azimuths",
        f"{len(horizontals)} in {record.path}",
        "give column",
        key=f"{key}.azimuth_deg",
    )
    one, two = horizontals
    first, second = (math.radians(channel.orientation.azimuth_deg or 0.0) for channel in horizontals)
    crossing = crossing_deg(one, two)
    require(
        crossing >= LEAST_CROSSING_DEG,
        where,
        "horizontals at least 30° apart",
        f"{one.name} and {two.name}, {crossing:g}° apart",
        "give column",
        key=f"{key}.azimuth_deg",
    )
    towards = math.radians(azimuth_deg)
    weights = np.array([math.sin(second - towards), math.sin(towards - first)]) / math.sin(second - first)
    series = aligned(record)
    parts = [series[channel.name].accel_m_s2 for channel in horizontals]
    total: Floats = weights[0] * parts[0] + weights[1] * parts[1]
    shares = {channel.name: weight for channel, weight in zip(horizontals, weights.tolist(), strict=True)}
    read = tuple(step for channel in horizontals for step in series[channel.name].done)
    return Series(series[one.name].dt_s, total, (*read, info("step_turned", azimuth_deg=azimuth_deg, weights=shares)))
