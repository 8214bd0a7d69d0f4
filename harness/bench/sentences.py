"""What the rows say, in sentences computed from them."""

from __future__ import annotations

import statistics
from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any, Final

Row = Mapping[str, Any]

REAL_TIME: Final = {"pymunk": 250.0, "pybullet": 60.0}
"""Times real time wanted on the block scenes at the target accuracy."""
COST_SHARE: Final = 0.5
"""Share of the fixed rung's total cost that the target accuracy may take, its checks included."""
HINDSIGHT: Final = 3.0
"""Times the best rung in hindsight that it may take on one scene."""
SKIP_GAIN: Final = {"analytic": 5.0, "pymunk": 2.0, "pybullet": 2.0}
STATED_SHARE: Final = 0.95


def choice(rows: Sequence[Row], target_rad: float) -> list[dict[str, Any]]:
    """For each engine: total cost of `--accuracy`, of the one fixed rung that meets the target everywhere, worst in hindsight."""
    found = []
    for engine in dict.fromkeys(row["engine"] for row in rows):
        mine = [row for row in rows if row["engine"] == engine]
        taken = {row["scene"]: row for row in mine if row["group"] == "accuracy" and row["failed"] is None}
        if not taken:
            continue
        # By its place in the ladder: one rung may have other iterations on another scene.
        levels: dict[int, dict[str, Row]] = defaultdict(dict)
        passed: dict[str, int] = defaultdict(int)
        for row in mine:
            if row["group"] != "ladder" or row["scene"] not in taken:
                continue
            if row["failed"] is None:
                levels[passed[row["scene"]]][row["scene"]] = row
            passed[row["scene"]] += 1
        meets = [
            sum(row["cpu_s"] for row in by_scene.values())
            for by_scene in levels.values()
            if set(by_scene) == set(taken) and all(row["error_rad"] <= target_rad for row in by_scene.values())
        ]
        hindsight = {}
        for scene, row in taken.items():
            good = [
                by[scene]["cpu_s"] for by in levels.values() if scene in by and by[scene]["error_rad"] <= target_rad
            ]
            if good:
                hindsight[scene] = row["cpu_s"] / min(good)
        total = sum(row["cpu_s"] for row in taken.values())
        worst = max(hindsight, key=lambda scene: hindsight[scene], default=None)
        found.append(
            {
                "engine": engine, "scenes": len(taken), "total_s": total, "fixed_s": min(meets, default=None),
                "share": None if not meets else total / min(meets), "worst_scene": worst,
                "worst_times": None if worst is None else hindsight[worst],
                "median_times": statistics.median(hindsight.values()) if hindsight else None,
                "met": sum(row["error_rad"] <= target_rad for row in taken.values()),
            }
        )  # fmt: skip
    return found


def fastest(rows: Sequence[Row], target_rad: float) -> dict[str, tuple[float, str]]:
    """For each engine the least real-time factor, over the block scenes, of the fastest rung that meets the target."""
    found: dict[str, tuple[float, str]] = {}
    for engine in dict.fromkeys(row["engine"] for row in rows):
        by_scene: dict[str, float] = {}
        for row in rows:
            if row["engine"] != engine or not row["block"] or row["group"] != "ladder":
                continue
            met = row["failed"] is None and row["error_rad"] <= target_rad
            by_scene[row["scene"]] = max(by_scene.get(row["scene"], 0.0), row["real_time_factor"] if met else 0.0)
        if by_scene:
            slowest = min(by_scene, key=lambda scene: by_scene[scene])
            found[engine] = by_scene[slowest], slowest
    return found


def sentences(record: Mapping[str, Any]) -> list[str]:
    """All sentences of a bench record."""
    rows, target = record["rows"], float(record["target_rad"])
    told = [_speed(engine, *item, target) for engine, item in fastest(rows, target).items()]
    told += [_choice(item, target) for item in record["choice"]]
    told += [_seeded(item, target) for item in record.get("seeded", ())]
    told += [_coverage(engine, item) for engine, item in record["coverage"].items()]
    told += [_skip(row) for row in record["skips"] if row["skip"] == "all together"]
    told += [
        f"{row['label']} ({row['engine']}): {row['error_rad']:.2g} rad on “{row['scene']}”."
        for row in _worst(rows)
        if row["group"] in ("default", "peer")
    ]
    return told


