"""A record as a scene asks for it: file, channel or azimuth, and the processing in its fixed order."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from harness.input import paths
from harness.input.motions import components, process
from harness.input.motions.check import DRIFTS
from harness.input.motions.process import ProcessError
from harness.input.motions.readers import read_record
from harness.input.motions.recordfile import RecordFile
from harness.input.motions.series import Series
from harness.input.motions.spec import Source
from harness.input.motions.text import mistake


def load(source: Source, *, base_dir: Path, where: str, key: str) -> tuple[Series, tuple[str, ...]]:
    """The processed history, and what the reader said of it; InputError names `key` of `where`, or the file and its line."""
    path = paths.resolve(source.file, base_dir=base_dir, where=where, key=f"{key}.file")
    record = read_record(path, unit=source.unit, layout=source.layout)
    series = _chosen(record, source, where, key)
    try:
        return _processed(series, record, source), _concerning(record, source, where, key)
    except ProcessError as error:
        raise mistake(where, key, f"a step that {path.name} can take", str(error)) from error


def _chosen(record: RecordFile, source: Source, where: str, key: str) -> Series:
    if source.azimuth_deg is not None:
        return components.turned(record, source.azimuth_deg, where=where, key=key)
    channel = components.channel_named(record, source.column, where=where, key=key)
    return components.aligned(record)[channel.name]


def _concerning(record: RecordFile, source: Source, where: str, key: str) -> tuple[str, ...]:
    """What the reader said of the channel that is used and of the whole file; of every channel where two are turned."""
    cured = source.baseline != "none" or source.bandpass_hz is not None
    warnings = tuple(said for said in record.warnings if not (cured and DRIFTS in said))
    if source.azimuth_deg is not None:
        return warnings
    used = components.channel_named(record, source.column, where=where, key=key).name
    others = tuple(f"{channel.name}: " for channel in record.channels if channel.name != used)
    return tuple(said for said in warnings if not said.startswith(others))


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


def _processed(series: Series, record: RecordFile, source: Source) -> Series:
    shaped = _shaped(series, source)
    if source.significant is not None:
        every = [_shaped(channel, source).accel_m_s2 for channel in components.aligned(record).values()]
        joint = np.sum([accel**2 for accel in every], axis=0)
        shaped = process.significant(shaped, source.significant, joint)
    if source.pga_g is not None:
        shaped = process.to_pga(shaped, source.pga_g)
    elif source.pgv_m_s is not None:
        shaped = process.to_pgv(shaped, source.pgv_m_s)
    else:
        shaped = process.scaled(shaped, source.scale, "scale")
    return process.scaled(shaped, float(source.sign), "sign")
