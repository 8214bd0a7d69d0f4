"""A run says when it left what its events are located for."""

from __future__ import annotations

import numpy as np
import pytest

from harness.engines.contact.layer import LEFT_M, LEFT_RAD, layer_left
from harness.engines.contact.trajectory import Trajectory

TIMES = np.linspace(0.0, 1.0, 11)
STILL = np.zeros(11)


def motion(tilt_rad: np.ndarray | None = None) -> Trajectory:
    extra = {} if tilt_rad is None else {"pedestal_tilt_rad": tilt_rad}
    place = np.zeros((11, 2))
    return Trajectory(TIMES, STILL, STILL, STILL, STILL, place, place, place, None, None, extra)


def ramp(limit: float, from_s: float) -> np.ndarray:
    """Just within the limit, then just beyond it."""
    return np.where(from_s <= TIMES, 1.01, 0.99) * limit


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_slip_gap_and_tilt_count_beyond_their_limits(sign: float) -> None:
    assert layer_left(motion(), sign * ramp(LEFT_M, 0.5), STILL) == {
        "layer_left_s": 0.5,
        "layer_left_by": "the statue slides on its support",
    }
    assert layer_left(motion(sign * ramp(LEFT_RAD, 0.3)), STILL, STILL)["layer_left_by"] == "the pedestal tips"
    gap = layer_left(motion(), STILL, sign * ramp(LEFT_M, 0.4))
    assert gap == ({"layer_left_s": 0.4, "layer_left_by": "the statue lifts off"} if sign > 0.0 else {}), (
        "sinks in: no gap"
    )


def test_what_came_first_is_told_and_nothing_within_the_limits() -> None:
    both = layer_left(motion(ramp(LEFT_RAD, 0.2)), ramp(LEFT_M, 0.5), STILL)
    assert both == {"layer_left_s": 0.2, "layer_left_by": "the pedestal tips"}
    assert layer_left(motion(0.99 * LEFT_RAD + STILL), 0.99 * LEFT_M + STILL, 0.99 * LEFT_M + STILL) == {}
