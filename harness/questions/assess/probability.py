"""How probable a fall is: by a model on every draw, and by an engine from few runs of its own, in strata by what the model says.

The model's answer to a draw costs nothing beside an engine's, and tells much of it. The draws are divided by the model's answer
into strata of known weight; the engine is run on some draws of each; P = Σ w_h p_h (Cochran, Sampling Techniques, ch. 5). The
estimate is unbiased whatever the model says: a wrong model costs runs, not truth. Runs go where w_h √(p_h (1 − p_h)) is largest
(Neyman).
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from statistics import NormalDist
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from harness import engines
from harness.accuracy.refinement import first_level
from harness.comparison.statistics import wilson
from harness.engines.base import Engine, EngineFailure
from harness.model import Outcome, Run, RunOptions, Scene
from harness.questions.assess.clearance import Ints, reach_m
from harness.questions.assess.model_draws import (
    ENGINE_ERROR_RAD,
    SPACE,
    SPACE_S,
    Array,
    ModelDraws,
    draws_of,
    model_draws,
    row,
    shaken_across,
    space_draws,
    uncertain_inputs,
    varied,
)
from harness.records.assess import Assessment
from harness.runs.task import RunRequest, Task, TaskResult, request_key

if TYPE_CHECKING:
    from harness.runs.execute import Campaign

SAFE_SHARE: Final = 0.6
"""Peak rotation of the model, over α, below which its statue is far from falling: a stratum of its own."""
PILOT: Final = 10
"""Runs of every stratum before any is judged."""
BATCH: Final = 16
"""Runs between two looks at the interval, on however many cores: what is answered is no matter of the machine."""
LEVEL: Final = 0.90
"""Level of every interval: what decides about a statue is asked to ± 0.05 at 90 %."""

End = bool | Outcome | None
"""How an engine's run of a draw ended: whether the statue falls, `TOUCHES_WALL`, None without an answer."""
Runs = Callable[[Sequence[int]], Sequence[End]]
"""From numbers of draws to how the engine's runs of them ended."""


def strata_of(model: ModelDraws) -> Ints:
    """Number of each draw's stratum, shape (n,): far from falling, near it (or not decided), overturned."""
    near = ~model.overturned & ((model.peak_share >= SAFE_SHARE) | ~model.decided)
    return np.where(model.overturned, 2, np.where(near, 1, 0))


def estimate(model: ModelDraws, run: Runs, *, half_width: float, most_runs: int, batch: int = BATCH) -> Assessment:
    """Run the engine on draws until the interval's half width is reached, or `most_runs` are made."""
    strata = strata_of(model)
    queues = [np.flatnonzero(strata == h).tolist() for h in range(3)]
    tally = _Tally(np.bincount(strata, minlength=3) / strata.size)
    tally.add(run, [(h, queues[h].pop(0)) for h in range(3) for _ in range(min(PILOT, len(queues[h])))])
    while tally.runs < most_runs and tally.half_width > half_width:
        picks: list[tuple[int, int]] = []
        pending = np.zeros(3)
        while len(picks) < min(batch, most_runs - tally.runs) and any(queues):
            h = tally.neediest(pending, [bool(queue) for queue in queues])
            pending[h] += 1
            picks.append((h, queues[h].pop(0)))
        if not picks:
            break
        tally.add(run, picks)
    return tally.estimate(strata.size)


def jeffreys(fell: float, runs: float, level: float = LEVEL) -> tuple[float, float, float]:
    """The share that fell of so many runs (a half of none), and its interval at a level (Jeffreys)."""
    from scipy.special import betaincinv

    tail, missed = 0.5 - 0.5 * level, runs - fell
    low = float(betaincinv(fell + 0.5, missed + 0.5, tail)) if fell else 0.0
    high = float(betaincinv(fell + 0.5, missed + 0.5, 1.0 - tail)) if missed else 1.0
    return fell / runs if runs else 0.5, low, high


