"""The room needed: a rotation worked by hand, sides that are mirrored, quantiles that rise."""

from __future__ import annotations

import math

import numpy as np
import pytest

from harness.assess.clearance import clearance, needed
from harness.assess.inputs import draw, uncertain_inputs
from tests import budgets_assess as budget
from tests.scenes_for_tests import paestum, rectangle


def test_a_block_rotated_by_hand() -> None:
    """A block 0.4 by 1 m turned right by 0.1 rad: its top left corner goes farthest left at rest, its top right one right."""
    turn, block = 0.1, rectangle(0.4, 1.0)
    right, left = needed(block, np.array([0.0, turn]), np.zeros(2))
    assert right == pytest.approx(math.sin(turn), abs=budget.PLACE_M)
    assert left == pytest.approx(0.0, abs=budget.PLACE_M)
    assert needed(block, np.array([0.0, -turn]), np.zeros(2)) == pytest.approx((left, right), abs=budget.PLACE_M)


def test_what_slides_needs_its_slip() -> None:
    right, left = needed(rectangle(0.4, 1.0), np.zeros(3), np.array([0.0, 0.2, -0.05]))
    assert (right, left) == pytest.approx((0.2, 0.05), abs=budget.PLACE_M)


def test_quantiles_rise_and_a_calm_scene_needs_little() -> None:
    scene = paestum(0.429, 3.0, duration_s=3.0)
    answer = clearance(scene, draw(uncertain_inputs(scene), 100, seed=0))
    assert answer.draws == 100
    assert 0 < answer.standing < 100
    assert answer.right_m is not None
    assert answer.left_m is not None
    assert answer.right_m[0] < answer.right_m[1] <= answer.right_m[2]
    calm = paestum(0.02, 3.0, duration_s=1.0)
    quiet = clearance(calm, draw(uncertain_inputs(calm), 50, seed=0))
    assert quiet.standing == 50
    assert quiet.right_m == [0.0, 0.0, 0.0]


def test_too_few_standing_draws_have_no_quantile() -> None:
    scene = paestum(2.0, 1.0, duration_s=3.0)
    answer = clearance(scene, draw(uncertain_inputs(scene), 30, seed=0))
    assert answer.standing < 20
    assert answer.right_m is None
