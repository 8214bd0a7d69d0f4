"""What a piece of work costs: best of several, after a warm-up, by the clock and by the processor."""

import resource
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, TypeVar

T = TypeVar("T")
REPEATS: Final = 5
BUDGET_S: Final = 1.0
"""Processor time after which no further repetition is begun: a slow run needs fewer to be timed to a percent."""


@dataclass(frozen=True)
class Cost:
    """Least seconds of several runs: by the clock, and of this process's processor time (other processes do not enter it)."""

    wall_s: float
    cpu_s: float
    repeats: int


def cost(work: Callable[[], object], repeats: int = REPEATS, budget_s: float = BUDGET_S) -> Cost:
    """Time some work that has been done once already (compiled, loaded, cached)."""
    return costs([work], repeats, budget_s)[0]


def timed(work: Callable[[], T]) -> tuple[T, Cost]:
    """What one piece of work gives, and its cost this once."""
    wall, cpu = time.perf_counter(), time.process_time()
    result = work()
    return result, Cost(time.perf_counter() - wall, time.process_time() - cpu, 1)


def costs(
    works: Sequence[Callable[[], object]],
    repeats: int = REPEATS,
    budget_s: float = BUDGET_S,
    first: Sequence[Cost] | None = None,
) -> list[Cost]:
    """The same of several pieces that take turns: what one meets of the machine's moods, the others meet too.

    `first` is what each took before: one that took the budget is not done again.
    """
    spent = [[each] for each in first] if first is not None else [list[Cost]() for _ in works]
    for _ in range(repeats):
        for work, mine in zip(works, spent, strict=True):
            if sum(each.cpu_s for each in mine) < budget_s:
                mine.append(timed(work)[1])
    return [Cost(min(each.wall_s for each in mine), min(each.cpu_s for each in mine), len(mine)) for mine in spent]


def peak_memory_mb(whose: int = resource.RUSAGE_SELF) -> float:
    """Largest resident memory of this process so far, or of any ended child of it (`resource.RUSAGE_CHILDREN`), MB."""
    return resource.getrusage(whose).ru_maxrss / 1024.0