class _Tally:
    """Runs and falls of each stratum (3,), of known weights."""

    def __init__(self, weights: Array) -> None:
        self._weights, self.runs = weights, 0
        self._decided, self._fell, self._open, self._walls = np.zeros((4, weights.size))

    def add(self, run: Runs, picks: Sequence[tuple[int, int]]) -> None:
        """Run the engine on these draws and count."""
        for (h, _), fell in zip(picks, run([draw for _, draw in picks]), strict=True):
            self.runs += 1
            if not isinstance(fell, bool):
                self._open[h] += 1
                self._walls[h] += fell is Outcome.TOUCHES_WALL
            else:
                self._decided[h] += 1
                self._fell[h] += fell

    def neediest(self, pending: Array, left: Sequence[bool]) -> int:
        """Of the strata with draws that are left, the one in which one more run takes most off the variance."""
        runs = self._decided + pending + 1.0
        return int(np.argmax(np.where(left, self._weights**2 * self._spread() / (runs * (runs + 1.0)), -1.0)))

    def _spread(self) -> Array:
        """p (1 − p), p drawn towards a half by two runs (Agresti and Coull): never nothing, however few the runs."""
        p = (self._fell + 1.0) / (self._decided + 2.0)
        return np.asarray(p * (1.0 - p))

    @property
    def half_width(self) -> float:
        """Half width at which runs end, of a normal interval: wider than the one told, so what fell so far moves the end less."""
        variance = np.sum(self._weights**2 * self._spread() / np.maximum(self._decided, 1.0))
        return NormalDist().inv_cdf(0.5 + 0.5 * LEVEL) * math.sqrt(variance)

    def estimate(self, draws: int) -> Assessment:
        """The probability so far, of so many draws; no number where every run came to no end.

        Its interval is that of Σ w p_h from those of each p_h (Jeffreys), arms added as squares (Zou, Huang and Zhang 2009).
        """
        known = self._decided > 0.0
        runs = np.maximum(self._open + self._decided, 1.0)
        undecided, wall = (float(self._weights @ (each / runs)) for each in (self._open, self._walls))
        if not known.any():
            return Assessment(math.nan, 0.0, 1.0, LEVEL, draws, self.runs, 1.0, touches_wall=wall)
        share, low, high = np.array([jeffreys(*each) for each in zip(self._fell, self._decided, strict=True)]).T
        p = float(np.sum((self._weights * share)[known]) / np.sum(self._weights[known]))
        middle = float(self._weights @ share)
        below, above = (math.hypot(*(self._weights * arms)) for arms in (share - low, high - share))
        least, most = max(middle - below, 0.0) * (1.0 - undecided), min(middle + above, 1.0)
        high = max(most + undecided * (1.0 - most), p)
        return Assessment(p, min(least, p), high, LEVEL, draws, self.runs, undecided, touches_wall=wall)


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
        campaign: Campaign,
        on_progress: Callable[[str], None],
    ) -> None:
        self._scene, self._name, self._values = scene, name, values
        self._campaign, self._on_progress = campaign, on_progress
        self._engine = engines.load(name)
        self.fell: dict[int, End] = {}
        self.reach_m: dict[int, Array] = {}

    def __call__(self, numbers: Sequence[int]) -> list[End]:
        requests = [RunRequest(varied(self._scene, row(self._values, number)), self._name) for number in numbers]
        tasks = [
            Task(request_key(each.made(), self._engine, OUTCOME, ENGINE_ERROR_RAD), overturns, each, self._name)
            for each in requests
        ]
        for number, found in zip(numbers, self._campaign.ask(tasks), strict=True):
            # A worker that died leaves nothing: the run counts as failed, and is tried anew when the assessment is.
            record = found or {"overturned": None}
            overturned = record["overturned"]
            wall = Outcome.TOUCHES_WALL if record.get("touches_wall") else None
            self.fell[number] = wall if overturned is None else bool(overturned)
            if overturned is False:
                self.reach_m[number] = np.array(record["reach_m"])
        self._on_progress(f"{self._name}: {len(self.fell)} runs")
        return [self.fell[number] for number in numbers]


