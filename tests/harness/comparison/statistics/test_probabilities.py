"""Probabilities against outcomes: the area under the curve and the reliability diagram, by hand and by many drawn sets."""

import numpy as np
import pytest
from scipy import stats

from harness.comparison.statistics import area_under_curve, reliability
from tests.budgets_compare import COUNTED


def test_the_area_counts_pairs_in_the_right_order() -> None:
    """Of the four pairs of one that fell and one that stood three are in order, one of them a tie: 3.5 of 4 less a tie's half."""
    found = area_under_curve([0.9, 0.4, 0.4, 0.1], [True, True, False, False])
    assert found.value == pytest.approx(3.5 / 4)
    assert found.low <= found.value <= found.high


def test_one_class_has_no_area() -> None:
    assert area_under_curve([0.2, 0.4], [True, True]) is None
    assert area_under_curve([], []) is None


def test_the_area_of_useless_and_of_perfect_probabilities() -> None:
    seen = [k % 2 == 0 for k in range(40)]
    assert area_under_curve([0.5] * 40, seen).value == pytest.approx(0.5)  # type: ignore[union-attr]
    assert area_under_curve([float(fell) for fell in seen], seen).value == 1.0  # type: ignore[union-attr]


def test_bins_hold_their_cases_and_the_band_is_the_binomials() -> None:
    """Twenty cases of one probability: the count that falls is binomial, whose quantiles scipy knows."""
    p = np.full(20, 0.3)
    bins = reliability(np.concatenate([p, [1.0]]), [k < 6 for k in range(20)] + [True])
    assert [(item.low, item.high, item.cases) for item in bins] == [(0.2, 0.4, 20), (0.8, 1.0, 1)]
    low, high = stats.binom.ppf((0.025, 0.975), 20, 0.3) / 20
    assert (bins[0].band_low, bins[0].band_high) == (pytest.approx(low), pytest.approx(high))
    assert bins[0].fell.value == pytest.approx(0.3)
    assert bins[0].holds


@pytest.mark.parametrize(("shift", "holds"), [(0.0, True), (0.15, False)])
def test_true_probabilities_lie_in_the_band_and_others_do_not(shift: float, holds: bool) -> None:
    """Of a hundred sets of 300 cases at least 95 in 100 bins hold where the probabilities are true; a shift of 0.15 is seen."""
    random = np.random.default_rng(4)
    inside = total = 0
    for _ in range(100):
        p = random.uniform(size=300)
        seen = random.uniform(size=300) < np.clip(p + shift, 0.0, 1.0)
        bins = reliability(p, seen)
        inside += sum(item.holds for item in bins)
        total += len(bins)
    assert (inside / total >= 0.95 - COUNTED) is holds


def test_cases_that_share_what_is_not_known_have_a_wider_band() -> None:
    """Bodies of 25 cases, one shift of probability each, which a true forecast does not know: its band holds 95 in 100 bins, that
    of independent cases fewer.
    """
    random = np.random.default_rng(8)
    held = {"together": 0, "independent": 0}
    total = 0
    for _ in range(60):
        middle, shifts = random.uniform(0.3, 0.7, (8, 25)), np.array([-0.3, 0.0, 0.3])
        p = middle.reshape(-1)
        drawn = middle + shifts[random.integers(3, size=(500, 8))][:, :, None]
        possible = random.uniform(size=drawn.shape) < drawn
        seen = (random.uniform(size=middle.shape) < middle + shifts[random.integers(3, size=8)][:, None]).reshape(-1)
        together, independent = reliability(p, seen, possible=possible.reshape(500, -1)), reliability(p, seen)
        total += len(together)
        held["together"] += sum(item.holds for item in together)
        held["independent"] += sum(item.holds for item in independent)
    assert held["together"] / total >= 0.95 - COUNTED
    assert held["independent"] / total < 0.85
