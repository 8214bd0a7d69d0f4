"""Every task is done once, and a process that dies costs only its own task."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from harness.model import InputError
from harness.runs import runner
from harness.runs.runner import AHEAD, Crash, LocalPool
from tests.harness.runs.endings import ended

MAIN = threading.main_thread().ident or 0
LIMIT_S = 5.0
"""Long enough for a fresh process to answer on a busy machine, short enough to wait for in a test."""
CRASH = "__import__('os')._exit(3)"


def results(tasks: list[str], jobs: int) -> dict[str, Any]:
    found: dict[str, Any] = {}

    def done(task: str, result: Any) -> None:
        assert task not in found, "a task was done twice"
        found[task] = result

    # `eval` is the one function that a fresh process knows and that does what a test says.
    LocalPool(jobs).run(eval, tasks, done)
    return found


def test_less_than_one_process_is_refused() -> None:
    with pytest.raises(InputError, match=r"^--jobs: .*, got 0$"):
        LocalPool(0)


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


def test_tasks_are_taken_as_workers_become_free() -> None:
    taken: list[int] = []
    ahead: list[int] = []

    def tasks() -> Iterator[str]:
        for i in range(40):
            taken.append(i)
            yield f"{i} + 0"

    finished: list[str] = []

    def done(task: str, result: Any) -> None:
        finished.append(task)
        ahead.append(len(taken) - len(finished))

    pool = LocalPool(2)
    pool.run(eval, tasks(), done)
    pool.close()
    assert len(finished) == 40
    assert max(ahead) <= AHEAD * 2


def test_processes_are_started_once() -> None:
    pool = LocalPool(1)
    seen: set[Any] = set()
    for _ in range(3):
        pool.run(eval, ["__import__('os').getpid()"] * 4, lambda task, pid: seen.add(pid))
    pool.close()
    assert len(seen) == 1


def script_run(folder: Path, code: str) -> subprocess.CompletedProcess[str]:
    """A script of these lines, run in a folder by an interpreter of its own."""
    script = folder / "script.py"
    script.write_text(code)
    environment = os.environ | {"PYTHONPATH": str(Path.cwd())}
    return subprocess.run(
        [sys.executable, script], check=False, env=environment, cwd=folder, capture_output=True, text=True
    )


def test_processes_end_with_a_parent_that_was_killed(tmp_path: Path) -> None:
    code = (
        "from pathlib import Path; from harness.runs.runner import LocalPool\n"
        "BUSY = \"__import__('time').sleep(60.0)\"\n"
        "def told(task, pid): Path('pid').write_text(str(pid)); __import__('os').kill(__import__('os').getpid(), 9)\n"
        "if __name__ == '__main__': LocalPool(1).run(eval, [\"__import__('os').getpid()\", BUSY], told)\n"
    )
    script_run(tmp_path, code)
    pid = int((tmp_path / "pid").read_text())
    assert ended(pid)


def test_a_script_without_a_guard_is_not_run_again_by_its_workers(tmp_path: Path) -> None:
    code = (
        "print('begun')\n"
        "from harness.runs.runner import LocalPool\n"
        "LocalPool(2).run(eval, ['1 + 1', '2 + 2'], lambda task, answer: print(answer))\n"
    )
    said = script_run(tmp_path, code)
    assert said.returncode == 0
    assert sorted(said.stdout.split()) == ["2", "4", "begun"]
    assert not said.stderr


def test_a_pool_that_is_interrupted_in_the_middle_of_an_answer_leaves_no_thread_waiting() -> None:
    # The second answer takes its worker longer to write than the interrupt takes to end it.
    def interrupted(task: str, result: Any) -> None:
        if task == "0":
            time.sleep(0.4)
            raise KeyboardInterrupt

    before = set(threading.enumerate())
    with pytest.raises(KeyboardInterrupt):
        LocalPool(2).run(eval, ["0", *["bytes(400_000_000)"] * 3], interrupted)
    left = [thread for thread in threading.enumerate() if thread not in before]
    for thread in left:
        thread.join(timeout=10.0)
    assert not [thread.name for thread in left if thread.is_alive()]


STOPPED = "__import__('os').kill(__import__('os').getpid(), __import__('signal').SIGSTOP)"


def test_a_stopped_worker_costs_only_its_own_task_and_no_more_than_the_limit() -> None:
    found: dict[str, Any] = {}
    tasks = ["1 + 1", STOPPED, *(f"{i} + 0" for i in range(6))]
    with closing(LocalPool(2, limit_s=LIMIT_S)) as pool:
        pool.run(eval, tasks, found.__setitem__)
    assert isinstance(found.pop(STOPPED), runner.Hung)
    assert all(result == eval(task) for task, result in found.items())
    assert len(found) == len(tasks) - 1


def stopped(pid: int) -> bool:
    """Whether a process has been stopped (state T of proc(5)): the interrupt must not come while it still starts."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "T"
    except OSError:
        return False


def asked_to_end(pid: int) -> bool:
    """Whether a stopped process has a request to end before it (`ShdPnd` of proc(5)), or is gone."""
    try:
        line = next(each for each in Path(f"/proc/{pid}/status").read_text().splitlines() if each.startswith("ShdPnd"))
    except (OSError, StopIteration):
        return True
    return bool(int(line.split()[1], 16) >> (signal.SIGTERM - 1) & 1)


def test_a_stopped_worker_does_not_hold_an_interrupt_back(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A stopped process does not hear a request to end: until it is killed, whoever waits for it waits for ever."""
    monkeypatch.setattr(runner, "GRACE_S", 0.5)
    file = tmp_path / "pid"
    stops = f"[open({str(file)!r}, 'w').write(str(__import__('os').getpid())), {STOPPED}]"
    heard = threading.Event()

    def interrupt() -> None:
        while not (file.exists() and (pid := file.read_text()) and stopped(int(pid))):
            time.sleep(0.05)
        # Python drops an interrupt that comes inside a finalizer: as a user does, it is sent again until it is heard.
        while not heard.is_set() and not asked_to_end(int(pid)):
            signal.pthread_kill(MAIN, signal.SIGINT)
            end_s = time.monotonic() + LIMIT_S
            while time.monotonic() < end_s and not asked_to_end(int(pid)):
                heard.wait(0.05)

    # A cluster that ran in this process before may have left a handler of its own.
    handler = signal.signal(signal.SIGINT, signal.default_int_handler)
    sender = threading.Thread(target=interrupt, daemon=True)
    sender.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            LocalPool(1).run(eval, [stops], lambda task, result: None)
    finally:
        heard.set()
        sender.join()
        signal.signal(signal.SIGINT, handler)
    assert ended(int(file.read_text()))


def once(path: str) -> str:
    """Work whose process is ended from outside the first time, and only then."""
    return (
        f"__import__('os').kill(__import__('os').getpid(), 9) if not __import__('os').path.exists({path!r})"
        f" and not open({path!r}, 'w').close() else 'whole'"
    )


def test_a_worker_that_was_ended_from_outside_costs_no_task(tmp_path: Path) -> None:
    tasks = [once(str(tmp_path / "seen")), *(f"{i} + 0" for i in range(6))]
    assert results(tasks, 2)[tasks[0]] == "whole"


def test_a_death_is_told_with_its_signal() -> None:
    killed = "__import__('os').kill(__import__('os').getpid(), 9)"
    assert "SIGKILL" in str(results([killed], 1)[killed])


def test_what_cannot_be_sent_back_is_told() -> None:
    with pytest.raises(TypeError, match="pickle"):
        results(["__import__('threading').Lock()"], 1)
