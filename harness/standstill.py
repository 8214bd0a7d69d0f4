"""What a scene in which nothing moves can be told: how far its motion is from moving it, and how to ask for more."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Final

from analytic.excitation import Rest
from harness.plan import limit_of_rest_m_s2
from harness.record import Run
from harness.scene import Scene

STILL_RAD: Final = 1e-4
"""A smaller rotation is the give of a contact engine, or an uneven base settling."""
STILL_M: Final = 1e-5
SIZE_KEYS: Final = {"pulse": "amplitude_g", "harmonic": "amplitude_g", "record": "scale"}
"""The key by which a scene file says how large a motion is."""
BEYOND: Final = 1.5
"""The motion proposed passes the limit by this factor: enough to be seen."""


def standstill(scene: Scene, runs: Iterable[Run]) -> str | None:
    """A sentence when no model's statue or pedestal moves although the floor does; None otherwise."""
    answered = [run for run in runs if not run.outcome.failed]
    peak = scene.shake.x.peak_m_s2
    if not answered or peak == 0.0 or any(_moves(run) for run in answered):
        return None
    limit, gravity = limit_of_rest_m_s2(scene), scene.gravity_m_s2
    how = "along x" if isinstance(scene.shake.y, Rest) else "in whatever direction"
    said = (
        f"nothing moves: a level push {how} begins to move it at {limit / gravity:.3g} g, the floor's peak along x is"
        f" {peak / gravity:.3g} g"
    )
    larger = motion_sized(scene, BEYOND * limit / peak)
    return f"{said}; to see it move try --set {larger}" if larger and limit > peak else said


def _moves(run: Run) -> bool:
    return run.outcome.overturned or abs(run.peak_theta_rad) > STILL_RAD or abs(run.peak_slip_m) > STILL_M


def motion_sized(scene: Scene, factor: float) -> str:
    """The key and value of a scene file that make its motion along x larger by a factor; empty where no single key does."""
    motion: Mapping[str, Any] = scene.given.get("motion", {}).get("x", {})
    key = SIZE_KEYS.get(str(motion.get("kind")))
    if key is None or (key == "scale" and ("pga_g" in motion or "pgv_m_s" in motion)):
        return ""
    before = motion.get(key, 1.0)
    return f"motion.x.{key}={float(before) * factor:.4g}" if isinstance(before, int | float) else ""
