"""The fuzz in pieces: shared out whole, in processes whose end is seen."""

import pytest

from tests.fuzz.fuzz_run import rows
from tests.fuzz.originals import kinds
from tests.fuzz.pieces import INPUTS as WHOLE
from tests.fuzz.pieces import compute, died, summed, tasks

FEW = 4
"""Kinds that are read in a process of its own here; `tests/fuzz/test_fuzz.py` reads all."""


def test_the_work_is_shared_out_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    assert [n for first, last in tasks(WHOLE) for n in range(int(first), int(last) + 1)] == list(range(WHOLE))
    assert WHOLE >= 20_000
    asked: list[tuple[str, int]] = []
    monkeypatch.setattr(
        "tests.fuzz.fuzz_run._row", lambda kind, seeds, folder: asked.extend((kind.name, s) for s in seeds)
    )
    list(rows(0, 99))
    list(rows(100, 1999))
    assert len(set(asked)) == len(asked) == 2000
    names = {name: [seed for kind, seed in asked if kind == name] for name, _ in asked}
    assert all(seeds == list(range(len(seeds))) for seeds in names.values())
    assert {"scene", "study", "experiments", "history", "store"} <= set(names)
    assert {"output folder", "gzip", "sister in gzip", "AT2 header", "title"} <= set(names)


def test_mutated_files_are_read_in_a_process_of_its_own() -> None:
    some = kinds()[:FEW]
    found = compute(("0", str(FEW - 1)))
    assert [(row["reader"], row["inputs"], row["found"]) for row in found] == [(kind.name, 1, []) for kind in some]
    (row,) = compute(("0", "none"))
    assert row["tracebacks"] == 1
    assert "ValueError" in row["found"][0]["what"]


def test_a_process_that_ends_counts_as_a_failure() -> None:
    counts = {"inputs": 100, "accepted": 30, "tracebacks": 0, "hangs": 0, "half_written": 0}
    good = {"reader": "scene", **counts, "said": [1, 2], "found": []}
    row, ended = summed([good, {**good, "said": [2, 3]}, *died("100 to 199: Timeout")])
    assert (row.inputs, row.tracebacks, row.refusals) == (200, 0, 3)
    assert ended.tracebacks == ended.harm == 1
    assert "inputs 100 to 199: Timeout" in ended.found[0].what
