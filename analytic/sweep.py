"""Many parameter sets in parallel, in compiled code: overturning maps, fragilities, sensitivities; certified rows."""

import math
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Final, Literal, NamedTuple, Self, TypeVar, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.block import GRAVITY_M_S2, OVERTURN_RAD, Block, Form, Pedestal, Wall, require
from analytic.excitation import Excitation
from analytic.kernel.records import (
    BASE,
    COSINE,
    COUNTS,
    HARMONIC,
    MOTION_PARAMS,
    NONE,
    OVERTURNED_LEFT,
    OVERTURNED_RIGHT,
    PARAMS,
    RECTANGULAR,
    RESULTS,
    SINE,
    STATE,
    TABLES,
    TASK,
    Counts,
    Floats,
    Params,
    Records,
    Results,
    State,
    row,
)
from analytic.problem import (
    HELD,
    NO_EVENTS,
    NO_HISTORY,
    OUTCOMES,
    Keywords,
    Options,
    Problem,
    Solution,
    encode,
    encode_base,
    encode_motion,
    stated,
)
from analytic.solver import (
    SECOND_RUN_SHARE,
    Certified,
    address,
    certified,
    longest_step_s,
    peaks_apart,
    rounding,
    run,
)

# Many rows of the kernel's records, run one after another in compiled code.


class Rows(NamedTuple):
    """What the compiled code reads, row by row; arrays keeps alive those that it knows by their address."""

    params: Records
    motion_x: Records
    motion_z: Records
    bases: Records
    arrays: tuple[Floats, ...]


class Out(NamedTuple):
    """What it writes, row by row."""

    states: Records
    """The instants at which the runs ended."""
    results: Records
    counts: Records

    @classmethod
    def of(cls, size: int) -> Self:
        """Room for so many rows."""
        return cls(*(np.zeros(size, record) for record in (STATE, RESULTS, COUNTS)))


def run_rows(rows: Rows, out: Out, start: int, stop: int) -> None:
    """Run the rows start to stop − 1 for their outcome, in memory of their own; no history and no events are kept."""
    task = bytearray(TASK.itemsize)
    tables = np.array([(*(table.ctypes.data for table in (*rows[:4], *out)), start, stop)], TABLES)
    run(address(task), address(tables))


# Many problems with their certificates, for the outcome alone: what `certify` says of each, by two compiled sweeps.

Motions = tuple[Excitation, Excitation]
"""The floor's accelerations along x and z."""


class Body(NamedTuple):
    """A problem without its motion, as its two runs read it: what many problems share is encoded once."""

    problem: Problem
    params: Params
    checked: Params
    """Of the run that checks the first, except its gravity, which follows from the steps of that."""


def body_of(problem: Problem, accuracy_rad: float) -> Body:
    """Encode a problem for runs of that accuracy, which no energy ends; its motion is left out."""
    first = Options(accuracy_rad=accuracy_rad, dt_s=None, events=False, skip_energy=False)
    cap_s = 0.5 * longest_step_s(problem.block, problem.gravity_m_s2)
    finer = replace(first, accuracy_rad=accuracy_rad * SECOND_RUN_SHARE, step_cap_s=cap_s, validity=False)
    return Body(problem, encode(problem, first), encode(problem, finer))


