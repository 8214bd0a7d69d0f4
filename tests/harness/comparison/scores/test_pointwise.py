"""Scores sample by sample, against hand computation and against doubles that they must rank."""

import math

import numpy as np
import pytest

from harness.comparison import scores
from harness.model import History, pair
from tests import doubles
from tests.budgets_compare import PEAK_RAD, ROUNDING_REL, TRAPEZOID_REL


def test_rms_of_a_constant_offset_is_the_offset() -> None:
    history = doubles.wave()
    both = pair(doubles.raised(history, 0.003), history)
    assert scores.rms(both, both.difference_rad) == pytest.approx(0.003, rel=ROUNDING_REL)


def test_rms_of_a_sine_against_rest_is_its_amplitude_over_root_two() -> None:
    both = pair(doubles.wave(amplitude_rad=0.05), doubles.rest(4.0))
    assert scores.rms(both, both.difference_rad) == pytest.approx(0.05 / math.sqrt(2.0), rel=TRAPEZOID_REL)


def test_rms_weights_uneven_samples_by_time() -> None:
    """θ = t on 0…1 s: √(1/3) by the integral whatever the samples; a mean over samples would be pulled to the dense end."""
    t = np.sort(np.concatenate((np.linspace(0.0, 0.1, 901), np.linspace(0.1, 1.0, 901)[1:])))
    none, one = np.zeros_like(t), np.ones_like(t)
    both = pair(History(t, t, one, none, none), History(t, none, none, none, none))
    assert scores.rms(both, both.difference_rad) == pytest.approx(math.sqrt(1.0 / 3.0), rel=TRAPEZOID_REL)
    assert abs(math.sqrt(float(np.mean(t**2))) - math.sqrt(1.0 / 3.0)) > 0.1


def test_sprague_geers_by_hand() -> None:
    """A sine scaled by 1.2 and shifted by a twelfth of a period: M = 0.2, P = 1/6, C = √(M² + P²)."""
    t = doubles.wave().t_s
    none = np.zeros_like(t)
    b = History(t, np.sin(2 * np.pi * t), 2 * np.pi * np.cos(2 * np.pi * t), none, none)
    phase = 2 * np.pi / 12
    a = History(t, 1.2 * np.sin(2 * np.pi * t - phase), 2.4 * np.pi * np.cos(2 * np.pi * t - phase), none, none)
    found = scores.sprague_geers(pair(a, b))
    assert found["magnitude"] == pytest.approx(0.2, rel=TRAPEZOID_REL)
    assert found["phase"] == pytest.approx(1.0 / 6.0, rel=TRAPEZOID_REL)
    assert found["combined"] == pytest.approx(math.hypot(0.2, 1.0 / 6.0), rel=TRAPEZOID_REL)


def test_sprague_geers_separates_size_from_time() -> None:
    history = doubles.rocking()
    larger = scores.sprague_geers(pair(doubles.scaled(history, 1.3), history))
    later = scores.sprague_geers(pair(doubles.shifted(history, 0.02), history))
    flipped = scores.sprague_geers(pair(doubles.flipped(history), history))
    assert larger["magnitude"] == pytest.approx(0.3, rel=ROUNDING_REL)
    assert larger["phase"] == pytest.approx(0.0, abs=1e-7)  # acos of 1 − 1e-16 is 1e-8
    assert later["magnitude"] == pytest.approx(0.0, abs=1e-3)  # linear resampling between samples clips the peaks
    assert later["phase"] > 0.01
    assert flipped["phase"] == pytest.approx(1.0)


def test_sprague_geers_of_rest() -> None:
    moving, still = doubles.wave(), doubles.rest(4.0)
    assert [*scores.sprague_geers(pair(still, still)).values()] == [0.0, 0.0, 0.0]
    assert [*scores.sprague_geers(pair(still, moving)).values()] == [-1.0, None, None]
    assert [*scores.sprague_geers(pair(moving, still)).values()] == [None, None, None]


def test_peak_lies_between_samples() -> None:
    """A parabolic arc sampled every 37 ms: the peak 0.1 rad at 0.5 + ω/a, whatever the samples."""
    history = doubles.rocking(dt_s=0.037, amplitude_rad=0.1, accel_rad_s2=4.0)
    found = scores.peak_of(history)
    assert np.max(np.abs(history.theta_rad)) < 0.1 - 1e-5
    assert found.theta_rad == pytest.approx(0.1, abs=PEAK_RAD)
    assert found.time_s == pytest.approx(0.5 + math.sqrt(0.8) / 4.0, abs=PEAK_RAD)


def test_peak_keeps_its_sign() -> None:
    history = doubles.flipped(doubles.rocking())
    assert scores.peak_of(history).theta_rad == pytest.approx(-0.1, abs=PEAK_RAD)


def test_together_ends_where_the_tolerance_is_passed() -> None:
    history = doubles.rocking()
    apart = doubles.parted(history, 2.0, 0.01)
    both = pair(apart, history)
    assert scores.together_until_s(both, 0.005) == pytest.approx(2.5, abs=PEAK_RAD)
    assert scores.together_until_s(both, 0.0801) == both.end_s


@pytest.mark.parametrize("name", sorted(doubles.SPOILT))
def test_more_spoilt_is_worse(name: str) -> None:
    history = doubles.rocking()
    spoil = doubles.SPOILT[name]
    spoilt = [pair(spoil(history, size), history) for size in (0.0, 0.1, 0.3, 1.0)]
    rms = [scores.rms(both, both.difference_rad) for both in spoilt]
    assert rms[0] == 0.0
    assert rms == sorted(rms)
    assert rms[1] > 0.0


def test_pairs_on_different_grids_agree_with_the_same_motion() -> None:
    """The same closed-form motion on 1 ms and on 0.7 ms: a Hermite cubic errs only in the step that holds an impact."""
    a, b = doubles.rocking(dt_s=1e-3), doubles.rocking(dt_s=7e-4)
    both = pair(a, b)
    assert set(both.t_s) == {*b.t_s[b.t_s <= a.duration_s], a.duration_s}
    # In such a step θ is off by at most the jump of rate, 1.9 × 0.9 rad/s, times dt/8.
    assert np.max(np.abs(both.difference_rad)) < 1.9 * 0.9 * 1e-3 / 8


def test_histories_that_do_not_overlap_are_refused() -> None:
    late = doubles.wave()
    late = History(late.t_s + 100.0, late.theta_rad, late.theta_rate_rad_s, late.slip_m, late.slip_rate_m_s)
    with pytest.raises(ValueError, match="do not overlap"):
        pair(late, doubles.wave())


def test_an_early_end_at_rest_is_held() -> None:
    history = doubles.rocking()
    short = doubles.truncated(history, 8.0)
    assert pair(short, history).end_s == short.duration_s
    held = pair(short, history, hold_a=True)
    assert held.end_s == history.duration_s
    assert scores.rms(held, held.difference_rad) == 0.0
