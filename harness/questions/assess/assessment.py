"""The probability that a statue falls, by the analytic model and by contact engines, and how far the two are apart."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack, closing
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from harness import engines
from harness.accuracy.forecast import START_S, Range, first_settings, moving_s, timed_step_s
from harness.model import Axes, Scene, Shown, Uncertain, machine, must_be_scene, new_axes, require, required, versions
from harness.questions.assess.answer import answer_of, findings_of
from harness.questions.assess.clearance import of_engine, of_model, of_space, rest_outline_m
from harness.questions.assess.model_draws import (
    SPACE,
    Array,
    ModelDraws,
    draws_of,
    model_draws,
    row,
    shaken_across,
    space_draws,
    sweepable,
    uncertain_inputs,
    varied,
)
from harness.questions.assess.options import Option, OptionDraws, compare, in_plane, in_space, options_of
from harness.questions.assess.probability import (
    MODEL,
    RUN_DRAWS,
    SAMPLE_S,
    SAMPLER,
    End,
    EngineRuns,
    Outside,
    estimate,
    probability_of,
    sampled,
    strata_of,
)
from harness.questions.assess.sensitivity import (
    FRAGILITY_DRAWS,
    fragility,
    fragility_in_space,
    indices,
    indices_of_draws,
)
from harness.records.assess import (
    Assessment,
    AssessRecord,
    ClearanceByModel,
    ClearanceRecord,
    NotAssessed,
    ProbabilityDifference,
)
from harness.records.base import RunCounts
from harness.records.scene import SceneRecord
from harness.runs.execute import Campaign
from harness.runs.progress import LESS_STORED, counted, forecast_words
from harness.runs.runner import LocalPool, Pool
from harness.runs.store import Store

HALF_WIDTH: Final = 0.05
"""Half width to which a contact engine's probability is asked, at `LEVEL`."""
SAMPLERS: Final = (SAMPLER, "pybullet")
"""Engines that follow a pedestal that tips and a statue that slips on it: the first of them that is asked."""
MOST_RUNS: Final = 400
"""Engine runs after which an interval is told as it is."""
SPACE_DIMENSIONS: Final = 3
SPACE_STEPS: Final = 1_000_000
"""Steps that the exact body may take in all, where it is asked beside the others: three times those beside a single run."""
OPTIONS: Final = 10
"""Options of which draws outside the model's domain may be answered by the engine, in a forecast: as many as are shipped."""
ALL_TIMES: Final = 4.2
"""What the models take for all that is asked of them over what the draws take: clearance, options, fragility, indices."""
RESULT_S: Final = 3.0
"""To begin, and to write the record and its page."""


