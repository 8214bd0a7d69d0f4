"""The springs to which pybullet is held find what is known, and better the stiffer they are."""

import numpy as np
import pytest

from harness.accuracy.refinement import simulate
from tests.measures.pedestal_space import SAMPLE_S, SINKS, row_of, springs
from tests.scenes_for_tests import paestum


def test_springs_find_the_model_s_rotation_and_slip_before_an_impact_as_they_grow_stiff() -> None:
    scene = paestum(0.429, 3.0)
    exact = simulate(scene, "analytic")
    assert exact.history is not None
    until_s = exact.impact_times_s[0] - 5.0 * SAMPLE_S
    errors = []
    for share in (16.0, 4.0):
        found = springs(scene, until_s, share * SINKS)
        history = exact.history
        told = np.stack([history.theta_rad, history.slip_m], axis=1)[: len(found)]
        errors.append(np.max(np.abs(found[:, :2] - told), axis=0))
        assert np.max(np.abs(found[:, 2:])) < 1e-9, "a motion in the plane stays in it"
    assert np.max(np.abs(exact.history.theta_rad[: len(found)])) > 1e-2
    assert np.all(errors[1] < 0.7 * errors[0])
    assert np.all(errors[1] < [1e-3, 4e-4])


@pytest.mark.parametrize("seed", [780_003])
def test_a_statue_that_rocks_on_a_pedestal_sliding_askew_is_within_what_pybullet_states(seed: int) -> None:
    row = row_of(seed)
    assert row.until_s > 0.2
    assert min(row.peak_rad, row.slip_m, row.across_m) > 1e-3
    assert row.held == (True, True)
    assert row.across_error_m < 1e-4
