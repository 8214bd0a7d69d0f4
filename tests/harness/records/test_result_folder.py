"""Nothing that rockcheck did not write is replaced or removed: foreign folders, files put into its own, and what a run reads."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from harness.input.scene_file import load_scene
from harness.model.errors import InputError
from harness.model.scene import Scene
from harness.records.result_folder import COMING, check_folder, check_listed, listing, named_after, owned, writing
from harness.scene_run.scene_run import Result, check_writing, run_scene, write_result
from tests.scenes_for_tests import paestum


@pytest.fixture(scope="module")
def result() -> Result:
    return run_scene(paestum(0.1, 2.0), ["analytic"])


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


@pytest.mark.parametrize("name", ["history_measured.csv", "statue.glb", "report.html", "notes.txt", "result.json"])
def test_a_foreign_folder_is_refused_and_keeps_everything(tmp_path: Path, result: Result, name: str) -> None:
    (tmp_path / name).write_text("{}")
    with pytest.raises(InputError, match="--out"):
        write_result(result, tmp_path)
    assert contents(tmp_path) == {name: b"{}"}


@pytest.mark.parametrize("name", ["history_measured.csv", "statue.glb", "notes.txt"])
def test_what_is_not_listed_stays(tmp_path: Path, result: Result, name: str) -> None:
    write_result(result, tmp_path)
    (tmp_path / name).write_text("mine")
    write_result(result, tmp_path)
    assert (tmp_path / name).read_text() == "mine"


def test_a_file_in_the_place_of_a_new_one_is_not_lost(tmp_path: Path, result: Result) -> None:
    write_result(result, tmp_path)
    (tmp_path / "history_pymunk.csv").write_text("measured")
    both = run_scene(paestum(0.1, 2.0), ["analytic", "pymunk"])
    before = contents(tmp_path)
    with pytest.raises(InputError, match=r"history_pymunk\.csv"):
        write_result(both, tmp_path)
    assert contents(tmp_path) == before


def test_a_file_that_was_changed_since_is_not_lost(tmp_path: Path, result: Result) -> None:
    write_result(result, tmp_path)
    (tmp_path / "history_analytic.csv").write_text("measured")
    with pytest.raises(InputError, match="changed since"):
        write_result(result, tmp_path)
    assert (tmp_path / "history_analytic.csv").read_text() == "measured"


def test_the_record_lists_its_files_with_checksums(tmp_path: Path, result: Result) -> None:
    write_result(result, tmp_path)
    files = json.loads((tmp_path / "result.json").read_text())["files"]
    assert files == listing([tmp_path / "history_analytic.csv"])
    assert files["report.html"] is None


def test_a_record_names_files_of_its_own_folder_only(tmp_path: Path, result: Result) -> None:
    folder = tmp_path / "out"
    (tmp_path / "precious").write_text("mine")
    write_result(result, folder)
    record = json.loads((folder / "result.json").read_text())
    record["files"] |= {"../precious": None, str(tmp_path / "precious"): None}
    (folder / "result.json").write_text(json.dumps(record))
    assert set(owned(folder)) == {"history_analytic.csv", "report.html", "conservator.html"}
    write_result(result, folder)
    assert (tmp_path / "precious").read_text() == "mine"


def test_a_folder_without_a_list_owns_what_its_record_names(tmp_path: Path, result: Result) -> None:
    """Records of older versions list no files."""
    write_result(result, tmp_path)
    record = json.loads((tmp_path / "result.json").read_text())
    del record["files"]
    (tmp_path / "result.json").write_text(json.dumps(record))
    (tmp_path / "history_measured.csv").write_text("mine")
    write_result(result, tmp_path)
    assert (tmp_path / "history_measured.csv").read_text() == "mine"


def test_a_write_that_was_killed_can_be_done_again(tmp_path: Path, result: Result) -> None:
    write_result(result, tmp_path)
    record = json.loads((tmp_path / "result.json").read_text())
    (tmp_path / "history_analytic.csv").write_text("the next history")
    record["files"] = listing([tmp_path / "history_analytic.csv"])
    (tmp_path / COMING).write_text(json.dumps(record))
    write_result(result, tmp_path)
    assert not (tmp_path / COMING).exists()


def test_a_result_of_another_kind_is_not_replaced(tmp_path: Path, result: Result) -> None:
    write_result(result, tmp_path)
    with pytest.raises(InputError, match="which holds a run"):
        check_folder(tmp_path, ("study",))


SCENE = """
title = "a block"
duration_s = 1.0
[statue]
mesh = { file = "out/statue.glb", unit = "m", density_kg_m3 = 2000.0 }
"""


def scan_scene(tmp_path: Path) -> Scene:
    import trimesh

    (tmp_path / "out").mkdir()
    box = trimesh.creation.box((0.2, 0.2, 1.0))
    box.export(tmp_path / "out" / "statue.glb")
    (tmp_path / "scene.toml").write_text(SCENE)
    return load_scene(tmp_path / "scene.toml")


def test_a_scan_that_the_scene_reads_is_no_output(tmp_path: Path, result: Result) -> None:
    scene = scan_scene(tmp_path)
    before = contents(tmp_path / "out")
    with pytest.raises(InputError, match=r"statue\.glb would be lost"):
        check_writing(tmp_path / "out", scene, ["analytic"])
    # Nor where the scan is what an earlier run has written there.
    record = {"schema_version": 1, "kind": "run", "files": listing([tmp_path / "out" / "statue.glb"])}
    (tmp_path / "out" / "result.json").write_text(json.dumps(record))
    with pytest.raises(InputError, match=r"statue\.glb would be lost"):
        check_writing(tmp_path / "out", scene, ["analytic"])
    assert contents(tmp_path / "out")["statue.glb"] == before["statue.glb"]


@pytest.mark.parametrize("name", ["...toml", "..toml", ".."])
def test_a_name_of_dots_names_no_folder(name: str) -> None:
    with pytest.raises(InputError, match="give --out"):
        named_after(Path(name))


def test_a_name_that_is_too_long_is_a_mistake(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="--out"):
        check_folder(tmp_path / ("a" * 300))


def test_a_file_is_replaced_only_as_its_account_lists_it(tmp_path: Path) -> None:
    path, account = tmp_path / "mesh.ply", tmp_path / "mesh.account.json"
    check_listed(path, account)
    path.write_text("a scan")
    with pytest.raises(InputError, match="new file"):
        check_listed(path, account)
    account.write_text(json.dumps({"files": listing([path], pages=False)}))
    check_listed(path, account)
    path.write_text("another")
    with pytest.raises(InputError, match="new file"):
        check_listed(path, account)


def test_a_file_is_written_whole_or_not_at_all(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_text("before")

    def torn() -> None:
        with writing(path) as fresh:
            fresh.write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        torn()
    assert contents(tmp_path) == {"file": b"before"}


@pytest.mark.parametrize("left", [["store.sqlite", "store.sqlite-wal"], ["parts"], ["motion.png", "motion.json"]])
def test_what_was_begun_or_inspected_there_makes_no_foreign_folder(tmp_path: Path, left: list[str]) -> None:
    for name in left:
        (tmp_path / name).write_text("")
    check_folder(tmp_path)
    (tmp_path / "more").write_text("")
    with pytest.raises(InputError, match="more"):
        check_folder(tmp_path)
