"""An engine's runs as tasks of a campaign: an assessment goes on where it stopped; every draw can be written."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import trimesh

from harness.model.errors import InputError
from harness.model.scene import Wall
from harness.questions.assess.assessment import assess
from harness.questions.assess.engine_draws import DrawnRun, overturns
from harness.runs.runner import InlinePool
from harness.runs.store import Store
from harness.runs.task import Answer
from reports.cli import assessments
from reports.cli.options import EngineOptions, Sampling, ScanOptions, SupportOptions
from tests.scenes_for_tests import paestum

FEW = {"draws": 200, "most_runs": 32, "more_options": None}


def test_what_is_stored_is_not_run_again(tmp_path: Path) -> None:
    scene = paestum(0.429, 3.0, duration_s=1.0)
    with Store(tmp_path / "store.sqlite") as store:
        first = assess(scene, ["pymunk"], store=store, pool=InlinePool(), **FEW)
    with Store(tmp_path / "store.sqlite") as store:
        again = assess(scene, ["pymunk"], store=store, pool=InlinePool(), **FEW)
        other = assess(scene, ["pymunk"], store=store, pool=InlinePool(), seed=1, **FEW)
    assert first.record.runs.computed == first.record.runs.wanted == len(first.fell["pymunk"]) > 0
    assert again.record.runs.computed == 0
    assert again.record.assessment == first.record.assessment
    assert again.fell == first.fell
    assert other.record.runs.computed == other.record.runs.wanted


def test_a_killed_assessment_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Interrupted at its tenth run, nine are kept, and only the others are run by the next."""
    scene, made = paestum(0.429, 3.0, duration_s=1.0), [0]

    def interrupted(drawn: Any) -> Answer:
        made[0] += 1
        if made[0] == 10:
            raise KeyboardInterrupt
        return overturns(drawn)

    monkeypatch.setattr("harness.questions.assess.engine_draws.overturns", interrupted)
    with Store(tmp_path / "store.sqlite") as store, pytest.raises(KeyboardInterrupt):
        assess(scene, ["pymunk"], store=store, pool=InlinePool(), **FEW)
    monkeypatch.undo()
    with Store(tmp_path / "store.sqlite") as store:
        record = assess(scene, ["pymunk"], store=store, pool=InlinePool(), **FEW).record
    assert record.runs.wanted - record.runs.computed == 9


def test_a_run_that_touches_the_wall_neither_stands_nor_falls() -> None:
    shaken = paestum(0.334, 3.0, duration_s=1.0)
    answer = overturns(DrawnRun("pymunk", replace(shaken, wall=Wall("right", 0.001))))
    assert answer.record == {"overturned": None, "reach_m": None}
    assert not answer.failed
    assert overturns(DrawnRun("pymunk", shaken)).record["overturned"] is False


SCENE = Path(__file__).parents[4] / "scenes" / "paestum_block.toml"
SAMPLING = Sampling(draws=100, seed=0, half_width=0.05, most_runs=30)


def test_draws_are_written_with_every_outcome(tmp_path: Path) -> None:
    asked, folder = EngineOptions(["pymunk"], ["duration_s=1.0"]), tmp_path / "out"
    record = assessments.run(SCENE, folder, asked, SAMPLING, no_options=True, csv=True, jobs=1, quiet=True)
    assert record.options is None
    assert record.files is not None
    assert "draws.csv" in record.files
    with (folder / "draws.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 100
    assert [row["draw"] for row in rows[:3]] == ["0", "1", "2"]
    share = sum(int(row["analytic_overturned"]) for row in rows) / 100
    assert share == record.answers["analytic"].probability_overturned
    undecided = record.answers["pymunk"].undecided * record.runs.wanted
    assert sum(row["pymunk_overturned"] != "" for row in rows) == pytest.approx(record.runs.wanted - undecided)
    assert all(float(row["contact.floor"]) > 0.0 for row in rows)
    # With the store of the first, a second call runs nothing, and takes away what it is not asked for.
    again = assessments.run(SCENE, folder, asked, SAMPLING, no_options=True, jobs=1, resume=True, quiet=True)
    assert again.runs.computed == 0
    assert not (folder / "draws.csv").exists()


def test_wrong_options_of_the_command_are_told_and_leave_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("harness.runs.runner.REACH_S", 0.5)
    asked, folder = EngineOptions(["analytic"]), tmp_path / "out"
    wrong: list[dict[str, Any]] = [
        {"resume": True},
        {"jobs": 0},
        {"no_options": True, "options": tmp_path / "mine.toml"},
    ]
    for more in (*wrong, {"options": tmp_path / "none.toml"}, {"dask": "tcp://127.0.0.1:1"}):
        with pytest.raises(InputError):
            assessments.run(SCENE, folder, asked, SAMPLING, quiet=True, **more)
    assert not folder.exists()


def test_a_scan_and_a_record_are_assessed_and_their_scene_is_kept(tmp_path: Path) -> None:
    scan, motion, folder = tmp_path / "block.ply", tmp_path / "quake.csv", tmp_path / "a" / "out"
    # A block is prepared in no time.
    box = trimesh.creation.box((0.3, 0.5, 1.4))
    box.export(scan)
    motion.write_text("t_s,x [m/s2]\n" + "".join(f"{0.02 * k:.2f},{(-3.0) ** (k % 2)}\n" for k in range(60)))
    scanned = assessments.Scanned(motion, ScanOptions(unit="m", up="z"), SupportOptions(friction=0.5))
    asked, more = EngineOptions(["analytic"]), {"no_options": True, "quiet": True}
    record = assessments.run(scan, folder, asked, SAMPLING, scanned=scanned, **more)
    again = assessments.run(folder / "scene.toml", tmp_path / "again", asked, SAMPLING, **more)
    assert record.assessment == again.assessment
    assert {"scene.toml", "scene_statue.ply"} <= set(record.files or ())
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a", "again", "block.ply", "quake.csv"]
    wrong = [
        (scan, assessments.Scanned()),
        (SCENE, scanned),
        (SCENE, assessments.Scanned(known=ScanOptions(height_m=2.0))),
    ]
    for path, given in wrong:
        with pytest.raises(InputError, match="--motion"):
            assessments.run(path, tmp_path / "none", asked, SAMPLING, scanned=given, **more)
    with pytest.raises(InputError, match="another folder"):
        assessments.run(folder / "scene.toml", folder, asked, SAMPLING, **more)