@final
@dataclass(frozen=True, eq=False)
class CertifiedRows:
    """The answers of many problems, (n,): of the run that counts and of the one that checks it, and what their difference says.

    Uncertainties of peak rotation, rad, and peak slip, m, and until when they hold, s.
    """

    bodies: Sequence[Body]
    body: NDArray[np.int64]
    """Of each row, by its place in `bodies`."""
    first: Out
    other: Out
    uncertainty_rad: Floats
    slip_uncertainty_m: Floats
    reliable_until_s: Floats
    accuracy_rad: float

    @property
    def doubtful(self) -> NDArray[np.bool_]:
        """Whether there is anything to warn of."""
        first, counts = self.first.results, self.first.counts
        unsure = self.first.states["outcome"] != self.other.states["outcome"]
        unsure |= self.reliable_until_s < self.first.states["time_s"]
        for name in ("given_up", "tangents", "ties", "dropped_rebounds"):
            unsure |= counts[name] > 0
        unsure |= np.isfinite(first["outcome_margin"]) | np.isfinite(first["left_domain_s"])
        return np.asarray(unsure | (first["energy_gained_j"] > 0.0))

    def certified(self, i: int) -> Certified:
        """One of them, as ``certify`` gives it."""
        one = self.bodies[self.body[i]]
        first, other = _solution(one.params, self.first, i), _solution(one.checked, self.other, i)
        return certified(first, (other,), (self.accuracy_rad, self.accuracy_rad * one.problem.block.centroid_height_m))


def certify_rows(
    bodies: Sequence[Body], body: NDArray[np.int64], motions: Sequence[Motions], accuracy_rad: float
) -> CertifiedRows:
    """Run every problem twice: of row i the body is `bodies[body[i]]`, the motion `motions[i]` (equal objects are encoded once).

    `accuracy_rad` is the error up to which a peak counts as reliable, as in ``certify``.
    """
    sides = _encoded(motions)
    bases = np.array([row(encode_base(one.problem)) for one in bodies], BASE)[body]
    params = np.array([row(one.params) for one in bodies], PARAMS)[body]
    first, other = Out.of(body.size), Out.of(body.size)
    run_rows(Rows(params, *sides[:2], bases, sides[2]), first, 0, body.size)
    finer = np.array([row(one.checked) for one in bodies], PARAMS)[body]
    finer["gravity_m_s2"] *= 1.0 + rounding(first.counts["steps"])
    finer["time_scale_s"] = _time_scale_s(bodies, body, finer["gravity_m_s2"])
    run_rows(Rows(finer, *sides[:2], bases, sides[2]), other, 0, body.size)
    a, b = (each.results.view(np.recarray) for each in (first, other))
    turned, slid, until = peaks_apart(a, b, first.states["time_s"], accuracy_rad)
    left_rad = np.where(first.counts["dropped_rebounds"] > 0, params["rest_rad"], 0.0)
    return CertifiedRows(bodies, body, first, other, np.maximum(turned, left_rad), slid, until, accuracy_rad)


def _encoded(motions: Sequence[Motions]) -> tuple[Records, Records, tuple[Floats, ...]]:
    """Motions along x and z row by row, and the samples that the kernel knows by their address."""
    encoded = {key: encode_motion(motion) for key, motion in {id(one): one for pair in motions for one in pair}.items()}
    values = {key: row(params) for key, (params, *_) in encoded.items()}
    x, z = (np.array([values[id(pair[k])] for pair in motions], MOTION_PARAMS) for k in (0, 1))
    return x, z, tuple(array for _, *samples in encoded.values() for array in samples)


def _time_scale_s(bodies: Sequence[Body], body: NDArray[np.int64], gravity_m_s2: Floats) -> Floats:
    """1/p of each row's faster outer corner, s."""
    blocks = [one.problem.block for one in bodies]
    rows = zip(body.tolist(), gravity_m_s2.tolist(), strict=True)
    return np.array([1.0 / max(blocks[k].p_rad_s(side, gravity) for side in (1, -1)) for k, gravity in rows])


def _solution(params: Params, out: Out, i: int) -> Solution:
    ended, results, counts = (rows[i].item() for rows in out)
    state = State(*ended)
    return Solution(OUTCOMES[state.outcome], Results(*results), params, state, Counts(*counts), NO_EVENTS, *NO_HISTORY)


CHUNKS_PER_THREAD: Final = 16
"""Pieces of work for each thread: enough to keep them busy to the end, few enough to cost nothing."""
ACCURACY_RAD: Final = 1e-6
"""Aimed error where only outcomes are asked: a thousandth of what the engines are asked for."""
TWO_PI: Final = 2.0 * math.pi

