"""Why a body in space leaves the planar model: each thing that the plane leaves out is taken away, and space asked again."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Final

import numpy as np

from analytic.excitation import ZeroExcitation
from harness import engines
from harness.comparison.distance import errors
from harness.engines.base import EngineFailure
from harness.model.options import RunOptions
from harness.model.run import Run
from harness.model.scene import Scene
from harness.records.scores import ROBUST, Scores

LEAST: Final = 1e-9
"""Share of the inertia's trace, or of the base's width, below which products or a skewed base are rounding."""


def _without_products(scene: Scene) -> Scene | None:
    tensor = scene.statue.inertia_tensor_kg_m2
    diagonal = np.diag(np.diag(tensor))
    if np.max(np.abs(tensor - diagonal)) <= LEAST * np.trace(tensor):
        return None
    return scene.but(statue=replace(scene.statue, inertia_tensor_kg_m2=diagonal))


def _along_the_plane(scene: Scene) -> Scene | None:
    if isinstance(scene.base_excitation.y, ZeroExcitation):
        return None
    return scene.but(base_excitation=replace(scene.base_excitation, y=ZeroExcitation()))


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
    return scene.but(statue=replace(s, footprint_m=base, solid=None))


TAKEN_AWAY: Final[Mapping[str, Callable[[Scene], Scene | None]]] = {
    "the products of inertia": _without_products,
    "the floor's motion across the plane": _along_the_plane,
    "the outline of the base": _on_edges,
}
"""What the plane leaves out, and the scene without it; None where the scene has none of it."""


def reasons(scene: Scene, runs: Mapping[str, Run], scores: Mapping[str, Scores]) -> list[str]:
    """For each 3D engine that differs robustly from the planar model in its rotation: which of `TAKEN_AWAY` is why."""
    said = []
    for each in scores.values():
        sides = {engines.load(name).capabilities.dimensions: name for name in (each.a, each.b)}
        if each.verdict not in ROBUST or each.evidence.differs_in != "rotation" or set(sides) != {2, 3}:
            continue
        if engines.load(sides[2]).capabilities.certifies:
            said += _reason(scene, runs[sides[2]], runs[sides[3]], each)
    return said


def _reason(scene: Scene, plane: Run, space: Run, scores: Scores) -> list[str]:
    until_s = min(plane.bounded_until_s, space.bounded_until_s, plane.end_s, space.end_s)
    with_all = errors(plane, space, until_s)[0]
    changed = {what: taken for what, take in TAKEN_AWAY.items() if (taken := take(scene)) is not None}
    again = {what: _again(taken, space, until_s) for what, taken in changed.items()}
    apart = {what: errors(plane, run, until_s)[0] for what, run in again.items() if run is not None}
    known = {what: value for what, value in apart.items() if math.isfinite(value)}
    if not (math.isfinite(with_all) and known):
        return []
    pair = f"{space.engine} and {plane.engine}"
    each = ", ".join(f"{value:.2g} rad without {what}" for what, value in known.items())
    measured = f"up to {until_s:.3g} s they are {with_all:.2g} rad apart, {each}"
    least = min(known, key=lambda what: known[what])
    if known[least] <= scores.evidence.limit_rad:
        return [f"{pair} differ because of {least}, which the plane leaves out: {measured}"]
    return [f"{pair} differ by more than any one thing that the plane leaves out: {measured}"]


def _again(scene: Scene, run: Run, until_s: float) -> Run | None:
    """A scene computed by a run's engine with that run's step; None where it cannot."""
    engine, dt_s = engines.load(run.engine), run.settings.get("dt_s")
    settings = engine.settings_for_dt(scene, float(dt_s)) if dt_s else engine.refinement_levels(scene)[-1]
    try:
        return engine.simulate(scene, settings, RunOptions(stop=lambda t_s, _: t_s > until_s))
    except EngineFailure:
        return None
