"""What the pybullet tests share: runs of both engines on one scene, and their distance."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from harness.engines import load
from harness.engines.pybullet.settings import BulletSettings
from harness.model.run import SKIPS, Run, RunOptions
from harness.model.scene import Scene

NOTHING_SKIPPED = RunOptions(skips=frozenset())
WHOLE = RunOptions(skips=frozenset(SKIPS) - {"mirror"})
"""All of a scene in three dimensions, also of one that is its own mirror image."""


@cache
def _engine(name: str) -> Any:
    return load(name)


def bullet(scene: Scene, dt_s: float = 2.5e-4, options: RunOptions | None = None, **changes: Any) -> Run:
    """pybullet on a scene with the level of `dt_s`, or a variation of it."""
    engine = _engine("pybullet")
    settings = engine.settings_for_dt(scene, dt_s)
    assert isinstance(settings, BulletSettings)
    run: Run = engine.simulate(scene, replace(settings, **changes), options or RunOptions())
    return run


def exact(scene: Scene) -> Run:
    """The analytic model on a scene, finest."""
    engine = _engine("analytic")
    run: Run = engine.simulate(scene, engine.refinement_levels(scene)[-1], RunOptions())
    return run


def apart(a: Run, b: Run, column: str = "theta_rad", until_s: float = np.inf) -> float:
    """Largest difference of a column of two runs at their common times."""
    count = min(a.history.t_s.size, b.history.t_s.size)
    early = a.history.t_s[:count] <= until_s
    np.testing.assert_allclose(a.history.t_s[:count][early], b.history.t_s[:count][early], rtol=1e-12)
    difference = a.history.columns()[column][:count] - b.history.columns()[column][:count]
    return float(np.max(np.abs(difference[early])))


def worst(run: Run, column: str) -> float:
    """Largest change of a column from its start."""
    values = run.history.columns()[column]
    return float(np.max(np.abs(values - values[0])))
