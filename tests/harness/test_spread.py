"""What differences of runs say of the finest: the order where three show it, else the safety of two."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from harness.history import History
from harness.record import Run
from harness.spread import MOST_ORDER, SAFETY, SAFETY_ORDERED, factor, spread
from tests.doubles import run_of

Array = NDArray[np.float64]
TIMES = np.linspace(0.0, 1.0, 1001)
TRUTH = 0.05 * np.sin(7.0 * TIMES)
STEPS_S = (4e-3, 2e-3, 9e-4)
SHAPE = 1e-3 * np.sin(3.0 * TIMES) * np.exp(TIMES)


def runs(error_rad: Callable[[float], Array], steps_s: tuple[float, ...] = STEPS_S) -> list[Run]:
    """Runs of these steps whose errors are given."""
    found = []
    for dt_s in steps_s:
        theta = TRUTH + error_rad(dt_s)
        rate = np.gradient(theta, TIMES)
        history = History(TIMES, theta, rate, np.zeros_like(TIMES), np.zeros_like(TIMES))
        found.append(run_of(history, settings={"dt_s": dt_s}))
    return found


def error_of(run: Run) -> float:
    assert run.history is not None
    return float(np.max(np.abs(run.history.theta_rad - TRUTH)))


@pytest.mark.parametrize("order", [1.05, 1.3, 1.7, 2.0])
def test_three_runs_of_one_shape_show_the_order(order: float) -> None:
    first, second, third = runs(lambda dt_s: SHAPE * (dt_s / 1e-3) ** order)
    found = spread(second, third, 1.0, first)
    assert found.stated_rad == pytest.approx(SAFETY_ORDERED * error_of(third), rel=0.03)


def test_a_higher_order_is_not_believed() -> None:
    first, second, third = runs(lambda dt_s: SHAPE * (dt_s / 1e-3) ** 4)
    left = 1.0 / ((STEPS_S[1] / STEPS_S[2]) ** MOST_ORDER - 1.0)
    found = spread(second, third, 1.0, first)
    assert found.stated_rad == pytest.approx(SAFETY_ORDERED * left * found.largest_rad, rel=0.01)


def slow(dt_s: float) -> Array:
    """Errors that hardly fall."""
    return SHAPE * (dt_s / 1e-3) ** 0.5


def other(dt_s: float) -> Array:
    """Errors whose last difference is small, and of another shape than the one before."""
    return SHAPE * (dt_s > 3e-3) + 0.02 * SHAPE[::-1] * (dt_s < 1e-3)


def turned(dt_s: float) -> Array:
    """Errors that pass through zero between the steps: the last difference is small and of the other sign."""
    return SHAPE * {4e-3: 8.0, 2e-3: 0.5, 9e-4: 1.5}[dt_s]


@pytest.mark.parametrize("error_rad", [slow, other, turned])
def test_without_an_order_two_runs_say_what_they_say_alone(error_rad: Callable[[float], Array]) -> None:
    first, second, third = runs(error_rad)
    with_three, with_two = spread(second, third, 1.0, first), spread(second, third, 1.0)
    assert with_three == with_two
    assert with_two.stated_rad == pytest.approx(factor(*STEPS_S[1:]) * with_two.largest_rad)
    assert factor(2e-3, 1e-3) == SAFETY


def test_a_run_with_no_longer_step_shows_no_order() -> None:
    first, second, third = runs(lambda dt_s: SHAPE * (dt_s / 1e-3) ** 2, (2e-3, 2e-3, 1e-3))
    assert spread(second, third, 1.0, first) == spread(second, third, 1.0)


def test_an_order_shown_until_a_run_ends_holds_no_longer() -> None:
    first, second, third = runs(lambda dt_s: SHAPE * (dt_s / 1e-3) ** 2)
    assert first.history is not None
    half = TIMES <= 0.5
    columns = (first.history.t_s, first.history.theta_rad, first.history.theta_rate_rad_s, first.history.slip_m)
    short = History(*(values[half] for values in columns), np.zeros(int(half.sum())))
    ended = run_of(short, settings={"dt_s": STEPS_S[0]}, end_s=0.5)
    whole, cut = spread(second, third, 1.0, first), spread(second, third, 1.0, ended)
    assert cut.stated_rad == pytest.approx(factor(*STEPS_S[1:]) * cut.largest_rad)
    assert whole.stated_rad < 0.5 * cut.stated_rad


def test_it_says_until_when_the_target_is_met() -> None:
    first, second, third = runs(lambda dt_s: SHAPE * (dt_s / 1e-3) ** 2)
    target = 0.5 * spread(second, third, 1.0, first).stated_rad
    found = spread(second, third, target, first)
    assert not found.whole
    assert 0.0 < found.clear_s < found.until_s < found.near_s
    assert found.stated_rad <= target < found.stated_to_the_end_rad
