"""A keyed task: what names its result, what computes it, and what it gives back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from harness.campaign.isolate import lost_run
from harness.campaign.runner import Crash
from harness.model.history import History
from harness.model.run import Run, to_plain
from harness.records.base import Plain
from harness.records.run import EngineRunRecord

RUN = "run"
"""Kind of a result that is an engine's run."""


@dataclass(frozen=True)
class Answer:
    """What a task's function gives back: its record as plain values, and the history that belongs to it.

    `seconds` is what the result is said to have cost, `inside_s` the part of the task's time that is no overhead, `failed` the
    number of its runs that failed; `table` holds the columns of many runs, as `column_store.as_bytes` writes them.
    """

    kind: str
    record: Plain
    seconds: float
    history: History | None = None
    inside_s: float = 0.0
    failed: int = 0
    table: bytes = b""


@dataclass(frozen=True)
class Task:
    """One thing to compute: a function of a module and its argument, both of which travel to a worker.

    `key` names the result in the store; without one it is not kept. Neighbours of one `group` may go to a worker together.
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
    plain = to_plain(EngineRunRecord.of(run))
    seconds = plain.pop("wall_s")
    return Answer(RUN, plain, seconds, run.history if histories else None, inside_s, run.outcome.failed)


def lost_answer(argument: Any, crash: Crash) -> Answer:
    """The answer of a task that is a run of `argument.engine`, and whose worker died or hung."""
    return answer_of(lost_run(argument.engine, crash), histories=False)
