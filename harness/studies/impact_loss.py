"""What an impact costs a rocking statue, from a history: the energy of its rotation about the corner, before and after."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from harness.model.history import History


def energy_lost_j(
    history: History, impact_times_s: Sequence[float], pivot_inertia_kg_m2: Mapping[int, float]
) -> NDArray[np.float64]:
    """Energy lost in each impact (J): I_pivot θ̇²/2 before less that after, the inertia by the side turned to (docs/model.md).

    Rates are drawn out in a straight line from the two instants of the history on either side: an error of the order of its step
    squared. Impacts nearer to another than three steps lose nothing that could be told and are left out.
    """
    t_s, theta, rate = history.t_s, history.theta_rad, history.theta_rate_rad_s
    times = np.asarray(impact_times_s, dtype=np.float64)
    if t_s.size < 5 or not times.size:
        return np.zeros(0)
    near = 3.0 * float(t_s[1] - t_s[0])
    gaps = np.diff(times, prepend=t_s[0], append=t_s[-1])
    alone = times[(gaps[:-1] >= near) & (gaps[1:] >= near)]
    before, after = np.searchsorted(t_s, alone, "left") - 1, np.searchsorted(t_s, alone, "right")

    def energy(near: NDArray[np.int64], beyond: NDArray[np.int64]) -> NDArray[np.float64]:
        slope = (rate[near] - rate[beyond]) / (t_s[near] - t_s[beyond])
        at_impact = rate[near] + slope * (alone - t_s[near])
        inertia = np.where(theta[beyond] > 0.0, pivot_inertia_kg_m2[1], pivot_inertia_kg_m2[-1])
        return np.asarray(0.5 * inertia * at_impact**2)

    return energy(before, before - 1) - energy(after, after + 1)
