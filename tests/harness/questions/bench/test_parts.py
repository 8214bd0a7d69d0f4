"""Measurements in parts: what is finished is kept, what was interrupted goes on, one part can be measured anew."""

import os
import signal
import subprocess
import sys
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from harness.model import InputError
from harness.questions.bench.parts import Part, command, measure
from harness.records.bench import of_parts
from harness.runs.store import STORE_NAME, Store

STAMP = {"versions": {"rockcheck": "1"}, "quick": False}


def silent(text: str) -> None:
    """Hears nothing."""


class Counting:
    """Work that counts how often each task was done, and may be interrupted at one."""

    def __init__(self, stop_at: str = "") -> None:
        self.done: list[str] = []
        self.stop_at = stop_at

    def __call__(self, task: str) -> list[dict[str, Any]]:
        if task == self.stop_at:
            raise KeyboardInterrupt
        self.done.append(task)
        return [{"task": task, "time": len(self.done)}]


def parts(work: Counting, other: Counting | None = None) -> list[Part]:
    return [Part("first", ("a", "b", "c"), work), Part("second", ("d",), other or work)]


def test_what_was_interrupted_goes_on_and_what_is_finished_is_kept(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt):
        measure(tmp_path, parts(Counting("c")), None, STAMP, silent)
    again = Counting()
    rows, (_, second) = measure(tmp_path, parts(again), None, STAMP, silent)
    assert again.done == ["c", "d"]
    assert [row["task"] for row in rows["first"]] == ["a", "b", "c"]
    assert not second.left


OTHER = {**STAMP, "versions": {"rockcheck": "2"}}


@pytest.mark.parametrize(
    ("first", "asked", "stamp", "done"),
    [
        (None, None, STAMP, ["a", "b", "c", "d"]),  # a whole one is made anew
        (None, ["second"], STAMP, ["d"]),  # of one part alone the others are kept
        (["first"], None, OTHER, ["a", "b", "c", "d"]),  # rows of other versions are not used
        (["first"], None, STAMP, ["d"]),
    ],
)
def test_what_is_measured_again(
    tmp_path: Path, first: list[str] | None, asked: list[str] | None, stamp: dict[str, Any], done: list[str]
) -> None:
    measure(tmp_path, parts(Counting()), first, STAMP, silent)
    again = Counting()
    _, found = measure(tmp_path, parts(again), asked, stamp, silent)
    assert again.done == done
    assert not found[0].left


def test_a_part_alone_leaves_the_others_to_do_and_says_so(tmp_path: Path) -> None:
    _, found = measure(tmp_path, parts(Counting()), ["second"], STAMP, silent)
    left, why, spent = of_parts(found, {"hull": "no program"})
    assert (left.code, left.values) == ("parts_left", {"parts": {"first": 3}})
    assert why.values == {"what": "hull", "reason": "no program"}
    assert list(spent.values["clock_s"]) == ["second"]


def test_the_command_that_repeats_a_run_carries_its_options(tmp_path: Path) -> None:
    _, part = measure(tmp_path, parts(Counting()), ["second"], STAMP, silent)
    assert command("stress", True, part) == "rockcheck stress --quick --parts second"
    _, whole = measure(tmp_path, [*parts(Counting()), Part("nothing to do", (), Counting())], None, STAMP, silent)
    assert command("bench", False, whole) == "rockcheck bench"


def test_a_damaged_row_is_told_with_what_can_be_done(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt):
        measure(tmp_path, parts(Counting("c")), None, STAMP, silent)
    path = tmp_path / STORE_NAME
    with Store(path, "bench") as store:
        store._db.execute("UPDATE result SET record = substr(record, 1, 20) WHERE rowid = 2")
        store._db.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    with pytest.raises(InputError, match=r"\.sqlite: "):
        measure(tmp_path, parts(Counting()), None, STAMP, silent)
    path.unlink()
    again = Counting()
    assert not measure(tmp_path, parts(again), None, STAMP, silent)[1][0].left
    assert again.done == ["a", "b", "c", "d"]


KILLED = """
import os, sys
from pathlib import Path
from harness.questions.bench.parts import Part, measure

def work(task):
    if task == "c":
        os.kill(os.getpid(), 9)
    return [{"task": task}]

measure(Path(sys.argv[1]), [Part("first", ("a", "b", "c"), work), Part("second", ("d",), work)], None, {}, print)
"""


def test_what_was_finished_outlives_a_kill(tmp_path: Path) -> None:
    done = subprocess.run([sys.executable, "-c", KILLED, tmp_path], check=False, cwd=Path.cwd())
    assert done.returncode == -signal.SIGKILL
    again = Counting()
    measure(tmp_path, parts(again), None, {}, silent)
    assert again.done == ["c", "d"]


def test_an_unknown_part_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"^--parts: .* first, second, got 'third'"):
        measure(tmp_path, parts(Counting()), ["third"], STAMP, silent)


def squared(base: int, task: str) -> list[dict[str, Any]]:
    """Work for a worker: the process ends with task 3."""
    if task == "3":
        os._exit(1)
    return [{"value": int(task) ** 2 + base}]


def died(task: str) -> list[dict[str, Any]]:
    return [{"value": -1}]


def test_workers_compute_side_by_side_and_a_death_is_a_row(tmp_path: Path) -> None:
    part = Part("squares", ("1", "2", "3", "4"), partial(squared, 100), died)
    found, _ = measure(tmp_path, [part], None, STAMP, silent)
    assert [row["value"] for row in found["squares"]] == [101, 104, -1, 116]


def test_the_source_is_part_of_what_a_row_was_measured_with(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from harness.questions.bench import parts as module

    first = Counting()
    measure(tmp_path, parts(first)[:1], ["first"], module.stamp(False), silent)
    monkeypatch.setattr(module, "source", lambda more=(): "other code")
    again = Counting()
    measure(tmp_path, parts(again), None, module.stamp(False), silent)
    assert again.done == ["a", "b", "c", "d"]
