"""Every task is done once, and a process that dies costs only its own task."""

from __future__ import annotations

from typing import Any

import pytest

from harness.executors import Crash, LocalPool

CRASH = "__import__('os')._exit(3)"


def results(tasks: list[str], jobs: int) -> dict[str, Any]:
    found: dict[str, Any] = {}

    def done(task: str, result: Any) -> None:
        assert task not in found, "a task was done twice"
        found[task] = result

    # `eval` is the one function that a fresh process knows and that does what a test says.
    LocalPool(jobs).run(eval, tasks, done)
    return found


@pytest.mark.parametrize("jobs", [1, 2])
def test_each_task_is_done_once(jobs: int) -> None:
    tasks = [f"{i} * {i}" for i in range(20)]
    assert results(tasks, jobs) == {f"{i} * {i}": i * i for i in range(20)}


def test_a_dead_process_costs_only_its_own_task() -> None:
    tasks = ["1 + 1", CRASH, *(f"{i} + 0" for i in range(12))]
    found = results(tasks, 2)
    assert set(found) == set(tasks)
    assert isinstance(found.pop(CRASH), Crash)
    assert all(result == eval(task) for task, result in found.items())


def test_a_task_of_its_own_exception_is_not_hidden() -> None:
    with pytest.raises(ZeroDivisionError):
        results(["1 / 0"], 1)
