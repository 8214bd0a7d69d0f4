"""The page of an effects study: what the third dimension changes, by direction, against what a survey does not know."""

from __future__ import annotations

import math
import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

import numpy as np

from harness.records.effects3d import BASELINE, SOLID, EffectsRecord
from reports.drawing.effects_figures import changes, curves, directions, rose
from reports.drawing.scene_picture import scene_svg
from reports.messages import ENGLISH
from reports.messages.numbers import digits, unit
from reports.pages.run_page import chip, replay_values
from reports.source import run_source
from reports.text.wording import Verdict

NEAR: Final = 0.05
"""Amplitudes within this share of each other count as the same: a survey's errors move them as much."""
LEAVES_RAD: Final = 1e-3
ROSE_WORDS: Final = (
    "Least peak acceleration of the floor that overturns the statue, by direction of shaking, in every model."
)
CHANGES_WORDS: Final = (
    "Change of the overturning amplitude under each condition, in per cent, one dot for each direction."
)

Peaks = Mapping[float, float]


def context(folder: Path, record: EffectsRecord) -> dict[str, object]:
    """Everything that the template shows."""
    engines = record.engines
    source = run_source(folder / record.replay.folder) if record.replay else None
    replay = replay_values(source) if source is not None and source.histories else None
    return {
        "verdict": effects_verdict(record),
        "chips": [chip(name, engines) for name in engines],
        "picture": scene_svg(record.scene),
        "directions": source and directions(record, source),
        "rose": rose(record).svg(ROSE_WORDS),
        "keys": curves(record),
        "engines": engines,
        "peaks": {name: {row.azimuth_deg: row.peak_g for row in record.amplitudes(name, BASELINE)} for name in engines},
        "band_at": {row.azimuth_deg: row for row in record.bands},
        "falls": {
            row.azimuth_deg: row.outcome.removeprefix("overturned_")
            for row in record.amplitudes(record.solid_engine, BASELINE)
        },
        "changes": changes(record).svg(CHANGES_WORDS, style="min-width: 700px"),
        "effect_engines": list(dict.fromkeys(item.engine for item in record.effects)),
        "change": _change,
        "solid": record.solid_engine,
        "replay": replay,
        "chosen": record.replay,
        "replay_ends": record.replay and [f"{end.sentence} ({name})" for name, end in record.replay.outcomes.items()],
        "command": f"rockcheck study {shlex.quote(record.file)}",
    }


def _peaks(record: EffectsRecord, engine: str) -> dict[float, float]:
    """Overturning peak by direction of one engine, infinite where it does not overturn up to the most tried."""
    rows = record.amplitudes(engine, BASELINE)
    return {row.azimuth_deg: math.inf if row.peak_g is None else row.peak_g for row in rows}


def effects_verdict(record: EffectsRecord) -> Verdict:
    """What the roses say of the planar model, and each effect against the uncertainty of a survey."""
    engine = record.solid_engine
    solid, planar = _peaks(record, engine), _peaks(record, "analytic")
    points: list[str] = []
    headline, tone = "The planar model was not asked", "differ"
    if planar:
        over = [a for a in solid if math.isfinite(solid[a]) and planar[a] > (1.0 + NEAR) * solid[a]]
        headline = (
            f"Asked in the plane of shaking, the planar model takes the statue for too safe at {len(over)} of"
            f" {len(solid)} directions"
        )
        tone = "differ" if over else "agree"
        sides = _by_sides(record, solid, engine)
        headline += f"; asked at the base's sides, it is right within {sides[0]} % in the median" if sides else ""
        points += [
            *_unsafe(solid, planar, record.study.search.most_g),
            *_worst(over, solid, planar, engine),
            *sides[1:],
        ]
    points += [*_solid_pair(record), *_least(solid, planar), *_effect_points(record, engine), *_leaving(record, engine)]
    return Verdict(headline, tone, points)


def _unsafe(solid: Peaks, planar: Peaks, most_g: float) -> list[str]:
    """The planar model's largest error to the unsafe side in one number; a lower bound where it never overturns."""
    errors = {a: min(planar[a], most_g) / solid[a] - 1.0 for a in solid if math.isfinite(solid[a]) and a in planar}
    if not errors or max(errors.values()) <= 0.0:
        return []
    worst = max(errors, key=lambda a: errors[a])
    least = "at least " if math.isinf(planar[worst]) else ""
    return [f"The plane is {least}{digits(100.0 * errors[worst], 2)} % unsafe towards {worst:g}°."]


