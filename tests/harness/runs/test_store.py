"""Nothing that was finished is lost, nothing is stored twice, and damage is told with what can be done."""

import errno
import sqlite3
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness import History, InputError, Mistake, Outcome, Run
from harness.questions.study.study_record import export_csv
from harness.records.base import STORE_NUMBER
from harness.runs.store import Store
from reports.cli.studies import unbegun
from tests.stores_for_tests import is_sound, put


def run(peak: float = 0.1, wall_s: float = 1.0) -> Run:
    t = np.linspace(0.0, 1.0, 5)
    zero = np.zeros(5)
    return Run(
        engine="analytic",
        outcome=Outcome.STANDS,
        history=History(t, peak * t, peak + zero, zero, zero, {"yaw_rad": t**2}),
        settings={"rtol": 1e-9},
        steps=10,
        wall_s=wall_s,
        peak_theta_rad=peak,
        peak_time_s=1.0,
        end_s=1.0,
        impact_times_s=(0.5,),
    )


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    with Store(tmp_path / "store.sqlite") as opened:
        yield opened


def test_a_result_reads_back_with_its_history(store: Store) -> None:
    put(store, [("a", run())], histories=True)
    record, history = store.get("a"), store.history("a")
    assert history is not None
    assert record["peak_theta_rad"] == 0.1
    assert store.seconds("a") == 1.0
    for name, values in run().history.columns().items():  # type: ignore[union-attr]
        assert np.array_equal(values, history.columns()[name])


