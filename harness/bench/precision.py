"""Work against precision: every engine and rung, the engines' own defaults, a peer's settings, and what a target takes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from harness import engines
from harness.accuracy.refinement import run_to_accuracy
from harness.bench.standard_scenes import Standard, standard_set
from harness.bench.timing import Cost, cost, costs
from harness.engines.base import Engine, EngineFailure, Settings
from harness.model.errors import InputError
from harness.model.options import RunOptions
from harness.model.run import Run
from harness.model.scene import Scene

Array = NDArray[np.float64]
Row = dict[str, Any]

INSTANTS: Final = 4000
"""Instants at which two histories are compared: the finest features, impacts, last longer than a thousandth of any scene."""
TARGET_RAD: Final = 1e-3
DEAR_S: Final = 4.0
"""A rung is left out (and said so) when the one before it took this long: finer rungs show the same line further."""


TURNS: Final = 15
"""Turns in which rungs are timed: after a long one caches are cold, and a short one needs more turns to show its least time."""


@dataclass(frozen=True)
class Rival:
    """Settings that are not this project's: `label`, the module that runs them, and what its `Stock` is given."""

    engine: str
    group: str
    label: str
    module: str
    given: Mapping[str, Any]


BULLET: Final = "harness.engines.pybullet.defaults"
MUNK: Final = "harness.engines.pymunk.defaults"
RIVALS: Final = (
    Rival("pybullet", "default", "own defaults, 1/240 s", BULLET, {}),
    Rival("pybullet", "default", "own defaults, 0.25 ms", BULLET, {"dt_s": 2.5e-4}),
    Rival("pybullet", "default", "damping 0, hull at its own margin, 0.25 ms", BULLET, {"dt_s": 2.5e-4, "damping": 0.0}),
    Rival(
        "pybullet", "default", "damping 0, hull at margin 0, 0.25 ms", BULLET,
        {"dt_s": 2.5e-4, "damping": 0.0, "margin_m": 0.0, "breaking_m": 1e-4},
    ),
    Rival(
        "pybullet", "peer", "virtual_shake_robot_pybullet: 1 ms, stiffness 1e5, damping 1", BULLET,
        {"dt_s": 1e-3, "iterations": 150, "stiffness_n_m": 1e5, "contact_damping": 1.0, "rolls": True},
    ),
    Rival("pymunk", "default", "own defaults, 1/240 s", MUNK, {}),
    Rival("pymunk", "default", "own defaults, 0.25 ms", MUNK, {"dt_s": 2.5e-4}),
)  # fmt: skip
"""The peer is github.com/ZhiangChen/virtual_shake_robot_pybullet, its published engine and contact parameters."""


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
    return list(rows_of(item, scene, list(engines.REGISTRY), quick=quick))


def died(name: str) -> list[Row]:
    """A scene whose process died: one row that says so."""
    item = next(item for item in standard_set() if item.name == name)
    return [_row(item, "any", "ladder", "all", failed="the process died")]


def rows_of(item: Standard, scene: Scene, names: Sequence[str], *, quick: bool) -> Iterator[Row]:
    """All rows of one scene: each engine's ladder, its rivals, what the target takes."""
    exact = engines.load("analytic").simulate(
        scene, engines.load("analytic").refinement_levels(scene)[-1], RunOptions()
    )
    for name in names:
        engine = engines.load(name)
        if item.spatial and engine.capabilities.dimensions < 3:
            continue
        reason = engine.missing()
        if reason is not None:
            yield _row(item, name, "ladder", "not here", failed=reason)
            continue
        # A self-certifying model has no finer settings of another kind to be judged by than its own finest.
        own = item.reference == "own" or engine.capabilities.certifies
        yield from _ladder(item, scene, engine, None if own else exact, quick)
        if not engine.capabilities.certifies:
            yield from _rivals(item, scene, name, exact if item.reference == "analytic" else None)


def _ladder(item: Standard, scene: Scene, engine: Engine, exact: Run | None, quick: bool) -> Iterator[Row]:
    """Every rung and what the target takes: errors first, then all of them timed in turns, as they are compared."""
    reference = "analytic" if exact is not None else "own finest rung"
    found = _computed(engine, scene, quick)
    good = [(settings, run) for settings, run in found if isinstance(run, Run)]
    judge = exact or (good[-1][1] if good else None)
    asked = None if judge is None or engine.capabilities.certifies else _asked(engine, scene)
    works: list[Callable[[], object]] = [
        partial(engine.simulate, scene, settings, RunOptions()) for settings, _ in good
    ]
    if isinstance(asked, Run):
        works.append(partial(run_to_accuracy, engine, scene, TARGET_RAD, RunOptions()))
    spent = iter(costs(works, repeats=TURNS))
    for settings, run in found:
        label = _label(settings)
        if isinstance(run, str) or judge is None:
            yield _row(item, engine.name, "ladder", label, dt_s=settings.dt_s, failed=str(run), reference=reference)
            continue
        took = next(spent)
        if run is judge:
            continue
        yield _row(
            item, engine.name, "ladder", label,
            dt_s=settings.dt_s, error_rad=error(run, judge), spent=took, run=run, reference=reference, scene=scene,
        )  # fmt: skip
    if asked is not None and judge is not None:
        yield _chosen(item, scene, engine.name, judge, reference, asked, next(spent, None))