def run_of(engine: Engine, scene: Scene) -> Run | None:
    """An engine's run of a draw, at the coarsest step that is expected to do; None where it fails."""
    try:
        settings, _ = first_level(engine.refinement_levels(scene), ENGINE_ERROR_RAD, 1.0)
        return engine.simulate(scene, settings, RunOptions())
    except EngineFailure:
        return None


def end_of(run: Run | None) -> End:
    """How a run of a draw ended."""
    if run is None:
        return None
    return run.outcome if run.outcome is Outcome.TOUCHES_WALL else run.outcome.fell


def overturns(drawn: RunRequest) -> TaskResult:
    """What a worker does: whether the statue overturns in its scene, and how far it goes where it stands."""
    begin, scene = time.perf_counter(), drawn.made()
    run, reached = run_of(engines.load(drawn.engine), scene), None
    fell = None if run is None else run.outcome.fell
    if run is not None and fell is False and (history := run.history) is not None:
        reached = reach_m(scene, history.theta_rad, history.slip_m, history.extra).tolist()
    seconds, failed = time.perf_counter() - begin, run is None or run.outcome.failed
    touches = run is not None and run.outcome is Outcome.TOUCHES_WALL
    ended = {"overturned": fell, "reach_m": reached, "touches_wall": touches}
    return TaskResult(OUTCOME, ended, seconds, inside_s=seconds, failed=failed)


# The probability beside every single run: the analytic model's, and in three dimensions the exact body's.
#
# A draw in which the model leaves its domain before a fall is decided is no answer of the model: a contact engine answers a
# sample of such draws, P = Σ fell/n + w q, where w is their share and q what falls of the sample; what neither answers is open,
# and counts as standing in the interval's low end, as falling in its high one.

MODEL: Final = "analytic"
RUN_DRAWS: Final = 10_000
"""Draws beside every single run: ± 0.8 % at a half, in half a second for a harmonic motion of 10 s."""
SAMPLER: Final = "pymunk"
"""The engine that answers draws outside the model's domain: in the plane, with all that the model leaves out there."""
OPEN: Final = 0.02
"""Share of draws outside the model's domain that needs no answer: it widens the interval by no more."""
SAMPLE_STEPS: Final = 50_000
"""Steps of the engine's runs beside a single run, a count so that an answer is the same wherever it is computed: 20 runs of a
motion of 10 s at 4 ms."""
SAMPLE_S: Final = 2.0
"""What they take of the processor, s, as a forecast tells it."""
MOST_SAMPLED: Final = 60
NONE_SAMPLED: Final[Mapping[int, End]] = {}
TRIAL_SHARE: Final = 0.01
"""Of the draws are timed before all of them are run."""


def assess_models(scene: Scene, draws: int = RUN_DRAWS, *, leaves_plane: bool = False) -> dict[str, Assessment]:
    """The analytic model's own probability, and the exact body's where the scene is shaken across its rocking plane or a run has
    shown that its statue leaves it.

    Empty where nothing of the scene is uncertain, or it begins from a pose in space.
    """
    inputs = uncertain_inputs(scene)
    if not inputs or scene.initial.pose is not None:
        return {}
    values = draws_of(scene, inputs, draws, seed=0)
    model = model_draws(scene, values)
    leaves_plane |= shaken_across(scene)
    space = space_draws(scene, values) if leaves_plane else None
    # What the planar model leaves open is asked of nobody where the exact body answers.
    fell = sampled(model, lambda number: varied(scene, row(values, number))) if space is None else NONE_SAMPLED
    answers = {MODEL: probability_of(model, fell, plane_only=leaves_plane)}
    return answers if space is None else {**answers, SPACE: probability_of(space)}


