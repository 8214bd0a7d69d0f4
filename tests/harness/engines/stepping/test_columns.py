"""Velocities of the samples' own times."""

import numpy as np

from harness.engines.stepping.columns import _synchronous


def test_a_run_of_one_sample_keeps_its_velocities() -> None:
    """A run is stopped at its first step where it has parted there from the one that it is held to."""
    values = np.array([[1.0, -2.0, 3.0]])
    np.testing.assert_array_equal(_synchronous(values, np.array([0.1]), np.array([0.05]), 9.81), values)


def test_the_last_sample_goes_on_as_the_one_before() -> None:
    values = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]])
    own = _synchronous(values, np.array([1.0, 2.0, 3.0]), np.array([0.5, 1.5, 2.5]), 9.81)
    np.testing.assert_allclose(own[:, 0], [0.5, 1.5, 2.5])
