"""The exact body in three dimensions on the draws of a scene that is shaken across its rocking plane, outcome only."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.excitation import ZeroExcitation
from harness.engines import stands_alone
from harness.model.scene import Scene
from harness.questions.assess.model_draws import Array, ModelDraws, file_scale, row, varied

SPACE: Final = "spatial"
MOST_STEPS: Final = 300_000
"""Steps of all runs together after which no draws are begun: some"""
SPACE_S: Final = 3.0
"""seconds of one core, and"""
RUN_STEPS: Final = 20_000
"""steps after which one run is given up: what stands or falls in a record of a minute takes a thousand at the median."""
RUN_COST: Final = 20
"""Steps for which one run is counted at least: what never leaves the floor costs the setting up alone."""
BATCH: Final = 16
"""Draws before the first look at the steps; later batches take at most a quarter of what is left."""


def shaken_across(scene: Scene) -> bool:
    """Whether the scene is shaken across the rocking plane, of which the planar model knows nothing."""
    return not isinstance(scene.base_excitation.y, ZeroExcitation)


def space_draws(
    scene: Scene,
    values: Mapping[str, Array],
    most_steps: int = MOST_STEPS,
    change: Callable[[Scene], Scene] = lambda scene: scene,
) -> ModelDraws | None:
    """What the exact body says of as many of the draws (n,) as the steps allow, each drawn and then changed: how it ends alone.

    None where it does not know all of the scene (a pedestal, a wall, a prescribed impact, a moving table).
    """
    from analytic import AnalyticInputError

    changed = change(scene)
    if not stands_alone(changed) or changed.initial.pose is not None:
        return None
    size, left, runs = len(next(iter(values.values()))), most_steps, 0
    parts: list[NDArray[np.object_]] = []
    batch = BATCH
    while runs < size and left > 0:
        try:
            columns = {key: column[runs : runs + batch] for key, column in values.items()}
            outcomes, steps = _batch(scene, columns, change)
        except AnalyticInputError:  # a base the exact body does not take
            return None
        runs, left = runs + outcomes.size, left - int(np.maximum(steps, RUN_COST).sum())
        batch = max(BATCH, left * runs // (4 * (most_steps - left)))
        parts.append(outcomes)
    ends = np.concatenate(parts)
    fell, unknown = ends == "overturned", np.full(ends.size, np.nan)
    # A run that was given up, or left the exact body's domain, is not decided.
    return ModelDraws(fell | (ends == "stands"), fell, unknown, unknown, *np.zeros((2, ends.size), dtype=bool))


def _batch(
    scene: Scene, values: Mapping[str, Array], change: Callable[[Scene], Scene]
) -> tuple[NDArray[np.object_], NDArray[np.int64]]:
    """Outcome and steps of each draw."""
    from analytic import spatial
    from harness.engines.spatial import problem_of

    sweep = {}
    if "motion.scale" in values:
        sweep["scale"] = values["motion.scale"] / file_scale(scene)
    if "contact.statue" in values:
        sweep["friction"] = values["contact.statue"]
    if sweep and len(sweep) == len(values):
        swept = spatial.outcomes(problem_of(change(scene)), sweep, most_steps=RUN_STEPS)
        return swept.outcomes, swept.steps

    def alone(number: int) -> spatial.Outcomes:
        drawn = problem_of(change(varied(scene, row(values, number))))
        return spatial.outcomes(drawn, {"scale": [1.0]}, most_steps=RUN_STEPS, threads=1)

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        each = list(pool.map(alone, range(len(next(iter(values.values()))))))
    return np.concatenate([item.outcomes for item in each]), np.concatenate([item.steps for item in each])
