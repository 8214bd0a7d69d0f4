"""A contact engine on numbered draws: each a keyed task of one campaign, so that a killed assessment goes on."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from harness import engines
from harness.accuracy.refinement import first_level
from harness.engines.base import EngineFailure
from harness.model.run import RunOptions
from harness.model.scene import Scene
from harness.questions.assess.model_draws import ENGINE_ERROR_RAD, Array, row, varied
from harness.questions.assess.plan import reach_m
from harness.runs.task import Answer, Task, request_key

if TYPE_CHECKING:
    from harness.runs.execute import Campaign

OUTCOME: Final = "end and reach"
"""Kind of a result that is whether a statue fell, and how far one that stands went on the plan."""


@dataclass(frozen=True)
class DrawnRun:
    """One engine and one drawn scene, as they travel to a worker."""

    engine: str
    scene: Scene


class EngineRuns:
    """Whether one engine's statue overturns, by number of the draw: `fell` keeps what was asked, None where it came to no end;
    `reach_m` how far it went on the plan in each run that stands (`harness.questions.assess.plan.reach_m`).
    """

    def __init__(
        self,
        scene: Scene,
        name: str,
        values: Mapping[str, Array],
        campaign: Campaign,
        on_progress: Callable[[str], None],
    ) -> None:
        self._scene, self._name, self._values = scene, name, values
        self._campaign, self._on_progress = campaign, on_progress
        self._engine = engines.load(name)
        self.fell: dict[int, bool | None] = {}
        self.reach_m: dict[int, Array] = {}

    def __call__(self, numbers: Sequence[int]) -> list[bool | None]:
        tasks = {number: self._task(number) for number in numbers}
        for number, found in zip(tasks, self._campaign.ask(list(tasks.values())), strict=True):
            # A worker that died leaves nothing: the run counts as failed, and is tried anew when the assessment is.
            record = found or {"overturned": None}
            overturned = record["overturned"]
            self.fell[number] = None if overturned is None else bool(overturned)
            if overturned is False:
                self.reach_m[number] = np.array(record["reach_m"])
        self._on_progress(f"{self._name}: {len(self.fell)} runs")
        return [self.fell[number] for number in numbers]

    def _task(self, number: int) -> Task:
        scene = varied(self._scene, row(self._values, number))
        key = request_key(scene, self._engine, OUTCOME, ENGINE_ERROR_RAD)
        return Task(key, overturns, DrawnRun(self._name, scene), self._name)


def overturns(drawn: DrawnRun) -> Answer:
    """What a worker does: whether the statue overturns in its scene, at the coarsest step that is expected to do."""
    begin = time.perf_counter()
    engine = engines.load(drawn.engine)
    settings, _ = first_level(engine.refinement_levels(drawn.scene), ENGINE_ERROR_RAD, 1.0)
    fell, reached, failed = None, None, False
    try:
        run = engine.simulate(drawn.scene, settings, RunOptions())
        fell, failed = run.outcome.fell, run.outcome.failed
        if fell is False and (history := run.history) is not None:
            reached = reach_m(drawn.scene, history.theta_rad, history.slip_m, history.extra).tolist()
    except EngineFailure:
        failed = True
    seconds = time.perf_counter() - begin
    return Answer(OUTCOME, {"overturned": fell, "reach_m": reached}, seconds, inside_s=seconds, failed=failed)
