"""The same study on a Dask cluster: same store, nothing lost, nothing twice."""

import re
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest

from harness.model import InputError
from harness.questions.study.cases import load_study
from harness.questions.study.study_run import run_study
from harness.runs import runner as dask_pool
from harness.runs.runner import AHEAD, DaskPool, Hung, LocalPool
from harness.runs.store import Packed, Store
from tests.harness.questions.study.small_study import CONTACT, contents, written

pytest.importorskip("distributed", reason="the extra [dask] is not installed")


Cluster = tuple[str, list[subprocess.Popen[str]], subprocess.Popen[str]]


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Cluster]:
    """A real scheduler and two worker processes on this machine, reached on the loopback interface only."""
    command = [
        sys.executable,
        "-m",
        "distributed.cli.dask_scheduler",
        "--host",
        "127.0.0.1",
        "--port",
        "0",
        "--no-dashboard",
    ]
    processes = [subprocess.Popen(command, stderr=subprocess.PIPE, text=True, cwd=tmp_path)]
    stream = processes[0].stderr
    address = next(found[0] for line in stream if (found := re.search(r"tcp://127\.0\.0\.1:\d+", line)))
    workers = []
    for _ in range(2):
        worker = [
            sys.executable,
            "-m",
            "distributed.cli.dask_worker",
            address,
            "--nthreads",
            "1",
            "--no-dashboard",
            "--no-nanny",
        ]
        workers.append(
            subprocess.Popen(worker, text=True, cwd=tmp_path, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        )
    processes += workers
    yield address, workers, processes[0]
    for process in processes:
        process.kill()
        process.wait()
    stream.close()


def test_a_study_on_a_cluster_that_loses_a_worker_ends_in_the_same_store(cluster: Cluster, tmp_path: Path) -> None:
    path = written(tmp_path / "study", CONTACT)
    study = load_study(path)
    with Store(tmp_path / "local.sqlite") as store:
        run_study(study, path, store, LocalPool(1))
    address, workers, _ = cluster
    pool = DaskPool(address)
    while pool.workers < 2:
        time.sleep(0.05)
    killed: list[int] = []
    stored: Counter[str] = Counter()

    def told(done: int, total: int) -> None:
        if done == 5 and not killed:
            workers[0].kill()
            killed.append(done)

    with Store(tmp_path / "cluster.sqlite") as store:
        add = store.add

        def counted(results: Sequence[Packed], clock_s: float = 0.0) -> None:
            stored.update(item.columns[0] for item in results)
            add(results, clock_s)

        store.add = counted  # type: ignore[method-assign]
        first = run_study(study, path, store, pool, told)
        again = run_study(study, path, store, pool)
    pool.close()
    assert killed
    assert first.computed == first.distinct == len(stored) == 24
    assert set(stored.values()) == {1}, "a result came twice"
    assert (again.computed, again.found) == (0, 24)
    assert contents(tmp_path / "cluster.sqlite") == contents(tmp_path / "local.sqlite")


LIMIT_S = 2.0
"""Long enough for a worker that is there to answer, short enough to wait for in a test."""
HANG = "__import__('time').sleep(600.0)"


def test_a_task_that_hangs_is_given_up_and_the_others_are_computed(
    cluster: Cluster,
) -> None:
    pool = DaskPool(cluster[0], limit_s=LIMIT_S)
    while pool.workers < 2:
        time.sleep(0.05)
    tasks = ["1 + 1", HANG, *(f"{i} + 0" for i in range(3 * AHEAD))]
    answers: dict[str, Any] = {}
    pool.run(eval, tasks, answers.__setitem__)
    assert isinstance(answers.pop(HANG), Hung)
    assert answers == {task: eval(task) for task in tasks if task != HANG}
    with pytest.raises(InputError, match="workers that answer"):
        pool.run(eval, [f"{HANG} or 1", "1 + 1"], answers.__setitem__)
    pool.close()


@pytest.mark.parametrize("gone", ["scheduler", "workers"])
def test_a_cluster_that_is_gone_is_told(cluster: Cluster, gone: str, monkeypatch: pytest.MonkeyPatch) -> None:
    address, workers, scheduler = cluster
    pool = DaskPool(address)
    while pool.workers < 2:
        time.sleep(0.05)
    monkeypatch.setattr(dask_pool, "GONE_S", LIMIT_S)

    def told(task: str, answer: Any) -> None:
        for process in [scheduler] if gone == "scheduler" else workers:
            process.kill()

    with pytest.raises(InputError, match=r"^--dask: "):
        pool.run(eval, ["1 + 1", *[HANG] * 4], told)
    pool.close()


def test_an_address_without_a_scheduler_is_a_mistake(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dask_pool, "REACH_S", 0.5)
    with pytest.raises(InputError, match="running Dask scheduler"):
        DaskPool("tcp://127.0.0.1:1")
