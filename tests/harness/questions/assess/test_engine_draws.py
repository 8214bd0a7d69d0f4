"""An engine's probability from few runs: unbiased, intervals that cover, and a campaign that goes on where it stopped."""

import csv
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from harness import InputError, Outcome, assess, load_scene, simulate
from harness.model import Wall
from harness.questions.assess.assessment import overturns
from harness.questions.assess.probability import IMPACT, ModelDraws, estimate
from harness.records.assess import Assessment
from harness.runs.progress import LESS_STORED
from harness.runs.runner import InlinePool
from harness.runs.store import Store
from harness.runs.task import RunRequest, TaskResult
from reports.cli import studies
from reports.cli.app import EngineOptions, Sampling, ScanOptions, SupportOptions
from tests import budgets_assess as budget
from tests.scenes_for_tests import paestum


def population(agreement: float, probability: float, random: np.random.Generator) -> tuple[ModelDraws, np.ndarray]:
    """A model's answers to the draws and an engine's that agrees with that share of them, else is drawn anew."""
    fell = random.random(budget.TRUTH_DRAWS) < probability
    same = random.random(budget.TRUTH_DRAWS) < agreement
    engine = np.where(same, fell, random.random(budget.TRUTH_DRAWS) < probability)
    share = np.where(fell, 17.0, random.uniform(0.0, 1.2, budget.TRUTH_DRAWS))
    return ModelDraws(np.ones_like(fell), fell, share, np.zeros(fell.size), *np.zeros((2, fell.size), bool)), engine


def estimated(model: ModelDraws, engine: np.ndarray, half_width: float = 0.05) -> Assessment:
    def run(numbers: Sequence[int]) -> list[bool | None]:
        return [bool(engine[k]) for k in numbers]

    return estimate(model, run, half_width=half_width, most_runs=2000)


def test_undecided_runs_weigh_as_much_as_the_draws_they_stand_for() -> None:
    """Of a tenth of the draws, near falling, no run ends: a tenth is undecided, however many of the runs were made there."""
    share = np.repeat([0.2, 1.0], [900, 100])
    none = np.zeros(share.size, dtype=bool)
    model = ModelDraws(~none, none, share, np.zeros(share.size), none, none)

    def run(numbers: Sequence[int]) -> list[bool | None]:
        return [None if share[k] == 1.0 else False for k in numbers]

    answer = estimate(model, run, half_width=0.001, most_runs=100)
    assert answer.undecided == pytest.approx(0.1)
    assert answer.probability_overturned == 0.0
    assert 0.1 < answer.high < 0.25


@pytest.mark.parametrize(("agreement", "probability"), [(0.9, 0.4), (0.0, 0.4), (0.95, 0.1), (0.8, 0.03)])
def test_intervals_cover_the_engines_own_probability(agreement: float, probability: float) -> None:
    random = np.random.default_rng(7)
    model, engine = population(agreement, probability, random)
    truth, covered, values = engine.mean(), 0, []
    for _ in range(budget.REPETITIONS):
        order = random.permutation(engine.size)
        shuffled = ModelDraws(*(column[order] for column in model))
        answer = estimated(shuffled, engine[order])
        covered += answer.low <= truth <= answer.high
        values.append(answer.probability_overturned)
    assert covered / budget.REPETITIONS >= budget.LEAST_COVERED
    standard_error = np.std(values) / np.sqrt(budget.REPETITIONS)
    assert abs(np.mean(values) - truth) <= 4.0 * standard_error, "the estimate is biased"


def test_an_engine_that_agrees_needs_fewer_runs() -> None:
    random = np.random.default_rng(3)
    close, far = (estimated(*population(agreement, 0.4, random)) for agreement in (0.95, 0.0))
    assert close.engine_runs < 0.5 * far.engine_runs


def test_a_model_that_is_always_wrong_does_not_move_the_estimate() -> None:
    model, engine = population(1.0, 0.4, np.random.default_rng(5))
    answer = estimated(model, ~engine)
    assert answer.low <= 1.0 - engine.mean() <= answer.high


def test_failed_runs_are_counted_apart() -> None:
    model, _ = population(1.0, 0.4, np.random.default_rng(5))
    answer = estimate(model, lambda numbers: [None] * len(numbers), half_width=0.05, most_runs=64)
    assert answer.undecided == 1.0
    assert answer.engine_runs == 64
    assert np.isnan(answer.probability_overturned)


FEW = {"draws": 200, "most_runs": 32, "more_options": None}


def test_what_is_stored_is_not_run_again(tmp_path: Path) -> None:
    scene = paestum(0.429, 3.0, duration_s=1.0)
    with Store(tmp_path / "store.sqlite") as store:
        first = assess(scene, ["pymunk"], store=store, pool=InlinePool(), **FEW)
    told: list[str] = []
    with Store(tmp_path / "store.sqlite") as store:
        again = assess(scene, ["pymunk"], store=store, pool=InlinePool(), on_progress=told.append, **FEW)
        other = assess(scene, ["pymunk"], store=store, pool=InlinePool(), seed=1, **FEW)
    assert first.record.runs.computed == first.record.runs.wanted == len(first.fell["pymunk"]) > 0
    assert again.record.runs.computed == 0
    assert any(line.startswith("this takes ") and line.endswith(LESS_STORED) for line in told)
    assert again.record.assessment == first.record.assessment
    assert again.fell == first.fell
    assert other.record.runs.computed == other.record.runs.wanted


