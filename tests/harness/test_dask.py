"""The same study on a Dask cluster: same store, nothing lost, nothing twice."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from harness.errors import InputError
from harness.executors import DaskPool, LocalPool
from harness.store import Store
from harness.study import run_study
from harness.study_file import load_study
from tests.harness.small_study import contents, written

pytest.importorskip("distributed", reason="the extra [dask] is not installed")


@pytest.fixture
def scheduler(tmp_path: Path) -> Iterator[str]:
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
    assert stream is not None
    address = next(found[0] for line in stream if (found := re.search(r"tcp://127\.0\.0\.1:\d+", line)))
    for _ in range(2):
        worker = [sys.executable, "-m", "distributed.cli.dask_worker", address, "--nthreads", "1", "--no-dashboard"]
        processes.append(subprocess.Popen(worker, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL, cwd=tmp_path))
    yield address
    for process in processes:
        process.kill()
        process.wait()
    stream.close()


def test_a_study_on_a_cluster_ends_in_the_same_store(scheduler: str, tmp_path: Path) -> None:
    path = written(tmp_path / "study")
    study = load_study(path)
    with Store(tmp_path / "local.sqlite") as store:
        run_study(study, path, store, LocalPool(1))
    pool = DaskPool(scheduler)
    with Store(tmp_path / "cluster.sqlite") as store:
        first = run_study(study, path, store, pool)
        again = run_study(study, path, store, pool)
    pool.close()
    assert first.computed == first.distinct == 30
    assert again.computed == 0
    assert contents(tmp_path / "cluster.sqlite") == contents(tmp_path / "local.sqlite")


def test_an_address_without_a_scheduler_is_a_mistake(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="running Dask scheduler"):
        DaskPool("tcp://127.0.0.1:1")
