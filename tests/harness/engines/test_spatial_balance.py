"""What the exact body's run says of energy and contact: of all its motion, where the contact engines' is of the plane."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from harness.accuracy.simulation import simulate
from harness.engines.spatial import LEVELS
from harness.model.run import Run
from harness.model.scene import Contact, Initial, Pose
from tests import budgets_spatial as budget
from tests.scenes_for_tests import GRAVITY_M_S2, rectangle, scene


@pytest.fixture(scope="module")
def thrown() -> Run:
    """A block thrown across the plane, spinning about all axes."""
    pose = Pose((0.0, 0.0, 1.5), (math.cos(0.4), 0.0, 0.0, math.sin(0.4)), (0.5, 2.0, 1.0), (1.0, -2.0, 3.0))
    still = scene(rectangle(0.3, 1.2, depth_m=0.4), duration_s=1.2)
    return simulate(replace(still, initial=Initial(pose=pose), contact=Contact(0.2, 0.15, 0.7)), "spatial")


def test_energy_is_kept_in_flight_and_lost_in_impacts_and_by_sliding(thrown: Run) -> None:
    energy_j = thrown.columns()["energy_j"]
    first = np.searchsorted(thrown.columns()["t_s"], thrown.impact_times_s[0])
    height_j = 1.2 * GRAVITY_M_S2 * 1000.0
    np.testing.assert_allclose(energy_j[:first], energy_j[0], atol=budget.AUDIT * height_j)
    lost_j = thrown.validity["lost_in_impacts_j"] + thrown.validity["energy_lost_by_sliding_j"]
    assert lost_j == pytest.approx(energy_j[0] - energy_j[-1], rel=budget.FRICTION_REL)
    assert thrown.validity["energy_gained_j"] is None


def test_what_touches_is_not_told_to_penetrate(thrown: Run) -> None:
    assert thrown.validity["penetration_m"] < LEVELS[0][0]
    assert thrown.validity["statue_flight_m"] > 0.5
