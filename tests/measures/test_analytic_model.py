"""The bench's other solvers solve the same problem, its rows are errors and work, and the kernel's work stays bounded."""

from __future__ import annotations

import subprocess
from dataclasses import replace

import numpy as np
import pytest

from analytic import Friction, Harmonic, Pedestal
from analytic.kernel.records import State
from tests import budgets_bench as budgets
from tests.measures import analytic_model as bench
from tests.measures import start
from tests.measures.analytic_model import Answer, Entry, take_turns
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


def test_solvers_of_a_case_take_turns_and_keep_their_least_time() -> None:
    calls: list[str] = []

    def solver(name: str, theta: float) -> Entry:
        def solve() -> Answer:
            calls.append(name)
            return np.array([theta]), len(calls)

        return Entry(name, 1e-6, solve)

    rows = take_turns("block", np.array([9.0, 1.0]), [solver("a", 1.0), solver("b", 1.5)], 3)
    assert calls == ["a", "b"] * 3
    assert [row.error_rad for row in rows] == [0.0, 0.5], "one instant is compared with the last"
    assert all(0.0 <= row.seconds < np.inf for row in rows)


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
    assert run.work.steps <= steps
    assert run.work.taylor_coefficients <= terms


def test_the_kernel_alone_is_the_same_run() -> None:
    task = bench.packed(bench.FORCED, 1e-10)
    task.run()
    assert task.read(State).theta_rad == bench.FORCED.ours(1e-10).theta_rad[-1]


def test_work_of_an_overturning_map() -> None:
    found = bench.throughput(100)
    assert found["two_block"].steps_per_run <= budgets.MAP_STEPS
    assert found["single_block"].steps_per_run <= budgets.MAP_STEPS_ON_FLOOR
    assert bench.map_time(4).overturned > 0.0
    assert found["two_block_certified"].overturned == found["two_block"].overturned


def test_a_missing_integrator_is_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(*_: object) -> None:
        raise ImportError("no heyoka here")

    monkeypatch.setattr(bench, "heyoka_solver", missing)
    entries, rows = bench.taylor()
    assert {entry.solver for entry in entries} == {"analytic, kernel alone"}
    assert {row.failed for row in rows} == {"no heyoka here"}
    assert len(rows) == len(bench.HEYOKA_TOLERANCES)


def test_cases_are_what_they_are_called() -> None:
    assert [case.duration_s for case in bench.CASES] == [10.0, 60.0, 10.0, 60.0]
    assert [isinstance(case.pedestal, Pedestal) for case in bench.CASES] == [False, False, True, True]


def test_a_start_leaves_out_its_first_turn_and_what_others_slow(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first turn writes bytecode and warms the disk; a busy processor slows both imports, or one first call."""
    asked: list[str] = []

    def timed(first: str, second: str) -> tuple[float, float]:
        slow = (0.1, 2.0, 1.0, 3.0)[asked.count(first)]
        asked.append(first)
        if first.startswith("import numpy"):
            return 4.0 * slow, 0.0
        return slow, slow * (1.5 if "analytic as" in first else 3.0)

    monkeypatch.setattr(start, "timed", timed)
    found = start.startup(3)
    assert (found.import_ratio, found.first_call_ratio) == (0.25, 0.5)
    assert (found.import_s, found.first_call_s) == (1.0, 1.5)
    assert asked[:4] == asked[4:8][::-1] == asked[8:12], "one after the other, there and back"


def test_a_start_is_timed_with_bytecode_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")
    seconds = start.timed("import sys; assert not sys.dont_write_bytecode", "")
    assert min(seconds) >= 0.0
    with pytest.raises(subprocess.CalledProcessError):
        start.timed("import sys; assert sys.dont_write_bytecode", "")
