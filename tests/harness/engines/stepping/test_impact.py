"""The impact map keeps what it must keep, in all its forms."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from harness import RunOptions, simulate
from harness.comparison.scores.pointwise import error_rad
from harness.engines.stepping.loop import Impact, impact
from harness.model.scene import Form, Pedestal, Scene
from tests import budgets_engines as budget
from tests.engines_for_tests import ready
from tests.scenes_for_tests import PAESTUM, paestum, scene

RATES = [(0.4, 0.0), (-0.3, 0.1), (0.5, -0.3), (-0.6, -0.05)]


def run(on: Scene, rate: float, slip: float, *, stuck: bool = False) -> Impact:
    return impact(on, old_side=1 if rate < 0.0 else -1, theta_rate_rad_s=rate, slip_rate_m_s=slip, stuck=stuck)


def corners(on: Scene, rate: float) -> tuple[float, float]:
    old = 1 if rate < 0.0 else -1
    return on.statue.corner_m(old), on.statue.corner_m(-old)


def momentum(on: Scene, rate: float, slip: float) -> tuple[float, float]:
    """Angular momentum of the statue about the new corner before, horizontal momentum of the whole before."""
    s, (old, new) = on.statue, corners(on, rate)
    crossed = s.inertia_kg_m2 + s.mass_kg * (s.centroid_height_m**2 - old * new)
    total = s.mass_kg + (on.pedestal.mass_kg if on.pedestal else 0.0)
    lever = s.mass_kg * s.centroid_height_m
    return crossed * rate + lever * slip, total * slip + lever * rate


@pytest.mark.parametrize(("rate", "slip"), RATES)
@pytest.mark.parametrize("mu", [0.02, 0.15, 0.8])
@pytest.mark.parametrize("ratio", [None, 0.85])
def test_both_balances_close(rate: float, slip: float, mu: float, ratio: float | None) -> None:
    on = paestum(mu=mu, restitution=ratio)
    after = run(on, rate, slip, stuck=slip == 0.0)
    s, (_, new) = on.statue, corners(on, rate)
    about, along = momentum(on, rate, slip)
    j_new = s.inertia_kg_m2 + s.mass_kg * (s.centroid_height_m**2 + new**2)
    lever = s.mass_kg * s.centroid_height_m
    total = s.mass_kg + 250.0
    if ratio is None:
        left = j_new * after.theta_rate_rad_s + lever * after.slip_rate_m_s
        assert math.isclose(left, about, rel_tol=1e3 * budget.IMPULSE)
    else:
        assert math.isclose(after.theta_rate_rad_s, ratio * rate, rel_tol=budget.IMPULSE)
    gained = total * after.slip_rate_m_s + lever * after.theta_rate_rad_s - along
    assert math.isclose(gained, after.friction_n_s, rel_tol=1e3 * budget.IMPULSE, abs_tol=1e-9)
    limit = mu * after.normal_n_s
    if after.slip_rate_m_s == 0.0:
        assert abs(after.friction_n_s) <= limit
    else:
        assert math.isclose(
            after.friction_n_s, -math.copysign(limit, after.slip_rate_m_s), rel_tol=1e3 * budget.IMPULSE
        )


@pytest.mark.parametrize("rate", [0.4, -0.4])
def test_held_pedestal_gives_housner(rate: float) -> None:
    after = run(paestum(pedestal=False), rate, 0.0)
    s, (old, new) = PAESTUM, corners(paestum(), rate)
    square = s.inertia_kg_m2 + s.mass_kg * s.centroid_height_m**2
    ratio = (square - s.mass_kg * old * new) / (square + s.mass_kg * new**2)
    assert math.isclose(after.theta_rate_rad_s, ratio * rate, rel_tol=budget.IMPULSE)
    assert after.slip_rate_m_s == 0.0


@pytest.mark.parametrize(("rate", "slip"), RATES)
def test_mirror_images(rate: float, slip: float) -> None:
    left = run(paestum(), rate, slip)
    statue = PAESTUM
    mirrored = scene(
        type(statue)(
            **{**vars(statue), "corner_left_m": statue.corner_right_m, "corner_right_m": statue.corner_left_m}
        ),
        pedestal=Pedestal(250.0, 0.6, 0.8, 0.2),
    )
    right = run(mirrored, -rate, -slip)
    assert right.theta_rate_rad_s == -left.theta_rate_rad_s
    assert right.slip_rate_m_s == -left.slip_rate_m_s


def test_unchanged_pedestal_keeps_its_velocity() -> None:
    on = paestum(restitution=0.9, form=Form("static", "unchanged"))
    after = run(on, 0.5, -0.2)
    assert (after.theta_rate_rad_s, after.slip_rate_m_s) == (0.45, -0.2)


def test_both_corners_hold_on_a_light_slippery_pedestal() -> None:
    squat = scene(
        type(PAESTUM)(**{**vars(PAESTUM), "corner_left_m": 0.9, "corner_right_m": 0.9}),
        pedestal=Pedestal(20.0, 2.0, 0.8, 0.2),
        mu=0.01,
    )
    after = run(squat, 0.5, 0.0, stuck=True)
    assert after.theta_rate_rad_s == 0.0


def test_static_coefficient_holds_what_the_kinetic_one_does_not() -> None:
    found = {
        (stuck, mu): run(paestum(mu=(mu, 0.05)), 0.5, 0.0, stuck=stuck).slip_rate_m_s
        for stuck, mu in itertools.product((True, False), (0.05, 0.9))
    }
    assert found[True, 0.9] == 0.0
    assert found[True, 0.05] == found[False, 0.05] == found[False, 0.9] != 0.0


@pytest.mark.parametrize("rate", [-0.5, -0.9])
def test_what_breaks_a_stuck_pedestal_loose_acts_with_its_own_coefficient(rate: float) -> None:
    usual = paestum(mu=(0.20, 0.15))
    for acts, coefficient in (("static", 0.20), (0.17, 0.17), ("kinetic", 0.15)):
        on = replace(usual, contact=replace(usual.contact, floor_impact=acts))
        loose, sliding = run(on, rate, 0.0, stuck=True), run(on, rate, math.copysign(0.05, rate))
        assert math.isclose(abs(loose.friction_n_s), coefficient * loose.normal_n_s, rel_tol=1e3 * budget.IMPULSE)
        assert math.isclose(abs(sliding.friction_n_s), 0.15 * sliding.normal_n_s, rel_tol=1e3 * budget.IMPULSE)


@pytest.mark.parametrize("name", ["pymunk", "pybullet"])
def test_an_impact_that_turns_a_sliding_pedestal_round_has_the_kinetic_coefficient(name: str) -> None:
    """It slides at 0.08 m/s before, the other way after: the static coefficient would all but stop it."""
    engine, on = ready(name), paestum(1.0, 1.02, mu=(0.2, 0.15), duration_s=1.72)
    tensor = on.statue.inertia_tensor_kg_m2.copy()
    tensor[1, 1] = 118.73
    on = replace(on, statue=replace(on.statue, inertia_kg_m2=118.73, inertia_tensor_kg_m2=tensor))
    exact = simulate(on, "analytic", accuracy_rad=1e-8)
    run = engine.simulate(on, engine.settings_for_dt(on, 5e-4), RunOptions())
    around_s = exact.impact_times_s[0] + np.array([-2e-3, 2e-3])
    before, after = np.interp(around_s, exact.history.t_s, exact.history.slip_rate_m_s)
    assert before * after < 0.0
    assert error_rad(exact, run, on.duration_s) <= budget.REVERSED_IMPACT_RAD
