"""Many runs: what the store holds is not computed again, each is kept as soon as it is there, and where the seconds go."""

import statistics
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import replace
from itertools import groupby, islice
from pathlib import Path
from typing import Any, Final

import numpy as np

from harness.model import NUMBERS, Column, InputError, Mistake, RunSet, require
from harness.model.run_set import run_set
from harness.records.base import Plain
from harness.records.study import UsageRecord, impacts
from harness.runs.runner import Crash, DaskPool, InlinePool, LocalPool, Pool
from harness.runs.store import MEMORY, Packed, Store, packed
from harness.runs.task import RunRequest, Task

OnProgress = Callable[[int, int], None]
"""Hears how many tasks are done, and how many there are to do."""
MOST_SHOWN: Final = 80
"""Characters of a wrong argument that an error shows."""
KEPT: Final = "what was finished is kept"
"""Noted in an interrupt of a campaign: the same call goes on where it was."""


def silent(done: int, total: int) -> None:
    """Hears nothing."""


def execute(
    requests: Iterable[RunRequest],
    store: Path | str | None = None,
    *,
    title: str = "",
    jobs: int = 1,
    dask: str | None = None,
    on_progress: OnProgress = silent,
) -> RunSet:
    """Compute the runs that a store lacks; all of them as one table in the order in which they were asked for.

    >>> wanted = [harness.RunRequest(scene, name, history=True) for name in ("analytic", "pymunk")]
    >>> runs = harness.execute(wanted, "out/runs.sqlite", jobs=2)
    >>> runs.history(1).theta_rad

    `store` is a file that is made where it is not there; the same call goes on where an interrupt left it. Without one nothing is
    kept. `jobs` processes, or the Dask cluster of the scheduler at `dask`. A run that fails, or takes its process with it, is a
    row that says so.

    Raises `InputError` for an engine that is not known, or a file that is no store.
    """
    wanted = list(requests) if isinstance(requests, Iterable) else []
    if not wanted or not all(isinstance(each, RunRequest) for each in wanted):
        shown = repr(wanted or requests)[:MOST_SHOWN]
        raise InputError(Mistake("execute", "requests", "a list of RunRequest, at least one", shown))
    require(type(jobs) is int and jobs >= 1, "execute", "a number of processes, 1 or more", repr(jobs), key="jobs")
    # A function of the caller's script, that makes a scene, is not known to a worker.
    tasks = [replace(request, scene=request.made()).task() for request in wanted]
    with Store(Path(MEMORY if store is None else store)) as kept, closing(pool_of(jobs, dask)) as pool:
        # A run that took its process with it has a record that says so.
        records = [record for record in Campaign(kept, pool, on_progress).ask(tasks) if record is not None]
        histories = [
            kept.history(task.key) if request.history else None for request, task in zip(wanted, tasks, strict=True)
        ]
    varied, names = [each.varied for each in wanted], [each.engine for each in wanted]
    outcomes = [str(record["outcome"]) for record in records]
    asked = histories if any(each.history for each in wanted) else ()
    return run_set(title, varied, names, outcomes, numbers_of(records), asked)


def pool_of(jobs: int, dask: str | None) -> Pool:
    """This process where one is enough, so many others, or a cluster's."""
    if dask is not None:
        return DaskPool(dask)
    return LocalPool(jobs) if jobs > 1 else InlinePool()


def numbers_of(records: Sequence[Mapping[str, Any]]) -> dict[str, Column]:
    """The numbers and counts of stored runs, by column; peaks by their size."""
    numbers = {
        name: np.array(
            [otherwise if (value := each.get(name)) is None else value for each in records], dtype=np.float64
        )
        for name, otherwise in NUMBERS.items()
    }
    return numbers | {
        "peak_theta_rad": np.abs(numbers["peak_theta_rad"]),
        "steps": np.array([each["steps"] for each in records]),
        "impacts": np.array([impacts(each) for each in records]),
    }


def compute(batch: Sequence[Task]) -> list[Packed]:
    """What a worker does: each task of a batch, and its answer packed."""
    answers = []
    for task in batch:
        begin = time.perf_counter()
        answer = packed(task.key, task.work(task.argument))
        answers.append(replace(answer, busy_s=time.perf_counter() - begin))
    return answers


def batches(tasks: Iterable[Task], sizes: Mapping[str, int], otherwise: int = 1) -> Iterator[tuple[Task, ...]]:
    """Tasks in the order given, neighbours of one group in what a worker takes at a time (`otherwise`: not in `sizes`)."""
    for group, members in groupby(tasks, key=lambda task: task.group):
        while batch := tuple(islice(members, sizes.get(group, otherwise))):
            yield batch


