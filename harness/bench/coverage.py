"""Is the stated numerical uncertainty honest, and what does a target take? Seeded scenes, each against a much finer run.

Measured by a program that is given; its rows are kept and counted here.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, replace
from typing import Final

from harness import engines
from harness.bench import programs
from harness.bench.precision import TARGET_RAD
from harness.campaign.parts import Row
from harness.records.bench import LEVEL, TARGET, Coverage, Covered, Level, PrecisionRow, Statement

FIRST_SEED: Final = 20_900
"""Scenes from here on were not used to choose the levels or the safety factor."""
SCENES: Final = 60
QUICK_SCENES: Final = 2
PIECE: Final = {"pybullet": 8, "pymunk": 25}
"""Scenes of one task, by engine."""


def read(row: Row) -> Coverage:
    """A row that was kept."""
    stated = row["stated"] and Statement(**row["stated"])
    return Coverage(**{**row, "stated": stated, "levels": tuple(Level(**level) for level in row["levels"])})


def tasks(quick: bool) -> list[str]:
    """The work in pieces that can be computed apart, the longest first."""
    last = FIRST_SEED + (QUICK_SCENES if quick else SCENES)
    return [
        f"{name}: seeds {begin} to {min(begin + piece, last) - 1}"
        for name, piece in PIECE.items()
        for begin in range(FIRST_SEED, last, piece)
    ]


def compute(program: str, task: str) -> list[Row]:
    """The rows of one piece; none where the engine is not here."""
    name, seeds = _piece(task)
    if engines.load(name).missing() is not None:
        return []
    done = programs.ask(program, name, str(seeds.start), str(len(seeds)), "--levels")
    return died(task) if done.returncode else [json.loads(line) for line in done.stdout.splitlines()]


def died(task: str) -> list[Row]:
    """A piece that took its process with it: none of its scenes is covered."""
    name, seeds = _piece(task)
    return [asdict(Coverage(name, seed, TARGET_RAD)) for seed in seeds]


def _piece(task: str) -> tuple[str, range]:
    name, _, span = task.partition(": seeds ")
    first, _, last = span.partition(" to ")
    return name, range(int(first), int(last) + 1)


def choice_rows(rows: Sequence[Coverage]) -> list[PrecisionRow]:
    """The scenes that met the target to the end, as `sentences.choice` compares them."""
    compared = []
    for row in rows:
        if not row.levels or row.stated is None:
            continue
        base = PrecisionRow(row.engine, f"seed {row.seed}", TARGET, "", error_rad=row.stated.error_rad, cpu_s=row.cpu_s)
        compared += [replace(base, group=LEVEL, **vars(level)) for level in row.levels]
        compared.append(base)
    return compared


def counted(rows: Sequence[Coverage]) -> dict[str, Covered]:
    """By engine: scenes on which the error lay within the statement, of how many, and which it did not."""
    counts = {}
    for engine in dict.fromkeys(row.engine for row in rows):
        mine = [row for row in rows if row.engine == engine]
        missed = [row.seed for row in mine if not row.covered]
        counts[engine] = Covered(len(mine) - len(missed), len(mine), missed)
    return counts
