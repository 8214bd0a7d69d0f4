"""Many runs in three dimensions for their outcome, in parallel."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.block import require
from analytic.kernel.records import Records
from analytic.spatial.kernel.codes import OVERTURNED
from analytic.spatial.kernel.records import MOST
from analytic.spatial.problem import Floats, Problem
from analytic.spatial.solution import OUTCOMES
from analytic.spatial.solver import prepare, run_all
from analytic.sweep import flattened, in_pieces

SWEEPABLE: Final = ("scale", "vertical_scale", "heading_rad", "friction")
"""What a sweep may vary: factors of all motions and of the vertical one, the body's heading (turned to the left, so that
the motion comes from the other side), the coefficient of friction (both)."""
TOLERANCE: Final = 1e-7
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
    tolerance: float = TOLERANCE,
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
        part = {name: values[start:stop] for name, values in flat.items()}
        return _run(task.run, task.memory, part, stop - start)

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


def _run(run: Records, memory: Records, part: Mapping[str, Floats], size: int) -> tuple[Records, Floats]:
    """The records and the last attitudes (size, 4) of a piece of the sweep."""
    runs, memories = np.repeat(run, size), np.repeat(memory, size)
    for name, values in part.items():
        if name in ("scale", "vertical_scale"):
            scaled = memories["motions"]["params"][:, 0 if name == "scale" else 2 :]
            scaled["amplitude_m_s2"] *= values[:, None]
            scaled["scale"] *= values[:, None]
        elif name == "friction":
            runs["friction_static"], runs["friction_kinetic"] = values, values
        else:
            _turn(memories["y"], values)
    run_all(runs, memories)
    return runs, memories["y"][:, 3:7].copy()


def _turn(y: Floats, heading_rad: Floats) -> None:
    """Turn initial states (n, 15) about the table's z: place, attitude and velocity."""
    c, s = np.cos(0.5 * heading_rad), np.sin(0.5 * heading_rad)
    w, x, y_, z = y[:, 3:7].T.copy()
    y[:, 3], y[:, 4], y[:, 5], y[:, 6] = c * w - s * z, c * x - s * y_, c * y_ + s * x, c * z + s * w
    c, s = np.cos(heading_rad), np.sin(heading_rad)
    for first in (0, 7):
        a, b = y[:, first].copy(), y[:, first + 1].copy()
        y[:, first], y[:, first + 1] = c * a - s * b, s * a + c * b
