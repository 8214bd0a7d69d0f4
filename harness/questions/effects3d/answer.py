"""What an effects study says: the planar model against the solid one by direction, and each effect beside a survey's errors."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, Final

import numpy as np

from harness.model.finding import Answer, Finding, caution, changes_answer, info
from harness.model.history import Outcome
from harness.records.effects3d import BASELINE, SOLID, EffectsRecord

NEAR: Final = 0.05
"""Amplitudes within this share of each other count as the same: a survey's errors move them as much."""
LEAVES_RAD: Final = 1e-3
"""A statue that leaves the plane of shaking by more is said to."""
UNKNOWN: Final = (0.05, 0.95)
"""Quantiles between which the changes by a survey's errors are told."""

Peaks = Mapping[float, float]


def answer_of(record: EffectsRecord) -> Answer:
    """At how many directions the planar model is too safe, by how much at most, and the least peak that overturns."""
    solid, planar = (_peaks(record, name) for name in (record.solid_engine, "analytic"))
    found = [*_planar(record, solid, planar)] if planar else [changes_answer("plane_not_asked")]
    for name, peaks in ((record.solid_engine, solid), ("analytic", planar)):
        least_g = min(peaks.values(), default=math.inf)
        if math.isfinite(least_g):
            azimuth_deg = next(a for a, peak in peaks.items() if peak == least_g)
            found.append(info("least_peak", model=name, peak_g=least_g, azimuth_deg=azimuth_deg))
    return Answer(found[0].code, [*found, info("effects_done", **vars(record.summary))])


def findings_of(record: EffectsRecord) -> list[Finding]:
    """All that is to be known beside the headline."""
    return [*_solid_pairs(record), *_effects(record), *_leaving(record)]


def _peaks(record: EffectsRecord, engine: str) -> dict[float, float]:
    """Overturning peak by direction of one engine, infinite where it does not overturn up to the most tried."""
    rows = record.amplitudes(engine, BASELINE)
    return {row.azimuth_deg: math.inf if row.peak_g is None else row.peak_g for row in rows}


def _planar(record: EffectsRecord, solid: Peaks, planar: Peaks) -> Iterator[Finding]:
    over = [a for a in solid if math.isfinite(solid[a]) and planar[a] > (1.0 + NEAR) * solid[a]]
    sides = [row for row in record.static if math.isfinite(solid.get(row.azimuth_deg, math.inf))]
    apart = {row: abs(row.projected_g / solid[row.azimuth_deg] - 1.0) for row in sides if row.projected_g is not None}
    values: dict[str, Any] = {"over": len(over), "directions": len(solid), "near": NEAR, "model": record.solid_engine}
    yield changes_answer("plane_unsafe", **values) if over else info("plane_safe", **values)
    fall_over = {row.azimuth_deg: [row.side_deg] for row, share in apart.items() if share <= NEAR}
    if apart:
        median = float(np.median([*apart.values()]))
        yield info("plane_by_sides", median=median, directions=len(apart), within=len(fall_over), near=NEAR)
    if over:
        most_g = record.study.search.most_g
        worst = max(over, key=lambda a: min(planar[a], most_g) / solid[a])
        never = sum(math.isinf(planar[a]) for a in over)
        values = {"azimuth_deg": worst, "solid_g": solid[worst], "never": never, "sides_deg": fall_over.get(worst, [])}
        bounded = math.isfinite(planar[worst])
        yield info(
            "plane_worst",
            bounded=bounded,
            planar_g=planar[worst] if bounded else most_g,
            error=min(planar[worst], most_g) / solid[worst] - 1.0,
            **values,
        )


def _solid_pairs(record: EffectsRecord) -> Iterator[Finding]:
    """Each other 3D engine against the first, and where the exact model's own answer is in doubt."""
    first = record.solid_engine
    one = _peaks(record, first)
    for name in (name for name in record.engines if name in SOLID and name != first):
        other = _peaks(record, name)
        both = [a for a in one if math.isfinite(one[a]) and math.isfinite(other.get(a, math.inf))]
        apart = np.abs([other[a] / one[a] - 1.0 for a in both])
        if both:
            values = {"median": float(np.median(apart)), "within": int((apart <= NEAR).sum()), "directions": len(both)}
            yield info("solids_apart", a=name, b=first, near=NEAR, **values)
    doubted = {row.azimuth_deg: row.doubt for row in record.amplitudes(first, BASELINE) if row.doubt}
    if undecided := [azimuth for azimuth, doubt in doubted.items() if doubt == "undecided"]:
        yield caution("peaks_undecided", azimuths_deg=undecided).of(first)
    if change := [azimuth for azimuth, doubt in doubted.items() if doubt == "change"]:
        yield caution("peaks_change", azimuths_deg=change).of(first)


def _effects(record: EffectsRecord) -> Iterator[Finding]:
    """The least and largest change of each by direction, beside the range of what a survey does not know."""
    mine = [item for item in record.effects if item.engine == record.solid_engine and item.median is not None]
    unknown = [change.relative for item in mine if item.group == "uncertainty" for change in item.changes]
    if unknown:
        low, high = (float(np.quantile(unknown, q)) for q in UNKNOWN)
        yield info("survey_effect", low=low, high=high, model=record.solid_engine)
    shown = {item.condition: [item.least, item.largest] for item in mine if item.group != "uncertainty"}
    if shown:
        yield info("other_effects", ranges=shown)


def _leaving(record: EffectsRecord) -> Iterator[Finding]:
    """How far statues that stand leave the plane: one that falls at less than the least found, too, is no example of it."""
    mine = [each for each in record.departures if each.engine == record.solid_engine and each.outcome == Outcome.STANDS]
    leaving = [row.out_of_plane_rad for row in mine if row.out_of_plane_rad > LEAVES_RAD]
    if leaving:
        yield info(
            "leaves_plane",
            share=record.study.share,
            leaving=len(leaving),
            directions=len(mine),
            out_of_plane_rad=max(leaving),
            yaw_rad=max(abs(row.yaw_left_rad) for row in mine),
            walked_m=max(row.walked_m for row in mine),
        )
