"""Times of solvers that take turns: what one of them meets of the machine's moods, the others meet too."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Answer = tuple[NDArray[np.float64], int]
"""θ at a case's instants, or at the last of them, rad, and the work by the solver's own measure."""


class Entry(NamedTuple):
    """What is timed of a solver, and how it is set beyond its tolerance."""

    solver: str
    tolerance: float
    solve: Callable[[], Answer]
    how: str = ""


def take_turns(case: str, exact: NDArray[np.float64], entries: Sequence[Entry], rounds: int) -> list[dict[str, Any]]:
    """A row for each entry: its error against the exact θ, rad, and the least processor time of all rounds, s."""
    best, answers = [math.inf] * len(entries), [(np.empty(0), 0)] * len(entries)
    for _ in range(rounds):
        for i, entry in enumerate(entries):
            start = time.process_time()
            answers[i] = entry.solve()
            best[i] = min(best[i], time.process_time() - start)
    rows = []
    for entry, (theta, work), seconds in zip(entries, answers, best, strict=True):
        row = {"case": case, "solver": entry.solver, "how": entry.how, "tolerance": entry.tolerance, "work": work}
        rows.append(row | {"error_rad": float(np.abs(theta - exact[-theta.size :]).max()), "seconds": seconds})
    return rows
