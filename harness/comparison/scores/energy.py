"""The energy that each impact takes, from the angular velocities on both sides of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.comparison.scores.events import Excursions
from harness.model.history import Array
from harness.model.scene import Statue


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
    """Share of the rocking energy lost in each impact, shape (k,); NaN where the history ends before it.

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
