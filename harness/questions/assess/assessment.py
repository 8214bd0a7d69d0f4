"""The probability that a statue falls, by the analytic model and by contact engines, and how far the two are apart."""

from __future__ import annotations

import math
import os
import shlex
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from harness import engines
from harness.accuracy.forecast import START_S, Range, first_settings, moving_s, timed_step_s
from harness.accuracy.horizon import MODEL
from harness.model import (
    Answer,
    Array,
    Axes,
    Finding,
    Outcome,
    Scene,
    Shown,
    Uncertain,
    caution,
    info,
    machine,
    must_be_scene,
    new_axes,
    require,
    required,
    versions,
)
from harness.questions.assess.clearance import (
    PLANAR_DEG,
    clearance_by_engine,
    clearance_by_model,
    clearance_in_space,
    reach_m,
    rest_outline_m,
)
from harness.questions.assess.options import Option, OptionDraws, compare, in_plane, in_space, options_of
from harness.questions.assess.probability import (
    ENGINE_ERROR_RAD,
    FRAGILITY_DRAWS,
    RUN_DRAWS,
    SAMPLE_S,
    SAMPLER,
    SPACE,
    End,
    ModelDraws,
    Outside,
    draws_of,
    end_of,
    estimate,
    finding_of,
    fragility,
    fragility_in_space,
    indices,
    indices_of_draws,
    model_draws,
    probability_of,
    row,
    run_of,
    sampled,
    shaken_across,
    space_draws,
    strata_of,
    sweepable,
    uncertain_inputs,
    varied,
)
from harness.records.assess import (
    FLOOR,
    MOSTLY,
    TURNED,
    Assessment,
    AssessRecord,
    ClearanceByModel,
    ClearanceRecord,
    FragilityRecord,
    Index,
    NotAssessed,
    OptionAnswer,
    OptionsRecord,
    ProbabilityDifference,
)
from harness.records.base import Plain, RunCounts
from harness.records.scene import SceneRecord
from harness.runs.execute import Campaign
from harness.runs.progress import LESS_STORED, counted, forecast_words
from harness.runs.runner import LocalPool, Pool
from harness.runs.store import Store
from harness.runs.task import RunRequest, Task, TaskResult, request_key

