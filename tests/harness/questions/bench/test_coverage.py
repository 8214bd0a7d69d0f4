"""Seeded scenes: how often a statement held, and what the target takes there beside each fixed level."""

from __future__ import annotations

from pathlib import Path

import pytest

from harness.questions.bench import bench_run, findings
from harness.records.base import part
from harness.records.bench import Coverage, Covered, LevelRow, Statement
from tests.measures.coverage import met_whole


def stated(error_rad: float) -> Statement:
    return Statement("pymunk", "stands", 1e-3, 3, 9000, 1e-4, 1e-5, 3.0, 3.0, error_rad, 0.0)


def test_coverage_counts_what_was_missed_and_what_died() -> None:
    kept = [Coverage("pymunk", 1, 1e-3, stated(1e-5)), Coverage("pymunk", 2, 1e-3, stated(1e-3))]
    died = bench_run.died("pymunk: seeds 3 to 4")
    assert bench_run.counted([*kept, *died]) == {"pymunk": Covered(1, 4, [2, 3, 4])}


def seeded(seed: int, coarse_rad: float, fine_rad: float, cpu_s: float) -> Coverage:
    """An invented row of coverage, met to the end at a cost, with two levels of 1 and 4 ms of processor time."""
    levels = (LevelRow(2e-3, None, coarse_rad, 1e-3), LevelRow(1e-3, None, fine_rad, 4e-3))
    return Coverage("pymunk", seed, 1e-3, stated(1e-5), cpu_s, levels)


def test_seeded_scenes_that_meet_the_target_are_compared_with_their_levels() -> None:
    unmet, died = Coverage("pymunk", 4, 1e-3, stated(1e-5), 1.0), Coverage("pymunk", 5, 1e-3)
    rows = [seeded(1, 1e-4, 1e-5, 2e-3), seeded(2, 1e-2, 1e-5, 5e-3), unmet, died]
    (found,) = findings.choice(bench_run.choice_rows(rows), 1e-3)
    assert (found.scenes, found.worst_scene) == (2, "seed 1")
    assert found.fixed_s == pytest.approx(8e-3)
    assert found.share == pytest.approx(7e-3 / 8e-3)
    assert found.worst_times == pytest.approx(2.0)
    assert found.median_times == pytest.approx(0.5 * (2.0 + 1.25))
    (told,) = findings.takes([found], 1e-3, "seeded")
    assert (told.engine, told.values["scenes_of"], told.values["scenes"]) == (found.engine, "seeded", found.scenes)


def test_the_levels_of_a_seeded_scene_are_judged_by_its_finer_run() -> None:
    (plain,) = bench_run.compute("tests.measures.coverage", "pymunk: seeds 20703 to 20703")
    row = part(Coverage, plain, Path("coverage"))
    assert met_whole(row)
    assert row.covered
    assert [level.dt_s for level in row.levels] == [4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4]
    errors = [level.error_rad for level in row.levels]
    assert errors[0] > errors[-1] > 0.0
    assert all(level.cpu_s > 0.0 for level in row.levels)
