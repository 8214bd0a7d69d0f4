"""Distances of distributions and intervals, against scipy, hand computation and coverage."""

import math

import numpy as np
import pytest
from scipy import stats

from harness.comparison import statistics
from tests.budgets_compare import LEAST_SUITES, QUANTILE_SE, ROUNDING_REL, SUITES


@pytest.fixture
def samples() -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(4)
    return rng.lognormal(0.0, 0.5, 83), rng.lognormal(0.2, 0.4, 57)


def test_distances_are_scipy_s(samples: tuple[np.ndarray, np.ndarray]) -> None:
    a, b = samples
    assert statistics.ks_distance(a, b) == pytest.approx(stats.ks_2samp(a, b).statistic, rel=ROUNDING_REL)
    assert statistics.area_metric(a, b) == pytest.approx(stats.wasserstein_distance(a, b), rel=ROUNDING_REL)


def test_distances_by_hand() -> None:
    """{1, 2, 3} against {2, 4}: F_a − F_b is 1/3 on [1, 2), 1/6 on [2, 3), 1/2 on [3, 4)."""
    assert statistics.ks_distance([1, 2, 3], [2, 4]) == pytest.approx(0.5)
    assert statistics.area_metric([1, 2, 3], [2, 4]) == pytest.approx(1 / 3 + 1 / 6 + 1 / 2)


def test_a_shift_is_the_area_metric(samples: tuple[np.ndarray, np.ndarray]) -> None:
    a, _ = samples
    assert statistics.area_metric(a + 0.7, a) == pytest.approx(0.7, rel=1e-9)
    assert statistics.area_metric(a, a) == 0.0
    assert statistics.ks_distance(a, a) == 0.0


@pytest.mark.parametrize("bad", [[], [1.0, math.nan]])
def test_an_empty_or_broken_sample_is_refused(bad: list[float]) -> None:
    with pytest.raises(ValueError, match="all finite"):
        statistics.area_metric(bad, [1.0])


def test_wilson_by_hand() -> None:
    """8 of 10 with z = 1.96: the published interval is 0.490 to 0.943."""
    found = statistics.wilson(8, 10)
    assert (found.value, round(found.low, 3), round(found.high, 3)) == (0.8, 0.490, 0.943)
    assert statistics.wilson(0, 0) is None
    for hits in (0, 10):
        edge = statistics.wilson(hits, 10)
        assert 0.0 <= edge.low <= edge.value <= edge.high <= 1.0


def test_bootstrap_of_a_mean_has_its_standard_error() -> None:
    values = np.random.default_rng(7).normal(3.0, 2.0, 400)
    found = statistics.bootstrap(lambda index: float(values[index].mean()), values.size, seed=1)
    half = 1.96 * values.std() / math.sqrt(values.size)
    # The 2.5 % quantile of 1000 resamples has a standard error of 0.0264 standard deviations… /φ(1.96)·√(0.025·0.975/1000).
    error = QUANTILE_SE * math.sqrt(0.025 * 0.975 / 1000) / stats.norm.pdf(1.96) * half / 1.96
    assert found.low == pytest.approx(values.mean() - half, abs=error)
    assert found.high == pytest.approx(values.mean() + half, abs=error)
    assert found == statistics.bootstrap(lambda index: float(values[index].mean()), values.size, seed=1)


def test_a_score_that_is_nowhere_defined_has_no_interval() -> None:
    assert statistics.bootstrap(lambda index: math.nan, 10) is None
    assert statistics.bootstrap(lambda index: 1.0, 0) is None


def test_equal_distributions_stay_below_the_null_and_others_do_not() -> None:
    rng = np.random.default_rng(11)
    same = statistics.compare_distributions(rng.normal(size=80), rng.normal(size=80), resamples=300)
    apart = statistics.compare_distributions(rng.normal(size=80), rng.normal(1.0, size=80), resamples=300)
    assert not same.differ
    assert apart.differ
    assert apart.ks_p == pytest.approx(1 / 301), "none of the shuffles is as far apart"
    assert same.ks_p > 1e-2
    assert apart.area.low < apart.area.value < apart.area.high


@pytest.mark.parametrize("shift", [0.0, 0.4, 0.8])
def test_shuffling_finds_the_exact_probability_of_a_distance(shift: float) -> None:
    rng, shuffles = np.random.default_rng(3), 4000
    a, b = rng.normal(size=12), rng.normal(shift, size=15)
    exact = stats.ks_2samp(a, b, method="exact").pvalue
    found = statistics.compare_distributions(a, b, resamples=shuffles).ks_p
    assert found == pytest.approx(exact, abs=4.0 * math.sqrt(exact * (1.0 - exact) / shuffles) + 1.0 / shuffles)


def test_resampled_cases_hold_the_area_between_two_alike_models() -> None:
    """Two models that differ by a hair in every case: their area is that hair, not the scatter of the cases."""
    values = np.random.default_rng(2).lognormal(size=30)
    area = statistics.compare_distributions(values, values + 1e-3, resamples=100, paired=True).area
    assert area.low == pytest.approx(1e-3)
    assert area.value == pytest.approx(1e-3)
    # Resampled apart from each other they scatter by more than the hair, which the interval holds all the same.
    apart = statistics.compare_distributions(values, values + 1e-3, resamples=100).area
    assert apart.low <= apart.value < apart.high


def test_median_and_dispersion_of_peaks_cover_what_they_were_drawn_with() -> None:
    """A model whose peaks are 1.1 times the other's, with scatter of its own: 95 % intervals cover in 95 of 100 suites, ± 2.2."""
    rng, truth, covered = np.random.default_rng(5), 1.1, np.zeros(2)
    wide = math.sqrt(0.6**2 + 0.1**2) / 0.6
    for seed in range(SUITES):
        shared = 0.6 * rng.standard_normal(40)
        own = shared + math.log(truth) + 0.1 * rng.standard_normal(40)
        scores = statistics.compare_logarithms(np.exp(own), np.exp(shared), seed=seed, resamples=200)
        intervals = (scores.median_ratio, truth), (scores.dispersion_ratio, wide)
        covered += [interval.low <= value <= interval.high for interval, value in intervals]
        assert scores.dispersion == pytest.approx(float(np.std(own, ddof=1)))
    assert (covered >= LEAST_SUITES).all()
    assert statistics.compare_logarithms([0.1] * 9, [0.2] * 9) is None, "without scatter there is no ratio"
