"""Many runs at once: the same as one by one, whatever the number of threads."""

from typing import Any

import numpy as np
import pytest

from analytic import AnalyticInputError, Harmonic, Outcome, Pulse, Record, Wall, ensemble, simulate
from analytic.sweep import ACCURACY_RAD, SWEEPABLE
from tests.analytic.paestum import GRAVITY, PEDESTAL, STATUE

ON_PEDESTAL = {"pedestal": PEDESTAL, "floor_static": 0.20, "floor_kinetic": 0.15}
AMPLITUDES = np.array([0.1, 0.3, 0.5]) * GRAVITY
FREQUENCIES = np.array([1.0, 2.0, 4.0, 7.0])


def test_each_run_is_the_single_run() -> None:
    found = ensemble(
        STATUE,
        Harmonic(1.0, 1.0),
        sweep={"amplitude_m_s2": AMPLITUDES[:, None], "frequency_hz": FREQUENCIES},
        duration_s=5.0,
        **ON_PEDESTAL,
    )
    assert found.codes.shape == (3, 4)
    for i, amplitude in enumerate(AMPLITUDES):
        for j, frequency in enumerate(FREQUENCIES):
            motion = Harmonic(float(amplitude), float(frequency))
            alone = simulate(
                STATUE,
                motion,
                duration_s=5.0,
                accuracy_rad=1e-6,
                dt_s=None,
                events=False,
                validity=False,
                **ON_PEDESTAL,
            )  # type: ignore[arg-type]
            assert found.outcomes[i, j] == alone.outcome
            assert found.peak_theta_rad[i, j] == alone.peak_theta_rad
            assert found.steps[i, j] == alone.counts.steps
            assert found.end_s[i, j] == alone.end_s


def test_one_coefficient_for_rest_and_motion_leaves_no_run_without_a_joint_state() -> None:
    """Where the pedestal begins to slide nothing jumps then: an onset found to 1e-6 rad must still stick or slide."""
    rng = np.random.default_rng(21)
    mu = 0.15 * np.exp(0.15 * rng.standard_normal(400))
    sweep = {"floor_static": mu, "floor_kinetic": mu, "amplitude_m_s2": rng.uniform(3.0, 5.0, 400)}
    found = ensemble(STATUE, Harmonic(1.0, 3.0), sweep=sweep, duration_s=10.0, pedestal=PEDESTAL)
    ends = {str(outcome) for outcome in found.outcomes}
    assert ends <= {"stands", "overturned_right", "overturned_left", "undecided"}
    assert 0.1 < found.overturned.mean() < 0.9


def test_a_pedestal_that_slides_at_its_statue_s_own_friction_does_not_shake_it_off() -> None:
    """It hands on just the friction under the statue: what rounding adds leaves no domain, what a coefficient lacks does."""
    mu = np.array([0.05, 0.05, 0.07])
    sweep = {"floor_static": mu, "floor_kinetic": mu, "statue_friction": mu * [1.0, 1.0 - 1e-6, 1.0]}
    shaken, lifted = Harmonic(4.0, 1.7), Harmonic(2.0, 3.1)
    found = ensemble(STATUE, shaken, lifted, sweep=sweep, duration_s=5.0, domain=True, pedestal=PEDESTAL)
    assert (found.peak_slip_m > 0.1).all()
    assert np.isfinite(found.left_domain_s).tolist() == [False, True, False]
    alone = simulate(
        STATUE,
        shaken,
        lifted,
        duration_s=5.0,
        pedestal=PEDESTAL,
        statue_friction=0.05,
        floor_static=0.05,
        floor_kinetic=0.05,
    )
    assert alone.validity.left_domain_s is None


def test_threads_change_no_bit() -> None:
    rng = np.random.default_rng(5)
    sweep = {
        "amplitude_m_s2": rng.uniform(0.5, 6.0, 200),
        "phase_rad": rng.uniform(0.0, 6.0, 200),
        "corner_right_m": rng.uniform(0.05, 0.2, 200),
        "floor_kinetic": rng.uniform(0.05, 0.2, 200),
    }
    runs = [
        ensemble(STATUE, Harmonic(1.0, 2.0), sweep=sweep, duration_s=3.0, threads=threads, **ON_PEDESTAL)
        for threads in (1, 3)
    ]
    assert np.array_equal(runs[0].peak_theta_rad, runs[1].peak_theta_rad)
    assert np.array_equal(runs[0].codes, runs[1].codes)
    assert np.array_equal(runs[0].overturn_time_s, runs[1].overturn_time_s, equal_nan=True)
    assert runs[0].overturned.any()
    assert (runs[0].outcomes == Outcome.STANDS).any()


