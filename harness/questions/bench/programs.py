"""Measurements that whoever measures brings along: each is a module that runs in a process of its own and prints rows.

A command without them leaves their parts out, and its record says so.
"""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, TypeVar

from harness.runs.parts import Row

# What a piece of work costs: best of several, after a warm-up, by the clock and by the processor.

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
    walls = [[item.wall_s] for item in first] if first is not None else [[] for _ in works]
    cpus = [[item.cpu_s] for item in first] if first is not None else [[] for _ in works]
    for _ in range(repeats):
        for work, wall_s, cpu_s in zip(works, walls, cpus, strict=True):
            if sum(cpu_s) >= budget_s:
                continue
            spent = timed(work)[1]
            wall_s.append(spent.wall_s)
            cpu_s.append(spent.cpu_s)
    return [Cost(min(wall_s), min(cpu_s), len(wall_s)) for wall_s, cpu_s in zip(walls, cpus, strict=True)]


def peak_memory_mb() -> float:
    """Largest resident memory of this process so far, MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def largest_child_mb() -> float:
    """Largest resident memory of any ended child of this process, MB."""
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024.0


Programs = Mapping[str, str]
"""Modules by what they measure."""
NONE: Final[Programs] = MappingProxyType({})


def absent(programs: Programs, wanted: Iterable[str]) -> dict[str, str]:
    """What is wanted and not brought along, and why it is left out: a code."""
    return {name: "no_program" for name in wanted if name not in programs}


def ask(module: str, *words: str) -> subprocess.CompletedProcess[str]:
    """Run a module with these arguments to its end, whatever it ends with."""
    return subprocess.run([sys.executable, "-m", module, *words], capture_output=True, text=True, check=False)


def rows(module: str, *words: str) -> list[Row]:
    """What a module prints with these arguments, a row in each line. Raises `CalledProcessError` where it fails."""
    done = ask(module, *words)
    done.check_returncode()
    return [json.loads(line) for line in done.stdout.splitlines()]
