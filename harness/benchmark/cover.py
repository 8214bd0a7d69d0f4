"""How often the error lies within what a run stated, on seeded scenes that no setting was tuned on."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

from harness import engines
from harness.benchmark.precision import TARGET_RAD
from harness.coverage import FIRST_SEED, coverage
from harness.parts import Row

SEEDS: Final = {"pybullet": 200, "pymunk": 200}
"""Seeded scenes by engine."""
QUICK_SEEDS: Final = 2
PIECE: Final = {"pybullet": 8, "pymunk": 25}


def tasks(quick: bool) -> list[str]:
    """The work in pieces that can be computed apart, the longest first."""
    found = []
    for name, count in SEEDS.items():
        last = FIRST_SEED + (QUICK_SEEDS if quick else count)
        for begin in range(FIRST_SEED, last, PIECE[name]):
            found.append(f"{name}: seeds {begin} to {min(begin + PIECE[name], last) - 1}")
    return found


def compute(task: str) -> list[Row]:
    """The rows of one piece; none where the engine is not here."""
    name, seeds = _piece(task)
    engine = engines.load(name)
    if engine.missing() is not None:
        return []
    return [row.as_dict() for row in coverage(engine, TARGET_RAD, seeds)]


def died(task: str) -> list[Row]:
    """A piece that took its process with it: none of its scenes is covered."""
    name, seeds = _piece(task)
    return [{"engine": name, "seed": seed, "covered": False, "died": True} for seed in seeds]


def counted(rows: Sequence[Row]) -> dict[str, dict[str, Any]]:
    """By engine: scenes on which the error lay within the statement, of how many, and which it did not."""
    found: dict[str, dict[str, Any]] = {}
    for row in rows:
        item = found.setdefault(row["engine"], {"inside": 0, "total": 0, "missed": []})
        item["inside"] += bool(row["covered"])
        item["total"] += 1
        if not row["covered"]:
            item["missed"].append(row["seed"])
    return found


def _piece(task: str) -> tuple[str, range]:
    name, _, span = task.partition(": seeds ")
    first, _, last = span.partition(" to ")
    return name, range(int(first), int(last) + 1)
