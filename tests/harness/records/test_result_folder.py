"""Nothing that rockcheck did not write is replaced or removed: foreign folders, files put into its own, and what a run reads."""

import errno
import json
import os
from pathlib import Path

import pytest

from harness import InputError, Scene, load_scene
from harness.model import is_own, is_sealed, write_json, write_text, writing
from harness.questions.scene.scene_run import Result, check_writing, run_scene, write_result
from harness.records.base import (
    COMING,
    PAGES,
    RECORD,
    STORE,
    STORE_KINDS,
    as_file,
    check_folder,
    check_inputs,
    listed,
    listing,
    named_after,
    owned,
    store_kind,
)
from harness.runs.store import Store
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


@pytest.mark.parametrize("kind", [["run"], {"run": 1}, 1, None, "novel"])
def test_a_record_of_another_kind_is_somebody_elses(tmp_path: Path, result: Result, kind: object) -> None:
    text = json.dumps({"kind": kind, "schema_version": 1, "files": {"thesis.docx": None}})
    (tmp_path / "result.json").write_text(text)
    with pytest.raises(InputError, match="--out"):
        write_result(result, tmp_path)
    assert contents(tmp_path) == {"result.json": text.encode()}


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
    assert is_sealed(tmp_path / "result.json")


def sealed_record(folder: Path, **changes: object) -> None:
    """A record that says something else than what was written, and proves to be ours all the same."""
    record = json.loads((folder / RECORD).read_text())
    record.pop("seal")
    write_json(folder / RECORD, record | changes)


def test_a_record_names_files_of_its_own_folder_only(tmp_path: Path, result: Result) -> None:
    folder = tmp_path / "out"
    precious = tmp_path / "precious"
    precious.write_text("mine")
    write_result(result, folder)
    mine = listing([folder / "history_analytic.csv"])
    (mine_sum,) = listing([precious]).values()
    sealed_record(folder, files=mine | dict.fromkeys(("../precious", str(precious), "..", ".", RECORD), mine_sum))
    assert set(owned(folder)) == {"history_analytic.csv", RECORD}
    write_result(result, folder)
    assert precious.read_text() == "mine"


FILES: list[object] = [{"thesis.docx": None}, None, [], "thesis.docx", {"thesis.docx": 1}, {"thesis.docx": ["x"]}, 0]


@pytest.mark.parametrize("name", [RECORD, COMING])
@pytest.mark.parametrize("files", [*FILES, "its checksum"])
def test_a_record_of_another_s_making_owns_nothing(tmp_path: Path, result: Result, name: str, files: object) -> None:
    (tmp_path / "thesis.docx").write_text("mine")
    (tmp_path / "history_measured.csv").write_text("mine")
    listed_there = listing([tmp_path / "thesis.docx"]) if files == "its checksum" else files
    record = {"kind": "run", "schema_version": 1, "histories": ["measured"], "files": listed_there}
    (tmp_path / name).write_text(json.dumps(record))
    before = contents(tmp_path)
    with pytest.raises(InputError, match="--out"):
        write_result(result, tmp_path)
    assert contents(tmp_path) == before


@pytest.mark.parametrize("files", FILES)
def test_a_file_of_which_no_checksum_is_listed_is_nobody_s(tmp_path: Path, result: Result, files: object) -> None:
    write_result(result, tmp_path)
    sealed_record(tmp_path, files=files)
    (tmp_path / "thesis.docx").write_text("mine")
    with pytest.raises(InputError, match=r"history_analytic\.csv"):
        write_result(result, tmp_path)
    assert (tmp_path / "thesis.docx").read_text() == "mine"


