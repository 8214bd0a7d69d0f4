"""Whether finer steps are worth their cost: by how errors grow in the analytic model, and by what a climb's comparisons show."""

from __future__ import annotations

import math
from typing import Final

from harness import engines
from harness.accuracy.horizon import parted_s, perturbed
from harness.accuracy.spread import PLAIN_ORDER, Error, Spread
from harness.engines.base import EngineFailure
from harness.model.options import RunOptions
from harness.model.run import Run, number
from harness.model.scene import Scene

LEAST_COMPARED: Final = 3
"""Comparisons before a climb is given up: the gain of one step to the next, which two tell, is luck where runs part at events."""
MOST_ORDER: Final = 2.0
"""Highest order that two differences are taken to show."""

MODEL: Final = "analytic"
"""Its runs take milliseconds: it tells how errors grow in a scene."""
PERTURBED_SHARE: Final = 0.03
"""Start and motion are perturbed by this share of what a level is expected to err by. On the paper's conditions with a pedestal a
run of 1 ms parts from its neighbours as the model parts from itself under a tenth of that: with less no climb is given up that
could succeed."""


def outgrows(scene: Scene, error_rad: float, target_rad: float) -> bool:
    """Whether errors as small as these grow past the target before the scene ends, or before there is no return from a fall.

    By the analytic model's own runs with perturbed starts and motions; no, where it refuses the scene or has left its domain by
    then.
    """
    model = engines.load(MODEL)
    try:
        settings = model.refinement_levels(scene)[-1]
        run = model.simulate(scene, settings, RunOptions())
        if run.history is None:
            return False
        until_s = min(last_s(run), number(run.validity, "left_domain_s", math.inf))
        for variant in perturbed(scene, PERTURBED_SHARE * error_rad):
            other = model.simulate(variant, settings, RunOptions())
            apart_s = None if other.history is None else parted_s(other.history, run.history, target_rad)
            if apart_s is not None and apart_s < until_s:
                return True
    except EngineFailure:
        return False
    return False


def hopeless(spreads: list[Spread], end_s: float, finest_dt_s: float, target: Error) -> bool:
    """Whether no level is expected to reach `end_s`, by what all comparisons together gained: two of them tell luck.

    A small difference grows in proportion to itself, so each halving of the step gains about the same time; unless what
    parts the runs is an event whose error falls with the step.
    """
    if len(spreads) < LEAST_COMPARED or spreads[-1].whole or _falls(spreads, finest_dt_s, target):
        return False
    first, last = spreads[0], spreads[-1]
    reached_s = max(item.until_s for item in spreads)
    gained = (reached_s - first.until_s) / math.log(first.coarse_dt_s / last.coarse_dt_s)
    possible = gained * math.log(max(last.coarse_dt_s / finest_dt_s, 1.0))
    return possible < end_s - reached_s


def beyond(spreads: list[Spread], finest_dt_s: float, target: Error) -> bool:
    """Whether the finest level would miss the target even if the last difference fell at the highest order."""
    if not spreads:
        return False
    share: float = (finest_dt_s / spreads[-1].fine_dt_s) ** MOST_ORDER
    return spreads[-1].stated_to_the_end.share_of(target) * min(share, 1.0) > 1.0


def _falls(spreads: list[Spread], finest_dt_s: float, target: Error) -> bool:
    """Whether the largest difference of two runs falls with the step, so fast that the finest level should do."""
    known = [item for item in spreads if 0.0 < item.apart.share_of(target) < math.inf]
    if len(known) < 2:
        return False
    first, last = known[0], known[-1]
    now, then = last.stated_to_the_end.share_of(target), first.stated_to_the_end.share_of(target)
    order = math.log(then / now) / math.log(first.coarse_dt_s / last.coarse_dt_s)
    expected = now * (finest_dt_s / last.coarse_dt_s) ** min(order, MOST_ORDER)
    return order >= PLAIN_ORDER and expected <= 1.0


def last_s(run: Run) -> float:
    """Until when a run is to be bounded: its end, or where there is no return from a fall."""
    return run.end_s if run.no_return_time_s is None else min(run.no_return_time_s, run.end_s)
