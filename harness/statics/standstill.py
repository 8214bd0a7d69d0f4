"""What a scene in which nothing moves can be told: how far its motion is from moving it, and from which size on it does."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Final

import numpy as np

from harness.input.motions.spec import LARGEST_G, LARGEST_SCALE
from harness.model.finding import Finding, caution, changes_answer
from harness.model.history import Outcome
from harness.model.run import Run
from harness.model.scene import Scene, written
from harness.statics.push import least_x_factor, push_of

STILL_RAD: Final = 1e-4
"""A smaller rotation is the give of a contact engine, or an uneven base settling."""
STILL_M: Final = 1e-5
DIGIT_ROUNDING: Final = 1e-3
"""Of a fourth digit: what the factor itself is found to, so that 1.0000001 is told as 1 and not as 1.001."""
SIZE_KEYS: Final = {"pulse": "amplitude_g", "harmonic": "amplitude_g", "record": "scale"}
"""The key by which a scene file says how large a motion is."""
LARGEST: Final = {"amplitude_g": LARGEST_G, "scale": LARGEST_SCALE}
"""What a scene file takes for these keys at most."""


def standstill(scene: Scene, runs: Iterable[Run]) -> Finding | None:
    """What is to know when no model's statue or pedestal moves although the floor pushes it; None otherwise."""
    answered = [run for run in runs if not run.outcome.failed]
    push = push_of(scene)
    if not answered or push.peak == 0.0 or any(_moves(run) for run in answered):
        return None
    cause, share = push.first
    if share >= 1.0:
        times = share if math.isfinite(share) else None
        return caution(
            "no_model_moves", limit_rad=STILL_RAD, limit_m=STILL_M, push_g=push.peak, times=times, cause=cause
        )
    return changes_answer("nothing_moves", push_g=push.peak, share=share, cause=cause, least=_least(scene))


def _moves(run: Run) -> bool:
    if run.outcome is not Outcome.STANDS or abs(run.peak_theta_rad) > STILL_RAD or abs(run.peak_slip_m) > STILL_M:
        return True
    # Across the rocking plane, about the vertical, and over its support a statue moves in columns of its own.
    extra = {} if run.history is None else run.history.extra
    limits = {"roll_rad": STILL_RAD, "yaw_rad": STILL_RAD, "statue_slip_m": STILL_M}
    return any(np.ptp(extra[name]) > limit for name, limit in limits.items() if name in extra)


def _least(scene: Scene) -> str:
    """The least value of the key of the motion along x that moves the statue, rounded up to four digits; empty without one."""
    key, before = _size(scene)
    if key is None or before == 0.0:
        return ""
    factor = least_x_factor(scene, LARGEST[key] / abs(before))
    if factor is None:
        return ""
    digit = 10.0 ** (math.floor(math.log10(abs(factor * before))) - 3)
    return (
        f"motion.x.{key}={math.copysign(digit * math.ceil(abs(factor * before) / digit - DIGIT_ROUNDING), before):.4g}"
    )


def motion_sized(scene: Scene, factor: float) -> str:
    """The key and value of a scene file that make its motion along x larger by a factor; empty where no single key does."""
    key, before = _size(scene)
    return "" if key is None else f"motion.x.{key}={before * factor:.4g}"


def _size(scene: Scene) -> tuple[str | None, float]:
    """The key that says how large the motion along x is, and its value; None where no single key does."""
    motion = written(scene, "motion", "x")
    if not isinstance(motion, Mapping):
        return None, 0.0
    key = SIZE_KEYS.get(str(motion.get("kind")))
    if key is None or (key == "scale" and ("pga_g" in motion or "pgv_m_s" in motion)):
        return None, 0.0
    before = motion.get(key, 1.0)
    return (key, float(before)) if isinstance(before, int | float) else (None, 0.0)
