"""One scene, several models, one comparison.

>>> import harness
>>> scene = harness.load_scene("scenes/paestum_floor.toml", motion__x__amplitude_g=0.3)
>>> run = harness.simulate(scene, "pymunk", accuracy_rad=1e-3)
>>> reference = harness.simulate(scene, "analytic")
>>> print(harness.compare(run, reference).verdict_sentence)

Scenes, runs, histories, scores and studies show themselves in a notebook, and have `to_dataframe()`, `to_xarray()` (extra
[frames]) and `plot(ax)`; docs/example.ipynb uses them all.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from harness.accuracy.simulation import simulate as simulate
    from harness.comparison.comparator import compare as compare
    from harness.comparison.history_files import compare_files as compare_files
    from harness.input.history_file import read_history as read_history
    from harness.input.scene_file import load_scene as load_scene
    from harness.model.errors import InputError as InputError
    from harness.model.errors import Mistake as Mistake
    from harness.model.history import History as History
    from harness.model.history import Outcome as Outcome
    from harness.model.options import RunOptions as RunOptions
    from harness.model.run import Run as Run
    from harness.model.scene import Scene as Scene
    from harness.records.kinds import read_result as read_result
    from harness.records.run import RunRecord as RunRecord
    from harness.records.scores import Scores as Scores
    from harness.records.scores import Verdict as Verdict
    from harness.records.study import StudyRecord as StudyRecord
    from harness.scene_run.scene_run import run_scene as run_scene

_HOMES = {
    "compare": "harness.comparison.comparator",
    "compare_files": "harness.comparison.history_files",
    "History": "harness.model.history",
    "InputError": "harness.model.errors",
    "load_scene": "harness.input.scene_file",
    "Mistake": "harness.model.errors",
    "Outcome": "harness.model.history",
    "read_history": "harness.input.history_file",
    "read_result": "harness.records.kinds",
    "Run": "harness.model.run",
    "run_scene": "harness.scene_run.scene_run",
    "RunOptions": "harness.model.options",
    "RunRecord": "harness.records.run",
    "Scene": "harness.model.scene",
    "Scores": "harness.records.scores",
    "simulate": "harness.accuracy.simulation",
    "StudyRecord": "harness.records.study",
    "Verdict": "harness.records.scores",
}
__all__ = sorted(_HOMES)


def __getattr__(name: str) -> object:
    """Load a public name from its module, when first asked: `rockcheck --help` does not pay for a simulator."""
    if name not in _HOMES:
        raise AttributeError(f"module 'harness' has no attribute {name!r}")
    globals()[name] = value = getattr(import_module(_HOMES[name]), name)
    return value


def __dir__() -> list[str]:
    """The public names, loaded or not, and none of what this file imports."""
    return sorted({*(name for name in globals() if name.startswith("__")), *__all__})
