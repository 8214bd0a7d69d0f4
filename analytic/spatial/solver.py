"""One run in three dimensions, how far its numbers hold, and many runs for their outcome."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.block import GRAVITY_M_S2, OVERTURN_RAD, Floats, positive, require
from analytic.excitation import Excitation, ZeroExcitation
from analytic.kernel.records import MotionParams, Records, row
from analytic.machine_code import Entry
from analytic.problem import encode_motion
from analytic.solver import SECOND_RUN_SHARE, within
from analytic.spatial.kernel.records import (
    EVENT_HEAD,
    GAVE_UP,
    INTERVAL_HEAD,
    LOST,
    MEMORY,
    MOST,
    OVERTURNED,
    RUN,
    SECTORS,
    STATE,
    Run,
)
from analytic.spatial.problem import (
    KINDS,
    MODES,
    OUTCOMES,
    UPRIGHT,
    VERTEX_STATES,
    Body,
    Event,
    Interval,
    Outcome,
    Problem,
    Solution,
    Work,
)
from analytic.sweep import flattened, in_pieces

run_rows: Final = Entry("analytic.spatial.kernel.integrator", "run")
TOLERANCE: Final = 1e-13
"""Local error of a step, relative to 1 m and 1 rad: rounding of some hundred operations."""
TOUCH_M: Final = 1e-10
"""Vertices whose gaps differ by less land together: far above what a symmetric body's rounding makes of equal gaps, far below
what any contact resolves."""
STILL_M_S: Final = 1e-11
"""Slowest sliding; where the local error is larger, ten times that: a slower velocity has no direction but that of the error."""
SETTLE_M: Final = 1e-14
"""A rebound lower than this, or than the tolerance, is dropped."""
ROWS: Final = 4096
"""Of the tables of events and intervals at the first try, more than nearly any run has: a run that has more is repeated with
enough, and rows that are never written take no memory."""


class Task(NamedTuple):
    """What one run reads and writes: record and memory (1,), history, tables of events and intervals; motions keep alive the
    samples that the memory knows by their address."""

    run: Records
    memory: Records
    history: Floats
    events: Floats
    intervals: Floats
    motions: Sequence[tuple[MotionParams, Floats, Floats]]


def prepare(
    problem: Problem,
    tolerance: float,
    dt_out_s: float | None,
    step_cap_s: float,
    rows: int,
    most_steps: int = MOST,
    ties: bool = False,
) -> Task:
    """Everything that one run reads and writes, freshly allocated."""
    body, n = problem.body, len(problem.body.vertices_m)
    motions = [encode_motion(each) for each in (problem.motion_x, problem.motion_y, problem.motion_z)]
    instants = math.floor(problem.duration_s / dt_out_s * (1.0 + 1e-12)) + 2 if dt_out_s else 1
    values = dict.fromkeys(Run.__dataclass_fields__, 0) | {
        "mass_kg": body.mass_kg,
        "gravity_m_s2": problem.gravity_m_s2,
        "friction_static": min(problem.friction_static, 1e9),
        "friction_kinetic": min(problem.kinetic, 1e9),
        "restitution": problem.restitution,
        "duration_s": problem.duration_s,
        "overturn_cos": math.cos(problem.overturn_rad) if problem.overturn_rad < math.pi else -math.inf,
        "stands_cos": math.cos(_slenderness(body)),
        "tolerance": tolerance,
        "touch_m": TOUCH_M,
        "still_m_s": max(STILL_M_S, 10.0 * tolerance),
        "settle_m_s": math.sqrt(2.0 * problem.gravity_m_s2 * max(tolerance, SETTLE_M)),
        "step_cap_s": step_cap_s,
        "most_steps": most_steps,
        "output_step_s": dt_out_s or 0.0,
        "keep_events": rows > 0,
        "try_all": ties,
        "sectors": SECTORS[0],
        "step_s": 1e-3,
        "energy_scale_j": body.mass_kg * problem.gravity_m_s2 * body.radius_m,
    }
    record = np.zeros(1, RUN)
    record[0] = tuple(values.values())
    memory = np.zeros(1, MEMORY)
    memory["vertices"], memory["y"][0, :13] = n, problem.start
    memory["inertia"], memory["inverse"] = body.inertia_kg_m2, np.linalg.inv(body.inertia_kg_m2)
    memory["about"][0, :n], memory["at"][0, :n] = body.inverse_about, body.vertices_m
    memory["motions"]["params"] = [row(params) for params, _, _ in motions]
    task = Task(
        record,
        memory,
        np.zeros((instants, STATE - 1)),
        np.zeros((rows, EVENT_HEAD + 3 * n)),
        np.zeros((rows, INTERVAL_HEAD + n)),
        motions,
    )
    # Addresses, not arrays: a record's layout must not depend on the length of a motion or a history.
    for name, array in (("history", task.history), ("event_table", task.events), ("interval_table", task.intervals)):
        memory[name] = array.ctypes.data
    memory["instants"], memory["rows"] = instants, rows
    return task


def run_all(runs: Records, memories: Records) -> None:
    """Run every row of two tables whose memories know the arrays of their task, which the caller keeps alive."""
    run_rows(runs.ctypes.data, memories.ctypes.data, 0, len(runs))


def _slenderness(body: Body) -> float:
    """Tilt up to which the upright body is inside all of its base's edges, rad: the least over them; 0 without a base."""
    r = body.vertices_m[body.vertices_m[:, 2] < 0.0]
    if len(r) < 3:
        return 0.0
    r = r[np.argsort(np.arctan2(*(r[:, :2] - r[:, :2].mean(axis=0)).T[::-1]))]
    a, b = r, np.roll(r, -1, axis=0)
    edge = b[:, :2] - a[:, :2]
    inside = (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / np.hypot(edge[:, 0], edge[:, 1])
    return float(np.arctan2(np.maximum(inside, 0.0), -np.minimum(a[:, 2], b[:, 2])).min())


def solve(
    problem: Problem,
    *,
    tolerance: float = TOLERANCE,
    dt_out_s: float | None = 0.001,
    step_cap_s: float = math.inf,
    events: bool = True,
    ties: bool = True,
    most_steps: int = MOST,
) -> Solution:
    """Run the model of docs/spatial.md; raises AnalyticInputError for numbers that cannot be used.

    ties: with events, count `Solution.ambiguous_states`, for which all modes are tried at each: most of a run's time.
    most_steps: after which the run is given up (`Solution.gave_up`).
    """
    positive(tolerance=tolerance, **({} if dt_out_s is None else {"dt_out_s": dt_out_s}))
    rows = ROWS if events else 0
    limits = tolerance, dt_out_s, step_cap_s
    task = prepare(problem, *limits, rows, most_steps, events and ties)
    run_all(task.run, task.memory)
    most = int(max(task.run["events"][0], task.run["intervals"][0]))
    if events and most > rows:
        task = prepare(problem, *limits, most, most_steps, ties)
        run_all(task.run, task.memory)
    return read(problem, task)


def simulate(
    body: Body,
    motion_x: Excitation | None = None,
    motion_y: Excitation | None = None,
    motion_z: Excitation | None = None,
    *,
    duration_s: float,
    friction_static: float,
    friction_kinetic: float | None = None,
    tolerance: float = TOLERANCE,
    dt_out_s: float | None = 0.001,
    step_cap_s: float = math.inf,
    gravity_m_s2: float = GRAVITY_M_S2,
    position_m: Sequence[float] | None = None,
    quaternion_wxyz: Sequence[float] = UPRIGHT,
    velocity_m_s: Sequence[float] = (0.0, 0.0, 0.0),
    angular_velocity_rad_s: Sequence[float] = (0.0, 0.0, 0.0),
    overturn_rad: float = OVERTURN_RAD,
    restitution: float = 0.0,
) -> Solution:
    """Run the model of docs/spatial.md: ``solve`` with the fields of `Problem` as keywords.

    motion_x, motion_y, motion_z: the floor's accelerations, None for none; dt_out_s: output step, None for no history.
    """
    x, y, z = (ZeroExcitation() if each is None else each for each in (motion_x, motion_y, motion_z))
    problem = Problem(
        body=body,
        duration_s=duration_s,
        friction_static=friction_static,
        friction_kinetic=friction_kinetic,
        motion_x=x,
        motion_y=y,
        motion_z=z,
        gravity_m_s2=gravity_m_s2,
        position_m=position_m,
        quaternion_wxyz=quaternion_wxyz,
        velocity_m_s=velocity_m_s,
        angular_velocity_rad_s=angular_velocity_rad_s,
        overturn_rad=overturn_rad,
        restitution=restitution,
    )
    return solve(problem, tolerance=tolerance, dt_out_s=dt_out_s, step_cap_s=step_cap_s)


def read(problem: Problem, task: Task) -> Solution:
    """The solution of what a run left in its arrays."""
    record = task.run[0]
    history = task.history[: int(record["samples"])]
    turn = history[:, 4:8] / np.linalg.norm(history[:, 4:8], axis=1, keepdims=True)
    return Solution(
        t_s=history[:, 0],
        position_m=history[:, 1:4],
        quaternion_wxyz=turn,
        velocity_m_s=history[:, 8:11],
        angular_velocity_rad_s=history[:, 11:14],
        vertices_m=problem.body.vertices_m,
        outcome=OUTCOMES[int(record["outcome"])],
        end_s=float(record["time_s"]),
        peak_tilt_rad=float(record["peak_tilt_rad"]),
        events=tuple(_event(row) for row in task.events[: int(record["events"])]),
        intervals=_intervals(task.intervals[: int(record["intervals"])], float(record["time_s"])),
        energy_lost_at_impacts_j=float(record["impact_loss_j"]),
        energy_lost_by_sliding_j=float(task.memory["y"][0, LOST]),
        energy_residual=float(record["energy_residual"]),
        momentum_residual=float(record["momentum_residual"]),
        cone_residual=float(record["cone_residual"]),
        least_friction=float(record["least_friction"]),
        gave_up=int(record["outcome"]) == GAVE_UP,
        work=Work(*(int(record[name]) for name in ("steps", "rejected", "events", "impacts", "settled"))),
        ambiguous_states=int(record["ties"]),
    )


def _event(row: Floats) -> Event:
    time_s, kind, vertex, mode, loss, cone = (float(item) for item in row[:EVENT_HEAD])
    return Event(
        time_s=time_s,
        kind=KINDS[int(kind)],
        vertex=int(vertex) if vertex >= 0.0 else None,
        mode=MODES[int(mode)],
        impulses_n_s=row[EVENT_HEAD:].reshape(-1, 3).copy(),
        energy_lost_j=loss,
        cone_residual=cone,
    )


def _intervals(table: Floats, end_s: float) -> tuple[Interval, ...]:
    ends = [*table[1:, 0], end_s][: len(table)]
    return tuple(
        Interval(
            float(row[0]),
            float(end),
            MODES[int(row[1])],
            tuple(VERTEX_STATES[int(item)] for item in row[INTERVAL_HEAD:]),
        )
        for row, end in zip(table, ends, strict=True)
    )


FINEST: Final = 1e-15
"""No local error below rounding is asked."""
CAP_S: Final = 0.01
"""Longest step of the second run."""


@final
@dataclass(frozen=True, eq=False)
class Certified:
    """A solution with the uncertainties of its attitude, rad, and of its centroid's place, m, valid up to reliable_until_s."""

    solution: Solution
    uncertainty_rad: float
    place_uncertainty_m: float
    reliable_until_s: float
    outcome_is_sure: bool
    complete: bool
    """Whether each of the runs found a way to its end: none was given up or found no mode of motion."""


def certify(
    problem: Problem,
    *,
    tolerance: float = TOLERANCE,
    dt_out_s: float = 0.001,
    accuracy: float = 1e-9,
    step_cap_s: float = math.inf,
    most_steps: int = MOST,
    alone: bool = False,
) -> Certified:
    """Run the model, and again a hundred times finer and with shorter steps; say how far the numbers hold.

    accuracy: error, in rad and m, up to which the history counts as reliable. alone: without the runs that check the first, whose
    uncertainties are then not known (NaN), and without a count of ambiguous states.
    """
    finer, shorter = max(SECOND_RUN_SHARE * tolerance, FINEST), min(CAP_S, 0.5 * step_cap_s)
    first, *others = (
        solve(
            problem,
            tolerance=local,
            dt_out_s=dt_out_s,
            step_cap_s=cap_s,
            events=events,
            ties=not alone,
            most_steps=most_steps,
        )
        for local, cap_s, events in (
            (tolerance, step_cap_s, True),
            (finer, step_cap_s, False),
            (tolerance, shorter, False),
        )[: 1 if alone else 3]
    )
    complete = not any(each.gave_up or each.outcome is Outcome.FRICTION_PARADOX for each in (first, *others))
    if alone:
        return Certified(first, math.nan, math.nan, first.end_s, True, complete)
    size = min(len(each.t_s) for each in (first, *others)) - 1
    turned = np.stack([attitude_difference_rad(first, other, size) for other in others])
    moved = np.stack([first.position_m[:size] - other.position_m[:size] for other in others])
    ends_s = min(each.end_s for each in (first, *others))
    said = within(first.t_s, ends_s, (turned, np.linalg.norm(moved, axis=2)), (accuracy, accuracy))
    # A check that was given up ended in no other way: it did not end.
    sure = all(other.gave_up or other.outcome is first.outcome for other in others)
    return Certified(first, *said, sure, complete)


def attitude_difference_rad(a: Solution, b: Solution, size: int) -> Floats:
    """Angle between the attitudes of two runs at their first samples (size,), rad."""
    p, q = a.quaternion_wxyz[:size], b.quaternion_wxyz[:size]
    sign = np.sign(np.einsum("ij,ij->i", p, q))[:, None]
    return np.asarray(4.0 * np.arcsin(np.clip(0.5 * np.linalg.norm(p - sign * q, axis=1), 0.0, 1.0)))


# Many runs in three dimensions for their outcome, in parallel.


SWEEPABLE: Final = ("scale", "vertical_scale", "heading_rad", "friction")
"""What a sweep may vary: factors of all motions and of the vertical one, the body's heading (turned to the left, so that
the motion comes from the other side), the coefficient of friction (both)."""
OUTCOME_TOLERANCE: Final = 1e-7
"""Local error where only the outcome is asked."""
CHUNK: Final = 128
"""Runs whose memories (some 40 kB each) are there at one time, for each thread."""


@final
@dataclass(frozen=True, eq=False)
class Outcomes:
    """Outcomes of many runs, each array of the sweep's shape. axis: the body's axis at the end, (..., 3)."""

    codes: NDArray[np.int64]
    end_s: Floats
    peak_tilt_rad: Floats
    axis: Floats
    impacts: NDArray[np.int64]
    steps: NDArray[np.int64]

    @property
    def outcomes(self) -> NDArray[np.object_]:
        """Outcome of each run."""
        return np.array(OUTCOMES, dtype=object)[self.codes]

    @property
    def overturned(self) -> NDArray[np.bool_]:
        """Whether each run overturned."""
        return np.asarray(self.codes == OVERTURNED)


def outcomes(
    problem: Problem,
    sweep: Mapping[str, ArrayLike],
    *,
    tolerance: float = OUTCOME_TOLERANCE,
    threads: int | None = None,
    most_steps: int = MOST,
) -> Outcomes:
    """Run the problem for every set of a sweep: arrays by name (SWEEPABLE) that broadcast against each other.

    threads: None for all cores; the result does not depend on it. most_steps: after which a run is given up.
    Raises AnalyticInputError for unknown names and numbers that cannot be run.
    """
    shape, flat = flattened(sweep, SWEEPABLE)
    require((flat.get("friction", np.zeros(1)) >= 0.0).all(), "sweep: no negative friction is wanted.")
    task = prepare(problem, tolerance, None, math.inf, 0, most_steps)

    def work(start: int, stop: int) -> tuple[Records, Floats]:
        """The records and the last attitudes (stop − start, 4) of a piece of the sweep."""
        runs, memories = np.repeat(task.run, stop - start), np.repeat(task.memory, stop - start)
        for name, values in flat.items():
            _vary(runs, memories, name, values[start:stop])
        run_all(runs, memories)
        return runs, memories["y"][:, 3:7].copy()

    runs, turns = map(np.concatenate, zip(*in_pieces(work, math.prod(shape), threads, most=CHUNK), strict=True))
    w, x, y, z = turns.T
    axis = np.stack([2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)], axis=-1)
    return Outcomes(
        codes=runs["outcome"].reshape(shape),
        end_s=runs["time_s"].reshape(shape),
        peak_tilt_rad=runs["peak_tilt_rad"].reshape(shape),
        axis=axis.reshape(*shape, 3),
        impacts=runs["impacts"].reshape(shape),
        steps=runs["steps"].reshape(shape),
    )


def _vary(runs: Records, memories: Records, name: str, values: Floats) -> None:
    """Write what one name of a sweep varies."""
    if name in ("scale", "vertical_scale"):
        scaled = memories["motions"]["params"][:, 0 if name == "scale" else 2 :]
        scaled["amplitude_m_s2"] *= values[:, None]
        scaled["scale"] *= values[:, None]
    elif name == "friction":
        runs["friction_static"], runs["friction_kinetic"] = values, values
    else:
        _turn(memories["y"], values)


def _turn(y: Floats, heading_rad: Floats) -> None:
    """Turn initial states (n, 15) about the table's z: place, attitude and velocity."""
    c, s = np.cos(0.5 * heading_rad), np.sin(0.5 * heading_rad)
    w, x, y_, z = y[:, 3:7].T.copy()
    y[:, 3], y[:, 4], y[:, 5], y[:, 6] = c * w - s * z, c * x - s * y_, c * y_ + s * x, c * z + s * w
    c, s = np.cos(heading_rad), np.sin(heading_rad)
    for first in (0, 7):
        a, b = y[:, first].copy(), y[:, first + 1].copy()
        y[:, first], y[:, first + 1] = c * a - s * b, s * a + c * b
