"""The analytic model against public integrators on the same scenes, and its throughput.

Errors are the largest difference of θ from a run of 1e-13 at twenty instants of the scene; times are processor time, the least
of many runs, in which solvers of a like cost take turns. A solver that is not installed is a row that says so.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic import (
    Block,
    Excitation,
    Friction,
    Harmonic,
    Pedestal,
    SampledAcceleration,
    ZeroExcitation,
    ensemble,
    simulate,
)
from analytic.block import GRAVITY_M_S2
from analytic.problem import Options, Problem, encode
from analytic.solver import Prepared, prepare
from analytic.sweep import body_of, certify_rows
from harness.questions.bench.parts import Cost, cost, costs
from tests.measures.reference_integrators import Model, heyoka_solver, scipy_run

COLUMN: Final = Block.rectangle(width_m=0.5, height_m=2.0, mass_kg=1000.0)
STATUE: Final = Block.two_corners(
    mass_kg=707.0, centroid_height_m=0.774, inertia_kg_m2=152.4, corner_left_m=0.3585, corner_right_m=0.0682
)
FRICTIONLESS: Final = Friction(0.0, 0.0)
REFERENCE_RAD: Final = 1e-13
REPEATS: Final = 5
INSTANTS: Final = 20
RECORD_STEP_S: Final = 0.01
"""Sampling of the record of 60 s."""

Answer = tuple[NDArray[np.float64], int]
"""θ at a case's instants, or at the last of them, rad, and the work by the solver's own measure."""


@dataclass(frozen=True)
class SolverRow:
    """One setting of a solver on a case: its error against the exact θ, rad, and the least processor time of all rounds, s."""

    case: str
    solver: str
    tolerance: float
    how: str = ""
    work: int = 0
    error_rad: float | None = None
    seconds: float | None = None
    failed: str | None = None


@dataclass(frozen=True)
class Throughput:
    """Outcome-only runs of a map over amplitude and frequency: how many, how fast, their steps, the share that overturned."""

    runs: int
    threads: int
    wall_s: float
    cpu_s: float
    runs_per_s: float
    runs_per_core_s: float
    steps_per_run: float
    us_per_step: float
    overturned: float


class Entry(NamedTuple):
    """What is timed of a solver, and how it is set beyond its tolerance."""

    solver: str
    tolerance: float
    solve: Callable[[], Answer]
    how: str = ""


def take_turns(case: str, exact: NDArray[np.float64], entries: Sequence[Entry], rounds: int) -> list[SolverRow]:
    """A row for each entry."""
    answers: dict[int, Answer] = {}

    def solve(i: int) -> None:
        answers[i] = entries[i].solve()

    spent = costs([partial(solve, i) for i in range(len(entries))], rounds, float("inf"))
    rows = []
    for i, entry in enumerate(entries):
        theta, work = answers[i]
        error = float(np.abs(theta - exact[-theta.size :]).max())
        rows.append(SolverRow(case, entry.solver, entry.tolerance, entry.how, work, error, spent[i].cpu_s))
    return rows


def record_60s(peak_m_s2: float, seed: int) -> SampledAcceleration:
    """Smoothed noise under the envelope (t/8) exp(1 − t/8), 60 s, always the same."""
    t = np.arange(6001) * RECORD_STEP_S
    noise = np.convolve(np.random.default_rng(seed).normal(size=t.size), np.hanning(15), "same")
    shaped = noise * (t / 8.0) * np.exp(1.0 - t / 8.0)
    return SampledAcceleration(t, peak_m_s2 / np.abs(shaped).max() * shaped)


@dataclass(frozen=True)
class Case:
    """One scene on which solvers are compared: errors must not be amplified by chance, so that every one can be exact."""

    name: str
    block: Block
    motion: Excitation
    duration_s: float
    pedestal: Pedestal | None = None
    friction: Friction = FRICTIONLESS
    theta0_rad: float = 0.0

    @property
    def at_s(self) -> NDArray[np.float64]:
        """Instants of comparison."""
        return np.linspace(0.0, self.duration_s, INSTANTS + 1)[1:]

    def ours(self, tolerance: float, **options: Any) -> Any:
        """The analytic model's run."""
        settings: dict[str, Any] = {"events": False, "validity": False, "dt_s": self.duration_s / INSTANTS}
        return simulate(
            self.block, self.motion, pedestal=self.pedestal, floor_static=self.friction.static,
            floor_kinetic=self.friction.kinetic, theta0_rad=self.theta0_rad, duration_s=self.duration_s,
            gravity_m_s2=GRAVITY_M_S2, accuracy_rad=tolerance, **(settings | options),
        )  # fmt: skip