def _computed(engine: Engine, scene: Scene, quick: bool) -> list[tuple[Settings, Run | str]]:
    """Each rung's run, whose error is taken, or why there is none."""
    found: list[tuple[Settings, Run | str]] = []
    levels = engine.refinement_levels(scene)
    for settings in levels[:3] if quick else levels:
        before = found[-1][1] if found else None
        dear = isinstance(before, Run) and before.wall_s > DEAR_S
        told = f"not run: the rung before it took {DEAR_S:g} s or more"
        found.append((settings, told if dear else _run(engine, scene, settings)))
        if dear:
            found += [(coming, told) for coming in levels[len(found) :]]
            break
    return found


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


def _chosen(
    item: Standard, scene: Scene, engine: str, judge: Run, reference: str, run: Run | str, spent: Cost | None
) -> Row:
    """What the target accuracy takes, its own checks included."""
    short = f"--accuracy {TARGET_RAD:g}"
    if isinstance(run, Run) and run.settings == judge.settings:
        run = "it goes on to the very rung by which errors are judged here"
    if isinstance(run, str):
        return _row(item, engine, "accuracy", short, failed=run, reference=reference)
    until = run.reliable_until_s
    row = _row(
        item, engine, "accuracy", f"{short}: {run.work.get('runs', 1)} runs, the finest {_label(run.settings)}",
        dt_s=float(run.settings["dt_s"]), error_rad=error(run, judge, until), spent=spent, run=run,
        reference=reference, scene=scene,
    )  # fmt: skip
    return row | {
        "chosen": True,
        "reliable_until_s": until,
        "steps": run.work.get("steps_of_all_runs", run.steps),
    }


def _rivals(item: Standard, scene: Scene, name: str, exact: Run | None) -> Iterator[Row]:
    if exact is None:
        return
    for rival in RIVALS:
        if rival.engine != name:
            continue
        module = import_module(rival.module)
        settings = module.Stock(**rival.given)
        t_s, theta = module.run(scene, settings)
        spent = cost(partial(module.run, scene, settings))
        row = _row(item, name, rival.group, rival.label, dt_s=settings.dt_s, spent=spent, scene=scene)
        apart = largest(t_s, theta, exact)
        if not np.isfinite(apart):
            row |= {"failed": "its numbers diverged"}
        yield row | {"error_rad": apart if np.isfinite(apart) else None, "steps": t_s.size - 1}


def largest(t_s: Array, theta_rad: Array, exact: Run) -> float:
    """Largest difference of samples from the exact rotation, rad; infinite where a sample is not finite."""
    if exact.history is None or not np.all(np.isfinite(theta_rad)):
        return float("inf")
    inside = t_s <= exact.end_s
    return float(np.max(np.abs(theta_rad[: t_s.size][inside] - exact.history.at(t_s[inside]))))


def error(run: Run, judge: Run, until_s: float | None = None) -> float:
    """Largest difference of two rotations, rad, up to the earlier end (or `until_s`); infinite without histories."""
    if run.history is None or judge.history is None:
        return float("inf")
    end = min(run.end_s, judge.end_s, run.end_s if until_s is None else until_s)
    times = np.linspace(0.0, end, INSTANTS)
    return float(np.max(np.abs(run.history.at(times) - judge.history.at(times))))


def _label(settings: Settings | Mapping[str, Any]) -> str:
    """A rung in words."""
    plain = settings.as_dict() if isinstance(settings, Settings) else settings
    if "accuracy_rad" in plain:
        return f"aimed at {plain['accuracy_rad']:g} rad"
    parts = [f"{1e3 * float(plain['dt_s']):g} ms"]
    parts += [f"{plain['iterations']} iterations"] if "iterations" in plain else []
    return ", ".join(parts)


def _row(
    item: Standard,
    engine: str,
    group: str,
    label: str,
    *,
    scene: Scene | None = None,
    dt_s: float | None = None,
    error_rad: float | None = None,
    spent: Cost | None = None,
    run: Run | None = None,
    reference: str = "analytic",
    failed: str | None = None,
) -> Row:
    factor = None if spent is None or scene is None else _simulated_s(scene, run) / spent.cpu_s
    return {
        "engine": engine,
        "scene": item.name,
        "block": item.block,
        "group": group,
        "label": label,
        "dt_s": dt_s,
        "error_rad": error_rad,
        "wall_s": None if spent is None else spent.wall_s,
        "cpu_s": None if spent is None else spent.cpu_s,
        "repeats": None if spent is None else spent.repeats,
        "steps": None if run is None else run.steps,
        "iterations": None if run is None else run.settings.get("iterations"),
        "real_time_factor": factor,
        "reference": reference,
        "chosen": False,
        "stated_rad": None if run is None else run.numerical_uncertainty_rad,
        "failed": failed,
    }


def _simulated_s(scene: Scene, run: Run | None) -> float:
    return scene.duration_s if run is None else run.end_s