Progress = Callable[[int, int], None]
"""Called with the runs done and the runs in all."""
Piece = TypeVar("Piece")


@final
@dataclass(frozen=True, eq=False)
class Ensemble:
    """Outcomes of many runs, each array of the sweep's shape; times are NaN where nothing of the kind happened.

    codes index OUTCOMES; steps counts the integration steps of each run; left_domain_s is NaN too where it was not asked.
    """

    codes: NDArray[np.int64]
    end_s: NDArray[np.float64]
    peak_theta_rad: NDArray[np.float64]
    peak_slip_m: NDArray[np.float64]
    overturn_time_s: NDArray[np.float64]
    no_return_time_s: NDArray[np.float64]
    left_domain_s: NDArray[np.float64]
    impacts: NDArray[np.int64]
    steps: NDArray[np.int64]

    @property
    def outcomes(self) -> NDArray[np.object_]:
        """Outcome of each run."""
        return np.array(OUTCOMES, dtype=object)[self.codes]

    @property
    def overturned(self) -> NDArray[np.bool_]:
        """Whether each run overturned, to either side."""
        return np.asarray((self.codes == OVERTURNED_LEFT) | (self.codes == OVERTURNED_RIGHT))


_PARAMETERS: Final = (
    "mass_kg",
    "centroid_height_m",
    "inertia_kg_m2",
    "pedestal_mass_kg",
    "floor_static",
    "floor_kinetic",
    "floor_impact",
    "statue_friction",
    "restitution",
    "theta0_rad",
    "theta_rate0_rad_s",
    "duration_s",
    "gravity_m_s2",
)
_MOTION: Final = ("amplitude_m_s2", "frequency_hz", "phase_rad", "scale", "vertical_scale")
_BASE: Final = ("corner_left_m", "corner_right_m")
SWEEPABLE: Final = (*_PARAMETERS, *_MOTION, *_BASE)
"""Names that a sweep may vary."""


def ensemble(
    block: Block,
    motion_x: Excitation,
    motion_z: Excitation | None = None,
    *,
    sweep: Mapping[str, ArrayLike],
    domain: bool = False,
    threads: int | None = None,
    progress: Progress | bool = False,
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
    accuracy_rad: float = ACCURACY_RAD,
    step_cap_s: float = math.inf,
    skip_start: bool = True,
    skip_rest: bool = True,
    skip_energy: bool = True,
) -> Ensemble:
    """Run every parameter set of a sweep for its outcome.

    sweep: arrays by name (SWEEPABLE) that broadcast against each other, their common shape being the result's: amplitude_m_s2,
    frequency_hz and phase_rad replace those of a harmonic or sine motion_x, scale and vertical_scale multiply the motions.
    domain: tell when each run left the model's domain (the pedestal tips, contact is lost, the statue slips on its support, which
    only this asks), at the cost of looking at its forces.
    threads: None for all cores; the result does not depend on it. progress: a callback, or True for a bar. The others
    are those of ``simulate`` that decide an outcome. Raises AnalyticInputError for unknown names and numbers that cannot be run.
    """
    shape, flat = flattened(sweep, SWEEPABLE)
    outcome_only: Keywords = {
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
        "accuracy_rad": accuracy_rad,
        "step_cap_s": step_cap_s,
        "skip_start": skip_start,
        "skip_rest": skip_rest,
        "skip_energy": skip_energy,
        "dt_s": None,
        "validity": domain,
    }
    rows = _rows(*stated(block, motion_x, motion_z, outcome_only), flat)
    out = Out.of(math.prod(shape))
    in_pieces(partial(run_rows, rows, out), math.prod(shape), threads, progress)

    def shaped(column: NDArray[Any]) -> NDArray[Any]:
        return np.ascontiguousarray(column).reshape(shape)

    outcome = shaped(out.states["outcome"])
    falls = (outcome == OVERTURNED_LEFT) | (outcome == OVERTURNED_RIGHT)
    return Ensemble(
        codes=outcome,
        end_s=shaped(out.states["time_s"]),
        peak_theta_rad=np.abs(shaped(out.results["peak_theta_rad"])),
        peak_slip_m=shaped(out.results["peak_slip_m"]),
        overturn_time_s=shaped(out.results["overturn_time_s"]),
        no_return_time_s=np.where(falls, shaped(out.results["no_return_time_s"]), np.nan),
        left_domain_s=shaped(out.results["left_domain_s"]) if domain else np.full(shape, np.nan),
        impacts=shaped(out.counts["impacts"]),
        steps=shaped(out.counts["steps"]),
    )