class Campaign:
    """The tasks of one call; `run` may be called again with what the results of the last call ask for.

    `sizes` are the tasks of a group that a worker takes at a time. `reused` are keys that the store held, with their runs.
    `free` are groups that cost next to nothing beside the others: progress does not
    count them, so that its rate tells the time that is left.
    """

    def __init__(
        self,
        store: Store,
        pool: Pool,
        on_progress: OnProgress = silent,
        sizes: Mapping[str, int] | None = None,
        otherwise: int = 1,
        free: Sequence[str] = (),
    ) -> None:
        self._store, self._pool, self._on_progress = store, pool, on_progress
        self._sizes, self._otherwise = sizes or {}, otherwise
        self._stored = store.keys()
        self._seen: set[str] = set()
        self._expected = self._told = 0
        self._free = free
        self._clock_s = time.perf_counter()
        self.reused: dict[str, int] = {}
        self.computed = self.failed = 0
        self._asked: dict[str, None] = {}
        self._busy_s = 0.0
        self._outside_s: list[float] = []
        self._begin = time.perf_counter(), time.process_time()

    def ask(self, tasks: Sequence[Task]) -> list[Plain | None]:
        """The records of the tasks' results in their order, those that the store lacks computed; None where a worker died."""
        self.run(tasks, sum(task.runs for task in tasks if task.group not in self._free))
        self._asked |= dict.fromkeys(task.key for task in tasks)
        return [self._store.get(task.key) for task in tasks]

    @property
    def asked_s(self) -> float:
        """What all answers that were asked for took, whenever they were found."""
        return sum(self._store.seconds(key) or 0.0 for key in self._asked)

    def run(self, tasks: Iterable[Task], expected: int) -> None:
        """Compute what the store does not hold, in the order in which it comes; so many tasks are expected.

        A batch whose worker died is run again task by task, so that a death is charged to its own task. An exception of a task is
        raised.
        """
        self._expected += expected
        again: list[tuple[Task, ...]] = []

        def done(batch: tuple[Task, ...], result: list[Packed] | Crash) -> None:
            if not isinstance(result, Crash):
                self._keep(batch, result)
            elif len(batch) > 1:
                again.extend((task,) for task in batch)
            else:
                self._keep(batch, self._lost(batch[0], result))

        try:
            self._pool.run(compute, batches(self._left(tasks), self._sizes, self._otherwise), done)
            self._pool.run(compute, again, done)
        except KeyboardInterrupt as ending:
            ending.add_note(KEPT)
            raise
        self._say_progress()

    def _left(self, tasks: Iterable[Task]) -> Iterator[Task]:
        """The tasks of which nobody has a result yet, and nobody is at work on."""
        begun = False
        for task in tasks:
            if task.key in self._stored:
                self.reused[task.key] = task.runs
            elif task.key not in self._seen:
                if not begun:  # what the store held is not told as left
                    self._say_progress()
                begun = True
                self._seen.add(task.key)
                yield task
                continue
            # What costs nothing is not counted: the rate at which the others finish tells the time that is left.
            self._expected -= task.runs * (task.group not in self._free)

    def _lost(self, task: Task, crash: Crash) -> list[Packed]:
        """What a task gives whose worker died."""
        if task.lost is None:
            self.failed += task.runs
            return []
        return [replace(packed(task.key, task.lost(task.argument, crash)), failed=1)]

    def _keep(self, batch: Sequence[Task], answers: Sequence[Packed]) -> None:
        now_s = time.perf_counter()
        self._store.add(answers, now_s - self._clock_s)
        self._clock_s = now_s
        runs = sum(task.runs for task in batch)
        self.computed += runs
        self._told += runs * (batch[0].group not in self._free)
        for task, answer in zip(batch, answers, strict=False):
            self.failed += answer.failed
            if answer.busy_s > 0.0:  # what was lost took nobody's time that is known
                self._busy_s += answer.busy_s
                self._outside_s.append((answer.busy_s - answer.inside_s) / task.runs)
        self._say_progress()

    def usage(self) -> UsageRecord:
        """Seconds of this call until now: of the clock, of all workers at work, of this process's processor, outside engines.

        `overhead_s_per_run` is planning, sending, packing and storing: this process's time by the run, and the median run's
        outside its engine. The median leaves out what a worker does once, such as loading the statue's mesh.
        """
        wall_s, own_s = time.perf_counter() - self._begin[0], time.process_time() - self._begin[1]
        runs, workers, outside = self.computed, self._pool.workers, self._outside_s
        return UsageRecord(
            workers=workers,
            runs=runs,
            wall_s=wall_s,
            busy_s=self._busy_s,
            own_s=own_s,
            utilisation=self._busy_s / (wall_s * workers) if runs else None,
            overhead_s_per_run=own_s / runs + statistics.median(outside) if outside else None,
        )

    def _say_progress(self) -> None:
        self._on_progress(self._told, max(self._expected, self._told))
