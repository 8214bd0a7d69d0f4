"""The runs of a validation: which are wanted, what names them, and what a worker does."""

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Final, NamedTuple

from pydantic import JsonValue

from harness import engines
from harness.accuracy.refinement import DEFAULT_ACCURACY_RAD, check_target, simulate
from harness.model import Outcome, RunOptions, grouped, require
from harness.model import run as record
from harness.questions.validate.scenes import SHIFT_M, TrialVariant, digest_of, motion_of, scene_of
from harness.questions.validate.table import Trial
from harness.records.study import CaseRun
from harness.runs.runner import Crash
from harness.runs.task import RunRequest, Task, TaskResult, key_of, lost_answer, lost_run, run_request

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
    wanted = "ENGINE, ENGINE@accuracy=RAD, ENGINE@dt=S or ENGINE@near=MODEL"
    require(name in ("accuracy", "dt") and number == number, "--engine", wanted, repr(text))
    accuracy, step = (number, None) if name == "accuracy" else (None, number)
    check_target(accuracy, step)
    return Model(text, engine, accuracy, step)


class Drawn(NamedTuple):
    """What is kept of a draw's run: a draw is counted, not judged."""

    outcome: Outcome
    peak_theta_rad: float


DRAWS: Final = "draws"
"""Kind of a result that is the draws of a test."""
TOGETHER: Final = {"analytic": 100}
"""Draws of one test that are one result; of other engines a single one: each takes longer than keeping it."""


@dataclass(frozen=True)
class TrialTask:
    """A task, and the variants of a test that it answers."""

    task: Task
    trial: Trial
    variants: Sequence[TrialVariant]

    def read(self, stored: Mapping[str, Any]) -> Iterator[tuple[tuple[str, TrialVariant], CaseRun | Drawn]]:
        """The answers, as they are stored."""
        runs: list[CaseRun | Drawn]
        if self.variants[0].stated:
            runs = [CaseRun.stored(stored)]
        else:
            ended = zip(stored["outcome"], stored["peak_theta_rad"], strict=True)
            runs = [Drawn(Outcome(outcome), peak) for outcome, peak in ended]
        return zip([(self.trial.name, variant) for variant in self.variants], runs, strict=True)


def asked_of(pairs: Sequence[tuple[Trial, TrialVariant]], model: Model, seed: int) -> list[TrialTask]:
    """The runs of variants of tests, each keyed by all that decides its answer.

    A draw's own error changes an outcome only near the boundary, where draws fall either way, and so does what is left out of its
    motion. Only a nominal run of the chosen inputs states its error.
    """
    versions = [record.versions().get(name) for name in ("rockcheck", "numpy", "numba", model.engine)]
    by_test = grouped(((trial.name, variant.stated), variant) for trial, variant in pairs)
    trials = {trial.name: trial for trial, _ in pairs}
    found = []
    for (name, stated), variants in by_test.items():
        trial, digest = trials[name], digest_of(trials[name])
        size = 1 if stated else TOGETHER.get(model.engine, 1)
        # A history is wanted where a measured one is there to compare, in the nominal run.
        history = stated and trial.history is not None
        setting = model.engine, model.accuracy_rad, model.dt_s, history, None if stated else SHIFT_M
        for start in range(0, len(variants), size):
            some = variants[start : start + size]
            key = key_of(digest, repr(some), None if stated else seed, setting, versions)
            # The motion is read once, for all processes.
            made = [
                partial(scene_of, trial, each, seed, motion_of(trial, each.inputs, fewer=not stated)) for each in some
            ]
            asked = model.engine, model.accuracy_rad, model.dt_s, history, stated
            runs = [RunRequest(each, *asked) for each in made]
            if stated:
                task = Task(key, run_request, runs[0], model.engine, lost_answer)
            else:
                # Draws that are together go to a worker by few, those alone by as many as nominal runs.
                group = f"{model.engine} draws" if size > 1 else model.engine
                task = Task(key, run_draws, runs, group, lost_draws, len(some))
            found.append(TrialTask(task, trial, some))
    return found


def run_draws(wanted: Sequence[RunRequest]) -> TaskResult:
    """Run each for its outcome and peak."""
    begin, inside_s, runs = time.perf_counter(), 0.0, []
    options = RunOptions(history=False, stated=False)
    for each in wanted:
        scene, start = each.made(), time.perf_counter()
        runs.append(simulate(scene, each.engine, accuracy_rad=each.accuracy_rad, dt_s=each.dt_s, options=options))
        inside_s += time.perf_counter() - start
    return _drawn(runs, time.perf_counter() - begin, inside_s)


def lost_draws(wanted: Sequence[RunRequest], crash: Crash) -> TaskResult:
    """The answer of draws whose worker died or hung."""
    return _drawn([lost_run(each.engine, crash) for each in wanted], 0.0, 0.0)


def _drawn(runs: Sequence[record.Run], seconds: float, inside_s: float) -> TaskResult:
    kept: dict[str, JsonValue] = {
        "outcome": [each.outcome.value for each in runs],
        "peak_theta_rad": [each.peak_theta_rad for each in runs],
    }
    return TaskResult(DRAWS, kept, seconds, inside_s=inside_s, failed=sum(each.outcome.failed for each in runs))
