"""Mutated files: the cases that were found stay refused in words, and the search itself can see a traceback."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from harness.fuzz.mutate import BINARY, TEXT, mutated
from harness.fuzz.originals import SCENE, Kind, kinds, obj, ply, prepare
from harness.fuzz.records import cosmos, esm, smc
from harness.fuzz.run import attempt, died, fuzz, summed, tasks

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
    "scene": (
        SCENE.replace(b"depth_m = 0.72", b"depth_m = 1e300"),
        SCENE.replace(b"depth_m = 0.80", b"depth_m = 1e300"),
        SCENE.replace(b"amplitude_g = 0.1\nduration_s = 0.5", b"amplitude_g = 0.1\nduration_s = 1e-300"),
        SCENE.replace(b"mass_kg = 707.0", b"mass_kg = 1e300"),
        SCENE.replace(b"gravity_m_s2 = 9.81", b"gravity_m_s2 = 1e300"),
        SCENE.replace(b"centroid_height_m = 0.774", b"centroid_height_m = 1e-300"),
    ),
    "motion ESM": (
        esm().replace(b"USER2:", b"USER1:"),
        esm().replace(b"NDATA: 40", b"NDATA: inf"),
        esm().replace(b"PGA_CM/S^2: ", b"PGA_CM/S^2: x"),
    ),
    "motion COSMOS": (cosmos().replace(b"(10I8)", b"(10I0)", 1), cosmos().replace(b"(8F10.5)", b"(0F10.5)", 1)),
    "motion SMC": (smc().replace(b"    -32768", b"1.0000e300", 1),),
}
"""Inputs that once ended in a traceback or never, by kind."""
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


def test_the_work_is_shared_out_whole() -> None:
    pieces = tasks(3000, seed=7)
    spans = [piece.partition(": ")[2].split(" to ") for piece in pieces if piece.startswith("scene: ")]
    seeds = [seed for first, last in spans for seed in range(int(first), int(last) + 1)]
    assert seeds == list(range(7, 7 + 3000 // len(kinds())))


def test_a_reader_that_ends_its_process_counts_as_a_failure() -> None:
    good = {"reader": "scene", "inputs": 100, "tracebacks": 0, "hangs": 0, "half_written": 0, "found": []}
    (row,) = summed([good, *died("scene: 100 to 199")])
    assert (row["inputs"], row["tracebacks"]) == (200, 1)
    assert "seeds 100 to 199" in row["found"][0]["what"]


@pytest.mark.parametrize("ways", [TEXT, BINARY])
def test_mutations_are_reproducible_and_do_something(ways: tuple) -> None:  # type: ignore[type-arg]
    original = ply()
    twice = [[mutated(original, seed, ways) for seed in range(50)] for _ in range(2)]
    assert twice[0] == twice[1]
    assert sum(item != original for item in twice[0]) > 40
