"""Slip in pymunk: what a pedestal that slides takes of a rocking statue's momentum, at the instant at which it is."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.excitation import Pulse
from harness.engine import Want
from harness.engines.munk2d import Munk2D
from harness.engines.twoblock import TwoBlock
from harness.record import Run
from harness.scene import Pedestal, Scene
from tests import budgets_engines as budget
from tests.scenes_for_tests import GRAVITY_M_S2, rectangle, scene

ENGINE, MODEL = Munk2D(), TwoBlock()


def run(on: Scene, dt_s: float) -> Run:
    return ENGINE.simulate(on, ENGINE.settings_for_dt(on, dt_s), Want())


def slip_error_m(on: Scene, found: Run) -> float:
    exact = MODEL.simulate(on, MODEL.ladder(on)[1], Want())
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
    on = squat() if pedestal else squat().but(pedestal=None)
    assert run(on, 1e-3).validity["statue_slip_m"] <= budget.STATUE_WALK_M


def test_a_start_with_a_rate_has_its_momentum() -> None:
    pedestal = Pedestal(300.0, 0.6, 0.5, 0.1)
    on = scene(rectangle(0.4, 1.0), theta_rate_rad_s=-1.0, pedestal=pedestal, mu=0.1, mu_statue=2.0, duration_s=1.2)
    assert slip_error_m(on, run(on, 2.5e-4)) <= budget.THROWN_SLIP_M
