"""Mutated files: the cases that were found stay refused in words, and the search itself can see a traceback."""

import gzip
import sqlite3
import subprocess
import sys
import time
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from harness.input.motions.recordfile import RecordFile
from harness.model import InputError, Mistake
from tests.fuzz.fuzz_run import Tried, attempt, rows
from tests.fuzz.mutate import (
    BINARY,
    BOMB_BYTES,
    LISTED,
    PACKED,
    STEPPED,
    STL,
    TEXT,
    TITLED,
    bomb,
    mutated,
    point,
)
from tests.fuzz.originals import EFFECTS, EXPERIMENTS, SCENE, Kind, kinds, obj, ply, prepare, stl, tosses
from tests.fuzz.pieces import INPUTS as WHOLE
from tests.fuzz.pieces import summed
from tests.fuzz.records import at2, cosmos, esm, smc
from tests.fuzz.use import WRITTEN, unfinished

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
        SCENE.replace(b"title =", b"Title ="),
        SCENE.replace(b"[wall]", b"[record]"),
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
    "3D effects": (
        EFFECTS.replace(b"[search]", b"[effects3d]"),
        EFFECTS.replace(b"directions = 8", b"Directions = 8"),
        b"a = " + b"[" * 100_000,
    ),
    "motion AT2": (at2().replace(b"DT=   0.0200", b"DT=   2.0E+12"),),
    "tosses": (tosses().replace(b",1.0,0.0,0.0,0.0", b",1e300,0.0,0.0,0.0", 1),),
    "experiments": (EXPERIMENTS.replace(b",2.0,", b",2e12,"),),
    "motion CSV": tuple(
        head + b"\n" + b"0.1\n" * 50 + b"0.2\n"
        for head in (
            b"NPTS=" + b"9" * 5000 + b" DT=.01",
            b"dt " + b"9" * 20_000,
            b"9 " * 50_000 + b"x",
            b"-" * 100_000,
            b"1." * 50_000 + b"hz",
            b"m/s" * 50_000,
            b"3251 POINTS OF ACC" + b" A" * 50_000,
            b"(8F" + b"9" * 5000 + b".3)",
        )
    ),
    "motion SMC": (smc().replace(b"    -32768", b"1.0000e300", 1),),
}
"""Inputs that once ended in a traceback or never, by kind."""
INPUTS = 420
"""Mutated inputs in every CI run; `make stress` reads twenty thousand, the first of the same numbers apart."""
PAST_READING = 0.45
"""Share that is to be accepted and used: half of many, less than three standard deviations (0.025) of so few."""


@pytest.fixture(scope="module")
def every() -> dict[str, Kind]:
    return {kind.name: kind for kind in kinds()}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    prepare(tmp_path)
    return tmp_path


@pytest.mark.parametrize(("name", "content"), [(name, item) for name, items in FOUND.items() for item in items])
def test_a_found_case_does_no_harm_again(every: dict[str, Kind], folder: Path, name: str, content: bytes) -> None:
    assert attempt(every[name], content, folder).wrong is None


