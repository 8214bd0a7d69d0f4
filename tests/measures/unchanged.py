"""What each skip changes: seeded scenes with all skips and with all but one, at one step.

`python -m tests.measures.unchanged [FIRST COUNT ENGINE...]` prints a row for each engine and skip; without
arguments it renews the table of docs/measured/unchanged.md.
"""

import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from harness import Scene, engines
from harness.accuracy.refinement import run_to_accuracy
from harness.engines.base import Engine
from harness.model import SKIPS, Run, RunOptions
from harness.questions.bench.bench_run import difference
from tests.measures.pages import renew, table
from tests.measures.seeded_scenes import random_scene

FIRST_SEED: Final = 30_000
SCENES: Final[Mapping[str, int]] = {"analytic": 100, "pymunk": 100, "pybullet": 100}
"""Scenes by engine."""
STEP_S: Final = 1e-3
REFERENCE_STEP_SHARE: Final = 0.25
"""Step of the run that tells how far the engine's own error goes where a skip parts two runs, over theirs, and"""
PARTED_RAD: Final = 1e-5
"""from what difference on it is asked."""
OUTCOME_ONLY: Final = frozenset({"no_history"})
"""Skips that apply where no history is asked: outcome and peak are compared."""
HEAD: Final = (
    "engine",
    "skip",
    "same bits",
    "nine in ten, rad",
    "largest, rad (seed)",
    "own error there",
    "other outcome",
)


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
            options = RunOptions(history=skip not in OUTCOME_ONLY, skips=frozenset(SKIPS) - {skip})
            on, off = with_all[options.history], _run(engine, scene, options)
            apart, own = difference(on, off), None
            if apart > PARTED_RAD and not engine.capabilities.certifies:
                own = difference(off, _run(engine, scene, options, REFERENCE_STEP_SHARE * STEP_S))
            yield Effect(engine.name, skip, seed, apart, own, (on.outcome.value, off.outcome.value))


def _run(engine: Engine, scene: Scene, options: RunOptions, dt_s: float = STEP_S) -> Run:
    if engine.capabilities.certifies:
        return run_to_accuracy(engine, scene, 1e-3, options)
    return engine.simulate(scene, engine.settings_for_dt(scene, dt_s), options)


def cells(of_skip: Sequence[Effect]) -> list[str]:
    """A row of the table from one skip's effects on all scenes."""
    apart = np.array([item.apart_rad for item in of_skip])
    worst = of_skip[int(np.argmax(apart))]
    own = "" if worst.own_rad is None else f"{worst.own_rad:.1e}"
    changed = [str(item.seed) for item in of_skip if item.outcomes[0] != item.outcomes[1]]
    same, most = f"{int(np.sum(apart == 0.0))} of {apart.size}", f"{apart.max():.1e} ({worst.seed})"
    return [worst.engine, worst.skip, same, f"{np.percentile(apart, 90):.1e}", most, own, ", ".join(changed) or "none"]


def rows(name: str, seeds: Sequence[int]) -> list[list[str]]:
    """An engine's rows of the table."""
    every = list(effects(engines.load(name), seeds))
    return merged(
        [cells([item for item in every if item.skip == skip]) for skip in sorted({item.skip for item in every})]
    )


def merged(lines: Iterable[Sequence[str]]) -> list[list[str]]:
    """Rows of skips of which all else is the same as one."""
    names: dict[tuple[str, ...], list[str]] = {}
    for engine, skip, *said in lines:
        names.setdefault((engine, *said), []).append(skip)
    return [[engine, ", ".join(skips), *said] for (engine, *said), skips in names.items()]


def main(arguments: Sequence[str]) -> None:
    """Print the rows of the engines and seeds asked, or renew the page."""
    if not arguments:
        every = [row for name, count in SCENES.items() for row in rows(name, range(FIRST_SEED, FIRST_SEED + count))]
        renew("measured/unchanged.md", "tests.measures.unchanged", table(HEAD, every))
        return
    first, count = (int(item) for item in arguments[:2])
    for name in arguments[2:] or SCENES:
        sys.stdout.write(table(HEAD, rows(name, range(first, first + count))) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main(sys.argv[1:])
