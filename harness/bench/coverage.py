"""Is the stated numerical uncertainty honest? Seeded scenes, each against a much finer run of the same engine.

`python -m harness.bench.coverage ENGINE [FIRST COUNT]` prints a line per scene, then how many of them held.
"""

from __future__ import annotations

import json
import math
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from analytic.constants import GRAVITY_M_S2
from analytic.excitation import Excitation, Harmonic, Pulse, SampledAcceleration, ZeroExcitation
from harness import engines
from harness.accuracy.refinement import run_to_accuracy
from harness.engines.base import Engine
from harness.model.options import RunOptions
from harness.model.run import Run
from harness.model.scene import BaseExcitation, Contact, Form, Pedestal, Scene, Statue

DURATION_S: Final = 3.0
FINER: Final = 5.0
"""The run that stands for the truth has a step this many times finer than the finest of the ladder's own two."""
FIRST_SEED: Final = 20_900
"""Scenes from here on were not used to choose the ladder or the safety factor."""
SCENES: Final = 200
TARGET_RAD: Final = 1e-3
_WIDE: Final = 17
"""Keeps the seeds of wide scenes apart from those of the others."""


@dataclass(frozen=True)
class Row:
    """One scene: what was stated and what was found; `covered`: both errors stay within the statement while it holds."""

    seed: int
    engine: str
    outcome: str
    target_rad: float
    stated_rad: float
    reliable_until_s: float
    error_rad: float
    stated_m: float
    error_m: float
    covered: bool
    met_whole: bool
    dt_s: float
    runs: int
    steps: int
    wall_s: float

    def as_dict(self) -> dict[str, Any]:
        """The row as plain values."""
        return dict(vars(self))


@dataclass(frozen=True)
class Case:
    """A seeded scene, its run to an accuracy with the processor time that this took, and a run that stands for the truth."""

    seed: int
    scene: Scene
    run: Run
    truth: Run
    cpu_s: float


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
    base_excitation = BaseExcitation(x=_motion(rng, limit * rng.uniform(1.1, 4.0)), z=ZeroExcitation())
    return Scene(
        title=f"seed {seed}",
        duration_s=duration_s,
        gravity_m_s2=GRAVITY_M_S2,
        form=Form(),
        statue=statue,
        pedestal=pedestal,
        contact=Contact(static, kinetic, 2.0),
        base_excitation=base_excitation,
    )


def wide_scene(seed: int, duration_s: float = DURATION_S) -> Scene:
    """A reproducible scene wider than `random_scene`: sizes 0.1 to 5 m, slenderness 1 to 12 (one in five below 2), any friction.

    Pedestals of 0.05 to 3 statues' mass, half of them with one coefficient of friction; motions by the statue's own
    frequency, records along all three axes; a statue that may slip on its support. Not all stay in the model's domain.
    """
    rng = np.random.default_rng([seed, _WIDE])
    height = 0.5 * _log_uniform(rng, 0.1, 5.0)
    slenderness = _log_uniform(rng, 1.0, 2.0) if rng.random() < 0.2 else _log_uniform(rng, 2.0, 12.0)
    base = 2.0 * height / slenderness
    left = base * float(rng.uniform(0.3, 0.7))
    right, depth = base - left, base * float(rng.uniform(0.6, 1.5))
    mass = 2000.0 * 2.0 * height * base * depth
    inertia = mass * (4.0 * height**2 + base**2) / 12.0 * float(rng.uniform(0.7, 1.2))
    statue = block(mass, left, right, height, inertia, depth)
    pedestal = None
    if rng.random() < 0.6:
        width, tall = base * float(rng.uniform(1.1, 2.5)), height * float(rng.uniform(0.1, 0.5))
        pedestal = Pedestal(mass * _log_uniform(rng, 0.05, 3.0), width, 1.2 * depth, tall)
    kinetic = _log_uniform(rng, 0.05, 1.0)
    static = kinetic if rng.random() < 0.5 else kinetic * float(rng.uniform(1.0, 1.4))
    on_support = 2.0 if rng.random() < 0.5 else _log_uniform(rng, 0.3, 1.0)
    own_rad_s = math.sqrt(mass * GRAVITY_M_S2 * math.hypot(height, 0.5 * base) / (inertia + mass * height**2))
    peak = GRAVITY_M_S2 * min(left, right) / height * float(rng.uniform(1.05, 3.0))
    base_excitation = _wide_motion(rng, peak, own_rad_s * _log_uniform(rng, 1.0, 8.0) / (2.0 * math.pi))
    return Scene(
        title=f"wide seed {seed}",
        duration_s=duration_s,
        gravity_m_s2=GRAVITY_M_S2,
        form=Form(),
        statue=statue,
        pedestal=pedestal,
        contact=Contact(static, kinetic, on_support),
        base_excitation=base_excitation,
    )


def _log_uniform(rng: np.random.Generator, least: float, most: float) -> float:
    return float(math.exp(rng.uniform(math.log(least), math.log(most))))


def _wide_motion(rng: np.random.Generator, peak_m_s2: float, frequency_hz: float) -> BaseExcitation:
    """A harmonic, a pulse or a record of the given peak along x and main frequency; a record moves along y and z, too."""
    kind = int(rng.integers(3))
    if kind == 0:
        return BaseExcitation(x=Harmonic(peak_m_s2, frequency_hz))
    if kind == 1:
        return BaseExcitation(x=Pulse("one_sine", peak_m_s2, 1.0 / frequency_hz, float(rng.uniform(0.0, 0.3))))
    axes = [_noise(rng, share * peak_m_s2, frequency_hz) for share in (1.0, *rng.uniform(0.2, 0.6, 2))]
    # More than half of gravity upwards and downwards is a question of flight, not of rocking.
    axes[2] = axes[2].scaled(min(1.0, 0.5 * GRAVITY_M_S2 / axes[2].peak_m_s2))
    return BaseExcitation(*axes)


