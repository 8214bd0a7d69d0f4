"""Why a body in space leaves the planar model: each thing that the plane leaves out is taken away, and space asked again."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache, partial
from typing import Final

import numpy as np

from analytic.excitation import ZeroExcitation
from harness import engines
from harness.accuracy.horizon import settings_of
from harness.accuracy.refinement import DEFAULT_ACCURACY_RAD, simulate
from harness.comparison.comparator import CODES, compare
from harness.comparison.scores import errors
from harness.engines.base import EngineFailure
from harness.model import Finding, Run, RunOptions, Scene, caution, history
from harness.records.scores import ROBUST, Evidence, Scores, Verdict

LEAST: Final = 1e-9
"""Share of the inertia's trace, or of the base's width, below which products or a skewed base are rounding."""
REMAINDER: Final = 0.25
"""Share of a difference that may stay without its cause, where it first passes its limit (of the shipped statue 2 to 14 % do).
What stays grows on from there, by itself and by the step of one run, whose error no second one bounds. And"""
MOSTLY: Final = 0.5
"""Share of a difference that may stay where the engine states its error without all that the plane leaves out, and still differs:
what stays is then less than the error that it stated with it."""
TOGETHER: Final = "together"
"""The cause where several are taken away at once."""
LITTLE: Final = 0.1
"""what of it is as good as none."""


def _without_products(scene: Scene) -> Scene | None:
    tensor = scene.statue.inertia_tensor_kg_m2
    diagonal = np.diag(np.diag(tensor))
    if np.max(np.abs(tensor - diagonal)) <= LEAST * np.trace(tensor):
        return None
    return replace(scene, statue=replace(scene.statue, inertia_tensor_kg_m2=diagonal))


def _along_the_plane(scene: Scene) -> Scene | None:
    if isinstance(scene.base_excitation.y, ZeroExcitation):
        return None
    return replace(scene, base_excitation=scene.base_excitation.in_plane())


def _on_edges(scene: Scene) -> Scene | None:
    """The statue on a rectangle between its two corners: their edges lie across the plane."""
    s = scene.statue
    left, right, half = -s.corner_left_m, s.corner_right_m, 0.5 * s.depth_m
    base = np.array([[left, -half, 0.0], [right, -half, 0.0], [right, half, 0.0], [left, half, 0.0]])
    mirrored = np.sort(np.round(s.footprint_m[:, [0, 2]] / s.depth_m, 9), axis=0)
    if len(s.footprint_m) == len(base) and np.allclose(
        mirrored, np.sort(base[:, [0, 2]] / s.depth_m, axis=0), atol=LEAST
    ):
        return None
    return replace(scene, statue=replace(s, footprint_m=base, solid=None))


TAKEN_AWAY: Final[Mapping[str, Callable[[Scene], Scene | None]]] = {
    "products_of_inertia": _without_products,
    "motion_across": _along_the_plane,
    "base_outline": _on_edges,
}
"""What the plane leaves out, and the scene without it; None where the scene has none of it."""


class TakenAway:
    """The runs of 3D engines again, without each thing that the scene has of what the plane leaves out; each is made once."""

    def __init__(self, scene: Scene, accuracy_rad: float = DEFAULT_ACCURACY_RAD) -> None:
        self.scene = scene
        self.runs = cache(partial(_without_each, scene))
        """The runs beside that of a 3D engine."""
        self.without_all = cache(partial(_without_all, scene, accuracy_rad))
        """A 3D engine's run until some time without any of it, its error stated."""


def explained(runs: Mapping[str, Run], scores: Mapping[str, Scores], taken: TakenAway) -> set[str]:
    """The pairs whose robust difference goes with what is taken away."""
    return {
        pair
        for pair, (plane, space) in _planar_and_spatial(runs, scores).items()
        if _judged(plane, space, scores[pair].evidence, taken)[0] is not Verdict.MODEL
    }


def with_reasons(runs: Mapping[str, Run], scores: Mapping[str, Scores], taken: TakenAway) -> dict[str, Scores]:
    """The scores of pairs; of each planar and 3D answer that differ robustly, found which of `TAKEN_AWAY` is why.

    Where one is, it is no longer two models that differ, but what one of them leaves out. They differ by their models where they
    do so by more than their errors in the scene without any of it, too.
    """
    judged = dict(scores)
    for pair, (plane, space) in _planar_and_spatial(runs, scores).items():
        each = scores[pair]
        verdict, reasons = _judged(plane, space, each.evidence, taken)
        found = [*each.findings, *(reason.of(pair) for reason in reasons)]
        if verdict is Verdict.PLANE:
            found[0] = replace(found[0], code=CODES[verdict].code)
        elif verdict is Verdict.UNBOUNDED:
            found[0] = caution("pair_cause_not_shown", **found[0].values, space=space.engine).of(pair)
        if verdict is not Verdict.MODEL:
            each = replace(each, verdict=verdict)
        judged[pair] = replace(each, findings=found)
    return judged


