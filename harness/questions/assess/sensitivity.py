"""Which input matters, and how strong a shaking the statue bears: one model on more draws."""

import math
from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.comparison.statistics import wilson
from harness.model import Scene, Uncertain
from harness.questions.assess.model_draws import (
    SPACE,
    Array,
    Flags,
    ModelDraws,
    draw,
    file_scale,
    groups,
    model_draws,
    row,
    space_draws,
    sweepable,
    varied,
)
from harness.questions.assess.probability import LEVEL
from harness.records.assess import FragilityRecord, Index

FACTORS: Final = tuple(float(value) for value in np.geomspace(0.25, 4.0, 25))
"""Factors on the motion at which the probability is found: a sixteenth part of the range from 1/4 to 4 apart, each 12 %."""
FRAGILITY_DRAWS: Final = 1000
"""Draws at each factor: ± 1.6 % at a half."""
SPACE_DRAWS: Final = 64
"""Draws at each factor in space: ± 10 % at a half."""
SPACE_STEPS: Final = 80_000
"""Steps of the runs in space at one factor together: some three seconds of one core."""
INDEX_DRAWS: Final = 4000
"""Draws of each of the two matrices: a first index is known to about ± 0.03."""
ASKED: Final = (0.05, 0.16, 0.50)
"""Probabilities whose factor is told."""
LEAST_DRAWS: Final = 100
"""Fewer draws tell a first index to ± 0.2 at best."""
RANK_WIDTH: Final = 2.0
"""Half width at 90 % of an index by ranks, over 1/√n: the spread is 1.2/√n at the most where a sum of two normal inputs decides,
whatever their shares, and 100 to 1000 draws are made."""
NORMAL_90: Final = 1.645
NEIGHBOUR_WIDTH: Final = 1.4 * NORMAL_90
"""Half width at 90 % of a total index by neighbours, over that of n independent pairs: most draws stand in two pairs."""
MOST_OTHERS: Final = 3
"""Inputs in which neighbours are sought: 300 draws lie so far apart in three that a total gains up to 0.05, in five 0.19."""
OTHER_SEED: Final = 1_000_003
"""Added to the seed for the second matrix, so that the two are independent."""


def fragility(scene: Scene, inputs: Sequence[Uncertain], seed: int, count: int = FRAGILITY_DRAWS) -> FragilityRecord:
    """Probability of overturning by a factor on all axes together, and the factors at which it is 5, 16 and 50 %.

    Where a draw needs the scene read again, it is read once for all factors.
    """
    draws = draw(inputs, count, seed)
    own = draws.pop("motion.scale", np.full(count, file_scale(scene)))
    if sweepable(scene, draws):
        return fragility_of(FACTORS, [model_draws(scene, {**draws, "motion.scale": own * each}) for each in FACTORS])
    by_draw = [
        model_draws(varied(scene, row(draws, k)), {"motion.scale": own[k] * np.array(FACTORS)}) for k in range(count)
    ]
    by_factor = [np.transpose(column) for column in zip(*by_draw, strict=True)]
    return fragility_of(FACTORS, [ModelDraws(*(column[k] for column in by_factor)) for k in range(len(FACTORS))])


def fragility_in_space(scene: Scene, inputs: Sequence[Uncertain], seed: int) -> FragilityRecord | None:
    """The same by the exact body, at every second factor; None for a scene that it does not know."""
    draws, factors, answers = draw(inputs, SPACE_DRAWS, seed), FACTORS[::2], []
    own = draws.get("motion.scale", np.full(SPACE_DRAWS, file_scale(scene)))
    for factor in factors:
        found = space_draws(scene, {**draws, "motion.scale": own * factor}, SPACE_STEPS)
        if found is None:
            return None
        answers.append(found)
    return fragility_of(factors, answers, SPACE)


def fragility_of(factors: Sequence[float], answers: Sequence[ModelDraws], model: str = "analytic") -> FragilityRecord:
    """The fragility by what a model says of the draws at each factor."""
    counts = [(int(each.overturned.sum()), int((~each.decided).sum()), each.decided.size) for each in answers]
    falls = [fell / size for fell, _, size in counts]
    none = [wilson(fell, size, LEVEL) for fell, _, size in counts]
    every = [wilson(fell + undecided, size, LEVEL) for fell, undecided, size in counts]
    low, high = [item.low for item in none if item], [item.high for item in every if item]
    undecided_share = [undecided / size for _, undecided, size in counts]
    factor_at, soonest_at, latest_at = (factors_at(factors, curve) for curve in (falls, high, low))
    size = min(size for *_, size in counts)
    return FragilityRecord(factors, falls, size, factor_at, model, low, high, undecided_share, soonest_at, latest_at)


