"""The runs of a study: what names one, what a worker is handed, and what it gives back."""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from harness import engines
from harness.accuracy.simulation import DEFAULT_ACCURACY_RAD, simulate
from harness.campaign.batches import crashed
from harness.campaign.runner import Crash
from harness.engines.base import Engine
from harness.model import run as record
from harness.model.options import RunOptions
from harness.model.run import Run
from harness.model.scene import Scene
from harness.studies.cache_key import scene_digest
from harness.studies.cases import Base, Case
from harness.studies.file import StudyFile
from harness.studies.store import Packed, Store, packed


@dataclass(frozen=True)
class Job:
    """One run to compute: everything a worker on another machine needs."""

    key: str
    engine: str
    base: Base
    setting: tuple[tuple[str, Any], ...]
    accuracy_rad: float
    histories: bool
    pedestal: bool


@dataclass(frozen=True)
class Finished:
    """What a worker gives back: packed results, seconds spent on all, and for each run those spent outside its engine."""

    results: Sequence[Packed]
    failed: int
    busy_s: float
    outside_s: Sequence[float]


def compute(batch: Sequence[Job]) -> Finished:
    """What a worker does: resolve each scene, run it (a failure is a `Run` that says so), pack the result."""
    begin, failed, results, outside_s = time.perf_counter(), 0, [], []
    for job in batch:
        marks = [time.perf_counter()]
        scene = job.base.scene(dict(job.setting))
        marks.append(time.perf_counter())
        run = simulate(scene, job.engine, accuracy_rad=job.accuracy_rad, want=RunOptions(history=job.histories))
        marks.append(time.perf_counter())
        failed += run.outcome.failed
        results.append(packed(job.key, run, job.histories))
        outside_s.append(time.perf_counter() - marks[2] + marks[1] - marks[0])
    return Finished(results, failed, time.perf_counter() - begin, outside_s)


def lost(batch: Sequence[Job], crash: Crash) -> Finished:
    """What a batch gives whose process died: every run says so."""
    runs = crashed(batch, crash)
    return Finished([packed(job.key, run) for job, run in zip(batch, runs, strict=True)], len(runs), 0.0, ())


class Jobs:
    """Jobs of a study's cases; each scene is resolved once here, for the name of its result."""

    def __init__(self, study: StudyFile, base: Base) -> None:
        self._study, self._base = study, base
        self._loaded: dict[str, Engine] = {}
        self._scene: tuple[int, Scene] | None = None

    def of(self, case: Case, engine: str) -> Job:
        """The job of a case for an engine. Raises `InputError` for a case that is no scene."""
        if self._scene is None or self._scene[0] != case.number:
            self._scene = case.number, self._base.scene(case.setting)
        scene = self._scene[1]
        if engine not in self._loaded:
            self._loaded[engine] = engines.load(engine)
        accuracy = {str(name): value for name, value in self._study.accuracy.items()}.get(engine, DEFAULT_ACCURACY_RAD)
        histories = self._study.ask.histories
        digest = scene_digest(scene, self._loaded[engine].capabilities)
        key = run_key(self._loaded[engine], digest, accuracy, histories)
        setting = tuple(case.setting.items())
        return Job(key, engine, self._base, setting, accuracy, histories, scene.pedestal is not None)


def run_key(engine: Engine, digest: str, accuracy_rad: float, histories: bool) -> str:
    """The name of a result: scene, engine, settings, versions, and whether its history was asked."""
    versions = record.versions()
    mine = {name: versions.get(name) for name in ("rockcheck", "numpy", "numba", engine.name) if name in versions}
    text = json.dumps([digest, engine.name, accuracy_rad.hex(), histories, mine], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def stored_runs(store: Store, scene: Scene, accuracy_rad: float = DEFAULT_ACCURACY_RAD) -> dict[str, Run]:
    """The runs of a scene that a study has stored with their histories, by engine."""
    found = {}
    for name in engines.DEFAULT_ENGINES:
        engine = engines.load(name)
        run = store.run(run_key(engine, scene_digest(scene, engine.capabilities), accuracy_rad, True))
        if run is not None:
            found[name] = run
    return found
