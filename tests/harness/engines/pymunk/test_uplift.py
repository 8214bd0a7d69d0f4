"""An uplift inside a step of pymunk: what it owes, and that a slow statue keeps its contact at the longest step."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.excitation import Pulse
from harness.engines.analytic import TwoBlock
from harness.engines.pymunk import Munk2D, loop, uplift
from harness.model.options import RunOptions
from harness.model.run import Run
from harness.model.scene import Scene
from tests import budgets_engines as budget
from tests.scenes_for_tests import rectangle, scene

ENGINE, MODEL = Munk2D(), TwoBlock()
DT_S = 8e-3


def shaken(share: float, sign: float = 1.0) -> Scene:
    """A block under a pulse that begins at a share of a step."""
    pulse = Pulse("one_sine", sign * 0.3 * 9.81, 0.5, 0.1 + share * DT_S)
    return scene(rectangle(0.2, 1.0), pulse, duration_s=0.4)


def error(on: Scene, dt_s: float = DT_S) -> float:
    """Largest error of the rotation against the analytic model, rad."""
    found, exact = run(on, dt_s), MODEL.simulate(on, MODEL.refinement_levels(on)[1], RunOptions())
    assert found.history is not None
    assert exact.history is not None
    times = np.linspace(0.0, on.duration_s, 500)
    return float(np.max(np.abs(found.history.at(times) - exact.history.at(times))))


def run(on: Scene, dt_s: float = DT_S) -> Run:
    return ENGINE.simulate(on, ENGINE.settings_for_dt(on, dt_s), RunOptions())


SHARES = (0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875)


def test_an_uplift_errs_at_second_order_wherever_in_a_step_it_comes() -> None:
    at_4_ms, at_1_ms = (max(error(shaken(share), dt_s) for share in SHARES) for dt_s in (4e-3, 1e-3))
    assert at_4_ms <= budget.UPLIFT_RAD
    assert math.log(at_4_ms / at_1_ms, 4.0) >= budget.UPLIFT_ORDER
    assert all(run(shaken(share)).work["uplifts_met"] == 1 for share in SHARES)


def test_uncorrected_it_errs_by_where_it_comes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(uplift, "follow", lambda *_: True)
    errors = [error(shaken(share), 4e-3) for share in SHARES]
    assert max(errors) > 1.5 * budget.UPLIFT_RAD
    assert max(errors) > 3.0 * min(errors)


def test_both_sides_are_owed_the_same() -> None:
    right, left = (run(shaken(0.0, sign), 4e-3).history for sign in (1.0, -1.0))
    assert right is not None
    assert left is not None
    np.testing.assert_allclose(right.theta_rad, -left.theta_rad, rtol=0.0, atol=budget.UPLIFT_RAD)


def test_a_statue_that_turns_slowly_keeps_its_contact_at_the_longest_step() -> None:
    # Unheld, its corner rises by the tangent of its circle in each step; at 8 ms it left the support before the rate was "fast".
    assert error(scene(rectangle(0.2, 1.0), theta_rad=0.0987, duration_s=2.0)) <= budget.LONGEST_STEP_RAD


def test_an_uplift_at_the_edge_of_a_block_of_steps_forgets_no_state_that_was_taken(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    on = shaken(0.3)
    whole = run(on, 1e-3).history
    monkeypatch.setattr(loop, "BLOCK_STEPS", 1)
    each_step = run(on, 1e-3)
    assert each_step.work["uplifts_met"] == 1
    assert each_step.history is not None
    assert whole is not None
    np.testing.assert_allclose(each_step.history.theta_rad, whole.theta_rad, rtol=0.0, atol=budget.BLOCKS_RAD)