def _worst(over: Sequence[float], solid: Peaks, planar: Peaks, engine: str) -> list[str]:
    if not over:
        return [f"At every direction it overturns within {100.0 * NEAR:g} % of {engine}, or earlier."]
    worst = max(over, key=lambda a: planar[a] / solid[a] if math.isfinite(planar[a]) else -solid[a])
    stands = [a for a in over if math.isinf(planar[a])]
    said = [
        f"At {worst:g}° it overturns from {unit(planar[worst], 'g')}, in three dimensions ({engine}) from"
        f" {unit(solid[worst], 'g')}: shaken obliquely the statue falls over its weakest side, which the section in the plane"
        " of shaking does not have."
    ]
    if stands:
        said.append(f"At {len(stands)} directions the planar model never overturns, though {engine} does.")
    return said


def _by_sides(record: EffectsRecord, solid: Peaks, engine: str) -> list[str]:
    """How well the planar model does when asked at the base's sides: the median in per cent, and the sentence; or nothing."""
    ratios = [
        row.projected_g / solid[row.azimuth_deg] - 1.0
        for row in record.static
        if row.projected_g is not None and math.isfinite(solid.get(row.azimuth_deg, math.inf))
    ]
    if not ratios:
        return []
    sizes = np.abs(ratios)
    middle = digits(100.0 * float(np.median(sizes)), 2)
    return [
        middle,
        "Asked at the sides of the base, each with its share of the shaking, the planar model differs from"
        f" {engine} by {middle} % (median of {len(ratios)} directions; within {100.0 * NEAR:g} % at"
        f" {int((sizes <= NEAR).sum())} of them).",
    ]


def _solid_pair(record: EffectsRecord) -> list[str]:
    """Each other 3D engine against the first, and where the exact model's own answer is in doubt."""
    first = record.solid_engine
    one, said = _peaks(record, first), []
    for name in (name for name in record.engines if name in SOLID and name != first):
        other = _peaks(record, name)
        both = [a for a in one if math.isfinite(one[a]) and math.isfinite(other.get(a, math.inf))]
        apart = np.abs([other[a] / one[a] - 1.0 for a in both])
        if both:
            said.append(
                f"{name} and {first} are {digits(100.0 * float(np.median(apart)), 2)} % apart (median; within"
                f" {100.0 * NEAR:g} % at {int((apart <= NEAR).sum())} of {len(both)} directions asked of both)."
            )
    doubts = [row for row in record.amplitudes(first, BASELINE) if row.doubt]
    if doubts:
        each = ENGLISH.listed(f"{row.azimuth_deg:g}° ({row.doubt})" for row in doubts)
        said.append(f"The answer of {first} is in doubt at {each}.")
    return said


def _least(solid: Peaks, planar: Peaks) -> list[str]:
    said = []
    for name, peaks in (("three dimensions", solid), ("the planar model", planar)):
        if peaks and math.isfinite(min(peaks.values())):
            azimuth = min(peaks, key=lambda a: peaks[a])
            said.append(f"{unit(peaks[azimuth], 'g')} at {azimuth:g}° in {name}")
    return [f"The least peak that overturns, over all directions: {ENGLISH.listed(said)}."] if said else []


def _effect_points(record: EffectsRecord, engine: str) -> list[str]:
    """The medians' sizes by group, beside the range of what a survey does not know."""
    mine = [item for item in record.effects if item.engine == engine and item.median is not None]
    unknown = [change.relative for item in mine if item.group == "uncertainty" for change in item.changes]
    said = []
    if unknown:
        low, high = (float(np.quantile(unknown, q)) for q in (0.05, 0.95))
        said.append(
            f"3 % of error in height, base or inertia and 10 % in friction, one at a time, move the amplitude by {_change(low)}"
            f" to {_change(high)} (5 to 95 % of directions; {engine})."
        )
    shown = [item for item in mine if item.group != "uncertainty"]
    if shown:
        each = ENGLISH.listed(f"{item.condition} {_change(item.median)}" for item in shown)
        said.append(f"Beside it, in the median of the directions: {each}.")
    return said


def _change(relative: float | None) -> str:
    """A relative change in per cent with its sign."""
    if relative is None:
        return "–"
    text = f"{100.0 * relative:+.1f}"
    return f"{'0.0' if float(text) == 0.0 else text.replace('-', '−')} %"


def _leaving(record: EffectsRecord, engine: str) -> list[str]:
    mine = [row for row in record.departures if row.engine == engine]
    leaving = [row for row in mine if row.out_of_plane_rad > LEAVES_RAD]
    if not leaving:
        return []
    tilt = max(row.out_of_plane_rad for row in leaving)
    yaw = max(abs(row.yaw_left_rad) for row in mine)
    walked = max(row.walked_m for row in mine)
    return [
        f"Shaken with {100.0 * record.study.share:g} % of that amplitude the statue leaves the plane of shaking at"
        f" {len(leaving)} of {len(mine)} directions, by up to {unit(tilt, 'rad', 2)}; it stays turned by up to"
        f" {unit(yaw, 'rad', 2)} and moved by up to {unit(1000.0 * walked, 'mm', 2)}."
    ]
