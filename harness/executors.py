"""Where runs are computed: local processes, or a Dask cluster, behind the standard `concurrent.futures` interface."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from typing import Any, Final, Protocol

from harness.errors import InputError, Mistake

AHEAD: Final = 3
"""Tasks handed out per worker at a time: enough that none waits, few enough that a crash leaves few suspects."""


class Crash(Exception):
    """The worker process died during this task (not an exception of the task's own)."""


class Pool(Protocol):
    """What a study needs of an executor."""

    @property
    def workers(self) -> int:
        """How many tasks run at once."""

    def run(
        self, work: Callable[[Any], Any], tasks: Sequence[Any], done: Callable[[Any, Any | BaseException], None]
    ) -> None:
        """Run `work` on each task, telling `done(task, result or Crash)` as each finishes, in any order."""


class LocalPool:
    """Processes on this machine; a crash loses only its own task."""

    def __init__(self, jobs: int | None = None) -> None:
        self._jobs = jobs or os.cpu_count() or 1

    @property
    def workers(self) -> int:
        """How many processes."""
        return self._jobs

    def run(
        self, work: Callable[[Any], Any], tasks: Sequence[Any], done: Callable[[Any, Any | BaseException], None]
    ) -> None:
        """See `Pool.run`; one task or one job still runs in a process of its own."""
        left = list(tasks)
        while left:
            suspects = _through(self._executor, work, left, done, self._jobs)
            finished_or_suspect = len(left) - suspects.remaining
            # Every suspect again, alone: the guilty one is then known, the others are computed.
            for task in suspects.tasks:
                alone = _through(lambda: self._executor(1), work, [task], done, 1)
                if alone.tasks:
                    done(task, Crash("the process died"))
            left = left[finished_or_suspect:]

    def _executor(self, jobs: int | None = None) -> Executor:
        # A fresh interpreter per worker: nothing that the parent did can reach a run.
        return ProcessPoolExecutor(jobs or self._jobs, mp_context=multiprocessing.get_context("spawn"))


class _Suspects:
    """Tasks that were under way when a process died, and how many had not been handed out."""

    def __init__(self, tasks: Sequence[Any], remaining: int) -> None:
        self.tasks = tasks
        self.remaining = remaining


def _through(
    executor: Callable[[], Executor],
    work: Callable[[Any], Any],
    tasks: Sequence[Any],
    done: Callable[[Any, Any | BaseException], None],
    workers: int,
) -> _Suspects:
    """Hand tasks out in order, a few ahead, until all are done or a process dies."""
    waiting: Iterator[Any] = iter(tasks)
    handed = 0
    under_way: dict[Future[Any], Any] = {}
    with executor() as pool:
        try:
            while True:
                for task in waiting:
                    under_way[pool.submit(work, task)] = task
                    handed += 1
                    if len(under_way) >= AHEAD * workers:
                        break
                if not under_way:
                    return _Suspects([], 0)
                ready, _ = wait(under_way, return_when=FIRST_COMPLETED)
                for future in ready:
                    result = future.result()
                    done(under_way.pop(future), result)
        except BrokenProcessPool:
            finished = [f for f in under_way if f.done() and not f.cancelled() and f.exception() is None]
            for future in finished:
                done(under_way.pop(future), future.result())
            return _Suspects(list(under_way.values()), len(tasks) - handed)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


class DaskPool:
    """Workers of a Dask cluster at `address`; needs the extra [dask]. Raises `InputError` when it cannot be reached."""

    def __init__(self, address: str) -> None:
        try:
            from distributed import Client
        except ImportError as error:
            raise InputError(Mistake("--dask", "", "the extra [dask]", "no distributed here")) from error
        try:
            self._client = Client(address, timeout="10s")
        except (OSError, ValueError, TimeoutError) as error:
            raise InputError(
                Mistake("--dask", "", "the address of a running Dask scheduler", address, str(error))
            ) from error

    @property
    def workers(self) -> int:
        """Threads of all workers of the cluster."""
        return max(sum(int(count) for count in self._client.nthreads().values()), 1)

    def run(
        self, work: Callable[[Any], Any], tasks: Sequence[Any], done: Callable[[Any, Any | BaseException], None]
    ) -> None:
        """See `Pool.run`; a worker that dies has its tasks moved by the scheduler, a task that kills workers is a `Crash`."""
        from distributed import KilledWorker, as_completed

        futures = {}
        for number, task in enumerate(tasks):
            # pure=False: each task is itself, though two may look alike; retries are the scheduler's own.
            futures[self._client.submit(work, task, pure=False, priority=-number)] = task
        for future in as_completed(list(futures)):
            try:
                done(futures[future], future.result())
            except KilledWorker as error:
                done(futures[future], Crash(str(error)))

    def close(self) -> None:
        """Leave the cluster as it was."""
        self._client.close()
