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
    from harness.comparator import compare
    from harness.errors import InputError, Mistake
    from harness.history import History, Outcome
    from harness.record import Run
    from harness.run import run_scene
    from harness.scene import Scene
    from harness.scene_file.load import load_scene
    from harness.simulation import simulate

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
    "compare": "harness.comparator",
    "InputError": "harness.errors",
    "Mistake": "harness.errors",
    "History": "harness.history",
    "Outcome": "harness.history",
    "load_scene": "harness.scene_file.load",
    "Run": "harness.record",
    "run_scene": "harness.run",
    "simulate": "harness.simulation",
    "Scene": "harness.scene",
}


def __getattr__(name: str) -> Any:
    # Loaded on demand: `rockcheck --help` does not pay for a simulator.
    if name not in _HOMES:
        raise AttributeError(f"module 'harness' has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_HOMES[name]), name)
