"""What the rows of an effects study say together: the planar model asked at the base's sides, and each condition's effect."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np

from harness.effects3d.conditions import BASELINE, CONDITIONS, solid_of
from harness.model.scene import Scene
from meshes import footprint

Row = Mapping[str, Any]

GRAZING_COS: Final = 0.05
"""A side that the shaking meets more obliquely than this (87°) is not tipped by it."""


def static_rose(scene: Scene, azimuths_deg: Sequence[float], sides: Sequence[Row]) -> list[dict[str, Any]]:
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
    rows = []
    for azimuth, lifts, planar in zip(azimuths_deg, reach.tolist(), corner.tolist(), strict=True):
        least, side = _projected(azimuth, sides)
        rows.append(
            {"azimuth_deg": azimuth, "lifts_g": lifts, "planar_lifts_g": planar, "projected_g": least, "side_deg": side}
        )
    return rows


def _projected(azimuth_deg: float, sides: Sequence[Row]) -> tuple[float | None, float | None]:
    found = [
        (row["peak_g"] / share, row["azimuth_deg"])
        for row in sides
        for share in [math.cos(math.radians(azimuth_deg - row["azimuth_deg"]))]
        if row["peak_g"] is not None and share > GRAZING_COS
    ]
    return min(found, default=(None, None))


def effects(rows: Sequence[Row], conditions: Sequence[str]) -> list[dict[str, Any]]:
    """For every engine and condition how much the overturning amplitude changes: by direction, median, least and largest.

    `flips` counts directions at which the changed statue no longer overturns up to the most tried.
    """
    base = {(row["engine"], row["azimuth_deg"]): row["peak_g"] for row in rows if row["condition"] == BASELINE}
    found = []
    for engine in dict.fromkeys(row["engine"] for row in rows):
        for condition in conditions:
            mine = [row for row in rows if row["condition"] == condition and row["engine"] == engine]
            if not mine:
                continue
            changes = [
                {"azimuth_deg": row["azimuth_deg"], "relative": row["peak_g"] / base[engine, row["azimuth_deg"]] - 1.0}
                for row in mine
                if row["peak_g"] is not None
            ]
            values = [item["relative"] for item in changes]
            found.append(
                {
                    "engine": engine,
                    "condition": condition,
                    "group": CONDITIONS[condition].group,
                    "changes": changes,
                    "median": float(np.median(values)) if values else None,
                    "least": min(values, default=None),
                    "largest": max(values, default=None),
                    "flips": len(mine) - len(values),
                }
            )
    return found
