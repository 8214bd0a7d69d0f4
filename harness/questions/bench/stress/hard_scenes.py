"""Run the catalogue: what each engine says of each hard scene, and what the checks found."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Final

from harness import engines
from harness.accuracy.refinement import run_to_accuracy
from harness.engines.base import Engine, EngineFailure, Settings
from harness.model.run import SKIPS, Run, RunOptions, number
from harness.model.scene import Scene
from harness.questions.bench.standard_scenes import scene_of
from harness.questions.bench.stress import checks
from harness.questions.bench.stress.catalogue import Hard, catalogue
from harness.records.bench import HardRow, KnownFailure, Measure, StabilityCell

# Why a cell of a stability map is not stable: the setting of the same row that is, or nothing.

ITERATIONS: Final = 3000
"""Solver iterations a step: ten times those of the finest levels, which leaves a bench scene's error to the step alone."""
IMPACT_ITERATIONS: Final = 9000
RESIDUAL: Final = 1e-16
"""Squared change of velocity, (m/s)², at which a solver that watches it may end before."""
MANY: Final = {
    "iterations": ITERATIONS, "turning_iterations": ITERATIONS, "impact_iterations": IMPACT_ITERATIONS,
    "event_iterations": IMPACT_ITERATIONS, "residual": RESIDUAL,
}  # fmt: skip
"""By the name of a field of settings; an engine has some of them."""


def explained(
    row: Sequence[StabilityCell], converged: Callable[[], StabilityCell | None] = lambda: None
) -> Iterator[StabilityCell]:
    """The cells of one row, from coarse to fine; those that are not stable with the setting that is, where one is known.

    A cell is explained by a whole run with a finer step that is stable. Where there is none, `converged` computes the row with
    far more iterations a step: that cell follows the others, and explains those before it when it is stable.
    """
    finer = [next((each for each in row[k + 1 :] if _explains(each)), None) for k in range(len(row))]
    left = [cell for cell, by in zip(row, finer, strict=True) if cell.category != "stable" and by is None]
    last = converged() if left else None
    for cell, by in zip(row, finer, strict=True):
        if cell.category != "stable" and by is not None:
            yield cell.avoided("step", by)
        elif cell.category != "stable" and last is not None and _explains(last):
            yield cell.avoided("iterations", last)
        else:
            yield cell
    if last is not None:
        yield last


def _explains(cell: StabilityCell) -> bool:
    return cell.category == "stable" and not cell.short


def converged(settings: Settings) -> Settings:
    """The same settings with as many iterations as converge. Raises `ValueError` where the engine counts none."""
    known = settings.as_dict()
    if "iterations" not in known:
        raise ValueError(f"{type(settings).__name__} has no iterations")
    changes = {name: value for name, value in MANY.items() if name in known}
    return replace(settings, **changes)


QUICK: Final = ("released 1e-3 rad below balance", "height to width 50", "floor friction 5")


def simulate(engine: Engine, scene: Scene, dt_s: float, skips: bool) -> Run:
    """One run with a fixed step (a certifying model chooses its own). Raises `EngineFailure`."""
    options = RunOptions(skips=frozenset(SKIPS) if skips else frozenset())
    if engine.capabilities.certifies:
        return run_to_accuracy(engine, scene, 1e-3, options)
    return engine.simulate(scene, engine.settings_for_dt(scene, dt_s), options)


def tasks(quick: bool) -> list[str]:
    """The hard scenes by name, the longest first."""
    return [hard.name for hard in catalogue() if not quick or hard.name in QUICK]


def compute(task: str) -> list[HardRow]:
    """The row of one hard scene."""
    return [row_of(next(hard for hard in catalogue() if hard.name == task))]


def died(task: str) -> list[HardRow]:
    """The row of a hard scene that took its process with it."""
    return [HardRow(task, "", {"*": "crashed"}, holds=False)]


def row_of(hard: Hard) -> HardRow:
    """A hard scene by every engine that it names and that is here."""
    scene = scene_of(hard.name, hard.content)
    exact = solution(scene) if hard.exact else None
    got: dict[str, str] = {}
    measured: dict[str, list[Measure]] = {}
    known: dict[str, KnownFailure] = {}
    for name in hard.engines:
        engine = engines.load(name)
        if engine.missing() is not None:
            continue
        try:
            run = simulate(engine, scene, hard.dt_s, hard.skips)
        except EngineFailure as failure:
            got[name] = str(failure)
            continue
        got[name], measured[name] = run.outcome.value, judged(hard, scene, run, exact)
        if hard.converged_s is not None and not checks.all_hold(measured[name]):
            avoided = _converged(engine, scene, hard, exact, hard.converged_s)
            known |= {} if avoided is None else {name: avoided}
    row = HardRow(hard.name, hard.wanted, got, True, measured, hard.note, known)
    return replace(row, holds=bool(got) and all(row.right(name) for name in got))


def solution(scene: Scene) -> Run:
    """The analytic solution on its finest level, with nothing left out."""
    engine = engines.load("analytic")
    return engine.simulate(scene, engine.refinement_levels(scene)[-1], RunOptions(skips=frozenset()))


def judged(hard: Hard, scene: Scene, run: Run, exact: Run | None, share: float = 1.0) -> list[Measure]:
    """What the checks of a hard scene measure in a run of `share` of its time."""
    found = [checks.creep(scene, run, share) if check is checks.creep else check(scene, run) for check in hard.checks]
    found += [] if exact is None else [checks.agrees(scene, run, exact)]
    return [each for of_check in found for each in of_check]


def _converged(engine: Engine, scene: Scene, hard: Hard, exact: Run | None, converged_s: float) -> KnownFailure | None:
    """What avoids a failure: the same step with far more iterations, where every check then holds."""
    shorter = replace(scene, duration_s=converged_s)
    settings = converged(engine.settings_for_dt(shorter, hard.dt_s))
    run = engine.simulate(shorter, settings, RunOptions(skips=frozenset()))
    measured = judged(hard, shorter, run, exact, shorter.duration_s / scene.duration_s)
    if run.outcome.value != hard.wanted or not checks.all_hold(measured):
        return None
    return KnownFailure(hard.dt_s, round(number(settings.as_dict(), "iterations")), shorter.duration_s, measured)
