"""Where tasks are computed: worker processes on this machine, this process, or a Dask cluster."""

import atexit
import gc
import multiprocessing
import multiprocessing.util  # its own hook at exit waits for workers: ours, registered later, ends them before
import os
import signal
import sys
import threading
import time
import traceback
import warnings
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import CancelledError
from contextlib import suppress
from multiprocessing import connection
from types import ModuleType
from typing import Any, Final
from weakref import WeakSet

from harness.model import InputError, Mistake, require, translated

GRACE_S: Final = 5.0
"""Time a worker is given to end by itself before it is killed: one that is stopped hears nothing else."""
LIMIT_S: Final = 4 * 3600.0
"""Time without an answer after which a worker is taken to hang: a search for an amplitude takes tens of runs."""
AHEAD: Final = 3
"""Tasks handed out per worker of a cluster at a time: enough that none waits, few enough that a million are never all there."""
TRIES: Final = 2
"""A worker may have been ended from outside: a task is charged with a death when it has seen two of them."""
LOOK_S: Final = 1.0
"""Time between two looks at the clock while no answer comes, less where the limit itself is short."""

Work = Callable[[Any], Any]
Done = Callable[[Any, Any], None]


class Crash(Exception):
    """The worker process died during this task (not an exception of the task's own)."""


class Hung(Crash):
    """The worker gave no answer to this task in the time allowed."""


class InlinePool:
    """No worker: each task here, one after the other; what is timed must have the machine for itself."""

    workers: Final = 1

    def run(self, work: Work, tasks: Iterable[Any], done: Done) -> None:
        """Run `work` on each task, telling `done(task, result or Crash)` as each finishes, in any order.

        Tasks are taken from the iterable as workers become free. A task's own exception is raised.
        """
        for task in tasks:
            done(task, work(task))

    def close(self) -> None:
        """Nothing to give back."""


_STARTING: Final = threading.Lock()
"""Held while a worker is started: `__main__` is then another module."""
_Order = tuple[Any, int]
"""One task on its way, and how often it was tried."""


class _Worker:
    """A process that is at one order at a time, and this side of the pipe to it."""

    def __init__(self) -> None:
        self.order: _Order | None = None
        self._since_s = 0.0
        self._limit_passed_s: float | None = None
        # A fresh interpreter: nothing that the parent did can reach a run.
        context = multiprocessing.get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self.process = context.Process(target=_serve, args=(theirs,))
        with _STARTING:
            # An interrupt is the parent's: until the new interpreter is at its orders, it waits.
            before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
            main = sys.modules["__main__"]
            try:
                # A worker needs nothing of the caller's script: without a guard it would run it again, and come to no end.
                sys.modules["__main__"] = ModuleType("__main__")
                self.process.start()
            finally:
                sys.modules["__main__"] = main
                signal.pthread_sigmask(signal.SIG_SETMASK, before)
        theirs.close()

    def begin(self, work: Work, task: Any) -> None:
        """Hand out its order. Raises what says that it cannot be sent."""
        self._since_s = time.monotonic()
        # One that died while it had nothing to do: its pipe says so when it is asked for the answer.
        with suppress(OSError):
            self.pipe.send((work, task))

    def check(self, limit_s: float) -> None:
        """Kill the process when it has been at its order for longer than the limit; its pipe then says that it died."""
        if self.order is not None and time.monotonic() - self._since_s > limit_s:
            self._limit_passed_s = limit_s
            self.process.kill()

    def answer(self) -> tuple[Any, BaseException | None]:
        """What came back for its order, or the error instead: a `Crash` where the process died."""
        self.order = None
        try:
            answer: tuple[Any, BaseException | None] = self.pipe.recv()
        except (EOFError, OSError):
            self.process.join()
            if self._limit_passed_s is not None:
                return None, Hung(f"no answer in {self._limit_passed_s:g} s")
            return None, Crash(_cause(self.process.exitcode))
        except Exception as error:  # noqa: BLE001 - an answer that cannot be read
            return None, error
        return answer


