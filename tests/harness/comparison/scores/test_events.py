"""Uplifts, impacts and their energy, against arcs known in closed form."""

import math
from dataclasses import replace

import numpy as np
import pytest

from harness.accuracy.refinement import simulate
from harness.comparison import scores
from harness.model import Statue
from tests import doubles
from tests.budgets_compare import ENERGY_SHARE, ENGINE_SHARE, IMPACT_S, PEAK_RAD, SMALL_SHARE, UPLIFT_S
from tests.scenes_for_tests import paestum

ARCS = doubles.arcs(10.0, 0.1, 4.0, 0.9, 0.5)


def test_impacts_of_parabolic_arcs_are_exact() -> None:
    found = scores.excursions_of(doubles.rocking())
    assert found.side.tolist() == [side for _, _, side, _ in ARCS]
    assert found.impact_s == pytest.approx([end for _, end, _, _ in ARCS], abs=IMPACT_S)
    assert np.abs(found.rate_before_rad_s) == pytest.approx([omega for *_, omega in ARCS], abs=ENERGY_SHARE)
    assert found.peak_rad[0] == pytest.approx(0.1, abs=1e-3**2 * 4.0)  # the nearest sample is within dt/2 of the top


def test_only_the_first_uplift_is_from_rest() -> None:
    found = scores.excursions_of(doubles.rocking())
    assert found.from_rest.tolist() == [True] + [False] * (len(ARCS) - 1)
    assert found.uplift_s[0] == pytest.approx(0.5 + scores.UPLIFT_RAD / ARCS[0][3], abs=UPLIFT_S)


def test_a_pause_makes_a_second_uplift() -> None:
    first, second = doubles.rocking(start_s=0.5), doubles.rocking(start_s=6.0)
    both = replace(
        first,
        theta_rad=first.theta_rad + second.theta_rad,
        theta_rate_rad_s=first.theta_rate_rad_s + second.theta_rate_rad_s,
    )
    found = scores.excursions_of(both)
    assert int(found.from_rest.sum()) == 2


def test_chatter_below_the_threshold_is_rest() -> None:
    t = doubles.rest().t_s
    chatter = 0.9 * scores.UPLIFT_RAD * np.sin(2 * math.pi * 40.0 * t)
    assert scores.excursions_of(replace(doubles.rest(), theta_rad=chatter)).side.size == 0
    assert scores.excursions_of(replace(doubles.rest(), theta_rad=chatter / 0.8)).side.size > 0


def test_energy_share_lost_is_one_minus_the_ratio_squared() -> None:
    lost = scores.share_lost(scores.excursions_of(doubles.rocking(ratio=0.9)), None)
    # The last arc's landing ends in rest: all is lost.
    assert lost[:-1] == pytest.approx(1.0 - 0.81, abs=ENERGY_SHARE)
    assert lost[-1] == pytest.approx(1.0, abs=ENERGY_SHARE)


def test_a_sample_inside_the_impact_leaves_its_energy_alone() -> None:
    """A contact engine takes a step or more over an impact: the first sample after it may still be half way."""
    clean = doubles.rocking(ratio=0.9)
    beside = np.searchsorted(clean.t_s, [end for _, end, _, _ in ARCS[:-1]], side="right")
    rate = clean.theta_rate_rad_s.copy()
    rate[beside] = 0.5 * (rate[beside - 1] + rate[beside])
    lost = scores.share_lost(scores.excursions_of(replace(clean, theta_rate_rad_s=rate)), None)
    assert lost[:-1] == pytest.approx(1.0 - 0.81, abs=ENERGY_SHARE)


@pytest.mark.parametrize(("engine", "dt_s"), [("analytic", None), ("pymunk", 1e-3), ("pymunk", 2e-4)])
def test_every_impact_of_every_engine_takes_the_share_of_angular_momentum(engine: str, dt_s: float | None) -> None:
    """With the floor held the share is 1 − J_c²/(J_l J_r) on either side (docs/model.md, section 3), whatever the rate."""
    shaken = paestum(0.429, 3.0, pedestal=False, duration_s=2.2)
    inertia, statue = shaken.pivot_inertia_kg_m2, shaken.statue
    across = statue.centroid_height_m**2 - statue.corner_left_m * statue.corner_right_m
    crossed = statue.inertia_kg_m2 + statue.mass_kg * across
    run = simulate(shaken, engine, dt_s=dt_s)
    assert run.history is not None
    lost = scores.share_lost(scores.excursions_of(run.history), inertia)
    assert np.isfinite(lost).sum() >= 4
    known = 1.0 - crossed**2 / (inertia[-1] * inertia[1])
    assert lost[np.isfinite(lost)] == pytest.approx(known, abs=ENGINE_SHARE)


