"""Run the catalogue: what each engine says of each hard scene, and what the checks found."""

from __future__ import annotations

from typing import Final

from harness import engines
from harness.benchmark.scenes import scene_of
from harness.engine import SKIPS, Engine, EngineFailure, Want
from harness.parts import Row
from harness.record import Run
from harness.scene import Scene
from harness.stresses.catalogue import ENDS, Hard, catalogue
from harness.uncertainty import run_to_accuracy

QUICK: Final = ("released 1e-3 rad below balance", "height to width 50", "floor friction 5")


def simulate(engine: Engine, scene: Scene, dt_s: float, skips: bool) -> Run:
    """One run with a fixed step (a certifying model chooses its own). Raises `EngineFailure`."""
    want = Want(skips=frozenset(SKIPS) if skips else frozenset())
    if engine.capabilities.certifies:
        return run_to_accuracy(engine, scene, 1e-3, want)
    return engine.simulate(scene, engine.settings_for_dt(scene, dt_s), want)


def tasks(quick: bool) -> list[str]:
    """The hard scenes by name, the longest first."""
    named = [hard.name for hard in catalogue()]
    return [name for name in named if not quick or name in QUICK]


def compute(task: str) -> list[Row]:
    """The row of one hard scene."""
    return [row_of(next(hard for hard in catalogue() if hard.name == task))]


def died(task: str) -> list[Row]:
    """The row of a hard scene that took its process with it."""
    return [{"name": task, "wanted": "", "got": {"*": "the process died"}, "holds": False, "checks": [], "note": ""}]


def row_of(hard: Hard) -> Row:
    """A hard scene by every engine that it names and that is here."""
    scene = scene_of(hard.name, hard.content)
    got: dict[str, str] = {}
    found: list[str] = []
    holds = True
    for name in hard.engines:
        engine = engines.load(name)
        if engine.missing() is not None:
            continue
        try:
            run = simulate(engine, scene, hard.dt_s, hard.skips)
        except EngineFailure as failure:
            got[name], holds = f"failed: {failure}", False
            continue
        findings = [check(scene, run) for check in hard.checks]
        bad = [item for item in findings if not item.holds]
        if bad and hard.finest_s is not None and _avoided(engine, scene, hard):
            said = "; ".join(item.sentence for item in bad)
            found.append(
                f"{name}: known: {said} at {hard.dt_s:g} s; avoided by its finest rung ({hard.finest_s:g} s run)"
            )
            bad = []
        outcome = run.outcome.value
        if hard.wanted == ENDS and not run.outcome.failed:
            found.append(f"{name}: {outcome}")
            outcome = ENDS
        got[name] = outcome if not bad else f"{outcome}, but {'; '.join(item.sentence for item in bad)}"
        found += [f"{name}: {item.sentence}" for item in findings if item.name != "finite"]
        holds &= got[name] == hard.wanted
    return {"name": hard.name, "wanted": hard.wanted, "got": got, "holds": holds, "checks": found, "note": hard.note}


def _avoided(engine: Engine, scene: Scene, hard: Hard) -> bool:
    """Whether every check holds with the engine's finest rung."""
    shorter = scene.but(duration_s=hard.finest_s)
    run = engine.simulate(shorter, engine.ladder(shorter)[-1], Want(skips=frozenset()))
    return not run.outcome.failed and all(check(shorter, run).holds for check in hard.checks)
