"""One run in a process of its own: a crash or a hang of an engine is a failure of that run and of nothing else."""

from __future__ import annotations

import multiprocessing
import multiprocessing.connection
import signal
import time
from collections.abc import Callable, Sequence
from contextlib import closing
from typing import TYPE_CHECKING, Any, Final

from harness.accuracy.simulation import failed, simulate
from harness.model.history import Outcome

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

    from harness.model.options import RunOptions
    from harness.model.run import Run
    from harness.model.scene import Scene

DEFAULT_TIMEOUT_S: Final = 600.0
GRACE_S: Final = 2.0
"""Time a process is given to end by itself before it is killed."""


class Died(RuntimeError):
    """The process ended without an answer."""


class Hung(RuntimeError):
    """The process gave no answer in its time."""


def call(function: Callable[..., Any], arguments: Sequence[Any] = (), *, timeout_s: float = DEFAULT_TIMEOUT_S) -> Any:
    """Call a function of a module in a fresh process and return what it returns.

    Raises `Died` when the process ends without an answer, `Hung` after `timeout_s` (it is then killed), and what the function
    itself raised.
    """
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe(duplex=False)
    process = context.Process(target=_answer, args=(theirs, function, tuple(arguments)), daemon=True)
    process.start()
    theirs.close()
    with closing(ours):
        try:
            kind, value = _heard(ours, timeout_s)
        except EOFError:
            process.join(GRACE_S)
            raise Died(_cause(process.exitcode)) from None
        finally:
            _end(process)
    if kind == "raised":
        raise value
    return value


def _answer(connection: Connection, function: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
    try:
        answer: tuple[str, Any] = ("returned", function(*arguments))
    except Exception as error:  # noqa: BLE001 - every exception belongs to the caller
        answer = ("raised", error)
    connection.send(answer)
    connection.close()


def _heard(connection: Connection, timeout_s: float) -> tuple[str, Any]:
    if not connection.poll(timeout_s):
        raise Hung(f"no answer in {timeout_s:g} s")
    kind, value = connection.recv()
    return kind, value


def _end(process: multiprocessing.process.BaseProcess) -> None:
    process.join(0.0)
    if process.is_alive():
        process.terminate()
        process.join(GRACE_S)
    if process.is_alive():
        process.kill()
        process.join()


def _cause(code: int | None) -> str:
    if code is not None and code < 0:
        return f"the process was ended by {signal.Signals(-code).name}"
    return f"the process ended with code {code} and no answer"


def simulate_isolated(
    scene: Scene,
    engine: str,
    *,
    accuracy_rad: float | None = None,
    dt_s: float | None = None,
    want: RunOptions | None = None,
    timeout_s: float = DEFAULT_TIMEOUT_S,
) -> Run:
    """`harness.simulate` in a process of its own; a crash or hang is a run whose outcome says so.

    Raises `InputError` as `harness.simulate` does.
    """
    begin = time.perf_counter()
    try:
        run: Run = call(_simulate, (scene, engine, accuracy_rad, dt_s, want), timeout_s=timeout_s)
    except Died as error:
        return failed(engine, Outcome.CRASHED, str(error), time.perf_counter() - begin)
    except Hung as error:
        return failed(engine, Outcome.TIMED_OUT, str(error), time.perf_counter() - begin)
    return run


def _simulate(
    scene: Scene, engine: str, accuracy_rad: float | None, dt_s: float | None, want: RunOptions | None
) -> Run:
    return simulate(scene, engine, accuracy_rad=accuracy_rad, dt_s=dt_s, want=want)
