"""Integrity of a record: what makes it unusable is refused, what only makes it doubtful is said."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Final

import numpy as np

from harness.input.motions.recordfile import (
    STANDARD_GRAVITY_M_S2,
    UNITS_M_S2,
    Channel,
    Floats,
    RecordFile,
    Series,
    displacement_m,
    mistake,
    velocity_m_s,
)
from harness.model import Finding, caution, info, require

LARGEST_PEAK_G: Final = 10.0
"""No free-field accelerogram has exceeded about 4 g (Iwate 2008): above 10 g the unit is wrong."""
STEPS_S: Final = (1e-6, 1.0)
"""Shorter and longer steps than any accelerograph's: a longer one says nothing of the periods that rock a statue."""
USUAL_STEPS_S: Final = (2e-4, 0.05)
"""Accelerographs sample 50 to 1000 times a second, digitised film at 0.005 to 0.04 s: beyond, a step was misread or mistyped."""
PLAUSIBLE_G: Final = (0.005, 5.0)
SMALLEST_PEAK_G: Final = 5e-4
STATED_PEAK_TOLERANCE: Final = 0.01
"""Headers round a peak to three digits or more."""
ABRUPT: Final = 0.1
"""Share of the peak that a record cut within its shaking still has at an end."""
DRIFT_VELOCITY: Final = 0.25
"""Share of the peak velocity that remains at the end; corrected records keep less than 0.1, an offset of any size 1."""
DRIFT_PATH: Final = (0.9, 0.01)
"""Shares of the peak displacement, and of the way at peak velocity, that lie between start and end. Corrected records keep less
than 0.008 of the way; a fling's lasting displacement is reached in a second or two of strong velocity, not over a minute."""
FILLERS: Final = np.array(
    [float("9" * whole + "." + "9" * part) for whole in range(3, 10) for part in range(5)]
    + [2.0**bits - less for bits in (15, 23, 31) for less in (0, 1)]
)
"""Numbers that programs write where they have none: nines, and the ends of a recorder's whole numbers."""
FILLER_STEP: Final = (0.5, 0.1)
"""Of a filler: how far it is from its neighbours, where it is whole, and where it has decimals (none is a sample by chance)."""
FILLER_TIMES: Final = 3
FILL: Final = "cut the record, or fill its gap in the program that made it"
SPIKE: Final = 3.0
"""Times all other samples: no floor moves so for one sample."""
SPIKES: Final = 0.01
FEWEST: Final = 100
_END_SHARE, _FLAT_SAMPLES, _STRONG = 0.01, 10, (0.05, 0.95)


def check(record: RecordFile) -> tuple[Finding, ...]:
    """What is doubtful of every channel; InputError for a record that cannot be one in the unit it is said to have."""
    doubts = [
        replace(found, values={"channel": channel.name, **found.values})
        for channel in record.channels
        for found in _channel(channel, record)
    ]
    if not record.tested:
        doubts.append(caution("record_reader_untested", format=record.format))
    return tuple(doubts)


def _channel(channel: Channel, record: RecordFile) -> Iterator[Finding]:
    accel = channel.accel_m_s2
    require(
        accel.size >= 2,
        record.path,
        "two samples or more",
        str(accel.size),
        "the file holds no motion",
        key=channel.name,
    )
    least_s, most_s = STEPS_S
    require(
        least_s <= channel.dt_s <= most_s,
        record.path,
        f"a step between {least_s:g} and {most_s:g} s",
        f"{channel.dt_s:g} s",
        key=channel.name,
    )
    if record.unit in UNITS_M_S2:
        refuse_fillers(accel / UNITS_M_S2[record.unit], record.path, lambda row: f"{channel.name}, sample {row + 1}")
    peak_g = float(np.abs(accel).max()) / STANDARD_GRAVITY_M_S2
    require(peak_g != 0.0, record.path, "a motion", "nothing but zeros", key=channel.name)
    spikes = _spikes(channel, record)
    if peak_g > LARGEST_PEAK_G:
        likely = _likely_units(peak_g, record.unit)
        if spikes:
            likely = f"{spikes['alone']} of {spikes['samples']} samples stand alone above all others: spikes, or missing samples?"
        raise mistake(
            record.path, channel.name, f"a peak below {LARGEST_PEAK_G:g} g", f"{peak_g:.4g} g in {record.unit}", likely
        )
    yield from _of_clock_and_sense(channel)
    if spikes:
        yield caution("record_spikes", **spikes)
    against = [*_against_header(channel)]
    if peak_g < SMALLEST_PEAK_G:
        claimed = channel.stated_peak_m_s2 is not None and not against
        units = [*_fitting_units(peak_g, record.unit)]
        yield caution("record_small", peak_g=peak_g, stated=claimed, units=units)
    yield from against
    yield from _drift(channel)
    edge = max(1, int(_END_SHARE * accel.size))
    for name, part in (("begins", accel[:edge]), ("ends", accel[-edge:])):
        share = float(np.abs(part).max() / np.abs(accel).max())
        if share > ABRUPT:
            yield caution("record_abrupt", at=name, share=share)
    run = _longest_flat(accel)
    if run > _FLAT_SAMPLES:
        yield caution("record_flat", lasts_s=run * channel.dt_s)


