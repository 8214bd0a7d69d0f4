"""Why the analytic model and pymunk differ in outcome on the 600 tests.

`python -m tests.harness.questions.validate.measure_causes` measures it.

Runs both on 600 tests of scanned stones under sine bursts at 800 Hz (pymunk at a step of 1 ms), then, on those that differ
only, pymunk at shorter steps, the analytic model on the whole silhouette and under slightly other motions, and counts each test
under the first cause that holds. With `--folder DIR` the files stay there; `--samples N` takes the first N motions of each
stone. Results go to standard output.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from analytic.excitation import Excitation
from harness.accuracy.horizon import parted_s
from harness.accuracy.simulation import simulate
from harness.engines import analytic as twoblock
from harness.model.history import Outcome
from harness.model.run import Run, RunOptions
from harness.model.scene import Scene
from harness.questions.validate.scenes import Variant, scene_of
from harness.questions.validate.table import read_table
from meshes.footprint import lower_chain
from tests.harness.questions.validate.experiments import write_motion, write_table
from tests.measures.invented_stones import write_scan

STONES, MOTIONS = 6, 100
STEPS_S: Final = (1e-3, 5e-4, 2.5e-4, 1.25e-4)
OTHER: Final = (-1e-5, -1e-7, 1e-7, 1e-5)
"""Motions that no table can tell from the nominal one."""
APART_RAD: Final = 0.05
"""A fifth of these stones' slenderness: two histories further apart are on different ways."""
CAUSES: Final = (
    "pymunk's step: at 0.25 and 0.125 ms it gives the model's outcome",
    "unpredictable: the outcome flips under motions 1e-5 or less apart, or with pymunk's three shorter steps",
    "silhouette: on the whole silhouette the model gives pymunk's outcome at 0.125 ms",
    "domain: the model slid or lifted off before the histories parted",
    "none of these",
)


def write_tests(folder: Path) -> list[dict[str, object]]:
    """The scans and motions of the table, and its rows, all of them said to have stood."""
    stream = np.random.default_rng(1)
    for stone in range(STONES):
        write_scan(folder / f"stone{stone}.ply", stone)
    for motion in range(MOTIONS):
        amplitude, frequency = stream.uniform(1.0, 12.0), stream.uniform(1.0, 5.0)
        write_motion(folder / f"motion{motion}.csv", amplitude_m_s2=amplitude, frequency_hz=frequency, cycles=5)
    return [
        {"test": f"s{stone}m{motion}", "mesh": f"stone{stone}.ply", "motion": f"motion{motion}.csv", "column": "table",
         "motion_unit": "m/s2", "observed": "stands", "friction": 0.6, "duration_s": 8}
        for stone in range(STONES) for motion in range(MOTIONS)
    ]  # fmt: skip


def _analytic(scene: Scene, *, history: bool = False) -> Run:
    return simulate(scene, "analytic", options=RunOptions(history=history))


def _pymunk(scene: Scene, dt_s: float, *, history: bool = False) -> Run:
    return simulate(scene, "pymunk", accuracy_rad=None, dt_s=dt_s, options=RunOptions(history=history))


@contextmanager
def whole_silhouette() -> Iterator[None]:
    """The analytic model with every vertex of the silhouette's lower half as its base, whatever the contact tolerance."""
    own = twoblock.block_of

    def block_of(scene: Scene) -> object:
        statue = scene.statue
        chain = lower_chain(statue.section_m)
        low = chain[chain[:, 1] < 0.5 * statue.centroid_height_m]
        return replace(own(scene), profile_m=tuple((float(x), float(z)) for x, z in low))

    twoblock.block_of = block_of  # type: ignore[assignment]
    try:
        yield
    finally:
        twoblock.block_of = own


def _scaled(scene: Scene, factor: float) -> Scene:
    motion: Excitation = scene.base_excitation.x
    return replace(scene, base_excitation=replace(scene.base_excitation, x=motion.scaled(factor)))


def cause(scene: Scene, model: Outcome) -> str:
    """The first of the causes that holds for a test on which the two differ; `model` is the analytic outcome."""
    refinement_levels = [_pymunk(scene, dt).outcome for dt in STEPS_S[1:]]
    if refinement_levels[1] is model and refinement_levels[2] is model:
        return CAUSES[0]
    near = [_analytic(_scaled(scene, 1.0 + by)).outcome for by in OTHER]
    if len(set(refinement_levels)) > 1 or any(outcome is not model for outcome in near):
        return CAUSES[1]
    with whole_silhouette():
        rolled = _analytic(scene).outcome
    if rolled is refinement_levels[-1]:
        return CAUSES[2]
    run = _analytic(scene, history=True)
    other = _pymunk(scene, STEPS_S[-1], history=True)
    left_s = run.validity.get("left_domain_s")
    parted = None if run.history is None or other.history is None else parted_s(run.history, other.history, APART_RAD)
    if model is Outcome.LIFT_OFF or (left_s is not None and parted is not None and left_s <= parted):
        return CAUSES[3]
    return CAUSES[4]


def main() -> None:
    """Run the two models, find the causes, print the shares."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--folder", type=Path)
    parser.add_argument("--samples", type=int, default=MOTIONS)
    asked = parser.parse_args()
    folder = asked.folder or Path(tempfile.mkdtemp(prefix="causes-"))
    folder.mkdir(parents=True, exist_ok=True)
    trials = read_table(write_table(folder / "tests.csv", write_tests(folder)))
    trials = [trial for k, trial in enumerate(trials) if k % MOTIONS < asked.samples]
    start = time.process_time()
    found: dict[str, list[str]] = {name: [] for name in CAUSES}
    fell = {True: 0, False: 0}
    for trial in trials:
        scene = scene_of(trial, Variant(trial.inputs()))
        model, other = _analytic(scene).outcome, _pymunk(scene, STEPS_S[0]).outcome
        if model is other:
            continue
        fell[model.overturned == other.overturned] += 1
        found[cause(scene, model)].append(trial.name)
    differ = sum(len(names) for names in found.values())
    print(json.dumps({"tests": len(trials), "differ": differ, "of these in side only": fell[True]}))
    for name, tests in found.items():
        print(f"{len(tests):4d} {name} ({', '.join(tests)})")
    print(json.dumps({"processor_s": time.process_time() - start}))


if __name__ == "__main__":
    main()
