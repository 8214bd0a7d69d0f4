"""One-sine and one-cosine pulses on the linearised block: published thresholds, both modes, and the nonlinear reference."""

import math

import numpy as np
import pytest

from analytic import AnalyticInputError
from analytic.pulse_response import minimum_overturning_spectrum, overturning_ranges, pulse_response
from tests import budgets_reference as budget
from tests.analytic import reference_lagrange
from tests.analytic.reference_case import GRAVITY, Case, full_period
from tests.analytic.test_closed_form import assert_printed

OMEGA_OVER_P, RATIO = 5.0, 0.9


def test_published_thresholds_and_their_modes() -> None:
    first, second = overturning_ranges(OMEGA_OVER_P, RATIO)
    assert_printed(first[0], "3.0186")
    assert_printed(first[1], "6.3181")
    assert_printed(second[0], "7.1681")
    assert second[1] == math.inf
    assert (first[2], second[2]) == (1, 0), "first after one impact, then at once"


def slender_outcome(amplitude: float, omega_over_p: float, ratio: float, kind: str) -> str:
    """Outcome of the nonlinear reference at α = 1e-3, forced towards its right corner first."""
    alpha = 1e-3
    p = math.sqrt(0.75 * GRAVITY)
    pulse = full_period(-amplitude * GRAVITY * alpha, 2.0 * math.pi / (omega_over_p * p), kind)
    h, b = math.cos(alpha), math.sin(alpha)
    case = Case(1.0, h, b, b, 1.0 / 3.0, ratio=ratio, accel_x=pulse, overturn=20.0 * alpha)
    return reference_lagrange.solve(case, 25.0 / p, 0.1).outcome


@pytest.mark.parametrize(("omega_over_p", "kind"), [(5.0, "one_sine"), (3.0, "one_cosine"), (1.5, "one_sine")])
def test_every_edge_is_an_edge_of_the_nonlinear_block(omega_over_p: float, kind: str) -> None:
    edges = [e for low, high, _ in overturning_ranges(omega_over_p, RATIO, kind) for e in (low, high) if e < math.inf]  # type: ignore[arg-type]
    assert len(edges) >= 3
    for edge in edges:
        for factor in (1.0 - 2.0 * budget.SLENDER_RELATIVE, 1.0 + 2.0 * budget.SLENDER_RELATIVE):
            linear = pulse_response(edge * factor, omega_over_p, RATIO, kind).overturned  # type: ignore[arg-type]
            side = {0: "ran", 1: "overturned_right", -1: "overturned_left"}[linear]
            assert slender_outcome(edge * factor, omega_over_p, RATIO, kind) == side, (edge, factor)


def test_peak_of_a_block_that_stands() -> None:
    """Against a fine Runge-Kutta integration of the same linearised equation."""
    response = pulse_response(2.5, OMEGA_OVER_P, RATIO)
    assert response.overturned == 0
    x, v, s, t, peak, dt = 0.0, 0.0, 0, 0.0, 0.0, 2e-5

    def push(time: float) -> float:
        return 2.5 * math.sin(OMEGA_OVER_P * time) if time < 2.0 * math.pi / OMEGA_OVER_P else 0.0

    while t < 4.0:
        if s == 0:
            s = (push(t) > 1.0) - (push(t) < -1.0)
        else:
            k1 = x - s + push(t)
            k2 = x + 0.5 * dt * v - s + push(t + 0.5 * dt)
            x, v = x + dt * v + 0.5 * dt * dt * k1, v + dt * k2
            if s * x < 0.0:
                v, s, x = RATIO * v, -s, 0.0
        peak, t = max(peak, abs(x)), t + dt
    assert response.peak_over_alpha == pytest.approx(peak, abs=50.0 * dt)  # impacts are located to one step of dt


def test_spectrum_is_the_first_edge_and_grows_with_frequency() -> None:
    spectrum = minimum_overturning_spectrum([2.0, 5.0, 8.0], RATIO)
    assert spectrum[1] == pytest.approx(overturning_ranges(OMEGA_OVER_P, RATIO)[0][0], rel=1e-14)
    assert np.all(np.diff(spectrum) > 0.0)
    assert np.isnan(minimum_overturning_spectrum([12.0], RATIO)[0])


def test_a_weak_pulse_lifts_nothing() -> None:
    response = pulse_response(1.0, OMEGA_OVER_P, RATIO)
    assert (response.overturned, response.impacts, response.peak_over_alpha) == (0, 0, 0.0)


def test_impossible_numbers_are_refused() -> None:
    for arguments in [(-1.0, 5.0, 0.9), (1.0, 0.0, 0.9), (1.0, 5.0, 1.1), (math.nan, 5.0, 0.9)]:
        with pytest.raises(AnalyticInputError, match="wanted"):
            pulse_response(*arguments)