FORCED: Final = Case("block, harmonic", COLUMN, Harmonic(0.28 * GRAVITY_M_S2, 1.1), 10.0, theta0_rad=0.05)
CASES: Final = (
    FORCED,
    Case("block, record of 60 s", COLUMN, record_60s(0.4 * GRAVITY_M_S2, 4), 60.0),
    Case(
        "two blocks, harmonic",
        COLUMN,
        Harmonic(0.4 * GRAVITY_M_S2, 2.0),
        10.0,
        Pedestal(500.0, 0.8, 0.2),
        Friction(0.3, 0.25),
    ),
    Case(
        "two blocks, record of 60 s",
        STATUE,
        record_60s(0.3 * GRAVITY_M_S2, 3),
        60.0,
        Pedestal(250.0, 0.6, 0.2),
        Friction(0.2, 0.15),
    ),
)
OUR_TOLERANCES: Final = (1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-12)
SCIPY_HARMONIC: Final = (
    *((tolerance, False, math.inf) for tolerance in (1e-7, 1e-9, 1e-10, 1e-11, 1e-13)),
    *((tolerance, False, 0.05) for tolerance in (1e-8, 1e-10, 1e-13)),
)
SCIPY_RECORD: Final = tuple(
    (tolerance, stops, math.inf) for tolerance, stops in ((1e-7, False), (1e-9, False), (1e-9, True), (1e-11, True))
)
"""Tolerances, whether no step crosses a kink of the record, and the longest step, s."""
HEYOKA_TOLERANCES: Final = (1e-8, 1e-10, 1e-12)


def _ours(case: Case, tolerance: float) -> Answer:
    solution = case.ours(tolerance)
    return solution.theta_rad[1:], solution.counts.steps


def scipy_of(case: Case, tolerance: float, stops: bool = False, longest_step_s: float = math.inf) -> Answer:
    """DOP853's run of a case, stopping at the kinks of its record or not."""
    model = Model.of(case.block, case.pedestal, case.friction)
    motion, stops_s = case.motion, None
    if isinstance(motion, SampledAcceleration):
        # a float and two lists: numpy's own interpolation costs ten times the sum that it replaces
        stops_s = motion.t_s if stops else None
        a = [*motion.samples_m_s2.tolist(), 0.0, 0.0]

        def accel(t: float) -> float:
            i = int(t / RECORD_STEP_S)
            return float(a[i] + (a[i + 1] - a[i]) * (t / RECORD_STEP_S - i))

    else:
        assert isinstance(motion, Harmonic)
        amplitude, omega = motion.amplitude_m_s2, motion.omega_rad_s

        def accel(t: float) -> float:
            return amplitude * math.sin(omega * t)

    return scipy_run(model, accel, case.theta0_rad, case.at_s, tolerance, RECORD_STEP_S, stops_s, longest_step_s)


def _setting_words(stops: bool, longest_step_s: float) -> str:
    """How scipy is set, in words."""
    held = f"steps up to {longest_step_s:g} s" if longest_step_s < math.inf else ""
    return "stopping at kinks" if stops else held


def measure(repeats: int = REPEATS) -> list[SolverRow]:
    """A row for each setting of all scenes and solvers."""
    rows: list[SolverRow] = []
    for case in CASES:
        exact = _ours(case, REFERENCE_RAD)[0]
        quick = [Entry("analytic", each, partial(_ours, case, each)) for each in OUR_TOLERANCES]
        if case is FORCED:
            others, absent = taylor()
            quick, rows = [*quick, *others], [*rows, *absent]
        rows += take_turns(case.name, exact, quick, 40 * repeats)
        on_record = isinstance(case.motion, SampledAcceleration)
        slow = [
            Entry("scipy DOP853", setting[0], partial(scipy_of, case, *setting), _setting_words(*setting[1:]))
            for setting in (SCIPY_RECORD if on_record else SCIPY_HARMONIC)
        ]
        # a record costs seconds: the first call's import is lost in them, and spent on the scene before
        rows += take_turns(case.name, exact, slow, 1 if on_record else repeats)
    return rows


