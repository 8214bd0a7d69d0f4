"""A base of more than two vertices (docs/model.md, section 8)."""

import math
from dataclasses import replace

import numpy as np
import pytest

from analytic import AnalyticInputError, Block, Harmonic, Outcome, Pulse, Rest, ensemble, simulate
from tests.analytic.paestum import GRAVITY, STATUE, mirror_image
from tests.budgets_analytic import CHORD_RAD, ENERGY_RISE_REL, EVENT_REL, SAMPLED_S

BULGE = Block.from_profile(
    mass_kg=100.0,
    centroid_height_m=0.6,
    inertia_kg_m2=14.0,
    profile_m=[(-0.15, 0.012), (-0.06, 0.0), (0.06, 0.0), (0.15, 0.012)],
)


def polygon(sides: int) -> Block:
    """A regular polygon of unit radius standing on one side, as a base of its lower half."""
    turn = 2.0 * math.pi / sides
    angles = [(i + 0.5) * turn for i in range(-(sides // 4), sides // 4)]
    drop = math.cos(0.5 * turn)
    profile = [(math.sin(a), drop - math.cos(a)) for a in angles]
    return Block.from_profile(mass_kg=1.0, centroid_height_m=drop, inertia_kg_m2=0.5, profile_m=profile)


def test_two_vertices_are_exactly_the_two_corner_model() -> None:
    same = Block.from_profile(
        mass_kg=707.0, centroid_height_m=0.774, inertia_kg_m2=152.4, profile_m=[(-0.3585, 0.0), (0.0682, 0.0)]
    )
    a = simulate(STATUE, Harmonic(0.334 * GRAVITY, 4.5), duration_s=5.0)
    b = simulate(same, Harmonic(0.334 * GRAVITY, 4.5), duration_s=5.0)
    assert np.array_equal(a.theta_rad, b.theta_rad)
    assert a.events == b.events


def test_a_body_rolls_from_vertex_to_vertex_and_loses_what_angular_momentum_says() -> None:
    run = simulate(BULGE, Rest(), theta0_rad=0.2, duration_s=3.0, gravity_m_s2=GRAVITY)
    facets = BULGE.arrays[2]
    assert run.events[0].pivot == 3
    assert {event.facet for event in run.impacts} == {0, 1, 2}
    m, h, jg = BULGE.mass_kg, BULGE.centroid_height_m, BULGE.inertia_kg_m2
    before = run.events[0].pivot
    for event in run.events[1:]:
        if event.kind.value == "impact" and event.pivot is not None and before is not None:
            angle = facets[event.facet]
            assert event.theta_rad == angle
            assert {before, event.pivot} == {event.facet, event.facet + 1}
            levers = []
            for vertex in (before, event.pivot):
                x, z = BULGE.profile_m[vertex]
                levers.append(
                    (
                        (h - z) * math.sin(angle) - x * math.cos(angle),
                        x * math.sin(angle) + (h - z) * math.cos(angle),
                    )
                )
            (xo, zo), (xn, zn) = levers
            assert zo == pytest.approx(zn, rel=1e-12)
            ratio = (jg + m * (zn * zn + xn * xo)) / (jg + m * (zn * zn + xn * xn))
            assert event.theta_rate_after_rad_s == pytest.approx(ratio * event.theta_rate_before_rad_s, rel=EVENT_REL)
        before = event.pivot


def test_energy_of_a_free_bulging_base_never_rises_and_it_comes_to_rest_on_a_facet() -> None:
    run = simulate(BULGE, Rest(), theta0_rad=0.2, duration_s=300.0, dt_s=0.1, gravity_m_s2=GRAVITY)
    assert run.outcome.value == "stands"
    assert run.events[-1].pivot is None
    assert abs(run.theta_rad[-1] - BULGE.arrays[2]).min() == 0.0
    assert all(event.energy_j <= ENERGY_RISE_REL for event in run.impacts)


def test_many_vertices_roll_like_a_disk() -> None:
    """A polygon of n sides under a weak steady push needs a finite slope; pushed on, it rolls over every vertex in turn."""
    block = polygon(40)
    run = simulate(block, Rest(), theta_rate0_rad_s=0.6, duration_s=0.8, gravity_m_s2=GRAVITY, dt_s=0.01)
    visited = [event.pivot for event in run.impacts if event.pivot is not None]
    assert len(visited) >= 2
    assert visited == sorted(visited)


def test_mirrored_profile_gives_the_mirrored_run_bit_for_bit() -> None:
    uneven = Block.from_profile(
        mass_kg=100.0,
        centroid_height_m=0.6,
        inertia_kg_m2=14.0,
        profile_m=[(-0.12, 0.02), (-0.05, 0.0), (0.07, 0.0), (0.15, 0.012), (0.18, 0.03)],
    )
    motion = Harmonic(2.5, 2.0)
    ours = simulate(uneven, motion, duration_s=6.0)
    mirrored = simulate(mirror_image(uneven), motion.scaled(-1.0), duration_s=6.0)
    assert ours.peak_theta_rad > 0.05
    assert np.array_equal(ours.theta_rad, -mirrored.theta_rad)


@pytest.mark.parametrize(
    ("profile", "sentence"),
    [
        ([(-0.1, 0.0)], "at least two"),
        ([(0.1, 0.0), (-0.1, 0.0)], "left to right"),
        ([(-0.1, 0.0), (0.0, 0.01), (0.1, 0.0)], "convex"),
        ([(0.1, 0.0), (0.2, 0.0)], "both sides"),
        ([(-0.1, 0.0), (0.1, math.nan)], "finite"),
    ],
)
def test_a_profile_that_cannot_rock_is_refused(profile: list[tuple[float, float]], sentence: str) -> None:
    with pytest.raises(AnalyticInputError, match=sentence):
        Block.from_profile(mass_kg=1.0, centroid_height_m=0.5, inertia_kg_m2=0.1, profile_m=profile)


@pytest.mark.parametrize("side", [1, -1])
def test_no_return_is_told_where_the_last_facet_lies_beyond_balance(side: int) -> None:
    """The statue lands on its outer corner with the centroid beyond it: what could not be undone was to pass the inner one."""
    steep = [(-0.3, 0.2), (-0.1, 0.0), (0.1, 0.0), (0.3, 0.2)]
    block = Block.from_profile(mass_kg=100.0, centroid_height_m=1.0, inertia_kg_m2=30.0, profile_m=steep)
    run = simulate(block, Rest(), theta_rate0_rad_s=0.6 * side, duration_s=5.0)
    assert run.outcome.value == ("overturned_right" if side > 0 else "overturned_left")
    assert run.impacts
    balance_rad = math.atan2(0.1, 1.0)
    landed_s = run.impacts[0].time_s
    rising = run.t_s < landed_s
    crossed_s = np.interp(balance_rad, side * run.theta_rad[rising], run.t_s[rising])
    assert run.no_return_time_s == pytest.approx(crossed_s, abs=SAMPLED_S)
    assert run.no_return_time_s < landed_s


@pytest.mark.parametrize("mirrored", [False, True])
def test_where_something_else_than_the_base_comes_down_the_domain_is_left(mirrored: bool) -> None:
    block = replace(STATUE, base_ends_rad=(math.inf, 0.05))
    wave, way = Harmonic(0.334 * GRAVITY, 4.5), 1.0
    if mirrored:
        block, wave, way = mirror_image(block), Harmonic(-0.334 * GRAVITY, 4.5), -1.0
        assert block.base_ends_rad == (0.05, math.inf)
    bare = simulate(STATUE, Harmonic(0.334 * GRAVITY, 4.5), duration_s=5.0)
    run = simulate(block, wave, duration_s=5.0)
    assert np.array_equal(run.theta_rad, way * bare.theta_rad), "the motion goes on as if nothing else were there"
    limits = run.validity
    assert limits.left_domain_by == "beyond_base"
    assert way * np.interp(limits.left_domain_s, run.t_s, run.theta_rad) == pytest.approx(0.05, abs=CHORD_RAD)
    first = float(run.t_s[np.argmax(way * run.theta_rad > 0.05)])
    assert 0.0 <= first - limits.left_domain_s <= 0.001
    swept = ensemble(block, wave, sweep={"mass_kg": [707.0, 707.0]}, duration_s=5.0, domain=True)
    assert swept.left_domain_s == pytest.approx(limits.left_domain_s, abs=SAMPLED_S)


def test_a_base_that_ends_upright_is_refused() -> None:
    with pytest.raises(AnalyticInputError, match="base_ends_rad"):
        replace(STATUE, base_ends_rad=(0.1, 0.0))


def test_a_fall_that_energy_tells_leaves_the_base_too() -> None:
    """The blow ends long before the statue is down: an outcome alone is told from its energy, once its balance is passed."""
    block, blow = replace(STATUE, base_ends_rad=(math.inf, 0.05)), Pulse("one_sine", 0.5 * GRAVITY, 0.3)
    whole = simulate(block, blow, duration_s=20.0)
    alone = simulate(block, blow, duration_s=20.0, dt_s=None)
    bare = simulate(STATUE, blow, duration_s=20.0, dt_s=None)
    assert whole.outcome is alone.outcome is bare.outcome is Outcome.OVERTURNED_RIGHT
    assert alone.counts.energy_endings
    assert whole.validity.left_domain_by == alone.validity.left_domain_by == "beyond_base"
    assert alone.validity.left_domain_s == pytest.approx(whole.validity.left_domain_s, rel=1e-9)
    assert bare.validity.left_domain_by != "beyond_base"
