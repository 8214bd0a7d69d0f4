"""Fewer samples for the screen keep every peak."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reports.charts.figure import shown_samples
from reports.pages.run_page import drawn_stretches


@settings(max_examples=60, deadline=None)
@given(st.integers(1, 5000), st.integers(8, 400), st.integers(0, 2**32 - 1))
def test_extremes_and_ends_stay(count: int, most: int, seed: int) -> None:
    values = np.random.default_rng(seed).standard_normal(count)
    kept = shown_samples(values, most)
    assert len(kept) <= max(most, 8)
    assert np.all(np.diff(kept) > 0)
    assert {0, count - 1} <= set(kept.tolist())
    assert values[kept].max() == values.max()
    assert values[kept].min() == values.min()


def test_a_short_curve_is_drawn_whole() -> None:
    assert np.array_equal(shown_samples(np.zeros(100), 100), np.arange(100))


def test_a_single_sample_spike_survives_in_any_bin() -> None:
    values = np.zeros(100_000)
    for place in (1, 49_999, 99_998):
        values[place] = 1.0
        assert place in shown_samples(values, 400)
        values[place] = 0.0


def test_every_nth_sample_would_lose_the_spike() -> None:
    values = np.zeros(100_000)
    values[49_999] = 1.0
    assert values[::250].max() == 0.0
    assert values[shown_samples(values, 400)].max() == 1.0


def test_many_short_stretches_cover_the_same_time() -> None:
    edges = np.linspace(0.0, 10.0, 20_001)
    patterns = [[a, b, ("rocking", "both")[k % 2]] for k, (a, b) in enumerate(itertools.pairwise(edges))]
    drawn = drawn_stretches(patterns, 200)
    assert len(drawn) <= 201
    assert drawn[0][0] == 0.0
    assert drawn[-1][1] == pytest.approx(10.0, abs=1e-9)
    assert all(before[1] == after[0] for before, after in itertools.pairwise(drawn))


def test_few_stretches_are_drawn_as_recorded() -> None:
    patterns = [[0.0, 0.5, "rest"], [0.5, 0.5000001, "both"], [0.5000001, 1.0, "rocking"]]
    assert drawn_stretches(patterns) == [tuple(item) for item in patterns]
