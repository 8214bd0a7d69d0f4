"""The probability that a statue falls, by the analytic model and by contact engines, and how far the two are apart."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, Final

from harness import engines
from harness.assess.inputs import draw, row, uncertain_inputs
from harness.assess.model_draws import SLOW_DRAWS, ModelDraws, model_draws, sweepable
from harness.assess.options import Option, options_of
from harness.assess.stratified import LEVEL, Estimate, estimate
from harness.assess.variation import varied
from harness.campaign.runner import Crash, LocalPool
from harness.comparison.statistics.distributions import wilson
from harness.engines.base import EngineFailure
from harness.model.errors import InputError, Mistake
from harness.model.options import RunOptions
from harness.model.run import machine, versions
from harness.model.scene import Scene
from harness.records.assess import Assessment, AssessRecord, NotAssessed, ProbabilityDifference
from harness.records.scene import SceneRecord

MODEL: Final = "analytic"
RUN_DRAWS: Final = 10_000
"""Draws beside every single run: ± 0.8 % at a half, in half a second for a harmonic motion of 10 s."""
ASSESS_DRAWS: Final = 20_000
HALF_WIDTH: Final = 0.05
"""Half width to which a contact engine's probability is asked, at `LEVEL`."""
MOST_RUNS: Final = 400
"""Engine runs after which an interval is told as it is."""
ENGINE_ERROR_RAD: Final = 1e-3
"""A single run's expected error: an outcome changes by it only where a draw lies that near the boundary."""
BATCH: Final = 16
"""Runs between two looks at the interval."""


def assess_model(scene: Scene, draws: int = RUN_DRAWS, seed: int = 0) -> Assessment | None:
    """The analytic model's own probability; None where nothing of the scene is uncertain, or it begins from a pose in space."""
    inputs = uncertain_inputs(scene)
    if not inputs or scene.initial.pose is not None:
        return None
    values = draw(inputs, draws, seed)
    if not sweepable(scene, values):
        values = draw(inputs, min(draws, SLOW_DRAWS), seed)
    return _of_model(model_draws(scene, values))


def _of_model(model: ModelDraws) -> Assessment | None:
    size = model.overturned.size
    share = wilson(int(model.overturned.sum()), size, LEVEL)
    if share is None:
        return None
    return Assessment(share.value, share.low, share.high, LEVEL, size, size, 1.0 - float(model.decided.mean()))


def assess(
    scene: Scene,
    names: Sequence[str] | None = None,
    *,
    draws: int = ASSESS_DRAWS,
    seed: int = 0,
    half_width: float = HALF_WIDTH,
    most_runs: int = MOST_RUNS,
    more_options: Sequence[Option] | None = (),
    on_progress: Callable[[str], None] = lambda text: None,
) -> AssessRecord:
    """The whole record of an assessment: by engine, the differences to the model, fragility, which input matters.

    `names` None: the engines of every run. `more_options` are the user's own beside the scene's; None compares no options.
    Raises `InputError` for a scene of which nothing is uncertain, or that begins from a pose in space (the draws are stratified
    by the planar model).
    """
    names = names or engines.DEFAULT_ENGINES
    if scene.initial.pose is not None:
        wanted = "a start in the rocking plane: draws are stratified by the planar model"
        raise InputError(Mistake(str(scene.source or "the scene"), "initial.position_m", wanted, "a pose in space"))
    inputs = uncertain_inputs(scene)
    if not inputs:
        wanted = "the keys that are not known: there is neither a motion nor a pedestal of which to assume any"
        raise InputError(Mistake(str(scene.source or "the scene"), "uncertainty", wanted, "nothing"))
    on_progress(f"{MODEL}: {draws} draws")
    values = draw(inputs, draws, seed)
    fast = sweepable(scene, values)
    if not fast:
        draws = min(draws, SLOW_DRAWS)
        values = draw(inputs, draws, seed)
    model = model_draws(scene, values)
    own = _of_model(model)
    answers: dict[str, Assessment | NotAssessed | None] = {MODEL: own}
    differences: dict[str, ProbabilityDifference] = {}
    for name in dict.fromkeys(names):
        if name == MODEL:
            continue
        reason = engines.load(name).missing()
        if reason is not None:
            answers[name] = NotAssessed(reason)
            continue
        with _Runs(scene, name, values, on_progress) as runs:
            answer = estimate(model, runs, half_width=half_width, most_runs=most_runs, batch=BATCH)
        answers[name] = _of_engine(answer, draws)
        if own is not None:
            differences[name] = _difference(own, answer)
    record = AssessRecord(
        title=scene.title,
        scene=SceneRecord.of(scene),
        notes=list(scene.notes),
        uncertainty=inputs,
        assumed=not scene.uncertainty,
        seed=seed,
        assessment={name: answers[name] for name in dict.fromkeys((*names, MODEL)) if name in answers},
        difference_from_model=differences,
        versions=versions(),
        machine=machine(),
    )
    if more_options is not None:
        from harness.assess.compared import OPTION_DRAWS, compare

        own_options, left_out = options_of(scene)
        size, every = min(draws, OPTION_DRAWS), [*own_options, *more_options]
        compared = compare(scene, inputs, every, left_out, draws=size, seed=seed, on_progress=on_progress)
        record = replace(record, options=compared)
    if not fast:
        return record
    from harness.assess.sensitivity import fragility, indices

    on_progress(f"{MODEL}: fragility and indices")
    return replace(record, fragility=fragility(scene, inputs, seed), indices=indices(scene, inputs, seed))


