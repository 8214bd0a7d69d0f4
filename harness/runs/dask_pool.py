"""Workers of a Dask cluster; needs the extra [dask]."""

from __future__ import annotations

import time
from collections.abc import Iterable
from concurrent.futures import CancelledError
from typing import Any, Final

from harness.model.errors import InputError, Mistake
from harness.runs.runner import AHEAD, LIMIT_S, LOOK_S, Crash, Done, Hung, Work

GONE_S: Final = 60.0
"""Time that a cluster without a worker is given to have one again."""


class DaskPool:
    """Workers of the cluster at `address`, each task with `limit_s`. Raises `InputError` when it cannot be reached."""

    def __init__(self, address: str, limit_s: float = LIMIT_S) -> None:
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
        """See `Pool.run`; a worker that dies has its tasks moved by the scheduler, a task that kills workers is a `Crash`.

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
        if self._hung >= self.workers:
            raise InputError(
                Mistake("--dask", "", "workers that answer", f"{got} on any of them", "restart the cluster's workers")
            )
        return Hung(got)
