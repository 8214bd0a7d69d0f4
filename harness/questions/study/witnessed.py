"""A seeded tenth of a study's scenes with a witness: do the unmodified engines confirm the answers of the others?"""

from __future__ import annotations

import math
import random
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from harness import engines
from harness.accuracy.simulation import DEFAULT_ACCURACY_RAD, simulate
from harness.engines.base import EngineFailure
from harness.engines.stepping.plain_steps import refuse_steering
from harness.model.run import RunOptions, to_plain, versions
from harness.model.scene import Scene
from harness.questions.scene.witness import findings_of, plain_names, witnesses
from harness.questions.study.cases import BaseScene, base_of, expand
from harness.questions.study.file import StudyFile, Value
from harness.questions.study.study_run import study_name
from harness.records.base import part
from harness.records.run import PLAIN, Witness
from harness.records.study import StudyWitness, WitnessCount
from harness.runs.execute import Campaign, OnProgress, silent
from harness.runs.runner import Pool
from harness.runs.store import Store
from harness.runs.task import RUN, Task, TaskResult, key_of

SHARE: Final = 0.1
"""Of the scenes: the run is made again and a witness costs as much at most, so a tenth of them adds a fifth or less."""
KIND: Final = "witness"
"""Kind of its results in a store."""
JUDGED: Final = "analytic"
"""Its answers are held against the plain engines, too: they cost nothing."""


@dataclass(frozen=True)
class Witnessed:
    """One scene of a study and the accuracy of each engine whose answer is judged: everything that a worker needs."""

    base: BaseScene
    setting: tuple[tuple[str, Value], ...]
    accuracy_rad: Mapping[str, float]


def witness_scene(asked: Witnessed) -> TaskResult:
    """Run the engines again, with their histories, and what the plain ones say of them; by plain engine."""
    begin = time.perf_counter()
    scene = asked.base.scene(dict(asked.setting))
    runs = {name: simulate(scene, name, accuracy_rad=target) for name, target in asked.accuracy_rad.items()}
    plain = {name: to_plain(item) for name, item in witnesses(scene, runs, RunOptions()).items()}
    return TaskResult(KIND, plain, time.perf_counter() - begin)


def witness_study(
    study: StudyFile, path: Path, store: Store, pool: Pool, on_progress: OnProgress = silent
) -> StudyWitness | None:
    """What the plain engines say of a tenth of the scenes of a study that was run, drawn with its seed; None: no engine has one.

    What the store holds is not computed again.
    """
    begin = time.perf_counter()
    judged = _answered(store, study)
    base = base_of(study, path)
    cases = (case for case in expand(study, base) if case.number in judged) if judged else ()
    settings = {case.number: case.setting for case in cases if _computable(base.scene(case.setting))}
    chosen = drawn(list(settings), study.seed)
    if not chosen:
        return None
    tasks = {}
    for number in chosen:
        targets = {name: study.asked_rad.get(name, DEFAULT_ACCURACY_RAD) for name in judged[number]}
        asked = Witnessed(base, tuple(settings[number].items()), targets)
        tasks[number] = Task(key_of(KIND, judged[number], versions()), witness_scene, asked, KIND)
    records = Campaign(store, pool, on_progress).ask(list(tasks.values()))
    said = {
        number: {name: part(Witness, item, store.path) for name, item in record.items()}
        for number, record in zip(tasks, records, strict=True)
        if record is not None
    }
    return _counted(said, len(settings), time.perf_counter() - begin)


def drawn(numbers: Sequence[int], seed: int) -> list[int]:
    """A seeded tenth of the cases, at least one of any: the same in every call."""
    return sorted(random.Random(f"witness {seed}").sample(sorted(numbers), math.ceil(SHARE * len(numbers))))


def _computable(scene: Scene) -> bool:
    """Whether unmodified engines take a scene at all."""
    try:
        refuse_steering(scene, "")
    except EngineFailure:
        return False
    return True


def _answered(store: Store, study: StudyFile) -> dict[int, dict[str, str]]:
    """By the first case of each distinct scene that an engine with a plain one has answered: keys of its results by engine."""
    by_number: dict[int, dict[str, str]] = {}
    for row in store.rows(study_name(study)):
        judged = row.engine == JUDGED or row.engine + PLAIN in engines.REGISTRY
        if not judged or row.key is None or row.kind != RUN or row.run is None:
            continue
        if row.run["reliable_until_s"] != 0.0:
            by_number.setdefault(row.number, {})[row.engine] = row.key
    first: dict[tuple[tuple[str, str], ...], int] = {}
    for number, keys in by_number.items():
        if plain_names(list(keys)):
            first.setdefault(tuple(sorted(keys.items())), number)
    return {number: by_number[number] for number in sorted(first.values())}


def _counted(said: Mapping[int, Mapping[str, Witness]], scenes: int, seconds: float) -> StudyWitness:
    counts, differing = {}, []
    for name in sorted({name for answers in said.values() for name in answers}):
        mine = {number: answers[name] for number, answers in said.items() if name in answers}
        own = [item.runs.get(name.removesuffix(PLAIN)) for item in mine.values()]
        counts[name] = WitnessCount(
            confirmed=sum(item.agrees is True for item in mine.values()),
            differ=sum(each is not None and not each.agrees for each in own),
            silent=sum(item.agrees is None for item in mine.values()),
        )
        for number, item in mine.items():
            parts = [found for found in findings_of({name: item}) if found.code == "witness_parts"]
            differing += [replace(found, values={**found.values, "case": number}) for found in parts]
    return StudyWitness(scenes=len(said), of=scenes, counts=counts, differing=differing, seconds=seconds)
