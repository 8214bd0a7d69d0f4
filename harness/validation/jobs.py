"""The runs of a validation: which are wanted, what names them, and what a worker does."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final

from harness import engines
from harness.accuracy.simulation import DEFAULT_ACCURACY_RAD, check_target, simulate
from harness.campaign.batches import batches, crashed, run_batches
from harness.campaign.runner import Crash, Pool
from harness.model import run as record
from harness.model.errors import InputError, Mistake
from harness.model.options import RunOptions
from harness.model.run import Run
from harness.studies.store import Store
from harness.validation.scenes import Variant, digest_of, scene_of, variants
from harness.validation.table import Trial

BATCH: Final = {"analytic": 32, "pymunk": 8}
"""Runs handed to a worker at a time: enough that sending them costs little beside computing them."""


@dataclass(frozen=True)
class Model:
    """An engine with one setting; `name` is how the user wrote it (`pymunk`, `pymunk@accuracy=1e-4`, `pybullet@dt=5e-4`)."""

    name: str
    engine: str
    accuracy_rad: float | None
    dt_s: float | None


@dataclass(frozen=True)
class Job:
    """One run: everything that a worker needs to know."""

    key: str
    trial: Trial
    variant: Variant
    model: Model
    seed: int

    @property
    def engine(self) -> str:
        """The engine that answers."""
        return self.model.engine

    @property
    def history(self) -> bool:
        """Whether the history is wanted: where a measured one is there to compare, in the nominal run."""
        return self.trial.history is not None and self.variant.sample == 0


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


def jobs_of(trials: Sequence[Trial], models: Sequence[Model], samples: int, seed: int) -> list[Job]:
    """All runs wanted, those of one body and azimuth side by side."""
    found = []
    for model in models:
        versions = record.versions()
        mine = [versions.get(name) for name in ("rockcheck", "numpy", "numba", model.engine)]
        for trial in sorted(trials, key=lambda each: each.body):
            digest = digest_of(trial)
            for variant in variants(trial, samples):
                found.append(Job(_key(digest, trial, variant, model, seed, mine), trial, variant, model, seed))
    return found


def _key(digest: str, trial: Trial, variant: Variant, model: Model, seed: int, versions: Sequence[Any]) -> str:
    inputs = trial.azimuths_deg[variant.azimuth], trial.frictions[variant.friction], variant.sample
    drawn = seed if variant.sample else None
    setting = model.engine, model.accuracy_rad, model.dt_s, trial.history is not None and variant.sample == 0
    return hashlib.sha256(json.dumps([digest, inputs, drawn, setting, versions]).encode()).hexdigest()


def compute(store: Store, pool: Pool, jobs: Sequence[Job], told: Callable[[int, int], None]) -> int:
    """Run the jobs that the store does not hold; each result is stored as soon as it is there. Returns how many ran."""
    distinct = {job.key: job for job in jobs}
    known = store.known(distinct)
    left = [job for key, job in distinct.items() if key not in known]
    finished = 0

    def done(batch: Sequence[Job], results: list[Run] | Crash) -> None:
        nonlocal finished
        runs = crashed(batch, results) if isinstance(results, Crash) else results
        for job, run in zip(batch, runs, strict=True):
            store.put([(job.key, run)], histories=job.history)
        finished += len(batch)
        told(finished, len(left))

    if left:
        told(0, len(left))
        run_batches(pool, work, batches(left, BATCH, otherwise=2), done)
    return len(left)


def work(batch: Sequence[Job]) -> list[Run]:
    """What a worker does: make each scene and run it (a failure is a `Run` that says so)."""
    return [_one(job) for job in batch]


def _one(job: Job) -> Run:
    scene = scene_of(job.trial, job.variant, job.seed)
    want = RunOptions(history=job.history)
    return simulate(scene, job.model.engine, accuracy_rad=job.model.accuracy_rad, dt_s=job.model.dt_s, want=want)
