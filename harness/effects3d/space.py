"""Whether amplitudes overturn a statue in the exact model of three dimensions: its outcome alone, some milliseconds a run."""

from __future__ import annotations

from typing import Final, final

from harness.engines.spatial import LEVELS, problem_of
from harness.model.history import Outcome
from harness.model.scene import Scene

EXACT: Final = "spatial"
FINER: Final = LEVELS[1][0]
"""A thousandth of the local error at which outcomes are asked (`analytic.spatial.outcomes.TOLERANCE`)."""
MOST_STEPS: Final = 50_000
"""A run of more is given up, and told: rocking takes some hundreds of steps, a slide that creeps a million."""


@final
class SpaceOutcomes:
    """Asks the exact model for outcomes, and remembers the factors at which it gave none."""

    def __init__(self, scene: Scene) -> None:
        self._problem = problem_of(scene)
        self.unanswered: list[float] = []

    def overturning(self, factor: float, tolerance: float = LEVELS[0][0]) -> Outcome | None:
        """How the scene with its motion scaled by a factor overturns, None when it does not."""
        from analytic import spatial

        run = spatial.outcomes(
            self._problem, {"scale": [factor]}, tolerance=tolerance, threads=1, most_steps=MOST_STEPS
        )
        if not run.overturned[0]:
            if run.outcomes[0] is not spatial.Outcome.STANDS:
                self.unanswered.append(factor)
            return None
        x, y, _ = run.axis[0]
        if abs(y) > abs(x):
            return Outcome.OVERTURNED_BACK if y > 0.0 else Outcome.OVERTURNED_FRONT
        return Outcome.OVERTURNED_RIGHT if x > 0.0 else Outcome.OVERTURNED_LEFT

    def doubt(self, above: float | None, below: float) -> str:
        """Why an amplitude between `below` (stands) and `above` (overturns) is in doubt; empty where it is not."""
        if self.unanswered:
            return f"{len(self.unanswered)} of its runs ended without an outcome"
        again = (above is None or self.overturning(above, FINER) is not None) and (
            below == 0.0 or self.overturning(below, FINER) is None
        )
        return "" if again and not self.unanswered else "its outcomes change with a smaller local error"
