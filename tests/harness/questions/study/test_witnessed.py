"""A seeded tenth of a study's scenes is held against unmodified engines, once, and the study says what came out."""

import sqlite3
from collections import Counter
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from harness import Run, Scene, StudyRecord, read_result, simulate
from harness.questions.scene import witness
from harness.questions.study import study_run
from harness.questions.study.study_run import drawn
from harness.runs.runner import InlinePool
from harness.runs.store import Store
from reports.cli import studies
from tests.doubles import codes
from tests.harness.questions.study.small_study import CONTACT, STUDY, written


def ran(folder: Path, text: str = CONTACT, **more: Any) -> StudyRecord:
    studies.run(written(folder, text), folder / "out", pool=InlinePool(), quiet=True, **more)
    record = read_result(folder / "out")
    assert isinstance(record, StudyRecord)
    return record


def stored(folder: Path) -> Counter[str]:
    with closing(sqlite3.connect(folder / "out" / "store.sqlite")) as store:
        return Counter(kind for (kind,) in store.execute("SELECT kind FROM result"))


def test_a_tenth_is_drawn_with_the_seed() -> None:
    numbers = list(range(40))
    assert len(drawn(numbers, 1)) == 4
    assert drawn(numbers, 1) == drawn(numbers[::-1], 1)
    assert drawn(numbers, 1) != drawn(numbers, 2)
    assert drawn([7], 1) == [7]
    assert drawn([], 1) == []


def test_a_study_holds_a_tenth_of_its_scenes_against_plain_engines_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen = ran(tmp_path, witness=True).witness
    assert (seen.scenes, seen.of) == (3, 24)
    count = seen.counts["pymunk:plain"]
    assert count.confirmed + count.differ + count.silent == 3
    assert count.confirmed > 0
    assert stored(tmp_path) == {"run": 24, "witness": 3}

    def nothing_is_computed(*values: Any, **named: Any) -> Run:
        raise AssertionError("a witness was computed again")

    monkeypatch.setattr(study_run, "simulate", nothing_is_computed)
    again = ran(tmp_path, witness=True, resume=True).witness
    assert again.counts == seen.counts


def test_a_study_without_a_witness_says_nothing_of_one(tmp_path: Path) -> None:
    assert ran(tmp_path).witness is None
    assert stored(tmp_path) == {"run": 24}


def test_a_study_of_the_model_alone_has_no_witness_and_says_so(tmp_path: Path) -> None:
    for asked in (True, False):
        record = ran(tmp_path, STUDY, witness=asked)
        assert record.witness is None
        assert ("no_witness" in codes(record.findings)) is asked


def test_why_runs_failed_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The exact body knows no pedestal: a count alone stood there. Its rows hold why: none is read twice."""
    monkeypatch.setattr(Store, "get", None)
    record = ran(tmp_path, STUDY.replace('engines = ["analytic"]', 'engines = ["analytic", "spatial"]'))
    (told,) = (each for each in record.findings if each.code == "runs_failed")
    failed = [row for row in record.rows if row.run and row.run.outcome.failed]
    assert (told.engine, told.values["count"]) == ("spatial", len(failed))
    assert "pedestal" in told.values["reason"]


def test_what_plain_engines_refuse_is_not_drawn(tmp_path: Path) -> None:
    """A prescribed ratio at impacts would have to be written to the bodies: of the 48 scenes half are left."""
    text = CONTACT.replace(
        "[[variant]]", '[[vary]]\nkey = "contact.restitution"\nvalues = [0.9, "momentum"]\n[[variant]]', 1
    )
    text = text.replace('"contact.restitution" = "momentum", ', "").replace("count = 8", "count = 2")
    seen = ran(tmp_path, text, witness=True).witness
    assert (seen.scenes, seen.of) == (1, 6)
    assert seen.counts["pymunk:plain"].silent == 0


def test_a_heavier_impact_in_the_study_s_engine_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The judged engine with the statue's inertia doubled: nothing is confirmed, and each scene is named."""

    def heavy(scene: Scene, name: str, **named: Any) -> Run:
        inertia, tensor = 2.0 * scene.statue.inertia_kg_m2, 2.0 * scene.statue.inertia_tensor_kg_m2
        statue = replace(scene.statue, inertia_kg_m2=inertia, inertia_tensor_kg_m2=tensor)
        return simulate(replace(scene, statue=statue), name, **named)

    monkeypatch.setattr(study_run, "simulate", heavy)
    monkeypatch.setattr(witness, "BUDGET", 60.0)
    text = CONTACT.replace("pymunk = 1e-2", "pymunk = 1e-3").replace("start = 0.2", "start = 0.5")
    seen = ran(tmp_path, text, witness=True).witness
    assert seen.counts["pymunk:plain"].differ > 0
    assert {each.code for each in seen.differing} == {"witness_parts"}
    assert all(each.values["models"] == ["pymunk"] and "case" in each.values for each in seen.differing)
