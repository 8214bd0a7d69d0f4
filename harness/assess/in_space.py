"""The exact body in three dimensions on the draws of a scene that is shaken across its rocking plane, outcome only."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.excitation import ZeroExcitation
from harness.assess.inputs import Array, row
from harness.assess.stratified import LEVEL
from harness.assess.variation import file_scale, varied
from harness.comparison.statistics.distributions import wilson
from harness.model.scene import Scene
from harness.records.assess import Assessment

SPACE: Final = "spatial"
MOST_STEPS: Final = 100_000
"""Steps of all runs together after which no draws are begun: some four seconds of one core, and"""
RUN_STEPS: Final = 20_000
"""steps after which one run is given up: what stands or falls in a record of a minute takes a thousand at the median."""
RUN_COST: Final = 20
"""Steps for which one run is counted at least: what never leaves the floor costs the setting up alone."""
BATCH: Final = 16
"""Draws before the first look at the steps; later batches take at most a quarter of what is left."""


def shaken_across(scene: Scene) -> bool:
    """Whether the scene is shaken across the rocking plane, of which the planar model knows nothing."""
    return not isinstance(scene.base_excitation.y, ZeroExcitation)


def assess_in_space(scene: Scene, values: Mapping[str, Array], most_steps: int = MOST_STEPS) -> Assessment | None:
    """The probability of overturning over as many of the draws (n,) as the steps allow; None where the planar model knows all
    of the shaking, or the exact body does not know all of the scene (a pedestal, a wall, a prescribed impact, a moving table).
    """
    from analytic import AnalyticInputError

    beyond = scene.pedestal, scene.wall, scene.contact.restitution, scene.initial.pose
    if not shaken_across(scene) or any(item is not None for item in beyond) or scene.table == "moving":
        return None
    size, left, runs = len(next(iter(values.values()))), most_steps, 0
    fell = decided = 0
    batch = BATCH
    while runs < size and left > 0:
        try:
            outcomes, steps = _batch(scene, {key: column[runs : runs + batch] for key, column in values.items()})
        except AnalyticInputError:  # a base the exact body does not take
            return None
        runs, left = runs + outcomes.size, left - int(np.maximum(steps, RUN_COST).sum())
        batch = max(BATCH, left * runs // (4 * (most_steps - left)))
        fell += int((outcomes == "overturned").sum())
        decided += int(np.isin(outcomes, ("overturned", "stands")).sum())
    share = wilson(fell, runs, LEVEL)
    if share is None:
        return None
    return Assessment(share.value, share.low, share.high, LEVEL, runs, runs, 1.0 - decided / runs)


def _batch(scene: Scene, values: Mapping[str, Array]) -> tuple[NDArray[np.object_], NDArray[np.int64]]:
    """Outcome and steps of each draw."""
    from analytic import spatial
    from harness.engines.spatial import problem_of

    sweep = {}
    if "motion.scale" in values:
        sweep["scale"] = values["motion.scale"] / file_scale(scene)
    if "contact.statue" in values:
        sweep["friction"] = values["contact.statue"]
    if sweep and len(sweep) == len(values):
        swept = spatial.outcomes(problem_of(scene), sweep, most_steps=RUN_STEPS)
        return swept.outcomes, swept.steps
    size = len(next(iter(values.values())))
    each = [
        spatial.outcomes(problem_of(varied(scene, row(values, k))), {"scale": [1.0]}, most_steps=RUN_STEPS)
        for k in range(size)
    ]
    return np.concatenate([item.outcomes for item in each]), np.concatenate([item.steps for item in each])
