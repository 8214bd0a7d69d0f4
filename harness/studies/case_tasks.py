"""The runs of a study: what names one, and what a worker does."""

from __future__ import annotations

import time
from dataclasses import dataclass

from harness import engines
from harness.accuracy.simulation import DEFAULT_ACCURACY_RAD, simulate
from harness.engines.base import Engine
from harness.model import run as record
from harness.model.options import RunOptions
from harness.model.run import Run
from harness.model.scene import Scene
from harness.runs.cache_key import key_of, scene_key
from harness.runs.store import Store
from harness.runs.task import Answer, Task, answer_of, lost_answer
from harness.studies.cases import Base, Case
from harness.studies.file import StudyFile, Value


@dataclass(frozen=True)
class CaseRun:
    """One case by one engine: everything that a worker on another machine needs."""

    engine: str
    base: Base
    setting: tuple[tuple[str, Value], ...]
    accuracy_rad: float
    histories: bool


def run_case(case: CaseRun) -> Answer:
    """Resolve the scene and run it (a failure is a `Run` that says so); overhead is what `simulate` does not take."""
    scene = case.base.scene(dict(case.setting))
    begin = time.perf_counter()
    run = simulate(scene, case.engine, accuracy_rad=case.accuracy_rad, options=RunOptions(history=case.histories))
    return answer_of(run, case.histories, time.perf_counter() - begin)


class CaseTasks:
    """Tasks of a study's cases; each scene is resolved once here, for the name of its result."""

    def __init__(self, study: StudyFile, base: Base) -> None:
        self._study, self._base = study, base
        self._loaded: dict[str, Engine] = {}
        self._scene: tuple[int, Scene] | None = None

    def of(self, case: Case, engine: str) -> Task:
        """The task of a case for an engine. Raises `InputError` for a case that is no scene."""
        if self._scene is None or self._scene[0] != case.number:
            self._scene = case.number, self._base.scene(case.setting)
        scene = self._scene[1]
        if engine not in self._loaded:
            self._loaded[engine] = engines.load(engine)
        accuracy = self._study.asked_rad.get(engine, DEFAULT_ACCURACY_RAD)
        histories = self._study.ask.histories
        key = run_key(self._loaded[engine], scene, accuracy, histories)
        setting = tuple(case.setting.items())
        run = CaseRun(engine, self._base, setting, accuracy, histories)
        return Task(key, run_case, run, engine, lost_answer)


def run_key(engine: Engine, scene: Scene, accuracy_rad: float, histories: bool) -> str:
    """The name of a result: scene, engine, settings, versions, and whether its history was asked."""
    versions = record.versions()
    mine = {name: versions.get(name) for name in ("rockcheck", "numpy", "numba", engine.name) if name in versions}
    physics = scene_key(scene, engine.capabilities)
    return key_of(physics, engine.name, accuracy_rad.hex(), histories, mine)


def stored_runs(store: Store, scene: Scene, accuracy_rad: float = DEFAULT_ACCURACY_RAD) -> dict[str, Run]:
    """The runs of a scene that a study has stored with their histories, by engine."""
    loaded = {name: engines.load(name) for name in engines.DEFAULT_ENGINES}
    runs = {name: store.run(run_key(engine, scene, accuracy_rad, True)) for name, engine in loaded.items()}
    return {name: run for name, run in runs.items() if run is not None}
