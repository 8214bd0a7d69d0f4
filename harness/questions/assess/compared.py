"""Options set against the scene as it is, by the analytic model with common random numbers."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from statistics import NormalDist
from types import MappingProxyType
from typing import Final, NamedTuple

import numpy as np

from harness.model.scene import Scene, Uncertain
from harness.questions.assess.by_model import SAMPLER, Outside, probability_of, sampled
from harness.questions.assess.in_space import shaken_across
from harness.questions.assess.inputs import LEAST_SHARE, Array, draw, row, uncertain_inputs
from harness.questions.assess.model_draws import (
    SLOW_DRAWS,
    Flags,
    ModelDraws,
    joined,
    model_draws,
    repeated,
    sweepable,
)
from harness.questions.assess.options import AS_IT_IS, Option
from harness.questions.assess.stratified import LEVEL
from harness.questions.assess.variation import KINETIC, STATIC, varied
from harness.records.assess import OptionAnswer, OptionsRecord
from harness.records.scores import Interval
from harness.statics.bodies import sliding

DIFFERENCE_LEVEL: Final = 0.99
"""Level of a difference's interval: of ten options without effect, one table in ten then names one."""
HIGH: Final = 0.95
"""The quantile of the pedestal's slip that is told beside the median."""
ALIKE: Final = ("contact.", "motion.", "initial.")
"""Keys whose draws are the same before and after a statue or a pedestal is changed."""
NEW_KEYS: Final = 2_000_003
"""Added to the seed where an option brings an uncertain number that the scene as it is does not have."""


class Answered(NamedTuple):
    """What the model says of each draw, and whether the statue falls by an engine in the first of those outside its domain."""

    model: ModelDraws
    fell: Mapping[int, bool | None] = MappingProxyType({})


def compare(
    scene: Scene,
    inputs: Sequence[Uncertain],
    options: Sequence[Option],
    left_out: Mapping[str, str],
    values: Mapping[str, Array],
    own: Answered,
    *,
    seed: int = 0,
    on_progress: Callable[[str], None] = lambda text: None,
) -> OptionsRecord:
    """Every option's probability of a fall and its slip, and its difference to the scene as it is, draw by draw.

    `values` (n,) are the draws of the scene as it is, and `own` what was answered of them; `seed` is that of both.
    """
    answers = [answer_of(None, own, None)]
    others: dict[str, ModelDraws | None] = {}
    for option in options:
        on_progress(f"option {option.name}")
        others[option.name] = _at_once(scene, inputs, option, values, seed)
    # What needs a scene made anew for each draw is done for all such options together: reading a scan costs most.
    slow = [option for option in options if others[option.name] is None]
    others |= _one_by_one(scene, slow, values) if slow else {}
    for option in options:
        if (other := others[option.name]) is not None:
            # The one body that may slide is no scene of an engine's: its floor is what the pedestal stands on.
            fell = {} if option.slides else sampled(other, _scenes_of(scene, inputs, option, values, seed))
            answers.append(answer_of(option, Answered(other, fell), own))
    across = shaken_across(scene)
    return OptionsRecord(answers, own.model.overturned.size, LEVEL, DIFFERENCE_LEVEL, dict(left_out), across)


def _scenes_of(
    scene: Scene, inputs: Sequence[Uncertain], option: Option, values: Mapping[str, Array], seed: int
) -> Callable[[int], Scene]:
    """The option's scene in a draw, by its number."""
    if not option.user:
        return lambda number: option.change(varied(scene, row(values, number)))
    other = option.change(scene)
    drawn = common(inputs, values, uncertain_inputs(other), seed)
    return lambda number: varied(other, row(drawn, number))


def option_draws(
    scene: Scene, inputs: Sequence[Uncertain], option: Option, values: Mapping[str, Array], seed: int = 0
) -> ModelDraws:
    """What the model says of an option on draws (n,) of the scene as it is (where each is a scene read again, on the first)."""
    at_once = _at_once(scene, inputs, option, values, seed)
    return _one_by_one(scene, [option], values)[option.name] if at_once is None else at_once


def _at_once(
    scene: Scene, inputs: Sequence[Uncertain], option: Option, values: Mapping[str, Array], seed: int
) -> ModelDraws | None:
    """All draws of an option as draws of its own scene; None where drawing and changing do not commute."""
    other = option.change(scene)
    if option.user:
        drawn = common(inputs, values, uncertain_inputs(other), seed)
        first = None if sweepable(other, drawn) else SLOW_DRAWS
        return model_draws(other, {key: column[:first] for key, column in drawn.items()})
    same_bodies = other.statue is scene.statue and other.pedestal in (scene.pedestal, None)
    if sweepable(scene, values) and (same_bodies or all(key.startswith(ALIKE) for key in values)):
        swept = common(inputs, values, _moved(inputs, other), seed)
        if not swept or sweepable(other, swept):
            return _slipping(other, swept, scene, len(next(iter(values.values()))), option.slides)
    return None


