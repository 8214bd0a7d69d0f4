"""What studies and validations share in handing runs to workers: grouping into batches, and a dead worker's answers."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Protocol, TypeVar

from harness.executors import Crash
from harness.history import Outcome
from harness.record import Run
from harness.run import failed


class Job(Protocol):
    """A run to compute, of which only the engine matters here."""

    @property
    def engine(self) -> str:
        """The engine's name."""


J = TypeVar("J", bound=Job)


def batches(jobs: Sequence[J], sizes: Mapping[str, int], otherwise: int) -> list[tuple[J, ...]]:
    """Jobs in the order given, by engine into what a worker takes at a time (`otherwise`: an engine not in `sizes`)."""
    groups: dict[str, list[J]] = defaultdict(list)
    for job in jobs:
        groups[job.engine].append(job)
    found = []
    for name, members in groups.items():
        size = sizes.get(name, otherwise)
        found += [tuple(members[i : i + size]) for i in range(0, len(members), size)]
    return found


def runs_of(batch: Sequence[Job], results: Sequence[Run] | BaseException) -> Sequence[Run]:
    """A batch's runs; a dead process is a failure of each of them, any other exception is raised."""
    if isinstance(results, Crash):
        return [failed(job.engine, Outcome.CRASHED, f"the engine's process died: {results}") for job in batch]
    if isinstance(results, BaseException):
        raise results
    return results