HALF_WIDTH: Final = 0.05
"""Half width to which a contact engine's probability is asked, at `LEVEL`."""
SAMPLERS: Final = (SAMPLER, "pybullet")
"""Engines that follow a pedestal that tips and a statue that slips on it: the first of them that is asked."""
MOST_RUNS: Final = 400
"""Engine runs after which an interval is told as it is."""
SPACE_DIMENSIONS: Final = 3
SPACE_STEPS: Final = 1_000_000
"""Steps that the exact body may take in all, where it is asked beside the others: some seven times those beside a single run."""
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
        said = {
            name: f"falls with {item.probability_overturned:.3g} ({item.low:.3g} to {item.high:.3g})"
            for name, item in self.record.answers.items()
        }
        return {"title": self.record.title, "not known": ", ".join(self.values), **said}

    def columns(self) -> dict[str, NDArray[Any]]:
        """One row for each draw: what was drawn by key, and whether the analytic model's statue overturns."""
        return {"draw": np.arange(self.model.overturned.size), **self.values, "overturned": self.model.overturned}

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw how probable a fall is by the strength of the whole motion, as a factor on it. Raises `InputError` without any."""
        curve = required(
            self.record.fragility, "assess", "a scene with a motion to make stronger", self.record.title, key="plot"
        )
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
    asked = {name: engines.load(name) for name in engines.asked(names, engines.DEFAULT_ENGINES)}
    for given, limit, usual in (("half_width", half_width, HALF_WIDTH), ("most_runs", most_runs, MOST_RUNS)):
        wanted = f"another engine beside {MODEL}: it is of its runs"
        require([*asked] != [MODEL] or limit == usual, "assess", wanted, f"{limit:g}", key=given)
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
        campaign = Campaign(storage, computing)
        contact = [name for name, item in asked.items() if name not in (MODEL, SPACE) and item.missing() is None]
        estimated = partial(estimate, model, half_width=half_width, most_runs=most_runs)
        # Counted as if each contact engine agreed with the model, and thrice as many.
        agreed = estimated(lambda numbers: model.overturned[list(numbers)].tolist()).engine_runs
        runs_each = Range(agreed, min(3 * agreed, most_runs))
        forecast = _forecast(scene, contact, runs_each, ALL_TIMES * drawn_s, computing.workers)
        on_progress(forecast + LESS_STORED * bool(storage.keys()))
        across, space = shaken_across(scene), None
        if across:
            on_progress(f"{SPACE}: draws, then clearance")
            space = space_draws(scene, values, SPACE_STEPS)
        already = (MODEL,) if space is None else (MODEL, SPACE)
        answers, room = dict[str, Assessment | NotAssessed](), dict[str, ClearanceByModel]()
        fell: dict[str, Mapping[int, End]] = {}
        for name, engine in ((name, engine) for name, engine in asked.items() if name not in already):
            if (reason := engine.missing()) is not None:
                answers[name] = NotAssessed(reason)
                continue
            runs = EngineRuns(scene, name, values, campaign.ask, on_progress)
            answer = estimated(runs)
            fell[name] = runs.fell
            if answer.undecided == 1.0:
                message = f"none of its {answer.engine_runs} runs came to an end (rockcheck run -e {name} says why)"
                answers[name] = NotAssessed(message, answer.engine_runs)
                continue
            planar = engine.capabilities.dimensions < SPACE_DIMENSIONS
            answers[name] = replace(answer, plane_only=planar and across)
            room[name] = clearance_by_engine(strata_of(model), runs.fell, runs.reach_m)
        counts = RunCounts(campaign.computed + len(campaign.reused), campaign.computed)
    if space is not None:
        answers[SPACE], room[SPACE] = probability_of(space), clearance_in_space(scene, values, space)
    sampler = next((name for name in fell if name in SAMPLERS), SAMPLER)
    own = OptionDraws(model, fell.get(sampler) or sampled(model, lambda number: varied(scene, row(values, number))))
    by_own = probability_of(*own, sampler, plane_only=across)
    outside = Outside.of(*own)
    differences = {
        name: difference(by_own, outside, item) for name, item in answers.items() if isinstance(item, Assessment)
    }
    answers = {MODEL: by_own, **answers}
    on_progress(f"{MODEL}: clearance")
    room = {MODEL: clearance_by_model(scene, values, model), **room}
    top_m = scene.statue.height_m + (0.0 if scene.pedestal is None else scene.pedestal.height_m)
    record = AssessRecord(
        title=scene.title,
        scene=SceneRecord.of(scene),
        findings=scene.findings,
        uncertainty=inputs,
        assumed=not scene.uncertainty,
        seed=seed,
        assessment={name: answers[name] for name in dict.fromkeys((*asked, *answers)) if name in answers},
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
    require(
        scene.initial.pose is None,
        where,
        "a start in the rocking plane: draws are stratified by the planar model",
        "a pose in space",
        key="initial.position_m",
    )
    inputs = uncertain_inputs(scene)
    require(
        inputs,
        where,
        "the keys that are not known: there is neither a motion nor a pedestal of which to assume any",
        "nothing",
        key="uncertainty",
    )
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
        if space is None:
            ask = in_plane(scene, every, inputs, values, seed)
            compared = compare(every, left_out, own, ask, plane_only=shaken_across(scene), on_progress=on_progress)
        else:
            ask = in_space(scene, inputs, values, seed)
            compared = compare(every, left_out, OptionDraws(space), ask, model=SPACE, on_progress=on_progress)
        record = replace(record, options=compared)
    if space is not None:
        on_progress(f"{SPACE}: fragility")
        by_input = indices_of_draws(inputs, values, space.overturned)
        return replace(record, fragility=fragility_in_space(scene, inputs, seed), indices=by_input)
    on_progress(f"{MODEL}: fragility and indices")
    found = fragility(scene, inputs, seed, min(own.model.overturned.size, FRAGILITY_DRAWS))
    if sweepable(scene, values):
        return replace(record, fragility=found, indices=indices(scene, inputs, seed))
    return replace(record, fragility=found, indices=indices_of_draws(inputs, values, own.model.overturned))


def difference(own: Assessment, outside: Outside, other: Assessment) -> ProbabilityDifference:
    """The model's probability less another's on the same draws: left are the sampling of the other, and of the draws `outside`
    the model's domain what their sample leaves open, and those without an answer, which may fall."""
    p, theirs = own.probability_overturned, other.probability_overturned
    below = math.hypot(outside.falls - outside.low, other.high - theirs)
    above = math.hypot(outside.high - outside.falls, theirs - other.low) + outside.undecided
    return ProbabilityDifference(p - theirs, p - theirs - below, p - theirs + above, other.level)


