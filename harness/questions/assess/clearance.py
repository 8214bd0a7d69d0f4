"""The room a statue needs: how far outline, top and pedestal go on a floor plan, over the draws that stand, by each model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from harness.engines import analytic as twoblock
from harness.model.scene import Scene
from harness.questions.assess.model_draws import SLOW_DRAWS, Array, ModelDraws, row, sweepable, varied
from harness.questions.assess.plan import AROUND_DEG, PARTS, PLANAR_DEG, reach_m
from harness.questions.assess.stratified import strata_of
from harness.records.assess import ClearanceByModel

if TYPE_CHECKING:  # a run of the model alone has no campaign
    from harness.questions.assess.engine_runs import EngineRuns

CLEARANCE_DRAWS: Final = 1000
"""Draws run with their histories: the 95 % quantile then rests on 50 of them, the 99 % one on 10."""
STEP_S: Final = 0.01
"""Between two looks at the history: a rotation of 3 Hz is then caught within (6π · 0.01)²/8 = 0.4 % of its peak."""
SHARES: Final = (0.50, 0.95, 0.99)
"""Of the draws that stand, this share stays within a clearance; told where at least one draw lies beyond."""
LEAST_DRAWS: Final = 20
"""Fewer standing draws have no 95 % quantile: none is told then."""


def of_model(scene: Scene, values: Mapping[str, Array]) -> ClearanceByModel:
    """The clearance right and left by the analytic model, on the first draws."""
    from analytic import Outcome, simulate

    size = min(CLEARANCE_DRAWS if sweepable(scene, values) else SLOW_DRAWS, len(next(iter(values.values()))))
    reached, undecided = [], 0
    for k in range(size):
        drawn = varied(scene, row(values, k))
        shaken = drawn.base_excitation
        keywords = {**twoblock.keywords(drawn), "dt_s": STEP_S}
        solution = simulate(twoblock.block_of(drawn), shaken.x, shaken.z, **keywords)  # type: ignore[arg-type]
        if solution.outcome == Outcome.STANDS:
            reached.append(reach_m(drawn, solution.theta_rad, solution.slip_m, {}))
        elif not solution.outcome.startswith("overturned"):
            undecided += 1
    return clearance(reached, np.ones(len(reached)), size, undecided)


def of_engine(model: ModelDraws, runs: EngineRuns) -> ClearanceByModel:
    """The clearance by the runs of an engine: each stands for its share of the stratum that it was drawn from."""
    strata, standing = strata_of(model), list(runs.reach_m)
    decided = strata[[number for number, fell in runs.fell.items() if fell is not None]]
    each = np.bincount(strata, minlength=3) / np.maximum(np.bincount(decided, minlength=3), 1)
    undecided = sum(fell is None for fell in runs.fell.values())
    return clearance([runs.reach_m[number] for number in standing], each[strata[standing]], len(runs.fell), undecided)


def clearance(reached: Sequence[Array], weights: Array, draws: int, undecided: int = 0) -> ClearanceByModel:
    """Quantiles of reaches (parts, directions), one for each draw that stands; `weights` (n,) are what each counts for."""
    count = len(reached)
    if count < LEAST_DRAWS:
        return ClearanceByModel(draws, count, undecided=undecided)
    every = np.array(reached)
    shares = [share for share in SHARES if (1.0 - share) * count > 1.0 - 1e-9]
    # Each direction has an order of its own: the smallest reach that this share of the weight does not exceed.
    order = np.argsort(every, axis=0)
    below = np.cumsum(weights[order], axis=0) / weights.sum()
    sorted_m = np.take_along_axis(every, order, axis=0)
    at = [np.argmax(below >= share - 1e-12, axis=0)[None] for share in shares]
    tables = [np.take_along_axis(sorted_m, index, axis=0)[0] for index in at]
    columns = {f"{part}_m": [table[k].tolist() for table in tables] for k, part in enumerate(PARTS)}
    known_deg = AROUND_DEG if every.shape[2] > len(PLANAR_DEG) else PLANAR_DEG
    return ClearanceByModel(draws, count, known_deg, shares, **columns, undecided=undecided)
