"""How far two runs of one engine are apart in rotation and slip, and what that says of the finer one."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from harness.model import Array, Run, Scene, number

SAFETY: Final = 3.0
"""Stated uncertainty over the error that a spread shows: what the grid convergence index takes for two grids (Roache, 1994);
docs/measured/random_scenes.md says how often it was enough."""
LEAST_RATIO: Final = 1.5
"""Two steps that are nearer to each other than this say no more of the error than two that are so far apart."""
PLAIN_ORDER: Final = 0.5
"""Order at which errors are taken to fall where events are not located: on tipping pedestals that of order 1 was missed by one
statement in nine, most by less than a factor of 2.5, which is what this order makes of two steps of the ratio 2.2."""
CLEAR: Final = 4.0
"""One comparison is enough for any engine where two runs are nearer by this factor than they must be."""
LEAST_COMPARED: Final = 200
"""Instants at which two histories are compared at least, however coarse their output."""


@dataclass(frozen=True)
class Error:
    """Error of a run, or a target for it: of the rotation, rad, and of the pedestal's slip, m."""

    rotation_rad: float
    slip_m: float

    def times(self, factor: float) -> Error:
        """Both multiplied by a factor."""
        return Error(factor * self.rotation_rad, factor * self.slip_m)

    def share_of(self, target: Error) -> float:
        """The larger of the two, each as a share of its target."""
        return max(self.rotation_rad / target.rotation_rad, self.slip_m / target.slip_m)

    def or_more(self, *others: Error) -> Error:
        """The largest rotation and the largest slip among this and others."""
        items = (self, *others)
        return Error(max(item.rotation_rad for item in items), max(item.slip_m for item in items))


NONE: Final = Error(0.0, 0.0)


def target_of(scene: Scene, accuracy_rad: float) -> Error:
    """The target of both for a target of the rotation, rad: the slip is asked to the accuracy times the centroid's height h.

    An error of the rotation moves the centroid by h times it, an error of the slip by itself: so neither counts for more. Without
    friction on the floor, M du + m h dθ = 0, an error of the rotation makes one of the slip, of at most h times it.
    """
    return Error(accuracy_rad, accuracy_rad * scene.statue.centroid_height_m)


@dataclass(frozen=True)
class Spread:
    """Difference of two runs: largest up to `until_s`, the last instant before it says that the target is missed.

    Where events are not located, differences count `plain_share` times.
    `clear_s` is the same for the target over `CLEAR`.
    `coarse_dt_s`, `fine_dt_s`: their steps. `apart`: largest difference to the end, infinite where the ends differ.
    """

    largest: Error
    until_s: float
    whole: bool
    coarse_dt_s: float
    fine_dt_s: float
    apart: Error = Error(math.inf, math.inf)
    clear_s: float = 0.0

    @property
    def stated(self) -> Error:
        """Uncertainty of the finer run that this difference shows."""
        return self.largest.times(factor(self.coarse_dt_s, self.fine_dt_s))

    @property
    def stated_to_the_end(self) -> Error:
        """The same from the largest difference to the end, though the target is missed before."""
        return self.apart.times(factor(self.coarse_dt_s, self.fine_dt_s))


def factor(coarse_dt_s: float, fine_dt_s: float) -> float:
    """Stated uncertainty of a run over its largest difference from a run with a longer step."""
    return SAFETY / (max(coarse_dt_s / fine_dt_s, LEAST_RATIO) - 1.0)


def plain_from_s(run: Run) -> float:
    """When a run left what its events are located for, infinite: it never did."""
    return number(run.validity, "plain_from_s", math.inf)


def plain_share(coarse_dt_s: float, fine_dt_s: float) -> float:
    """By how much more two runs' difference counts where it falls with `PLAIN_ORDER` only."""
    ratio = max(coarse_dt_s / fine_dt_s, LEAST_RATIO)
    return float((ratio - 1.0) / (ratio**PLAIN_ORDER - 1.0))


def spread(coarse: Run, fine: Run, target: Error, limit: Error | None = None) -> Spread:
    """How far two runs are apart, and until when the finer one is by that within `target`.

    `limit`: the difference that just meets the target, where the two differ by more than their steps.
    Raises `ValueError` when a run has no history.
    """
    if coarse.history is None or fine.history is None:
        raise ValueError("both runs must have kept their histories")
    end_s = min(coarse.end_s, fine.end_s)
    count = max(LEAST_COMPARED, min(coarse.history.t_s.size, fine.history.t_s.size))
    times = np.linspace(0.0, end_s, count, dtype=np.float64)
    turned = np.abs(coarse.history.at(times) - fine.history.at(times))
    slid = np.abs(coarse.history.slip_at(times) - fine.history.slip_at(times))
    # An overturn that only one run sees, or at another time, is a difference once the other has ended.
    same_end = abs(coarse.end_s - fine.end_s) <= 2.0 * float(np.max(np.diff(fine.history.t_s), initial=0.0))
    steps = number(coarse.settings, "dt_s"), number(fine.settings, "dt_s")
    plain = np.where(times > min(plain_from_s(coarse), plain_from_s(fine)), plain_share(*steps), 1.0)
    turned, slid = plain * turned, plain * slid
    limit = limit or target.times(1.0 / factor(*steps))
    share = np.maximum(turned / limit.rotation_rad, slid / limit.slip_m)
    # How many instants come before the first at which they are further apart than that.
    met, clear = (int(np.argmax(np.append(share > most, True))) for most in (1.0, 1.0 / CLEAR))
    whole = met == share.size and (same_end or coarse.outcome == fine.outcome)
    within = share.size if whole else min(met, share.size - 1)
    until_s = fine.end_s if whole else float(times[max(within - 1, 0)])
    return Spread(
        _largest(turned[:within], slid[:within]),
        until_s,
        whole,
        *steps,
        apart=_largest(turned, slid) if whole or same_end else Error(math.inf, math.inf),
        clear_s=until_s if clear == share.size else min(float(times[max(clear - 1, 0)]), until_s),
    )


def _largest(turned_rad: Array, slid_m: Array) -> Error:
    return Error(float(np.max(turned_rad, initial=0.0)), float(np.max(slid_m, initial=0.0)))
