"""A keyed task: what names its result, what computes it, and what it gives back; and one run in a process of its own."""

from __future__ import annotations

import operator
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Final

from numpy.typing import NDArray

from harness import engines
from harness.accuracy.simulation import DEFAULT_ACCURACY_RAD, RunTarget, failed, simulate, simulate_with
from harness.model.errors import InputError, Mistake
from harness.model.history import History, Outcome
from harness.model.options import RunOptions
from harness.model.run import Run, to_plain
from harness.model.scene import Scene
from harness.records.base import Plain
from harness.runs.cache_key import request_key
from harness.runs.runner import Crash, Hung, LocalPool

RUN = "run"
"""Kind of a result that is an engine's run."""


@dataclass(frozen=True)
class Answer:
    """What a task's function gives back: its record as plain values, and the history that belongs to it.

    `seconds` is what the result is said to have cost, `inside_s` the part of the task's time that is no overhead, `failed` the
    number of its runs that failed; `table` holds the columns of many runs, texts as objects.
    """

    kind: str
    record: Plain
    seconds: float
    history: History | None = None
    inside_s: float = 0.0
    failed: int = 0
    table: Mapping[str, NDArray[Any]] | None = None


@dataclass(frozen=True)
class Task:
    """One thing to compute: a function of a module and its argument, both of which travel to a worker.

    `key` names the result in the store. Neighbours of one `group` may go to a worker together.
    `lost` makes the answer of a task whose worker died; None: there is none, and nothing is kept. It counts as so many `runs`.
    """

    key: str
    work: Callable[[Any], Answer]
    argument: Any
    group: str = ""
    lost: Callable[[Any, Crash], Answer | None] = lambda argument, crash: None
    runs: int = 1


def answer_of(run: Run, histories: bool, inside_s: float = 0.0) -> Answer:
    """A finished run as an answer.

    Times differ from run to run: they stand apart, so that two stores of one study are equal row for row.
    """
    plain = to_plain(run)
    seconds = plain.pop("wall_s")
    return Answer(RUN, plain, seconds, run.history if histories else None, inside_s, run.outcome.failed)


def lost_answer(argument: Any, crash: Crash) -> Answer:
    """The answer of a task that is a run of `argument.engine`, and whose worker died or hung."""
    return answer_of(lost_run(argument.engine, crash), histories=False)


@dataclass(frozen=True)
class RunRequest:
    """One run that is wanted, as it travels to a worker: its scene, or what makes it there, the engine, its target, what is kept.

    >>> request = harness.RunRequest(scene.replace(motion__x__amplitude_g=0.3), "pymunk", varied={"amplitude_g": 0.3})

    Either `accuracy_rad`, the target of the rotation's numerical error (1e-3 where neither is given), or a fixed step `dt_s`;
    without `stated` one run is made and its error is not. `varied` tells it from others in a table (and is no part of the key).
    """

    scene: Scene | Callable[[], Scene]
    engine: str
    accuracy_rad: float | None = None
    dt_s: float | None = None
    history: bool = False
    stated: bool = True
    varied: Mapping[str, object] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Fill in the target. Raises `InputError` for what is no scene, nor makes one."""
        if not isinstance(self.scene, Scene) and not callable(self.scene):
            wanted = "a scene (harness.load_scene), or a function that makes one"
            raise InputError(Mistake("RunRequest", "scene", wanted, type(self.scene).__name__))
        if self.accuracy_rad is None and self.dt_s is None:
            object.__setattr__(self, "accuracy_rad", DEFAULT_ACCURACY_RAD)

    def made(self) -> Scene:
        """Its scene."""
        return self.scene if isinstance(self.scene, Scene) else self.scene()

    def task(self, scene: Scene | None = None) -> Task:
        """Its task, named by all that decides its answer; `scene` is what it will make, where that is there already."""
        asked = self.accuracy_rad, self.dt_s, self.history, self.stated
        key = request_key(scene or self.made(), engines.load(self.engine), *asked)
        return Task(key, run_request, self, self.engine, lost_answer)


def run_request(wanted: RunRequest) -> Answer:
    """Make the scene and run it (a failure is a `Run` that says so); overhead is what `simulate` does not take."""
    scene = wanted.made()
    begin = time.perf_counter()
    options = RunOptions(history=wanted.history, stated=wanted.stated)
    run = simulate(scene, wanted.engine, accuracy_rad=wanted.accuracy_rad, dt_s=wanted.dt_s, options=options)
    return answer_of(run, wanted.history, time.perf_counter() - begin)


DEFAULT_TIMEOUT_S: Final = 600.0


def call(function: Callable[..., Any], arguments: Sequence[Any] = (), *, timeout_s: float = DEFAULT_TIMEOUT_S) -> Any:
    """Call a function of a module in a fresh process and return what it returns.

    Raises `Crash` when the process ends without an answer, `Hung` after `timeout_s` (it is then killed), and what the function
    itself raised.
    """
    answers: list[Any] = []
    with closing(LocalPool(1, timeout_s, tries=1)) as pool:
        pool.run(operator.call, [partial(function, *arguments)], lambda task, answer: answers.append(answer))
    if isinstance(answers[0], Crash):
        raise answers[0]
    return answers[0]


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
