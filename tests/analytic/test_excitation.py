"""Each motion's integrals against quadrature, its ends and breaks, what it rejects; a pulse is run by its own formula."""

import itertools
import math
from typing import Any, get_args

import numpy as np
import pytest

import analytic
from analytic import spatial
from analytic.block import AnalyticInputError
from analytic.excitation import Excitation, Harmonic, Pulse, PulseShape, Record, Rest
from analytic.kernel import records
from tests.budgets_analytic import QUADRATURE_REL, SAMPLED_PULSE_RAD

MOTIONS: list[Excitation] = [
    Rest(),
    Harmonic(2.0, 1.5),
    Harmonic(2.0, 1.5, phase_rad=0.7),
    Harmonic(-2.0, 1.5, phase_rad=0.7, ramp_s=0.8),
    *(Pulse(shape, 3.0, 0.5, 0.25) for shape in get_args(PulseShape)),
    Pulse("ricker", 3.0, 1.5, 0.25),
    Record([0.25, 0.5, 1.0, 1.25], [1.0, -2.0, 3.0, 0.5]),
]


def _cumulative(values: np.ndarray, t: np.ndarray) -> np.ndarray:
    return np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(t))])


@pytest.mark.parametrize("motion", MOTIONS, ids=repr)
def test_integrals_follow_the_acceleration(motion: Excitation) -> None:
    edges = [0.0, *motion.breaks_s(2.0), 2.0]
    v0 = d0 = 0.0
    for start, end in itertools.pairwise(edges):
        t = np.linspace(start, end, 200_001)
        inner = np.clip(t, start + 1e-13, end - 1e-13)  # the one-sided value at a jump
        velocity = v0 + _cumulative(motion.accel_m_s2(inner), t)
        displacement = d0 + _cumulative(velocity, t)
        scale = QUADRATURE_REL * max(motion.peak_m_s2, 1e-300)
        np.testing.assert_allclose(motion.velocity_m_s(t), velocity, rtol=0, atol=scale)
        np.testing.assert_allclose(motion.displacement_m(t), displacement, rtol=0, atol=scale)
        assert motion.velocity_at(t[70_001]) == pytest.approx(float(motion.velocity_m_s(t[70_001])), rel=0, abs=scale)
        v0, d0 = velocity[-1], displacement[-1]


@pytest.mark.parametrize("motion", MOTIONS, ids=repr)
def test_is_zero_after_its_end_and_scales(motion: Excitation) -> None:
    if math.isfinite(motion.end_s):
        assert motion.accel_m_s2(motion.end_s + 1e-9) == 0.0
    t = np.linspace(0.0, 2.0, 101)
    assert np.array_equal(motion.scaled(-2.0).accel_m_s2(t), -2.0 * motion.accel_m_s2(t))
    assert motion.scaled(-2.0).peak_m_s2 == 2.0 * motion.peak_m_s2
    assert np.abs(motion.accel_m_s2(t)).max() <= motion.peak_m_s2


def test_breaks_are_where_the_acceleration_is_not_smooth() -> None:
    assert Harmonic(1.0, 1.0).breaks_s(9.0).size == 0
    assert list(Harmonic(1.0, 1.0, ramp_s=2.0).breaks_s(9.0)) == [2.0]
    assert list(Pulse("one_sine", 1.0, 0.5).breaks_s(9.0)) == [0.5]
    assert list(Record([0.0, 1.0, 2.0], [0.0, 1.0, 0.0]).breaks_s(2.0)) == [1.0]


def test_jumps_are_the_breaks_at_which_the_acceleration_itself_changes() -> None:
    assert list(Pulse("rectangular", 1.0, 0.5, 0.218).jumps_s(9.0)) == [0.218, 0.718]
    assert list(Pulse("one_cosine", -1.0, 0.5, 0.1).jumps_s(9.0)) == [0.1, 0.6]
    assert Pulse("one_sine", 1.0, 0.5, 0.1).jumps_s(9.0).size == 0
    assert Pulse("ricker", 1.0, 0.5, 0.1).jumps_s(9.0).size == 0
    assert Harmonic(1.0, 1.0, ramp_s=2.0).jumps_s(9.0).size == 0
    assert list(Record([0.1, 1.0, 2.0], [0.5, 1.0, 0.0]).jumps_s(9.0)) == [0.1]
    assert list(Record([0.1, 1.0, 2.0], [0.0, 1.0, -0.2]).jumps_s(9.0)) == [2.0]
    assert Record([0.0, 1.0, 2.0], [0.0, 1e6, 0.0]).jumps_s(9.0).size == 0


def test_record_keeps_its_own_read_only_copy() -> None:
    t, a = np.array([0.0, 1.0]), np.array([1.0, 2.0])
    record = Record(t, a)
    a[0] = 9.0
    assert record.samples_m_s2[0] == 1.0
    with pytest.raises(ValueError, match="read-only"):
        record.samples_m_s2[0] = 3.0
    assert record == Record(t, [1.0, 2.0])
    assert record != Record(t, [1.0, 3.0])
    assert hash(record) == hash(Record(t, [1.0, 2.0]))


@pytest.mark.parametrize(
    ("wrong", "sentence"),
    [
        (lambda: Record([0.0, 0.0], [1.0, 1.0]), "sample 1 is at 0.0 s"),
        (lambda: Record([-1.0, 0.0], [1.0, 1.0]), "sample 0"),
        (lambda: Record([0.0, 1.0], [1.0, math.nan]), "sample 1"),
        (lambda: Record([0.0], [1.0]), "at least 2"),
        (lambda: Harmonic(1.0, 0.0), "frequency_hz"),
        (lambda: Harmonic(math.inf, 1.0), "amplitude_m_s2"),
        (lambda: Harmonic(1.0, 1.0, ramp_s=-1.0), "ramp_s"),
        (lambda: Pulse("square", 1.0, 1.0), "rectangular"),
        (lambda: Pulse("one_sine", 1.0, 0.0), "duration_s"),
    ],
)
def test_rejects_what_is_no_motion(wrong: object, sentence: str) -> None:
    assert callable(wrong)
    with pytest.raises(AnalyticInputError, match=sentence):
        wrong()


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
    monkeypatch.setitem(records.PULSES, "one_sine", FORGOTTEN)
    planar, spatially = solutions(analytic.Pulse("one_sine", 4.5, 0.8))
    assert (planar.outcome, planar.counts.given_up) == (analytic.Outcome.UNDECIDED, True)
    assert spatially.outcome is spatial.Outcome.UNDECIDED


def test_a_shape_without_a_formula_has_no_history() -> None:
    pulse = analytic.Pulse("ricker", 4.5, 0.8)
    object.__setattr__(pulse, "shape", "forgotten")
    with pytest.raises(NotImplementedError, match="forgotten"):
        pulse.accel_m_s2(0.1)