# The engine's runs: each a keyed task of one campaign, so that a killed assessment goes on.

OUTCOME: Final = "end and reach"
"""Kind of a result that is whether a statue fell, and how far one that stands went on the plan."""


class EngineRuns:
    """How one engine's runs end, by number of the draw: `fell` keeps what was asked; `reach_m` how far it went on the plan in
    each run that stands (`harness.questions.assess.clearance.reach_m`).
    """

    def __init__(
        self,
        scene: Scene,
        name: str,
        values: Mapping[str, Array],
        ask: Callable[[Sequence[Task]], Sequence[Plain | None]],
        on_progress: Callable[[str], None],
    ) -> None:
        self._scene, self._name, self._values = scene, name, values
        self._ask, self._on_progress = ask, on_progress
        self._engine = engines.load(name)
        self.fell: dict[int, End] = {}
        self.reach_m: dict[int, Array] = {}

    def __call__(self, numbers: Sequence[int]) -> list[End]:
        requests = [RunRequest(varied(self._scene, row(self._values, number)), self._name) for number in numbers]
        tasks = [
            Task(request_key(each.made(), self._engine, OUTCOME, ENGINE_ERROR_RAD), overturns, each, self._name)
            for each in requests
        ]
        for number, found in zip(numbers, self._ask(tasks), strict=True):
            # A worker that died leaves nothing: the run counts as failed, and is tried anew when the assessment is.
            record = found or {"overturned": None}
            overturned = record["overturned"]
            wall = Outcome.TOUCHES_WALL if record.get("touches_wall") else None
            self.fell[number] = wall if overturned is None else bool(overturned)
            if overturned is False:
                self.reach_m[number] = np.array(record["reach_m"])
        self._on_progress(f"{self._name}: {len(self.fell)} runs")
        return [self.fell[number] for number in numbers]


def overturns(drawn: RunRequest) -> TaskResult:
    """What a worker does: whether the statue overturns in its scene, and how far it goes where it stands."""
    begin, scene = time.perf_counter(), drawn.made()
    run, reached = run_of(engines.load(drawn.engine), scene), None
    end = end_of(run)
    if run is not None and end is False and (history := run.history) is not None:
        reached = reach_m(scene, history.theta_rad, history.slip_m, history.extra).tolist()
    seconds, failed = time.perf_counter() - begin, run is None or run.outcome.failed
    touches = end is Outcome.TOUCHES_WALL
    ended = {"overturned": None if touches else end, "reach_m": reached, "touches_wall": touches}
    return TaskResult(OUTCOME, ended, seconds, inside_s=seconds, failed=failed)


# What an assessment says: how probable a fall is, what reserve is left, what would help, and the room that it needs.

CLEAR: Final = 0.95
"""Share of the standing draws whose clearance is told."""
FIRST: Final = "0.05"
"""The least probability whose factor is told: what a reserve is."""
MATTERS: Final = 0.05
"""A total index below this: knowing the input would change next to nothing."""
NEGLIGIBLE: Final = 0.01
"""A statue that overturns less often than this needs nothing done."""


