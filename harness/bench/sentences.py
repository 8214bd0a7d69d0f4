"""What the rows say, in sentences computed from them."""

from __future__ import annotations

import statistics
from collections import defaultdict
from collections.abc import Mapping, Sequence

from harness.records.bench import DEFAULT, LEVEL, OTHER_PROJECT, TARGET, Choice, Covered, PrecisionRow


def choice(rows: Sequence[PrecisionRow], target_rad: float) -> list[Choice]:
    """For each engine what the target takes on the scenes where it gave an answer."""
    engines = dict.fromkeys(row.engine for row in rows)
    choices = [_choice([row for row in rows if row.engine == engine], target_rad) for engine in engines]
    return [item for item in choices if item is not None]


def _choice(rows: Sequence[PrecisionRow], target_rad: float) -> Choice | None:
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
    return Choice(
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


def speeds(rows: Sequence[PrecisionRow], target_rad: float) -> list[str]:
    """How fast each engine meets the target."""
    return [
        f"{engine} meets {target_rad:g} rad at {factor:.3g} times real time or faster; slowest: “{scene}”."
        if factor > 0.0
        else f"{engine}: no level of its meets {target_rad:g} rad on “{scene}”."
        for engine, (factor, scene) in fastest(rows, target_rad).items()
    ]


def choices(standard: Sequence[Choice], seeded: Sequence[Choice], target_rad: float) -> list[str]:
    """What the target takes on the standard set, and on the seeded scenes that meet it to the end."""
    lines = [
        f"--accuracy {target_rad:g} with {item.engine}: {item.met} of {item.scenes} scenes met, {_cost(item)}."
        for item in standard
    ]
    return lines + [
        f"On {item.scenes} seeded scenes that {item.engine} meets to the end, --accuracy {target_rad:g} takes {_cost(item)}."
        for item in seeded
    ]


def _cost(item: Choice) -> str:
    fixed = "where no fixed level that was tried meets all of them"
    if item.share is not None:
        fixed = f"{item.share:.2f} times the one fixed level that meets all of them"
    start = f"{item.total_s:.3g} s in all, {fixed}"
    if item.worst_times is None:
        return start
    half = f"{item.median_times:.2g} times the best level in hindsight on half of them"
    return f"{start}; {half}, at most {item.worst_times:.2g} (“{item.worst_scene}”)"


def coverage(counts: Mapping[str, Covered]) -> list[str]:
    """How often errors lay within what was stated."""
    return [
        f"{engine}: the error lay within what was stated on {item.inside} of {item.total} seeded scenes."
        for engine, item in counts.items()
    ]


def defaults(rows: Sequence[PrecisionRow]) -> list[str]:
    """The largest error of each setting that is no level."""
    worst: dict[tuple[str, str], PrecisionRow] = {}
    for row in rows:
        key = row.engine, row.label
        if row.group in (DEFAULT, OTHER_PROJECT) and row.error_rad is not None:
            worst[key] = max(row, worst.get(key, row), key=lambda each: each.error_rad or 0.0)
    return [f"{row.label} ({row.engine}): {row.error_rad:.2g} rad on “{row.scene}”." for row in worst.values()]
