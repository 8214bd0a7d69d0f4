"""One run in a process of its own: a crash or a hang of an engine is a failure of that run and of nothing else."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import closing
from typing import TYPE_CHECKING, Any, Final

from harness import engines
from harness.accuracy.simulation import RunTarget, failed, simulate_with
from harness.campaign.runner import Crash, Hung, LocalPool
from harness.model.history import Outcome

if TYPE_CHECKING:
    from harness.model.run import Run
    from harness.model.scene import Scene

DEFAULT_TIMEOUT_S: Final = 600.0


def call(function: Callable[..., Any], arguments: Sequence[Any] = (), *, timeout_s: float = DEFAULT_TIMEOUT_S) -> Any:
    """Call a function of a module in a fresh process and return what it returns.

    Raises `Crash` when the process ends without an answer, `Hung` after `timeout_s` (it is then killed), and what the function
    itself raised.
    """
    answers: list[Any] = []
    with closing(LocalPool(1, timeout_s, tries=1)) as pool:
        pool.run(_apply, [(function, tuple(arguments))], lambda task, answer: answers.append(answer))
    if isinstance(answers[0], Crash):
        raise answers[0]
    return answers[0]


def _apply(called: tuple[Callable[..., Any], tuple[Any, ...]]) -> Any:
    return called[0](*called[1])


def lost_run(engine: str, crash: Crash, wall_s: float = 0.0) -> Run:
    """The run whose process died or hung: it says so."""
    outcome = Outcome.TIMED_OUT if isinstance(crash, Hung) else Outcome.CRASHED
    return failed(engine, outcome, str(crash), wall_s)


def simulate_isolated(scene: Scene, engine: str, target: RunTarget, *, timeout_s: float = DEFAULT_TIMEOUT_S) -> Run:
    """`harness.simulate` in a process of its own; a crash or hang is a run whose outcome says so.

    Raises `InputError` for an unknown engine.
    """
    begin = time.perf_counter()
    try:
        run: Run = call(_simulate, (scene, engine, target), timeout_s=timeout_s)
    except Crash as crash:
        return lost_run(engine, crash, time.perf_counter() - begin)
    return run


def _simulate(scene: Scene, engine: str, target: RunTarget) -> Run:
    return simulate_with(engines.load(engine), scene, target)