def answer_of(record: AssessRecord) -> Answer:
    """The headline: the probability, the reserve, the most effective option, the clearance."""
    found = [finding_of(record.answers)]
    alone = "plane" if record.plane_only else "alone" if record.contradicted else ""
    found += [] if record.fragility is None else [reserve(record.fragility, alone)]
    found += [] if record.options is None else [best_option(record.options, contradicted=record.contradicted)]
    room = record.whole_clearance
    return Answer(found[0].code, found + ([] if room is None else [clearance(room)]))


def findings_of(record: AssessRecord) -> list[Finding]:
    """All that is to be known beside the headline."""
    found = [
        (caution("no_run_ended", runs=item.runs) if item.runs else caution("not_assessed", reason=item.message)).of(
            name
        )
        for name, item in record.assessment.items()
        if isinstance(item, NotAssessed)
    ]
    found += _other_commands(record.answers, record.scene.file, pedestal=record.scene.pedestal is not None)
    found += [_difference(name, item) for name, item in record.difference_from_model.items()]
    found += [] if record.options is None else of_options(record.options, contradicted=record.contradicted)
    found += [] if record.clearance is None else without_clearance(record.clearance)
    key, most = max((record.indices or {}).items(), key=lambda item: item[1].most, default=("", Index(0.0, 0.0)))
    if most.most >= max(MATTERS, most.half_width):
        planar = record.plane_only and record.fragility is not None and record.fragility.model == MODEL
        # Of the same draws: a difference is known better than by both widths, so that none is left out that may matter more.
        equal = [
            other
            for other, item in (record.indices or {}).items()
            if other != key and most.most - item.most <= math.hypot(most.half_width, item.half_width)
        ]
        found.append(info("decisive_input", input=key, share=min(most.most, 1.0), planar=planar, equal=equal))
    if record.assumed:
        found.append(info("uncertainty_assumed", keys=[item.key for item in record.uncertainty]))
    if record.runs is not None and record.runs.computed < record.runs.wanted:
        found.append(info("runs_kept", kept=record.runs.wanted - record.runs.computed, of=record.runs.wanted))
    return found


def _other_commands(answers: Mapping[str, Assessment], file: str | None, *, pedestal: bool) -> Iterator[Finding]:
    """The command that knows what every answer leaves out: the shaking across the plane, or most draws on a pedestal."""
    scene = shlex.quote(file) if file else "SCENE"
    if answers and all(item.plane_only for item in answers.values()):
        yield caution("assess_in_space", file=scene)
    if list(answers) == [MODEL] and pedestal and not answers[MODEL].tells:
        yield caution("assess_by_contact", file=scene)


def _difference(name: str, item: ProbabilityDifference) -> Finding:
    values = {"model": name, "difference": item.value, "low": item.low, "high": item.high}
    if item.low <= 0.0 <= item.high:
        return info("probability_difference", shown="none", **values)
    if item.low > 0.0:
        return caution("probability_difference", shown="over", **values)
    less = {"difference": -item.value, "low": -item.high, "high": -item.low}
    return caution("probability_difference", shown="under", **values | less)


def reserve(item: FragilityRecord, alone: str = "") -> Finding:
    """How much stronger than today's the shaking may be until a fall is as probable as 5, 16 and 50 %, by the model.

    `alone`: the analytic model's is none, as it leaves a part of the shaking out ("plane") or others contradict it ("alone").
    """
    soonest, latest = ({**item.factor_at, **at} for at in (item.soonest_at, item.latest_at))
    # A probability that the weakest shaking tried already has is reached by that, or by less.
    weakest = item.factor[0]
    factors = {
        share: [soonest[share], at, latest[share], weakest] for share, at in item.factor_at.items() if at is not None
    }
    kind = "none" if (item.factor_at[FIRST] or math.inf) <= 1.0 else "some"
    if kind == "some" and (soonest[FIRST] or math.inf) <= 1.0:
        kind = "open"
    values = {
        "factors": factors,
        "most": None if factors or soonest[FIRST] else item.factor[-1],
        "soonest": None if factors else soonest[FIRST],
        "undecided": max(item.undecided, default=0.0),
        "model": item.model,
    }
    if alone and item.model == MODEL:
        return caution("reserve", kind=alone, **values)
    return info("reserve", kind=kind, **values) if kind == "some" else caution("reserve", kind=kind, **values)