def _noise(rng: np.random.Generator, peak_m_s2: float, frequency_hz: float) -> SampledAcceleration:
    """Smoothed noise between no motion at both ends of `DURATION_S`; its samples follow the frequency."""
    count = round(8.0 * frequency_hz * DURATION_S) + 9
    times = np.linspace(0.0, DURATION_S, count)
    smooth = np.convolve(rng.normal(size=count), np.hanning(7), mode="same") * np.sin(np.pi * times / DURATION_S)
    return SampledAcceleration(times, peak_m_s2 * smooth / np.max(np.abs(smooth)))


def block(mass: float, left: float, right: float, height: float, inertia: float, depth: float) -> Statue:
    """A rectangular body of the given centroid height and corners, twice as high as its centroid."""
    top, half = 2.0 * height, 0.5 * depth
    section = np.array([[-left, 0.0], [right, 0.0], [right, top], [-left, top]])
    footprint = np.array([[-left, -half, 0.0], [right, -half, 0.0], [right, half, 0.0], [-left, half, 0.0]])
    across, along = mass * (left + right) ** 2 / 12.0, mass * depth**2 / 12.0
    tensor = np.diag([inertia - across + along, inertia, across + along])
    return Statue(mass, height, left, right, inertia, top, depth, section, footprint, tensor)


def _motion(rng: np.random.Generator, peak_m_s2: float) -> Excitation:
    kind = int(rng.integers(3))
    if kind == 0:
        return Harmonic(peak_m_s2, float(rng.uniform(0.8, 5.0)))
    if kind == 1:
        return Pulse("one_sine", peak_m_s2, float(rng.uniform(0.2, 1.2)), float(rng.uniform(0.0, 0.5)))
    times = np.linspace(0.0, DURATION_S, 151)
    noise = rng.normal(size=times.size)
    smooth = np.convolve(noise, np.hanning(9), mode="same") * np.sin(np.pi * times / DURATION_S)
    return SampledAcceleration(times, peak_m_s2 * smooth / np.max(np.abs(smooth)))


def coverage(engine: Engine, accuracy_rad: float, seeds: Sequence[int]) -> Iterator[Row]:
    """For each seed run to the accuracy, then against a finer run of the same engine, and say whether the statement held."""
    for case in cases(engine, accuracy_rad, seeds):
        yield row_of(case, engine.name, accuracy_rad)


def cases(engine: Engine, accuracy_rad: float, seeds: Sequence[int]) -> Iterator[Case]:
    """For each seed its scene, the run to the accuracy and a finer one of the same engine; without those that kept no history."""
    for seed in seeds:
        scene = random_scene(seed)
        begin = time.process_time()
        run = run_to_accuracy(engine, scene, accuracy_rad, RunOptions())
        cpu_s = time.process_time() - begin
        fine = engine.settings_for_dt(scene, float(run.settings["dt_s"]) / FINER)
        truth = engine.simulate(scene, fine, RunOptions(stop=_after(run.reliable_until_s or 0.0)))
        if run.history is not None and truth.history is not None:
            yield Case(seed, scene, run, truth, cpu_s)


def row_of(case: Case, engine: str, accuracy_rad: float) -> Row:
    """What a case says of the statement. Raises `ValueError` where a run kept no history."""
    run, truth, until = case.run, case.truth, case.run.reliable_until_s or 0.0
    if run.history is None or truth.history is None:
        raise ValueError("both runs must have kept their histories")
    times = run.history.t_s[run.history.t_s <= min(until, truth.end_s)]
    error = float(np.max(np.abs(run.history.at(times) - truth.history.at(times)), initial=0.0))
    slip = float(np.max(np.abs(run.history.slip_at(times) - truth.history.slip_at(times)), initial=0.0))
    stated, stated_m = run.numerical_uncertainty_rad or 0.0, run.slip_uncertainty_m or 0.0
    return Row(
        seed=case.seed,
        engine=engine,
        outcome=run.outcome.value,
        target_rad=accuracy_rad,
        stated_rad=stated,
        reliable_until_s=until,
        error_rad=error,
        stated_m=stated_m,
        error_m=slip,
        covered=error <= stated and slip <= stated_m,
        met_whole=until >= run.end_s and stated <= accuracy_rad,
        dt_s=float(run.settings["dt_s"]),
        runs=int(run.work.get("runs", 1)),
        steps=int(run.work.get("steps_of_all_runs", run.steps)),
        wall_s=run.wall_s,
    )


def _after(until_s: float) -> Callable[[float, float], bool]:
    """Ends a run once nothing more is asked of it."""
    return lambda t_s, _: t_s > until_s


def main(arguments: Sequence[str]) -> None:
    """Print the rows of an engine's seeds as they are found, then the count."""
    name, *numbers = arguments
    first, count = (int(item) for item in numbers) if numbers else (FIRST_SEED, SCENES)
    rows: list[Row] = []
    for row in coverage(engines.load(name), TARGET_RAD, range(first, first + count)):
        rows.append(row)
        sys.stdout.write(json.dumps(row.as_dict()) + "\n")
        sys.stdout.flush()
    missed = [row.seed for row in rows if not row.covered]
    sys.stdout.write(
        f"{name}: the error lay within the statement on {len(rows) - len(missed)} of {len(rows)}; not on {missed}\n"
    )


if __name__ == "__main__":
    main(sys.argv[1:])
