"""What is written at an imposed impact keeps what it must keep, and the engines' own impacts follow friction."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from harness.comparison.scores import error_rad
from harness.engines.stepping.loop import imposed_rates
from harness.model import Form, Scene
from tests import budgets_engines as budget
from tests import engines_for_tests
from tests.engines_for_tests import exact
from tests.scenes_for_tests import paestum

RATES = [(0.4, 0.0), (-0.3, 0.1), (0.5, -0.3), (-0.6, -0.05)]


def run(on: Scene, rate: float, slip: float, *, stuck: bool = False) -> tuple[float, float]:
    side = 1 if rate < 0.0 else -1
    return imposed_rates(on, old_side=side, theta_rate_rad_s=rate, slip_rate_m_s=slip, stuck=stuck)


def impulses(on: Scene, rate: float, slip: float, after: tuple[float, float]) -> tuple[float, float]:
    """The floor's friction by the momentum of the whole, and its normal impulse by what both corners' speeds change, N s."""
    s, old = on.statue, 1 if rate < 0.0 else -1
    total, lever = s.mass_kg + on.pedestal.mass_kg, s.mass_kg * s.centroid_height_m
    friction = total * (after[1] - slip) + lever * (after[0] - rate)
    return friction, s.mass_kg * (s.corner_m(-old) * abs(after[0]) + s.corner_m(old) * abs(rate))


@pytest.mark.parametrize(("rate", "slip"), RATES)
@pytest.mark.parametrize("mu", [0.02, 0.15, 0.8])
def test_the_ratio_is_the_scene_s_and_momentum_is_kept_but_for_friction(rate: float, slip: float, mu: float) -> None:
    on = paestum(mu=mu, restitution=0.85)
    turning, sliding = run(on, rate, slip, stuck=slip == 0.0)
    assert math.isclose(turning, 0.85 * rate, rel_tol=budget.IMPULSE)
    friction, normal = impulses(on, rate, slip, (turning, sliding))
    if sliding == 0.0:
        assert abs(friction) <= mu * normal
    else:
        assert math.isclose(friction, -math.copysign(mu * normal, sliding), rel_tol=1e3 * budget.IMPULSE)


@pytest.mark.parametrize(("rate", "slip"), RATES)
def test_mirror_images(rate: float, slip: float) -> None:
    on = paestum(restitution=0.85)
    statue = replace(on.statue, corner_left_m=on.statue.corner_right_m, corner_right_m=on.statue.corner_left_m)
    turning, sliding = run(replace(on, statue=statue), -rate, -slip)
    assert (-turning, -sliding) == run(on, rate, slip)


@pytest.mark.parametrize(
    "on", [paestum(restitution=0.9, form=Form("static", "unchanged")), paestum(restitution=0.9, pedestal=False)]
)
def test_unchanged_pedestal_keeps_its_velocity(on: Scene) -> None:
    assert run(on, 0.5, -0.2) == (0.45, -0.2)


def test_static_coefficient_holds_what_the_kinetic_one_does_not() -> None:
    found = {
        (stuck, mu): run(paestum(mu=(mu, 0.05), restitution=0.85), 0.5, 0.0, stuck=stuck)[1]
        for stuck, mu in itertools.product((True, False), (0.05, 0.9))
    }
    assert found[True, 0.9] == 0.0
    assert found[True, 0.05] == found[False, 0.05] == found[False, 0.9] != 0.0


@pytest.mark.parametrize("rate", [-0.5, -0.9])
def test_what_breaks_a_stuck_pedestal_loose_acts_with_its_own_coefficient(rate: float) -> None:
    usual = paestum(mu=(0.10, 0.05), restitution=0.85)
    for acts, coefficient in (("static", 0.10), (0.07, 0.07), ("kinetic", 0.05)):
        on = replace(usual, contact=replace(usual.contact, floor_impact=acts))
        for slip, acting in ((0.0, coefficient), (math.copysign(0.05, rate), 0.05)):
            friction, normal = impulses(on, rate, slip, run(on, rate, slip, stuck=slip == 0.0))
            assert math.isclose(abs(friction), acting * normal, rel_tol=1e3 * budget.IMPULSE)


@pytest.mark.parametrize("name", ["pymunk", "pybullet"])
def test_an_impact_that_turns_a_sliding_pedestal_round_has_the_kinetic_coefficient(name: str) -> None:
    """It slides at 0.08 m/s before, the other way after: the static coefficient would all but stop it."""
    on = paestum(1.0, 1.02, mu=(0.2, 0.15), duration_s=1.72)
    tensor = on.statue.inertia_tensor_kg_m2.copy()
    tensor[1, 1] = 118.73
    on = replace(on, statue=replace(on.statue, inertia_kg_m2=118.73, inertia_tensor_kg_m2=tensor))
    model = exact(on)
    around_s = model.impact_times_s[0] + np.array([-2e-3, 2e-3])
    before, after = np.interp(around_s, model.history.t_s, model.history.slip_rate_m_s)
    assert before * after < 0.0
    assert error_rad(model, engines_for_tests.run(name, on, 5e-4), on.duration_s) <= budget.REVERSED_IMPACT_RAD
