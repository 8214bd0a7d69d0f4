"""Every engine against the modes of a rectangular block: from rest under a constant push, and as it lands flat.

q is its height over its width. From rest it rocks without slip above μ = (A (q² + 4) + 3 q)/(4 q² + 1 + 3 q A) under A g.
Landed flat with the velocities v_x, v_z it turns about its leading edge with ω = 3 (q v_x − v_z)/(4 (1 + q²) b), and the edge
sticks if m (v_x − ω h) ≤ μ m (v_z + ω b): for v_z/v_x above (4 + q² − 3 μ q)/(μ (1 + 4 q²) − 3 q); it slides below.
"""

from dataclasses import replace
from typing import Final

import numpy as np
import pytest

from analytic.excitation import Pulse
from harness import Run, RunOptions, engines
from harness.engines.base import Engine
from harness.model import Initial, Pose, Scene
from tests import budgets_engines as budget
from tests.scenes_for_tests import GRAVITY_M_S2, rectangle, scene

Q: Final = 3.0
WIDTH_M: Final = 0.4
PUSH_S: Final = 0.1
STEP_S: Final = 2.5e-4
ENGINES: Final = tuple(name for name in engines.REGISTRY if engines.load(name).missing() is None)
SLIPPING: Final = tuple(name for name in ENGINES if engines.load(name).capabilities.statue_slips)
LANDING: Final = tuple(name for name in ENGINES if engines.load(name).capabilities.posed_start)


def pushed(share_g: float, friction: float) -> Scene:
    block = rectangle(WIDTH_M, Q * WIDTH_M)
    return scene(
        block, Pulse("rectangular", share_g * GRAVITY_M_S2, PUSH_S), mu_statue=friction, duration_s=0.5 * PUSH_S
    )


def run(engine: Engine, on: Scene) -> Run:
    finest = engine.refinement_levels(on)[-1]
    settings = finest if engine.capabilities.certifies else engine.settings_for_dt(on, STEP_S)
    return engine.simulate(on, settings, RunOptions())


def critical(share_g: float) -> float:
    return (share_g * (Q * Q + 4.0) + 3.0 * Q) / (4.0 * Q * Q + 1.0 + 3.0 * Q * share_g)


@pytest.mark.parametrize("share_g", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("name", SLIPPING)
def test_uplift_without_slip_from_rest(name: str, share_g: float) -> None:
    slips = [
        run(engines.load(name), pushed(share_g, share * critical(share_g))).validity["statue_slip_m"]
        for share in (1.0 - budget.MODE_SHARE, 1.0 + budget.MODE_SHARE)
    ]
    assert slips[0] > budget.MODE_SLIP_M
    assert slips[1] < budget.MODE_STICK_M


@pytest.mark.parametrize("share_g", [0.5, 1.0, 2.0])
def test_the_planar_model_says_the_friction_that_uplift_needs(share_g: float) -> None:
    block = run(engines.load("analytic"), pushed(share_g, 2.0))
    assert block.validity["statue_friction_needed"] == pytest.approx(critical(share_g), rel=budget.MODE_FRICTION_REL)


@pytest.mark.parametrize(
    ("share_g", "friction", "rocks", "slides"),
    [(0.2, 0.4, False, False), (0.35, 0.3, False, True), (1.0, 0.4, True, True)],
)
@pytest.mark.parametrize("name", SLIPPING)
def test_the_modes_from_rest(name: str, share_g: float, friction: float, rocks: bool, slides: bool) -> None:
    found = run(engines.load(name), pushed(share_g, friction))
    assert (found.peak_theta_rad > budget.MODE_TURN_RAD) is rocks
    assert (found.validity["statue_slip_m"] > budget.MODE_SLIP_M) is slides


@pytest.mark.parametrize(("friction", "printed"), [(0.4, 1.6207), (0.5, 0.8947), (0.7, 0.3964)])
@pytest.mark.parametrize("name", LANDING)
def test_a_block_that_lands_flat_turns_about_an_edge_that_sticks_above_the_limit(
    name: str, friction: float, printed: float
) -> None:
    limit = (4.0 + Q * Q - 3.0 * friction * Q) / (friction * (1.0 + 4.0 * Q * Q) - 3.0 * Q)
    assert limit == pytest.approx(printed, abs=5e-5)
    speeds = []
    for share in (0.8, 1.2):
        height_m = 0.5 * Q * WIDTH_M
        down = share * limit
        pose = Pose((0.0, 0.0, height_m + 1e-3 * down), (1.0, 0.0, 0.0, 0.0), (1.0, 0.0, -down), (0.0, 0.0, 0.0))
        on = scene(rectangle(WIDTH_M, 2.0 * height_m), mu_statue=friction, duration_s=0.004, output_dt_s=5e-4)
        history = run(engines.load(name), replace(on, initial=Initial(pose=pose))).history
        # From 1 to 2.5 ms after the landing the leading vertex stands, or goes on.
        column = "corner_right_x_m" if "corner_right_x_m" in history.extra else "statue_slip_m"
        edge = np.interp([0.002, 0.0035], history.t_s, history.extra[column])
        speeds.append(float(edge[1] - edge[0]) / 0.0015)
    assert abs(speeds[1]) < budget.LANDED_STICKS_M_S
    assert speeds[0] > max(budget.LANDED_SLIDES_M_S, 2.0 * speeds[1])