def factors_at(factors: Sequence[float], probability: Sequence[float]) -> dict[str, float | None]:
    """The factors at which the probability first reaches 5, 16 and 50 %; None where it never does."""
    rising = np.maximum.accumulate(np.nan_to_num(probability)).tolist()
    return {f"{asked:.2f}": crossing(rising, math.nextafter(asked, 0.0), factors) for asked in ASKED}


def crossing(heights: Sequence[float], level: float, at: Sequence[float]) -> float | None:
    """Where a value is first above a level, between two points in proportion on a logarithmic scale (halfway to no number)."""
    above = next((j for j, height in enumerate(heights) if height > level), None)
    if above is None or above == 0:
        return None if above is None else at[0]
    low, high = heights[above - 1], heights[above]
    share = (level - low) / (high - low) if math.isfinite(high) else 0.5
    return float(at[above - 1] * (at[above] / at[above - 1]) ** share)


def indices(scene: Scene, inputs: Sequence[Uncertain], seed: int) -> dict[str, Index]:
    """First and total variance-based index of every input for whether the statue overturns (Saltelli 2010, Jansen 1999).

    Inputs that correlate have one index together: only groups that are independent divide the variance.
    The first is the share of the variance that goes when this input is known; the total the share that stays when all others are.
    """
    a, b = draw(inputs, INDEX_DRAWS, seed), draw(inputs, INDEX_DRAWS, seed + OTHER_SEED)
    fell_a, fell_b = (model_draws(scene, draws).overturned for draws in (a, b))
    variance = float(np.var(np.concatenate([fell_a, fell_b])))
    if variance == 0.0:
        return {}
    result = {}
    for group in groups(inputs):
        fell = model_draws(scene, {**a, **{key: b[key] for key in group}}).overturned
        unlike = [float(np.mean(other != fell)) for other in (fell_b, fell_a)]
        half_width = max(NORMAL_90 * math.sqrt(share * (1.0 - share) / fell.size) for share in unlike) / (
            2.0 * variance
        )
        first, total = 1.0 - unlike[0] / (2.0 * variance), unlike[1] / (2.0 * variance)
        result[" with ".join(group)] = Index(first, half_width, total)
    return result


def indices_of_draws(inputs: Sequence[Uncertain], values: Mapping[str, Array], fell: Flags) -> dict[str, Index]:
    """First and total index of every input that depends on no other, from outcomes (n,) of the first draws alone.

    First: draws are put in the order of the input and each is held against the next (Gamboa, Gremaud, Klein and Lagnoux 2022).
    Total: each is held against the nearest in all other inputs by rank (Broto, Bachoc and Depecker 2020); None beside more than
    `MOST_OTHERS` of these. Empty where draws are too few or end alike.
    """
    size = fell.size
    if size < LEAST_DRAWS or (variance := float(np.var(fell))) == 0.0:
        return {}
    result = {}
    for key in (group[0] for group in groups(inputs) if len(group) == 1):
        ordered = fell[np.argsort(values[key][:size])].astype(np.float64)
        first = (float(np.mean(ordered * np.roll(ordered, -1))) - float(ordered.mean()) ** 2) / variance
        others = [column[:size] for other, column in values.items() if other != key]
        half_width, total = RANK_WIDTH / math.sqrt(size), None
        if 1 <= len(others) <= MOST_OTHERS:
            unlike = float(np.mean(fell != fell[_nearest(others)]))
            total = unlike / (2.0 * variance)
            spread = NEIGHBOUR_WIDTH * math.sqrt(unlike * (1.0 - unlike) / size) / (2.0 * variance)
            half_width = max(half_width, spread)
        result[key] = Index(first, half_width, total)
    return result


def _nearest(columns: Sequence[Array]) -> NDArray[np.int64]:
    """For each draw (n,) the one that is nearest in these columns, each by rank."""
    from scipy.spatial import KDTree

    ranks = np.column_stack([np.argsort(np.argsort(column)) for column in columns]).astype(np.float64)
    return np.asarray(KDTree(ranks).query(ranks, k=[2])[1])[:, 0]
