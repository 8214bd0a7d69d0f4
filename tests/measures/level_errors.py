"""An engine's error against the analytic model at each step, on the paper's cases.

`python -m tests.measures.level_errors ENGINE [STEP_S...]` prints, for each kind of scene and step, the largest errors of
rotation, rad, and slip, m, in the first second.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from typing import Final

from harness import engines
from harness.comparison.scores.pointwise import errors
from harness.model.run import RunOptions
from tests.measures.contact_engines import KINDS, PAPER, analytic_run, paper_scene

STEPS_S: Final = (4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4)


def level_errors(name: str, steps_s: Sequence[float] = STEPS_S) -> Iterator[tuple[str, float, float, float]]:
    """Kind of scene, step, s, largest error of rotation, rad, and of slip, m."""
    engine = engines.load(name)
    for kind, pedestal, static, ratio in KINDS:
        scenes = [paper_scene(a, f, pedestal=pedestal, static=static, ratio=ratio) for a, f in PAPER]
        exact = [analytic_run(scene) for scene in scenes]
        for dt_s in steps_s:
            runs = [engine.simulate(scene, engine.settings_for_dt(scene, dt_s), RunOptions()) for scene in scenes]
            rotation, slip = (max(column) for column in zip(*map(errors, exact, runs), strict=True))
            yield kind, dt_s, rotation, slip


if __name__ == "__main__":
    for row in level_errors(sys.argv[1], [float(step) for step in sys.argv[2:]] or STEPS_S):
        print("{:40} {:8g} s {:9.1e} rad {:9.1e} m".format(*row), flush=True)