def clearance(item: ClearanceRecord) -> Finding:
    """How much must be kept clear, in which direction, by the model that knows most of them; and what a fall needs."""
    name, answer = next(iter(item.answered.items()), ("", None))
    if answer is None:
        return caution("clearance", by="none", height_m=item.height_m)
    beyond_m = answer.at(CLEAR)
    values: dict[str, Any] = {"model": name, "height_m": item.height_m}
    if len(beyond_m) == len(PLANAR_DEG):
        right_m, left_m = beyond_m.values()
        return info("clearance", by="plane", right_m=right_m, left_m=left_m, **values)
    towards_deg, most_m = max(beyond_m.items(), key=lambda each: each[1])
    least_m = round(min(beyond_m.values()), 4)  # a tenth of a millimetre is none that anyone keeps free
    return info("clearance", by="space", most_m=most_m, towards_deg=towards_deg, least_m=least_m, **values)


def without_clearance(item: ClearanceRecord) -> Iterator[Finding]:
    """Models of which too few draws stand, and draws that the clearance leaves out."""
    for name, each in item.by_model.items():
        if name not in item.answered:
            yield caution("clearance_few", standing=each.standing, draws=each.draws).of(name)
        if each.undecided:
            yield caution("clearance_undecided", undecided=each.undecided, draws=each.draws).of(name)


def best_option(record: OptionsRecord, *, contradicted: bool = False) -> Finding:
    """The option with the least probable fall, of those shown to help, a draw without an end taken for one: the less slip first;
    what is turned comes last, as its weak side is one that no draw shakes.
    """
    helping = sorted(
        record.helping,
        key=lambda item: (item.probability_overturned + item.undecided, item.name == TURNED, item.slip_high_m or 0.0),
    )
    now = record.as_it_is
    if not helping:
        needed = record.plane_only or contradicted or now.high >= NEGLIGIBLE
        return info("no_option_helps", needed=needed if record.options[1:] else "none_compared")
    best, *others = helping
    return info(
        "best_option",
        option=best.name,
        share=best.probability_overturned,
        undecided=best.undecided or None,
        now=now.probability_overturned if now.tells else None,
        slip_m=best.slip_high_m,
        equal=[item.name for item in others if item.low <= best.high],
    )


def of_options(record: OptionsRecord, *, contradicted: bool = False) -> Iterator[Finding]:
    """What would harm, and the paper's claim: whether a pedestal that slides protects, answered by this statue on the floor."""
    if record.plane_only:
        yield caution("options_in_plane")
    elif contradicted and record.model == MODEL:
        yield caution("options_contradicted")
    if record.harming:
        yield caution("options_harm", options=[item.name for item in record.harming])
    floor = next((item for item in record.options if item.name == FLOOR), None)
    if floor is not None:
        yield pedestal_effect(record.as_it_is, floor)


def pedestal_effect(own: OptionAnswer, floor: OptionAnswer) -> Finding:
    """Whether the pedestal protects by sliding."""
    shown = "protects" if floor.harms else "endangers" if floor.helps else "not_shown"
    if own.undecided > MOSTLY or not own.slip_high_m:
        shown = "undecided" if own.undecided > MOSTLY else "stuck"
    shares = {"own": own.probability_overturned, "floor": floor.probability_overturned}
    return info("pedestal_effect", shown=shown, undecided=own.undecided, **shares)
