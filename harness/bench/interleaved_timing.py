"""Times of solvers that take turns: what one of them meets of the machine's moods, the others meet too."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from harness.bench.timing import costs
from harness.records.bench import SolverRow

Answer = tuple[NDArray[np.float64], int]
"""θ at a case's instants, or at the last of them, rad, and the work by the solver's own measure."""


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