def test_impacts_too_small_to_be_seen_leave_the_share_of_those_that_are() -> None:
    """At 8 Hz an excursion of 4e-6 rad comes between two impacts: read as one, they won a quarter of the energy."""
    shaken = paestum(0.12, 8.0, pedestal=False, duration_s=3.0)
    inertia, statue = shaken.pivot_inertia_kg_m2, shaken.statue
    across = statue.centroid_height_m**2 - statue.corner_left_m * statue.corner_right_m
    known = 1.0 - (statue.inertia_kg_m2 + statue.mass_kg * across) ** 2 / (inertia[-1] * inertia[1])
    history = simulate(shaken, "analytic").history
    assert history is not None
    found = scores.excursions_of(history)
    lost = scores.share_lost(found, inertia)
    assert (found.side.size, int(found.landed.sum())) == (27, 26)
    assert lost[np.isfinite(lost)] == pytest.approx(known, abs=SMALL_SHARE)


def test_rates_that_too_few_samples_tell_give_no_share() -> None:
    """After the first impact the statue comes down again within three samples: what it lost cannot be read."""
    clean = doubles.rocking(ratio=0.9)
    theta = clean.theta_rad.copy()
    first = np.searchsorted(clean.t_s, ARCS[0][1], side="right")
    theta[first + 2 : first + 6] = 0.5 * scores.UPLIFT_RAD * np.sign(theta[first - 1])
    lost = scores.share_lost(scores.excursions_of(replace(clean, theta_rad=theta)), None)
    assert np.isnan(lost[0])


def test_a_statue_that_leans_again_before_it_is_down_has_no_impact() -> None:
    t = doubles.rest().t_s
    theta = 2.0 * scores.UPLIFT_RAD * (1.0 - 0.7 * np.cos(2 * math.pi * t))
    rate = np.gradient(theta, t)
    found = scores.excursions_of(replace(doubles.rest(), theta_rad=theta, theta_rate_rad_s=rate))
    assert found.side.size > 2
    assert not found.landed.any()


def test_energy_of_an_unsymmetric_statue_counts_each_corner_s_inertia() -> None:
    statue = Statue(
        mass_kg=707.0,
        centroid_height_m=0.774,
        corner_left_m=0.3585,
        corner_right_m=0.0682,
        inertia_kg_m2=152.4,
        height_m=1.46,
        depth_m=0.72,
        section_m=np.zeros((4, 2)),
        footprint_m=np.zeros((4, 3)),
        inertia_tensor_kg_m2=np.eye(3),
    )
    inertia = replace(paestum(), statue=statue).pivot_inertia_kg_m2
    right = 152.4 + 707.0 * (0.774**2 + 0.0682**2)
    left = 152.4 + 707.0 * (0.774**2 + 0.3585**2)
    found = scores.excursions_of(doubles.rocking(ratio=0.9))
    share = scores.share_lost(found, inertia)
    omega = ARCS[0][3]
    assert share[0] == pytest.approx(1.0 - left * 0.81 / right, abs=ENERGY_SHARE)
    assert scores.lost_j(found, inertia)[0] == pytest.approx(0.5 * right * omega**2 - 0.5 * left * (0.9 * omega) ** 2)


def test_shifted_impacts_match_with_their_shift() -> None:
    a, b = scores.excursions_of(doubles.shifted(doubles.rocking(), 0.004)), scores.excursions_of(doubles.rocking())
    matched = scores.match((a.impact_s, a.side, a.length_s / 2), (b.impact_s, b.side, b.length_s / 2))
    assert (matched.alone_a, matched.alone_b) == (0, 0)
    shift = a.impact_s[matched.index_a] - b.impact_s[matched.index_b]
    assert shift == pytest.approx(0.004, abs=1e-6)  # shifted by whole samples: rounding of the linear resampling


def test_events_of_the_other_side_never_match() -> None:
    a, b = scores.excursions_of(doubles.flipped(doubles.rocking())), scores.excursions_of(doubles.rocking())
    matched = scores.match((a.impact_s, a.side, a.length_s), (b.impact_s, b.side, b.length_s))
    times = np.abs(a.impact_s[matched.index_a] - b.impact_s[matched.index_b])
    assert np.all(a.side[matched.index_a] == b.side[matched.index_b])
    assert np.all(times > 0.0)


def test_far_events_do_not_match() -> None:
    one, window = np.array([1.0]), np.array([0.2])
    side = np.array([1], dtype=np.int8)
    near = scores.match((one, side, window), (one + 0.19, side, window))
    far = scores.match((one, side, window), (one + 0.21, side, window))
    assert (near.alone_a, far.alone_a, far.alone_b) == (0, 1, 1)


def test_an_excursion_that_does_not_land_has_no_impact() -> None:
    history = doubles.truncated(doubles.rocking(), 0.7)
    found = scores.excursions_of(history)
    assert found.landed.tolist() == [False]
    assert np.isnan(scores.share_lost(found, None)[0])


def test_the_peak_of_each_excursion_is_signed() -> None:
    peaks = scores.excursions_of(doubles.rocking()).peak_rad
    expected = [side * omega**2 / 8.0 for _, _, side, omega in ARCS]
    assert peaks == pytest.approx(expected, abs=1e-3**2 * 4.0 + PEAK_RAD)