def taylor() -> tuple[list[Entry], list[SolverRow]]:
    """The single block under its harmonic motion by heyoka, built and compiled beforehand, and by the kernel alone, packed
    beforehand: the integration and nothing else; and a row for each that is not installed. θ at the last instant only:
    neither keeps a history."""
    entries: list[Entry] = []
    absent = []
    for tolerance in HEYOKA_TOLERANCES:
        task = packed(FORCED, tolerance)

        def kernel(task: Prepared = task) -> Answer:
            state, _, counts = task.run()
            return np.array([state.theta_rad]), counts.steps

        entries.append(Entry("analytic, kernel alone", tolerance, kernel))
        assert isinstance(FORCED.motion, Harmonic)
        try:
            other = heyoka_solver(FORCED.block, FORCED.motion, FORCED.theta0_rad, FORCED.duration_s, tolerance)
            entries.append(Entry("heyoka", tolerance, other))
        except ImportError as error:
            absent.append(SolverRow(FORCED.name, "heyoka", tolerance, failed=str(error)))
    return entries, absent


def packed(case: Case, tolerance: float) -> Prepared:
    """The kernel's task of a case, for the outcome only."""
    problem = Problem(
        case.block,
        case.motion,
        ZeroExcitation(),
        case.duration_s,
        case.pedestal,
        case.friction.static,
        case.friction.kinetic,
        theta0_rad=case.theta0_rad,
        gravity_m_s2=GRAVITY_M_S2,
    )
    return prepare(problem, encode(problem, Options(accuracy_rad=tolerance, dt_s=None, validity=False)), 0)


def _map(size: int, pedestal: bool) -> dict[str, Any]:
    """An overturning map of the paper's statue: sweep and scene."""
    sweep = {
        "amplitude_m_s2": np.linspace(0.05, 0.8, size)[:, None] * GRAVITY_M_S2,
        "frequency_hz": np.linspace(0.5, 8.0, size)[None, :],
    }
    scene = {"pedestal": Pedestal(250.0, 0.6, 0.2), "floor_static": 0.2, "floor_kinetic": 0.15} if pedestal else {}
    return {"sweep": sweep, "duration_s": 10.0, **scene}


def outcomes(size: int, pedestal: bool, threads: int, repeats: int) -> Throughput:
    """A size × size map of outcomes of 10 s at 1e-6 over amplitude and frequency, of the paper's statue; the least of several."""
    ensemble(STATUE, Harmonic(1.0, 1.0), **_map(1, pedestal))
    call = partial(ensemble, STATUE, Harmonic(1.0, 1.0), threads=threads, **_map(size, pedestal))
    spent, result = cost(call, repeats, math.inf), call()
    return _rate(spent, size * size, threads, float(result.steps.sum()), float(result.overturned.mean()))


def certified_outcomes(size: int, repeats: int) -> Throughput:
    """The same map on a pedestal, each run with the one that checks it and its doubt flag."""
    scene = _map(size, True)
    pairs = np.broadcast_arrays(*scene["sweep"].values())
    still = ZeroExcitation()
    motions = [(Harmonic(float(a), float(f)), still) for a, f in zip(*(each.ravel() for each in pairs), strict=True)]
    problem = Problem(
        STATUE, *motions[0], scene["duration_s"], scene["pedestal"], scene["floor_static"], scene["floor_kinetic"],
        gravity_m_s2=GRAVITY_M_S2,
    )  # fmt: skip
    call = partial(certify_rows, [body_of(problem, 1e-6)], np.zeros(size * size, np.int64), motions, 1e-3)
    spent, first = cost(call, repeats, math.inf), call().first
    overturned = float(np.mean(np.isfinite(first.results["overturn_time_s"])))
    return _rate(spent, size * size, 1, float(first.counts["steps"].sum()), overturned)


def _rate(spent: Cost, runs: int, threads: int, steps: float, overturned: float) -> Throughput:
    return Throughput(
        runs, threads, spent.wall_s, spent.cpu_s, runs / spent.wall_s, runs / spent.cpu_s, steps / runs,
        1e6 * spent.cpu_s / steps, overturned,
    )  # fmt: skip


def throughput(runs: int = 2000, threads: int = 1, repeats: int = REPEATS) -> dict[str, Throughput]:
    """Outcomes with the pedestal, without it, and with it and their doubt flags."""
    side = max(math.isqrt(runs), 1)
    bare = {name: outcomes(side, on, threads, repeats) for name, on in (("two_block", True), ("single_block", False))}
    return bare | {"two_block_certified": certified_outcomes(side, repeats)}


def map_time(size: int = 200, threads: int = 2) -> Throughput:
    """One size × size overturning map on a pedestal: seconds by the clock, and of the processor in all threads."""
    return outcomes(size, True, threads, 1)
