"""One run of the two-block model: a problem in, a frozen solution out; between them the memory of its task."""

from __future__ import annotations

import ctypes
import math
from typing import Final, Literal, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from analytic.block import Block, Form, Pedestal, Wall
from analytic.constants import GRAVITY_M_S2, OVERTURN_RAD
from analytic.encode import encode, encode_base, encode_motion
from analytic.excitation import Excitation, ZeroExcitation
from analytic.kernel.layout import EVENT_ROW, TASK, packing
from analytic.kernel.records import Base, Counts, MotionParams, Output, Params, Records, Results, State
from analytic.machine_code import Entry
from analytic.problem import CONSISTENT, DEFAULT_OPTIONS, Options, Problem
from analytic.results import NO_EVENTS, Solution, solution_of

run: Final = Entry("analytic.kernel.entries", "run")
Record = TypeVar("Record", State, Results, Counts, Output)
ALONE: Final = (0, 0, 0, 0, 0, 1, 0, 0, 0)
"""Arguments after a task that is run as it stands."""


def address(memory: bytearray | NDArray[np.generic]) -> int:
    """Where it stands, for as long as it lives; numpy itself takes a microsecond to say so."""
    return ctypes.addressof(ctypes.c_char.from_buffer(memory))  # type: ignore[arg-type]


def _offset(*names: str) -> int:
    """Where a record stands in a task, bytes."""
    place, record = 0, TASK
    for name in names:
        assert record.fields is not None
        place, record = place + record.fields[name][1], record.fields[name][0]
    return place


_WRITTEN: Final = (
    _offset("params"),
    _offset("motion_x", "params"),
    _offset("motion_z", "params"),
    _offset("base"),
    _offset("output"),
)
"""Where what a run reads stands in its task."""
_LEFT: Final = {
    State: _offset("state"),
    Results: _offset("results"),
    Counts: _offset("counts"),
    Output: _offset("output"),
}
"""Where what it leaves behind stands."""
_PACKING: Final = {each: packing(each) for each in (Params, MotionParams, Base, *_LEFT)}


class Prepared(NamedTuple):
    """The memory of a task, and what it knows by address only."""

    memory: bytearray
    history: NDArray[np.float64]
    """Rows of t, θ, θ̇, u, u̇, (5, n)."""
    events: Records
    """(m,)"""
    owners: tuple[object, ...]
    """Whose numbers motions and base name by address: kept alive."""

    def run(self) -> None:
        """Run the task."""
        run(address(self.memory), *ALONE)

    def read(self, record: type[Record]) -> Record:
        """One of the records that the run left behind."""
        return record(*_PACKING[record].unpack_from(self.memory, _LEFT[record]))


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
    history, events = np.zeros((5, instants)), np.zeros(event_rows, EVENT_ROW) if event_rows else NO_EVENTS
    table, rows = (address(each) if each.size else 0 for each in (history, events))
    output = Output(table, max(instants - 1, 0), 0, rows, event_rows)
    for place, record in zip(_WRITTEN, (params, x, z, encode_base(problem), output), strict=True):
        _PACKING[type(record)].pack_into(memory, place, *vars(record).values())
    return Prepared(memory, history, events, (problem.block, problem.wall, times_x, times_z, samples_x, samples_z))


def _read(params: Params, finished: Prepared, counts: Counts) -> Solution:
    """The solution that a finished task holds; its arrays are read-only."""
    n_samples = finished.read(Output).next_sample
    finished.history.setflags(write=False)
    written = finished.history[:, :n_samples], finished.events[: counts.events]
    return solution_of(params, finished.read(State), finished.read(Results), counts, *written)


def solve(problem: Problem, options: Options = DEFAULT_OPTIONS) -> Solution:
    """Run the model of docs/model.md, sections 1 to 5 and 8."""
    params = encode(problem, options)
    task = prepare(problem, params, FIRST_EVENTS if options.events else 0)
    task.run()
    counts = task.read(Counts)
    if options.events and counts.events > FIRST_EVENTS:
        task = prepare(problem, params, counts.events)
        task.run()
        counts = task.read(Counts)
    return _read(params, task, counts)


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