def flattened(
    sweep: Mapping[str, ArrayLike], known: tuple[str, ...]
) -> tuple[tuple[int, ...], dict[str, NDArray[np.float64]]]:
    """The shape of a sweep, and each of its arrays, by its name, broadcast to it and flat.

    Raises AnalyticInputError for other names than those known, for none, and for numbers that are not finite.
    """
    unknown = ", ".join(sorted(set(sweep) - set(known)))
    require(sweep and not unknown, "sweep: some of {} are wanted, {} came.", ", ".join(known), unknown or "none")
    columns = {name: np.asarray(values, dtype=np.float64) for name, values in sweep.items()}
    wrong = [name for name, values in columns.items() if not np.isfinite(values).all()]
    require(not wrong, "sweep: finite numbers are wanted in {}.", ", ".join(wrong))
    shape = np.broadcast_shapes(*(values.shape for values in columns.values()))
    return shape, {name: np.broadcast_to(values, shape).ravel() for name, values in columns.items()}


def _rows(problem: Problem, options: Options, sweep: Mapping[str, Floats]) -> Rows:
    """The kernel's records row by row, and the shared samples."""
    block = problem.block
    size = next(iter(sweep.values())).size
    params = np.repeat(np.array([row(encode(problem, options))], PARAMS), size)
    *given, samples = _encoded([(problem.motion_x, problem.motion_z)])
    xs, zs = (np.repeat(each, size) for each in given)
    corners_x, corners_z, facets = (np.tile(each, (size, 1)) for each in block.arrays)
    for name, values in sweep.items():
        if name in _PARAMETERS:
            params[name] = values * HELD if name == "statue_friction" else values
        elif name in _BASE:
            require(len(block.profile_m) == 2, "sweep: {} belongs to a block of two corners.", name)
            corners_x[:, _BASE.index(name)] = -values if name == "corner_left_m" else values
        else:
            _vary_motion(name, values, xs, zs)
    if "floor_impact" not in sweep and problem.floor_impact in ("kinetic", "static"):
        params["floor_impact"] = params[f"floor_{problem.floor_impact}"]
    require(
        problem.wall is None or not set(sweep) & set(_BASE),
        "sweep: corners are wanted without a wall: its place is told from one of them.",
    )
    _check(params, corners_x, xs)
    if set(sweep) & {"mass_kg", "centroid_height_m", "inertia_kg_m2", "gravity_m_s2", *_BASE}:
        params["time_scale_s"] = _time_scale(params, corners_x, corners_z)
    bases, start = np.zeros(size, BASE), np.arange(size)
    for name, each in (("x", corners_x), ("z", corners_z), ("facets", facets)):
        bases[name] = each.ctypes.data + start * each.strides[0]
    bases["n_facets"] = facets.shape[1]
    shared = encode_base(problem)
    for name in ("stands", "outline_x", "outline_z", "n_outline"):
        bases[name] = getattr(shared, name)
    outline = () if problem.wall is None else problem.wall.arrays
    return Rows(params, xs, zs, bases, (corners_x, corners_z, facets, *samples, block.stands_m, *outline))


