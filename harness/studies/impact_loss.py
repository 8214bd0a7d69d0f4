"""What an impact costs a rocking statue, from a history: the energy of its rotation about the corner, before and after."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.model.history import History

SETTLING_S: Final = 0.003
"""The contact engines' impacts take up to two steps of 1 ms: rates are read this long before and after, and drawn out."""

RESTS_RAD_S: Final = 5e-3
"""A statue slower than this does not strike: the contact engines' statues tremble about rest at some 1e-3 rad/s."""


def last_impact_s(history: History) -> float:
    """When the statue last struck its support: where θ changes its sign, faster than one that rests; 0 where it never did."""
    theta, rate = history.theta_rad, history.theta_rate_rad_s
    strikes = np.flatnonzero((theta[:-1] * theta[1:] < 0.0) & (np.abs(rate[:-1]) >= RESTS_RAD_S))
    return float(history.t_s[strikes[-1]]) if strikes.size else 0.0


def energy_lost_j(history: History, pivot_inertia_kg_m2: Mapping[int, float]) -> NDArray[np.float64]:
    """Energy lost in each impact (J): I_pivot θ̇²/2 before less that after, the inertia by the side turned to (docs/model.md).

    An impact is where θ changes its sign: the engines' own lists of impacts count contacts, and not at the same instant. Rates
    are drawn out to it in a straight line. Impacts nearer to another than four times `SETTLING_S` are chattering and left out.
    """
    t_s, theta, rate = history.t_s, history.theta_rad, history.theta_rate_rad_s
    if t_s.size < 3:
        return np.zeros(0)
    settling = max(1, round(SETTLING_S / float(t_s[1] - t_s[0])))
    crossing = np.flatnonzero(theta[:-1] * theta[1:] < 0.0)
    gaps = np.diff(crossing, prepend=0, append=t_s.size - 1)
    crossing = crossing[(gaps[:-1] >= 4 * settling) & (gaps[1:] >= 4 * settling)]
    crossing = crossing[np.abs(rate[crossing - settling]) >= RESTS_RAD_S]
    share = theta[crossing] / (theta[crossing] - theta[crossing + 1])
    impact_s = t_s[crossing] + share * (t_s[crossing + 1] - t_s[crossing])

    def energy(near: NDArray[np.int64], beyond: NDArray[np.int64]) -> NDArray[np.float64]:
        slope = (rate[near] - rate[beyond]) / (t_s[near] - t_s[beyond])
        at_impact = rate[near] + slope * (impact_s - t_s[near])
        inertia = np.where(theta[near] > 0.0, pivot_inertia_kg_m2[1], pivot_inertia_kg_m2[-1])
        return np.asarray(0.5 * inertia * at_impact**2)

    first, last = crossing - settling, crossing + 1 + settling
    return energy(first, first - 1) - energy(last, last + 1)
