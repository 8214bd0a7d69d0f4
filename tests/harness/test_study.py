"""A study computes each distinct run once, goes on where it was killed, and ends in the same store."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from harness import asking
from harness.errors import InputError
from harness.executors import LocalPool
from harness.store import Store
from harness.study import Summary, run_study, study_name
from harness.study_file import load_study
from tests.harness.small_study import STUDY, contents, written


def compute(path: Path, store_path: Path, jobs: int = 1) -> Summary:
    study = load_study(path)
    with Store(store_path) as store:
        return run_study(study, path, store, LocalPool(jobs))


def test_runs_that_are_the_same_by_their_physics_are_computed_once(tmp_path: Path) -> None:
    path = written(tmp_path)
    first = compute(path, tmp_path / "s.sqlite")
    assert (first.cases, first.wanted, first.distinct, first.computed) == (60, 60, 30, 30)
    again = compute(path, tmp_path / "s.sqlite")
    assert (again.computed, again.found) == (0, 30)


def test_the_store_does_not_depend_on_the_number_of_processes(tmp_path: Path) -> None:
    path = written(tmp_path)
    compute(path, tmp_path / "one.sqlite", jobs=1)
    compute(path, tmp_path / "two.sqlite", jobs=2)
    assert contents(tmp_path / "one.sqlite") == contents(tmp_path / "two.sqlite")


def test_a_killed_study_goes_on_to_the_same_store(tmp_path: Path) -> None:
    path = written(tmp_path)
    compute(path, tmp_path / "whole.sqlite")
    code = (
        "import sys; from pathlib import Path; from harness.executors import LocalPool; from harness.store import Store;"
        "from harness.study import run_study; from harness.study_file import load_study;"
        "path = Path(sys.argv[1]); store = Store(Path(sys.argv[2])); run_study(load_study(path), path, store, LocalPool(1))"
    )
    killed = tmp_path / "killed.sqlite"
    for wait_s in (0.8, 1.6):
        child = subprocess.Popen([sys.executable, "-c", code, str(path), str(killed)], start_new_session=True)
        time.sleep(wait_s)
        os.killpg(child.pid, signal.SIGKILL)
        child.wait()
    compute(path, killed)
    assert contents(killed) == contents(tmp_path / "whole.sqlite")


def test_only_cases_near_the_boundary_and_an_audit_are_sent(tmp_path: Path) -> None:
    text = STUDY.replace('engines = ["analytic"]', 'engines = ["analytic", "pymunk"]')
    text = text.replace("count = 6", "count = 4").replace("count = 5", "count = 2").replace("[0.85, 0.9]", "[0.85]")
    path = written(tmp_path, text + '[accuracy]\npymunk = 1e-2\n[ask]\ncases = "boundary"\naudit = 0.2\n')
    summary = compute(path, tmp_path / "s.sqlite", jobs=2)
    study = load_study(path)
    with Store(tmp_path / "s.sqlite") as store:
        rows = list(store.rows(study_name(study)))
    sent = [row for row in rows if row["engine"] == "pymunk" and row["run"] is not None]
    left = [row for row in rows if row["engine"] == "pymunk" and row["run"] is None]
    assert summary.not_sent == len(left) > 0
    assert {row["reason"] for row in left} == {asking.NOT_SENT}
    assert {row["reason"] for row in sent} <= {asking.NEAR, asking.MARGIN, asking.AUDIT}
    assert asking.NEAR in {row["reason"] for row in sent}


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('scene = "block.toml"', 'scene = "none.toml"', "readable scene file"),
        ("motion.x.amplitude_g", "motion.x.amplitud_g", "did you mean amplitude_g"),
        ("start = 0.05", "", "start, stop and count"),
        ('engines = ["analytic"]', 'engines = ["analytical"]', "engines"),
        ('name = "own"', "", "name"),
        ("count = 6", "count = 0", "at least 1"),
    ],
)
def test_a_wrong_study_is_a_mistake_that_names_its_key(tmp_path: Path, old: str, new: str, message: str) -> None:
    path = written(tmp_path, STUDY.replace(old, new))
    with pytest.raises(InputError, match=message):
        compute(path, tmp_path / "s.sqlite")
