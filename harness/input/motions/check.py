"""Integrity of a record: what makes it unusable is refused, what only makes it doubtful is said."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from analytic.excitation import Excitation, SampledAcceleration
from harness.input.motions.oscillator import exact_step
from harness.input.motions.recordfile import (
    STANDARD_GRAVITY_M_S2,
    UNITS_M_S2,
    Channel,
    Floats,
    RecordFile,
    Series,
    displacement_m,
    velocity_m_s,
)
from harness.input.motions.spec import Oscillator
from harness.input.motions.text import mistake
from harness.model.finding import Finding, caution, info

# The building's filter: the acceleration of a floor from that of the ground, by one or several
# oscillators.
#
# a_floor = (1 − Σφᵢ) a + Σ φᵢ (q̈ᵢ + a), with qᵢ the i-th mode's relative displacement and φᵢ its share
# (participation factor times shape at the floor): docs/motions.md, "The building's filter".


POINTS_PER_PERIOD: Final = 70
"""Samples in the shortest period: straight lines miss a sine by at most (2π/70)²/8 = 0.1 % of its amplitude."""
RING_DOWN: Final = 1e-3
"""The floor is followed until its slowest mode has decayed to this share."""
_JUMP_S = 1e-9
"""A jump of the floor's acceleration (Σφ ≠ 1 under a pulse) is drawn over this time."""


def ring_down_s(modes: Sequence[Oscillator]) -> float:
    """Time in which the slowest mode decays to RING_DOWN after the ground has stopped, s."""
    return max(-math.log(RING_DOWN) * mode.period_s / (2.0 * math.pi * mode.damping) for mode in modes)


def floor_motion(ground: Excitation, modes: Sequence[Oscillator], until_s: float) -> SampledAcceleration:
    """The floor's acceleration from 0 to `until_s`, sampled so finely that straight lines between samples hold.

    Exact at the samples for grounds of straight lines (records, rectangular pulses).
    """
    shortest = min(mode.period_s for mode in modes)
    t_s, before, after = _nodes(ground, shortest / POINTS_PER_PERIOD, until_s)
    rigid = 1.0 - sum(mode.share for mode in modes)
    moving = np.zeros(t_s.size)
    for mode in modes:
        moving += mode.share * _absolute(t_s, before, after, mode)
    return _drawn(t_s, rigid * before + moving, rigid * after + moving)


def _nodes(ground: Excitation, longest_step_s: float, until_s: float) -> tuple[Floats, Floats, Floats]:
    """Times that hold every break of the ground, and its acceleration just before and just after each."""
    breaks = np.concatenate([[0.0], ground.breaks_s(until_s), [until_s]])
    if ground.end_s < until_s:
        breaks = np.append(breaks, ground.end_s)
    breaks = np.unique(breaks)
    pieces = [
        np.linspace(
            start, end, max(1, math.ceil((end - start) / _harmonic_step(ground, longest_step_s))), endpoint=False
        )
        for start, end in zip(breaks[:-1].tolist(), breaks[1:].tolist(), strict=True)
    ]
    t_s = np.append(np.concatenate(pieces), until_s)
    gap = np.diff(t_s)
    inside = 1e-7 * np.concatenate([[gap[0]], np.minimum(gap[:-1], gap[1:]), [gap[-1]]])
    before, after = ground.accel_m_s2(np.maximum(t_s - inside, 0.0)), ground.accel_m_s2(t_s + inside)
    at = ground.accel_m_s2(t_s)
    smooth = np.abs(after - before) <= 1e-4 * max(ground.peak_m_s2, 1e-300)
    before, after = np.where(smooth, at, before), np.where(smooth, at, after)
    return t_s, before, after


def _harmonic_step(ground: Excitation, longest_step_s: float) -> float:
    """The longest step that also follows a ground which is not made of straight lines."""
    omega = getattr(ground, "omega_rad_s", 0.0)
    return min(longest_step_s, 2.0 * math.pi / omega / POINTS_PER_PERIOD) if omega > 0.0 else longest_step_s


def _absolute(t_s: Floats, before: Floats, after: Floats, mode: Oscillator) -> Floats:
    """Absolute acceleration of one oscillator at every node (n,), from rest, exact for straight lines between nodes."""
    result = np.zeros(t_s.size)
    displacement = velocity = 0.0
    steps = np.diff(t_s)
    dt_s, row = -1.0, (0.0, 0.0)
    p00 = p01 = p10 = p11 = s0 = s1 = e0 = e1 = 0.0
    for i, step_s in enumerate(steps.tolist()):
        if abs(step_s - dt_s) > 1e-12 * step_s:
            dt_s = step_s
            step = exact_step(mode.period_s, mode.damping, dt_s)
            (p00, p01), (p10, p11) = step.phi.tolist()
            (s0, s1), (e0, e1) = step.b0.tolist(), step.b1.tolist()
            row = (float(step.row_absolute[0]), float(step.row_absolute[1]))
        start, end = after[i], before[i + 1]
        displacement, velocity = (
            p00 * displacement + p01 * velocity + s0 * start + e0 * end,
            p10 * displacement + p11 * velocity + s1 * start + e1 * end,
        )
        result[i + 1] = row[0] * displacement + row[1] * velocity
    return result