@dataclass(frozen=True, eq=False, repr=False)
class Assessed(Shown):
    """A whole assessment: its record, the draws by key, the model's answers to them, and each engine's to those it ran."""

    record: AssessRecord
    values: Mapping[str, Array]
    model: ModelDraws
    fell: Mapping[str, Mapping[int, End]]

    def facts(self) -> dict[str, str]:
        """Title, and by engine how probable a fall is, with its interval."""
        answers = self.record.answers.items()
        said = {
            name: f"falls with {item.probability_overturned:.3g} ({item.low:.3g} to {item.high:.3g})"
            for name, item in answers
        }
        return {"title": self.record.title, "not known": ", ".join(self.values), **said}

    def columns(self) -> dict[str, NDArray[Any]]:
        """One row for each draw: what was drawn by key, and whether the analytic model's statue overturns."""
        size = len(self.model.overturned)
        return {"draw": np.arange(size), **self.values, "overturned": self.model.overturned}

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw how probable a fall is by the strength of the whole motion, as a factor on it. Raises `InputError` without any."""
        wanted = "a scene with a motion to make stronger"
        curve = required(self.record.fragility, "assess", wanted, self.record.title, key="plot")
        ax = new_axes(ax)
        ax.plot(curve.factor, curve.probability_overturned, marker="o", label=curve.model)
        if curve.low and curve.high:
            ax.fill_between(curve.factor, curve.low, curve.high, alpha=0.2)
        ax.axvline(1.0, linestyle=":", linewidth=1.0)
        ax.set(xlabel="factor on the motion", ylabel="probability of a fall", title=self.record.title)
        return ax


def assess(
    scene: Scene,
    names: Sequence[str] | None = (MODEL,),
    *,
    draws: int = RUN_DRAWS,
    seed: int = 0,
    half_width: float = HALF_WIDTH,
    most_runs: int = MOST_RUNS,
    more_options: Sequence[Option] | None = (),
    store: Store | None = None,
    pool: Pool | None = None,
    on_progress: Callable[[str], None] = lambda text: None,
) -> Assessed:
    """How probable a fall is over what a scene does not know: by engine, and options, clearance, fragility, which input matters.

    >>> answer = harness.assess(scene, draws=2000)
    >>> answer.record.assessment["analytic"].probability_overturned

    `names`: the models asked (None: those of every run, some hundred runs of each contact engine). `more_options` are the user's
    own beside the scene's; None compares no options. Engine runs that the `store` holds are not computed again; `pool` is used,
    and not closed, where the caller has one.
    Raises `InputError` for a wrong number, a scene of which nothing is uncertain, or one that begins from a pose in space (the
    draws are stratified by the planar model).
    """
    must_be_scene(scene, "assess")
    for given, value, least in (("draws", draws, 1), ("seed", seed, 0), ("most_runs", most_runs, 1)):
        require(
            type(value) is int and value >= least,
            "assess",
            f"a whole number of at least {least}",
            repr(value),
            key=given,
        )
    names = engines.asked(names, engines.DEFAULT_ENGINES)
    for name in names:
        engines.load(name)
    for given, limit, usual in (("half_width", half_width, HALF_WIDTH), ("most_runs", most_runs, MOST_RUNS)):
        wanted = f"another engine beside {MODEL}: it is of its runs"
        require(names != [MODEL] or limit == usual, "assess", wanted, f"{limit:g}", key=given)
    inputs = _inputs(scene)
    on_progress(f"{MODEL}: {counted(draws, 'draw')}")
    values = draws_of(scene, inputs, draws, seed)
    begin = time.process_time()
    model = model_draws(scene, values)
    drawn_s = time.process_time() - begin
    with ExitStack() as stack:
        # The caller's store and pool, or a store in memory and this machine's cores until the end.
        storage = store or stack.enter_context(Store(Path(":memory:")))
        computing = pool or stack.enter_context(closing(LocalPool(os.cpu_count())))
        campaign, workers = Campaign(storage, computing), computing.workers
        contact = [name for name in names if name not in (MODEL, SPACE) and engines.load(name).missing() is None]
        estimated = partial(estimate, model, half_width=half_width, most_runs=most_runs)
        # Counted as if each contact engine agreed with the model, and thrice as many.
        agreed = estimated(lambda numbers: model.overturned[list(numbers)].tolist()).engine_runs
        runs_each = Range(agreed, min(3 * agreed, most_runs))
        forecast = _forecast(scene, contact, runs_each, ALL_TIMES * drawn_s, workers)
        on_progress(forecast + LESS_STORED * bool(storage.keys()))
        across, space = shaken_across(scene), None
        if across:
            on_progress(f"{SPACE}: draws, then clearance")
            space = space_draws(scene, values, SPACE_STEPS)
        already = (MODEL,) if space is None else (MODEL, SPACE)
        answers, room = dict[str, Assessment | NotAssessed](), dict[str, ClearanceByModel]()
        fell: dict[str, Mapping[int, End]] = {}
        for name in (name for name in names if name not in already):
            if (reason := engines.load(name).missing()) is not None:
                answers[name] = NotAssessed(reason)
                continue
            runs = EngineRuns(scene, name, values, campaign, on_progress)
            answer = estimated(runs)
            fell[name] = runs.fell
            if answer.undecided == 1.0:
                message = f"none of its {answer.engine_runs} runs came to an end (rockcheck run -e {name} says why)"
                answers[name] = NotAssessed(message, answer.engine_runs)
                continue
            planar = engines.load(name).capabilities.dimensions < SPACE_DIMENSIONS
            answers[name] = replace(answer, plane_only=planar and across)
            room[name] = of_engine(strata_of(model), runs.fell, runs.reach_m)
        counts = RunCounts(campaign.computed + len(campaign.reused), campaign.computed)
    if space is not None:
        answers[SPACE], room[SPACE] = probability_of(space), of_space(scene, values, space)
    sampler = next((name for name in fell if name in SAMPLERS), SAMPLER)
    own = OptionDraws(model, fell.get(sampler) or sampled(model, lambda number: varied(scene, row(values, number))))
    by_own = probability_of(*own, sampler, plane_only=across)
    outside = Outside.of(*own)
    differences = {
        name: difference(by_own, outside, item) for name, item in answers.items() if isinstance(item, Assessment)
    }
    answers = {MODEL: by_own, **answers}
    on_progress(f"{MODEL}: clearance")
    room = {MODEL: of_model(scene, values, model), **room}
    top_m = scene.statue.height_m + (0.0 if scene.pedestal is None else scene.pedestal.height_m)
    record = AssessRecord(
        title=scene.title,
        scene=SceneRecord.of(scene),
        findings=scene.findings,
        uncertainty=inputs,
        assumed=not scene.uncertainty,
        seed=seed,
        assessment={name: answers[name] for name in dict.fromkeys((*names, *answers)) if name in answers},
        difference_from_model=differences,
        versions=versions(),
        machine=machine(),
        runs=counts,
        clearance=ClearanceRecord(top_m, rest_outline_m(scene.statue).tolist(), room),
    )
    record = _by_one_model(record, scene, values, own, space, more_options, on_progress)
    record = replace(record, answer=answer_of(record), findings=[*findings_of(record), *record.findings])
    return Assessed(record, values, model, fell)


def _forecast(scene: Scene, names: Sequence[str], runs: Range, models_s: float, workers: int) -> str:
    """What an assessment will take, in words: so many runs of each contact engine, and so many seconds of the models."""
    each_s = sum(timed_step_s(name, scene) * moving_s(scene)[0] / first_settings(name, scene).dt_s for name in names)
    spent = Range(models_s, models_s).and_also(
        runs.times(each_s), RESULT_S, START_S * workers * bool(names), Range(0.0, SAMPLE_S * OPTIONS)
    )
    clock = forecast_words(*spent.times(1.0 / workers))
    return f"this takes {forecast_words(*spent)} of processor time, {clock} by the clock (cores: {workers})"


def _inputs(scene: Scene) -> Sequence[Uncertain]:
    """What is uncertain; raises `InputError` for a scene of which no draws can be made."""
    where = str(scene.source or "the scene")
    wanted = "a start in the rocking plane: draws are stratified by the planar model"
    require(scene.initial.pose is None, where, wanted, "a pose in space", key="initial.position_m")
    inputs = uncertain_inputs(scene)
    wanted = "the keys that are not known: there is neither a motion nor a pedestal of which to assume any"
    require(inputs, where, wanted, "nothing", key="uncertainty")
    return inputs


def _by_one_model(
    record: AssessRecord,
    scene: Scene,
    values: Mapping[str, Array],
    own: OptionDraws,
    space: ModelDraws | None,
    more_options: Sequence[Option] | None,
    on_progress: Callable[[str], None],
) -> AssessRecord:
    """The record with all that one model alone answers: the exact body where the scene is its own, else the analytic model."""
    inputs, seed = record.uncertainty, record.seed
    if more_options is not None:
        own_options, left_out = options_of(scene)
        every = [*own_options, *more_options]
        if space is not None:
            ask = in_space(scene, inputs, values, seed)
            compared = compare(every, left_out, OptionDraws(space), ask, model=SPACE, on_progress=on_progress)
        else:
            ask = in_plane(scene, every, inputs, values, seed)
            across = shaken_across(scene)
            compared = compare(every, left_out, own, ask, plane_only=across, on_progress=on_progress)
        record = replace(record, options=compared)
    if space is not None:
        on_progress(f"{SPACE}: fragility")
        found = fragility_in_space(scene, inputs, seed)
        return replace(record, fragility=found, indices=indices_of_draws(inputs, values, space.overturned))
    on_progress(f"{MODEL}: fragility and indices")
    found = fragility(scene, inputs, seed, min(own.model.overturned.size, FRAGILITY_DRAWS))
    swept = sweepable(scene, values)
    by_input = indices(scene, inputs, seed) if swept else indices_of_draws(inputs, values, own.model.overturned)
    return replace(record, fragility=found, indices=by_input)


def difference(own: Assessment, outside: Outside, other: Assessment) -> ProbabilityDifference:
    """The model's probability less another's on the same draws: left are the sampling of the other, and of the draws `outside`
    the model's domain what their sample leaves open, and those without an answer, which may fall."""
    p, theirs = own.probability_overturned, other.probability_overturned
    below = math.hypot(outside.falls - outside.low, other.high - theirs)
    above = math.hypot(outside.high - outside.falls, theirs - other.low) + outside.undecided
    return ProbabilityDifference(p - theirs, p - theirs - below, p - theirs + above, other.level)
