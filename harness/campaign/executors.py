"""Where runs are computed: local processes, or a Dask cluster, behind the standard `concurrent.futures` interface."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import connection
from typing import Any, Final, Protocol

from harness.model.errors import InputError, Mistake

GRACE_S: Final = 5.0
"""Time a worker is given to end by itself before it is killed: one that is stopped hears nothing else."""
LIMIT_S: Final = 4 * 3600.0
"""Time without any answer after which the workers are taken to hang: a search for an amplitude takes tens of runs."""
AHEAD: Final = 3
"""Tasks handed out per worker at a time: enough that none waits, few enough that a crash leaves few suspects."""

Work = Callable[[Any], Any]
Done = Callable[[Any, Any | BaseException], None]


class Crash(Exception):
    """The worker process died during this task (not an exception of the task's own)."""


class Hung(Crash):
    """No worker gave an answer in the time allowed while this task was under way."""


class Pool(Protocol):
    """What a study needs of an executor."""

    @property
    def workers(self) -> int:
        """How many tasks run at once."""

    def run(self, work: Work, tasks: Iterable[Any], done: Done) -> None:
        """Run `work` on each task, telling `done(task, result or Crash)` as each finishes, in any order.

        Tasks are taken from the iterable as workers become free: a million of them are never all there at once.
        """

    def close(self) -> None:
        """Give the workers back."""


class LocalPool:
    """Processes on this machine, started once; a crash loses only its own task.

    So does a worker that hangs or is stopped: where none answers for `limit_s`, all are ended, and what was
    under way is computed again, alone.
    """

    def __init__(self, jobs: int | None = None, limit_s: float = LIMIT_S) -> None:
        self._jobs = jobs or os.cpu_count() or 1
        self._limit_s = limit_s
        self._cause = Crash("the process died")
        self._executor: ProcessPoolExecutor | None = None
        self._not_ours: list[int | None] = []

    @property
    def workers(self) -> int:
        """How many processes."""
        return self._jobs

    def run(self, work: Work, tasks: Iterable[Any], done: Done) -> None:
        """See `Pool.run`; one task or one job still runs in a process of its own."""
        waiting = iter(tasks)
        while suspects := self._through(work, waiting, done):
            # Every suspect again, alone: the guilty one is then known, the others are computed.
            for task in suspects:
                if self._through(work, iter([task]), done):
                    done(task, self._cause)

    def close(self) -> None:
        """End the processes, which have nothing left to do."""
        self._end(at_once=False)

    def _through(self, work: Work, waiting: Iterator[Any], done: Done) -> list[Any]:
        """Hand tasks out in order, a few ahead, until all are done (then nothing is left) or a process dies (the suspects)."""
        under_way: dict[Future[Any], Any] = {}
        try:
            while True:
                while len(under_way) < AHEAD * self._jobs:
                    task = next(waiting, under_way)
                    if task is under_way:
                        break
                    under_way[self._submit(work, task)] = task
                if not under_way:
                    return []
                ready, _ = wait(under_way, timeout=self._limit_s, return_when=FIRST_COMPLETED)
                if not ready:
                    self._cause = Hung(f"no answer in {self._limit_s:g} s")
                    self._end(at_once=True)
                    return list(under_way.values())
                for future in ready:
                    result = future.result()
                    done(under_way.pop(future), result)
        except BrokenProcessPool:
            self._cause = Crash("the process died")
            self.close()
            finished = [f for f in under_way if f.done() and not f.cancelled() and f.exception() is None]
            for future in finished:
                done(under_way.pop(future), future.result())
            return list(under_way.values())
        except BaseException:
            # Interrupted, or a task's own exception: nobody waits for what is under way.
            self._end(at_once=True)
            raise

    def _submit(self, work: Work, task: Any) -> Future[Any]:
        if self._executor is None:
            # A fresh interpreter per worker: nothing that the parent did can reach a run.
            self._not_ours = [process.pid for process in multiprocessing.active_children()]
            context = multiprocessing.get_context("spawn")
            self._executor = ProcessPoolExecutor(self._jobs, mp_context=context, initializer=_live_with_parent)
        try:
            return self._executor.submit(work, task)
        except BrokenProcessPool:
            # It died between two tasks, with none of them to blame.
            self.close()
            return self._submit(work, task)

    def _end(self, at_once: bool) -> None:
        """End the workers; those that do not, for they hang or are stopped, are killed."""
        executor, self._executor = self._executor, None
        if executor is None:
            return
        answers = getattr(executor, "_result_queue", None)
        ours = [process for process in multiprocessing.active_children() if process.pid not in self._not_ours]
        executor.shutdown(wait=False, cancel_futures=True)
        for process in ours if at_once else ():
            process.terminate()
        end = time.monotonic() + GRACE_S
        for process in ours:
            process.join(max(end - time.monotonic(), 0.0))
        for process in ours:
            if process.is_alive():
                at_once = True
                process.kill()
                process.join()
        if answers is not None and at_once:
            # A worker that was ended in the middle of an answer leaves the pool's own thread waiting for the rest of it, and the
            # interpreter for that thread, as long as anyone holds the end that is written to: this process does, too.
            answers._writer.close()


def _live_with_parent() -> None:
    """In a worker: leave interrupts to the parent, and end when it is gone, however it went."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()


def _end_with(sentinel: int) -> None:
    connection.wait([sentinel])
    os._exit(1)


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
        """Threads of all workers of the cluster as it is now."""
        return max(sum(int(count) for count in self._client.nthreads().values()), 1)

    def run(self, work: Work, tasks: Iterable[Any], done: Done) -> None:
        """See `Pool.run`; a worker that dies has its tasks moved by the scheduler, a task that kills workers is a `Crash`."""
        from distributed import KilledWorker, as_completed

        waiting = enumerate(tasks)
        under_way: dict[Any, Any] = {}
        ready = as_completed()
        while True:
            while len(under_way) < AHEAD * self.workers:
                number, task = next(waiting, (-1, None))
                if number < 0:
                    break
                # pure=False: each task is itself, though two may look alike; retries are the scheduler's own.
                future = self._client.submit(work, task, pure=False, priority=-number)
                under_way[future] = task
                ready.add(future)
            if not under_way:
                return
            future = next(ready)
            task = under_way.pop(future)
            try:
                result = future.result()
            except KilledWorker as error:
                result = Crash(str(error))
            done(task, result)

    def close(self) -> None:
        """Leave the cluster as it was."""
        self._client.close()
