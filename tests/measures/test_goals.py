"""The goals of a bench: each is reached or missed by its own number."""

import json
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import pytest

from harness.records.base import plain
from harness.records.bench import BenchRecord, LevelChoice, PrecisionRow, SkipRow
from tests.measures.analytic_model import SolverRow, Throughput
from tests.measures.goals import COST_SHARE, OVERHEAD, Goal, goals, main
from tests.measures.other_integrators import Others, times_as_fast
from tests.measures.start import StartRow

ROW = PrecisionRow("pymunk", "easy", "level", "", error_rad=1e-4, real_time_factor=300.0)
CHOICE = LevelChoice("pymunk", 3, 3, 0.4, 1.0, 0.4, "easy", 2.9)
SKIP = SkipRow("all together", "pymunk", 6, 1.0, 2.5)
OURS = SolverRow("block", "analytic", 1e-9, error_rad=1e-10, seconds=1e-3)
THEIRS = SolverRow("block", "scipy DOP853", 1e-9, error_rad=1e-10, seconds=0.2)
RATE = Throughput(40_000, 2, 4.0, 8.0, 1e4, 26_000.0, 300.0, 1.0, 0.5)
RATES = {"two_block": RATE, "two_block_certified": RATE, "map": RATE}
START = StartRow(1.0, 1.0, 1.2, 1.9)
GOOD = BenchRecord(
    target_rad=1e-3, rows=[ROW], choice=[CHOICE], skips=[SKIP], seconds=1.0, versions={}, machine={},
)  # fmt: skip
OTHERS = Others([OURS, THEIRS], RATES, START, {"pedestal_ratio": 1.05, "pedestal_run_s": 9.0})


def test_a_record_that_reaches_them_all() -> None:
    reached = list(goals(GOOD, OTHERS))
    assert len(reached) == 13
    assert [str(goal) for goal in reached if not goal.reached] == []


@pytest.mark.parametrize(
    ("part", "value", "missed"),
    [
        ("rows", [replace(ROW, error_rad=2e-3)], 1),
        ("rows", [replace(ROW, real_time_factor=240.0)], 1),
        ("choice", [replace(CHOICE, share=None, worst_times=3.1)], 2),
        ("choice", [replace(CHOICE, share=COST_SHARE + 0.01)], 1),
        ("skips", [replace(SKIP, off_s=1.5, changed=["a: b"])], 2),
        ("skips", [SkipRow("all together", "pymunk", failed="no record")], 1),
        ("solvers", [OURS, replace(THEIRS, error_rad=1e-7)], 1),
        ("solvers", [OURS, replace(THEIRS, seconds=0.09)], 2),
        ("throughput", {"two_block": replace(RATE, runs_per_core_s=9000.0), "map": replace(RATE, wall_s=6.0)}, 2),
        ("throughput", {"two_block": RATE, "map": replace(RATE, runs=1600, wall_s=6.0)}, 0),
        ("throughput", RATES | {"two_block_certified": replace(RATE, runs_per_core_s=19_000.0)}, 1),
        ("startup", replace(START, import_ratio=1.4, first_call_ratio=2.1), 2),
        ("overhead", {"pedestal_ratio": OVERHEAD + 0.01}, 1),
    ],
)  # fmt: skip
def test_each_goal_can_be_missed(part: str, value: Any, missed: int) -> None:
    record = replace(GOOD, **{part: value}) if hasattr(GOOD, part) else GOOD
    others = replace(OTHERS, **{part: value}) if hasattr(OTHERS, part) else OTHERS
    assert sum(not goal.reached for goal in goals(record, others)) == missed


def test_solvers_are_compared_at_equal_error() -> None:
    loose = replace(OURS, error_rad=1e-4, seconds=1e-4)
    rows = [OURS, loose, replace(THEIRS, error_rad=1e-7)]
    assert times_as_fast("analytic", "scipy DOP853", 1e-6, rows) == pytest.approx(200.0), "not by what errs by more"
    assert times_as_fast("analytic", "scipy DOP853", 1e-9, rows) is None, "which the other did not reach"


def test_the_command_tells_and_fails(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, kept = tmp_path / "result.json", tmp_path / "others.json"
    path.write_text(json.dumps(plain(GOOD)), encoding="utf-8")
    assert main([str(path), str(kept)]) == 0, "what is not measured has no goals"
    kept.write_text(json.dumps(asdict(OTHERS)), encoding="utf-8")
    assert main([str(path), str(kept)]) == 0
    kept.write_text(json.dumps(asdict(replace(OTHERS, overhead={"pedestal_ratio": 2.0}))), encoding="utf-8")
    assert main([str(path), str(kept)]) == 1
    assert str(Goal("pymunk over a baseline loop, pedestal_ratio", 2.0, 1.1, at_most=True)) in capsys.readouterr().out
    assert not Goal("a", None, 1.0).reached
