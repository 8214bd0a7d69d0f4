"""A list of runs becomes one table, and what a store holds is not computed again."""

import sqlite3
from pathlib import Path

import numpy as np
import pytest

import harness
from harness.runs import execute as executed
from harness.runs.runner import Crash, InlinePool

STRENGTHS_G = (0.3, 0.6)


@pytest.fixture(scope="module")
def scene(root: Path) -> harness.Scene:
    return harness.load_scene(root / "scenes/paestum_floor.toml", {"duration_s": 1.0})


def wanted(scene: harness.Scene, *, history: bool = False) -> list[harness.RunRequest]:
    """Both models in the plane at two strengths."""
    return [
        harness.RunRequest(scene.replace(motion__x__amplitude_g=a_g), name, 1e-2, history=history, varied={"a_g": a_g})
        for a_g in STRENGTHS_G
        for name in ("analytic", "pymunk")
    ]


def test_rows_stand_in_the_order_of_the_requests_and_are_single_runs(scene: harness.Scene) -> None:
    runs = harness.execute((each for each in wanted(scene, history=True)), title="two strengths")
    assert (runs.title, runs.varied, runs.engines) == ("two strengths", ["a_g"], ["analytic", "pymunk"])
    assert runs.table["a_g"].tolist() == [0.3, 0.3, 0.6, 0.6]
    for k, request in enumerate(wanted(scene, history=True)):
        alone = harness.simulate(request.made(), request.engine, accuracy_rad=1e-2)
        assert runs.table["peak_theta_rad"][k] == abs(alone.peak_theta_rad)
        assert (runs.table["steps"][k], runs.table["impacts"][k]) == (alone.steps, alone.impacts)
        np.testing.assert_array_equal(runs.history(k).theta_rad, alone.history.theta_rad)


def test_histories_follow_their_rows(scene: harness.Scene) -> None:
    runs = harness.execute(wanted(scene, history=True))
    own = runs.where({"engine": "pymunk", "a_g": 0.6})
    np.testing.assert_array_equal(own.history(0).theta_rad, runs.history(3).theta_rad)
    mine, model = runs.pairs()["pymunk"]
    np.testing.assert_array_equal(mine.history(1).theta_rad, runs.history(3).theta_rad)
    np.testing.assert_array_equal(model.history(1).theta_rad, runs.history(2).theta_rad)
    with pytest.raises(harness.InputError, match="history of run 0"):
        harness.execute(wanted(scene)[:1]).history(0)


def test_what_a_store_holds_is_not_computed_again(
    scene: harness.Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = tmp_path / "runs.sqlite"
    first = harness.execute(wanted(scene)[:2], store)

    class Counting(InlinePool):
        asked = 0

        def run(self, work, tasks, done):  # type: ignore[no-untyped-def]
            super().run(work, (self._counted(item) for item in tasks), done)

        def _counted(self, item):  # type: ignore[no-untyped-def]
            Counting.asked += len(item)
            return item

    monkeypatch.setattr(executed, "InlinePool", Counting)
    told: list[tuple[int, int]] = []
    again = harness.execute(wanted(scene), store, on_progress=lambda *counts: told.append(counts))
    assert Counting.asked == 2
    assert told[0] == (0, 2)
    assert told[-1] == (2, 2)
    found: list[tuple[int, int]] = []
    harness.execute(wanted(scene), store, on_progress=lambda *counts: found.append(counts))
    assert found == [(0, 0)]
    assert again.table["peak_theta_rad"][:2].tolist() == first.table["peak_theta_rad"].tolist()
    # A study and a list of runs name a run alike: either finds what the other computed.
    with sqlite3.connect(store) as file:
        assert file.execute("SELECT COUNT(*) FROM result").fetchone() == (4,)


def test_a_run_that_takes_its_process_with_it_is_a_row(scene: harness.Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    class Dying(InlinePool):
        def run(self, work, tasks, done):  # type: ignore[no-untyped-def]
            for item in tasks:
                done(item, Crash("died") if item[0].argument.engine == "pymunk" else work(item))

    monkeypatch.setattr(executed, "InlinePool", Dying)
    runs = harness.execute(wanted(scene, history=True))
    assert runs.table["outcome"].tolist()[1::2] == ["crashed", "crashed"]
    assert np.isnan(runs.table["peak_theta_rad"][1])
    assert runs.history(0) is not None
    with pytest.raises(harness.InputError):
        runs.history(1)


def test_a_sweep_by_several_processes_is_the_sweep_by_one(scene: harness.Scene, tmp_path: Path) -> None:
    values = {"motion.x.amplitude_g": STRENGTHS_G}
    alone = harness.sweep(scene, values, "pymunk", accuracy_rad=1e-2)
    both = harness.sweep(scene, values, "pymunk", accuracy_rad=1e-2, jobs=2, store=tmp_path / "s.sqlite", history=True)
    for name, column in alone.table.items():
        np.testing.assert_array_equal(both.table[name], column)
    assert both.history(1).theta_rad.size > 1
    swept = harness.sweep(scene, values)
    single = harness.sweep(scene, values, history=True)
    assert list(swept.table) == list(single.table)
    assert single.table["outcome"].tolist() == swept.table["outcome"].tolist()


@pytest.mark.parametrize("requests", [[], ["analytic"], None, 3])
def test_wrong_requests_are_refused(requests: list[harness.RunRequest]) -> None:
    with pytest.raises(harness.InputError, match="RunRequest"):
        harness.execute(requests)


def test_wrong_arguments_are_refused_by_name(scene: harness.Scene) -> None:
    with pytest.raises(harness.InputError, match="jobs"):
        harness.execute(wanted(scene), jobs=0)
    with pytest.raises(harness.InputError, match="scene"):
        harness.RunRequest("scenes/paestum_floor.toml", "analytic")  # type: ignore[arg-type]
    with pytest.raises(harness.InputError, match=r"^--accuracy and --dt: "):
        harness.execute([harness.RunRequest(scene, "pymunk", 1e-3, 1e-3)])
    assert harness.RunRequest(scene, "pymunk", dt_s=1e-3).accuracy_rad is None
    assert harness.RunRequest(scene, "pymunk").accuracy_rad == 1e-3


def test_a_file_that_is_no_store_is_refused_and_left(scene: harness.Scene, tmp_path: Path) -> None:
    mine = tmp_path / "mine.txt"
    mine.write_text("my notes", encoding="utf-8")
    with pytest.raises(harness.InputError):
        harness.execute(wanted(scene)[:1], mine)
    assert mine.read_text(encoding="utf-8") == "my notes"


def test_a_function_that_a_worker_does_not_know_makes_its_scene_before(scene: harness.Scene) -> None:
    runs = harness.execute([harness.RunRequest(lambda: scene, "pymunk", 1e-2)], jobs=2)
    assert runs.table["outcome"].tolist() == ["stands"]
    with pytest.raises(harness.InputError, match=r"^RunRequest: scene: .*, got str"):
        harness.execute([harness.RunRequest(lambda: "a scene", "pymunk")])  # type: ignore[arg-type, return-value]
