"""Seeded scenes: how often a statement held, and what the target takes there beside each fixed rung."""

from __future__ import annotations

from typing import Any

import pytest

from harness.bench import sentences
from harness.bench import uncertainty_coverage as cover


def test_coverage_counts_what_was_missed_and_what_died() -> None:
    kept = [{"engine": "pymunk", "seed": 1, "covered": True}, {"engine": "pymunk", "seed": 2, "covered": False}]
    assert cover.counted([*kept, *cover.died("pymunk: seeds 3 to 4")]) == {
        "pymunk": {"inside": 1, "total": 4, "missed": [2, 3, 4]}
    }


def seeded(seed: int, coarse_rad: float, fine_rad: float, cpu_s: float) -> dict[str, Any]:
    """An invented row of coverage, met to the end at a cost, with two rungs of 1 and 4 ms of processor time."""
    levels = [
        {"dt_s": dt_s, "failed": None, "error_rad": error_rad, "cpu_s": took}
        for dt_s, error_rad, took in ((2e-3, coarse_rad, 1e-3), (1e-3, fine_rad, 4e-3))
    ]
    return {"engine": "pymunk", "seed": seed, "covered": True, "error_rad": 1e-5, "cpu_s": cpu_s, "rungs": levels}


def test_seeded_scenes_that_meet_the_target_are_compared_with_their_rungs() -> None:
    unmet = {"engine": "pymunk", "seed": 4, "covered": True, "error_rad": 1e-5, "cpu_s": 1.0, "rungs": []}
    rows = [seeded(1, 1e-4, 1e-5, 2e-3), seeded(2, 1e-2, 1e-5, 5e-3), unmet, *cover.died("pymunk: seeds 5 to 6")]
    (found,) = sentences.choice(cover.choice_rows(rows), 1e-3)
    assert (found["scenes"], found["worst_scene"]) == (2, "seed 1")
    assert found["fixed_s"] == pytest.approx(8e-3)
    assert found["share"] == pytest.approx(7e-3 / 8e-3)
    assert found["worst_times"] == pytest.approx(2.0)
    assert found["median_times"] == pytest.approx(0.5 * (2.0 + 1.25))
    record = {"rows": [], "target_rad": 1e-3, "choice": [], "coverage": {}, "skips": [], "seeded": [found]}
    assert sentences.sentences(record) == [
        "On 2 seeded scenes that pymunk meets to the end, --accuracy 0.001 takes 0.007 s, 0.88 times the one fixed rung that "
        "meets all of them (above the 0.5 wanted); 1.6 times the best rung in hindsight on half of them, at most 2 (within 3; "
        "seed 1)."
    ]


def test_the_rungs_of_a_seeded_scene_are_judged_by_its_finer_run() -> None:
    (row,) = cover.compute("pymunk: seeds 20703 to 20703")
    assert row["met_whole"]
    assert [level["dt_s"] for level in row["rungs"]] == [4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4]
    errors = [level["error_rad"] for level in row["rungs"]]
    assert errors[0] > errors[-1] > 0.0
    assert all(level["cpu_s"] > 0.0 for level in row["rungs"])
