"""The main job runs scenes beside the study from one queue, and takes what they share with the study from its store."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from harness import Outcome, RunRequest, Scene, engines, load_scene, run_scene, simulate
from harness.questions import trust
from harness.records.base import plain
from harness.records.study import StudyRow
from harness.runs.runner import InlinePool
from harness.runs.store import Store, stored_runs
from reports import build_examples
from tests import doubles
from tests.budgets_reports import PAGE_WORDS
from tests.harness.questions.study.small_study import BLOCK
from tests.reports.pages.test_run_page import words_beside_tables
from tests.stores_for_tests import put


@pytest.fixture
def scene(tmp_path: Path) -> Scene:
    path = tmp_path / "block.toml"
    path.write_text(BLOCK.replace("duration_s = 2.0", "duration_s = 0.5"))
    return load_scene(path)


def test_what_a_study_has_stored_is_not_run_again(
    scene: Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    engine = engines.load("pymunk")
    key = RunRequest(lambda: scene, "pymunk", history=True).task(scene).key
    run = simulate(scene, "pymunk")
    with Store(tmp_path / "s.sqlite") as store:
        put(store, [(key, run)], histories=True)
        stored = stored_runs(store, scene)
    assert set(stored) == {"pymunk"}
    monkeypatch.setattr(type(engine), "simulate", lambda *given: pytest.fail("it was run again"))
    found = run_scene(scene, ["analytic", "pymunk"], stored=stored)
    # What it took of the processor is not kept: nothing was integrated.
    assert plain(found.runs["pymunk"]) == plain(replace(run, cpu_s=None))
    first, second = found.runs["pymunk"].history, run.history
    assert all((values == second.columns()[name]).all() for name, values in first.columns().items())
    assert "analytic_vs_pymunk" in found.scores


@pytest.mark.parametrize(
    ("outcome", "failed"), [(Outcome.STANDS, False), (Outcome.UNAVAILABLE, False), (Outcome.CRASHED, True)]
)
def test_an_engine_that_is_not_installed_is_said_and_fails_nothing(
    outcome: Outcome, failed: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    row = StudyRow(
        number=0, engine="pybullet", reason="", varied={}, run=doubles.case_run(engine="pybullet", outcome=outcome)
    )
    assert build_examples._failed([row]) is failed
    assert ("left out: pybullet" in capsys.readouterr().err) is (outcome is Outcome.UNAVAILABLE)


def test_an_example_without_an_engine_that_is_not_installed_is_done(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(build_examples, "OUT", tmp_path)
    monkeypatch.setattr(type(engines.load("pybullet")), "missing", lambda engine: "not installed here")
    answer = build_examples.example(("free_rocking", {}))
    assert "not installed here" in answer.record["text"]
    assert not answer.failed


def test_a_shipped_page_of_a_statue_that_may_fall_is_never_green(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Engineer's and conservator's: the statue stands in every run as given, and falls in two of five draws."""
    monkeypatch.setattr(build_examples, "OUT", tmp_path)
    monkeypatch.setattr(engines, "default_engines", lambda scene: ("analytic",))
    build_examples.example(("paestum_pedestal", {}))
    for page in ("report", "conservator"):
        (tone,) = re.findall(
            r'class="verdict (\w+)(?: first)?"', (tmp_path / "paestum_pedestal" / f"{page}.html").read_text()
        )
        assert tone != "agree"
    shipped = (tmp_path / "paestum_pedestal" / "report.html").read_text()
    assert len(words_beside_tables(shipped)) <= PAGE_WORDS


def test_the_main_job_s_map_is_the_coarse_one_of_the_statue_on_the_floor(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(build_examples, "OUT", tmp_path)
    monkeypatch.setattr(trust, "RESOLUTION", {True: 4.5})
    monkeypatch.setattr(trust, "FREQUENCIES", {True: 1})
    record = build_examples.trust_map(InlinePool())
    assert (record.coarse, record.engines, record.scene.file) == (True, ("analytic", "pymunk"), "paestum_pedestal.toml")
    assert [(each.stands_on, len(each.cells)) for each in record.maps] == [("pedestal", 3), ("floor", 3)]
    assert (tmp_path / "paestum_pedestal-trust" / "result.json").is_file()
