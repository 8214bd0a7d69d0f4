"""One scene, several models, one comparison.

>>> import harness
>>> scene = harness.load_scene("scenes/paestum_floor.toml").replace(motion__x__amplitude_g=0.3)
>>> run = harness.simulate(scene, "pymunk", accuracy_rad=1e-3)
>>> reference = harness.simulate(scene, "analytic")
>>> print(harness.compare(run, reference).verdict)

`scene(mapping)` makes a scene without a file, `scene.with_motion(accel_m_s2, dt_s)` shakes it by one's own array, `sweep` runs
it many times into a table, `execute` any list of runs, kept in a file; `assess` says how probable a fall is, `read_mesh` what a
scan weighs, `History.from_arrays` takes one's own history to `compare`.

Scenes, runs, histories, scores and studies show themselves in a notebook, and have `to_dataframe()`, `to_xarray()` (extra
[frames]) and `plot(ax)`; docs/example.ipynb uses them all.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from harness.accuracy.refinement import simulate
    from harness.comparison.comparator import compare, compare_files
    from harness.input.history_file import read_history
    from harness.input.mesh_statue import Mesh, read_mesh
    from harness.input.scene_file import load_scene, scene
    from harness.model import History, InputError, Mistake, Outcome, Run, RunOptions, RunSet, Scene
    from harness.questions.assess.assessment import assess
    from harness.questions.scene.scene_run import run_scene
    from harness.questions.study.study_run import sweep
    from harness.records.base import read_result
    from harness.records.run import RunRecord
    from harness.records.scores import Scores, Verdict
    from harness.records.study import StudyRecord
    from harness.runs.execute import execute
    from harness.runs.task import RunRequest

_NAMES: Final = {
    "harness.accuracy.refinement": "simulate",
    "harness.comparison.comparator": "compare compare_files",
    "harness.input.history_file": "read_history",
    "harness.input.mesh_statue": "Mesh read_mesh",
    "harness.input.scene_file": "load_scene scene",
    "harness.model": "History InputError Mistake Outcome Run RunOptions RunSet Scene",
    "harness.questions.assess.assessment": "assess",
    "harness.records.base": "read_result",
    "harness.records.run": "RunRecord",
    "harness.records.scores": "Scores Verdict",
    "harness.records.study": "StudyRecord",
    "harness.questions.scene.scene_run": "run_scene",
    "harness.runs.execute": "execute",
    "harness.runs.task": "RunRequest",
    "harness.questions.study.study_run": "sweep",
}
"""The public names by their modules."""
_HOMES: Final = {name: module for module, names in _NAMES.items() for name in names.split()}
__all__ = [
    "History", "InputError", "Mesh", "Mistake", "Outcome", "Run", "RunOptions", "RunRecord", "RunRequest", "RunSet",
    "Scene", "Scores", "StudyRecord", "Verdict", "assess", "compare", "compare_files", "execute", "load_scene", "read_history",
    "read_mesh", "read_result", "run_scene", "scene", "simulate", "sweep",
]  # fmt: skip


def __getattr__(name: str) -> object:
    """Load a public name from its module, when first asked: `rockcheck --help` does not pay for a simulator."""
    if name not in _HOMES:
        raise AttributeError(f"module 'harness' has no attribute {name!r}")
    globals()[name] = value = getattr(import_module(_HOMES[name]), name)
    return value


def __dir__() -> list[str]:
    """The public names, loaded or not, and none of what this file imports."""
    return sorted({*(name for name in globals() if name.startswith("__")), *__all__})
