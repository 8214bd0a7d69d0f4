"""What a contact restitution changes of an impact (docs/model.md, section 3): pymunk in a plain loop, where there is none."""

import math
from typing import Any

import numpy as np
import pytest

from harness.engines.pymunk import world
from harness.engines.pymunk.settings import MunkSettings
from tests import budgets_engines as budget
from tests.measures import contact_engines
from tests.scenes_for_tests import rectangle, scene

DT_S = 1e-4


def ratio(widths: float, restitution: float, patch: pytest.MonkeyPatch) -> float:
    """Angular velocity after the first impact, with all its bounces, over that before, from the heights of both half-cycles."""

    def bouncing(*given: Any) -> world.World:
        built = world.build(*given)
        for shape in built.space.shapes:
            # Chipmunk multiplies those of two shapes.
            shape.elasticity = math.sqrt(restitution)
        return built

    patch.setattr(contact_engines, "build", bouncing)
    block = rectangle(1.0 / widths, 1.0)
    alpha = block.slenderness_rad(1)
    on = scene(block, theta_rad=0.5 * alpha, mu_statue=2.0, duration_s=1.0)
    rows = contact_engines.baseline_loop(on, MunkSettings(DT_S, 0.0, 60, 1e-8, 1e-6, 60))[1]
    theta = -np.array([row[2] for row in rows])
    falls = np.flatnonzero(theta < 0.0)
    returns = np.flatnonzero(theta[falls[0] :] > 0.0)
    half_cycle = theta[falls[0] :][: returns[0] if returns.size else None]
    heights = [math.cos(alpha - lean) - math.cos(alpha) for lean in (0.5 * alpha, float(-np.min(half_cycle)))]
    return math.sqrt(heights[1] / heights[0])


@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_a_slender_block_loses_what_angular_momentum_asks_for(
    restitution: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    housner = 1.0 - 1.5 * math.sin(math.atan(0.2)) ** 2
    assert ratio(5.0, restitution, monkeypatch) == pytest.approx(housner, abs=budget.BOUNCES_RATIO)


def test_a_squat_block_that_bounces_loses_another_share(monkeypatch: pytest.MonkeyPatch) -> None:
    assert ratio(1.0, 0.0, monkeypatch) == pytest.approx(0.25, abs=budget.BOUNCES_RATIO)
    assert abs(ratio(1.6, 0.9, monkeypatch) - ratio(1.6, 0.0, monkeypatch)) > 10.0 * budget.BOUNCES_RATIO