def _speed(engine: str, factor: float, scene: str, target: float) -> str:
    if factor == 0.0:
        return f"{engine}: no rung of its ladder meets {target:g} rad on “{scene}”."
    wanted = REAL_TIME.get(engine)
    against = "" if wanted is None else f" ({'at least' if factor >= wanted else 'short of'} the {wanted:g} wanted)"
    return f"{engine} meets {target:g} rad at {factor:.3g} times real time or faster{against}; slowest: “{scene}”."


def _choice(item: Mapping[str, Any], target: float) -> str:
    engine, times, worst = item["engine"], item["worst_times"], item["worst_scene"]
    start = f"--accuracy {target:g} with {engine}: {item['met']} of {item['scenes']} scenes met, {item['total_s']:.3g} s in all"
    if item["share"] is None:
        middle = ", where no fixed rung meets it on every scene"
    else:
        held = "within" if item["share"] <= COST_SHARE else "above"
        middle = f", {item['share']:.2f} times the one fixed rung that meets it everywhere ({held} the {COST_SHARE:g} wanted)"
    if times is None:
        return f"{start}{middle}."
    held = "within" if times <= HINDSIGHT else "above"
    return f"{start}{middle}; at most {times:.2g} times the best rung in hindsight ({held} {HINDSIGHT:g}; “{worst}”)."


def _seeded(item: Mapping[str, Any], target: float) -> str:
    on = f"On {item['scenes']} seeded scenes that {item['engine']} meets to the end, --accuracy {target:g} takes"
    end = "" if item["median_times"] is None else f"; {_hindsight(item)}"
    if item["share"] is None:
        return f"{on} {item['total_s']:.3g} s, where no fixed rung that was tried meets all of them{end}."
    held = "within" if item["share"] <= COST_SHARE else "above"
    fixed = f"{item['share']:.2f} times the one fixed rung that meets all of them ({held} the {COST_SHARE:g} wanted)"
    return f"{on} {item['total_s']:.3g} s, {fixed}{end}."


def _hindsight(item: Mapping[str, Any]) -> str:
    held = "within" if item["worst_times"] <= HINDSIGHT else "above"
    return (
        f"{item['median_times']:.2g} times the best rung in hindsight on half of them, at most {item['worst_times']:.2g} "
        f"({held} {HINDSIGHT:g}; {item['worst_scene']})"
    )


def _coverage(engine: str, item: Mapping[str, Any]) -> str:
    share = item["inside"] / item["total"] if item["total"] else 0.0
    held = "at least" if share >= STATED_SHARE else "less than"
    return (
        f"{engine}: the error lay within what was stated on {item['inside']} of {item['total']} seeded scenes "
        f"({held} {STATED_SHARE:.0%})."
    )


def _skip(row: Row) -> str:
    if row.get("failed"):
        return f"The skips were not measured: {row['failed']}."
    wanted = SKIP_GAIN[row["engine"]]
    held = "at least" if row["gain"] >= wanted else "short of"
    same = "no outcome changed" if row["same"] else "; ".join(row["changed"])
    if row.get("unsettled"):
        same += f", but for {len(row['unsettled'])} that the engine's own finer settings without skips change as well"
    return (
        f"All skips together on {row['scenes']} outcomes under the real records, {row['engine']}: {row['gain']:.2g} times "
        f"faster ({held} {wanted:g} wanted); {same}."
    )


def _worst(rows: Sequence[Row]) -> list[Row]:
    """Of each setting that is no rung, its row with the largest error."""
    found: dict[tuple[str, str], Row] = {}
    for row in rows:
        key = row["engine"], row["label"]
        if row["failed"] is None and (key not in found or row["error_rad"] > found[key]["error_rad"]):
            found[key] = row
    return list(found.values())
