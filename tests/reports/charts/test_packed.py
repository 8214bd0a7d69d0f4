"""What a page carries of an array is the array, to the step that is stated."""

import json

import numpy as np
import pytest

from reports.charts.figure import STEPS, packed_array
from tests.reports.unpacking import numbers


@pytest.mark.parametrize("seed", range(20))
def test_a_value_is_at_most_half_a_step_beside_the_records(seed: int) -> None:
    rng = np.random.default_rng(seed)
    values = 10.0 ** rng.uniform(-9, 6) * (rng.normal(size=int(rng.integers(1, 400))).cumsum() + rng.normal())
    packed = json.loads(json.dumps(packed_array(values)))
    assert np.abs(numbers(packed) - values).max() <= 0.5000001 * max(np.ptp(values) / STEPS, 1e-12 * abs(values).max())


def test_times_and_whole_numbers_come_back_as_they_are() -> None:
    t_s = np.arange(10_001) * 1e-3
    assert np.abs(numbers(packed_array(t_s)) - t_s).max() < 1e-12
    # A clock of 0.005 s that ends between two ticks, as a replay's, is no clock, and is bounded all the same.
    cut = np.append(t_s[::5], 10.0031)
    assert np.abs(numbers(packed_array(cut)) - cut).max() <= 0.5000001 * 10.0031 / STEPS
    index = np.random.default_rng(0).integers(0, 2**32 - 1, 1000)
    assert np.array_equal(numbers(packed_array(index)), index)


@pytest.mark.parametrize("values", [[], [0.0], [3.25], [-2.0, -2.0, -2.0], [0.0, 0.0]])
def test_arrays_without_a_range_come_back_as_they_are(values: list[float]) -> None:
    assert numbers(packed_array(values)).tolist() == values


def test_values_that_differ_by_rounding_alone_come_back_as_they_are() -> None:
    values = 0.7 + np.spacing(0.7) * np.random.default_rng(0).integers(-2, 3, 500)
    assert np.array_equal(numbers(packed_array(values)), values)


def test_a_value_that_dwarfs_all_others_leaves_them_no_clock() -> None:
    values = np.append(np.arange(50) * 1e-3, 1e200)
    assert np.abs(numbers(packed_array(values)) - values).max() <= 0.5000001 * 1e200 / STEPS


def test_a_smooth_curve_costs_two_digits_a_sample() -> None:
    t_s = np.arange(10_000) * 1e-3
    packed = packed_array(np.sin(6.0 * t_s) * np.exp(-0.2 * t_s))
    assert packed["order"] == 2
    assert np.abs(packed["deltas"][2:]).max() < 10
