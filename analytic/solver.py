"""One run of the two-block model: a problem in, a frozen solution out."""

from __future__ import annotations

import math
from typing import Final, Unpack

from analytic.block import Block
from analytic.encode import encode, encode_base, encode_motion
from analytic.excitation import Excitation
from analytic.kernel.records import Params
from analytic.problem import DEFAULT_OPTIONS, Keywords, Options, Problem, stated
from analytic.results import Prepared, read
from analytic.solution import Solution

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


def solve(problem: Problem, options: Options = DEFAULT_OPTIONS) -> Solution:
    """Run the model of docs/model.md, sections 1 to 5 and 8."""
    params = encode(problem, options)
    task = prepare(problem, params, FIRST_EVENTS if options.events else 0)
    task.run()
    if options.events and task.n_events > FIRST_EVENTS:
        task = prepare(problem, params, task.n_events)
        task.run()
    return read(params, task)


def simulate(
    block: Block, motion_x: Excitation, motion_z: Excitation | None = None, **keywords: Unpack[Keywords]
) -> Solution:
    """Run the model of docs/model.md, sections 1 to 5 and 8: ``solve`` with the fields of `Problem` and `Options` as keywords.

    motion_x, motion_z: the floor's accelerations; duration_s must be given. Raises AnalyticInputError for numbers that cannot
    be run.
    """
    return solve(*stated(block, motion_x, motion_z, keywords))
