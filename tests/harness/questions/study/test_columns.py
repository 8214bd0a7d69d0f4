"""A study in columns holds, row for row, what a store of single runs holds; what was finished outlives a kill."""

import signal
import sqlite3
import subprocess
import sys
import time
from contextlib import closing
from pathlib import Path

import pytest

from analytic.block import AnalyticInputError
from harness import InputError, StudyRecord
from harness.questions.study import study_run
from harness.questions.study.cases import CaseScenes, load_study
from harness.questions.study.study_record import coarser, every_row, table
from harness.questions.study.study_run import run_study, study_name
from harness.runs.runner import InlinePool
from harness.runs.store import STORE_NAME, PlannedRow, Store
from reports.cli import studies
from tests.harness.questions.study.small_study import BLOCK, STUDY, written

VARIED = """
title = "a study of all that varies"
scene = "block.toml"
samples = 2
[[vary]]
key = "motion.x.amplitude_g"
start = 0.0
stop = 0.6
count = 3
[[vary]]
key = "motion.scale"
values = ["keep", 2.0, "none"]
[[vary]]
key = "pedestal"
values = ["keep", "none"]
[[vary]]
key = "motion.x.frequency_hz"
values = [1, 2.5]
also = { "motion.z.amplitude_g" = 0.1 }
[[scatter]]
key = "contact.floor_static"
distribution = "uniform"
low = 0.16
high = 0.4
[[scatter]]
key = "gravity_m_s2"
distribution = "uniform"
low = 9.7
high = 9.9
[[variant]]
name = "own"
engines = ["analytic"]
[[variant]]
name = "paper"
engines = ["analytic"]
set = { "contact.restitution" = 0.9, "model.preset" = "paper", "wall.side" = "left", "wall.distance_m" = 0.5 }
"""
SHAKEN = """
[motion]
scale = 1.5
[motion.z]
kind = "pulse"
shape = "one_sine"
amplitude_g = 0.1
duration_s = 0.7
[uncertainty]
"motion.scale" = { kind = "lognormal", cov = 0.1 }
"statue.mass_kg" = { kind = "lognormal", cov = 0.1 }
"""
RECORD = '[motion.x]\nkind = "record"\nfile = "shaking.csv"\nunit = "g"\n'


@pytest.fixture(autouse=True)
def small_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study_run, "LEAST_RUNS", 1)
    monkeypatch.setattr(study_run, "BLOCK", 25)


def columns(path: Path, store: Store) -> list[PlannedRow]:
    study = load_study(path)
    summary = run_study(study, path, store, InlinePool())
    assert (summary.cases, summary.computed + summary.found) == (study.runs, study.runs)
    return list(every_row(store, study_name(study)))


def both(path: Path, folder: Path) -> tuple[list[PlannedRow], list[PlannedRow]]:
    study = load_study(path)
    with Store(folder / "columns.sqlite") as store:
        rows = columns(path, store)
    with Store(folder / "rows.sqlite") as store, pytest.MonkeyPatch.context() as patch:
        patch.setattr(study_run, "LEAST_RUNS", study.runs + 1)
        run_study(study, path, store, InlinePool())
        return list(store.rows(study_name(study))), rows


def parts(row: PlannedRow) -> tuple[object, ...]:
    return row.number, row.engine, row.reason, row.varied, row.run


@pytest.mark.parametrize("kind", ["grid", "varied", "record"])
def test_rows_are_those_of_single_runs(tmp_path: Path, kind: str) -> None:
    path = written(tmp_path, STUDY if kind == "grid" else VARIED)
    if kind == "varied":
        (tmp_path / "block.toml").write_text(BLOCK + SHAKEN)
    if kind == "record":
        shaking = "\n".join(f"{0.02 * k:.2f},{0.4 * (-1) ** (k // 9) * (k % 9) / 9:.4f}" for k in range(90))
        (tmp_path / "shaking.csv").write_text(f"t_s,a\n{shaking}\n")
        (tmp_path / "block.toml").write_text(BLOCK.partition("[motion.x]")[0] + "[motion]\nscale = 1.0\n" + RECORD)
        text = STUDY.replace("motion.x.amplitude_g", "motion.scale").replace(
            "motion.x.frequency_hz", "pedestal.mass_kg"
        )
        path.write_text(text.replace("start = 1.0\nstop = 4.0", "start = 100.0\nstop = 400.0"))
    single, rows = both(path, tmp_path)
    assert len(rows) == len(single) > 50
    for row, other in zip(rows, single, strict=True):
        assert parts(row) == parts(other)


def test_a_case_that_the_model_refuses_fails_as_a_single_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(self: CaseScenes, setting: object) -> object:
        raise AnalyticInputError("this body cannot rock")

    monkeypatch.setattr(CaseScenes, "still", refused)
    single, rows = both(written(tmp_path), tmp_path)
    assert [parts(row) for row in rows] == [parts(row) for row in single]


