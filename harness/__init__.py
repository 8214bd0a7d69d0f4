"""One scene, several models, one comparison.

>>> import harness
>>> scene = harness.load_scene("scenes/paestum_floor.toml")
>>> run = harness.simulate(scene, "pymunk", accuracy_rad=1e-3)
>>> reference = harness.simulate(scene, "analytic")
>>> print(harness.compare(run, reference).verdict_sentence)
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from harness.accuracy.simulation import simulate
    from harness.comparison.comparator import compare
    from harness.input.scene_file import load_scene
    from harness.model.errors import InputError, Mistake
    from harness.model.history import History, Outcome
    from harness.model.run import Run
    from harness.model.scene import Scene
    from harness.scene_run.scene_run import run_scene

__all__ = [
    "History",
    "InputError",
    "Mistake",
    "Outcome",
    "Run",
    "Scene",
    "compare",
    "load_scene",
    "run_scene",
    "simulate",
]

_HOMES = {
    "compare": "harness.comparison.comparator",
    "InputError": "harness.model.errors",
    "Mistake": "harness.model.errors",
    "History": "harness.model.history",
    "Outcome": "harness.model.history",
    "load_scene": "harness.input.scene_file",
    "Run": "harness.model.run",
    "run_scene": "harness.scene_run.scene_run",
    "simulate": "harness.accuracy.simulation",
    "Scene": "harness.model.scene",
}


def __getattr__(name: str) -> Any:
    # Loaded on demand: `rockcheck --help` does not pay for a simulator.
    if name not in _HOMES:
        raise AttributeError(f"module 'harness' has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_HOMES[name]), name)
