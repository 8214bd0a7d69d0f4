"""What each skip changes: seeded scenes with all skips and with all but one, at one step.

`python -m harness.bench.unchanged [FIRST COUNT [ENGINE]]` prints a row for each engine and skip.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from harness import engines
from harness.accuracy.refinement import run_to_accuracy
from harness.bench.seeded_scenes import random_scene
from harness.bench.skip_savings import difference
from harness.engines.base import Engine
from harness.model.options import SKIPS, RunOptions
from harness.model.run import Run
from harness.model.scene import Scene

ENGINES: Final = ("analytic", "pymunk", "pybullet")
FIRST_SEED, SCENES = 30_000, 100
STEP_S: Final = 1e-3
FINER: Final = 0.25
"""Step of the run that tells how far the engine's own error goes where a skip parts two runs, over theirs, and"""
PARTED_RAD: Final = 1e-5
"""from what difference on it is asked."""
OUTCOME_ONLY: Final = frozenset({"no_history", "energy_outcome"})
"""Skips that apply where no history is asked: outcome and peak are compared."""


@dataclass(frozen=True)
class Effect:
    """One skip on one scene: largest difference, rad, and that to a finer run without it (None: not asked), outcomes."""

    engine: str
    skip: str
    seed: int
    apart_rad: float
    own_rad: float | None
    outcomes: tuple[str, str]


def effects(engine: Engine, seeds: Sequence[int]) -> Iterator[Effect]:
    """Every skip of an engine on every seed's scene."""
    for seed in seeds:
        scene = random_scene(seed)
        with_all = {history: _run(engine, scene, RunOptions(history=history)) for history in (True, False)}
        for skip in sorted(engine.capabilities.skips):
            want = RunOptions(history=skip not in OUTCOME_ONLY, skips=frozenset(SKIPS) - {skip})
            on, off = with_all[want.history], _run(engine, scene, want)
            apart, own = difference(on, off), None
            if apart > PARTED_RAD and not engine.capabilities.certifies:
                own = difference(off, _run(engine, scene, want, FINER * STEP_S))
            yield Effect(engine.name, skip, seed, apart, own, (on.outcome.value, off.outcome.value))


def _run(engine: Engine, scene: Scene, want: RunOptions, dt_s: float = STEP_S) -> Run:
    if engine.capabilities.certifies:
        return run_to_accuracy(engine, scene, 1e-3, want)
    return engine.simulate(scene, engine.settings_for_dt(scene, dt_s), want)


def line(found: Sequence[Effect]) -> str:
    """A row of the table from one skip's effects on all scenes."""
    apart = np.array([item.apart_rad for item in found])
    worst = found[int(np.argmax(apart))]
    own = "" if worst.own_rad is None else f"{worst.own_rad:.1e}"
    changed = [str(item.seed) for item in found if item.outcomes[0] != item.outcomes[1]]
    return (
        f"| {worst.engine} | {worst.skip} | {int(np.sum(apart == 0.0))} of {apart.size} | {np.percentile(apart, 90):.1e} | "
        f"{apart.max():.1e} ({worst.seed}) | {own} | {', '.join(changed) or 'none'} |"
    )


def main(arguments: Sequence[str]) -> None:
    """Print the table, an engine's rows once all of its scenes are done."""
    first, count = (int(item) for item in arguments[:2]) if arguments else (FIRST_SEED, SCENES)
    sys.stdout.write(
        "| engine | skip | same bits | nine in ten, rad | largest, rad (seed) | its own error there | other outcome |\n"
    )
    sys.stdout.write("|---|---|---|---|---|---|---|\n")
    for name in arguments[2:] or ENGINES:
        found = list(effects(engines.load(name), range(first, first + count)))
        for skip in sorted({item.skip for item in found}):
            sys.stdout.write(line([item for item in found if item.skip == skip]) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main(sys.argv[1:])
