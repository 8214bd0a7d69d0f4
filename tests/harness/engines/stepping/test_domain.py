"""A run says when, for how long and why it left what its events are located for; its velocities are of its own times."""

import numpy as np
import pytest

from harness.engines.stepping.support import LEFT_M, LEFT_RAD, Corners, plain_spells
from harness.engines.stepping.trajectory import Trajectory, _synchronous
from harness.model import Pedestal

TIMES = np.linspace(0.0, 1.0, 11)
STILL = np.zeros(11)
PEDESTAL = Pedestal(100.0, 0.6, 0.6, 0.2)
SLIDES, FLIES = "statue_slides", "contact_lost"
TIPS, BESIDE = "pedestal_tips", "beyond_edge"


def spells(
    slip_m: np.ndarray = STILL, gap_m: np.ndarray = STILL, tilt_rad: np.ndarray = STILL, right_m: np.ndarray = STILL
) -> tuple[float | None, float, list[str]]:
    place = np.zeros((11, 2))
    motion = Trajectory(
        TIMES, STILL, STILL, STILL, STILL, place, place, place, place, place, extra={"pedestal_tilt_rad": tilt_rad}
    )
    found = plain_spells(motion, slip_m, gap_m, Corners(right_m, *([STILL] * 6)), PEDESTAL)
    return found["plain_from_s"], found["plain_for_s"], found["plain_because"]


def ramp(limit: float, from_s: float, until_s: float = 2.0) -> np.ndarray:
    """Just within the limit, then just beyond it, then within it again."""
    return np.where((from_s <= TIMES) & (until_s > TIMES), 1.01, 0.99) * limit


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_each_reason_counts_beyond_its_limit(sign: float) -> None:
    assert spells(tilt_rad=sign * ramp(LEFT_RAD, 0.3, 0.65)) == (pytest.approx(0.3), pytest.approx(0.4), [TIPS])
    assert spells(right_m=sign * ramp(0.3 + LEFT_M, 0.5)) == (0.5, pytest.approx(0.6), [BESIDE])
    gap = spells(gap_m=sign * ramp(LEFT_M, 0.4))
    assert gap == ((0.4, pytest.approx(0.7), [FLIES]) if sign > 0.0 else (None, 0.0, [])), "sinks in: no gap"


def test_a_slip_counts_from_its_limit_on_and_while_it_goes_on() -> None:
    slid = np.interp(TIMES, [0.0, 0.35, 0.65, 1.0], [0.0, 0.0, 0.01, 0.01])
    assert spells(slip_m=slid) == (0.4, pytest.approx(0.4), [SLIDES])


def test_what_came_first_is_told_first_and_nothing_within_the_limits() -> None:
    both = spells(tilt_rad=ramp(LEFT_RAD, 0.6), gap_m=ramp(LEFT_M, 0.2))
    assert (both[0], both[2]) == (0.2, [FLIES, TIPS])
    assert spells(0.99 * LEFT_M + STILL, 0.99 * LEFT_M + STILL, 0.99 * LEFT_RAD + STILL) == (None, 0.0, [])


def test_a_run_of_one_sample_keeps_its_velocities() -> None:
    """A run is stopped at its first step where it has parted there from the one that it is held to."""
    values = np.array([[1.0, -2.0, 3.0]])
    np.testing.assert_array_equal(_synchronous(values, np.array([0.1]), np.array([0.05]), 9.81), values)


def test_the_last_sample_goes_on_as_the_one_before() -> None:
    values = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]])
    own = _synchronous(values, np.array([1.0, 2.0, 3.0]), np.array([0.5, 1.5, 2.5]), 9.81)
    np.testing.assert_allclose(own[:, 0], [0.5, 1.5, 2.5])
