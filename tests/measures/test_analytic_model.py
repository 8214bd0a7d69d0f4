"""The bench's other solvers solve the same problem, its rows are errors and work, and the kernel's work stays bounded."""

from dataclasses import replace

import numpy as np
import pytest

from analytic import Friction, Harmonic
from tests import budgets_bench as budgets
from tests.measures import analytic_model as bench
from tests.measures.reference_integrators import Model, heyoka_solver, scipy_run

SHORT = [replace(case, duration_s=2.5 if case.duration_s == 10.0 else 7.0) for case in bench.CASES]


@pytest.mark.parametrize("case", SHORT, ids=lambda case: case.name)
def test_scipy_solves_the_same_problem(case: bench.Case) -> None:
    ours, theirs = case.ours(1e-12).theta_rad[1:], bench.scipy_of(case, 1e-10)[0]
    assert np.abs(ours).max() > 0.0
    assert np.abs(ours - theirs).max() <= budgets.OTHER_INTEGRATOR_RAD


def test_shorter_steps_bring_scipy_to_an_error_that_its_tolerance_does_not() -> None:
    exact = bench.FORCED.ours(bench.REFERENCE_RAD).theta_rad[1:]
    free, held = (bench.scipy_of(bench.FORCED, 1e-10, longest_step_s=cap)[0] for cap in (np.inf, 0.05))
    assert np.abs(held - exact).max() <= 1e-9 < np.abs(free - exact).max()
    assert (1e-10, False, 0.05) in bench.SCIPY_HARMONIC


def test_a_wrong_integrator_is_seen() -> None:
    case = SHORT[2]
    assert isinstance(case.motion, Harmonic)
    stiff = Model.of(case.block, case.pedestal, Friction(case.friction.static, 0.9 * case.friction.kinetic))
    amplitude, omega = case.motion.amplitude_m_s2, case.motion.omega_rad_s
    theirs, _ = scipy_run(stiff, lambda t: amplitude * float(np.sin(omega * t)), 0.0, case.at_s, 1e-9, 0.01)
    assert np.abs(case.ours(1e-12).theta_rad[1:] - theirs).max() > 100.0 * budgets.OTHER_INTEGRATOR_RAD


def test_heyoka_solves_the_same_problem() -> None:
    pytest.importorskip("heyoka")
    case = bench.FORCED
    assert isinstance(case.motion, Harmonic)
    theirs, steps = heyoka_solver(case.block, case.motion, case.theta0_rad, case.duration_s, 1e-10)()
    assert steps > 0
    assert abs(theirs[0] - case.ours(1e-12).theta_rad[-1]) <= budgets.OTHER_INTEGRATOR_RAD


@pytest.mark.parametrize("tolerance", [1e-6, 1e-9])
@pytest.mark.parametrize("case", bench.CASES, ids=lambda case: case.name)
def test_work_and_error_of_the_kernel(case: bench.Case, tolerance: float) -> None:
    run, exact = case.ours(tolerance), case.ours(bench.REFERENCE_RAD)
    assert np.abs(run.theta_rad - exact.theta_rad).max() <= tolerance
    steps, terms = budgets.KERNEL_WORK[case.name][tolerance]
    assert run.counts.steps <= steps
    assert run.counts.coefficients <= terms


def test_work_of_an_overturning_map() -> None:
    found = bench.throughput(100)
    assert found["two_block"].steps_per_run <= budgets.MAP_STEPS
    assert found["single_block"].steps_per_run <= budgets.MAP_STEPS_ON_FLOOR
    assert bench.map_time(4).overturned > 0.0
    assert found["two_block_certified"].overturned == found["two_block"].overturned
