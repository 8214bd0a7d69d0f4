"""What the rows of an effects study say together: the planar model asked at the base's sides, and each condition's effect."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from harness.effects3d.conditions import CONDITIONS, solid_of
from harness.model.finding import Finding, info
from harness.model.scene import Scene
from harness.model.written import scan_azimuth_deg, written
from harness.records.effects3d import BASELINE, Amplitude, Change, Effect, StaticLimit
from meshes import footprint
from meshes.orientation import turn_axis
from meshes.solid import turn_about_z

GRAZING_COS: Final = 0.05
"""A side that the shaking meets more obliquely than this (87°) is not tipped by it."""


def scan_directions(scene: Scene) -> Finding:
    """Where the study's 0° and 90° point on the scan as its file has it, before it was set upright and turned."""
    file, up = (written(scene, "statue", "mesh", key) for key in ("file", "up"))
    back = turn_axis(str(up or "z")).T @ turn_about_z(scan_azimuth_deg(scene)).T
    first, second = ((column.round(12) + 0.0).tolist() for column in (back[:, 0], back[:, 1]))
    return info("scan_directions", file=str(file), along_0=first, along_90=second)


def static_rose(scene: Scene, azimuths_deg: Sequence[float], sides: Sequence[Amplitude]) -> list[StaticLimit]:
    """By direction: peaks, g, at which a level push lifts the statue in 3D and in the plane, and the sides' planar answer.

    `projected_g` is the least over the base's sides of the planar model's amplitude at the side divided by the cosine between
    shaking and the side's direction: the share of the shaking that turns the statue about that side.
    """
    solid = solid_of(scene)
    back = [azimuth + 180.0 for azimuth in azimuths_deg]
    # The floor shakes both ways along a direction.
    reach, corner = (
        np.minimum(of(solid.footprint_m, azimuths_deg), of(solid.footprint_m, back)) / solid.centroid_height_m
        for of in (footprint.reach_m, footprint.corner_m)
    )
    limits = zip(azimuths_deg, reach.tolist(), corner.tolist(), strict=True)
    return [StaticLimit(azimuth, lifts, planar, *_projected(azimuth, sides)) for azimuth, lifts, planar in limits]


def _projected(azimuth_deg: float, sides: Sequence[Amplitude]) -> tuple[float | None, float | None]:
    amplitudes = [
        (row.peak_g / share, row.azimuth_deg)
        for row in sides
        for share in [math.cos(math.radians(azimuth_deg - row.azimuth_deg))]
        if row.peak_g is not None and share > GRAZING_COS
    ]
    return min(amplitudes, default=(None, None))


def effects(rows: Sequence[Amplitude], conditions: Sequence[str]) -> list[Effect]:
    """For every engine and condition how much the overturning amplitude changes: by direction, median, least and largest."""
    base = {(row.engine, row.azimuth_deg): row.peak_g for row in rows if row.condition == BASELINE}
    by_engine = []
    for engine in dict.fromkeys(row.engine for row in rows):
        for condition in conditions:
            mine = [row for row in rows if row.condition == condition and row.engine == engine]
            if not mine:
                continue
            changes = [
                Change(row.azimuth_deg, row.peak_g / unchanged - 1.0)
                for row in mine
                for unchanged in [base[engine, row.azimuth_deg]]
                if row.peak_g is not None and unchanged is not None
            ]
            values = [item.relative for item in changes]
            median = float(np.median(values)) if values else None
            least, largest = min(values, default=None), max(values, default=None)
            group = CONDITIONS[condition].group
            flips = sum(row.peak_g is None for row in mine)
            by_engine.append(Effect(engine, condition, group, changes, median, least, largest, flips))
    return by_engine
