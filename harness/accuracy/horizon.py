"""How long a model can predict a scene at all: perturbed starts of that model alone."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np

from harness.engines.base import Engine, EngineFailure, Settings
from harness.model.history import History, Outcome
from harness.model.history_pair import first_beyond_s, pair
from harness.model.options import RunOptions
from harness.model.run import Run, number
from harness.model.scene import Scene
from harness.records.run import HorizonRecord

PERTURBATIONS: Final = (1e-9, 1e-7, 1e-5, 1e-3)
"""Sizes of the perturbations: from what rounding does in some thousand steps to what no measurement could tell."""
TOLERANCE_RAD: Final = 0.01
"""Rotation to which a prediction is asked: 1.5 cm at the top of a statue of 1.5 m."""


def perturbed(scene: Scene, size: float) -> tuple[Scene, ...]:
    """The scene with slightly other starts: rotation + size (rad), rate + size·p (rad/s), and all motion times 1 ± size.

    p = √(mgR/J) is the statue's frequency parameter. A statue at rest forgets a perturbed start as soon as it rests again, so
    its motion is perturbed as well.
    """
    statue, start = scene.statue, scene.initial
    side = 1 if start.theta_rad >= 0.0 else -1
    arm = math.hypot(statue.corner_m(side), statue.centroid_height_m)
    p = math.sqrt(statue.mass_kg * scene.gravity_m_s2 * arm / scene.pivot_inertia_kg_m2[side])
    leaning = replace(scene, initial=start.plus(side * size, 0.0))
    if start.pose is not None:
        leaning = replace(scene, initial=start.plus(0.0, -size * p))
    thrown = replace(scene, initial=start.plus(0.0, size * p))
    if scene.base_excitation.still:
        return leaning, thrown
    return leaning, thrown, shaken(scene, 1.0 + size), shaken(scene, 1.0 - size)


def shaken(scene: Scene, factor: float) -> Scene:
    """The scene with all its motion multiplied by a factor."""
    return replace(scene, base_excitation=scene.base_excitation.scaled(factor))


def horizon(
    scene: Scene,
    run: Callable[[Scene], Run],
    *,
    tolerance_rad: float = TOLERANCE_RAD,
    perturbations: Sequence[float] = PERTURBATIONS,
) -> HorizonRecord:
    """The horizon of a model, `run` being that model with its settings; perturbed runs that fail are left out and counted.

    Raises `EngineFailure` when the unperturbed run has no history.
    """
    reference = run(scene)
    if reference.history is None:
        raise EngineFailure(reference.message or "the unperturbed run has no history")
    sizes = tuple(sorted(perturbations))
    outcomes = {reference.outcome}
    until: list[float] = []
    rates: list[float] = []
    failed = 0
    for size in sizes:
        times = []
        for variant in perturbed(scene, size):
            other = _tried(run, variant)
            if other is None or other.history is None:
                failed += 1
                continue
            outcomes.add(other.outcome)
            times.append(parted_s(other.history, reference.history, tolerance_rad))
        times_parted = [t for t in times if t is not None]
        until.append(min(times_parted, default=scene.duration_s))
        if times_parted and size < tolerance_rad and until[-1] > 0.0:
            rates.append(math.log(tolerance_rad / size) / until[-1])
    # A larger perturbation cannot be predicted for longer; where chance lets it, the shorter time holds.
    least = np.minimum.accumulate(until)
    growth = float(np.mean(rates)) if rates else None
    return HorizonRecord(
        tolerance_rad,
        scene.duration_s,
        sizes,
        tuple(least.tolist()),
        growth,
        tuple(sorted(outcomes)),
        failed,
        float(least[0]),
    )


def _tried(run: Callable[[Scene], Run], scene: Scene) -> Run | None:
    try:
        perturbed_run = run(scene)
    except EngineFailure:
        return None
    # A run that ends because no mode was found, or that was given up, has no path that could part from another.
    ended = perturbed_run.outcome.failed or perturbed_run.outcome is Outcome.FRICTION_PARADOX
    given_up = perturbed_run.outcome is Outcome.UNDECIDED and perturbed_run.end_s < scene.duration_s
    return None if ended or given_up else perturbed_run


def parted_s(a: History, b: History, tolerance_rad: float) -> float | None:
    """When two histories are first further apart than the tolerance; a shorter one parts at its end, None: never."""
    both = pair(a, b)
    apart = first_beyond_s(both.t_s, np.abs(both.difference_rad), tolerance_rad)
    if apart is not None:
        return apart
    shorter = abs(a.duration_s - b.duration_s) > max(np.diff(both.t_s).max(initial=0.0), 1e-9)
    return both.end_s if shorter else None


def horizon_of(engine: Engine, scene: Scene, settings: Settings, **keywords: Any) -> HorizonRecord:
    """The horizon of an engine with its settings (see `horizon`)."""
    options = RunOptions(history=True)
    return horizon(scene, lambda each: engine.simulate(each, settings, options), **keywords)


def horizon_beside(engine: Engine, scene: Scene, run: Run) -> HorizonRecord:
    """The horizon of an engine at the step that `run` took, or at its finest where the engine certifies its own error."""
    if engine.capabilities.certifies:
        return horizon_of(engine, scene, engine.refinement_levels(scene)[-1])
    return horizon_of(engine, scene, engine.settings_for_dt(scene, number(run.settings, "dt_s")))
