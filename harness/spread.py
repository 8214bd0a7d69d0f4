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
"""Stated uncertainty over the error that two runs show, if errors fell in proportion to the step: what the grid convergence index
takes for two grids (Roache, 1994); docs/pymunk.md, "A target accuracy", says how often it was enough."""
SAFETY_ORDERED: Final = 2.0
"""The same where a third run shows the order at which errors fall. The index takes 1.25 for three grids; errors of contact fall
less evenly than a field's."""
LEAST_ORDER, MOST_ORDER = 1.0, 2.0
"""Orders that three runs are taken to show: below the least they show none."""
ALIKE: Final = 0.8
"""Correlation in time of two differences above which they are of one shape."""
ORDERS: Final = 21
"""Orders between these at which the ratio of two differences is tabled."""
LEAST_RATIO: Final = 1.5
"""Two steps that are nearer to each other than this say no more of the error than two that are so far apart."""
CLEAR: Final = 4.0
"""One comparison is enough for any engine where two runs are nearer by this factor than they must be."""
LEAST_COMPARED: Final = 200
"""Instants at which two histories are compared at least, however coarse their output."""


@dataclass(frozen=True)
class Spread:
    """Difference of two runs, and the uncertainty of the finer one that it shows, rad: up to `until_s`, the last instant before
    that exceeds the target (`largest_rad`, `stated_rad`), and to the end (`apart_rad`, `stated_to_the_end_rad`).

    `whole`: the target is met to the end. `clear_s` and `near_s` are as `until_s`, for the target over `CLEAR` and for `CLEAR`
    times the target. `coarse_dt_s`, `fine_dt_s`: the runs' steps. What holds to the end is infinite where the ends differ.
    """

    largest_rad: float
    until_s: float
    whole: bool
    coarse_dt_s: float
    fine_dt_s: float
    apart_rad: float = math.inf
    stated_rad: float = math.inf
    stated_to_the_end_rad: float = math.inf
    clear_s: float = 0.0
    near_s: float = 0.0


def factor(coarse_dt_s: float, fine_dt_s: float) -> float:
    """Stated uncertainty of a run over its largest difference from a run with a longer step, the order being unknown."""
    return SAFETY / (max(coarse_dt_s / fine_dt_s, LEAST_RATIO) - 1.0)


def spread(coarse: Run, fine: Run, accuracy_rad: float, before: Run | None = None) -> Spread:
    """How far two runs are apart, and until when the finer one is by that within `accuracy_rad`.

    `before`: a run with a longer step than either; how far it is from `coarse` shows the order at which errors fall. Raises
    `ValueError` when a run has no history.
    """
    if coarse.history is None or fine.history is None:
        raise ValueError("both runs must have kept their histories")
    end_s = min(coarse.end_s, fine.end_s)
    times = _instants(coarse.history, fine.history, end_s)
    differs = coarse.history.at(times) - fine.history.at(times)
    apart = np.maximum.accumulate(np.abs(differs))
    steps = float(coarse.settings["dt_s"]), float(fine.settings["dt_s"])
    stated = factor(*steps) * apart
    if before is not None and before.history is not None and before.settings["dt_s"] > steps[0] > steps[1]:
        told = times <= min(before.end_s, coarse.end_s)
        differed = before.history.at(times[told]) - coarse.history.at(times[told])
        ordered = _ordered(differed, differs[told], (float(before.settings["dt_s"]), *steps))
        stated[told] = np.fmin(stated[told], ordered)
        stated = np.maximum.accumulate(stated)
    # An overturn that only one run sees, or at another time, is a difference once the other has ended.
    same_end = abs(coarse.end_s - fine.end_s) <= 2.0 * float(np.max(np.diff(fine.history.t_s), initial=0.0))
    counts = [_within(stated, limit * accuracy_rad) for limit in (1.0, 1.0 / CLEAR, CLEAR)]
    _, clear, near = (fine.end_s if count == apart.size else float(times[max(count - 1, 0)]) for count in counts)
    whole = counts[0] == apart.size and (same_end or coarse.outcome == fine.outcome)
    last = apart.size - 1 if whole else max(min(counts[0], apart.size - 1) - 1, 0)
    until_s = fine.end_s if whole else float(times[last])
    to_the_end = whole or same_end
    return Spread(
        float(apart[last]),
        until_s,
        whole,
        *steps,
        apart_rad=float(apart[-1]) if to_the_end else math.inf,
        stated_rad=float(stated[last]),
        stated_to_the_end_rad=float(stated[-1]) if to_the_end else math.inf,
        clear_s=min(clear, until_s),
        near_s=near,
    )


def _ordered(earlier_rad: Array, later_rad: Array, steps_s: tuple[float, float, float]) -> Array:
    """Uncertainty that two signed differences in a row show up to each instant, rad; infinite where they show no order.

    Errors C(t) hᵖ make the differences C (h₀ᵖ − h₁ᵖ) and C (h₁ᵖ − h₂ᵖ): alike in shape, and their ratio grows with p.
    """
    longest, middle, shortest = steps_s
    orders = np.linspace(LEAST_ORDER, MOST_ORDER, ORDERS)
    fallen = (longest**orders - middle**orders) / (middle**orders - shortest**orders)
    least = np.finfo(np.float64).tiny
    earlier, later = (np.maximum.accumulate(np.abs(item)) for item in (earlier_rad, later_rad))
    ratio = earlier / np.maximum(later, least)
    common, own, other = (
        np.cumsum(a * b) for a, b in ((earlier_rad, later_rad), (earlier_rad, earlier_rad), (later_rad, later_rad))
    )
    alike = common >= ALIKE * np.sqrt(own * other)
    factors = SAFETY_ORDERED / ((middle / shortest) ** np.interp(ratio, fallen, orders) - 1.0)
    found: Array = np.where(alike & (ratio >= fallen[0]), factors * later, math.inf)
    return found


def _within(stated_rad: Array, limit_rad: float) -> int:
    """Number of instants before the first at which more than the limit is stated."""
    return int(np.searchsorted(stated_rad, limit_rad, side="right"))


def _instants(a: History, b: History, end_s: float) -> Array:
    count = max(LEAST_COMPARED, min(a.t_s.size, b.t_s.size))
    return np.linspace(0.0, end_s, count, dtype=np.float64)