def test_of_two_calls_that_begin_at_once_both_use_one_store(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    put(store, [("first", run())])
    # What the second saw before the first had made its store.
    monkeypatch.setattr("harness.runs.store.os.path.lexists", lambda path: False)
    with Store(store.path) as second:
        assert second.keys() == {"first"}


@pytest.mark.parametrize("used", [True, False])
def test_a_store_that_another_call_uses_is_not_taken_away(tmp_path: Path, used: bool) -> None:
    path, others = tmp_path / "store.sqlite", list[Store]()

    @unbegun(tmp_path)
    def refused() -> None:
        others.append(Store(path))
        assert others[0].keys() == set()
        if not used:
            others.pop().__exit__()
        raise InputError(Mistake("study", "", "another", "this"))

    with pytest.raises(InputError):
        refused()
    assert path.exists() == used
    for other in others:
        put(other, [("first", run())])


def test_a_key_keeps_its_first_result(store: Store) -> None:
    put(store, [("a", run(0.1))])
    put(store, [("a", run(0.2))])
    record = store.get("a")
    assert record["peak_theta_rad"] == 0.1


def test_rows_do_not_hold_what_differs_from_run_to_run(store: Store) -> None:
    put(store, [("a", run(wall_s=1.0)), ("b", replace(run(wall_s=2.0), cpu_s=1.5))])
    a, b = store.get("a"), store.get("b")
    assert a == b


def test_known_tells_what_is_there(store: Store) -> None:
    put(store, [("a", run())])
    assert store.keys() & {"a", "b"} == {"a"}
    assert store.get("b") is None
    assert store.history("a") is None


def test_a_failed_write_leaves_the_rest_whole(store: Store) -> None:
    bad = replace(run(), validity={"not": object()})
    with pytest.raises(TypeError):
        put(store, [("a", run()), ("b", bad), ("c", run())])
    assert store.keys() & {"a", "b", "c"} == {"a"}
    put(store, [("c", run())])
    assert is_sound(store)


def database(path: Path, schema: str, *pragmas: str) -> None:
    with closing(sqlite3.connect(path)) as db:
        for pragma in pragmas:
            db.execute(f"PRAGMA {pragma}")
        db.executescript(schema)


STORES: dict[str, Callable[[Path], object]] = {
    "text": lambda path: path.write_bytes(b"this is no database at all, but long enough to be read as one" * 20),
    "nothing": lambda path: path.touch(),
    "another's": lambda path: database(path, "CREATE TABLE notes (text TEXT)"),
    "another's with our tables": lambda path: database(path, "CREATE TABLE result (key TEXT)", "user_version=5"),
    "another's in WAL mode": lambda path: database(path, "CREATE TABLE notes (text TEXT)", "journal_mode=WAL"),
    "another's with a number": lambda path: database(path, "CREATE TABLE a (b)", f"application_id={STORE_NUMBER - 1}"),
    "a folder": lambda path: path.mkdir(),
    "a link to nothing": lambda path: path.symlink_to(path.with_name("elsewhere")),
    "a write-ahead log without a store": lambda path: path.with_name("store.sqlite-wal").write_text("mine"),
}


@pytest.mark.parametrize("kind", STORES)
def test_what_is_no_store_of_ours_is_refused_and_keeps_its_bytes(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "store.sqlite"
    STORES[kind](path)
    before = {each: each.read_bytes() for each in tmp_path.iterdir() if each.is_file()}
    inside = list(tmp_path.iterdir())
    with pytest.raises(InputError, match=r"store\.sqlite"):
        Store(path)
    assert {each: each.read_bytes() for each in tmp_path.iterdir() if each.is_file()} == before
    assert list(tmp_path.iterdir()) == inside


@pytest.mark.parametrize("end", ["wal", "shm", "journal"])
def test_another_s_file_beside_a_store_is_not_written_over(tmp_path: Path, end: str) -> None:
    path, beside = tmp_path / "store.sqlite", tmp_path / f"store.sqlite-{end}"
    with Store(path):
        pass
    beside.write_text("mine")
    with pytest.raises(InputError, match=f"{beside.name}: "):
        Store(path)
    assert beside.read_text() == "mine"


def test_a_store_of_another_version_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "store.sqlite"
    with Store(path):
        pass
    with sqlite3.connect(path) as db:
        db.execute("PRAGMA user_version=99")
    db.close()
    with pytest.raises(InputError, match="version 99"):
        Store(path)


def test_a_full_disk_is_told_and_what_was_finished_is_kept(store: Store) -> None:
    put(store, [("a", run())])
    pages = store._db.execute("PRAGMA page_count").fetchone()[0]
    store._db.execute(f"PRAGMA max_page_count={pages}")
    with pytest.raises(OSError, match="free some space") as caught:
        put(store, [(f"k{i}", run()) for i in range(200)], histories=True)
    assert (caught.value.errno, caught.value.filename) == (errno.ENOSPC, str(store.path)), "no mistake of the input's"
    assert store.get("a") is not None
    assert is_sound(store)


def test_a_run_whose_history_is_lost_counts_as_none(tmp_path: Path) -> None:
    """67 histories of 201 deleted: these runs are computed again, not passed over."""
    path = tmp_path / "store.sqlite"
    names = [f"key{i:03d}" for i in range(201)]
    with Store(path) as store:
        put(store, [(name, run()) for name in names], histories=True)
        put(store, [("outcome alone", run())])
        store._db.execute("DELETE FROM history WHERE rowid % 3 = 0")
        whole = {name for i, name in enumerate(names, 1) if i % 3} | {"outcome alone"}
        assert store.keys() == whole
        put(store, [(name, run()) for name in names], histories=True)
        assert store.keys() == {*names, "outcome alone"}
        assert all(store.history(name) is not None for name in names)


def test_no_change_of_a_history_goes_unseen(tmp_path: Path) -> None:
    """64 random bytes written into stored histories, 25 times: until now 6 of these changed a history that was read as sound."""
    stream = np.random.default_rng(5)
    with Store(tmp_path / "store.sqlite") as store:
        put(store, [("a", run())], histories=True)
        (whole,) = store._db.execute("SELECT data FROM history").fetchone()
        for _ in range(25):
            data = bytearray(whole)
            at = int(stream.integers(0, max(len(data) - 64, 1)))
            data[at : at + 64] = stream.bytes(len(data[at : at + 64]))
            store._db.execute("UPDATE history SET data = ?", (bytes(data),))
            with pytest.raises(InputError, match=r"\.sqlite: "):
                store.history("a")


@pytest.mark.parametrize("text", ["[]", "3", "null", '{"engine": "analytic"}', "{", '"text"'])
def test_a_record_of_another_shape_is_told(store: Store, text: str) -> None:
    put(store, [("a", run())])
    store.write_plan("s", [(0, "analytic", "a", "asked", {})])
    store._db.execute("UPDATE result SET record = ?", (text,))
    with pytest.raises(InputError, match=r"\.sqlite: "):
        store.get("a")
    with pytest.raises(InputError, match=r"\.sqlite: "):
        list(store.rows("s"))


def test_rows_of_a_study_are_exported(store: Store, tmp_path: Path) -> None:
    put(store, [("a", run())])
    store.write_plan("s", [(0, "analytic", "a", "asked", {"f": 2.0}), (1, "analytic", None, "not sent", {"f": 3.0})])
    export_csv(store, "s", tmp_path / "rows.csv")
    lines = (tmp_path / "rows.csv").read_text().splitlines()
    assert len(lines) == 1 + 2
    assert lines[0].startswith("number,engine,reason,f,")
    assert lines[2].startswith("1,analytic,not sent,3.0")


FULL = """
import resource, sys
from pathlib import Path
from harness.runs.store import Store
from tests.harness.runs.test_store import run
from tests.stores_for_tests import put
resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))
with Store(Path(sys.argv[1])) as store:
    for i in range(1000):
        try:
            put(store, [(f"k{i}", run())])
        except OSError as error:
            sys.exit(f"{i} {error}")
"""


def test_a_file_that_may_not_grow_keeps_what_was_finished(tmp_path: Path) -> None:
    path = tmp_path / "store.sqlite"
    done = subprocess.run([sys.executable, "-c", FULL, path], check=False, capture_output=True, text=True)
    count, _, said = done.stderr.partition(" ")
    assert "free some space" in said
    assert int(count) > 0
    with Store(path) as store:
        assert store.keys() == {f"k{i}" for i in range(int(count))}
        assert is_sound(store)
        put(store, [("more", run())])
