"""The stability map: every engine, setting by difficulty, each cell's category computed with its evidence."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from importlib import import_module
from typing import Any, Final

import numpy as np

from harness import engines
from harness.benchmark.precision import INSTANTS, largest
from harness.benchmark.scenes import COLUMN, PAESTUM, PEDESTAL, harmonic, scene_of
from harness.engine import Engine, EngineFailure, Want
from harness.parts import Row
from harness.record import Run
from harness.scene import Scene
from harness.stresses import checks
from harness.stresses.catalogue import body, leaning
from harness.stresses.explained import INACCURATE_RAD, Cell, explained

STEPS_S: Final = (1.0 / 60.0, 1.0 / 240.0, 1e-3, 2.5e-4, 1e-4, 1e-5)
NONE: Final = Want(skips=frozenset())
FINEST_SHARE: Final = 0.3
"""Share of a scene's duration that is run with the finest step: what grows with small steps shows at once."""


@dataclass(frozen=True)
class Difficulty:
    """One row of a map: down to steps of `finest_s`, the finest run for a share of the time (a pedestal is dear in 3D)."""

    name: str
    content: Mapping[str, Any]
    finest_s: float = STEPS_S[-1]
    at_rest: bool = False


def difficulties() -> tuple[Difficulty, ...]:
    """The rows from easy to hard."""
    pushed = {"duration_s": 1.0, "statue": PAESTUM, "motion": harmonic(0.429, 3.0)}
    equal = {"floor_static": 0.15, "floor_kinetic": 0.15}
    stand = {"pedestal": PEDESTAL, "contact": equal}
    light = {"pedestal": {**PEDESTAL, "mass_kg": 0.707}, "contact": equal}
    return (
        Difficulty("at rest", {"duration_s": 2.0, "statue": COLUMN}, at_rest=True),
        Difficulty("free rocking", leaning(COLUMN, 0.5, 1.0)),
        Difficulty("slenderness 50", leaning(body(0.02, 1.0), 0.5, 1.0)),
        Difficulty("harmonic, 0.429 g, 3 Hz", pushed),
        Difficulty("harmonic, on a pedestal", {**pushed, **stand}, finest_s=1e-4),
        Difficulty("pedestal of a thousandth of the mass", {**pushed, **light}, finest_s=1e-4),
        Difficulty("5 g at 100 Hz", {"duration_s": 0.5, "statue": COLUMN, "motion": harmonic(5.0, 100.0)}),
    )


ENGINES: Final = ("pybullet", "pymunk", "analytic")


def tasks(quick: bool) -> list[str]:
    """A row of each engine's map: the difficulty by each engine, the longest first."""
    rows = difficulties()[1:2] if quick else difficulties()
    return [f"{engine}: {row.name}" for engine in ENGINES for row in sorted(rows, key=lambda row: -row.finest_s)]


def compute(quick: bool, task: str) -> list[Row]:
    """The cells of one row of one map; none where the engine is not here."""
    name, _, words = task.partition(": ")
    engine = engines.load(name)
    if engine.missing() is not None:
        return []
    row = next(item for item in difficulties() if item.name == words)
    scene = scene_of(row.name, row.content)
    reference = engines.load("analytic")
    exact = reference.simulate(scene, reference.ladder(scene)[-1], Want())
    tightest = partial(_tightest, row, scene, engine, exact)
    found = list(explained(list(_cells_of(row, scene, engine, exact, quick)), tightest))
    if name == "pybullet":
        found += _hulls(row, scene, exact)
    return [cell.as_dict() for cell in found]


def died(task: str) -> list[Row]:
    """A row whose process died: one cell, diverged and not explained."""
    name, _, words = task.partition(": ")
    return [Cell(name, "any", words, "diverged", "the engine's process died").as_dict()]


def _cells_of(row: Difficulty, scene: Scene, engine: Engine, exact: Run, quick: bool) -> Iterator[Cell]:
    if engine.capabilities.certifies:
        for settings in engine.ladder(scene):
            run = engine.simulate(scene, settings, Want())
            label = f"aimed at {settings.expected_error_rad:g} rad"
            yield _judged(Cell(engine.name, label, row.name, "", ""), scene, run, exact, row)
        return
    for step_s in STEPS_S[1:3] if quick else STEPS_S:
        if step_s < row.finest_s:
            continue
        short = step_s == row.finest_s
        shorter = scene.but(duration_s=FINEST_SHARE * scene.duration_s) if short else scene
        cell = Cell(engine.name, _step(step_s), row.name, "", "", short=short)
        try:
            run = engine.simulate(shorter, engine.settings_for_dt(shorter, step_s), NONE)
        except EngineFailure as failure:
            yield replace(cell, category="diverged", evidence=str(failure))
            continue
        yield _judged(cell, shorter, run, exact, row)


