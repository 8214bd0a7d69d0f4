"""The building's filter against closed forms: steady state, step, free decay, two modes, and a rigid building."""

import numpy as np
import pytest

from analytic.excitation import Harmonic, Pulse, SampledAcceleration
from harness.input.motions.process import RING_DOWN, floor_motion, ring_down_s
from harness.input.motions.spec import Oscillator
from tests.budgets_motions import FLOOR_LINES, STEADY_STATE


@pytest.mark.parametrize("ratio", [0.3, 0.9, 1.0, 2.0, 4.0])
def test_the_steady_state_is_the_transmissibility(ratio: float) -> None:
    mode = Oscillator(period_s=0.5, damping=0.08)
    found = floor_motion(Harmonic(2.0, ratio * 2.0), (mode,), 14.0)
    late = np.abs(found.accel_m_s2(np.linspace(12.0, 14.0, 40001))).max()
    damped = (2.0 * 0.08 * ratio) ** 2
    transmitted = np.sqrt((1.0 + damped) / ((1.0 - ratio**2) ** 2 + damped))
    assert late == pytest.approx(2.0 * transmitted, rel=STEADY_STATE)


def test_a_step_is_answered_in_closed_form() -> None:
    mode = Oscillator(period_s=0.4, damping=0.05)
    found = floor_motion(Pulse("rectangular", 3.0, 5.0), (mode,), 4.0)
    w = 2.0 * np.pi / 0.4
    wd = w * np.sqrt(1.0 - 0.05**2)
    t = found.t_s[1:-1]
    exact = 3.0 * (1.0 - np.exp(-0.05 * w * t) * (np.cos(wd * t) - 0.05 * w / wd * np.sin(wd * t)))
    np.testing.assert_allclose(found.samples_m_s2[1:-1], exact, atol=1e-10)
    between = 0.5 * (t[1:] + t[:-1])
    exact = 3.0 * (1.0 - np.exp(-0.05 * w * between) * (np.cos(wd * between) - 0.05 * w / wd * np.sin(wd * between)))
    np.testing.assert_allclose(found.accel_m_s2(between), exact, atol=3.0 * FLOOR_LINES)


def test_modes_add_up_with_their_shares() -> None:
    ground = SampledAcceleration(0.02 * np.arange(200), np.random.default_rng(1).normal(size=200))
    one, two = Oscillator(period_s=0.5, share=1.3), Oscillator(period_s=0.15, damping=0.03, share=-0.4)
    both = floor_motion(ground, (one, two), 6.0)
    t = both.t_s[2:-2]
    alone = [floor_motion(ground, (mode.model_copy(update={"share": 1.0}),), 6.0).accel_m_s2(t) for mode in (one, two)]
    wanted = (1.0 - 0.9) * ground.accel_m_s2(t) + 1.3 * alone[0] - 0.4 * alone[1]
    scale = float(np.abs(wanted).max())
    smooth = np.abs(t - ground.end_s) > 1e-6  # there the ground's last sample drops to zero
    found = both.samples_m_s2[2:-2]
    np.testing.assert_allclose(found[smooth], wanted[smooth], atol=scale * 2.0 * FLOOR_LINES)


def test_a_stiff_building_moves_as_the_ground() -> None:
    ground = SampledAcceleration(0.02 * np.arange(400), np.sin(2.0 * np.pi * 1.0 * 0.02 * np.arange(400)))
    found = floor_motion(ground, (Oscillator(period_s=0.02, damping=0.5),), 7.0)
    t = np.linspace(0.5, 6.5, 500)
    np.testing.assert_allclose(found.accel_m_s2(t), ground.accel_m_s2(t), atol=0.01)


def test_jumps_of_the_rigid_remainder_are_kept() -> None:
    found = floor_motion(Pulse("rectangular", 2.0, 1.0, 0.5), (Oscillator(period_s=0.5, share=0.25),), 3.0)
    before, after = found.accel_m_s2(0.5 - 1e-6), found.accel_m_s2(0.5 + 1e-6)
    assert float(after - before) == pytest.approx(1.5, abs=1e-3)


def test_the_floor_is_followed_until_it_has_level_down() -> None:
    mode = Oscillator(period_s=0.5, damping=0.05)
    until = 1.0 + ring_down_s((mode,))
    found = floor_motion(Pulse("one_sine", 2.0, 1.0), (mode,), until)
    peak = found.peak_m_s2
    last = np.abs(found.samples_m_s2[found.t_s > until - 0.5]).max()
    assert 0.1 * RING_DOWN * peak < last < 5.0 * RING_DOWN * peak
