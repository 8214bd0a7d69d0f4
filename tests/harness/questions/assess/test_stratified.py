"""An engine's probability from few runs: unbiased whatever the model says, with intervals that cover."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from harness.questions.assess.engine_draws import estimate
from harness.questions.assess.model_draws import ModelDraws
from harness.records.assess import Assessment
from tests import budgets_assess as budget


def population(agreement: float, probability: float, random: np.random.Generator) -> tuple[ModelDraws, np.ndarray]:
    """A model's answers to the draws and an engine's that agrees with that share of them, else is drawn anew."""
    fell = random.random(budget.TRUTH_DRAWS) < probability
    same = random.random(budget.TRUTH_DRAWS) < agreement
    engine = np.where(same, fell, random.random(budget.TRUTH_DRAWS) < probability)
    share = np.where(fell, 17.0, random.uniform(0.0, 1.2, budget.TRUTH_DRAWS))
    return ModelDraws(np.ones_like(fell), fell, share, np.zeros(fell.size), *np.zeros((2, fell.size), bool)), engine


def estimated(model: ModelDraws, engine: np.ndarray, half_width: float = 0.05) -> Assessment:
    def run(numbers: Sequence[int]) -> list[bool | None]:
        return [bool(engine[k]) for k in numbers]

    return estimate(model, run, half_width=half_width, most_runs=2000, batch=8)


@pytest.mark.parametrize(("agreement", "probability"), [(0.9, 0.4), (0.0, 0.4), (0.95, 0.1), (0.8, 0.03)])
def test_intervals_cover_the_engines_own_probability(agreement: float, probability: float) -> None:
    random = np.random.default_rng(7)
    model, engine = population(agreement, probability, random)
    truth, covered, values = engine.mean(), 0, []
    for _ in range(budget.REPETITIONS):
        order = random.permutation(engine.size)
        shuffled = ModelDraws(*(column[order] for column in model))
        answer = estimated(shuffled, engine[order])
        covered += answer.low <= truth <= answer.high
        values.append(answer.probability_overturned)
    assert covered / budget.REPETITIONS >= budget.LEAST_COVERED
    standard_error = np.std(values) / np.sqrt(budget.REPETITIONS)
    assert abs(np.mean(values) - truth) <= 4.0 * standard_error, "the estimate is biased"


def test_an_engine_that_agrees_needs_fewer_runs() -> None:
    random = np.random.default_rng(3)
    close, far = (estimated(*population(agreement, 0.4, random)) for agreement in (0.95, 0.0))
    assert close.engine_runs < 0.5 * far.engine_runs


def test_a_model_that_is_always_wrong_does_not_move_the_estimate() -> None:
    model, engine = population(1.0, 0.4, np.random.default_rng(5))
    answer = estimated(model, ~engine)
    assert answer.low <= 1.0 - engine.mean() <= answer.high


def test_failed_runs_are_counted_apart() -> None:
    model, _ = population(1.0, 0.4, np.random.default_rng(5))
    answer = estimate(model, lambda numbers: [None] * len(numbers), half_width=0.05, most_runs=64, batch=8)
    assert answer.undecided == 1.0
    assert answer.engine_runs == 64
    assert np.isnan(answer.probability_overturned)
