"""Do the intervals of contact engines cover as often as they say? Invented populations, then the engines' own thousand runs.

`python -m tests.measures.interval_coverage` makes a thousand estimates of each with other seeds, as `rockcheck assess` makes
them, and renews the table of docs/measured/interval_coverage.md. The rule of the interval was chosen by the invented ones alone.
"""

import itertools
from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from harness.questions.assess.probability import ModelDraws, draw, estimate, model_draws, uncertain_inputs
from harness.records.assess import Assessment
from tests.harness.questions.assess.measure_own_runs import ENGINES, RUNS, SEED, own_runs, scene_of_runs
from tests.measures.pages import renew, table

MODULE: Final = "tests.measures.interval_coverage"
CORRELATIONS: Final = (0.3, 0.6, 0.8, 0.9, 0.99)
"""Of the outcomes of model and engine: between two neighbours of these lies one class of invented populations."""
OF_CLASS: Final = 12
SIZE: Final = 4000
"""Draws of an invented population."""
ESTIMATES: Final = 1000
"""With other seeds: their share that covers has a standard error of 0.9 %."""
TRUTH: Final = (0.02, 0.98)
"""The probability of falling of an invented engine lies between these."""


class Population(NamedTuple):
    """What the model says of each draw (n,), and whether the engine's statue falls in it (n,)."""

    model: ModelDraws
    fell: NDArray[np.bool_]

    @property
    def correlation(self) -> float:
        """Of the two outcomes."""
        return float(np.corrcoef(self.model.overturned, self.fell)[0, 1])

    def estimated(self, seed: int, size: int = SIZE) -> Assessment:
        """One estimate from draws of its own, taken with replacement: the population's share is the truth of all."""
        chosen = np.random.default_rng(seed).integers(0, self.fell.size, size)
        drawn = ModelDraws(*(column[chosen] for column in self.model))

        def run(numbers: Sequence[int]) -> list[bool | None]:
            return [bool(self.fell[chosen[k]]) for k in numbers]

        return estimate(drawn, run, half_width=0.05, most_runs=400)


def invented(random: np.random.Generator) -> Population:
    """A model of which an unknown part is wrong, most where it is near the boundary and least where it is far from falling."""
    falls = random.uniform(*TRUTH)
    near = (1.0 - falls) * random.uniform(0.02, 0.6)
    wrong = 10.0 ** random.uniform(-2.5, -0.2)
    shares = [
        wrong * random.uniform(0.0, 0.5),
        min(wrong * random.uniform(0.5, 3.0), 0.9),
        1.0 - wrong * random.uniform(0.1, 1.0),
    ]
    stratum = random.choice(3, SIZE, p=[1.0 - falls - near, near, falls])
    overturned = stratum == 2
    model = ModelDraws(
        np.ones_like(overturned),
        overturned,
        np.array([0.2, 0.9, 17.0])[stratum],
        np.zeros(SIZE),
        *np.zeros((2, SIZE), dtype=bool),
    )
    return Population(model, random.random(SIZE) < np.array(shares)[stratum])


def populations(low: float, high: float) -> Iterator[Population]:
    """Invented populations without end whose correlation lies between two numbers."""
    random = np.random.default_rng([int(100 * low), int(100 * high)])
    while True:
        item = invented(random)
        if TRUTH[0] <= item.fell.mean() <= TRUTH[1] and low <= item.correlation < high:
            yield item


def thousand(name: str) -> Population:
    """An engine's own thousand runs on the shipped pedestal scene, and what the model says of the same draws."""
    scene = scene_of_runs()
    model = model_draws(scene, draw(uncertain_inputs(scene), RUNS, SEED))
    return Population(model, np.array([mark == "1" for mark in own_runs()[name]]))


def coverage(item: Population, estimates: int, size: int = SIZE) -> tuple[float, float]:
    """The share of estimates whose interval holds the population's share, and their mean runs."""
    truth = item.fell.mean()
    answers = [item.estimated(seed, size) for seed in range(estimates)]
    return float(np.mean([each.low <= truth <= each.high for each in answers])), float(
        np.mean([each.engine_runs for each in answers])
    )


def line(what: str, items: Sequence[Population]) -> list[str]:
    """One row of the table."""
    covered, runs = zip(*(coverage(item, ESTIMATES) for item in items), strict=True)
    least_to_most = f"{100.0 * min(covered):.1f} to {100.0 * max(covered):.1f} %"
    return [what, str(len(items)), f"{100.0 * np.mean(covered):.1f} %", least_to_most, f"{np.mean(runs):.0f}"]


def text() -> str:
    """The table in Markdown."""
    lines = []
    for low, high in itertools.pairwise(CORRELATIONS):
        made = populations(low, high)
        lines.append(line(f"invented, correlation {low:g} to {high:g}", [next(made) for _ in range(OF_CLASS)]))
    lines += [line(f"{name}'s own thousand runs", [thousand(name)]) for name in ENGINES]
    return table(
        ["population", "populations", f"cover, of {ESTIMATES} estimates", "least and most", "mean runs"], lines
    )


if __name__ == "__main__":
    renew("measured/interval_coverage.md", MODULE, text())