def _of_engine(answer: Estimate, draws: int) -> Assessment:
    undecided = answer.undecided / answer.runs if answer.runs else 0.0
    return Assessment(answer.probability, answer.low, answer.high, answer.level, draws, answer.runs, undecided)


def _difference(own: Assessment, answer: Estimate) -> ProbabilityDifference:
    """The model's probability less the engine's: both from the same draws, so that only the engine's sampling is left."""
    p = own.probability_overturned
    return ProbabilityDifference(p - answer.probability, p - answer.high, p - answer.low, answer.level)


class _Runs:
    """Runs of one engine on numbered draws, in processes of their own."""

    def __init__(self, scene: Scene, name: str, values: Any, on_progress: Callable[[str], None]) -> None:
        self.scene, self.name, self.values, self.on_progress = scene, name, values, on_progress
        self.pool, self.made = LocalPool(os.cpu_count()), 0

    def __enter__(self) -> _Runs:
        return self

    def __exit__(self, *ending: object) -> None:
        self.pool.close()

    def __call__(self, numbers: Sequence[int]) -> list[bool | None]:
        tasks = [(k, self.name, varied(self.scene, row(self.values, number))) for k, number in enumerate(numbers)]
        answers: list[bool | None] = [None] * len(tasks)

        def done(task: Any, answer: Any) -> None:
            answers[task[0]] = None if isinstance(answer, Crash) else answer

        self.pool.run(overturns, tasks, done)
        self.made += len(tasks)
        self.on_progress(f"{self.name}: {self.made} runs")
        return answers


def overturns(task: tuple[int, str, Scene]) -> bool | None:
    """Whether one engine's statue overturns in one scene within its duration; None where the run failed."""
    _, name, scene = task
    engine = engines.load(name)
    levels = engine.refinement_levels(scene)
    settings = next((item for item in levels if item.expected_error_rad <= ENGINE_ERROR_RAD), levels[-1])
    try:
        outcome = engine.simulate(scene, settings, RunOptions(history=False)).outcome
    except EngineFailure:
        return None
    return None if outcome.failed else outcome.overturned


def summary(record: AssessRecord) -> str:
    """An assessment in a few lines of plain words."""
    lines = [record.title]
    width = max(len(name) for name in record.assessment)
    for name, item in record.assessment.items():
        if isinstance(item, Assessment):
            lines.append(f"  {name:{width}}  {sentence(item)}; {item.engine_runs} runs")
        elif item is not None:
            lines.append(f"  {name:{width}}  not here: {item.message}")
    if record.assumed:
        assumed = ", ".join(f"{item.key} ({item.kind}, {item.width:g})" for item in record.uncertainty)
        lines.append(f"  note: the scene has no table [uncertainty]; assumed are {assumed}")
    if record.options is not None:
        from harness.assess.advice import advice

        lines += [f"  {line}" for line in advice(record.options)]
    return "\n".join(lines)


def sentence(item: Assessment) -> str:
    """`falls in 40 % of what may be true (39 to 41 %)`."""
    low, high = percent(item.low), percent(item.high)
    return f"falls in {percent(item.probability_overturned)} % of what may be true ({low} to {high} %)"


def percent(share: float) -> str:
    """A share in per cent, two digits where it is small."""
    value = 100.0 * share
    return f"{value:.0f}" if value >= 9.95 or value == 0.0 else f"{value:.2g}"
