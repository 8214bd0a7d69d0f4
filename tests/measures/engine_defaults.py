"""Engines on their own defaults, and on another project's settings: what stands beside the bench's and the stress run's rows.

`python -m tests.measures.engine_defaults` prints each setting's error and processor time on the bench's standard scenes, then the
errors, rad, of pybullet's own hull on the rows of the stability map.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from importlib import import_module
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from harness import Run, RunOptions, Scene, engines
from harness.questions.bench.bench_run import BUDGET_S, REPEATS, costing
from harness.questions.bench.parts import costs, timed
from harness.questions.bench.standard_scenes import Standard, resolved, scene_of, standard_set
from harness.questions.bench.stress_run import difficulties, holds_until_s, solution
from harness.records.bench import PrecisionRow

Array = NDArray[np.float64]


HULLS: Final = (
    ("hull, own margin, 0.25 ms", {"dt_s": 2.5e-4, "damping": 0.0}),
    ("hull, margin 0, 0.25 ms", {"dt_s": 2.5e-4, "damping": 0.0, "margin_m": 0.0, "breaking_m": 1e-4}),
)
"""pybullet's known failure, and the setting that avoids it on the floor."""


@dataclass(frozen=True)
class Default:
    """Settings that are not this project's: `label`, the module that runs them, and what its `EngineDefaults` take."""

    engine: str
    label: str
    module: str
    given: Mapping[str, Any]


BULLET: Final = "tests.measures.pybullet_defaults"
MUNK: Final = "tests.measures.pymunk_defaults"
DEFAULTS: Final = (
    Default("pybullet", "own defaults, 1/240 s", BULLET, {}),
    Default("pybullet", "own defaults, 0.25 ms", BULLET, {"dt_s": 2.5e-4}),
    Default("pybullet", "damping 0, hull at its own margin, 0.25 ms", BULLET, {"dt_s": 2.5e-4, "damping": 0.0}),
    Default(
        "pybullet", "damping 0, hull at margin 0, 0.25 ms", BULLET,
        {"dt_s": 2.5e-4, "damping": 0.0, "margin_m": 0.0, "breaking_m": 1e-4},
    ),
    Default(
        "pybullet", "virtual_shake_robot_pybullet: 1 ms, stiffness 1e5, damping 1", BULLET,
        {"dt_s": 1e-3, "iterations": 150, "stiffness_n_m": 1e5, "contact_damping": 1.0, "rolls": True},
    ),
    Default("pymunk", "own defaults, 1/240 s", MUNK, {}),
    Default("pymunk", "own defaults, 0.25 ms", MUNK, {"dt_s": 2.5e-4}),
)  # fmt: skip
"""The other project is github.com/ZhiangChen/virtual_shake_robot_pybullet, its published engine and contact parameters."""


def rows_of(item: Standard, scene: Scene) -> Iterator[PrecisionRow]:
    """A row for each setting of each engine that is here and asked of the scene."""
    model = engines.load("analytic")
    exact = model.simulate(scene, model.refinement_levels(scene)[-1], RunOptions())
    for name in dict.fromkeys(default.engine for default in DEFAULTS):
        engine = engines.load(name)
        if engine.missing() is None and not (item.spatial and engine.capabilities.dimensions < 3):
            yield from _defaults(PrecisionRow(name, item.name, "", item.block), scene, exact)


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
            base, label=default.label, dt_s=settings.dt_s, steps=t_s.size - 1,
            error_rad=error if finite else None, failed=None if finite else "its numbers diverged",
        )  # fmt: skip
        yield costing(row, spent, scene.duration_s)


def largest(t_s: Array, theta_rad: Array, exact: Run) -> float:
    """Largest difference of samples from the exact rotation, rad; infinite where a sample is not finite."""
    if exact.history is None or not np.all(np.isfinite(theta_rad)):
        return float("inf")
    inside = t_s <= exact.end_s
    return float(np.max(np.abs(theta_rad[: t_s.size][inside] - exact.history.at(t_s[inside]))))


def hull_errors(difficulty: str) -> dict[str, float]:
    """Largest error, rad, of each setting of `HULLS` while the exact solution holds (infinite where a number is not finite)."""
    bullet = import_module(BULLET)
    row = next(item for item in difficulties() if item.name == difficulty)
    scene = scene_of(row.name, row.content)
    exact, errors = solution(scene), dict[str, float]()
    for label, given in HULLS:
        t_s, theta = bullet.run(scene, bullet.EngineDefaults(**given))
        errors[label] = largest(t_s[t_s <= holds_until_s(exact)], theta, exact)
    return errors


def main() -> None:
    """Print them all."""
    for item, scene in resolved(standard_set())[0]:
        for row in rows_of(item, scene) if item.reference == "analytic" else ():
            error = row.failed or f"{row.error_rad:.2g} rad"
            print(f"{item.name}: {row.engine}, {row.label}: {error} in {row.cpu_s:.2g} s", flush=True)
    if engines.load("pybullet").missing() is None:
        for difficulty in difficulties():
            print(f"{difficulty.name}: {hull_errors(difficulty.name)}", flush=True)


if __name__ == "__main__":
    main()
