"""One run of the two-block model: a problem in, a frozen solution out; between them the memory of its task."""

from __future__ import annotations

import ctypes
import math
from struct import Struct
from typing import Final, NamedTuple, Self, Unpack

import numpy as np
from numpy.typing import NDArray

from analytic.block import Block
from analytic.encode import encode, encode_base, encode_motion
from analytic.excitation import Excitation
from analytic.kernel.layout import EVENT_ROW, TASK, packing
from analytic.kernel.records import Base, Counts, MotionParams, Output, Params, Records, Results, State
from analytic.machine_code import Entry
from analytic.problem import DEFAULT_OPTIONS, Keywords, Options, Problem, stated
from analytic.results import Solution, solution_of

run: Final = Entry("analytic.kernel.entries", "run")
ALONE: Final = (0, 0, 0, 0, 0, 1, 0, 0, 0)
"""Arguments after a task that is run as it stands."""


def address(memory: bytearray) -> int:
    """Where it stands, for as long as it lives."""
    return ctypes.addressof(ctypes.c_char.from_buffer(memory))


def _offset(*names: str) -> int:
    """Where a record stands in a task, bytes."""
    place, record = 0, TASK
    for name in names:
        assert record.fields is not None
        place, record = place + record.fields[name][1], record.fields[name][0]
    return place


_PARAMS, _STATE, _RESULTS = _offset("params"), _offset("state"), _offset("results")
_BASE, _OUTPUT = _offset("base"), _offset("output")
_COUNTS, _EVENTS, _SAMPLES = _offset("counts"), _offset("counts", "events"), _offset("output", "next_sample")
_MOTION_X, _MOTION_Z = _offset("motion_x", "params"), _offset("motion_z", "params")
_PACKING: Final = {each: packing(each) for each in (Params, MotionParams, Base, Output, State, Results, Counts)}
_INTEGER: Final = Struct("q")


class Prepared(NamedTuple):
    """The memory of a task, and what it knows by address only."""

    memory: bytearray
    history: NDArray[np.float64]
    """Rows of t, θ, θ̇, u, u̇, (5, n)."""
    events: Records
    """(m,)"""
    owners: tuple[object, ...]
    """Whose numbers motions and base name by address: kept alive."""

    @classmethod
    def of(
        cls,
        params: Params,
        motions: tuple[MotionParams, MotionParams],
        base: Base,
        instants: int,
        event_rows: int,
        *owners: object,
    ) -> Self:
        """A task with its parameters written, and room for so many instants and events."""
        memory = bytearray(TASK.itemsize)
        history, events = np.zeros((5, instants)), np.zeros(event_rows, EVENT_ROW)
        output = Output(history.ctypes.data, max(instants - 1, 0), 0, events.ctypes.data, event_rows)
        places = (_PARAMS, params), (_MOTION_X, motions[0]), (_MOTION_Z, motions[1]), (_BASE, base), (_OUTPUT, output)
        for place, record in places:
            _PACKING[type(record)].pack_into(memory, place, *vars(record).values())
        return cls(memory, history, events, owners)

    def run(self) -> None:
        """Run the task."""
        run(address(self.memory), *ALONE)

    @property
    def state(self) -> State:
        """The state that the run ended in."""
        return State(*_PACKING[State].unpack_from(self.memory, _STATE))

    @property
    def results(self) -> Results:
        """What the run left behind."""
        return Results(*_PACKING[Results].unpack_from(self.memory, _RESULTS))

    @property
    def counts(self) -> Counts:
        """How often what happened."""
        return Counts(*_PACKING[Counts].unpack_from(self.memory, _COUNTS))

    @property
    def n_samples(self) -> int:
        """Output samples written."""
        return int(_INTEGER.unpack_from(self.memory, _SAMPLES)[0])

    @property
    def n_events(self) -> int:
        """Events of the run, whether or not the table had room for them."""
        return int(_INTEGER.unpack_from(self.memory, _EVENTS)[0])


FIRST_EVENTS: Final = 256
"""Rows of the event table at the first try; a run that has more is repeated with enough."""
WHOLE: Final = 1.0 + 1e-12
"""A duration that is a multiple of the output step to rounding has that many samples."""


def prepare(problem: Problem, params: Params, event_rows: int) -> Prepared:
    """Everything that one run reads and writes, freshly allocated."""
    x, times_x, samples_x = encode_motion(problem.motion_x)
    z, times_z, samples_z = encode_motion(problem.motion_z)
    dt = params.output_step_s
    instants = math.floor(params.duration_s / dt * WHOLE) + 2 if dt > 0.0 else 0
    base = encode_base(problem.block)
    return Prepared.of(
        params, (x, z), base, instants, event_rows, problem.block, times_x, times_z, samples_x, samples_z
    )


def _read(params: Params, finished: Prepared) -> Solution:
    """The solution that a finished task holds; its arrays are read-only."""
    history, events = finished.history, finished.events
    history.setflags(write=False)
    written = history[:, : finished.n_samples], events[: finished.n_events]
    return solution_of(params, finished.state, finished.results, finished.counts, *written)


def solve(problem: Problem, options: Options = DEFAULT_OPTIONS) -> Solution:
    """Run the model of docs/model.md, sections 1 to 5 and 8."""
    params = encode(problem, options)
    task = prepare(problem, params, FIRST_EVENTS if options.events else 0)
    task.run()
    if options.events and task.n_events > FIRST_EVENTS:
        task = prepare(problem, params, task.n_events)
        task.run()
    return _read(params, task)


def simulate(
    block: Block, motion_x: Excitation, motion_z: Excitation | None = None, **keywords: Unpack[Keywords]
) -> Solution:
    """Run the model of docs/model.md, sections 1 to 5 and 8: ``solve`` with the fields of `Problem` and `Options` as keywords.

    motion_x, motion_z: the floor's accelerations; duration_s must be given. Raises AnalyticInputError for numbers that cannot
    be run.
    """
    return solve(*stated(block, motion_x, motion_z, keywords))
