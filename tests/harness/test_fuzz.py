"""Mutated files: the cases that were found stay refused in words, and the search itself can see a traceback."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from harness.fuzz.mutate import BINARY, TEXT, mutated
from harness.fuzz.originals import Kind, kinds, obj, ply, prepare
from harness.fuzz.run import attempt, fuzz

FOUND = {
    "history": (
        b"t_s,theta_rad\n0,0\n0,1\n1,2\n",
        b"t_s,theta_rad\n0,0\n1e300,1\n1e300,nan\n",
        b"t_s,theta_rad\n0,0\ninf,1\n",
    ),
    "mesh OBJ": (
        b"v 1\nv 2\nv 3\nf 1 2 3\n",
        obj().replace(b"f 1 3 2", b"f 1 1 1"),
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 1 2\n",
    ),
    "mesh PLY": (ply().replace(b"3 0 2 1", b"3 0 2 9"), ply().replace(b"3 0 2 1", b"3 0 2 -5")),
    "study": (b'title = "t"\nscene = "good.toml"\n[[vary]]\nkey = "a"\nstart = 0\nstop = 1\ncount = 9999999999999\n',),
}
"""Inputs that once ended in a traceback, by kind."""
INPUTS = 600
"""Mutated inputs in every CI run; `make stress` reads ten thousand."""


@pytest.fixture(scope="module")
def every() -> dict[str, Kind]:
    return {kind.name: kind for kind in kinds()}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    prepare(tmp_path)
    return tmp_path


@pytest.mark.parametrize(("name", "content"), [(name, item) for name, items in FOUND.items() for item in items])
def test_a_found_case_stays_refused_in_words(every: dict[str, Kind], folder: Path, name: str, content: bytes) -> None:
    assert attempt(every[name], content, folder) is None


def test_whole_files_are_read(every: dict[str, Kind], folder: Path) -> None:
    for kind in every.values():
        path = folder / kind.file
        path.write_bytes(kind.content)
        kind.read(path)


def test_a_damaged_result_in_a_whole_store_is_refused(every: dict[str, Kind], folder: Path) -> None:
    kind = every["store"]
    damaged = kind.content.replace(b'"outcome_sentence"', b'"outcome\x00sentence"')
    assert damaged != kind.content
    assert attempt(kind, damaged, folder) is None


def test_mutated_inputs_do_no_harm() -> None:
    rows = fuzz(INPUTS, seed=10_000)
    assert {row["reader"] for row in rows} >= {"scene", "study", "experiments", "history", "store"}
    assert [row for row in rows if row["found"]] == []


def test_the_search_sees_what_it_looks_for(every: dict[str, Kind], folder: Path) -> None:
    def raises(path: Path) -> object:
        raise KeyError(path.name)

    def litters(path: Path) -> object:
        return (path.parent / "half.json").write_text("{")

    scene = every["scene"]
    assert "KeyError" in (attempt(replace(scene, read=raises), b"", folder) or "")
    assert "half.json" in (attempt(replace(scene, read=litters), b"", folder) or "")


@pytest.mark.parametrize("ways", [TEXT, BINARY])
def test_mutations_are_reproducible_and_do_something(ways: tuple) -> None:  # type: ignore[type-arg]
    original = ply()
    twice = [[mutated(original, seed, ways) for seed in range(50)] for _ in range(2)]
    assert twice[0] == twice[1]
    assert sum(item != original for item in twice[0]) > 40