@pytest.mark.parametrize("name", ["scene", "study", "motion CSV", "history", "mesh OBJ"])
def test_what_a_file_is_used_for_is_written_whole(every: dict[str, Kind], folder: Path, name: str) -> None:
    kind = every[name]
    (folder / kind.file).write_bytes(kind.content)
    kind.read(folder / kind.file)
    files = sorted(path for path in (folder / WRITTEN).iterdir() if path.is_file())
    assert files
    assert unfinished(folder / WRITTEN, accepted=True) is None
    assert "written though refused" in (unfinished(folder / WRITTEN, accepted=False) or "")
    for path in files:
        whole = path.read_bytes()
        path.write_bytes(whole[: len(whole) // 2] if path.suffix in (".json", ".csv") else b"")
        assert unfinished(folder / WRITTEN, accepted=True), f"half of {path.name} is taken for the whole"
        path.write_bytes(whole)


def test_a_history_that_a_result_names_and_lacks_is_seen(every: dict[str, Kind], folder: Path) -> None:
    (folder / "scene.toml").write_bytes(SCENE)
    every["scene"].read(folder / "scene.toml")
    (folder / WRITTEN / "history_analytic.csv").unlink()
    assert "history_analytic.csv" in (unfinished(folder / WRITTEN, accepted=True) or "")


def test_a_damaged_result_in_a_whole_store_is_refused(every: dict[str, Kind], folder: Path) -> None:
    kind = every["store"]
    damaged = kind.content.replace(b'"outcome"', b'"outcome\x00"')
    assert damaged != kind.content
    assert attempt(kind, damaged, folder).refusal


def test_a_stored_result_that_is_nothing_is_refused(every: dict[str, Kind], folder: Path) -> None:
    path = folder / "nothing.sqlite"
    path.write_bytes(every["store"].content)
    looser = "UPDATE sqlite_schema SET sql=replace(sql, 'record TEXT NOT NULL', 'record TEXT') WHERE name='result'"
    # SQLite lets no such value in, but a damaged page reads back so.
    for said in (
        ("PRAGMA journal_mode=DELETE", "PRAGMA writable_schema=1", looser),
        ("UPDATE result SET record=NULL",),
    ):
        with closing(sqlite3.connect(path, isolation_level=None)) as store:
            for statement in said:
                store.execute(statement)
    assert attempt(every["store"], path.read_bytes(), folder).refusal


@pytest.mark.slow
def test_whole_files_are_accepted_and_mutated_inputs_do_no_harm() -> None:
    found = summed(list(rows(10 * WHOLE, 10 * WHOLE + INPUTS - 1)))
    assert [row for row in found if row.found] == []
    assert {row.reader for row in found} == {kind.name for kind in kinds()}
    assert sum(row.inputs for row in found) == INPUTS
    assert sum(row.accepted for row in found) >= PAST_READING * INPUTS, "what is refused hides what else is wrong"
    # A record that was changed proves nothing to be ours: its folder is refused, whatever the change.
    shallow = [row.reader for row in found if not (row.reader != "output folder") <= row.accepted < row.inputs]
    assert shallow == [], "a kind that is always refused, or never, is not searched"
    # Two refusals of so few inputs may be alike by chance.
    often = [row for row in found if row.inputs - row.accepted > 2]
    assert min(row.refusals for row in often) > 1, "damage that always ends at the same sentence searches nothing"
    assert len(often) > 0.8 * len(found)


def work_s(seconds: float) -> None:
    """Take so much processor time."""
    begin = time.process_time()
    while time.process_time() - begin < seconds:
        pass


def test_the_search_sees_what_it_looks_for(
    every: dict[str, Kind], folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def raises(path: Path) -> None:
        raise KeyError(path.name)

    def litters(path: Path) -> None:
        (path.parent / "half.json").write_text("{")

    scene = every["scene"]

    def refuses_late(path: Path) -> None:
        (path.parent / WRITTEN).mkdir()
        (path.parent / WRITTEN / "half.csv").write_text("t_s", encoding="utf-8")
        raise InputError(Mistake("file", "", "something else", "this"))

    def waits(path: Path) -> None:
        work_s(5.0)

    assert "KeyError" in (attempt(replace(scene, read=raises), b"", folder).wrong or "")
    assert attempt(replace(scene, read=litters), b"", folder).wrong == "left half.json"
    late = attempt(replace(scene, read=refuses_late), b"", folder).wrong
    assert late == "left half-written: written though refused: half.csv"
    assert not (folder / WRITTEN).exists()
    with monkeypatch.context() as short:
        short.setattr("tests.fuzz.fuzz_run.HANG_S", 1)
        assert attempt(replace(scene, read=waits), b"", folder).wrong == "hang"
        slow = replace(scene, read=lambda path: work_s(1.5))
        assert attempt(slow, SCENE, folder, 10) == Tried(), "the first file of a kind imports what its use takes"
    assert attempt(scene, SCENE, folder) == Tried()


def test_the_search_sees_memory_that_was_taken(
    every: dict[str, Kind], folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    taken = iter([500.0, 2500.0, 2500.0])
    monkeypatch.setattr("tests.fuzz.fuzz_run._most_mib", lambda: next(taken))
    assert attempt(every["motion CSV"], every["motion CSV"].content, folder).wrong == "took 2500 MiB"


@pytest.mark.parametrize("name", ["options of new", "options of run", "options of a text", "record"])
def test_the_search_sees_a_command_end_in_a_traceback(
    every: dict[str, Kind], folder: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    kind = every[name]
    assert attempt(kind, b"--nothing-like-it" if "options" in name else b"{}", folder).refusal

    ended = SimpleNamespace(exception=KeyError(name), exit_code=1, output="")
    monkeypatch.setattr("typer.testing.CliRunner.invoke", lambda *given, **named: ended)
    assert "KeyError" in (attempt(kind, kind.content, folder).wrong or "")


def test_the_search_sees_a_step_misread_and_a_folder_robbed(
    every: dict[str, Kind], folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from harness.input.motions import readers
    from tests.fuzz import use

    whole = readers.read_file

    def a_hundred_times_too_slow(path: Path) -> RecordFile:
        record = whole(path)
        return replace(
            record, channels=tuple(replace(channel, dt_s=100.0 * channel.dt_s) for channel in record.channels)
        )

    header, output = every["AT2 header"], every["output folder"]
    monkeypatch.setattr(readers, "read_file", a_hundred_times_too_slow)
    assert "a step of 0.0200 is read as 2.0" in (attempt(header, header.content, folder).wrong or "")

    def robs(scene: Path, there: Path) -> None:
        (there / "notes.txt").write_text("")

    def robs_and_refuses(scene: Path, there: Path) -> None:
        (there / "notes.txt").unlink()
        raise InputError(Mistake("--out", "", "another folder", "this"))

    for way, said in ((robs, "a file that is another's was changed"), (robs_and_refuses, "is not as it was")):
        monkeypatch.setattr(use, "write_into", way)
        assert said in (attempt(output, output.content, folder).wrong or "")


@pytest.mark.parametrize("name", LISTED)
def test_a_record_that_lists_what_is_no_file_of_its_folder_takes_nothing(
    every: dict[str, Kind], folder: Path, name: bytes
) -> None:
    output = every["output folder"]
    content = output.content.replace(b'"files": {', b'"files": {' + name + b": null, ", 1)
    assert content != output.content
    assert attempt(output, content, folder).wrong is None


def test_a_title_that_steers_the_terminal_is_seen(
    every: dict[str, Kind], folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    titled = SCENE.replace(b"a block", b"\\u001b[31m [/] red")
    assert attempt(every["title"], titled, folder) == Tried()
    monkeypatch.setattr("reports.terminal.printable", str)
    assert "steers the terminal" in (attempt(every["title"], titled, folder).wrong or "")


def test_a_bomb_costs_no_more_than_what_may_be_read(every: dict[str, Kind], folder: Path) -> None:
    for name in ("gzip", "sister in gzip"):
        content = bomb(every[name].content, np.random.default_rng(1))
        assert len(content) < BOMB_BYTES / 100
        assert "64 MiB" in (attempt(every[name], content, folder).refusal or "")


def test_compiled_code_that_never_comes_back_ends_its_process() -> None:
    code = (
        "from itertools import repeat\nfrom tests.fuzz import fuzz_run\nfuzz_run.DEAD_SHARE = 2.0\n"
        "with fuzz_run.limited(1): sum(repeat(1))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.returncode != 0
    assert "Timeout" in done.stderr


@pytest.mark.parametrize("ways", [TEXT, BINARY, STL, STEPPED, TITLED, PACKED])
def test_mutations_are_reproducible_and_do_something(ways: tuple) -> None:  # type: ignore[type-arg]
    others = {STL: stl(), STEPPED: at2(), TITLED: SCENE, PACKED: gzip.compress(at2(), mtime=0)}
    original = others.get(ways, ply())
    twice = [[mutated(original, seed, ways) for seed in range(50)] for _ in range(2)]
    assert twice[0] == twice[1]
    assert original not in twice[0]


def test_a_moved_point_of_an_stl_moves_in_all_its_facets() -> None:
    moved = point(stl(), np.random.default_rng(1))
    corners = {moved[84 + 50 * k + 12 * j :][:12] for k in range(12) for j in (1, 2, 3)}
    assert len(corners) == 8
    assert moved != stl()
