"""What `--accuracy` takes on all of El Centro 1940 on a pedestal, met or not: `python -m tests.measures.target_cost`."""

from __future__ import annotations

from functools import partial
from typing import Final

from harness import engines
from harness.accuracy.refinement import run_to_accuracy
from harness.model.run import RunOptions
from harness.questions.bench.programs import timed
from harness.questions.bench.standard_scenes import PAESTUM, PEDESTAL, TWO, record, scene_of

DURATION_S: Final = 31.18
ASKED: Final = (("pymunk", 1e-3), ("pybullet", 1e-3), ("pymunk", 1e-7), ("pybullet", 1e-6))
"""Engines and targets, rad: what both contact engines meet, and what none of their levels is expected to."""


def main() -> None:
    """Print processor seconds, runs, what is stated and until when it holds."""
    motion = {"x": record("elcentro1940_NS.csv", "a_NS_ms2")}
    content = {"duration_s": DURATION_S, "statue": PAESTUM, "pedestal": PEDESTAL, "contact": TWO, "motion": motion}
    scene = scene_of("El Centro on a pedestal", content)
    for name, target_rad in ASKED:
        engine = engines.load(name)
        engine.simulate(scene, engine.refinement_levels(scene)[0], RunOptions())
        run, spent = timed(partial(run_to_accuracy, engine, scene, target_rad, RunOptions()))
        stated = "nothing" if run.numerical_uncertainty_rad is None else f"{run.numerical_uncertainty_rad:.1e} rad"
        print(
            f"{name}, {target_rad:g} rad: {spent.cpu_s:.2f} s of processor time, {run.work.get('runs', 1)} runs, the finest at "
            f"{1e3 * float(run.settings['dt_s']):.3g} ms; stated {stated} up to {run.bounded_until_s:.3g} of {run.end_s:.4g} s"
        )


if __name__ == "__main__":
    main()
