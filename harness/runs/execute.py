"""Many tasks: what the store holds is not computed again, each is kept as soon as it is there, and where the seconds go."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from itertools import groupby, islice
from typing import Any, Final

from harness.records.study import UsageRecord
from harness.runs.runner import Crash, Pool
from harness.runs.store import Packed, Store, packed
from harness.runs.task import Answer, Task

OnProgress = Callable[[int, int], None]
"""Hears how many tasks are done, and how many there are to do."""
KEPT: Final = "what was finished is kept"
"""Noted in an interrupt of a campaign: the same call goes on where it was."""
Order = tuple[str, Callable[[Any], Answer], Any]
"""What travels of a task: its key, its function, and the function's argument."""


def silent(done: int, total: int) -> None:
    """Hears nothing."""


@dataclass(frozen=True)
class Finished:
    """What a worker gives back: an answer for each order, packed where it is kept, and seconds: all, and each task's overhead."""

    answers: Sequence[Packed | Answer]
    failed: int
    busy_s: float
    outside_s: Sequence[float]


def compute(batch: tuple[int, Sequence[Order]]) -> Finished:
    """What a worker does: each task of a numbered batch, and its answer packed."""
    begin, failed, answers, outside_s = time.perf_counter(), 0, [], []
    for key, work, argument in batch[1]:
        start = time.perf_counter()
        answer = work(argument)
        failed += answer.failed
        answers.append(packed(key, answer) if key else answer)
        outside_s.append(time.perf_counter() - start - answer.inside_s)
    return Finished(answers, failed, time.perf_counter() - begin, outside_s)


def batches(tasks: Iterable[Task], sizes: Mapping[str, int], otherwise: int = 1) -> Iterator[tuple[Task, ...]]:
    """Tasks in the order given, neighbours of one group in what a worker takes at a time (`otherwise`: not in `sizes`)."""
    for group, members in groupby(tasks, key=lambda task: task.group):
        size = sizes.get(group, otherwise)
        while batch := tuple(islice(members, size)):
            yield batch


class Campaign:
    """The tasks of one call; `run` may be called again with what the results of the last call ask for.

    `sizes` are the tasks of a group that a worker takes at a time. `reused` are keys that the store held; `latest` is the task
    that finished last. `free` are groups that cost next to nothing beside the others: progress does not count them, so that its
    rate tells the time that is left. Tasks without a key, of a group of their own, are not counted: their answers are `aside`.
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
        self.reused: set[str] = set()
        self.computed = self.failed = 0
        self.aside: list[tuple[Task, Answer]] = []
        self.latest: Task | None = None
        self.usage = Usage(pool.workers)

    def run(self, tasks: Iterable[Task], expected: int) -> None:
        """Compute what the store does not hold, in the order in which it comes; so many tasks are expected.

        A batch whose worker died is run again task by task, so that a death is charged to its own task. An exception of a task is
        raised.
        """
        self._expected += expected
        self._say_progress()
        again: list[tuple[Task, ...]] = []

        def done(batch: tuple[Task, ...], result: Finished | Crash) -> None:
            if isinstance(result, Crash) and len(batch) > 1:
                again.extend((task,) for task in batch)
            else:
                self._keep(batch, _lost(batch[0], result) if isinstance(result, Crash) else result)

        try:
            self._run(batches(self._left(tasks), self._sizes, self._otherwise), done)
            self._run(again, done)
        except KeyboardInterrupt as ending:
            ending.add_note(KEPT)
            raise
        self._say_progress()

    def _run(
        self, tasks: Iterable[tuple[Task, ...]], done: Callable[[tuple[Task, ...], Finished | Crash], None]
    ) -> None:
        waiting: dict[int, tuple[Task, ...]] = {}

        def orders() -> Iterator[tuple[int, list[Order]]]:
            for number, batch in enumerate(tasks):
                waiting[number] = batch
                yield number, [(task.key, task.work, task.argument) for task in batch]

        self._pool.run(compute, orders(), lambda order, result: done(waiting.pop(order[0]), result))

    def _left(self, tasks: Iterable[Task]) -> Iterator[Task]:
        """The tasks of which nobody has a result yet, and nobody is at work on."""
        for task in tasks:
            if not task.key:
                yield task
                continue
            if task.key in self._stored:
                self.reused.add(task.key)
            elif task.key not in self._seen:
                self._seen.add(task.key)
                yield task
                continue
            # What costs nothing is not counted: the rate at which the others finish tells the time that is left.
            self._expected -= task.runs * (task.group not in self._free)

    def _keep(self, batch: Sequence[Task], result: Finished) -> None:
        if not batch[0].key:
            self.aside += [
                (task, answer) for task, answer in zip(batch, result.answers, strict=True) if isinstance(answer, Answer)
            ]
            return
        now_s = time.perf_counter()
        self._store.add([item for item in result.answers if isinstance(item, Packed)], now_s - self._clock_s)
        self._clock_s = now_s
        self.latest = batch[-1]
        runs = sum(task.runs for task in batch)
        self.computed += runs
        self._told += runs * (batch[0].group not in self._free)
        self.failed += result.failed
        outside_s = [seconds / task.runs for task, seconds in zip(batch, result.outside_s, strict=False)]
        self.usage.note(runs, result.busy_s, outside_s)
        self._say_progress()

    def _say_progress(self) -> None:
        self._on_progress(self._told, max(self._expected, self._told))


def _lost(task: Task, crash: Crash) -> Finished:
    """What a task gives whose worker died."""
    answer = task.lost(task.argument, crash)
    if answer is None:
        return Finished((), task.runs, 0.0, ())
    return Finished([packed(task.key, answer) if task.key else answer], 1, 0.0, ())


class Usage:
    """Seconds of one call: of the clock, of all workers at work, of this process's processor, and outside engines per run."""

    def __init__(self, workers: int) -> None:
        self.workers = workers
        self.runs = 0
        self.busy_s = self.own_s = self.wall_s = 0.0
        self._outside_s: list[float] = []
        self._begin = time.perf_counter(), time.process_time()

    def note(self, runs: int, busy_s: float, outside_s: Sequence[float]) -> None:
        """Count what a worker gave back: runs, seconds at work, and what each run took outside its engine."""
        self.runs += runs
        self.busy_s += busy_s
        self._outside_s.extend(outside_s)

    def stop(self) -> None:
        """Take both clocks."""
        self.wall_s = time.perf_counter() - self._begin[0]
        self.own_s = time.process_time() - self._begin[1]

    @property
    def utilisation(self) -> float | None:
        """Share of the workers' time in which they were at work; None where nothing ran."""
        return self.busy_s / (self.wall_s * self.workers) if self.runs else None

    @property
    def overhead_s_per_run(self) -> float | None:
        """Planning, sending, packing and storing: this process's time by the run, and the median run's outside its engine.

        The median leaves out what a worker does once, such as loading the statue's mesh.
        """
        if not self._outside_s:
            return None
        return self.own_s / self.runs + statistics.median(self._outside_s)

    def record(self) -> UsageRecord:
        """All numbers, as a record holds them."""
        return UsageRecord(**{item.name: getattr(self, item.name) for item in fields(UsageRecord)})
