"""However a study ends (killed, told to end, a worker dead), what was finished is kept; going on ends in the same store."""

import random
import signal
import sqlite3
import subprocess
import sys
import time
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from harness.questions.study.cases import load_study
from harness.questions.study.study_run import run_study
from harness.runs.execute import KEPT, Campaign
from harness.runs.runner import LocalPool
from harness.runs.store import Store
from harness.runs.task import Task
from tests.harness.questions.study.small_study import CONTACT, contents, lethal, lost, written
from tests.harness.runs.endings import ended

KILLS = 10
LONGEST_S = 60.0
"""A fresh process has its first result well within it, however busy the machine."""


def begun(path: Path, folder: Path) -> subprocess.Popen[str]:
    command = [sys.executable, "-c", "from reports.cli import main; main()"]
    command += ["study", str(path), "--out", str(folder), "--jobs", "2"]
    return subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)


def stored(path: Path) -> int:
    try:
        with closing(sqlite3.connect(f"file:{path}?mode=ro", uri=True)) as db:
            return int(db.execute("SELECT count(*) FROM result").fetchone()[0])
    except sqlite3.OperationalError:
        return 0


def wait_for(path: Path, count: int, child: subprocess.Popen[str]) -> None:
    end = time.monotonic() + LONGEST_S
    while stored(path) < count and child.poll() is None:
        assert time.monotonic() < end, "no result in time"
        time.sleep(0.002)


def whole(path: Path, store_path: Path) -> list[Any]:
    with Store(store_path) as store:
        pool = LocalPool(2)
        run_study(load_study(path), path, store, pool)
        pool.close()
    return contents(store_path)


@pytest.mark.slow
def test_killed_at_random_moments_a_study_ends_in_the_same_store_row_for_row(tmp_path: Path) -> None:
    path = written(tmp_path / "study", CONTACT)
    undisturbed = whole(path, tmp_path / "whole.sqlite")
    cases = len(undisturbed[0])
    stream = random.Random(20260)
    # Moments: after how many results, and how much later. Each goes on where the last was killed; some cases are left.
    moments = sorted((stream.randrange(2 * cases // 3), stream.uniform(0.0, 0.03)) for _ in range(KILLS))
    killed = tmp_path / "out" / "store.sqlite"
    counts = []
    for count, later_s in moments:
        child = begun(path, tmp_path / "out")
        wait_for(killed, count, child)
        time.sleep(later_s)
        child.kill()
        child.communicate()
        counts.append(stored(killed))
    assert counts == sorted(counts), "a result that was stored is gone"
    assert 0 < counts[-1] < cases
    assert whole(path, killed) == undisturbed


def test_told_to_end_a_study_says_what_it_keeps_and_leaves_no_process(tmp_path: Path) -> None:
    path = written(tmp_path / "study", CONTACT)
    child = begun(path, tmp_path / "out")
    wait_for(tmp_path / "out" / "store.sqlite", 1, child)
    workers = Path(f"/proc/{child.pid}/task/{child.pid}/children").read_text().split()
    child.send_signal(signal.SIGTERM)
    _, said = child.communicate(timeout=LONGEST_S)
    assert child.returncode == 130
    assert KEPT in said
    assert not [word for word in ("Traceback", "leaked", "Warning", "Error") if word in said], said
    assert len(workers) >= 2
    assert all(ended(int(pid)) for pid in workers)


def test_a_death_in_a_batch_is_charged_to_its_own_task(tmp_path: Path) -> None:
    tasks = [
        Task(name, lethal, name, group, lost)
        for name, group in zip(("a", "b", "die", "c", "d", "e", "f"), "1111223", strict=True)
    ]
    with Store(tmp_path / "store.sqlite") as store, closing(LocalPool(2)) as pool:
        campaign = Campaign(store, pool, sizes={"1": 4, "2": 2})
        campaign.run(tasks, len(tasks))
        answers = {task.key: record for task in tasks if (record := store.get(task.key)) is not None}
    assert "code 3" in answers.pop("die")["text"]
    assert answers == {name: {"text": name.upper()} for name in "abcdef"}
    assert (campaign.computed, campaign.failed) == (7, 1)
