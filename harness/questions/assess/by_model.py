"""The probability beside every single run: the analytic model's, and in three dimensions the exact body's.

A draw in which the model leaves its domain before a fall is decided is no answer of the model: a contact engine answers a
sample of such draws, P = Σ fell/n + w q, where w is their share and q what falls of the sample; what neither answers is open,
and counts as standing in the interval's low end, as falling in its high one.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from typing import Final, NamedTuple

import numpy as np

from harness import engines
from harness.comparison.statistics.distributions import wilson
from harness.model.history import Outcome
from harness.model.scene import Scene
from harness.questions.assess.engine_draws import LEVEL, End, jeffreys, run_of
from harness.questions.assess.model_draws import (
    SPACE,
    SPACE_S,
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
    fell = sampled(model, lambda number: varied(scene, row(values, number)))
    leaves_plane |= shaken_across(scene)
    answers = {MODEL: probability_of(model, fell, plane_only=leaves_plane)}
    space = space_draws(scene, values) if leaves_plane else None
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
    return seconds + SAMPLE_S * bool(model.left.mean() > OPEN) + SPACE_S * shaken_across(scene)


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
        touches = run is not None and run.outcome is Outcome.TOUCHES_WALL
        fell[number] = Outcome.TOUCHES_WALL if touches else None if run is None else run.outcome.fell
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
