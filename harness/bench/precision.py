"""Work against precision: every engine on every level, on its own defaults, on another project's settings, and what a target
takes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from importlib import import_module
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from harness import engines
from harness.accuracy.refinement import run_to_accuracy
from harness.bench.standard_scenes import Standard, standard_set
from harness.bench.timing import Cost, costs, timed
from harness.campaign.parts import Row
from harness.comparison.distance import error_rad
from harness.engines.base import Engine, EngineFailure, Settings
from harness.model.errors import InputError
from harness.model.options import RunOptions
from harness.model.run import Run
from harness.model.scene import Scene
from harness.records.bench import DEFAULT, LEVEL, OTHER_PROJECT, TARGET, PrecisionRow

Array = NDArray[np.float64]

TARGET_RAD: Final = 1e-3
LONG_S: Final = 1.0
"""A level is left out (and said so) when the one before it took this long: finer levels show the same line further."""
REPEATS: Final = 15
"""Turns in which levels are timed: after a long one caches are cold, and a short one needs more turns to show its least time."""
BUDGET_S: Final = 0.1
"""Processor time of one level after which no further turn is begun: what is compared are ratios of whole numbers and more."""


@dataclass(frozen=True)
class Default:
    """Settings that are not this project's: `label`, the module that runs them, and what its `EngineDefaults` take."""

    engine: str
    group: str
    label: str
    module: str
    given: Mapping[str, Any]


NOTHING: Final = Cost(0.0, 0.0, 0)
"""Of what was not run."""
BULLET: Final = "harness.bench.pybullet_defaults"
MUNK: Final = "harness.bench.pymunk_defaults"
DEFAULTS: Final = (
    Default("pybullet", DEFAULT, "own defaults, 1/240 s", BULLET, {}),
    Default("pybullet", DEFAULT, "own defaults, 0.25 ms", BULLET, {"dt_s": 2.5e-4}),
    Default("pybullet", DEFAULT, "damping 0, hull at its own margin, 0.25 ms", BULLET, {"dt_s": 2.5e-4, "damping": 0.0}),
    Default(
        "pybullet", DEFAULT, "damping 0, hull at margin 0, 0.25 ms", BULLET,
        {"dt_s": 2.5e-4, "damping": 0.0, "margin_m": 0.0, "breaking_m": 1e-4},
    ),
    Default(
        "pybullet", OTHER_PROJECT, "virtual_shake_robot_pybullet: 1 ms, stiffness 1e5, damping 1", BULLET,
        {"dt_s": 1e-3, "iterations": 150, "stiffness_n_m": 1e5, "contact_damping": 1.0, "rolls": True},
    ),
    Default("pymunk", DEFAULT, "own defaults, 1/240 s", MUNK, {}),
    Default("pymunk", DEFAULT, "own defaults, 0.25 ms", MUNK, {"dt_s": 2.5e-4}),
)  # fmt: skip
"""The other project is github.com/ZhiangChen/virtual_shake_robot_pybullet, its published engine and contact parameters."""


def tasks(quick: bool) -> list[str]:
    """The scenes of the standard set, the longest first."""
    names = [item.name for item in standard_set()]
    return names[:3] if quick else sorted(names, key=lambda name: "Maria" not in name)


def of(quick: bool, name: str) -> list[Row]:
    """All rows of one scene of the standard set; one that says why where a file of it is absent."""
    item = next(item for item in standard_set() if item.name == name)
    try:
        scene = item.scene()
    except InputError as error:
        return [{"scene": name, "absent": str(error)}]
    return [asdict(row) for row in rows_of(item, scene, list(engines.REGISTRY), quick=quick)]


def died(name: str) -> list[Row]:
    """A scene whose process died: one row that says so."""
    return [asdict(PrecisionRow("any", name, LEVEL, "all", failed="the process died"))]


def rows_of(item: Standard, scene: Scene, names: Sequence[str], *, quick: bool) -> Iterator[PrecisionRow]:
    """All rows of one scene: each engine's levels, what the target takes, the engine's own defaults."""
    model = engines.load("analytic")
    exact = model.simulate(scene, model.refinement_levels(scene)[-1], RunOptions())
    for name in names:
        engine = engines.load(name)
        if item.spatial and engine.capabilities.dimensions < 3:
            continue
        base = PrecisionRow(name, item.name, LEVEL, "not here", item.block)
        reason = engine.missing()
        if reason is not None:
            yield replace(base, failed=reason)
            continue
        # A self-certifying model has no finer settings of another kind to be judged by than its own finest.
        own = item.reference == "own" or engine.capabilities.certifies
        yield from _levels(base, scene, engine, None if own else exact, quick)
        if item.reference == "analytic":
            yield from _defaults(base, scene, exact)


