"""Seeded scenes that no setting was tuned on: how often the error lies within what a run stated, and what the target takes there
beside each fixed rung.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from typing import Any, Final

from harness import engines
from harness.bench.coverage import FIRST_SEED, Case, cases, random_scene, row_of
from harness.bench.precision import TARGET_RAD, error
from harness.campaign.parts import Row
from harness.engines.base import Engine, EngineFailure
from harness.model.options import RunOptions

SEEDS: Final = {"pybullet": 200, "pymunk": 200}
"""Seeded scenes by engine."""
QUICK_SEEDS: Final = 2
FINEST_S: Final = 2.5e-4
"""Step of the finest rung that is compared: the share of what it takes is clear by then, and finer ones take the most."""
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
    found = []
    # What is loaded and compiled once is not the first scene's cost.
    first = random_scene(seeds[0])
    engine.simulate(first, engine.refinement_levels(first)[0], RunOptions())
    for case in cases(engine, TARGET_RAD, seeds):
        row = row_of(case, engine.name, TARGET_RAD)
        # Where the target is not met to the end, no rung is known to be enough.
        levels = list(_rungs(engine, case)) if row.met_whole else []
        found.append(row.as_dict() | {"cpu_s": case.cpu_s, "rungs": levels})
    return found


def _rungs(engine: Engine, case: Case) -> Iterator[Row]:
    """Each rung down to `FINEST_S` on a case's scene: its error and what it takes, timed once, after the run to the target."""
    for settings in engine.refinement_levels(case.scene):
        if settings.dt_s < FINEST_S:
            return
        begin = time.process_time()
        try:
            run = engine.simulate(case.scene, settings, RunOptions())
        except EngineFailure as failure:
            yield {"dt_s": settings.dt_s, "failed": str(failure)}
            continue
        cpu_s = time.process_time() - begin
        yield {"dt_s": settings.dt_s, "failed": None, "error_rad": error(run, case.truth), "cpu_s": cpu_s}


def choice_rows(rows: Sequence[Row]) -> list[Row]:
    """The scenes that met the target to the end, as `sentences.choice` compares them."""
    found: list[Row] = []
    for row in rows:
        if not row.get("rungs"):
            continue
        common = {"engine": row["engine"], "scene": f"seed {row['seed']}", "label": ""}
        found += [{**common, "group": "ladder", **level} for level in row["rungs"]]
        asked = {"error_rad": row["error_rad"], "cpu_s": row["cpu_s"], "failed": None}
        found.append({**common, "group": "accuracy", **asked})
    return found


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
