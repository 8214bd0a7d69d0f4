"""Why a body in space leaves the planar model: each thing that the plane leaves out is taken away, and space asked again."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from analytic.excitation import ZeroExcitation
from harness import engines
from harness.comparison.distance import errors
from harness.comparison.verdict import mm_text, rad_text
from harness.engines.base import EngineFailure
from harness.model.options import RunOptions
from harness.model.run import Run, number
from harness.model.scene import Scene
from harness.records.scores import ROBUST, Evidence, Scores

LEAST: Final = 1e-9
"""Share of the inertia's trace, or of the base's width, below which products or a skewed base are rounding."""
REMAINDER: Final = 0.1
"""Share of a difference that may stay without its cause: it grows on from what else is left out, and from the step of one run."""


def _without_products(scene: Scene) -> Scene | None:
    tensor = scene.statue.inertia_tensor_kg_m2
    diagonal = np.diag(np.diag(tensor))
    if np.max(np.abs(tensor - diagonal)) <= LEAST * np.trace(tensor):
        return None
    return replace(scene, statue=replace(scene.statue, inertia_tensor_kg_m2=diagonal))


def _along_the_plane(scene: Scene) -> Scene | None:
    if isinstance(scene.base_excitation.y, ZeroExcitation):
        return None
    return replace(scene, base_excitation=replace(scene.base_excitation, y=ZeroExcitation()))


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
    "the products of inertia": _without_products,
    "the floor's motion across the plane": _along_the_plane,
    "the outline of the base": _on_edges,
}
"""What the plane leaves out, and the scene without it; None where the scene has none of it."""


@dataclass
class TakenAway:
    """The runs of 3D engines again, without each thing that the scene has of what the plane leaves out; each is made once."""

    scene: Scene
    made: dict[int, dict[str, Run]] = field(default_factory=dict)

    def runs(self, space: Run) -> dict[str, Run]:
        """The runs beside that of a 3D engine."""
        if id(space) not in self.made:
            self.made[id(space)] = _without_each(self.scene, space)
        return self.made[id(space)]


def explained(runs: Mapping[str, Run], scores: Mapping[str, Scores], taken: TakenAway) -> set[str]:
    """The pairs whose robust difference goes, all or most of it, with one of `TAKEN_AWAY`."""
    found = set()
    for pair, (plane, space) in _planar_and_spatial(runs, scores).items():
        with_all, limit, known = _apart(plane, space, taken.runs(space), scores[pair].evidence)
        if math.isfinite(with_all) and known and min(known.values()) <= max(limit, REMAINDER * with_all):
            found.add(pair)
    return found


def with_reasons(runs: Mapping[str, Run], scores: Mapping[str, Scores], taken: TakenAway) -> dict[str, Scores]:
    """The scores of pairs; of each planar and 3D answer that differ robustly, told which of `TAKEN_AWAY` is why."""
    judged = dict(scores)
    for pair, (plane, space) in _planar_and_spatial(runs, scores).items():
        each = scores[pair]
        reason = _reason(plane, space, taken.runs(space), each.evidence)
        judged[pair] = replace(each, verdict_sentence=each.verdict_sentence + reason)
    return judged


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


def _end_s(run: Run) -> float:
    return min(run.bounded_until_s, run.end_s)


def _apart(
    plane: Run, space: Run, again: Mapping[str, Run], evidence: Evidence
) -> tuple[float, float, dict[str, float]]:
    """How far the two are apart in what they differ in, the limit of that, and how far they are without each thing."""
    slips = evidence.differs_in == "slip"
    until_s = min(_end_s(plane), _end_s(space))

    def apart(run: Run) -> float:
        return errors(plane, run, until_s)[1 if slips else 0]

    known = {what: value for what, run in again.items() if math.isfinite(value := apart(run))}
    return apart(space), evidence.slip_limit_m if slips else evidence.limit_rad, known


def _reason(plane: Run, space: Run, again: Mapping[str, Run], evidence: Evidence) -> str:
    with_all, limit, known = _apart(plane, space, again, evidence)
    slips, until_s = evidence.differs_in == "slip", min(_end_s(plane), _end_s(space))
    text = mm_text if slips else rad_text
    if not (math.isfinite(with_all) and known):
        return ""
    each = ", ".join(f"{text(value)} without {what}" for what, value in known.items())
    measured = f"up to {until_s:.3g} s {'their slips' if slips else 'they'} are {text(with_all)} apart, {each}"
    least = min(known, key=lambda what: known[what])
    if known[least] > max(limit, REMAINDER * with_all):
        return f" They differ by more than any one thing that the plane leaves out: {measured}."
    mostly = "" if known[least] <= limit else "mostly "
    return f" They differ {mostly}because of {least}, which the plane leaves out: {measured}."


def _again(scene: Scene, run: Run, until_s: float) -> Run | None:
    """A scene computed by a run's engine with that run's step; None where it cannot."""
    engine, dt_s = engines.load(run.engine), number(run.settings, "dt_s", 0.0)
    settings = engine.settings_for_dt(scene, dt_s) if dt_s else engine.refinement_levels(scene)[-1]
    try:
        return engine.simulate(scene, settings, RunOptions(stop=lambda t_s, _: t_s > until_s))
    except EngineFailure:
        return None
