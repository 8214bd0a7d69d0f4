"""One run of the two-block model: a problem in, a frozen solution out; between them the memory of its task; its certificate."""

import ctypes
import math
from dataclasses import dataclass, fields
from typing import Any, Final, Literal, NamedTuple, final

import numpy as np
from numpy.typing import NDArray

from analytic.block import GRAVITY_M_S2, OVERTURN_RAD, Block, Form, Pedestal, Wall
from analytic.excitation import Excitation, Floats, ZeroExcitation
from analytic.kernel.records import (
    EVENT_ROW,
    MOTION_PARAMS,
    TASK,
    Base,
    Counts,
    Motion,
    MotionParams,
    Output,
    Params,
    Records,
    Results,
    State,
    layout,
    packing,
)
from analytic.machine_code import Entry
from analytic.problem import (
    CONSISTENT,
    DEFAULT_OPTIONS,
    NO_EVENTS,
    NO_HISTORY,
    OUTCOMES,
    CommonKeywords,
    Options,
    Outcome,
    Problem,
    Solution,
    encode,
    encode_base,
    encode_motion,
)

run: Final = Entry("analytic.kernel.integrator", "run")


def address(memory: bytearray | NDArray[np.generic]) -> int:
    """Where it stands, for as long as it lives; numpy itself takes a microsecond to say so."""
    return ctypes.addressof(ctypes.c_char.from_buffer(memory))  # type: ignore[arg-type]


_OWN: Final = layout(Motion).itemsize - MOTION_PARAMS.itemsize
"""Bytes of a motion that are the run's own."""
_READ: Final = packing(Params, Base, MotionParams, _OWN, MotionParams, _OWN, Output)
"""What a run reads: a task begins with it."""
_LEFT: Final = packing(State, Results, Counts)
"""What it leaves behind: in a task it follows."""
_STATE, _RESULTS = (len(fields(each)) for each in (State, Results))


class Prepared(NamedTuple):
    """The memory of a task, and what it knows by address only."""

    memory: bytearray
    history: NDArray[np.float64]
    """Rows of t, θ, θ̇, u, u̇, (5, n)."""
    events: Records
    """(m,)"""
    owners: tuple[object, ...]
    """Whose numbers motions and base name by address: kept alive."""

    def run(self) -> tuple[State, Results, Counts]:
        """Run the task; what it leaves behind."""
        run(address(self.memory), 0)
        left = _LEFT.unpack_from(self.memory, _READ.size)
        state, results, counts = left[:_STATE], left[_STATE : _STATE + _RESULTS], left[_STATE + _RESULTS :]
        return State(*state), Results(*results), Counts(*counts)


FIRST_EVENTS: Final = 256
"""Rows of the event table at the first try; a run that has more is repeated with enough."""
WHOLE: Final = 1.0 + 1e-12
"""A duration that is a multiple of the output step to rounding has that many samples."""


def prepare(problem: Problem, params: Params, event_rows: int) -> Prepared:
    """Everything that one run reads and writes, freshly allocated, its parameters written."""
    x, times_x, samples_x = encode_motion(problem.motion_x)
    z, times_z, samples_z = encode_motion(problem.motion_z)
    dt = params.output_step_s
    instants = math.floor(params.duration_s / dt * WHOLE) + 2 if dt > 0.0 else 0
    memory = bytearray(TASK.itemsize)
    history = np.empty((5, instants))
    events = np.zeros(event_rows, EVENT_ROW) if event_rows else NO_EVENTS
    table, rows = address(history) if instants else 0, address(events) if event_rows else 0
    output = table, max(instants - 1, 0), rows, event_rows
    base, motions = encode_base(problem), (*vars(x).values(), *vars(z).values())
    _READ.pack_into(memory, 0, *vars(params).values(), *vars(base).values(), *motions, *output)
    return Prepared(memory, history, events, (problem.block, problem.wall, times_x, times_z, samples_x, samples_z))


