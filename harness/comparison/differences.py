"""By how much, and from when, two answers differ in rotation and slip: what a verdict decides on."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from harness.comparison.scores.pointwise import Peak
from harness.model.history import Array
from harness.model.history_pair import Pair, first_beyond_s

ROUNDING: Final = 1e-12
"""Differences below this, rad or m, are rounding of numbers of order one through some thousand operations."""


@dataclass(frozen=True)
class Difference:
    """Of one quantity: the limit, when it is first exceeded, the largest difference, and the largest before the horizon."""

    limit: float
    exceeded_s: float | None = None
    largest: float = 0.0
    largest_reliable: float = 0.0


@dataclass(frozen=True)
class Facts:
    """What decides: the differences of rotation, rad, and slip, m, the horizon and the end of what was compared.

    `fallen_s`: when a fall across the plane parts the two, which the planar rotation does not tell.
    """

    rotation: Difference
    slip: Difference
    until_s: float
    end_s: float
    fallen_s: float | None = None

    @property
    def exceeded_s(self) -> float | None:
        """When the two answers part: the first of both quantities exceeds its limit, or one falls across the plane."""
        known = [t for t in (self.rotation.exceeded_s, self.slip.exceeded_s, self.fallen_s) if t is not None]
        return min(known, default=None)

    @property
    def differs_in(self) -> Literal["", "rotation", "slip"]:
        """In what they then differ; empty: in nothing."""
        if self.exceeded_s is None:
            return ""
        return "slip" if self.slip.exceeded_s == self.exceeded_s != self.rotation.exceeded_s else "rotation"


def from_histories(both: Pair, turned_rad: float, slid_m: float, until: float) -> Facts:
    """From both histories on one grid; `turned_rad` and `slid_m` are the limits, `until` the horizon, s."""

    def of(apart: Array, limit: float) -> Difference:
        inside = both.t_s <= until
        reliable = float(np.max(apart[inside])) if inside.any() else 0.0
        return Difference(limit, first_beyond_s(both.t_s, apart, limit), float(np.max(apart)), reliable)

    rotation = of(np.abs(both.difference_rad), turned_rad)
    return Facts(rotation, of(np.abs(both.slip_a_m - both.slip_b_m), slid_m), until, both.end_s)


def from_peaks(peaks: tuple[Peak, Peak], turned_rad: float, slid_m: float, until: float) -> Facts:
    """When a larger peak is reached the other rotation is at most its own peak: by then the two are that far apart."""
    # A run without a history may state its peak without a sign.
    smaller, larger = sorted(peaks, key=lambda peak: abs(peak.theta_rad))
    apart = abs(larger.theta_rad) - abs(smaller.theta_rad)
    exceeded = larger.time_s if apart > turned_rad else None
    rotation = Difference(turned_rad, exceeded, apart, apart if larger.time_s <= until else 0.0)
    return Facts(rotation, Difference(slid_m), until, math.inf)
