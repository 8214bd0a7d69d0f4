"""The plan says what is skipped and why, and a quiet start ends before anything can move."""

import math
from dataclasses import replace

import numpy as np
import pytest

from analytic.excitation import Excitation, Harmonic, Pulse, SampledAcceleration
from harness import engines, simulate
from harness.model import SKIPS, BaseExcitation, RunOptions
from harness.statics.plan import LimitsOfRest, first_motion_s, limit_of_rest_m_s2, plan
from tests.budgets import LIMIT_ROUNDING
from tests.scenes_for_tests import paestum

G = 9.81


def rising() -> SampledAcceleration:
    """A record that reaches 0.05 g at 2 s, 0.15 g at 4 s and 0.4 g at 6 s."""
    return SampledAcceleration(np.array([0.0, 2.0, 4.0, 6.0, 8.0]), G * np.array([0.0, 0.05, 0.15, 0.4, 0.0]))


def test_the_limit_of_rest_is_the_least_of_uplift_and_slip() -> None:
    on_pedestal, on_floor = paestum(0.3, 2.0), paestum(0.3, 2.0, pedestal=False)
    uplift = G * 0.0682 / 0.774
    assert limit_of_rest_m_s2(on_floor) == pytest.approx(uplift, rel=LIMIT_ROUNDING)
    slippery = replace(on_pedestal, contact=type(on_pedestal.contact)(0.05, 0.04, 1.0))
    assert limit_of_rest_m_s2(slippery) == pytest.approx(0.05 * G, rel=LIMIT_ROUNDING)


def test_motion_across_the_plane_counts_by_the_nearest_edge() -> None:
    scene = paestum(0.3, 2.0, pedestal=False)
    narrow = scene.statue.footprint_m * [1.0, 0.01, 1.0]
    across = replace(
        scene,
        base_excitation=BaseExcitation(y=rising()),
        statue=type(scene.statue)(**{**vars(scene.statue), "footprint_m": narrow}),
    )
    assert limit_of_rest_m_s2(across) < limit_of_rest_m_s2(scene)


def test_the_quiet_start_ends_at_the_last_sample_below_the_limit() -> None:
    towards_left = replace(
        paestum(0.3, 2.0, pedestal=False), base_excitation=BaseExcitation(x=rising()), duration_s=8.0
    )
    assert first_motion_s(towards_left) == 8.0  # there g b / h is 0.463 g: never reached
    assert simulate(towards_left, "analytic").peak_theta_rad == 0.0
    scene = replace(towards_left, base_excitation=BaseExcitation(x=rising().scaled(-1.0)))
    assert first_motion_s(scene) == 2.0  # here it is 0.088 g: reached between 2 s and 4 s
    lifted = replace(
        scene,
        base_excitation=BaseExcitation(
            x=rising().scaled(-1.0), z=SampledAcceleration(np.array([0.0, 2.0, 8.0]), G * np.array([0.0, -0.9, 0.0]))
        ),
    )
    assert first_motion_s(lifted) == 0.0  # a falling floor lowers the limit to a tenth


@pytest.mark.parametrize(
    ("motion", "first_s"),
    [
        (Harmonic(0.01 * G, 1.0), 8.0),  # never reaches the limit
        (Harmonic(0.1 * G, 0.8), 0.625 + math.asin(0.088 / 0.1) / (2.0 * math.pi * 0.8)),
        (Harmonic(0.1 * G, 0.8, ramp_s=5.0), 4.6),
        (Pulse("one_sine", 0.2 * G, 0.004, start_s=3.0), 3.0),  # shorter than any grid over the whole duration
        (Pulse("rectangular", -0.2 * G, 1.0, start_s=2.5), 2.5),
        (Harmonic(0.2 * G, 500.0), 0.0),  # of too many cycles nothing is known
    ],
)
def test_the_quiet_start_of_a_formula_ends_where_it_first_passes_a_limit(motion: Excitation, first_s: float) -> None:
    scene = replace(paestum(0.3, 2.0, pedestal=False), base_excitation=BaseExcitation(x=motion), duration_s=8.0)
    found = first_motion_s(scene)
    assert found == pytest.approx(first_s, abs=6e-2)
    t_s = np.linspace(0.0, found, 200_001)[:-1]
    assert np.min(motion.accel_m_s2(t_s), initial=0.0) >= -limit_of_rest_m_s2(scene)


def test_rest_under_a_formula_ends_before_each_crest_that_moves_the_statue() -> None:
    scene = replace(
        paestum(0.3, 2.0, pedestal=False), base_excitation=BaseExcitation(x=Harmonic(0.1 * G, 0.8)), duration_s=8.0
    )
    limits, period_s = LimitsOfRest.of(scene), 1.25
    assert limits is not None
    begin = limits.until_s(0.0)
    assert begin == pytest.approx(
        period_s / 2 + math.asin(limit_of_rest_m_s2(scene) / (0.1 * G)) / (2 * math.pi * 0.8), abs=5e-3
    )
    assert limits.until_s(begin + 0.5 * period_s) == pytest.approx(begin + period_s, abs=5e-3)


def test_every_skip_that_is_off_says_so() -> None:
    steps = plan(paestum(0.3, 2.0), [engines.load("pybullet")], RunOptions(skips=frozenset()))
    assert {step.skip for step in steps} <= set(SKIPS)
    own = [step for step in steps if step.engine == "pybullet"]
    assert {step.skip for step in own} == engines.load("pybullet").capabilities.skips
    assert all(step.reason.code == "plan_switched_off" and not step.applies for step in own)


def test_what_the_harness_leaves_out_says_how_to_have_it() -> None:
    scene = paestum(0.3, 2.0)
    found = {step.skip: step for step in plan(scene, [engines.load("analytic")], RunOptions(), engines.REGISTRY)}
    assert found["planar"].applies
    assert found["planar"].reason.values == {"planar": True}
    assert found["lazy_engines"].reason.values["idle"] == [name for name in engines.REGISTRY if name != "analytic"]
    every = {
        step.skip: step
        for step in plan(scene, [engines.load(name) for name in engines.REGISTRY], RunOptions(), engines.REGISTRY)
    }
    assert not every["planar"].applies
    assert not every["lazy_engines"].applies


def test_rest_goes_on_until_the_next_sample_that_moves_the_statue_as_it_has_turned() -> None:
    scene = replace(
        paestum(0.3, 2.0, pedestal=False), base_excitation=BaseExcitation(x=rising().scaled(-1.0)), duration_s=9.0
    )
    limits = LimitsOfRest.of(scene)
    assert [limits.until_s(t) for t in (0.0, 1.0, 3.0, 7.0, 8.0)] == [2.0, 2.0, 3.0, 7.0, 9.0]
    # Turned by half a turn the far corner is where the near one was: 0.463 g is never reached.
    assert limits.until_s(0.0, np.pi) == 9.0


def test_a_tall_pedestal_that_tips_under_its_statue_ends_the_quiet_start() -> None:
    scene = replace(paestum(0.3, 2.0), base_excitation=BaseExcitation(x=rising()), duration_s=8.0)
    pedestal = scene.pedestal
    assert pedestal is not None
    sticky = replace(scene, contact=type(scene.contact)(1.0, 1.0, 1.0))
    tall = replace(sticky, pedestal=replace(pedestal, height_m=5.0))
    assert first_motion_s(sticky) == 8.0
    assert first_motion_s(tall) == 2.0
