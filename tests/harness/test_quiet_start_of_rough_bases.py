"""A base that is not level has no quiet start: what it rests on is narrower than its corners are apart."""

from __future__ import annotations

import numpy as np
import pytest

from analytic.excitation import Record
from harness.bench_profiles import BASES, scene, statue
from harness.engine import SKIPS, Want
from harness.plan import first_motion_s, limit_of_rest_m_s2
from harness.run import simulate
from tests.budgets import LIMIT_ROUNDING

FLAT = ((-0.2, 0.0), (0.2, 0.0))
PUSH = Record(np.array([0.0, 0.5, 1.0, 1.5]), np.array([0.0, 0.0, 3.0, 0.0]))
"""Beyond what lifts the bulging base off its 0.14 m wide middle facet (1.2 m/s²), below what a base of 0.4 m takes (3.3 m/s²)."""


def test_a_flat_base_waits_and_rough_ones_do_not() -> None:
    flat = scene(statue(FLAT), PUSH)
    assert limit_of_rest_m_s2(flat) == pytest.approx(9.81 * 0.2 / 0.6, rel=LIMIT_ROUNDING)
    assert first_motion_s(flat) == flat.duration_s
    for base in BASES.values():
        assert first_motion_s(scene(statue(base), PUSH)) == 0.0


def test_pymunk_moves_a_rough_base_under_a_push_that_leaves_its_corners_alone() -> None:
    each = scene(statue(BASES["bulging"]), PUSH, 1.5)
    peaks = [
        simulate(each, "pymunk", accuracy_rad=None, dt_s=1e-3, want=Want(history=False, skips=skips)).peak_theta_rad
        for skips in (frozenset(SKIPS), frozenset[str]())
    ]
    assert abs(peaks[1]) > 0.04  # over the facet's rotation, 0.09 rad, back and forth
    assert peaks[0] == pytest.approx(peaks[1], rel=LIMIT_ROUNDING)
