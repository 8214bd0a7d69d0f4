"""What each rung of the ladder errs by: `expected_error_rad` states the largest of its errors and a finer rung's, and more
on the floor (docs/pybullet_contact.md).

`python -m harness.bench.pybullet_levels` prints them for every scene: the surveyed statue's four cases on the floor and on its
pedestal, with one coefficient of friction, with two, and with a ratio imposed, and the bench's standard set. Errors are of the
rotation over the whole run, against the analytic model, or, for a scan, against a third of the finest rung's step.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from harness.bench.pybullet_settings import CASES, scene_of
from harness.bench.standard_scenes import resolved, standard_set
from harness.engines import load
from harness.model.options import SKIPS, RunOptions
from harness.model.run import Run
from harness.model.scene import Scene

HALF: Final = RunOptions()
WHOLE: Final = RunOptions(skips=frozenset(SKIPS) - {"mirror"})
FINER: Final = 3.0
"""How many times finer than the finest rung's the step of a scan's reference is."""


def scenes() -> Iterator[tuple[str, Scene, bool]]:
    """Each scene's name, the scene, and whether the analytic model is exact for it."""
    for amplitude_g, frequency_hz in CASES:
        name = f"{amplitude_g} g, {frequency_hz:g} Hz"
        yield f"{name}, floor", scene_of(amplitude_g, frequency_hz, pedestal=False), True
        yield f"{name}, pedestal", scene_of(amplitude_g, frequency_hz), True
        yield f"{name}, two coefficients", scene_of(amplitude_g, frequency_hz, static=0.20), True
        for ratio in (0.85, 0.90):
            yield f"{name}, ratio {ratio}", scene_of(amplitude_g, frequency_hz, static=0.20, ratio=ratio), True
    for item, scene in resolved(standard_set())[0]:
        yield item.name, scene, item.reference == "analytic"


def error_rad(run: Run, truth: Run) -> float:
    """Largest difference of two rotations up to where the first of them ends, rad. Raises `ValueError` without histories."""
    if run.history is None or truth.history is None:
        raise ValueError("both runs must have kept their histories")
    times = run.history.t_s[run.history.t_s <= truth.end_s]
    return float(np.max(np.abs(run.history.at(times) - truth.history.at(times))))


def reference(scene: Scene, exact: bool) -> Run:
    """The analytic model's finest run, or one of pybullet's own with a finer step than any rung's."""
    if exact:
        engine = load("analytic")
        return engine.simulate(scene, engine.refinement_levels(scene)[-1], HALF)
    engine = load("pybullet")
    return engine.simulate(scene, engine.settings_for_dt(scene, engine.refinement_levels(scene)[-1].dt_s / FINER), HALF)


def errors_rad(scene: Scene, truth: Run) -> list[float]:
    """The larger error of half and whole of a scene on every rung, rad."""
    engine = load("pybullet")
    return [
        max(error_rad(engine.simulate(scene, level, want), truth) for want in (HALF, WHOLE))
        for level in engine.refinement_levels(scene)
    ]


def line(name: str, found: Sequence[float]) -> str:
    """A scene's row."""
    return " ".join(f"{value:8.1e}" for value in found) + f"  {name}\n"


def kind(scene: Scene) -> str:
    """Which of the ladder's rows a scene belongs to."""
    if not scene.planar:
        return "a scan, or motion across"
    return "on the floor" if scene.pedestal is None else "on a pedestal"


def main() -> None:
    """Print each scene's errors as they are found, then for each kind of scene the largest of every rung and what it states."""
    largest: dict[str, list[float]] = {}
    stated: dict[str, list[float]] = {}
    for name, scene, exact in scenes():
        found, of = errors_rad(scene, reference(scene, exact)), kind(scene)
        largest[of] = [max(pair) for pair in zip(found, largest.get(of, found), strict=True)]
        stated[of] = [level.expected_error_rad for level in load("pybullet").refinement_levels(scene)]
        sys.stdout.write(line(name, found))
        sys.stdout.flush()
    for of, errors in largest.items():
        sys.stdout.write(line(f"{of}: largest", errors) + line(f"{of}: stated", stated[of]))


if __name__ == "__main__":
    main()