class LocalPool:
    """Processes on this machine, started once; a worker that dies or hangs costs its own task only, tried twice.

    `limit_s` is the time for one task. Raises `InputError` for less than one job.
    """

    def __init__(self, jobs: int | None = None, limit_s: float = LIMIT_S, tries: int = TRIES) -> None:
        self._jobs = jobs or os.cpu_count() or 1
        self._limit_s, self._tries = limit_s, tries
        self._workers: list[_Worker] = []
        require(jobs is None or jobs >= 1, "--jobs", "a whole number of at least 1", str(jobs))
        _OPEN.add(self)

    @property
    def workers(self) -> int:
        """How many processes."""
        return self._jobs

    def run(self, work: Work, tasks: Iterable[Any], done: Done) -> None:
        """See `InlinePool.run`; one task or one job still runs in a process of its own."""
        upcoming, again = iter(tasks), list[_Order]()
        try:
            while True:
                self._hand_out(work, upcoming, again)
                busy = {each.pipe: (each, each.order) for each in self._workers if each.order is not None}
                if not busy:
                    return
                for pipe in connection.wait(list(busy), min(LOOK_S, self._limit_s)):
                    worker, (task, tries) = busy[pipe]  # type: ignore[index]
                    answer, error = worker.answer()
                    if isinstance(error, Crash):
                        self._workers.remove(worker)
                        if tries + 1 < self._tries:
                            again.append((task, tries + 1))
                        else:
                            done(task, error)
                        continue
                    if error is not None:
                        raise error
                    # It is at work again while its answer is kept.
                    self._hand_out(work, upcoming, again)
                    done(task, answer)
                for worker, _ in busy.values():
                    worker.check(self._limit_s)
        except BaseException:
            # Interrupted, or a task's own exception: nobody waits for what is under way.
            self._end(at_once=True)
            raise

    def close(self) -> None:
        """End the processes, which have nothing left to do."""
        self._end(at_once=False)

    __del__ = close

    def _hand_out(self, work: Work, upcoming: Iterator[Any], again: list[_Order]) -> None:
        """Give each worker that has nothing to do an order, as long as there are any."""
        idle = [worker for worker in self._workers if worker.order is None]
        begun = []
        while idle or len(self._workers) < self._jobs:
            task = next(upcoming, None)
            if task is not None:
                order = task, 0
            elif again and all(worker.order is None for worker in self._workers):
                # Once more alone: whatever a neighbour may have done to it cannot come again.
                order = again.pop()
            else:
                break
            if not idle:
                self._workers.append(_Worker())
                idle = self._workers[-1:]
            worker = idle.pop()
            worker.order = order
            begun.append((worker, order[0]))
        # A long order is taken only when its process has come up: by then all are on their way.
        for worker, task in begun:
            worker.begin(work, task)

    def _end(self, at_once: bool) -> None:
        """End the workers; those that do not, for they hang or are stopped, are killed."""
        workers, self._workers = self._workers, []
        for worker in workers:
            if at_once:
                worker.process.terminate()
            worker.pipe.close()
        end_s = time.monotonic() + GRACE_S
        for worker in workers:
            worker.process.join(max(end_s - time.monotonic(), 0.0))
            if worker.process.is_alive():
                worker.process.kill()
                worker.process.join()


_OPEN: Final[WeakSet[LocalPool]] = WeakSet()


def kill_workers() -> None:
    """Kill the processes of every pool, whatever they are at: who waits for their answers hears that they died."""
    for pool in list(_OPEN):
        for worker in list(pool._workers):
            worker.process.kill()


@atexit.register
def _close_open() -> None:
    for pool in list(_OPEN):
        pool.close()


def _cause(code: int | None) -> str:
    if code is not None and code < 0:
        return f"the process was ended by {signal.Signals(-code).name}"
    return f"the process ended with code {code} and no answer"


