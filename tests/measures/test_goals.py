"""The goals of a bench: each is reached or missed by its own number."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tests.measures.goals import COST_SHARE, OVERHEAD, Goal, goals, main

GOOD: dict[str, Any] = {
    "target_rad": 1e-3,
    "rows": [
        {"engine": "pymunk", "scene": "easy", "group": "ladder", "label": "", "error_rad": 1e-4, "real_time_factor": 300.0}
    ],
    "choice": [{"engine": "pymunk", "share": 0.4, "worst_times": 2.9}],
    "seeded": [{"engine": "pymunk", "share": 0.4, "worst_times": 2.9}],
    "coverage": {"pymunk": {"inside": 19, "total": 20}},
    "skips": [{"skip": "all together", "engine": "pymunk", "gain": 2.5, "changed": []}],
    "solvers": [
        {"case": "block", "solver": "analytic", "tolerance": 1e-9, "error_rad": 1e-10, "seconds": 1e-3},
        {"case": "block", "solver": "scipy DOP853", "tolerance": 1e-9, "error_rad": 1e-10, "seconds": 0.2},
    ],
    "throughput": {"two_block": {"runs_per_core_s": 11_000.0}, "map": {"size": 200, "wall_s": 4.0}},
    "startup": {"import_ratio": 1.2, "first_call_ratio": 1.9, "import_s": 9.0, "uncollected": {}},
    "overhead": {"pedestal_ratio": 1.05, "pedestal_run_s": 9.0},
}  # fmt: skip


def test_a_record_that_reaches_them_all() -> None:
    reached = list(goals(GOOD))
    assert len(reached) == 15
    assert [str(goal) for goal in reached if not goal.reached] == []


@pytest.mark.parametrize(
    ("part", "value", "missed"),
    [
        ("rows", [GOOD["rows"][0] | {"error_rad": 2e-3}], 1),
        ("rows", [GOOD["rows"][0] | {"real_time_factor": 240.0}], 1),
        ("choice", [{"engine": "pymunk", "share": None, "worst_times": 3.1}], 2),
        ("seeded", [{"engine": "pymunk", "share": COST_SHARE + 0.01, "worst_times": 2.0}], 1),
        ("coverage", {"pymunk": {"inside": 18, "total": 20}}, 1),
        ("skips", [{"skip": "all together", "engine": "pymunk", "gain": 1.5, "changed": ["a: b"]}], 2),
        ("skips", [{"skip": "all together", "engine": "pymunk", "changed": [], "failed": "no record"}], 1),
        ("solvers", [GOOD["solvers"][0], GOOD["solvers"][1] | {"error_rad": 1e-7}], 1),
        ("solvers", [GOOD["solvers"][0], GOOD["solvers"][1] | {"seconds": 0.09}], 2),
        ("throughput", {"two_block": {"runs_per_core_s": 9000.0}, "map": {"size": 200, "wall_s": 6.0}}, 2),
        ("throughput", {"two_block": {"runs_per_core_s": 11_000.0}, "map": {"size": 40, "wall_s": 6.0}}, 0),
        ("startup", {"import_ratio": 1.4, "first_call_ratio": 2.1}, 2),
        ("overhead", {"pedestal_ratio": OVERHEAD + 0.01}, 1),
    ],
)  # fmt: skip
def test_each_goal_can_be_missed(part: str, value: Any, missed: int) -> None:
    assert sum(not goal.reached for goal in goals({**GOOD, part: value})) == missed


def test_the_command_tells_and_fails(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "result.json"
    path.write_text(json.dumps(GOOD), encoding="utf-8")
    assert main([str(path)]) == 0
    path.write_text(json.dumps({**GOOD, "overhead": {"pedestal_ratio": 2.0}}), encoding="utf-8")
    assert main([str(path)]) == 1
    assert "MISSED   pymunk over a bare loop, pedestal_ratio: 2, at most 1.1 wanted" in capsys.readouterr().out
    assert str(Goal("a", None, 1.0)).endswith("not measured, at least 1 wanted")