def test_records_are_scaled() -> None:
    times = np.arange(0.0, 4.0, 0.01)
    record = Record(times, np.sin(9.0 * times))
    scales = np.array([0.5, 1.5, 3.0, 4.5])
    found = ensemble(STATUE, record, sweep={"scale": scales}, duration_s=5.0)
    for scale, peak in zip(scales, found.peak_theta_rad, strict=True):
        alone = simulate(STATUE, record.scaled(float(scale)), duration_s=5.0, accuracy_rad=1e-6, dt_s=None)
        assert peak == pytest.approx(alone.peak_theta_rad, rel=1e-6, abs=1e-12)
    assert found.peak_theta_rad[0] == 0.0
    assert (np.diff(found.peak_theta_rad) > 0.0).any()


def test_progress_hears_of_every_run() -> None:
    heard: list[tuple[int, int]] = []
    ensemble(
        STATUE,
        Pulse("one_sine", 1.0, 0.5),
        sweep={"amplitude_m_s2": np.linspace(-6.0, 6.0, 100)},
        duration_s=2.0,
        progress=lambda done, total: heard.append((done, total)),
    )
    assert heard[-1] == (100, 100)
    assert [done for done, _ in heard] == sorted(done for done, _ in heard)


@pytest.mark.parametrize(
    ("sweep", "sentence"),
    [
        ({}, "wanted"),
        ({"amplitud": [1.0]}, "amplitud"),
        ({"mass_kg": [-1.0]}, "positive"),
        ({"frequency_hz": [np.nan]}, "finite"),
        ({"floor_kinetic": [0.5]}, "floor_static"),
        ({"theta0_rad": [2.0]}, "overturning"),
    ],
)
def test_wrong_iterations_are_refused(sweep: dict[str, list[float]], sentence: str) -> None:
    with pytest.raises(AnalyticInputError, match=sentence):
        ensemble(STATUE, Harmonic(1.0, 1.0), sweep=sweep, duration_s=1.0)


def test_every_sweepable_name_is_taken() -> None:
    values = {"mass_kg": 700.0, "duration_s": 1.0, "restitution": 0.9, "theta0_rad": 0.01, "pedestal_mass_kg": 200.0}
    for name in SWEEPABLE:
        found = ensemble(
            STATUE, Harmonic(2.0, 2.0), sweep={name: [values.get(name, 0.16)]}, duration_s=0.5, **ON_PEDESTAL
        )
        assert found.codes.shape == (1,)


def test_walls_and_the_coefficient_at_an_impact_are_those_of_single_runs() -> None:
    wall = Wall("left", 0.1, ((-0.3585, 1.46), (0.0682, 1.46)))
    scene: Any = ON_PEDESTAL | {"wall": wall, "duration_s": 4.0}
    acts, amplitude = np.array([0.15, 0.18, 0.20])[:, None], np.array([2.0, 3.3, 4.2])
    found = ensemble(STATUE, Harmonic(1.0, 2.0), sweep={"floor_impact": acts, "amplitude_m_s2": amplitude}, **scene)
    for (i, j), code in np.ndenumerate(found.outcomes):
        motion, own = Harmonic(amplitude[j], 2.0), float(acts[i, 0])
        alone = simulate(
            STATUE, motion, floor_impact=own, accuracy_rad=ACCURACY_RAD, dt_s=None, validity=False, **scene
        )
        assert (code, found.end_s[i, j]) == (alone.outcome, alone.end_s)
    assert (found.outcomes == Outcome.TOUCHES_WALL).sum() >= 2
    static = ensemble(STATUE, Harmonic(3.3, 2.0), sweep={"floor_static": [0.2, 0.25]}, floor_impact="static", **scene)
    assert static.end_s[0] == found.end_s[2, 1]
    with pytest.raises(AnalyticInputError, match="floor_impact"):
        ensemble(STATUE, Harmonic(3.3, 2.0), sweep={"floor_impact": [0.21]}, **scene)
    with pytest.raises(AnalyticInputError, match="corners"):
        ensemble(STATUE, Harmonic(3.3, 2.0), sweep={"corner_left_m": [0.3]}, **scene)
