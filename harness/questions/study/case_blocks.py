"""Studies of very many cases by the analytic model alone: blocks of neighbouring cases, each run in two compiled sweeps."""

from __future__ import annotations

import json
import time
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np

from analytic.errors import AnalyticInputError
from analytic.excitation import SampledAcceleration
from harness import engines
from harness.accuracy.refinement import first_level
from harness.accuracy.simulation import DEFAULT_ACCURACY_RAD
from harness.engines import analytic as twoblock
from harness.engines.base import RELIABLE_RAD
from harness.model.run import to_plain
from harness.questions.study import case_selection as selection
from harness.questions.study.case_columns import Columns, Shaken, columns_of_record, swept, texts, varied_column
from harness.questions.study.case_scenes import CaseScenes
from harness.questions.study.cases import Base, expand
from harness.questions.study.file import StudyFile, Value
from harness.runs.cache_key import key_of
from harness.runs.task import Answer, RunRequest, Task, run_request

KIND: Final = "columns"
"""Kind of a result that is a block."""
LEAST_RUNS: Final = 2_000
"""From so many runs on a study's results stand in columns: a tenth of the bytes, two thirds of the processor time (of 2520
runs). Rows are shared between studies, and what is the same by its physics is computed once."""
BLOCK: Final = 16_384
"""Cases of a block: some seconds of work, a megabyte to send."""
MOST_SAMPLES: Final = 4_000_000
"""Samples of records that are run together, 64 MB of them."""


def in_columns(study: StudyFile, base: Base) -> bool:
    """Whether a study's results stand in columns: very many runs of the analytic model, for their outcomes alone."""
    own = {name for variant in study.variant for name in variant.engines} == {selection.REFERENCE}
    bare = study.ask.cases == "all" and not study.ask.histories and study.claims is None
    # A file that a case names is no part of its block's name, and what begins from a pose fails run by run.
    values = [value for item in study.vary for value in item.values or ()]
    named = any(isinstance(value, str) and value not in ("keep", "none") for value in values)
    initial = base.content.get("initial")
    posed = isinstance(initial, Mapping) and "position_m" in initial
    return study.runs >= LEAST_RUNS and own and bare and not named and not posed


@dataclass(frozen=True)
class Block:
    """Neighbouring cases of a study: everything that a worker on another machine needs."""

    study: StudyFile
    base: Base
    numbers: range


def block_tasks(study: StudyFile, base: Base) -> Iterator[Task]:
    """The blocks of a study, in order; each is named by the study's content, its scene's (files included), and versions."""
    asked = study.asked_rad.get(selection.REFERENCE, DEFAULT_ACCURACY_RAD)
    request = RunRequest(lambda: base.scene({}), selection.REFERENCE, asked)
    keys = [request.task(base.scene(variant.set)).key for variant in study.variant]
    name = key_of(study.model_dump_json(), base.content, keys)
    for start in range(0, study.runs, BLOCK):
        block = Block(study, base, range(start, min(start + BLOCK, study.runs)))
        yield Task(key_of(name, start, BLOCK), run_block, block, selection.REFERENCE, runs=len(block.numbers))


def run_block(block: Block) -> Answer:
    """Run every case of a block: its columns, and what they have in common."""
    begin = time.perf_counter()
    cases = list(expand(block.study, block.base, block.numbers))
    runs = SweptRuns(block.base, block.study.asked_rad.get(selection.REFERENCE, DEFAULT_ACCURACY_RAD))
    for place, case in enumerate(cases):
        runs.add(place, case.setting)
    varied = {key: varied_column(block.study, key, [case.varied[key] for case in cases]) for key in cases[0].varied}
    named = {"number": np.array(block.numbers), "variant": texts([case.variant for case in cases])}
    table = {**named, **varied, **runs.columns()}
    outcomes = Counter(table["outcome"].tolist())
    record = {"settings": runs.settings, "varied": list(varied), "outcomes": outcomes}
    seconds = time.perf_counter() - begin
    return Answer(KIND, to_plain(record), seconds, inside_s=runs.inside_s, failed=runs.failed, table=table)


class SweptRuns:
    """Cases of a base scene, gathered and run together; one that the model refuses is run, and fails, as any single run does."""

    def __init__(self, base: Base, asked_rad: float) -> None:
        self._base, self._asked = base, asked_rad
        levels = engines.load(selection.REFERENCE).refinement_levels(base.scene({}))
        chosen = twoblock.own(first_level(levels, self._asked, 1.0)[0])
        self.settings = twoblock.stated_settings(chosen)
        self._scenes = _scenes(base, min(RELIABLE_RAD, chosen.accuracy_rad))
        self._gathered: list[Shaken] = []
        self._samples = 0
        self._parts: list[Columns] = []
        self.inside_s = 0.0
        self.failed = 0

    def add(self, place: int, setting: Mapping[str, Value]) -> None:
        """Gather a case by the keys that it sets, or run it. Raises `InputError` for a case that is no scene."""
        try:
            shaken = Shaken(place, self._scenes.still(setting), self._scenes.motion(setting))
        except AnalyticInputError:
            self._run_single(place, setting)
            return
        self._gathered.append(shaken)
        axes = shaken.motion.x, shaken.motion.z
        self._samples += sum(item.t_s.size for item in axes if isinstance(item, SampledAcceleration))
        if self._samples > MOST_SAMPLES:
            self._run()

    def columns(self) -> Columns:
        """All that was added, in order."""
        self._run()
        order = np.argsort(np.concatenate([part["place"] for part in self._parts]), kind="stable")
        return {
            name: np.concatenate([part[name] for part in self._parts])[order]
            for name in self._parts[0]
            if name != "place"
        }

    def _run(self) -> None:
        """Run what was gathered in two sweeps."""
        if not self._gathered:
            return
        start = time.perf_counter()
        self._parts.append(swept(self._gathered))
        self.inside_s += time.perf_counter() - start
        self._gathered, self._samples = [], 0

    def _run_single(self, place: int, setting: Mapping[str, Value]) -> None:
        answer = run_request(RunRequest(partial(self._base.scene, setting), selection.REFERENCE, self._asked))
        self.failed += answer.failed
        self._parts.append({"place": np.array([place]), **columns_of_record(answer.record)})


_REMEMBERED: Final[dict[str, CaseScenes]] = {}
"""The scenes of the study at work: what its blocks share is read once in each worker."""


def _scenes(base: Base, accuracy: float) -> CaseScenes:
    name = json.dumps([str(base.path), base.content, accuracy], default=str)
    if name not in _REMEMBERED:
        _REMEMBERED.clear()
        _REMEMBERED[name] = CaseScenes(base, accuracy)
    return _REMEMBERED[name]