@pytest.mark.parametrize("name", [RECORD, *PAGES])
def test_a_record_or_a_page_that_was_edited_is_not_lost(tmp_path: Path, result: Result, name: str) -> None:
    write_result(result, tmp_path)
    for page in PAGES:
        write_text(tmp_path / page, "<p>a page</p>\n")
    path = tmp_path / name
    path.write_bytes(path.read_bytes().replace(b"a", b"e", 1))
    before = contents(tmp_path)
    with pytest.raises(InputError, match=name.replace(".", r"\.")):
        write_result(result, tmp_path)
    assert contents(tmp_path) == before


def test_no_page_stays_beside_a_record_of_which_it_does_not_speak(tmp_path: Path, result: Result) -> None:
    write_result(result, tmp_path)
    for page in PAGES:
        write_text(tmp_path / page, "<p>a page</p>\n")
    write_result(result, tmp_path)
    assert set(contents(tmp_path)) == {RECORD, "history_analytic.csv"}


@pytest.mark.parametrize("end", ["link", "dangling link", "folder"])
def test_what_is_no_file_of_ours_is_not_replaced(tmp_path: Path, result: Result, end: str) -> None:
    folder, elsewhere = tmp_path / "out", tmp_path / "elsewhere"
    write_result(result, folder)
    page = folder / PAGES[0]
    if end == "folder":
        page.mkdir()
    else:
        page.symlink_to(elsewhere)
    if end == "link":
        write_text(tmp_path / "elsewhere.html", "<p>a page</p>\n")
        (tmp_path / "elsewhere.html").rename(elsewhere)
    with pytest.raises(InputError, match=r"report\.html"):
        write_result(result, folder)
    with pytest.raises(InputError, match=r"report\.html"):
        write_text(page, "")
    assert elsewhere.exists() is (end == "link")


def test_a_folder_behind_a_link_to_nothing_is_not_made(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(tmp_path / "nothing")
    for folder in (tmp_path / "link", tmp_path / "link" / "below"):
        with pytest.raises(InputError, match=r"^--out: .*/link"):
            check_folder(folder)


def test_a_write_that_was_killed_can_be_done_again(tmp_path: Path, result: Result) -> None:
    write_result(result, tmp_path)
    (tmp_path / "history_analytic.csv").write_text("the next history")
    files = listing([tmp_path / "history_analytic.csv"])
    write_json(tmp_path / COMING, as_file(result.record()) | {"files": files})
    write_result(result, tmp_path)
    assert not (tmp_path / COMING).exists()


def test_a_result_of_another_kind_is_not_replaced(tmp_path: Path, result: Result) -> None:
    write_result(result, tmp_path)
    with pytest.raises(InputError, match=r"^--out: .*: study, got .*: run "):
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
    with pytest.raises(InputError, match=r"^--out: .*statue\.glb"):
        check_writing(tmp_path / "out", scene, ["analytic"])
    # Nor where the scan is what an earlier run has written there.
    record = {"schema_version": 1, "kind": "run", "files": listing([tmp_path / "out" / "statue.glb"])}
    (tmp_path / "out" / "result.json").write_text(json.dumps(record))
    with pytest.raises(InputError, match=r"^--out: .*statue\.glb"):
        check_writing(tmp_path / "out", scene, ["analytic"])
    assert contents(tmp_path / "out")["statue.glb"] == before["statue.glb"]


@pytest.mark.parametrize("name", ["...toml", "..toml", ".."])
def test_a_name_of_dots_names_no_folder(name: str) -> None:
    with pytest.raises(InputError, match="give --out"):
        named_after(Path(name))


@pytest.mark.parametrize("kind", [".html", ".svg", ".pdf", ".json", ".gif", ".png"])
def test_a_sealed_file_is_ours_until_one_byte_is_another(tmp_path: Path, kind: str) -> None:
    path = tmp_path / f"file{kind}"
    ends = {".json": '{\n "a": 1\n}\n', ".gif": "GIF;", ".png": "PNG\0\0\0\0IEND\xaeB`\x82"}
    with writing(path) as fresh:
        fresh.write_bytes(ends.get(kind, "text").encode("latin-1"))
    whole = path.read_bytes()
    assert is_sealed(path)
    for place in range(len(whole)):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 1]) + whole[place + 1 :])
        assert not is_own(path), place
    for other in (b"", whole[:-1], whole + b"\n", whole[1:], b" " + whole, whole * 2):
        path.write_bytes(other)
        assert not is_own(path)
    assert is_own(path, listing([path]).values())  # type: ignore[arg-type]


