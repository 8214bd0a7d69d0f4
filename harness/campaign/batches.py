"""What studies and validations share in handing runs to workers: grouping into batches, and a dead worker's answers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import groupby
from typing import Any, Protocol, TypeVar

from harness.accuracy.simulation import failed
from harness.campaign.runner import Crash, Hung, Pool
from harness.model.history import Outcome
from harness.model.run import Run


class Job(Protocol):
    """A run to compute, of which only the engine matters here."""

    @property
    def engine(self) -> str:
        """The engine's name."""


J = TypeVar("J", bound=Job)


def batches(jobs: Iterable[J], sizes: Mapping[str, int], otherwise: int) -> Iterator[tuple[J, ...]]:
    """Jobs in the order given, neighbours of one engine in what a worker takes at a time (`otherwise`: not in `sizes`)."""
    for name, members in groupby(jobs, key=lambda job: job.engine):
        size = sizes.get(name, otherwise)
        batch: list[J] = []
        for job in members:
            batch.append(job)
            if len(batch) == size:
                yield tuple(batch)
                batch = []
        if batch:
            yield tuple(batch)


def run_batches(
    pool: Pool,
    work: Callable[[tuple[J, ...]], Any],
    tasks: Iterable[tuple[J, ...]],
    done: Callable[[tuple[J, ...], Any], None],
) -> None:
    """Run batches; one whose process died is run again job by job, so that a crash is charged to its own job only.

    `done(batch, result)` hears of each batch once, as it finishes: the result, or the `Crash` of a batch of one job. Any other
    exception of the work is raised.
    """
    again: list[tuple[J, ...]] = []

    def told(batch: tuple[J, ...], result: Any | BaseException) -> None:
        if isinstance(result, Crash) and len(batch) > 1:
            again.extend((job,) for job in batch)
        elif isinstance(result, BaseException) and not isinstance(result, Crash):
            raise result
        else:
            done(batch, result)

    pool.run(work, tasks, told)
    if again:
        pool.run(work, again, told)


def crashed(batch: Sequence[Job], crash: Crash) -> list[Run]:
    """The runs of a batch whose process died or hung: each says so."""
    if isinstance(crash, Hung):
        return [failed(job.engine, Outcome.TIMED_OUT, f"the engine's process was ended: {crash}") for job in batch]
    return [failed(job.engine, Outcome.CRASHED, f"the engine's process died: {crash}") for job in batch]
