"""The engines as tests ask for them: here or skipped, run at a step, beside the model's finest run."""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

from harness import engines
from harness.engines.base import Engine
from harness.model import SKIPS, Run, RunOptions, Scene

NOTHING_SKIPPED = RunOptions(skips=frozenset())
WHOLE = RunOptions(skips=frozenset(SKIPS) - {"mirror"})
"""All of a scene in three dimensions, also of one that is its own mirror image."""


def ready(name: str) -> Engine:
    """The engine, or a skip that says why it cannot run here."""
    engine = engines.load(name)
    reason = engine.missing()
    if reason is not None:
        pytest.skip(reason)
    return engine


def run(name: str, on: Scene, dt_s: float = 2.5e-4, options: RunOptions | None = None, **changes: Any) -> Run:
    """An engine on a scene with the level of `dt_s`, or a variation of it."""
    engine = ready(name)
    return engine.simulate(on, replace(engine.settings_for_dt(on, dt_s), **changes), options or RunOptions())


bullet = partial(run, "pybullet")


def exact(on: Scene) -> Run:
    """The analytic model on a scene, finest."""
    engine = engines.load("analytic")
    return engine.simulate(on, engine.refinement_levels(on)[-1], RunOptions())


def apart(a: Run, b: Run, column: str = "theta_rad", until_s: float = np.inf) -> float:
    """Largest difference of a column of two runs at their common times."""
    count = min(a.history.t_s.size, b.history.t_s.size)
    early = a.history.t_s[:count] <= until_s
    np.testing.assert_allclose(a.history.t_s[:count][early], b.history.t_s[:count][early], rtol=1e-12)
    difference = a.history.columns()[column][:count] - b.history.columns()[column][:count]
    return float(np.max(np.abs(difference[early])))


def error(name: str, on: Scene, dt_s: float, options: RunOptions | None = None, **changes: Any) -> float:
    """Largest difference of an engine's rotation from the model's, rad, between samples of any step."""
    found, truth = run(name, on, dt_s, options, **changes), exact(on)
    times = np.linspace(0.0, min(found.end_s, truth.end_s), 500)
    return float(np.max(np.abs(found.history.at(times) - truth.history.at(times))))


def worst(run: Run, column: str) -> float:
    """Largest change of a column from its start."""
    values = run.history.columns()[column]
    return float(np.max(np.abs(values - values[0])))
