"""The room a statue needs to both sides: how far its silhouette and its pedestal go, by the model on the draws."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np

from harness.assess.inputs import Array, row
from harness.assess.model_draws import SLOW_DRAWS, sweepable
from harness.assess.variation import varied
from harness.engines import analytic as twoblock
from harness.model.scene import Scene, Statue
from harness.records.assess import ClearanceRecord

CLEARANCE_DRAWS: Final = 1000
"""Draws run with their histories: the 95 % quantile then rests on 50 of them, the 99 % one on 10."""
STEP_S: Final = 0.01
"""Between two looks at the history: a swing of 3 Hz is then caught within (6π · 0.01)²/8 = 0.4 % of its peak."""
SHARES: Final = (0.50, 0.95, 0.99)
"""Of the draws that stand, this share stays within a clearance."""
LEAST_DRAWS: Final = 20
"""Standing draws below which no quantile is told."""


def clearance(scene: Scene, values: Mapping[str, Array]) -> ClearanceRecord:
    """Quantiles over the draws that stand of the room needed beyond the silhouette at rest, m: right, left; and of the slip."""
    from analytic import simulate

    size = min(CLEARANCE_DRAWS if sweepable(scene, values) else SLOW_DRAWS, len(next(iter(values.values()))))
    rooms = []
    for k in range(size):
        drawn = varied(scene, row(values, k))
        shaken = drawn.base_excitation
        keywords = {**twoblock.keywords(drawn), "dt_s": STEP_S}
        solution = simulate(twoblock.block_of(drawn), shaken.x, shaken.z, **keywords)  # type: ignore[arg-type]
        if not solution.outcome.startswith("overturned"):
            slips = (max(float(solution.slip_m.max()), 0.0), max(float(-solution.slip_m.min()), 0.0))
            rooms.append((*needed(drawn.statue, solution.theta_rad, solution.slip_m), *slips))
    if len(rooms) < LEAST_DRAWS:
        return ClearanceRecord(size, len(rooms), scene.statue.height_m, SHARES)
    right, left, slip_right, slip_left = (column.tolist() for column in np.quantile(np.array(rooms), SHARES, axis=0).T)
    return ClearanceRecord(size, len(rooms), scene.statue.height_m, SHARES, right, left, slip_right, slip_left)


def needed(statue: Statue, theta_rad: Array, slip_m: Array) -> tuple[float, float]:
    """Room right and left of the silhouette at rest, m, over a history of shape (n,): rotated about the outer corner, and slid.

    A base of more than two vertices rolls before it stands on its outer one; the difference is some millimetres of a rotation.
    """
    x, z = statue.section_m[:, 0], statue.section_m[:, 1]
    pivot = np.where(theta_rad >= 0.0, statue.corner_right_m, -statue.corner_left_m)[:, None]
    turn = theta_rad[:, None]
    places = pivot + (x - pivot) * np.cos(turn) + z * np.sin(turn) + slip_m[:, None]
    # At rest rounding may say less than nothing.
    return max(float(places.max() - x.max()), 0.0), max(float(x.min() - places.min()), 0.0)
