"""The runs of a validation: which are wanted, what names them, and what a worker does."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Final

from harness import engines
from harness.accuracy.simulation import DEFAULT_ACCURACY_RAD, check_target
from harness.model import run as record
from harness.model.errors import InputError, Mistake
from harness.runs.cache_key import key_of
from harness.runs.task import RunRequest, Task, lost_answer, run_request
from harness.validation.scenes import INPUTS, Variant, digest_of, scene_of
from harness.validation.table import UNKNOWN, Trial

BATCH: Final = {"analytic": 32, "pymunk": 8}
"""Runs handed to a worker at a time: enough that sending them costs little beside computing them; of other engines"""
BATCH_OTHERWISE: Final = 2


@dataclass(frozen=True)
class Model:
    """An engine with one setting; `name` is how the user wrote it (`pymunk`, `pymunk@accuracy=1e-4`, `pybullet@dt=5e-4`)."""

    name: str
    engine: str
    accuracy_rad: float | None
    dt_s: float | None


def parse_model(text: str) -> Model:
    """A model as written on the command line. Raises `InputError`."""
    engine, _, setting = text.partition("@")
    engines.load(engine)
    if not setting:
        return Model(text, engine, DEFAULT_ACCURACY_RAD, None)
    name, _, value = setting.partition("=")
    try:
        number = float(value)
    except ValueError:
        number = float("nan")
    if name not in ("accuracy", "dt") or number != number:
        raise InputError(Mistake("--engine", "", "ENGINE, ENGINE@accuracy=RAD or ENGINE@dt=S", repr(text)))
    accuracy, step = (number, None) if name == "accuracy" else (None, number)
    check_target(accuracy, step)
    return Model(text, engine, accuracy, step)


def task_of(trial: Trial, variant: Variant, model: Model, seed: int, stated: bool) -> Task:
    """The run of one variant of a test, keyed by all that decides its answer.

    A draw is counted, not judged: its own error changes an outcome only near the boundary, where draws fall either way. So are
    runs for a fit. Only a nominal run of the chosen inputs states its error (`stated`).
    """
    stated = stated and not variant.sample
    # A history is wanted where a measured one is there to compare, in the nominal run.
    history = stated and trial.history is not None
    inputs = [getattr(trial, UNKNOWN[column])[getattr(variant, name)] for name, column in INPUTS.items()]
    drawn = (variant.sample, seed) if variant.sample else None
    setting = model.engine, model.accuracy_rad, model.dt_s, stated, history
    versions = [record.versions().get(name) for name in ("rockcheck", "numpy", "numba", model.engine)]
    made = partial(scene_of, trial, variant, seed)
    run = RunRequest(made, model.engine, model.accuracy_rad, model.dt_s, history, stated)
    return Task(key_of(digest_of(trial), inputs, drawn, setting, versions), run_request, run, model.engine, lost_answer)