def _tightest(row: Difficulty, scene: Scene, engine: Engine, exact: Run) -> Cell:
    """The engine's finest rung over the first part of a scene."""
    shorter = scene.but(duration_s=FINEST_SHARE * scene.duration_s)
    rung = engine.ladder(shorter)[-1]
    cell = Cell(engine.name, f"the finest rung ({_step(rung.dt_s)})", row.name, "", "", short=True)
    return _judged(cell, shorter, engine.simulate(shorter, rung, NONE), exact, row)


def _judged(cell: Cell, scene: Scene, run: Run, exact: Run, row: Difficulty) -> Cell:
    category, evidence = judge(scene, run, exact, row.at_rest)
    gained = float(run.validity.get("energy_gained_j") or 0.0)
    part = f"over the first {scene.duration_s:g} s only: " if cell.short else ""
    found = replace(cell, category=category, evidence=part + evidence, gained_j=gained)
    if run.history is None:
        return found
    early_s = run.end_s if cell.short else FINEST_SHARE * scene.duration_s
    return replace(found, error_rad=_error(run, exact), early_rad=_error(run, exact, early_s))


def judge(scene: Scene, run: Run, exact: Run, at_rest: bool) -> tuple[str, str]:
    """Category and evidence of one run against the exact solution."""
    if run.outcome.failed or run.history is None or exact.history is None:
        return "diverged", run.message or run.outcome.sentence
    if at_rest:
        found = checks.creep(scene, run)
        return ("stable" if found.holds else "drifting"), found.sentence
    gained = checks.energy(scene, run)
    error = _error(run, exact)
    if not math.isfinite(error):
        return "diverged", "its numbers are not finite"
    evidence = f"error {error:.1e} rad; {gained.sentence}"
    if error > INACCURATE_RAD:
        return "inaccurate", evidence
    return ("stable" if gained.holds else "drifting"), evidence


def _error(run: Run, exact: Run, until_s: float = math.inf) -> float:
    """Largest difference from the exact rotation, rad, while that holds and the model is inside its domain."""
    if run.history is None or exact.history is None or not np.all(np.isfinite(run.history.theta_rad)):
        return math.inf
    times = np.linspace(0.0, min(run.end_s, _valid_until_s(exact), until_s), INSTANTS)
    return float(np.max(np.abs(run.history.at(times) - exact.history.at(times))))


def _valid_until_s(exact: Run) -> float:
    until = exact.reliable_until_s if exact.reliable_until_s is not None else exact.end_s
    left = exact.validity.get("left_domain_s")
    return min(until, exact.end_s, exact.end_s if left is None else float(left))


HULLS: Final = (
    ("hull, own margin, 0.25 ms", {"dt_s": 2.5e-4, "damping": 0.0}),
    ("hull, margin 0, 0.25 ms", {"dt_s": 2.5e-4, "damping": 0.0, "margin_m": 0.0, "breaking_m": 1e-4}),
)
"""pybullet's known failure, and the setting that avoids it on the floor."""


def _hulls(row: Difficulty, scene: Scene, exact: Run) -> Iterator[Cell]:
    """pybullet's own hull, which this project does not use: with its default collision margin and without one."""
    module = import_module("harness.engines.bullet.stock")
    errors = []
    for _, given in HULLS:
        t_s, theta = module.run(scene, module.Stock(**given))
        errors.append(largest(t_s[t_s <= _valid_until_s(exact)], theta, exact))
    for (label, _), error in zip(HULLS, errors, strict=True):
        finite = math.isfinite(error)
        category = "diverged" if not finite else "inaccurate" if error > INACCURATE_RAD else "stable"
        why = ""
        if category != "stable":
            why = f"a convex hull's contact points wander (margin {errors[0]:.1e} rad, margin 0 {errors[1]:.1e} rad): "
            why += "rockcheck stands the statue on spheres at its base's vertices instead"
        yield Cell("pybullet", label, row.name, category, f"error {error:.1e} rad", why)


def _step(step_s: float) -> str:
    return f"1/{round(1.0 / step_s)} s" if step_s > 2e-3 else f"{1e3 * step_s:g} ms"
