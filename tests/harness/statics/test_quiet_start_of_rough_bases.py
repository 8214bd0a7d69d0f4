"""A base that is not level is quiet while it stays on what it rests on, which is narrower than its corners are apart."""

import numpy as np
import pytest

from analytic.excitation import Harmonic, SampledAcceleration
from harness.accuracy.refinement import simulate
from harness.model import SKIPS, RunOptions
from harness.statics.plan import first_motion_s, limit_of_rest_m_s2
from harness.statics.standstill import push_of, resting_polygon_m
from tests.budgets import LIMIT_ROUNDING
from tests.measures.profiles import BASES, scene, statue

SAMPLED = 1e-6
"""A crest is found within 1e-8 of its size."""
FLAT = ((-0.2, 0.0), (0.2, 0.0))
PUSH = SampledAcceleration(np.array([0.0, 0.5, 1.0, 1.5]), np.array([0.0, 0.0, 3.0, 0.0]))
"""Beyond what lifts the bulging base off its 0.14 m wide middle facet (1.2 m/s²), below what a base of 0.4 m takes (3.3 m/s²)."""


def test_a_flat_base_waits_longer_than_rough_ones() -> None:
    flat = scene(statue(FLAT), PUSH)
    assert limit_of_rest_m_s2(flat) == pytest.approx(9.81 * 0.2 / 0.6, rel=LIMIT_ROUNDING)
    assert first_motion_s(flat) == flat.duration_s
    # The push is to the left. The last sample before it leaves the facet; or never, where the base is whole on that side.
    quiet_s = {name: first_motion_s(scene(statue(base), PUSH)) for name, base in BASES.items()}
    assert quiet_s == {"bulging": 0.5, "chipped": 1.0, "worn": 0.5, "uneven": 1.0, "keeled": 0.0}
    assert flat.duration_s == 1.0


def test_what_would_move_a_rough_base_is_what_lifts_it_off_that() -> None:
    shaken = scene(statue(BASES["bulging"]), Harmonic(1.0, 1.0), 2.0)
    share = push_of(shaken).shares["statue_tips"]
    assert limit_of_rest_m_s2(shaken) == pytest.approx(1.0 / share, rel=SAMPLED)
    assert share == pytest.approx(shaken.statue.centroid_height_m / 0.07 / 9.81, rel=SAMPLED)
    below, above = (
        scene(statue(BASES["bulging"]), Harmonic(each / share, 1.0), 2.0) for each in (1.0 - SAMPLED, 1.0 + SAMPLED)
    )
    assert simulate(below, "analytic").peak_theta_rad == 0.0
    assert simulate(above, "analytic").peak_theta_rad > 0.0


def test_what_is_uneven_by_less_than_counts_rests_on_all_that_touches() -> None:
    uneven = statue(((-0.2, 1e-6), (-0.02, 0.0), (0.02, 0.0), (0.2, 1e-6)))
    shaken = scene(uneven, Harmonic(1.0, 1.0), 2.0)
    assert push_of(shaken).shares["statue_tips"] == pytest.approx(uneven.centroid_height_m / 0.2 / 9.81, rel=SAMPLED)


def test_the_resting_polygon_is_that_of_the_lowest_vertices_under_the_centroid() -> None:
    polygon = resting_polygon_m(statue(BASES["bulging"]))
    assert np.ptp(polygon[:, 0]) == pytest.approx(0.14, rel=LIMIT_ROUNDING)
    assert resting_polygon_m(statue(BASES["keeled"])) is None


def test_pymunk_moves_a_rough_base_under_a_push_that_leaves_its_corners_alone() -> None:
    each = scene(statue(BASES["bulging"]), PUSH, 1.5)
    peaks = [
        simulate(
            each, "pymunk", accuracy_rad=None, dt_s=1e-3, options=RunOptions(history=False, skips=skips)
        ).peak_theta_rad
        for skips in (frozenset(SKIPS), frozenset[str]())
    ]
    assert abs(peaks[1]) > 0.04  # over the facet's rotation, 0.09 rad, back and forth
    assert peaks[0] == pytest.approx(peaks[1], rel=LIMIT_ROUNDING)