def solve(problem: Problem, options: Options = DEFAULT_OPTIONS) -> Solution:
    """Run the model of docs/model.md, sections 1 to 5 and 8; the solution's arrays are read-only."""
    params = encode(problem, options)
    task = prepare(problem, params, FIRST_EVENTS if options.events else 0)
    state, results, counts = task.run()
    if options.events and counts.events > FIRST_EVENTS:
        task = prepare(problem, params, counts.events)
        state, results, counts = task.run()
    task.history.setflags(write=False)
    history = NO_HISTORY if options.dt_s is None else task.history[:, : counts.samples]
    return Solution(OUTCOMES[state.outcome], results, params, state, counts, task.events[: counts.events], *history)


def simulate(
    block: Block,
    motion_x: Excitation,
    motion_z: Excitation | None = None,
    *,
    duration_s: float,
    pedestal: Pedestal | None = None,
    floor_static: float = 0.0,
    floor_kinetic: float = 0.0,
    floor_impact: float | Literal["kinetic", "static"] = "kinetic",
    statue_friction: float = math.inf,
    form: Form | None = None,
    theta0_rad: float = 0.0,
    theta_rate0_rad_s: float = 0.0,
    gravity_m_s2: float = GRAVITY_M_S2,
    wall: Wall | None = None,
    overturn_rad: float = OVERTURN_RAD,
    accuracy_rad: float = DEFAULT_OPTIONS.accuracy_rad,
    dt_s: float | None = DEFAULT_OPTIONS.dt_s,
    step_cap_s: float = math.inf,
    skip_start: bool = True,
    skip_rest: bool = True,
    skip_energy: bool = True,
    events: bool = True,
    validity: bool = True,
) -> Solution:
    """Run the model of docs/model.md, sections 1 to 5 and 8: ``solve`` with the fields of `Problem` and `Options` as keywords.

    motion_x, motion_z: the floor's accelerations. Raises AnalyticInputError for numbers that cannot be run.

    >>> block = analytic.Block.rectangle(width_m=0.2, height_m=1.0, mass_kg=500.0)
    >>> solution = analytic.simulate(block, analytic.Harmonic(amplitude_m_s2=3.0, frequency_hz=2.0), duration_s=5.0)
    """
    problem = Problem(
        block=block,
        motion_x=motion_x,
        motion_z=ZeroExcitation() if motion_z is None else motion_z,
        duration_s=duration_s,
        pedestal=pedestal,
        floor_static=floor_static,
        floor_kinetic=floor_kinetic,
        floor_impact=floor_impact,
        statue_friction=statue_friction,
        form=CONSISTENT if form is None else form,
        theta0_rad=theta0_rad,
        theta_rate0_rad_s=theta_rate0_rad_s,
        gravity_m_s2=gravity_m_s2,
        wall=wall,
        overturn_rad=overturn_rad,
    )
    options = Options(
        accuracy_rad=accuracy_rad,
        dt_s=dt_s,
        step_cap_s=step_cap_s,
        skip_start=skip_start,
        skip_rest=skip_rest,
        skip_energy=skip_energy,
        events=events,
        validity=validity,
    )
    return solve(problem, options)


# How sure a run is of its own numbers: the same run again with finer steps, and what made it doubtful.

BASE_ACCURACY_RAD: Final = 1e-12
"""Accuracy of the run that is given back; its local error is 1e-15 rad."""
SECOND_RUN_SHARE: Final = 1e-2
"""The second run asks for this share of the accuracy, hence for another order and other steps."""
CAP: Final = 0.7
"""The third run's steps are at most half of this, in time constants 1/p: below the free steps of every order used."""
SAFETY: Final = 3.0
"""The stated uncertainty is this many times the largest difference between the runs."""
PARTED: Final = 1e-3
"""Two runs whose losses of energy at impacts differ by more than this share took different paths: where rotations stay within
1e-4 rad of each other they differ by less."""
ROUNDING: Final = 2.0**-52
"""Relative rounding of one operation."""
ROUNDED: Final = 4.0
"""Roundings that a step adds to the state, as if all pointed one way: of the first terms of its series, and"""
ROUNDED_ONCE: Final = 64.0
"""those of what is computed once: angles of the corners, inertias, the motion's own constants."""


