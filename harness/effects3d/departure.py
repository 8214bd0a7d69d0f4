"""How far a run in three dimensions leaves the plane of shaking: tilt, yaw, way, and whether it rocks on an edge or a corner."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from harness.effects3d.conditions import amplified, changed_scene, solid_of
from harness.effects3d.search import peak_g, run_once
from harness.model.errors import InputError, Mistake
from harness.model.history import History
from harness.model.scene import Scene
from harness.records.effects3d import BASELINE, Departure

UPRIGHT_RAD: Final = 1.0
"""Beyond this tilt the statue is falling: its yaw and its way say nothing of rocking."""
ROCKING_RAD: Final = 2e-3
"""A smaller lean is no rocking: it is what an uneven base and the contact's give amount to."""
EDGE_M: Final = 5e-4
"""Another foot as near to the lowest as this shares the load: the statue turns about an edge, not about one corner."""
APART_SHARE: Final = 0.1
"""Feet nearer to each other than this share of the base are one corner."""


def departure(scene: Scene, azimuth_deg: float, engine: str, floor_g: float, dt_s: float) -> Departure:
    """How far a 3D engine's statue leaves the plane when shaken along that azimuth alone with that peak. Raises `InputError`."""
    turned = changed_scene(scene, BASELINE, azimuth_deg)
    shaken = amplified(turned, floor_g / peak_g(turned))
    run = run_once(shaken, engine, dt_s, history=True)
    if run.history is None:
        raise InputError(Mistake(engine, "history", "a run with a history", run.message or run.outcome.value))
    extra, theta = run.history.extra, run.history.theta_rad
    standing = np.hypot(theta, extra["out_of_plane_rad"]) < UPRIGHT_RAD
    until = len(theta) if standing.all() else int(np.argmin(standing))
    yaw, across = (extra[name][:until] - extra[name][0] for name in ("yaw_rad", "statue_y_m"))
    return Departure(
        azimuth_deg=float(azimuth_deg),
        engine=engine,
        peak_g=floor_g,
        outcome=run.outcome,
        peak_theta_rad=float(np.abs(theta[:until]).max()),
        out_of_plane_rad=float(np.abs(extra["out_of_plane_rad"][:until]).max()),
        yaw_rad=float(np.abs(yaw).max()),
        across_m=float(np.abs(across).max()),
        yaw_left_rad=float(yaw[-1]),
        walked_m=float(math.hypot(across[-1], extra["statue_slip_m"][until - 1])),
        corner_share=corner_share(shaken, run.history, until),
    )


def corner_share(scene: Scene, history: History, until: int) -> float:
    """Share of the rocking time (lean above 2 mrad) in which a single corner carries the statue; 0 when it never rocks."""
    feet = solid_of(scene).feet_m - np.array([0.0, 0.0, scene.statue.centroid_height_m])
    roll, pitch = (history.extra[name][:until] for name in ("roll_rad", "pitch_rad"))
    # The last row of the rotation: each body axis's share of the vertical.
    up = np.column_stack([-np.sin(pitch), np.cos(pitch) * np.sin(roll), np.cos(pitch) * np.cos(roll)])
    heights = up @ feet.T
    rocking = np.arccos(np.clip(up[:, 2], -1.0, 1.0)) > ROCKING_RAD
    if not rocking.any():
        return 0.0
    lowest = np.argmin(heights, axis=1)
    spans = np.linalg.norm(feet[:, None, :2] - feet[None, :, :2], axis=2)
    elsewhere = spans[lowest] > APART_SHARE * spans.max()
    above = np.where(elsewhere, heights - heights.min(axis=1)[:, None], np.inf).min(axis=1)
    return float(np.mean(above[rocking] > EDGE_M))