def test_a_killed_assessment_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Interrupted at its tenth run, nine are kept, and only the others are run by the next."""
    scene, made = paestum(0.429, 3.0, duration_s=1.0), [0]

    def interrupted(drawn: Any) -> TaskResult:
        made[0] += 1
        if made[0] == 10:
            raise KeyboardInterrupt
        return overturns(drawn)

    monkeypatch.setattr("harness.questions.assess.assessment.overturns", interrupted)
    with Store(tmp_path / "store.sqlite") as store, pytest.raises(KeyboardInterrupt):
        assess(scene, ["pymunk"], store=store, pool=InlinePool(), **FEW)
    monkeypatch.undo()
    with Store(tmp_path / "store.sqlite") as store:
        record = assess(scene, ["pymunk"], store=store, pool=InlinePool(), **FEW).record
    assert record.runs.wanted - record.runs.computed == 9


def test_draws_of_an_engine_that_touch_the_wall_are_told_as_such() -> None:
    """Of the draws near a fall half touch the wall, a quarter come to no end."""
    overturned, near = np.repeat([True, False], [40, 60]), np.repeat([0.0, 0.9], [40, 60])
    model = ModelDraws(np.ones(100, dtype=bool), overturned, near, near, *np.zeros((2, 100), dtype=bool))
    ends = [True] * 40 + [Outcome.TOUCHES_WALL, Outcome.TOUCHES_WALL, None, False] * 15
    found = estimate(model, lambda numbers: [ends[k] for k in numbers], half_width=1e-3, most_runs=100)
    assert (found.engine_runs, found.undecided, found.touches_wall) == (100, pytest.approx(0.45), pytest.approx(0.3))


def test_a_run_that_touches_the_wall_neither_stands_nor_falls() -> None:
    shaken = paestum(0.334, 3.0, duration_s=1.0)
    answer = overturns(RunRequest(replace(shaken, wall=Wall("right", 0.001)), "pymunk"))
    assert answer.record == {"overturned": None, "reach_m": None, "touches_wall": True}
    assert not answer.failed
    assert overturns(RunRequest(shaken, "pymunk")).record["overturned"] is False


SCENE = Path(__file__).parents[4] / "scenes" / "paestum_block.toml"
DRAWN = Sampling(draws=100)
SAMPLING = Sampling(draws=100, seed=0, half_width=0.05, most_runs=30)


def test_draws_are_written_with_every_outcome(tmp_path: Path) -> None:
    asked, folder = EngineOptions(["pymunk"], ["duration_s=1.0"]), tmp_path / "out"
    record = studies.assess(SCENE, folder, asked, SAMPLING, no_options=True, csv=True, jobs=1, quiet=True)
    assert record.options is None
    assert record.files is not None
    assert "draws.csv" in record.files
    with (folder / "draws.csv").open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 100
    assert [row["draw"] for row in rows[:3]] == ["0", "1", "2"]
    share = sum(int(row["analytic_overturned"]) for row in rows) / 100
    assert share == record.answers["analytic"].probability_overturned
    assert record.clearance is not None
    undecided = record.clearance.by_model["pymunk"].undecided
    assert sum(row["pymunk_overturned"] != "" for row in rows) == record.runs.wanted - undecided
    # Every row, set in the scene, gives its peaks again; what acts at an impact stood there as a share.
    base, own = load_scene(SCENE, ["duration_s=1.0"]), load_scene(SCENE).contact
    for row in rows[:40]:
        static = float(row["contact.floor"])
        friction = {
            "static": static,
            "kinetic": static * own.floor_kinetic / own.floor_static,
            "impact": float(row[IMPACT]),
        }
        keys = {"motion.scale", "motion.x.frequency_hz"} & row.keys()
        given = {f"contact.floor_{k}": v for k, v in friction.items()} | {key: float(row[key]) for key in keys}
        run = simulate(base.replace(given), "analytic")
        assert run.peak_slip_m == pytest.approx(float(row["analytic_peak_slip_m"]), rel=1e-5)
    # With the store of the first, a second call runs nothing, and takes away what it is not asked for.
    again = studies.assess(SCENE, folder, asked, SAMPLING, no_options=True, jobs=1, resume=True, quiet=True)
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
            studies.assess(SCENE, folder, asked, DRAWN, quiet=True, **more)
    assert not folder.exists()


def test_a_scan_and_a_record_are_assessed_and_their_scene_is_kept(tmp_path: Path) -> None:
    scan, motion, folder = tmp_path / "block.ply", tmp_path / "quake.csv", tmp_path / "a" / "out"
    # A block is prepared in no time.
    box = trimesh.creation.box((0.3, 0.5, 1.4))
    box.export(scan)
    motion.write_text("t_s,x [m/s2]\n" + "".join(f"{0.02 * k:.2f},{(-3.0) ** (k % 2)}\n" for k in range(60)))
    scanned = studies.Scanned(motion, ScanOptions(unit="m", up="z"), SupportOptions(friction=0.5))
    asked, more = EngineOptions(["analytic"]), {"no_options": True, "quiet": True}
    record = studies.assess(scan, folder, asked, DRAWN, scanned=scanned, **more)
    again = studies.assess(folder / "scene.toml", tmp_path / "again", asked, DRAWN, **more)
    assert record.assessment == again.assessment
    assert {"scene.toml", "scene_statue.ply"} <= set(record.files or ())
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a", "again", "block.ply", "quake.csv"]
    wrong = [
        (scan, studies.Scanned()),
        (SCENE, scanned),
        (SCENE, studies.Scanned(known=ScanOptions(height_m=2.0))),
    ]
    for path, given in wrong:
        with pytest.raises(InputError, match="--motion"):
            studies.assess(path, tmp_path / "none", asked, DRAWN, scanned=given, **more)
    with pytest.raises(InputError, match="another folder"):
        studies.assess(folder / "scene.toml", folder, asked, DRAWN, **more)
