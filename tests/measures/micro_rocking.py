"""Micro-rocking, in half-cycles of some milliseconds that decide what follows: an engine's error by step, a scene's sensitivity.

`python -m tests.measures.micro_rocking ENGINE [SEED...]` prints a line per scene of `tests.measures.seeded_scenes.random_scene`.
"""

import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

from analytic.excitation import Excitation, Harmonic, Pulse, SampledAcceleration
from harness import RunOptions, Scene, engines
from harness.comparison.scores import errors
from harness.engines.base import Engine
from tests.measures.contact_engines import analytic_run
from tests.measures.seeded_scenes import random_scene

SEEDS: Final = (10129, 20399, 20809, 20844, 20866)
"""Well-conditioned scenes that whole steps missed, by up to 0.2 rad at every step of 0.5 ms and more."""
STEPS_S: Final = (4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4)
STRONGER: Final = 1e-6
"""Relative change of the motion whose effect is the scene's own sensitivity."""


@dataclass(frozen=True)
class Row:
    """A seed: largest difference of the rotation from the analytic model by step, rad; what a stronger motion changes there."""

    seed: int
    sensitive_rad: float
    error_rad: dict[float, float]


def rows(engine: Engine, seeds: Sequence[int] = SEEDS, steps_s: Sequence[float] = STEPS_S) -> Iterator[Row]:
    """A row for each seed."""
    for seed in seeds:
        scene = random_scene(seed)
        exact = analytic_run(scene)
        sensitive_rad = errors(exact, analytic_run(stronger(scene, 1.0 + STRONGER)))[0]
        runs = {dt_s: engine.simulate(scene, engine.settings_for_dt(scene, dt_s), RunOptions()) for dt_s in steps_s}
        yield Row(seed, sensitive_rad, {dt_s: errors(exact, run)[0] for dt_s, run in runs.items()})


def stronger(scene: Scene, factor: float) -> Scene:
    """The scene with its motion along x multiplied. Raises `TypeError` for a motion that has no amplitude."""
    return replace(scene, base_excitation=replace(scene.base_excitation, x=_scaled(scene.base_excitation.x, factor)))


def _scaled(motion: Excitation, factor: float) -> Excitation:
    if isinstance(motion, SampledAcceleration):
        return SampledAcceleration(motion.t_s, motion.samples_m_s2 * factor)
    if isinstance(motion, Harmonic | Pulse):
        return replace(motion, amplitude_m_s2=motion.amplitude_m_s2 * factor)
    raise TypeError(f"a record, a harmonic or a pulse is wanted, not {type(motion).__name__}")


def main(arguments: Sequence[str]) -> None:
    """Print the rows."""
    name, *seeds = arguments
    for row in rows(engines.load(name), [int(seed) for seed in seeds] or SEEDS):
        errors = "  ".join(f"{1e3 * dt_s:g} ms {error:.1e}" for dt_s, error in row.error_rad.items())
        sys.stdout.write(f"{row.seed}  {errors}  motion stronger by {STRONGER:g}: {row.sensitive_rad:.1e}\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main(sys.argv[1:])