def _levels(base: PrecisionRow, scene: Scene, engine: Engine, exact: Run | None, quick: bool) -> Iterator[PrecisionRow]:
    """Every level and what the target takes: errors first, then all of them timed in turns, as they are compared."""
    base = replace(base, reference="analytic" if exact is not None else "own finest level")
    tried = _tried(engine, scene, quick)
    good = [(settings, run, once) for settings, run, once in tried if isinstance(run, Run)]
    judge = exact or (good[-1][1] if good else None)
    asked, once = (
        (None, NOTHING) if judge is None or engine.capabilities.certifies else timed(partial(_asked, engine, scene))
    )
    works: list[Callable[[], object]] = [
        partial(engine.simulate, scene, settings, RunOptions()) for settings, _, _ in good
    ]
    before = [item[2] for item in good]
    if isinstance(asked, Run):
        works.append(partial(run_to_accuracy, engine, scene, TARGET_RAD, RunOptions()))
        before.append(once)
    spent = iter(costs(works, REPEATS, BUDGET_S, before))
    for settings, run, _ in tried:
        row = replace(base, label=_label(settings), dt_s=settings.dt_s)
        if isinstance(run, str) or judge is None:
            yield replace(row, failed=str(run))
            continue
        took = next(spent)
        if run is not judge:
            yield _costing(_with(row, run, error_rad(run, judge)), took, run.end_s)
    if asked is not None and judge is not None:
        yield _chosen(replace(base, group=TARGET, label=f"--accuracy {TARGET_RAD:g}"), asked, judge, next(spent, None))


def _tried(engine: Engine, scene: Scene, quick: bool) -> list[tuple[Settings, Run | str, Cost]]:
    """Each level's run, whose error is taken, or why there is none, and its cost."""
    tried: list[tuple[Settings, Run | str, Cost]] = []
    levels = engine.refinement_levels(scene)[: 3 if quick else None]
    for settings in levels:
        if tried and isinstance(tried[-1][1], Run) and tried[-1][2].cpu_s > LONG_S:
            left_out = f"not run: the level before it took {LONG_S:g} s of processor time or more"
            return [*tried, *((finer, left_out, NOTHING) for finer in levels[len(tried) :])]
        tried.append((settings, *timed(partial(_run, engine, scene, settings))))
    return tried


def _run(engine: Engine, scene: Scene, settings: Settings) -> Run | str:
    try:
        run = engine.simulate(scene, settings, RunOptions())
    except EngineFailure as failure:
        return str(failure)
    return (run.message or run.outcome.sentence) if run.outcome.failed or run.history is None else run


def _asked(engine: Engine, scene: Scene) -> Run | str:
    """What the target accuracy gives, or why it gives nothing."""
    try:
        return run_to_accuracy(engine, scene, TARGET_RAD, RunOptions())
    except EngineFailure as failure:
        return str(failure)


def _chosen(row: PrecisionRow, run: Run | str, judge: Run, spent: Cost | None) -> PrecisionRow:
    """What the target accuracy takes, its own checks included."""
    if isinstance(run, Run) and run.settings == judge.settings:
        run = "it goes on to the very level by which errors are judged here"
    if isinstance(run, str) or spent is None:
        return replace(row, failed=str(run))
    error = error_rad(run, judge, run.bounded_until_s)
    row = _costing(_with(row, run, error), spent, run.end_s)
    label = f"{row.label}: {run.work.get('runs', 1)} runs, the finest {_label(run.settings)}"
    steps = run.work.get("steps_of_all_runs", run.steps)
    return replace(
        row, label=label, dt_s=run.settings["dt_s"], chosen=True, reliable_until_s=run.reliable_until_s, steps=steps
    )


def _defaults(base: PrecisionRow, scene: Scene, exact: Run) -> Iterator[PrecisionRow]:
    for default in DEFAULTS:
        if default.engine != base.engine:
            continue
        module = import_module(default.module)
        settings = module.EngineDefaults(**default.given)
        (t_s, theta), once = timed(partial(module.run, scene, settings))
        spent = costs([partial(module.run, scene, settings)], REPEATS, BUDGET_S, [once])[0]
        error = largest(t_s, theta, exact)
        finite = bool(np.isfinite(error))
        row = replace(
            base, group=default.group, label=default.label, dt_s=settings.dt_s, steps=t_s.size - 1,
            error_rad=error if finite else None, failed=None if finite else "its numbers diverged",
        )  # fmt: skip
        yield _costing(row, spent, scene.duration_s)


def _with(row: PrecisionRow, run: Run, error: float) -> PrecisionRow:
    """A row with a run's work, its statement and its error."""
    return replace(
        row, error_rad=error, steps=run.steps, iterations=run.settings.get("iterations"),
        stated_rad=run.numerical_uncertainty_rad,
    )  # fmt: skip


def _costing(row: PrecisionRow, spent: Cost, simulated_s: float) -> PrecisionRow:
    """A row with what it took to simulate so long."""
    factor = simulated_s / spent.cpu_s
    return replace(row, wall_s=spent.wall_s, cpu_s=spent.cpu_s, repeats=spent.repeats, real_time_factor=factor)


def largest(t_s: Array, theta_rad: Array, exact: Run) -> float:
    """Largest difference of samples from the exact rotation, rad; infinite where a sample is not finite."""
    if exact.history is None or not np.all(np.isfinite(theta_rad)):
        return float("inf")
    inside = t_s <= exact.end_s
    return float(np.max(np.abs(theta_rad[: t_s.size][inside] - exact.history.at(t_s[inside]))))


def _label(settings: Settings | Mapping[str, Any]) -> str:
    """A level in words."""
    plain = settings.as_dict() if isinstance(settings, Settings) else settings
    if "accuracy_rad" in plain:
        return f"aimed at {plain['accuracy_rad']:g} rad"
    parts = [f"{1e3 * float(plain['dt_s']):g} ms"]
    parts += [f"{plain['iterations']} iterations"] if "iterations" in plain else []
    return ", ".join(parts)
