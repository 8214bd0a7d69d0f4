"""Which coefficient unmodified pymunk takes as an impact breaks the pedestal loose.

`python -m tests.measures.static_impacts [STEP_S]`, on the paper's pedestal at 0.334 and 0.429 g, 2 and 3 Hz: the largest
difference of its rotation from the model with the kinetic and with the static coefficient at impacts, a row for each case.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from typing import Literal, NamedTuple

from harness.comparison.scores.pointwise import errors
from harness.engines import load
from harness.model.options import RunOptions
from harness.model.run import Run
from harness.model.scene import Scene
from tests.scenes_for_tests import paestum

CASES = ((0.334, 2.0), (0.334, 3.0), (0.429, 2.0), (0.429, 3.0))
UNTIL_S = 1.5


class Row(NamedTuple):
    """Largest differences of rotation, rad, from the model by each coefficient."""

    amplitude_g: float
    frequency_hz: float
    kinetic_rad: float
    static_rad: float


def measured(amplitude_g: float, frequency_hz: float, step_s: float, until_s: float = UNTIL_S) -> Row:
    """One case with a step of the plain engine."""
    scene = paestum(amplitude_g, frequency_hz, mu=(0.20, 0.15), duration_s=until_s)
    engine = load("pymunk:plain")
    plain = engine.simulate(scene, engine.settings_for_dt(scene, step_s), RunOptions())
    apart = [errors(plain, _model(scene, acts), until_s)[0] for acts in ("kinetic", "static")]
    return Row(amplitude_g, frequency_hz, *apart)


def _model(scene: Scene, acts: Literal["kinetic", "static"]) -> Run:
    engine, on = load("analytic"), replace(scene, contact=replace(scene.contact, floor_impact=acts))
    return engine.simulate(on, engine.refinement_levels(on)[-1], RunOptions())


def main() -> None:
    """Print the table."""
    step_s = float(sys.argv[1]) if len(sys.argv) > 1 else 1e-5
    print("| case | from the model with the kinetic coefficient, rad | with the static one, rad |\n|---|---|---|")
    for case in CASES:
        row = measured(*case, step_s)
        print(
            f"| {row.amplitude_g} g, {row.frequency_hz:g} Hz | {row.kinetic_rad:.1e} | {row.static_rad:.1e} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
