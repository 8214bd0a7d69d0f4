"""ISO/TS 18571 by the library of TU Graz (extra `iso`), on a stated resampling; loaded only when asked."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from harness.model.errors import InputError, Mistake
from harness.model.history import Pair
from harness.records.scores import IsoRating

SAMPLES: Final = 1001
"""Samples after resampling: the rating's time warping costs the square of their number in time and memory."""

WEIGHTS: Final = {"corridor": 0.4, "phase": 0.2, "magnitude": 0.2, "slope": 0.2}
"""Weights of the overall rating (ISO/TS 18571, also the library's defaults)."""


def rate(pair: Pair, samples: int = SAMPLES) -> IsoRating:
    """Corridor, phase, magnitude, slope and overall rating (1 is perfect) of θ_a against θ_b.

    The specification was made for signals at 10 kHz; here both histories are resampled linearly to `samples` equal steps over
    the window, and that step is stated. Raises `InputError` when the extra is not installed, the window is too short, or a
    history does not move (the rating divides by its norm).
    """
    try:
        from objective_rating_metrics.rating import ISO18571
    except ImportError as error:
        advice = 'install it: pip install "rockcheck[iso]"'
        raise InputError(Mistake("--iso", "", "the extra `iso`", "no objective_rating_metrics", advice)) from error
    if pair.t_s.size < 10:
        raise InputError(Mistake("--iso", "", "at least 10 common samples", f"{pair.t_s.size}"))
    if np.ptp(pair.theta_a_rad) == 0.0 or np.ptp(pair.theta_b_rad) == 0.0:
        raise InputError(Mistake("--iso", "", "two histories that move", "one that stays at a constant rotation"))
    curves, step = resampled(pair, samples)
    rating = ISO18571(reference_curve=curves[1], comparison_curve=curves[0], dt=step)
    # Each rating once: the library's own overall_rating computes them all again.
    parts = {
        "corridor": float(rating.corridor_rating(-1)),
        "phase": float(rating.phase_rating(-1)),
        "magnitude": float(rating.magnitude_rating(-1)),
        "slope": float(rating.slope_rating(-1)),
    }
    overall = sum(WEIGHTS[name] * value for name, value in parts.items())
    return IsoRating(**parts, overall=overall, resampled_dt_s=step, samples=samples)


def resampled(pair: Pair, samples: int) -> tuple[tuple[Any, Any], float]:
    """Both rotations as (samples, 2) arrays of time and value on equal steps, and the step in s."""
    t_s = np.linspace(pair.start_s, pair.end_s, samples)
    curves = [np.column_stack((t_s, np.interp(t_s, pair.t_s, x))) for x in (pair.theta_a_rad, pair.theta_b_rad)]
    return (curves[0], curves[1]), float(t_s[1] - t_s[0])