@final
@dataclass(frozen=True, eq=False)
class Certified:
    """A solution with the uncertainties of its rotation, rad, and slip, m, valid up to reliable_until_s.

    outcomes are those of all its runs, sorted: more than one says that the outcome changes with the integrator's steps.
    """

    solution: Solution
    uncertainty_rad: float
    slip_uncertainty_m: float
    reliable_until_s: float
    outcomes: tuple[Outcome, ...]

    @property
    def outcome_is_sure(self) -> bool:
        """Whether all runs ended in the same way."""
        return len(self.outcomes) == 1


def certify(
    block: Block,
    motion_x: Excitation,
    motion_z: Excitation | None = None,
    *,
    duration_s: float,
    pedestal: Pedestal | None = None,
    floor_static: float = 0.0,
    floor_kinetic: float = 0.0,
    floor_impact: float | Literal["kinetic", "static"] = "kinetic",
    statue_friction: float = math.inf,
    form: Form | None = None,
    theta0_rad: float = 0.0,
    theta_rate0_rad_s: float = 0.0,
    gravity_m_s2: float = GRAVITY_M_S2,
    wall: Wall | None = None,
    overturn_rad: float = OVERTURN_RAD,
    accuracy_rad: float = 1e-9,
    base_accuracy_rad: float = BASE_ACCURACY_RAD,
    step_cap_s: float = math.inf,
    dt_s: float | None = DEFAULT_OPTIONS.dt_s,
    skip_start: bool = True,
    skip_rest: bool = True,
    skip_energy: bool = True,
    events: bool = True,
    validity: bool = True,
) -> Certified:
    """Run the model three times (finer local error, shorter steps) and say how far the numbers hold.

    accuracy_rad: error up to which the history counts as reliable; base_accuracy_rad, step_cap_s: of the run that is given back;
    the others are those of ``simulate``. Without a history (dt_s None) no list of events is kept and one further run, with
    the finer error and the shorter steps together, is the check; where the two lose other energy, the peak is reliable up to its
    own time only; the slip's uncertainty is then that of its peak over the whole run.
    Raises AnalyticInputError as ``simulate`` does.
    """
    base = min(accuracy_rad, base_accuracy_rad)
    scene: CommonKeywords = {
        "duration_s": duration_s,
        "pedestal": pedestal,
        "floor_static": floor_static,
        "floor_kinetic": floor_kinetic,
        "floor_impact": floor_impact,
        "statue_friction": statue_friction,
        "form": form,
        "theta0_rad": theta0_rad,
        "theta_rate0_rad_s": theta_rate0_rad_s,
        "gravity_m_s2": gravity_m_s2,
        "wall": wall,
        "overturn_rad": overturn_rad,
        "dt_s": dt_s,
        "skip_start": skip_start,
        "skip_rest": skip_rest,
        "skip_energy": skip_energy,
        "events": events,
        "validity": validity,
    }
    quick = scene | {"events": False, "validity": False}
    shorter = 0.5 * min(step_cap_s, longest_step_s(block, gravity_m_s2))
    checks: tuple[tuple[float, float], ...] = ((base * SECOND_RUN_SHARE, step_cap_s), (base, shorter))
    if dt_s is None:
        scene, checks = {**scene, "events": False}, ((base * SECOND_RUN_SHARE, shorter),)
    first = simulate(block, motion_x, motion_z, accuracy_rad=base, step_cap_s=step_cap_s, **scene)
    quick = quick | {"gravity_m_s2": gravity_m_s2 * (1.0 + rounding(first.counts.steps))}
    others = tuple(
        simulate(block, motion_x, motion_z, accuracy_rad=finer, step_cap_s=longest, **quick)
        for finer, longest in checks
    )
    # An error of the slip moves the centroid by itself, one of the rotation by the height times it: so neither counts for more.
    return certified(first, others, (accuracy_rad, accuracy_rad * block.centroid_height_m))


