"""Is the stated numerical uncertainty honest, and what does a target take? Seeded scenes, each against a much finer run.

`python -m tests.measures.coverage ENGINE [FIRST COUNT] [--levels]` prints a line of JSON per scene, then (on stderr) how many of
them held; with `--levels` each level is run too, as the bench does.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict, replace
from typing import Final

import numpy as np

from analytic.block import GRAVITY_M_S2
from analytic.excitation import Excitation, Harmonic, Pulse, SampledAcceleration
from harness import engines
from harness.accuracy.refinement import run_to_accuracy
from harness.comparison.scores.pointwise import error_rad, errors
from harness.engines.base import Engine, EngineFailure
from harness.model.run import Run, RunOptions
from harness.model.scene import BaseExcitation, Contact, Form, Pedestal, Scene, Statue
from harness.questions.bench.bench_run import FIRST_SEED, SCENES
from harness.questions.bench.precision import TARGET_RAD
from harness.records.bench import Coverage, LevelRow, Statement

REFERENCE_STEP_DIVISOR: Final = 5.0
"""The run that stands for the truth has a step this many times finer than the finest of the target's own two."""
FINEST_S: Final = 2.5e-4
"""Step of the finest level that is compared: the share of what it takes is clear by then, and finer ones take the most."""
DURATION_S: Final = 3.0


def statement(run: Run, truth: Run) -> Statement:
    """A run's statement against the run that stands for the truth."""
    until_s = run.bounded_until_s
    rotation, slip = errors(run, truth, until_s)
    return Statement(
        run.engine, run.outcome.value, run.settings.get("dt_s"), int(run.work.get("runs", 1)),
        int(run.work.get("steps_of_all_runs", run.steps)), run.numerical_uncertainty_rad or 0.0,
        run.slip_uncertainty_m or 0.0, until_s, run.end_s, rotation, slip, run.validity.get("plain_from_s"),
    )  # fmt: skip


def coverage(engine: Engine, accuracy_rad: float, seeds: Sequence[int], levels: bool = False) -> Iterator[Coverage]:
    """For each seed run to the accuracy, then against a finer run of the same engine, and say whether the statement held.

    Without the scenes of which no history was kept. `levels` runs each level too.
    """
    for seed in seeds:
        scene = random_scene(seed)
        begin = time.process_time()
        run = run_to_accuracy(engine, scene, accuracy_rad, RunOptions())
        cpu_s = time.process_time() - begin
        truth = truth_of(engine, scene, run, run.bounded_until_s)
        if run.history is None or truth.history is None:
            continue
        row = Coverage(engine.name, seed, accuracy_rad, statement(run, truth), cpu_s)
        yield replace(row, levels=tuple(_levels(engine, scene, truth))) if levels and met_whole(row) else row


def met_whole(row: Coverage) -> bool:
    """Whether the target is met to the end of the run."""
    return row.stated is not None and row.stated.share >= 1.0 and row.stated.stated_rad <= row.target_rad


def truth_of(engine: Engine, scene: Scene, run: Run, until_s: float, finest_s: float = 0.0) -> Run:
    """A much finer run of the same engine up to a time, its step not below the finest; of one that certifies, its finest."""
    if engine.capabilities.certifies:
        return engine.simulate(scene, engine.refinement_levels(scene)[-1], RunOptions())
    settings = engine.settings_for_dt(scene, max(float(run.settings["dt_s"]) / REFERENCE_STEP_DIVISOR, finest_s))
    return engine.simulate(scene, settings, RunOptions(stop=lambda t_s, _: t_s > until_s))


def _levels(engine: Engine, scene: Scene, truth: Run) -> Iterator[LevelRow]:
    """Each level down to `FINEST_S`: its error and what it takes, timed once, after the run to the target."""
    for settings in engine.refinement_levels(scene):
        if settings.dt_s < FINEST_S:
            return
        begin = time.process_time()
        try:
            run = engine.simulate(scene, settings, RunOptions())
        except EngineFailure as failure:
            yield LevelRow(settings.dt_s, str(failure))
            continue
        cpu_s = time.process_time() - begin
        yield LevelRow(settings.dt_s, None, error_rad(run, truth), cpu_s)


