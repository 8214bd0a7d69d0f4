"""The runs of a validation: which are wanted, what names them, and what a worker does."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple, dataclass
from functools import partial
from typing import Final

from harness import engines
from harness.accuracy.simulation import DEFAULT_ACCURACY_RAD, check_target
from harness.model import run as record
from harness.model.errors import InputError, Mistake
from harness.questions.validate.scenes import Variant, digest_of, motion_of, scene_of
from harness.questions.validate.table import Trial
from harness.runs.cache_key import key_of
from harness.runs.task import RunRequest, Task, lost_answer, run_request

BATCH: Final = {"analytic": 32, "pymunk": 8}
"""Runs handed to a worker at a time: enough that sending them costs little beside computing them; of other engines"""
BATCH_OTHERWISE: Final = 2


@dataclass(frozen=True)
class Model:
    """An engine with one setting; `name` is how the user wrote it (`pymunk`, `pymunk@accuracy=1e-4`, `pybullet@dt=5e-4`,
    `spatial@near=analytic`: asked only where draws of the model `near` disagree).
    """

    name: str
    engine: str
    accuracy_rad: float | None
    dt_s: float | None
    near: str = ""


def parse_model(text: str) -> Model:
    """A model as written on the command line. Raises `InputError`."""
    engine, _, setting = text.partition("@")
    engines.load(engine)
    name, _, value = setting.partition("=")
    if not setting or (name == "near" and value):
        return Model(text, engine, DEFAULT_ACCURACY_RAD, None, value)
    try:
        number = float(value)
    except ValueError:
        number = float("nan")
    if name not in ("accuracy", "dt") or number != number:
        wanted = "ENGINE, ENGINE@accuracy=RAD, ENGINE@dt=S or ENGINE@near=MODEL"
        raise InputError(Mistake("--engine", "", wanted, repr(text)))
    accuracy, step = (number, None) if name == "accuracy" else (None, number)
    check_target(accuracy, step)
    return Model(text, engine, accuracy, step)


def tasks_of(pairs: Sequence[tuple[Trial, Variant]], model: Model, seed: int) -> list[Task]:
    """The runs of variants of tests, each keyed by all that decides its answer.

    A draw is counted, not judged: its own error changes an outcome only near the boundary, where draws fall either way. So are
    runs for a fit. Only a nominal run of the chosen inputs states its error.
    """
    versions = [record.versions().get(name) for name in ("rockcheck", "numpy", "numba", model.engine)]
    digests = {name: digest_of(trial) for name, trial in {trial.name: trial for trial, _ in pairs}.items()}
    tasks = []
    for trial, variant in pairs:
        # A history is wanted where a measured one is there to compare, in the nominal run.
        history = variant.stated and trial.history is not None
        drawn = (variant.sample, seed, variant.width) if variant.sample else None
        setting = model.engine, model.accuracy_rad, model.dt_s, variant.stated, history
        key = key_of(digests[trial.name], astuple(variant.inputs), drawn, setting, versions)
        # The motion is read once, for all processes.
        made = partial(scene_of, trial, variant, seed, motion_of(trial, variant.inputs))
        run = RunRequest(made, model.engine, model.accuracy_rad, model.dt_s, history, variant.stated)
        tasks.append(Task(key, run_request, run, model.engine, lost_answer))
    return tasks
