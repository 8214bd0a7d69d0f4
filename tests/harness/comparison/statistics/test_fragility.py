"""Fragility curves: the likelihood's maximum by another optimiser, recovery of known curves, and what cannot be fitted."""

import numpy as np
import pytest
from scipy import optimize, stats

from harness.comparison import statistics
from tests.budgets_compare import QUANTILE_SE


def drawn(median: float, dispersion: float, count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    x = rng.uniform(0.1, 1.5, count)
    return x, rng.uniform(size=count) < stats.norm.cdf(np.log(x / median) / dispersion)


def test_the_maximum_is_the_one_that_a_direct_search_finds() -> None:
    """Baker's layout: eight levels of 40 motions each."""
    levels, fell = [0.2, 0.3, 0.4, 0.6, 0.7, 0.8, 0.9, 1.0], [0, 0, 0, 4, 6, 13, 12, 16]
    x = np.repeat(levels, 40)
    y = np.concatenate([np.arange(40) < count for count in fell])
    found = statistics.fit_fragility(x, y)

    def minus(parameters: np.ndarray) -> float:
        p = stats.norm.cdf(np.log(np.array(levels) / parameters[0]) / parameters[1])
        return -float(np.sum(stats.binom.logpmf(fell, 40, p)))

    searched = optimize.minimize(minus, [0.8, 0.4], method="Nelder-Mead", options={"xatol": 1e-10, "fatol": 1e-12})
    # A search on values alone sees the flat top to the root of rounding.
    assert (found.median, found.dispersion) == pytest.approx(tuple(searched.x), rel=1e-6)


def test_a_known_curve_is_recovered_within_its_own_errors() -> None:
    x, y = drawn(0.6, 0.4, 4000, 3)
    found = statistics.fit_fragility(x, y)
    low, high = found.band(x, confidence=stats.norm.cdf(QUANTILE_SE) * 2 - 1)
    truth = stats.norm.cdf(np.log(x / 0.6) / 0.4)
    assert np.all((low <= truth) & (truth <= high))
    assert np.all(np.diff(found.probability(np.linspace(0.1, 2.0, 50))) > 0.0)


def test_the_band_covers_the_truth_as_often_as_it_says() -> None:
    """95 % bands in the tail, at the median and above, over 400 seeded sets: 95 % ± four standard errors of such a proportion."""
    asked, sets = np.array([0.35, 0.6, 0.9]), 400
    truth, covered = stats.norm.cdf(np.log(asked / 0.6) / 0.4), np.zeros(3)
    for seed in range(sets):
        low, high = statistics.fit_fragility(*drawn(0.6, 0.4, 150, seed)).band(asked)
        covered += (low <= truth) & (truth <= high)
    assert covered / sets == pytest.approx(np.full(3, 0.95), abs=QUANTILE_SE * np.sqrt(0.95 * 0.05 / sets))


def test_the_band_is_the_bootstrap_s_where_cases_are_many() -> None:
    """1000 cases, 400 resamples: a 2.5 % quantile rests on 10 of them and errs by some 0.15 standard deviations of the curve."""
    x, y = drawn(0.6, 0.4, 1000, 5)
    asked, stream = np.array([0.4, 0.6, 0.9]), np.random.default_rng(2)
    index = stream.integers(0, x.size, (400, x.size))
    curves = np.array([statistics.fit_fragility(x[pick], y[pick]).probability(asked) for pick in index])
    low, high = statistics.fit_fragility(x, y).band(asked)
    spread = curves.std(axis=0)
    assert np.all(np.abs(np.quantile(curves, 0.025, axis=0) - low) <= 0.6 * spread)
    assert np.all(np.abs(np.quantile(curves, 0.975, axis=0) - high) <= 0.6 * spread)


def test_separated_classes_have_bounds_and_no_dispersion() -> None:
    found = statistics.fit_fragility([0.1, 0.2, 0.4, 0.8], [0, 0, 1, 1])
    assert found.separated
    assert found.bounds == (0.2, 0.4)
    assert found.median == pytest.approx(np.sqrt(0.08))
    assert found.probability([0.2, 0.4]).tolist() == [0.0, 1.0]
    low, high = found.band([0.1, 0.3, 0.5])
    assert (low.tolist(), high.tolist()) == ([0.0, 0.0, 1.0], [0.0, 1.0, 1.0])


@pytest.mark.parametrize("y", [[0, 0, 0], [1, 1, 1], [1, 1, 0]], ids=["none fell", "all fell", "falling curve"])
def test_what_no_rising_curve_fits_says_nothing(y: list[int]) -> None:
    x = [0.1, 0.2, 0.3]
    found = statistics.fit_fragility(x, y)
    assert found.median is None
    assert np.all(np.isnan(found.probability(x)))
    assert found.fell == sum(y)


@pytest.mark.parametrize("x", [[], [0.0], [-1.0], [np.inf]])
def test_intensities_must_be_positive(x: list[float]) -> None:
    with pytest.raises(ValueError, match="positive intensities"):
        statistics.fit_fragility(x, [1] * len(x))