def _drawn(t_s: Floats, before: Floats, after: Floats) -> SampledAcceleration:
    """A record through all nodes, its jumps drawn over _JUMP_S."""
    jumps = np.flatnonzero(np.abs(after - before) > 0.0)
    jumps = jumps[(jumps > 0) & (jumps < t_s.size - 1)]
    times = np.insert(t_s, jumps, t_s[jumps] - _JUMP_S)
    values = np.insert(after, jumps, before[jumps])
    values[-1] = before[-1]
    return SampledAcceleration(times, values)


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


def _channel(channel: Channel, record: RecordFile) -> list[Finding]:
    accel = channel.accel_m_s2
    if accel.size < 2:
        raise mistake(record.path, channel.name, "two samples or more", str(accel.size), "the file holds no motion")
    least_s, most_s = STEPS_S
    if not least_s <= channel.dt_s <= most_s:
        raise mistake(record.path, channel.name, f"a step between {least_s:g} and {most_s:g} s", f"{channel.dt_s:g} s")
    if record.unit in UNITS_M_S2:
        refuse_fillers(accel / UNITS_M_S2[record.unit], record.path, lambda row: f"{channel.name}, sample {row + 1}")
    peak_g = float(np.abs(accel).max()) / STANDARD_GRAVITY_M_S2
    if peak_g == 0.0:
        raise mistake(record.path, channel.name, "a motion", "nothing but zeros")
    if peak_g > LARGEST_PEAK_G:
        likely = _likely_units(peak_g, record.unit)
        if spikes := _spikes(channel, record):
            likely = f"{spikes['alone']} of {spikes['samples']} samples stand alone above all others: spikes, or missing samples?"
        raise mistake(
            record.path, channel.name, f"a peak below {LARGEST_PEAK_G:g} g", f"{peak_g:.4g} g in {record.unit}", likely
        )
    doubts = _of_clock_and_sense(channel)
    if spikes := _spikes(channel, record):
        doubts.append(caution("record_spikes", **spikes))
    if peak_g < SMALLEST_PEAK_G:
        claimed = channel.stated_peak_m_s2 is not None and not _against_header(channel)
        units = [*_fitting_units(peak_g, record.unit)]
        doubts.append(caution("record_small", peak_g=peak_g, stated=claimed, units=units))
    doubts += [*_against_header(channel), *_drift(channel)]
    edge = max(1, int(_END_SHARE * accel.size))
    for name, part in (("begins", accel[:edge]), ("ends", accel[-edge:])):
        share = float(np.abs(part).max() / np.abs(accel).max())
        if share > ABRUPT:
            doubts.append(caution("record_abrupt", at=name, share=share))
    run = _longest_flat(accel)
    if run > _FLAT_SAMPLES:
        doubts.append(caution("record_flat", lasts_s=run * channel.dt_s))
    return doubts


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


def _of_clock_and_sense(channel: Channel) -> list[Finding]:
    """What is doubtful in the step, and what was taken for granted of the direction."""
    doubts: list[Finding] = []
    least_s, most_s = USUAL_STEPS_S
    if not least_s <= channel.dt_s <= most_s:
        lasts = channel.dt_s * (channel.accel_m_s2.size - 1)
        doubts.append(caution("record_step", dt_s=channel.dt_s, lasts_s=lasts))
    if channel.orientation.sense_assumed:
        doubts.append(caution("record_sense_assumed"))
    if channel.orientation.sign < 0:
        doubts.append(info("record_downwards"))
    return doubts


def _drift(channel: Channel) -> list[Finding]:
    """Whether the record runs away when it is integrated, and what takes that off."""
    series = Series(channel.dt_s, channel.accel_m_s2)
    velocity, path_m = velocity_m_s(series), displacement_m(series)
    fastest, farthest = float(np.abs(velocity).max()), float(np.abs(path_m).max())
    left = (abs(float(velocity[-1])), abs(float(path_m[-1])))
    of_peak, of_way = DRIFT_PATH
    if left[0] <= DRIFT_VELOCITY * fastest and not (
        left[1] > of_peak * farthest and left[1] > of_way * fastest * series.duration_s
    ):
        return []
    return [caution("record_drifts", velocity_m_s=float(velocity[-1]), displacement_m=float(path_m[-1]))]


def _against_header(channel: Channel) -> list[Finding]:
    accel, stated = channel.accel_m_s2, channel.stated_peak_m_s2
    if stated is None:
        return []
    doubts: list[Finding] = []
    at = int(np.argmax(np.abs(accel)))
    if abs(abs(accel[at]) - abs(stated)) > STATED_PEAK_TOLERANCE * abs(stated):
        doubts.append(caution("record_peak_stated", peak_m_s2=float(accel[at]), stated_m_s2=stated))
    if channel.stated_peak_s is not None and abs(at * channel.dt_s - channel.stated_peak_s) > 2.0 * channel.dt_s:
        doubts.append(caution("record_peak_time", at_s=at * channel.dt_s, stated_s=channel.stated_peak_s))
    return doubts


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
