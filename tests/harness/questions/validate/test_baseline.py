"""The baselines without a model: threshold and contour, by hand and by recovery."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from harness.questions.validate.scenes import GRAVITY_M_S2, Intensity
from harness.questions.validate.scoring import best_threshold, chances, contour, contour_pga_g
from tests.budgets_compare import QUANTILE_SE


@pytest.mark.parametrize(
    ("x", "fell", "threshold"),
    [
        ([1, 2, 3, 4], [0, 0, 1, 1], 2.5),
        ([4, 1, 3, 2], [1, 0, 1, 0], 2.5),
        ([1, 2, 3], [1, 1, 1], 1.0),
        ([1, 2, 3, 4, 5], [0, 1, 0, 1, 1], 1.5),
        ([1, 1, 2], [0, 1, 1], 1.0),
    ],
    ids=["parted", "in any order", "all fell", "first of equals", "ties are not parted"],
)
def test_the_best_threshold(x: list[float], fell: list[int], threshold: float) -> None:
    assert best_threshold(x, fell) == pytest.approx(threshold)


def test_nobody_fell_means_a_threshold_above_all() -> None:
    assert best_threshold([1.0, 2.0], [0, 0]) > 2.0


def test_the_best_threshold_is_the_best_of_all() -> None:
    rng = np.random.default_rng(5)
    x = rng.uniform(size=60)
    y = rng.uniform(size=60) < x
    right = max(int(np.sum((x >= t) == y)) for t in np.concatenate((x, [2.0])))
    assert int(np.sum((x >= best_threshold(x, y)) == y)) == right


def test_the_probability_by_intensity_is_that_of_the_curve_drawn_from() -> None:
    """Median 0.5, dispersion 0.4: with 4000 cases the share at the median is known to some 1/√4000; four of them."""
    rng = np.random.default_rng(3)
    x = rng.uniform(0.1, 1.5, 4000)
    y = rng.uniform(size=4000) < stats.norm.cdf(np.log(x / 0.5) / 0.4)
    asked = np.array([0.3, 0.5, 0.9])
    true = stats.norm.cdf(np.log(asked / 0.5) / 0.4)
    assert np.max(np.abs(chances(x, y, asked) - true)) <= QUANTILE_SE / np.sqrt(4000.0)


def test_without_a_rising_curve_the_share_that_fell_is_all_that_is_known() -> None:
    assert chances([1, 2, 3], [0, 0, 0], [2.0, 0.0]).tolist() == [pytest.approx(0.2), 0.0]
    assert chances([1, 2, 3, 4], [1, 0, 1, 0], [2.0])[0] == pytest.approx(0.5)
    assert chances([0, 0], [0, 0], [1.0])[0] == pytest.approx(0.25)


def drawn(count: int) -> tuple[list[Intensity], list[bool]]:
    rng = np.random.default_rng(9)
    pga, ratio = rng.uniform(0.1, 1.2, count), rng.uniform(0.05, 0.3, count)
    p = stats.norm.cdf(8.0 + 3.0 * np.log(pga) + 3.0 * np.log(ratio))
    shaken = [Intensity(a, a * GRAVITY_M_S2 * r) for a, r in zip(pga, ratio, strict=True)]
    return shaken, (rng.uniform(size=count) < p).tolist()


def test_a_known_contour_is_recovered() -> None:
    """Where P = 1/2 the curve's error is that of c₀, c₁, c₂: some 1/√n over the slope's 3; four of them."""
    found = contour(*drawn(4000))
    assert not found.separated
    ratios = np.array([0.08, 0.15, 0.25])
    expected = np.exp(-(8.0 + 3.0 * np.log(ratios)) / 3.0)
    assert np.log(contour_pga_g(found.coefficients, ratios)) == pytest.approx(
        np.log(expected), abs=QUANTILE_SE * 3.0 / np.sqrt(4000)
    )
    assert np.all(contour_pga_g(found.coefficients, ratios, 0.9) > contour_pga_g(found.coefficients, ratios))


def test_separated_classes_have_a_line_between_them() -> None:
    shaken = [Intensity(a, a * GRAVITY_M_S2 * 0.1 * (1 + k % 3)) for k, a in enumerate(np.linspace(0.1, 1.0, 20))]
    fell = [each.pga_g > 0.5 for each in shaken]
    found = contour(shaken, fell)
    assert found.separated
    above = [each.pga_g > contour_pga_g(found.coefficients, each.ratio_s) for each in shaken]
    assert above == fell


def test_one_class_has_no_contour() -> None:
    shaken, _ = drawn(10)
    assert contour(shaken, [True] * 10) is None
