"""The main job runs scenes beside the study from one queue, and takes what they share with the study from its store."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

from harness import engines, load_scene
from harness.accuracy.simulation import DEFAULT_ACCURACY_RAD, simulate
from harness.campaign.executors import Done, Work
from harness.model.scene import Scene
from harness.records.base import plain
from harness.records.run import EngineRunRecord
from harness.scene_run.scene_run import run_scene
from harness.studies.jobs import stored_runs
from harness.studies.store import Store
from reports.build_examples import Beside
from tests.harness.studies.small_study import BLOCK


class Inline:
    """A pool of one that runs here."""

    workers = 1

    def run(self, work: Work, tasks: Iterable[Any], done: Done) -> None:
        for task in tasks:
            done(task, work(task))

    def close(self) -> None:
        """Nothing to give back."""


def test_tasks_beside_a_study_run_once_before_it_and_at_its_end() -> None:
    said: list[str] = []
    beside = Beside(
        Inline(),
        [(str.upper, "before")],
        lambda: iter([(str.upper, "after")]),
        lambda task, result: said.append(f"beside {result}"),
    )
    for tasks in (["a", "b"], ["c"]):
        beside.run(str.title, tasks, lambda task, result: said.append(f"study {result}"))
    assert said == ["beside BEFORE", "study A", "study B", "beside AFTER", "study C"]


@pytest.fixture
def scene(tmp_path: Path) -> Scene:
    path = tmp_path / "block.toml"
    path.write_text(BLOCK.replace("duration_s = 2.0", "duration_s = 0.5"))
    return load_scene(path)


def test_what_a_study_has_stored_is_not_run_again(
    scene: Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from harness.studies.cache_key import scene_digest
    from harness.studies.jobs import run_key

    engine = engines.load("pymunk")
    key = run_key(engine, scene_digest(scene, engine.capabilities), DEFAULT_ACCURACY_RAD, True)
    run = simulate(scene, "pymunk")
    with Store(tmp_path / "s.sqlite") as store:
        store.put([(key, run)], histories=True)
        stored = stored_runs(store, scene)
    assert set(stored) == {"pymunk"}
    monkeypatch.setattr(type(engine), "simulate", lambda *given: pytest.fail("it was run again"))
    found = run_scene(scene, ["analytic", "pymunk"], stored=stored)
    assert plain(EngineRunRecord.of(found.runs["pymunk"])) == plain(EngineRunRecord.of(run))
    first, second = found.runs["pymunk"].history, run.history
    assert first is not None
    assert second is not None
    assert all((values == second.columns()[name]).all() for name, values in first.columns().items())
    assert "analytic_vs_pymunk" in found.scores
