"""Which input matters, and how strong a shaking the statue bears: the analytic model on more draws."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.assess.inputs import draw, groups
from harness.assess.model_draws import model_draws
from harness.assess.variation import file_scale
from harness.model.scene import Scene, Uncertain
from harness.records.assess import FragilityRecord, Index

Array = NDArray[np.float64]

FACTORS: Final = tuple(float(value) for value in np.geomspace(0.25, 4.0, 25))
"""Factors on the motion at which the probability is found: a sixteenth part of the range from 1/4 to 4 apart, each 12 %."""
FRAGILITY_DRAWS: Final = 1000
"""Draws at each factor: ± 1.6 % at a half."""
INDEX_DRAWS: Final = 4000
"""Draws of each of the two matrices: a first index is known to about ± 0.03."""
ASKED: Final = (0.05, 0.16, 0.50)
"""Probabilities whose factor is told."""
OTHER_SEED: Final = 1_000_003
"""Added to the seed for the second matrix, so that the two are independent."""


def fragility(scene: Scene, inputs: Sequence[Uncertain], seed: int) -> FragilityRecord:
    """Probability of overturning by a factor on all axes together, and the factors at which it is 5, 16 and 50 %."""
    draws = draw(inputs, FRAGILITY_DRAWS, seed)
    own = draws.get("motion.scale", np.full(FRAGILITY_DRAWS, file_scale(scene)))
    probability = [model_draws(scene, {**draws, "motion.scale": own * factor}).probability for factor in FACTORS]
    return FragilityRecord(FACTORS, probability, FRAGILITY_DRAWS, factors_at(FACTORS, probability))


def factors_at(factors: Sequence[float], probability: Sequence[float]) -> dict[str, float | None]:
    """The factors at which the probability is 5, 16 and 50 %; None where it never is."""
    rising = np.maximum.accumulate(np.nan_to_num(probability))
    return {f"{asked:.2f}": _crossing(factors, rising, asked) for asked in ASKED}


def _crossing(factors: Sequence[float], rising: Array, asked: float) -> float | None:
    """The factor at which a rising curve first reaches a probability, on a logarithmic axis; None where it never does."""
    over = np.flatnonzero(rising >= asked)
    if over.size == 0:
        return None
    k = int(over[0])
    if k == 0:
        return float(factors[0])
    share = (asked - rising[k - 1]) / (rising[k] - rising[k - 1])
    return float(np.exp(np.log(factors[k - 1]) + share * np.log(factors[k] / factors[k - 1])))


def indices(scene: Scene, inputs: Sequence[Uncertain], seed: int) -> dict[str, Index]:
    """First and total variance-based index of every input for whether the statue overturns (Saltelli 2010, Jansen 1999).

    Inputs that correlate have one index together: only groups that are independent divide the variance.
    The first is the share of the variance that goes when this input is known; the total the share that stays when all others are.
    """
    a, b = draw(inputs, INDEX_DRAWS, seed), draw(inputs, INDEX_DRAWS, seed + OTHER_SEED)
    fell_a, fell_b = _fell(scene, a), _fell(scene, b)
    variance = float(np.var(np.concatenate([fell_a, fell_b])))
    if variance == 0.0:
        return {}
    result = {}
    for group in groups(inputs):
        fell = _fell(scene, {**a, **{key: b[key] for key in group}})
        first = 1.0 - float(np.mean((fell_b - fell) ** 2)) / (2.0 * variance)
        total = float(np.mean((fell_a - fell) ** 2)) / (2.0 * variance)
        result[" with ".join(group)] = Index(first, total)
    return result


def _fell(scene: Scene, draws: Mapping[str, Array]) -> Array:
    return model_draws(scene, draws).overturned.astype(np.float64)