def refuse_fillers(values: Floats, where: str, place: Callable[[int], str]) -> None:
    """InputError at a number that programs write where a sample is missing (999.99, -9999, …) and that leaves the others' course.

    `values` (n,) are as the file has them; `place` names the place of one by its row. A whole number, which a sample can be by
    chance, must also be the largest of all, come again, or bend the others' course as nothing else does.
    """
    size = np.abs(values)
    rows = np.flatnonzero(np.isin(np.round(size, 6), FILLERS))
    if not rows.size:
        return
    before, after = (np.flatnonzero(np.concatenate(ends)) for ends in (
        ([True], np.diff(values) != 0.0), (np.diff(values) != 0.0, [True])
    ))  # fmt: skip
    runs = np.isin(before, rows)
    first, last = before[runs], after[runs]
    step = FILLER_STEP[0] * size[first]
    step[size[first] % 1.0 > 0.0] *= FILLER_STEP[1] / FILLER_STEP[0]
    left = np.where(first > 0, np.abs(values[first] - values[first - 1]), np.inf)
    right = np.where(last < values.size - 1, np.abs(values[last] - values[(last + 1) % values.size]), np.inf)
    alone = (left > step) & (right > step)
    bends = np.abs(np.diff(values, 2))
    bends = np.pad(bends, (1, values.size - 1 - bends.size))
    near = np.concatenate([first - 1, first, last, last + 1]).clip(0, values.size - 1)
    usual = float(np.delete(bends, near).max(initial=0.0))
    for value in np.unique(values[first[alone]]):
        same = alone & (values[first] == value)
        row, times = int(first[same][0]), int((last - first + 1)[same].sum())
        sure = size[row] % 1.0 > 0.0 or size[row] >= size.max() or times >= FILLER_TIMES
        if sure or bends[row] > SPIKE * usual > 0.0:
            got = f"{value:.10g} ({times} such), which programs write where a sample is missing"
            raise mistake(where, place(row), "an acceleration", got, FILL)


def _spikes(channel: Channel, record: RecordFile) -> dict[str, object]:
    """Samples that stand alone above all others, in the file's unit; nothing where none does."""
    size = np.abs(channel.accel_m_s2)
    low = size[size < size.max() * (1.0 - FILLER_STEP[1])]
    highest = float(low.max()) if low.size else 0.0
    if size.size < FEWEST or highest <= 0.0 or size.max() < SPIKE * highest or low.size < (1.0 - SPIKES) * size.size:
        return {}
    row = int(np.argmax(size))
    unit = record.unit if record.unit in UNITS_M_S2 else "m/s2"
    peak, others = (value / UNITS_M_S2[unit] for value in (channel.accel_m_s2[row], highest))
    counts = {"alone": size.size - low.size, "samples": size.size}
    return counts | {"peak": peak, "others": others, "unit": unit, "at_s": float(channel.t_s[row])}


def _of_clock_and_sense(channel: Channel) -> Iterator[Finding]:
    """What is doubtful in the step, and what was taken for granted of the direction."""
    least_s, most_s = USUAL_STEPS_S
    if not least_s <= channel.dt_s <= most_s:
        lasts = channel.dt_s * (channel.accel_m_s2.size - 1)
        yield caution("record_step", dt_s=channel.dt_s, lasts_s=lasts)
    if channel.orientation.sense_assumed:
        yield caution("record_sense_assumed")
    if channel.orientation.sign < 0:
        yield info("record_downwards")


def _drift(channel: Channel) -> Iterator[Finding]:
    """Whether the record runs away when it is integrated, and what takes that off."""
    series = Series(channel.dt_s, channel.accel_m_s2)
    velocity, path_m = velocity_m_s(series), displacement_m(series)
    fastest, farthest = float(np.abs(velocity).max()), float(np.abs(path_m).max())
    of_peak, of_way = DRIFT_PATH
    last_m_s, last_m = float(velocity[-1]), float(path_m[-1])
    far = max(of_peak * farthest, of_way * fastest * series.duration_s)
    if abs(last_m_s) > DRIFT_VELOCITY * fastest or abs(last_m) > far:
        yield caution("record_drifts", velocity_m_s=last_m_s, displacement_m=last_m)


def _against_header(channel: Channel) -> Iterator[Finding]:
    """What of the header's peak the samples do not show."""
    accel, stated = channel.accel_m_s2, channel.stated_peak_m_s2
    if stated is None:
        return
    at = int(np.argmax(np.abs(accel)))
    if abs(abs(accel[at]) - abs(stated)) > STATED_PEAK_TOLERANCE * abs(stated):
        yield caution("record_peak_stated", peak_m_s2=float(accel[at]), stated_m_s2=stated)
    if channel.stated_peak_s is not None and abs(at * channel.dt_s - channel.stated_peak_s) > 2.0 * channel.dt_s:
        yield caution("record_peak_time", at_s=at * channel.dt_s, stated_s=channel.stated_peak_s)


def _likely_units(peak_g: float, unit: str) -> str:
    """Units in which these numbers would be an ordinary earthquake, as advice."""
    if unit not in UNITS_M_S2:
        return "look at the columns' units"
    said = [f"{name} ({value:.3g} g)" for name, value in _fitting_units(peak_g, unit).items()]
    return "the unit may be " + " or ".join(said) if said else "the unit or the file is wrong"


def _fitting_units(peak_g: float, unit: str) -> dict[str, float]:
    """Those units, with the peak in g; none where the file has several."""
    if unit not in UNITS_M_S2:
        return {}
    low, high = PLAUSIBLE_G
    peaks = {name: peak_g * factor / UNITS_M_S2[unit] for name, factor in UNITS_M_S2.items() if name != unit}
    return {name: value for name, value in peaks.items() if low <= value <= high}


def _longest_flat(accel: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> int:
    """Longest run of equal values (in steps) between 5 % and 95 % of the squared acceleration's integral."""
    build = np.cumsum(accel**2)
    first, last = (int(np.searchsorted(build, share * build[-1])) for share in _STRONG)
    equal = np.concatenate([[0], (np.diff(accel[first : last + 1]) == 0.0).astype(np.int8), [0]])
    edges = np.flatnonzero(np.diff(equal))
    return int((edges[1::2] - edges[::2]).max()) if edges.size else 0
