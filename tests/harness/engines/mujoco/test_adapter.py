"""MuJoCo as it is: close without a pedestal, soft with one, and its rows stand whatever they are."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from analytic.excitation import Harmonic, Pulse
from harness.accuracy.simulation import simulate
from harness.engines.analytic import TwoBlock
from harness.engines.base import EngineFailure
from harness.engines.mujoco.adapter import Mujoco3D
from harness.model.history import Outcome
from harness.model.options import RunOptions
from harness.model.run import Run
from harness.model.scene import BaseExcitation, Scene, Wall
from tests import budgets_engines as budget
from tests.scenes_for_tests import GRAVITY_M_S2, PAESTUM, paestum, rectangle, scene

pytest.importorskip("mujoco", reason="mujoco is an optional extra and is not installed")
ENGINE = Mujoco3D()


def run(on: Scene, dt_s: float) -> Run:
    return ENGINE.simulate(on, ENGINE.settings_for_dt(on, dt_s), RunOptions())


def apart(on: Scene, dt_s: float) -> float:
    model = TwoBlock()
    exact, found = model.simulate(on, model.refinement_levels(on)[1], RunOptions()).history, run(on, dt_s).history
    assert exact is not None
    assert found is not None
    return float(np.max(np.abs(exact.theta_rad - found.theta_rad)))


@pytest.mark.parametrize(("amplitude_g", "frequency_hz"), [(0.334, 2.0), (0.429, 3.0)])
def test_statue_on_the_floor_follows_the_model(amplitude_g: float, frequency_hz: float) -> None:
    on = paestum(amplitude_g, frequency_hz, pedestal=False)
    coarse, fine = apart(on, 1e-3), apart(on, 2.5e-4)
    assert max(coarse, fine) <= budget.MUJOCO_FLOOR_RAD


def test_statue_on_a_pedestal_is_soft() -> None:
    assert apart(paestum(0.429, 3.0), 2.5e-4) <= budget.MUJOCO_PEDESTAL_RAD


def test_planar_scene_stays_planar_on_the_floor() -> None:
    history = run(paestum(0.429, 3.0, pedestal=False), 1e-3).history
    assert history is not None
    for name in ("roll_rad", "yaw_rad", "statue_y_m"):
        assert np.max(np.abs(history.extra[name])) <= budget.CREEP


def test_a_raised_base_vertex_is_felt() -> None:
    on = scene(PAESTUM, Harmonic(0.429 * GRAVITY_M_S2, 3.0), duration_s=0.4)
    footprint = PAESTUM.footprint_m.copy()
    footprint[1, 2] = 0.002
    raised = on.but(statue=replace(PAESTUM, footprint_m=footprint))
    a, b = run(on, 1e-3).history, run(raised, 1e-3).history
    assert a is not None
    assert b is not None
    assert np.max(np.abs(a.theta_rad - b.theta_rad)) > 1e-3


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"contact": replace(paestum().contact, restitution=0.9)}, "a prescribed ratio at impact"),
        ({"table": "moving"}, "a moving table"),
        ({"wall": Wall("right", 0.3)}, "a wall"),
    ],
)
def test_what_is_not_computed_is_refused_in_one_sentence(change: dict[str, Any], said: str) -> None:
    asked = paestum(0.429, 3.0, duration_s=0.1).but(**change)
    with pytest.raises(
        EngineFailure, match=f"^mujoco does not compute {said}.*: leave it out, or ask pymunk or pybullet$"
    ):
        run(asked, 1e-3)
    assert simulate(asked, "mujoco", dt_s=1e-3).outcome.failed


def test_a_fall_across_the_plane_is_told_apart() -> None:
    """Pushed along y alone the statue falls over its front edge, which a planar rotation cannot see."""
    push = BaseExcitation(y=Pulse("one_sine", GRAVITY_M_S2, 1.0))
    found = run(scene(PAESTUM, Harmonic(0.1, 3.0), duration_s=3.0).but(base_excitation=push), 1e-3)
    assert found.outcome in (Outcome.OVERTURNED_FRONT, Outcome.OVERTURNED_BACK)
    assert found.overturn_time_s == found.end_s


def test_an_edge_under_shaking_across_keeps_both_its_feet() -> None:
    """A block at 30 to 45°: its edge sticks, and turns as if alone, until one of its vertices has no load left (0.083 s)."""
    block = rectangle(0.30, 1.20, mass_kg=500.0, depth_m=0.40)
    across = BaseExcitation(Pulse("one_sine", 0.5 * GRAVITY_M_S2, 0.5), Pulse("one_sine", 0.45 * GRAVITY_M_S2, 0.6))
    on = scene(block, mu_statue=5.0, duration_s=0.079).but(base_excitation=across)
    alone = on.but(base_excitation=BaseExcitation(across.x))
    for dt_s in (2.5e-4, 5e-5):
        found, plane = run(on, dt_s).history, run(alone, dt_s).history
        assert found is not None
        assert plane is not None
        assert np.max(np.abs(found.theta_rad - plane.theta_rad)) < budget.MUJOCO_EDGE_RAD
        assert np.max(np.abs(found.extra["yaw_rad"])) < budget.MUJOCO_EDGE_RAD
