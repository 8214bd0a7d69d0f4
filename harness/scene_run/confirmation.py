"""Before two models are said to differ, a contact engine's run is made again to a finer target, up to where they differ."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Final

from harness import engines
from harness.accuracy.simulation import DEFAULT_ACCURACY_RAD, RunTarget, simulate_with
from harness.comparison.comparator import compare
from harness.model.run import Run
from harness.model.scene import Scene
from harness.records.scores import ROBUST, Scores

CONFIRMATION_FACTOR: Final = 4.0
"""The finer run's target is this many times smaller: some two halvings of the step."""
SURE: Final = 30.0
"""A difference of this many times its limit is no luck of two runs that agree: none was off by more than twelve times what it
stated on 303 scenes before their sensitivity was asked."""


PAST_S: Final = 0.05
"""The finer run goes so far past where the difference passes its limit: a difference that grows is clear by then."""


def doubted(scores: Iterable[Scores]) -> list[Scores]:
    """The pairs that are said to differ robustly, by less than `SURE` times their limit."""
    return [each for each in scores if each.verdict in ROBUST and _close(each)]


def finer_rad(target: RunTarget) -> float:
    """The accuracy of a run that is made again before models are said to differ."""
    return (target.accuracy_rad or DEFAULT_ACCURACY_RAD) / CONFIRMATION_FACTOR


def finer_runs(
    scene: Scene,
    runs: Mapping[str, Run],
    doubts: Iterable[Scores],
    refinable: set[str],
    target: RunTarget,
    on_progress: Callable[[str], None],
) -> tuple[list[str], dict[str, Run]]:
    """The engines that were run again to a finer target up to where their difference stands, and whole finer runs.

    Only of those whose difference is gone with the finer target a whole finer run is made, which takes the place of the other.
    """
    until_s: dict[str, float] = {}
    for each in doubts:
        for name in {each.a, each.b} & refinable:
            parts_s = scene.duration_s if each.evidence.exceeded_s is None else each.evidence.exceeded_s
            until_s[name] = max(until_s.get(name, 0.0), min(parts_s + PAST_S, scene.duration_s))
    finer = replace(target, accuracy_rad=finer_rad(target))
    again = {}
    for name, end_s in sorted(until_s.items()):
        on_progress(f"{name}, again and finer")
        run = simulate_with(engines.load(name), replace(scene, duration_s=end_s), finer)
        if not run.outcome.failed:
            again[name] = run
    gone = set()
    for each in doubts:
        a, b = (again.get(name, runs[name]) for name in (each.a, each.b))
        apart_s = compare(a, b).evidence.exceeded_s
        if apart_s is None or apart_s > min(a.bounded_until_s, b.bounded_until_s):
            gone |= {each.a, each.b} & again.keys()
    whole = {name: simulate_with(engines.load(name), scene, finer) for name in sorted(gone)}
    return sorted(again), {name: run for name, run in whole.items() if not run.outcome.failed}


def _close(scores: Scores) -> bool:
    seen = scores.evidence
    if seen.differs_in == "slip":
        return seen.largest_reliable_slip_difference_m < SURE * seen.slip_limit_m
    return seen.largest_reliable_difference_rad < SURE * seen.limit_rad
