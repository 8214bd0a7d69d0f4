"""Slip in pymunk: what a pedestal that slides takes of a rocking statue's momentum, at the instant at which it is."""

import math
from dataclasses import replace
from typing import Literal

import numpy as np
import pytest

from analytic.excitation import Harmonic, Pulse
from harness.comparison.scores.pointwise import errors
from harness.engines.analytic import TwoBlock
from harness.engines.pymunk import Munk2D
from harness.model.run import Run, RunOptions
from harness.model.scene import Pedestal, Scene
from tests import budgets_engines as budget
from tests.scenes_for_tests import GRAVITY_M_S2, paestum, rectangle, scene

ENGINE, MODEL = Munk2D(), TwoBlock()


def run(on: Scene, dt_s: float) -> Run:
    return ENGINE.simulate(on, ENGINE.settings_for_dt(on, dt_s), RunOptions())


def slip_error_m(on: Scene, found: Run) -> float:
    exact = MODEL.simulate(on, MODEL.refinement_levels(on)[1], RunOptions())
    assert found.history is not None
    assert exact.history is not None
    times = np.linspace(0.0, min(found.end_s, exact.end_s), 500)
    slips = [np.interp(times, history.t_s, history.slip_m) for history in (found.history, exact.history)]
    return float(np.max(np.abs(slips[0] - slips[1])))


def squat() -> Scene:
    """A block as half as wide as high that rocks, slides and meets its pedestal once."""
    motion = Pulse("one_sine", 0.8 * GRAVITY_M_S2, 1.2, 0.0)
    pedestal = Pedestal(500.0, 3.0, 0.5, 0.3)
    return scene(rectangle(1.5, 2.9), motion, pedestal=pedestal, mu=0.6, mu_statue=2.0, duration_s=1.5)


def test_slip_beside_rocking_errs_at_second_order() -> None:
    on = squat()
    coarse, fine = slip_error_m(on, run(on, 2e-3)), slip_error_m(on, run(on, 2.5e-4))
    assert fine <= budget.SLIP_BESIDE_ROCKING_M
    assert math.log(coarse / fine, 8.0) >= budget.SLIP_ORDER


@pytest.mark.parametrize("pedestal", [True, False])
def test_a_statue_that_holds_does_not_walk_over_its_support(pedestal: bool) -> None:
    on = squat() if pedestal else replace(squat(), pedestal=None)
    assert run(on, 1e-3).validity["statue_slip_m"] <= budget.STATUE_WALK_M


def test_a_start_with_a_rate_has_its_momentum() -> None:
    pedestal = Pedestal(300.0, 0.6, 0.5, 0.1)
    on = scene(rectangle(0.4, 1.0), theta_rate_rad_s=-1.0, pedestal=pedestal, mu=0.1, mu_statue=2.0, duration_s=1.2)
    assert slip_error_m(on, run(on, 2.5e-4)) <= budget.THROWN_SLIP_M


def test_a_run_in_the_layers_domain_says_that_no_step_was_plain() -> None:
    validity = run(squat(), 1e-3).validity
    assert (validity["plain_from_s"], validity["plain_for_s"], validity["plain_because"]) == (None, 0.0, [])


def test_a_statue_that_slips_at_its_impact_says_so() -> None:
    # Thrown to one side, it meets its support where friction does not bear the impact, not before.
    on = scene(rectangle(0.7, 1.0), theta_rad=0.1, mu_statue=0.45, duration_s=0.6)
    found = run(on, 1e-3)
    assert found.validity["plain_because"] == ["statue_slides"]
    assert found.validity["plain_from_s"] == pytest.approx(found.impact_times_s[0], abs=budget.TWO_STEPS_S)
    assert 0.0 < found.validity["plain_for_s"] < 0.5 * found.end_s


def test_a_pedestal_that_tips_says_so() -> None:
    narrow = Pedestal(100.0, 0.3, 0.5, 0.6)
    on = scene(rectangle(0.25, 1.0), Harmonic(0.6 * GRAVITY_M_S2, 2.0), pedestal=narrow, mu=1.0, mu_statue=2.0)
    assert "pedestal_tips" in run(on, 1e-3).validity["plain_because"]


@pytest.mark.parametrize("acts", ["static", 0.18])
def test_the_scenes_coefficient_acts_as_an_impact_breaks_the_pedestal_loose(acts: float | Literal["static"]) -> None:
    usual = paestum(0.429, 3.0, mu=(0.20, 0.15), duration_s=1.0)
    own = replace(usual, contact=replace(usual.contact, floor_impact=acts))
    found = run(own, 2.5e-4)
    by_own, by_kinetic = (MODEL.simulate(on, MODEL.refinement_levels(on)[1], RunOptions()) for on in (own, usual))
    assert errors(found, by_own, 1.0)[0] <= budget.TWO_FRICTIONS_FINE_RAD
    assert errors(found, by_kinetic, 1.0)[0] > 100.0 * budget.TWO_FRICTIONS_FINE_RAD