def test_the_mode_of_a_file_is_that_of_the_user(tmp_path: Path) -> None:
    before = os.umask(0o077)
    try:
        write_text(tmp_path / "private", "")
        os.umask(0o002)
        write_text(tmp_path / "shared", "")
    finally:
        os.umask(before)
    assert [(tmp_path / name).stat().st_mode & 0o777 for name in ("private", "shared")] == [0o600, 0o664]


def test_a_file_for_which_there_is_no_room_stays_as_it_was(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    write_json(path, {"a": 1})
    before = contents(tmp_path)

    def full() -> None:
        with writing(path):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with pytest.raises(OSError, match=r"a\.json") as caught:
        full()
    assert (caught.value.errno, caught.value.filename) == (errno.ENOSPC, str(path))
    assert contents(tmp_path) == before


def test_a_file_is_written_whole_or_not_at_all(tmp_path: Path) -> None:
    path = tmp_path / "file.html"
    write_text(path, "before")
    before = contents(tmp_path)

    def torn() -> None:
        with writing(path) as fresh:
            fresh.write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        torn()
    assert contents(tmp_path) == before


def test_what_was_inspected_there_makes_no_foreign_folder(tmp_path: Path) -> None:
    for name in ("motion.png", "motion.json"):
        (tmp_path / name).write_text("")
    check_folder(tmp_path)
    (tmp_path / "more").write_text("")
    with pytest.raises(InputError, match="more"):
        check_folder(tmp_path)


@pytest.mark.parametrize("kind", STORE_KINDS)
def test_what_was_begun_is_for_its_own_command_only(tmp_path: Path, kind: str) -> None:
    with Store(tmp_path / STORE, kind):
        pass
    assert store_kind(tmp_path / STORE) == kind
    check_folder(tmp_path, (kind,))
    before = contents(tmp_path)
    for other in {"run", "compare", *STORE_KINDS} - {kind}:
        with pytest.raises(InputError, match=f"^--out: .*: {other}, got .*: {kind} "):
            check_folder(tmp_path, (other,))
    for other in set(STORE_KINDS) - {kind}:
        with pytest.raises(InputError, match="use another folder"):
            Store(tmp_path / STORE, other)
    assert contents(tmp_path) == before


def test_an_input_that_an_earlier_result_listed_is_not_removed(tmp_path: Path, result: Result) -> None:
    write_result(result, tmp_path)
    with pytest.raises(InputError, match=r"^--out: .*history_analytic\.csv"):
        check_inputs(tmp_path, ["history_pymunk.csv"], [tmp_path / ".." / tmp_path.name / "history_analytic.csv"])
    assert listed(tmp_path / RECORD).keys() == {"history_analytic.csv"}


def test_links_that_go_round_name_no_file_that_could_be_lost(tmp_path: Path) -> None:
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    check_inputs(tmp_path, ["loop.csv"], [tmp_path / "loop"])


def test_an_input_given_from_home_or_by_a_link_is_an_input(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = scan_scene(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path))
    (tmp_path / "link.glb").symlink_to(tmp_path / "out" / "statue.glb")
    for name in ("~/out/statue.glb", "link.glb", "./out/../out/statue.glb"):
        (tmp_path / "scene.toml").write_text(SCENE.replace("out/statue.glb", name))
        with pytest.raises(InputError, match=r"^--out: .*(statue|link)\.glb"):
            check_writing(tmp_path / "out", load_scene(tmp_path / "scene.toml"), ["analytic"])
    assert scene.source is not None