def random_scene(seed: int, duration_s: float = DURATION_S) -> Scene:
    """A reproducible scene: a statue of any size and asymmetry, pedestal or none, any friction, harmonic, pulse or record."""
    rng = np.random.default_rng(seed)
    height = rng.uniform(0.3, 1.2)
    left, right = height * rng.uniform(0.08, 0.5, 2)
    mass = rng.uniform(50.0, 900.0)
    depth = 0.8 * (left + right)
    inertia = mass * (height**2 + 0.25 * (left + right) ** 2) / 3.0 * rng.uniform(0.7, 1.2)
    statue = block(mass, float(left), float(right), height, inertia, depth)
    pedestal = None
    if rng.random() < 0.5:
        width = (left + right) * rng.uniform(1.1, 2.0)
        pedestal = Pedestal(mass * rng.uniform(0.2, 1.5), float(width), depth, height * rng.uniform(0.1, 0.4))
    kinetic = rng.uniform(0.08, 0.4)
    static = kinetic * rng.uniform(1.0, 1.4)
    limit = GRAVITY_M_S2 * min(left, right) / height
    excitation = BaseExcitation(x=_excitation(rng, limit * rng.uniform(1.1, 4.0)))
    return seeded(f"seed {seed}", duration_s, statue, pedestal, Contact(static, kinetic, 2.0), excitation)


def block(mass: float, left: float, right: float, height: float, inertia: float, depth: float) -> Statue:
    """A rectangular body of the given centroid height and corners, twice as high as its centroid."""
    top, half = 2.0 * height, 0.5 * depth
    section = np.array([[-left, 0.0], [right, 0.0], [right, top], [-left, top]])
    footprint = np.array([[-left, -half, 0.0], [right, -half, 0.0], [right, half, 0.0], [-left, half, 0.0]])
    across, along = mass * (left + right) ** 2 / 12.0, mass * depth**2 / 12.0
    tensor = np.diag([inertia - across + along, inertia, across + along])
    return Statue(mass, height, left, right, inertia, top, depth, section, footprint, tensor)


def seeded(
    title: str, duration_s: float, statue: Statue, pedestal: Pedestal | None, contact: Contact, motion: BaseExcitation
) -> Scene:
    """A scene of the model's consistent form, on earth."""
    return Scene(title, duration_s, GRAVITY_M_S2, Form(), statue, pedestal, contact, motion)


def _excitation(rng: np.random.Generator, peak_m_s2: float) -> Excitation:
    kind = int(rng.integers(3))
    if kind == 0:
        return Harmonic(peak_m_s2, float(rng.uniform(0.8, 5.0)))
    if kind == 1:
        return Pulse("one_sine", peak_m_s2, float(rng.uniform(0.2, 1.2)), float(rng.uniform(0.0, 0.5)))
    times = np.linspace(0.0, DURATION_S, 151)
    noise = rng.normal(size=times.size)
    smooth = np.convolve(noise, np.hanning(9), mode="same") * np.sin(np.pi * times / DURATION_S)
    return SampledAcceleration(times, peak_m_s2 * smooth / np.max(np.abs(smooth)))


def main(arguments: Sequence[str]) -> None:
    """Print the rows of an engine's seeds as they are measured, then the count."""
    name, *numbers = (word for word in arguments if word != "--levels")
    first, count = (int(item) for item in numbers) if numbers else (FIRST_SEED, SCENES)
    engine, levels = engines.load(name), "--levels" in arguments
    if levels:
        # What is loaded and compiled once is not the first scene's cost.
        scene = random_scene(first)
        engine.simulate(scene, engine.refinement_levels(scene)[0], RunOptions())
    missed: list[int] = []
    scenes = 0
    for row in coverage(engine, TARGET_RAD, range(first, first + count), levels):
        scenes += 1
        missed += [] if row.covered else [row.seed]
        print(json.dumps(asdict(row)), flush=True)
    held = scenes - len(missed)
    print(f"{name}: the error lay within the statement on {held} of {scenes}; not on {missed}", file=sys.stderr)


if __name__ == "__main__":
    main(sys.argv[1:])
