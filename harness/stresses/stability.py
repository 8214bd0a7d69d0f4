"""The stability map: every engine, setting by difficulty, each cell's category computed with its evidence."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from typing import Any, Final

import numpy as np

from harness import engines
from harness.benchmark.precision import INSTANTS
from harness.benchmark.scenes import COLUMN, PAESTUM, PEDESTAL, harmonic, scene_of
from harness.engine import Engine, EngineFailure, Want
from harness.parts import Row
from harness.record import Run
from harness.scene import Scene
from harness.stresses import checks
from harness.stresses.catalogue import body, leaning

STEPS_S: Final = (1.0 / 60.0, 1.0 / 240.0, 1e-3, 2.5e-4, 1e-4, 1e-5)
FINEST_SHARE: Final = 0.3
"""Share of a scene's duration that is run with the finest step: what grows with small steps shows at once."""
INACCURATE_RAD: Final = 1e-3
"""Error above which a cell counts as inaccurate: the accuracy that a run aims at unless told otherwise."""
SHRINKS: Final = 0.8
"""A quantity falls with the step when the next step leaves less than this share of it."""


@dataclass(frozen=True)
class Difficulty:
    """One row of a map: `finest` also with the finest step (a pedestal makes that a minute's work in 3D)."""

    name: str
    content: Mapping[str, Any]
    finest: bool = True
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
        Difficulty("harmonic, on a pedestal", {**pushed, **stand}, finest=False),
        Difficulty("pedestal of a thousandth of the mass", {**pushed, **light}, finest=False),
        Difficulty("5 g at 100 Hz", {"duration_s": 0.5, "statue": COLUMN, "motion": harmonic(5.0, 100.0)}),
    )


@dataclass(frozen=True)
class Cell:
    """One cell: `category` (stable, inaccurate, drifting, diverged), the numbers that say so, and what it is owed to."""

    engine: str
    setting: str
    difficulty: str
    category: str
    evidence: str
    explained: str = ""
    error_rad: float | None = None
    gained_j: float = 0.0

    def as_dict(self) -> dict[str, Any]:
        """Plain values."""
        return dict(vars(self))


ENGINES: Final = ("pybullet", "pymunk", "analytic")


def tasks(quick: bool) -> list[str]:
    """A row of each engine's map: the difficulty by each engine, the longest first."""
    rows = difficulties()[1:2] if quick else difficulties()
    return [f"{engine}: {row.name}" for engine in ENGINES for row in sorted(rows, key=lambda row: row.finest)]


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
    found = list(explained(list(_cells_of(row, scene, engine, exact, quick))))
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
        finest = step_s == STEPS_S[-1]
        if finest and not row.finest:
            continue
        shorter = scene.but(duration_s=FINEST_SHARE * scene.duration_s) if finest else scene
        try:
            run = engine.simulate(shorter, engine.settings_for_dt(shorter, step_s), Want(skips=frozenset()))
        except EngineFailure as failure:
            yield Cell(engine.name, _step(step_s), row.name, "diverged", str(failure))
            continue
        yield _judged(Cell(engine.name, _step(step_s), row.name, "", ""), shorter, run, exact, row)


def _judged(cell: Cell, scene: Scene, run: Run, exact: Run, row: Difficulty) -> Cell:
    category, evidence = judge(scene, run, exact, row.at_rest)
    error = None if run.history is None else _error(run.history.t_s, run.history.theta_rad, exact)
    gained = float(run.validity.get("energy_gained_j") or 0.0)
    return replace(cell, category=category, evidence=evidence, error_rad=error, gained_j=gained)


def judge(scene: Scene, run: Run, exact: Run, at_rest: bool) -> tuple[str, str]:
    """Category and evidence of one run against the exact solution."""
    if run.outcome.failed or run.history is None or exact.history is None:
        return "diverged", run.message or run.outcome.sentence
    if at_rest:
        found = checks.creep(scene, run)
        return ("stable" if found.holds else "drifting"), found.sentence
    gained = checks.energy(scene, run)
    error = _error(run.history.t_s, run.history.theta_rad, exact)
    if not math.isfinite(error):
        return "diverged", "its numbers are not finite"
    evidence = f"error {error:.1e} rad; {gained.sentence}"
    if error > INACCURATE_RAD:
        return "inaccurate", evidence
    return ("stable" if gained.holds else "drifting"), evidence


def _error(t_s: Any, theta_rad: Any, exact: Run) -> float:
    """Largest difference from the exact rotation, rad, while that holds and the model is inside its domain."""
    if exact.history is None or not np.all(np.isfinite(theta_rad)):
        return math.inf
    times = np.linspace(0.0, min(t_s[-1], _valid_until_s(exact)), INSTANTS)
    return float(np.max(np.abs(np.interp(times, t_s, theta_rad) - exact.history.at(times))))


def _valid_until_s(exact: Run) -> float:
    until = exact.reliable_until_s if exact.reliable_until_s is not None else exact.end_s
    left = exact.validity.get("left_domain_s")
    return min(until, exact.end_s, exact.end_s if left is None else float(left))


def explained(row: Sequence[Cell]) -> Iterator[Cell]:
    """The row with what its cells that are not stable owe it to: the step, when a finer one of the same row is stable."""
    for index, cell in enumerate(row):
        finer = [other for other in row[index + 1 :] if other.category == "stable"]
        near = [o for o in row[index + 1 :] if o.error_rad is not None and o.error_rad <= INACCURATE_RAD]
        if cell.category == "stable":
            yield cell
        elif finer:
            yield replace(cell, explained=f"the step is too long for this scene: {finer[0].setting} is stable")
        elif near and cell.category == "inaccurate":
            why = f"the step is too long for this scene: at {near[0].setting} the error is {near[0].error_rad:.1e} rad"
            yield replace(cell, explained=why)
        else:
            yield replace(cell, explained=_converging(cell, row[:index]))


def _converging(cell: Cell, coarser: Sequence[Cell]) -> str:
    """No finer setting is stable: whether what is wrong falls with the step, so that the step alone owes it."""
    before = [other for other in coarser if other.category != "diverged"]
    if not before or cell.category == "diverged":
        return ""
    last = before[-1]
    if cell.category == "drifting" and cell.gained_j < SHRINKS * last.gained_j:
        return (
            f"the solver ends each step unconverged; the energy added falls with the step, from {last.gained_j:.1e} J at "
            f"{last.setting} to {cell.gained_j:.1e} J, the error is {cell.error_rad or 0.0:.1e} rad"
        )
    if last.error_rad and cell.error_rad is not None and cell.error_rad < SHRINKS * last.error_rad:
        return f"the error falls with the step, from {last.error_rad:.1e} rad at {last.setting}: a finer one is wanted"
    return ""


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
        errors.append(_error(t_s, theta, exact))
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