def _judged(plane: Run, space: Run, evidence: Evidence, taken: TakenAway) -> tuple[Verdict, list[Finding]]:
    """Why a planar and a 3D run differ robustly, and what shows it.

    A single run's error may hide what the plane leaves out: where no cause is found by runs of the same step, the engine states
    its error in the scene without any of it.
    """
    reasons = _reason(plane, space, taken.runs(space), evidence)
    if _caused(reasons):
        return Verdict.PLANE, reasons
    every = [what for what, take in TAKEN_AWAY.items() if take(taken.scene) is not None]
    if not every or plane.numerical_uncertainty_rad is None or space.numerical_uncertainty_rad is None:
        return Verdict.MODEL, reasons
    until_s = _parted_s(plane, space, evidence)
    again = taken.without_all(space.engine, until_s)
    if again.outcome.failed:
        return Verdict.UNBOUNDED, reasons
    alone = compare(plane, again)
    parted_s = alone.evidence.exceeded_s
    differ = parted_s is not None and parted_s <= until_s and alone.verdict in ROBUST
    if not differ and _end_s(again) < until_s:
        return Verdict.UNBOUNDED, reasons
    cause = every[0] if len(every) == 1 else TOGETHER
    due = _reason(plane, space, {cause: again}, evidence, most=MOSTLY if differ else math.inf)
    return (Verdict.PLANE, due) if _caused(due) or not differ else (Verdict.MODEL, reasons)


def _caused(reasons: Sequence[Finding]) -> bool:
    return any(each.code == "plane_cause" for each in reasons)


def _planar_and_spatial(runs: Mapping[str, Run], scores: Mapping[str, Scores]) -> dict[str, tuple[Run, Run]]:
    """Of the pairs of a planar and a 3D answer that differ robustly the two runs."""
    pairs = {}
    for pair, each in scores.items():
        sides = {engines.load(name).capabilities.dimensions: name for name in (each.a, each.b)}
        if each.verdict in ROBUST and each.evidence.differs_in and set(sides) == {2, 3}:
            pairs[pair] = runs[sides[2]], runs[sides[3]]
    return pairs


def _without_each(scene: Scene, space: Run) -> dict[str, Run]:
    """The run of a 3D engine again, without each thing that the scene has of what the plane leaves out."""
    changed = {what: taken for what, take in TAKEN_AWAY.items() if (taken := take(scene)) is not None}
    again = {what: _again(taken, space, _end_s(space)) for what, taken in changed.items()}
    return {what: run for what, run in again.items() if run is not None}


def _without_all(scene: Scene, accuracy_rad: float, engine: str, until_s: float) -> Run:
    """The run of a 3D engine to an accuracy, without any of what the plane leaves out."""
    bare = scene
    for take in TAKEN_AWAY.values():
        bare = take(bare) or bare
    return simulate(replace(bare, duration_s=until_s), engine, accuracy_rad=accuracy_rad)


def _end_s(run: Run) -> float:
    return min(run.bounded_until_s, run.end_s)


def _parted_s(plane: Run, space: Run, evidence: Evidence) -> float:
    """When two that differ robustly first do so, or the end of what is known of both."""
    slips = evidence.differs_in == "slip"
    limit = evidence.slip_limit_m if slips else evidence.limit_rad
    return min(_end_s(plane), _end_s(space), _seen_s(plane, space, limit, slips=slips))


def _reason(
    plane: Run, space: Run, again: Mapping[str, Run], evidence: Evidence, most: float = REMAINDER
) -> list[Finding]:
    """The cause without which the two are nearest, if at most a share of the difference is left; how far apart without each."""
    slips = evidence.differs_in == "slip"
    until_s = _parted_s(plane, space, evidence)

    def apart(run: Run) -> float:
        return errors(plane, run, until_s)[1 if slips else 0]

    with_all = apart(space)
    known = {what: value for what, run in again.items() if math.isfinite(value := apart(run))}
    if not (0.0 < with_all < math.inf and known):
        return []
    least = min(known, key=lambda what: known[what])
    shares = {what: value / with_all for what, value in known.items()}
    if known[least] > most * with_all:
        return [caution("plane_several_causes", until_s=until_s, share_without=shares)]
    return [caution("plane_cause", cause=least, whole=shares[least] <= LITTLE, until_s=until_s, share_without=shares)]


def _seen_s(plane: Run, space: Run, size: float, *, slips: bool) -> float:
    """When their rotations, or slips, are first so far apart; infinite where they never are, or have no histories."""
    if plane.history is None or space.history is None:
        return math.inf
    both = history.pair(plane.history, space.history)
    apart = np.abs(both.slip_a_m - both.slip_b_m if slips else both.difference_rad)
    beyond = np.flatnonzero(apart > size)
    return float(both.t_s[beyond[0]]) if beyond.size else math.inf


def _again(scene: Scene, run: Run, until_s: float) -> Run | None:
    """A scene computed by a run's engine with that run's step; None where it cannot."""
    engine = engines.load(run.engine)
    try:
        return engine.simulate(scene, settings_of(engine, scene, run), RunOptions(stop=lambda t_s, _: t_s > until_s))
    except EngineFailure:
        return None
