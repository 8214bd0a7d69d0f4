"""Outcome scores over a set, by hand."""

import math

import numpy as np
import pytest

from harness.comparison.statistics import Prediction, brier, brier_skill, f1, matthews, score_outcomes
from harness.model import Outcome
from tests.budgets_compare import ROUNDING_REL

S, L, R = Outcome.STANDS, Outcome.OVERTURNED_LEFT, Outcome.OVERTURNED_RIGHT


def cases(table: dict[tuple[Outcome, Outcome], int]) -> list[Prediction]:
    return [Prediction(predicted, observed) for (predicted, observed), count in table.items() for _ in range(count)]


def test_scores_by_hand() -> None:
    """TP 12 (2 of them to the wrong side), FP 3, FN 5, TN 20."""
    found = score_outcomes(cases({(L, L): 10, (L, R): 2, (R, S): 3, (S, L): 5, (S, S): 20}))
    assert found.accuracy.value == pytest.approx(32 / 40)
    assert found.side_accuracy.value == pytest.approx(30 / 40)
    assert found.precision.value == pytest.approx(12 / 15)
    assert found.recall.value == pytest.approx(12 / 17)
    assert found.f1.value == pytest.approx(2 * 0.8 * (12 / 17) / (0.8 + 12 / 17))
    expected = (12 * 20 - 3 * 5) / math.sqrt(15 * 17 * 23 * 25)
    assert found.matthews.value == pytest.approx(expected, rel=ROUNDING_REL)
    assert found.matthews.low < expected < found.matthews.high
    assert found.confusion["overturned_right"]["overturned_left"] == 2
    assert found.confusion["stands"]["overturned_right"] == 3
    assert sum(sum(row.values()) for row in found.confusion.values()) == 40


def test_perfect_inverted_and_constant_predictions() -> None:
    perfect = score_outcomes(cases({(L, L): 5, (S, S): 7}))
    inverted = score_outcomes(cases({(S, L): 5, (L, S): 7}))
    constant = score_outcomes(cases({(S, L): 5, (S, S): 7}))
    assert perfect.matthews.value == 1.0
    assert inverted.matthews.value == -1.0
    assert constant.matthews is None
    assert constant.precision is None
    assert constant.f1.value == 0.0


def test_what_flips_within_the_uncertainty_and_what_is_undecided_is_counted_apart() -> None:
    flipping = [Prediction(L, S, within_uncertainty=True)] * 3
    lifted = [Prediction(Outcome.LIFT_OFF, S)] * 2
    found = score_outcomes([*cases({(L, L): 4, (S, S): 4}), *flipping, *lifted])
    assert (found.cases, found.undecided, found.within_uncertainty) == (13, 2, 3)
    assert found.accuracy.value == 1.0


def test_no_return_times_are_compared_where_both_fall() -> None:
    found = score_outcomes(
        [Prediction(L, L, no_return_s=(3.0, 2.5)), Prediction(L, L, no_return_s=(4.0, 3.0)), Prediction(S, S)]
    )
    assert found.no_return_difference_s.value == pytest.approx(0.75)


def test_an_empty_set_has_no_scores() -> None:
    found = score_outcomes([])
    assert found.cases == 0
    assert (found.accuracy, found.f1, found.matthews, found.no_return_difference_s) == (None, None, None, None)


def test_f1_and_matthews_without_meaning_are_nan() -> None:
    none = np.zeros(3, dtype=np.bool_)
    assert math.isnan(f1(none, none))
    assert math.isnan(matthews(none, ~none))


def test_brier_by_hand() -> None:
    assert brier([0.9, 0.2, 0.5], [1, 0, 1]) == pytest.approx((0.01 + 0.04 + 0.25) / 3)
    assert brier([1.0, 0.0], [1, 0]) == 0.0
    assert brier([0.5] * 4, [1, 0, 0, 1]) == 0.25
    assert brier_skill([1.0, 0.0], [1, 0]) == 1.0
    assert brier_skill([0.5, 0.5], [1, 0]) == 0.0
    assert math.isnan(brier_skill([0.5], [1]))


@pytest.mark.parametrize("bad", [[1.1], [-0.1], [math.nan], [0.5, 0.5]])
def test_what_is_no_probability_is_refused(bad: list[float]) -> None:
    with pytest.raises(ValueError, match="from 0 to 1"):
        brier(bad, [1])


def test_a_side_that_flips_within_the_uncertainty_leaves_the_outcome_s_score() -> None:
    """Both fall: the outcome is right; which way it fell is not decided, so it counts in no accuracy of sides."""
    open_side = Prediction(Outcome.OVERTURNED_LEFT, Outcome.OVERTURNED_RIGHT, side_within_uncertainty=True)
    wrong_side = Prediction(Outcome.OVERTURNED_LEFT, Outcome.OVERTURNED_RIGHT)
    right = Prediction(Outcome.STANDS, Outcome.STANDS)
    found = score_outcomes([open_side, wrong_side, right])
    assert (found.accuracy.value, found.side_accuracy.value) == (1.0, 0.5)
    assert found.within_uncertainty == 0