def test_a_case_that_is_no_scene_is_refused_in_the_same_words(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = written(tmp_path, STUDY.replace("stop = 4.0", "stop = 4e9"))
    said = []
    for least in (1, 1000):
        monkeypatch.setattr(study_run, "LEAST_RUNS", least)
        with pytest.raises(InputError) as error, Store(tmp_path / f"{least}.sqlite") as store:
            run_study(load_study(path), path, store, InlinePool())
        said.append(str(error.value))
    assert said[0] == said[1]
    assert "frequency_hz" in said[0]


def test_an_export_is_the_same_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = written(tmp_path)
    for name, least in (("columns", 1), ("rows", 1000)):
        monkeypatch.setattr(study_run, "LEAST_RUNS", least)
        for end in ("csv", "parquet"):
            record = studies.run(
                path, tmp_path / name, pool=InlinePool(), quiet=True, export=tmp_path / f"{name}.{end}"
            )
            assert isinstance(record, StudyRecord)
            assert (record.table is not None) == (name == "columns")
    assert (tmp_path / "columns.csv").read_bytes() == (tmp_path / "rows.csv").read_bytes()
    parquet = pytest.importorskip("pyarrow.parquet", reason="needs the extra [parquet]")
    assert parquet.read_table(tmp_path / "columns.parquet").equals(parquet.read_table(tmp_path / "rows.parquet"))


def test_a_record_holds_a_coarser_grid_and_counts_all(tmp_path: Path) -> None:
    path = written(tmp_path)
    study, name = load_study(path), study_name(load_study(path))
    with Store(tmp_path / "c.sqlite") as store:
        every = {row.number: parts(row) for row in columns(path, store)}
        shown = list(every_row(store, name, coarser(study, most=12)))
        counted = table(store, name, len(shown))
    assert 3 <= len(shown) <= 12
    assert all(parts(row) == every[row.number] for row in shown)
    assert (counted.rows, sum(counted.outcomes.values()), counted.shown) == (60, 60, len(shown))
    record = studies.run(path, tmp_path / "out", pool=InlinePool(), quiet=True)
    assert isinstance(record, StudyRecord)
    assert record.table.outcomes == counted.outcomes


SCRIPT = """
import sys
from pathlib import Path
from reports.cli import studies
from harness.runs.runner import InlinePool
from harness.questions.study import study_run
study_run.LEAST_RUNS, study_run.BLOCK = 1, 3
studies.run(Path(sys.argv[1]), Path(sys.argv[2]), pool=InlinePool(), quiet=True)
"""


def finished(path: Path) -> dict[str, bytes]:
    """The blocks of a store by their keys."""
    try:
        with closing(sqlite3.connect(f"file:{path}?mode=ro", uri=True)) as db:
            return dict(db.execute("SELECT key, data FROM history"))
    except sqlite3.Error:
        return {}


def test_what_was_finished_outlives_a_kill(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path, out = written(tmp_path), tmp_path / "out"
    process = subprocess.Popen([sys.executable, "-c", SCRIPT, str(path), str(out)])
    until_s = time.monotonic() + 60.0
    while len(finished(out / STORE_NAME)) < 2 and time.monotonic() < until_s:
        time.sleep(0.005)
    process.send_signal(signal.SIGKILL)
    process.wait()
    before = finished(out / STORE_NAME)
    assert len(before) >= 2
    monkeypatch.setattr(study_run, "BLOCK", 3)
    record = studies.run(path, out, pool=InlinePool(), quiet=True, resume=True)
    assert isinstance(record, StudyRecord)
    assert record.summary.found >= 3 * len(before), "what was whole is kept"
    assert before.items() <= finished(out / STORE_NAME).items()
    with Store(out / STORE_NAME) as store, Store(tmp_path / "whole.sqlite") as whole:
        rows = list(every_row(store, study_name(load_study(path))))
        assert [parts(row) for row in rows] == [parts(row) for row in columns(path, whole)]


def test_what_was_changed_is_refused(tmp_path: Path) -> None:
    path = written(tmp_path)
    with Store(tmp_path / "c.sqlite") as store:
        columns(path, store)
        key, data = store._db.execute("SELECT key, data FROM history").fetchone()
        changed = bytes([*data[:-9], data[-9] ^ 0xFF, *data[-8:]])
        store._db.execute("UPDATE history SET data=? WHERE key=?", (changed, key))
        with pytest.raises(InputError, match=r"c\.sqlite: "):
            list(every_row(store, study_name(load_study(path))))


def test_what_a_witness_judges_stays_rows(tmp_path: Path) -> None:
    path = written(tmp_path)
    study, name = load_study(path), study_name(load_study(path))
    with Store(tmp_path / "s.sqlite") as store:
        run_study(study, path, store, InlinePool(), singly=True)
        assert table(store, name, 0) is None
        assert all(row.key is not None for row in every_row(store, name))


def test_few_cases_or_other_questions_stay_rows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = written(tmp_path)
    base = study_run.BaseScene(path, {})
    assert study_run.in_columns(load_study(path), base)
    for old, new in (
        ('engines = ["analytic"]', 'engines = ["analytic", "pymunk"]'),
        ("[[variant]]", "[ask]\nhistories = true\n[[variant]]"),
        ("[[variant]]", 'claims = "pedestal"\n[[variant]]'),
        ("values = [0.85, 0.9]", 'values = ["momentum", 0.9]'),
    ):
        text = new.replace("[[variant]]", "") + STUDY if new.startswith("claims") else STUDY.replace(old, new)
        path.write_text(text)
        assert not study_run.in_columns(load_study(path), base), new
    path.write_text(STUDY)
    monkeypatch.setattr(study_run, "LEAST_RUNS", 61)
    assert not study_run.in_columns(load_study(path), base)