def longest_step_s(block: Block, gravity_m_s2: float) -> float:
    """Twice the longest step of the runs with short steps, s."""
    return CAP / max(block.p_rad_s(1, gravity_m_s2), block.p_rad_s(-1, gravity_m_s2))


def rounding(steps: Any) -> Any:
    """Share by which the checks' gravity differs: what so many steps may have rounded.

    What all runs share shows in no difference between them.
    """
    return ROUNDING * (ROUNDED * steps + ROUNDED_ONCE)


def certified(first: Solution, others: tuple[Solution, ...], accuracy: tuple[float, float]) -> Certified:
    """What the differences between the runs say; `accuracy` of rotation, rad, and slip, m, up to which they count as reliable."""
    uncertainty, slip, until = _spread(first, others, accuracy)
    # Runs that end the same sequences of impacts differ by nothing of what they all left out.
    left_rad = first.params.rest_rad if first.counts.dropped_rebounds else 0.0
    return Certified(
        first, max(uncertainty, left_rad), slip, until, tuple(sorted({each.outcome for each in (first, *others)}))
    )


def _spread(first: Solution, others: tuple[Solution, ...], accuracy: tuple[float, float]) -> tuple[float, float, float]:
    """Uncertainties of rotation, rad, and slip, m, and the time until which they hold, s; `accuracy` is asked of the two."""
    if first.t_s.size == 0:  # then one other run is the check
        a, b, until = peaks_apart(first.results, others[0].results, first.end_s, accuracy[0])
        return float(a), float(b), float(until)
    size = min(solution.t_s.size for solution in (first, *others)) - 1
    turned, slid = (
        np.abs(np.stack([getattr(other, name)[:size] for other in others]) - getattr(first, name)[:size])
        for name in ("theta_rad", "slip_m")
    )
    return within(first.t_s, min(s.end_s for s in (first, *others)), (turned, slid), accuracy)


def within(
    t_s: Floats, end_s: float, differences: tuple[Floats, Floats], accuracy: tuple[float, float]
) -> tuple[float, float, float]:
    """Largest of two differences (runs, n) of runs from the first, with its safety, while both are within the accuracy asked of
    them, and until when that is: their end, where they never leave it."""
    a, b = (SAFETY * each.max(axis=0) for each in differences)
    bad = np.flatnonzero((a > accuracy[0]) | (b > accuracy[1]))
    reliable = int(bad[0]) if bad.size else a.size
    until = float(t_s[max(reliable - 1, 0)]) if bad.size else end_s
    return float(a[:reliable].max(initial=0.0)), float(b[:reliable].max(initial=0.0)), until


def peaks_apart(first: Any, other: Any, end_s: Any, accuracy_rad: float) -> tuple[Any, Any, Any]:
    """Uncertainties of peak rotation, rad, and peak slip, m, and the time until which they hold, s, by the results of a run and
    of the one that checks it: of a pair of `Results`, or of tables of them (n,)."""
    turned = SAFETY * abs(abs(other.peak_theta_rad) - abs(first.peak_theta_rad))
    slid = SAFETY * abs(other.peak_slip_m - first.peak_slip_m)
    # Of runs that took different paths an equal peak before they parted tells nothing.
    most = np.maximum(first.energy_lost_j, other.energy_lost_j)
    parted = abs(other.energy_lost_j - first.energy_lost_j) > PARTED * most
    until = np.where(parted, np.minimum(first.peak_time_s, other.peak_time_s), end_s)
    return turned, slid, np.where(turned <= accuracy_rad, until, 0.0)