def _one_by_one(scene: Scene, options: Sequence[Option], values: Mapping[str, Array]) -> dict[str, ModelDraws]:
    """Each draw's scene made first and then changed, on the first draws."""
    parts: dict[str, list[ModelDraws]] = {option.name: [] for option in options}
    for k in range(min(SLOW_DRAWS, len(next(iter(values.values()))))):
        drawn = varied(scene, row(values, k))
        for option in options:
            parts[option.name].append(_slipping(option.change(drawn), {}, drawn, 1, option.slides))
    return {name: joined(several) for name, several in parts.items()}


def _slipping(other: Scene, values: Mapping[str, Array], scene: Scene, size: int, slides: bool) -> ModelDraws:
    """The draws of a body: of one that may slide, those whose friction is below the least slenderness slide and stand.

    A free body on the floor lifts at g b/h and slides at g μ, whichever comes first (Ishiyama 1982); the model of one body
    knows no sliding.
    """
    rocking = repeated(model_draws(other, values), size)
    if not slides:
        return rocking
    static = np.broadcast_to(values.get("contact.floor", scene.contact.floor_static), size)
    least = math.tan(min(other.statue.slenderness_rad(side) for side in (1, -1)))
    path, slips = repeated(model_draws(sliding(other), values), size), static < least
    return ModelDraws(*(np.where(slips, slid, rocked) for slid, rocked in zip(path, rocking, strict=True)))


def _moved(inputs: Sequence[Uncertain], other: Scene) -> list[Uncertain]:
    """The scene's inputs as an option leaves them: friction has its own median, what is gone is not drawn."""
    relevant = [item for item in inputs if other.pedestal is not None or not item.key.startswith("pedestal.")]
    contact = other.contact
    medians = {"contact.floor": contact.floor_static, STATIC: contact.floor_static, KINETIC: contact.floor_kinetic}
    return [replace(item, value=medians.get(item.key, item.value)) for item in relevant]


def common(
    inputs: Sequence[Uncertain], values: Mapping[str, Array], own: Sequence[Uncertain], seed: int
) -> dict[str, Array]:
    """The draws of an option from those of the scene as it is: moved with a lognormal's median or another's mean.

    Only a number that the scene as it is does not draw, or draws otherwise, has draws of its own.
    """
    known = {(item.key, item.kind, item.width): item for item in inputs}
    size = len(next(iter(values.values())))
    fresh = [item for item in own if (item.key, item.kind, item.width) not in known]
    result = draw(fresh, size, seed + NEW_KEYS)
    for item in own:
        before = known.get((item.key, item.kind, item.width))
        if before is None:
            continue
        column = values[item.key]
        if item.kind == "lognormal":
            result[item.key] = column * (item.value / before.value)
        else:
            moved = column + (item.value - before.value)
            result[item.key] = np.maximum(moved, LEAST_SHARE * item.value) if item.value > 0.0 else moved
    return result


def answer_of(option: Option | None, answered: Answered, before: Answered | None) -> OptionAnswer:
    """What is told of an option (None: the scene as it is), by its draws and the same ones of the scene as it is."""
    model, fell = answered
    share = probability_of(model, SAMPLER, fell)
    if share is None:
        raise ValueError("an option without draws")
    shown = Option(AS_IT_IS, lambda scene: scene) if option is None else option
    median_m, high_m = None, None
    if np.isfinite(model.peak_slip_m).all():
        median_m, high_m = (float(value) for value in np.quantile(model.peak_slip_m, (0.5, HIGH)))
    change = None if before is None else difference_of(answered, before)
    interval = share.probability_overturned, share.low, share.high
    told = shown.name, shown.values, shown.source
    return OptionAnswer(*told, share.draws, *interval, median_m, high_m, change, share.undecided)


def difference_of(answered: Answered, before: Answered) -> Interval:
    """The probability of a fall less the one before, of the same draws; where one comes to no end it may be either."""
    size = min(answered.model.overturned.size, before.model.overturned.size)
    paired = paired_difference(answered.model.overturned[:size], before.model.overturned[:size])
    now, then = (Outside.of(*each, DIFFERENCE_LEVEL) for each in (answered, before))
    value = paired.value + now.falls - then.falls
    below = math.hypot(paired.value - paired.low, now.falls - now.low, then.high - then.falls) + then.undecided
    above = math.hypot(paired.high - paired.value, now.high - now.falls, then.falls - then.low) + now.undecided
    return Interval(value, max(value - below, -1.0), min(value + above, 1.0), DIFFERENCE_LEVEL)


def paired_difference(fell: Flags, before: Flags, level: float = DIFFERENCE_LEVEL) -> Interval:
    """The probability of a fall less the one before, of the same draws, with its interval.

    Half a draw is added to each of the four cells (Agresti and Min, Statistics in Medicine 24, 2005): the interval has a width
    where no draw differs, too. Its middle is the plain difference, so that both numbers of a table agree.
    """
    more, fewer = int(np.sum(fell & ~before)), int(np.sum(before & ~fell))
    size = fell.size + 2.0
    shift = (more - fewer) / size
    variance = ((more + fewer + 1.0) / size - shift**2) / size
    half = NormalDist().inv_cdf(0.5 + 0.5 * level) * math.sqrt(variance)
    plain = (more - fewer) / fell.size
    return Interval(plain, max(min(shift - half, plain), -1.0), min(max(shift + half, plain), 1.0), level)
