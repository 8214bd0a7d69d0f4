"""What the rows of the bench say."""

from __future__ import annotations

import statistics
from collections import defaultdict
from collections.abc import Sequence

from harness.model.finding import Finding, caution, info
from harness.records.bench import LEVEL, TARGET, LevelChoice, PrecisionRow


def choice(rows: Sequence[PrecisionRow], target_rad: float) -> list[LevelChoice]:
    """For each engine what the target takes on the scenes where it gave an answer."""
    engines = dict.fromkeys(row.engine for row in rows)
    choices = [_choice([row for row in rows if row.engine == engine], target_rad) for engine in engines]
    return [item for item in choices if item is not None]


def _choice(rows: Sequence[PrecisionRow], target_rad: float) -> LevelChoice | None:
    taken = {row.scene: row for row in rows if row.group == TARGET and row.failed is None}
    if not taken:
        return None
    # By its place among the levels: one level may have other iterations on another scene.
    levels: dict[int, dict[str, PrecisionRow]] = defaultdict(dict)
    passed: dict[str, int] = defaultdict(int)
    for row in rows:
        if row.group == LEVEL and row.scene in taken:
            if row.failed is None:
                levels[passed[row.scene]][row.scene] = row
            passed[row.scene] += 1
    whole = [
        by for by in levels.values() if set(by) == set(taken) and all(row.meets(target_rad) for row in by.values())
    ]
    fixed_s = min((sum(row.cpu_s or 0.0 for row in by.values()) for by in whole), default=None)
    times = {}
    for scene, row in taken.items():
        good = [by[scene].cpu_s or 0.0 for by in levels.values() if scene in by and by[scene].meets(target_rad)]
        if good:
            times[scene] = (row.cpu_s or 0.0) / min(good)
    total_s = sum(row.cpu_s or 0.0 for row in taken.values())
    worst = max(times, key=lambda scene: times[scene], default=None)
    return LevelChoice(
        rows[0].engine,
        len(taken),
        sum(row.meets(target_rad) for row in taken.values()),
        total_s,
        fixed_s,
        None if fixed_s is None else total_s / fixed_s,
        worst,
        None if worst is None else times[worst],
        statistics.median(times.values()) if times else None,
    )


def fastest(rows: Sequence[PrecisionRow], target_rad: float) -> dict[str, tuple[float, str]]:
    """For each engine the least real-time factor, over the block scenes, of the fastest level that meets the target."""
    slowest: dict[str, tuple[float, str]] = {}
    for engine in dict.fromkeys(row.engine for row in rows):
        by_scene: dict[str, float] = {}
        for row in rows:
            if row.engine == engine and row.block and row.group == LEVEL:
                factor = (row.real_time_factor or 0.0) if row.meets(target_rad) else 0.0
                by_scene[row.scene] = max(by_scene.get(row.scene, 0.0), factor)
        if by_scene:
            slowest[engine] = min((factor, scene) for scene, factor in by_scene.items())
    return slowest


def speeds(rows: Sequence[PrecisionRow], target_rad: float) -> list[Finding]:
    """How fast each engine meets the target."""
    return [
        info("meets_target", model=engine, factor=factor, scene=scene, target_rad=target_rad)
        if factor > 0.0
        else caution("misses_target", model=engine, scene=scene, target_rad=target_rad)
        for engine, (factor, scene) in fastest(rows, target_rad).items()
    ]


def takes(choices: Sequence[LevelChoice], target_rad: float) -> list[Finding]:
    """What the target takes."""
    return [info("target_takes", target_rad=target_rad, **vars(item)).of(item.engine) for item in choices]