def assessed_s(scene: Scene) -> float:
    """Processor seconds that `assess_models` is expected to take: timed on a share of its draws."""
    from analytic import AnalyticInputError

    inputs = uncertain_inputs(scene)
    if not inputs or scene.initial.pose is not None:
        return 0.0
    values = draws_of(scene, inputs, RUN_DRAWS, seed=0)
    size = next(iter(values.values())).size
    some = {key: column[: math.ceil(TRIAL_SHARE * size)] for key, column in values.items()}
    try:
        model_draws(scene, some)  # the first time its code is loaded
    except AnalyticInputError:  # the model refuses this scene; its own run says why
        return 0.0
    begin = time.process_time()
    model = model_draws(scene, some)
    seconds = (time.process_time() - begin) * size / model.left.size
    return seconds + (SPACE_S if shaken_across(scene) else SAMPLE_S * bool(model.left.mean() > OPEN))


def sampled(model: ModelDraws, scene_of: Callable[[int], Scene]) -> dict[int, End]:
    """How the engine's runs end, by number of the draw, in the first draws outside the model's domain: as many as
    `SAMPLE_STEPS` allows, none where they are few. `scene_of` gives the scene of a draw."""
    engine, fell = engines.load(SAMPLER), dict[int, End]()
    if model.left.size == 0 or model.left.mean() <= OPEN or engine.missing() is not None:
        return fell
    steps = 0
    for number in np.flatnonzero(model.left)[:MOST_SAMPLED].tolist():
        if steps >= SAMPLE_STEPS:
            break
        run = run_of(engine, scene_of(number))
        fell[number] = end_of(run)
        steps += 0 if run is None else run.steps
    return fell


class Outside(NamedTuple):
    """What an engine's sample answers of the draws outside the model's domain, as shares of all draws: what falls, with its
    interval, what nobody answers, and what of that touches the wall.
    """

    falls: float
    low: float
    high: float
    undecided: float
    wall: float = 0.0

    @classmethod
    def of(cls, model: ModelDraws, fell: Mapping[int, End], level: float = LEVEL) -> Outside:
        """Of the draws, where `fell` holds the engine's runs by number of the draw."""
        runs = [fell[number] for number in np.flatnonzero(model.left).tolist() if number in fell]
        ends = [each for each in runs if isinstance(each, bool)]
        size, left, unknown = model.decided.size, int(model.left.sum()), int((~model.decided).sum())
        answers = left * len(ends) / len(runs) if runs else 0.0
        answered = answers / size
        falls, low, high = (answered * share for share in jeffreys(sum(ends), len(ends), level))
        walls = left / size * runs.count(Outcome.TOUCHES_WALL) / len(runs) if runs else 0.0
        return cls(falls, low, high, max(unknown - answers, 0.0) / size, walls)


def probability_of(
    model: ModelDraws,
    fell: Mapping[int, End] = NONE_SAMPLED,
    engine: str = SAMPLER,
    *,
    plane_only: bool = False,
) -> Assessment:
    """The share of the draws that overturn, by the model where it answers and by the engine's runs (`fell`, by number of the
    draw) where the model left its domain, with its interval. Raises `ValueError` without draws."""
    size, fallen = model.overturned.size, int(model.overturned.sum())
    outside, runs = Outside.of(model, fell), int(model.left[list(fell)].sum())
    own, most = wilson(fallen, size, LEVEL), wilson(fallen + round(outside.undecided * size), size, LEVEL)
    if own is None or most is None:
        raise ValueError("a probability without draws")
    p = own.value + outside.falls
    below = math.hypot(own.value - own.low, outside.falls - outside.low)
    above = math.hypot(most.high - most.value, outside.high - outside.falls)
    return Assessment(
        probability_overturned=p,
        low=max(p - below, 0.0),
        high=min(p + outside.undecided + above, 1.0),
        level=LEVEL,
        draws=size,
        engine_runs=size,
        undecided=outside.undecided,
        plane_only=plane_only,
        left_domain=float(model.left.mean()),
        sampler=engine if runs else "",
        sampled=runs,
        touches_wall=float(model.wall.mean()) + outside.wall,
    )
