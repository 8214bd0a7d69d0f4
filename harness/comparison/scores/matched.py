"""Scores of events: matched uplifts and impacts, and what numerical errors change in them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from harness.comparison.scores import events
from harness.comparison.scores.events import Excursions
from harness.comparison.side import Side
from harness.model.history import Array
from harness.model.scene import Statue

ALWAYS: Final = (-math.inf, math.inf)


def event_scores(
    a: events.Excursions, b: events.Excursions, inertia: RockingInertia | None, common_s: tuple[float, float] = ALWAYS
) -> dict[str, Any]:
    """Matched uplifts and impacts of two histories, and the energy that each matched impact takes; pairs whose event in b, and
    events alone, come before or after the stretch `common_s` are left out."""
    rise_a, rise_b = a.from_rest, b.from_rest
    up_a, up_b = a.uplift_s[rise_a], b.uplift_s[rise_b]
    uplifts = events.match(up_a, a.side[rise_a], a.length_s[rise_a], up_b, b.side[rise_b], b.length_s[rise_b])
    uplifts = uplifts.within(up_a, up_b, *common_s)
    down_a, down_b = a.landed, b.landed
    times_a, times_b = a.impact_s[down_a], b.impact_s[down_b]
    # An impact is the same one when it is off by less than half the excursion that it ends.
    impacts = events.match(
        times_a, a.side[down_a], 0.5 * a.length_s[down_a], times_b, b.side[down_b], 0.5 * b.length_s[down_b]
    ).within(times_a, times_b, *common_s)
    index_a, index_b = np.flatnonzero(down_a)[impacts.index_a], np.flatnonzero(down_b)[impacts.index_b]
    share_a, share_b = share_lost(a, inertia)[index_a], share_lost(b, inertia)[index_b]
    return {
        "uplift_time_differences_s": _list(up_a[uplifts.index_a] - up_b[uplifts.index_b]),
        "uplifts_alone_a": uplifts.alone_a,
        "uplifts_alone_b": uplifts.alone_b,
        "impact_times_a_s": _list(times_a[impacts.index_a]),
        "impact_time_differences_s": _list(times_a[impacts.index_a] - times_b[impacts.index_b]),
        "impacts_alone_a": impacts.alone_a,
        "impacts_alone_b": impacts.alone_b,
        "impact_energy_share_lost_a": _list(share_a),
        "impact_energy_share_lost_b": _list(share_b),
        "impact_energy_lost_a_j": None if inertia is None else _list(lost_j(a, inertia)[index_a]),
        "impact_energy_lost_b_j": None if inertia is None else _list(lost_j(b, inertia)[index_b]),
    }


def numerical_uncertainty(
    sides: tuple[Side, Side],
    peak_b_rad: float,
    excursions: tuple[events.Excursions, events.Excursions],
    until_s: float = math.inf,
) -> dict[str, float | None]:
    """What the stated numerical errors can change in each score, while they hold; None where one is not stated.

    A rotation known to u moves a root mean square and a difference of peaks by at most u_a + u_b, an impact by u/|θ̇⁻|; a slip
    known to u moves its root mean square by as much.
    """
    u_a, u_b = sides[0].uncertainty_rad, sides[1].uncertainty_rad
    joint = None if u_a is None or u_b is None else u_a + u_b
    slips = sides[0].slip_uncertainty_m, sides[1].slip_uncertainty_m
    rates = [np.abs(each.rate_before_rad_s[each.landed & (each.impact_s <= until_s)]) for each in excursions]
    slowest = [float(np.nanmin(each)) if np.isfinite(each).any() else None for each in rates]
    times = [u / rate if u is not None and rate else None for u, rate in zip((u_a, u_b), slowest, strict=True)]
    return {
        "rms_theta_rad": joint,
        "largest_difference_rad": joint,
        "peak_theta_a_rad": u_a,
        "peak_theta_b_rad": u_b,
        "peak_ratio": joint / abs(peak_b_rad) if joint is not None and peak_b_rad else None,
        "rms_slip_m": None if slips[0] is None or slips[1] is None else slips[0] + slips[1],
        "impact_times_a_s": times[0],
        "impact_times_b_s": times[1],
    }


def _list(values: Array) -> tuple[float | None, ...]:
    return tuple(None if math.isnan(value) else value for value in values.tolist())


@dataclass(frozen=True)
class RockingInertia:
    """J_s about each corner, for the kinetic energy of rocking, ½ J_s θ̇² (docs/model.md, section 1)."""

    left_kg_m2: float
    right_kg_m2: float

    @classmethod
    def of(cls, statue: Statue) -> RockingInertia:
        """J_s = J_G + m (h² + b_s²) of a statue's two corners."""
        h, m, j = statue.centroid_height_m, statue.mass_kg, statue.inertia_kg_m2
        return cls(*(j + m * (h * h + b * b) for b in (statue.corner_left_m, statue.corner_right_m)))

    def about(self, side: NDArray[Any]) -> Array:
        """J of the corner on each side (+1 right, −1 left), shape of `side`."""
        return np.where(side > 0, self.right_kg_m2, self.left_kg_m2)


def share_lost(excursions: Excursions, inertia: RockingInertia | None) -> Array:
    """Share of the rocking energy lost in each impact, shape (k,); NaN where the history ends before it, or has too few
    samples to tell a rate before or after it.

    At θ = 0 both corners touch and the potential energy is the same, so the share is 1 − J_new θ̇⁺²/(J_old θ̇⁻²). Without
    inertias J_new = J_old is taken (a symmetric body). When the statue falls back on the corner that it came from, or
    rests, the new corner is the side of θ̇⁺.
    """
    before, after = excursions.rate_before_rad_s, excursions.rate_after_rad_s
    ratio = np.ones_like(before)
    if inertia is not None:
        ratio = inertia.about(np.sign(after)) / inertia.about(excursions.side)
    energy = before * before
    lost: Array = 1.0 - np.divide(ratio * after * after, energy, out=np.full_like(energy, np.nan), where=energy > 0.0)
    return lost


def lost_j(excursions: Excursions, inertia: RockingInertia) -> Array:
    """Energy in J that each impact takes from the rocking motion, shape (k,)."""
    before = 0.5 * inertia.about(excursions.side) * excursions.rate_before_rad_s**2
    taken: Array = share_lost(excursions, inertia) * before
    return taken