def _time_scale(params: Records, corners_x: Floats, corners_z: Floats) -> Floats:
    """1/p of each row's faster outer corner, s."""
    mass, weight = params["mass_kg"], params["mass_kg"] * params["gravity_m_s2"]
    scale = np.full(len(params), np.inf)
    for k in (0, -1):
        radius = np.hypot(corners_x[:, k], params["centroid_height_m"] - corners_z[:, k])
        scale = np.minimum(scale, np.sqrt((params["inertia_kg_m2"] + mass * radius**2) / (weight * radius)))
    return scale


def _vary_motion(name: str, values: Floats, xs: Records, zs: Records) -> None:
    if name in ("scale", "vertical_scale"):
        rows = xs if name == "scale" else zs
        rows["amplitude_m_s2"] *= values
        rows["scale"] *= values
        return
    kind = int(xs["kind"][0])
    require(
        kind in (HARMONIC, SINE, COSINE, RECTANGULAR),
        "sweep: {} needs a harmonic or pulse motion_x; use scale for records.",
        name,
    )
    if name in ("amplitude_m_s2", "phase_rad"):
        xs[name] = values
        return
    require(kind != RECTANGULAR, "sweep: a rectangular pulse has no frequency_hz.")
    xs["omega_rad_s"] = TWO_PI * values
    if kind != HARMONIC:
        xs["end_s"] = xs["start_s"] + 1.0 / values


def _check(params: Records, corners_x: Floats, xs: Records) -> None:
    positive = [
        params[each] for each in ("mass_kg", "centroid_height_m", "inertia_kg_m2", "duration_s", "gravity_m_s2")
    ]
    acts, kinetic, static = params["floor_impact"], params["floor_kinetic"], params["floor_static"]
    floor, starts = ~params["has_pedestal"], np.abs(params["theta0_rad"]) < params["overturn_rad"]
    holds = {
        "positive masses, lengths, inertias, durations and gravities are wanted": (
            np.array([*positive, -corners_x[:, 0], corners_x[:, -1]]) > 0.0
        ),
        "0 ≤ floor_kinetic ≤ floor_static is wanted": (kinetic >= 0.0) & (kinetic <= static),
        "floor_kinetic ≤ floor_impact ≤ floor_static is wanted": floor | ((kinetic <= acts) & (acts <= static)),
        "positive pedestal masses are wanted": floor | (params["pedestal_mass_kg"] > 0.0),
        "|theta0_rad| below the overturning limit and ratios up to 1 are wanted": starts
        & (params["restitution"] <= 1.0),
        "positive frequencies are wanted": (xs["omega_rad_s"] >= 0.0) | (xs["kind"] == NONE),
    }
    for wanted, each in holds.items():
        require(each.all(), "sweep: {}.", wanted)


def in_pieces(
    work: Callable[[int, int], Piece],
    size: int,
    threads: int | None,
    progress: Progress | bool = False,
    most: int | None = None,
) -> list[Piece]:
    """What work(start, stop) gives of pieces of so many rows, at most `most` in each, shared among threads (None: all cores)."""
    workers = threads or os.cpu_count() or 1
    # Of no rows one empty piece: its parts have their shapes and kinds still.
    step = max(1, min(most or size, -(-size // (workers * CHUNKS_PER_THREAD))))
    with ThreadPoolExecutor(workers) as pool:
        waiting = {
            pool.submit(work, start, min(start + step, size)): min(step, size - start)
            for start in range(0, max(size, 1), step)
        }
        ended: Iterable[Future[Piece]] = as_completed(waiting)
        if progress is True:
            from rich.progress import track

            ended = track(ended, "runs", total=len(waiting))
        done = 0
        for future in ended:
            future.result()
            done += waiting[future]
            if callable(progress):
                progress(done, size)
        return [each.result() for each in waiting]
