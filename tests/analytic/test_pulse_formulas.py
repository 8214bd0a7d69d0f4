"""Every shape of a pulse has its own formula wherever one is needed; a kind without one is run as no other."""

import math
from typing import Any, get_args

import numpy as np
import pytest

import analytic
from analytic import spatial
from analytic.excitation import PulseShape
from analytic.kernel import codes
from tests.budgets_analytic import SAMPLED_PULSE_RAD

FORGOTTEN = 99
BLOCK = {"width_m": 0.3, "height_m": 0.9, "mass_kg": 200.0}
DURATION_S, SAMPLE_S = 0.9, 1e-4


def solutions(motion: analytic.Excitation) -> tuple[analytic.Solution, spatial.Solution]:
    """Of one block, in the plane and in space."""
    planar = analytic.simulate(analytic.Block.rectangle(**BLOCK), motion, duration_s=DURATION_S, dt_s=0.01)
    body = spatial.Body.block(BLOCK["mass_kg"], BLOCK["width_m"], 0.4, BLOCK["height_m"])
    return planar, spatial.simulate(body, motion, duration_s=DURATION_S, friction_static=math.inf, dt_out_s=0.01)


def rotations(motion: analytic.Excitation) -> tuple[np.ndarray, np.ndarray]:
    """The rotation by both."""
    planar, run = solutions(motion)
    return planar.theta_rad, 2.0 * np.arctan2(run.quaternion_wxyz[:, 2], run.quaternion_wxyz[:, 0])


@pytest.mark.parametrize("shape", get_args(PulseShape))
def test_a_pulse_is_run_as_the_same_motion_sampled(shape: Any) -> None:
    pulse = analytic.Pulse(shape, 7.0, 0.4)
    t_s = np.arange(4001) * SAMPLE_S
    inside = np.clip(t_s, 0.0, 0.4 * (1.0 - 1e-12))
    sampled = analytic.SampledAcceleration(t_s, pulse.accel_m_s2(inside))
    for formula, samples in zip(rotations(pulse), rotations(sampled), strict=True):
        assert np.abs(formula).max() > 1e-3
        assert np.abs(formula - samples).max() <= SAMPLED_PULSE_RAD


def test_a_kind_without_a_formula_is_given_up_and_run_as_no_other(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(codes.PULSES, "one_sine", FORGOTTEN)
    planar, spatially = solutions(analytic.Pulse("one_sine", 4.5, 0.8))
    assert (planar.outcome, planar.counts.given_up) == (analytic.Outcome.UNDECIDED, True)
    assert spatially.outcome is spatial.Outcome.UNDECIDED


def test_a_shape_without_a_formula_has_no_history() -> None:
    pulse = analytic.Pulse("ricker", 4.5, 0.8)
    object.__setattr__(pulse, "shape", "forgotten")
    with pytest.raises(NotImplementedError, match="forgotten"):
        pulse.accel_m_s2(0.1)
