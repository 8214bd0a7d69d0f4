"""How far two runs are apart."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from harness.model.run import Run

INSTANTS: Final = 4000
"""Instants at which two histories are compared: the finest features, impacts, last longer than a thousandth of any scene."""


def errors(run: Run, other: Run, until_s: float = math.inf) -> tuple[float, float]:
    """Largest differences of rotation, rad, and slip, m, at a run's samples while both last; infinite without histories."""
    if run.history is None or other.history is None:
        return math.inf, math.inf
    times = run.history.t_s[run.history.t_s <= min(until_s, run.end_s, other.end_s)]
    return (
        float(np.max(np.abs(run.history.at(times) - other.history.at(times)), initial=0.0)),
        float(np.max(np.abs(run.history.slip_at(times) - other.history.slip_at(times)), initial=0.0)),
    )


def error_rad(run: Run, other: Run, until_s: float = math.inf) -> float:
    """Largest difference of two rotations, rad, at `INSTANTS`, up to the earlier end; infinite without histories."""
    if run.history is None or other.history is None:
        return math.inf
    times = np.linspace(0.0, min(run.end_s, other.end_s, until_s), INSTANTS)
    return float(np.max(np.abs(run.history.at(times) - other.history.at(times))))
