"""How far two runs of one engine with different steps are apart, and what that says of the finer one."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.history import History
from harness.record import Run

Array = NDArray[np.float64]

SAFETY: Final = 3.0
"""Stated uncertainty over the error that a spread shows: what the grid convergence index takes for two grids (Roache, 1994);
docs/pymunk.md, "A target accuracy", says how often it was enough."""
LEAST_RATIO: Final = 1.5
"""Two steps that are nearer to each other than this say no more of the error than two that are so far apart."""
CLEAR: Final = 4.0
"""One comparison is enough for any engine where two runs are nearer by this factor than they must be."""
LEAST_COMPARED: Final = 200
"""Instants at which two histories are compared at least, however coarse their output."""


@dataclass(frozen=True)
class Spread:
    """Difference of two runs: largest, rad, up to `until_s`, the last instant before it says that the target is missed.

    `clear_s` and `near_s` are the same for the target over `CLEAR` and for `CLEAR` times the target.
    `coarse_dt_s`, `fine_dt_s`: their steps. `apart_rad`: largest difference to the end, infinite where the ends differ.
    """

    largest_rad: float
    until_s: float
    whole: bool
    coarse_dt_s: float
    fine_dt_s: float
    apart_rad: float = math.inf
    clear_s: float = 0.0
    near_s: float = 0.0

    @property
    def stated_rad(self) -> float:
        """Uncertainty of the finer run that this difference shows, rad."""
        return factor(self.coarse_dt_s, self.fine_dt_s) * self.largest_rad

    @property
    def stated_to_the_end_rad(self) -> float:
        """The same from the largest difference to the end, though the target is missed before."""
        return factor(self.coarse_dt_s, self.fine_dt_s) * self.apart_rad


def factor(coarse_dt_s: float, fine_dt_s: float) -> float:
    """Stated uncertainty of a run over its largest difference from a run with a longer step."""
    return SAFETY / (max(coarse_dt_s / fine_dt_s, LEAST_RATIO) - 1.0)


def spread(coarse: Run, fine: Run, accuracy_rad: float) -> Spread:
    """How far two runs are apart, and until when the finer one is by that within `accuracy_rad`.

    Raises `ValueError` when a run has no history.
    """
    if coarse.history is None or fine.history is None:
        raise ValueError("both runs must have kept their histories")
    end_s = min(coarse.end_s, fine.end_s)
    times = _instants(coarse.history, fine.history, end_s)
    apart = np.abs(coarse.history.at(times) - fine.history.at(times))
    # An overturn that only one run sees, or at another time, is a difference once the other has ended.
    same_end = abs(coarse.end_s - fine.end_s) <= 2.0 * float(np.max(np.diff(fine.history.t_s), initial=0.0))
    steps = float(coarse.settings["dt_s"]), float(fine.settings["dt_s"])
    target_rad = accuracy_rad / factor(*steps)
    counts = [_within(apart, limit) for limit in (target_rad, target_rad / CLEAR, CLEAR * target_rad)]
    _, clear, near = (fine.end_s if count == apart.size else float(times[max(count - 1, 0)]) for count in counts)
    if counts[0] == apart.size and (same_end or coarse.outcome == fine.outcome):
        largest = float(np.max(apart))
        return Spread(largest, fine.end_s, True, *steps, apart_rad=largest, clear_s=clear, near_s=near)
    first = min(counts[0], apart.size - 1)
    until_s = float(times[max(first - 1, 0)])
    return Spread(
        float(np.max(apart[:first], initial=0.0)),
        until_s,
        False,
        *steps,
        apart_rad=float(np.max(apart)) if same_end else math.inf,
        clear_s=min(clear, until_s),
        near_s=near,
    )


def _within(apart_rad: Array, limit_rad: float) -> int:
    """Number of instants before the first at which two runs are further apart than the limit."""
    over = np.flatnonzero(apart_rad > limit_rad)
    return int(over[0]) if over.size else apart_rad.size


def _instants(a: History, b: History, end_s: float) -> Array:
    count = max(LEAST_COMPARED, min(a.t_s.size, b.t_s.size))
    return np.linspace(0.0, end_s, count, dtype=np.float64)