def _serve(parent: connection.Connection) -> None:
    """In a worker: answer orders until there are none; interrupts are the parent's; end when it is gone, however it went."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])
    warnings.showwarning = lambda *_: None  # what is to be said of a run stands in it
    gc.set_threshold(
        100_000
    )  # what is imported lives to the end, and a run makes no rings: it is looked through less often
    threading.Thread(target=_end_with_parent, daemon=True).start()
    while True:
        try:
            work, task = parent.recv()
        except EOFError:
            return
        except Exception as error:  # noqa: BLE001 - what cannot be read belongs to the caller
            parent.send((None, error))
            continue
        try:
            answer: tuple[Any, BaseException | None] = (work(task), None)
        except Exception as error:  # noqa: BLE001 - every exception belongs to the caller
            error.add_note("".join(traceback.format_exception(error)))
            answer = (None, error)
        try:
            parent.send(answer)
        except Exception as error:  # noqa: BLE001 - an answer that cannot be sent is told as that
            parent.send((None, error))


def _end_with_parent() -> None:
    process = multiprocessing.parent_process()
    if process is not None:
        connection.wait([process.sentinel])
        os._exit(1)


# Workers of a Dask cluster; needs the extra [dask].

REACH_S: Final = 10.0
"""Time in which a scheduler answers."""
GONE_S: Final = 60.0
"""Time that a cluster without a worker is given to have one again."""


class DaskPool:
    """Workers of the cluster at `address`, each task with `limit_s`. Raises `InputError` when it cannot be reached."""

    def __init__(self, address: str, limit_s: float = LIMIT_S) -> None:
        with translated(ImportError, "--dask", "the extra [dask]", "no distributed here"):
            from distributed import Client
        try:
            self._client = Client(address, timeout=REACH_S)
        except (OSError, ValueError, TimeoutError) as error:
            raise InputError(
                Mistake("--dask", "", "the address of a running Dask scheduler", address, str(error))
            ) from error
        # When a task begins only its worker knows; on each there are at most so many before it.
        self._limit_s = AHEAD * limit_s
        self._hung = 0
        self._last_s = time.monotonic()

    @property
    def workers(self) -> int:
        """Threads of all workers of the cluster as it is now."""
        return max(self._threads(), 1)

    def _threads(self) -> int:
        """Raises `InputError` where the scheduler is gone, or no worker was there for `GONE_S`."""
        try:
            threads = sum(self._client.nthreads().values()) if self._client.status == "running" else 0
        except OSError as error:
            raise self._gone(str(error)) from error
        if self._client.status != "running":
            raise self._gone("no scheduler any more")
        if threads:
            self._last_s = time.monotonic()
        elif time.monotonic() - self._last_s > GONE_S:
            raise self._gone(f"no worker for {GONE_S:g} s")
        return threads

    def _gone(self, got: str) -> InputError:
        advice = "start it anew and give the command again: what was finished is kept"
        return InputError(Mistake("--dask", "", "a cluster that answers", got, advice))

    def run(self, work: Work, tasks: Iterable[Any], done: Done) -> None:
        """See `InlinePool.run`; a worker that dies has its tasks moved by the scheduler, a task that kills workers is a `Crash`.

        A task that hangs is given up, and keeps its worker's thread. Raises `InputError` when it has taken them all, or where the
        cluster is gone.
        """
        waiting = enumerate(tasks)
        under_way: dict[Any, tuple[Any, float]] = {}
        try:
            while True:
                while len(under_way) < AHEAD * self.workers:
                    number, task = next(waiting, (-1, None))
                    if number < 0:
                        break
                    # pure=False: each task is itself, though two may look alike; retries are the scheduler's own.
                    future = self._client.submit(work, task, pure=False, priority=-number)
                    under_way[future] = task, time.monotonic()
                if not under_way:
                    return
                for future in self._finished(under_way):
                    task, _ = under_way.pop(future)
                    done(task, self._result(future))
                for future in [
                    f for f, (_, since_s) in under_way.items() if time.monotonic() - since_s > self._limit_s
                ]:
                    task, _ = under_way.pop(future)
                    done(task, self._given_up(future))
        finally:
            if self._client.status == "running":
                self._client.cancel(list(under_way), force=True)

    def close(self) -> None:
        """Leave the cluster as it was."""
        self._client.close()

    def _finished(self, under_way: dict[Any, tuple[Any, float]]) -> list[Any]:
        """Those that have an answer; none where there is none within a look at the clock, or in the time of the oldest."""
        from distributed import wait

        left_s = min(since_s for _, since_s in under_way.values()) + self._limit_s - time.monotonic()
        try:
            some = wait(list(under_way), timeout=min(max(left_s, 0.01), LOOK_S), return_when="FIRST_COMPLETED")
        except TimeoutError:
            return []
        except CancelledError as error:
            raise self._gone("no scheduler any more") from error
        return list(some.done)

    def _result(self, future: Any) -> Any:
        """Its answer, which is computed once more where it was lost with its worker."""
        from distributed import KilledWorker

        try:
            return future.result(timeout=self._limit_s)
        except KilledWorker as error:
            return Crash(str(error))
        except CancelledError as error:
            raise self._gone("no scheduler any more") from error
        except TimeoutError:
            return self._given_up(future)

    def _given_up(self, future: Any) -> Hung:
        self._client.cancel([future], force=True)
        self._hung += 1
        got = f"no answer in {self._limit_s:g} s"
        require(
            self._hung < self.workers,
            "--dask",
            "workers that answer",
            f"{got} on any of them",
            "restart the cluster's workers",
        )
        return Hung(got)


Pool = InlinePool | LocalPool | DaskPool
"""Whatever computes tasks: `workers` of them at once by `run`, until the caller gives them back by `close`."""
