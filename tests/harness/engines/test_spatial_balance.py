"""What the exact body's run says of energy and contact: of all its motion, where the contact engines' is of the plane."""

import math
from dataclasses import replace

import numpy as np
import pytest

from analytic import Pulse
from harness import Run, simulate
from harness.engines.spatial import LEVELS
from harness.model import BaseExcitation, Contact, Initial, Pose
from tests import budgets_spatial as budget
from tests.measures.profiles import BASES, statue
from tests.measures.profiles import scene as profile_scene
from tests.scenes_for_tests import GRAVITY_M_S2, block, rectangle, scene

TENSOR = np.array([[90.0, 4.0, 3.0], [4.0, 80.0, -2.0], [3.0, -2.0, 40.0]])
"""Of a body that is its own mirror image in no plane."""


@pytest.fixture(scope="module")
def thrown() -> Run:
    """A block thrown across the plane, spinning about all axes."""
    pose = Pose((0.0, 0.0, 1.5), (math.cos(0.4), math.sin(0.4), 0.0, 0.0), (0.5, 2.0, 1.0), (1.0, -2.0, 3.0))
    still = scene(rectangle(0.3, 1.2, depth_m=0.4), duration_s=1.2)
    return simulate(replace(still, initial=Initial(pose=pose), contact=Contact(0.2, 0.15, 0.7)), "spatial")


def test_energy_is_kept_in_flight_and_lost_in_impacts_and_by_sliding(thrown: Run) -> None:
    energy_j = thrown.columns()["energy_j"]
    first = np.searchsorted(thrown.columns()["t_s"], thrown.impact_times_s[0])
    height_j = 1.2 * GRAVITY_M_S2 * 1000.0
    np.testing.assert_allclose(energy_j[:first], energy_j[0], atol=budget.AUDIT * height_j)
    lost_j = thrown.validity["lost_in_impacts_j"] + thrown.validity["energy_lost_by_sliding_j"]
    assert lost_j == pytest.approx(energy_j[0] - energy_j[-1], rel=budget.FRICTION_REL)
    assert thrown.validity["energy_gained_j"] is None


def test_what_touches_is_not_told_to_penetrate(thrown: Run) -> None:
    assert thrown.validity["penetration_m"] < LEVELS[0][0]
    assert thrown.validity["statue_flight_m"] > 0.5


def test_the_largest_lean_of_a_body_that_is_thrown_is_from_upright(thrown: Run) -> None:
    columns = thrown.columns()
    tilt = np.arccos(np.cos(columns["roll_rad"]) * np.cos(columns["pitch_rad"]))
    assert thrown.validity["peak_lean_rad"] == pytest.approx(tilt.max(), abs=budget.THRESHOLD)


def test_a_worn_base_passes_its_balance_where_the_model_does() -> None:
    worn = profile_scene(statue(BASES["bulging"]), Pulse("one_sine", 6.0, 0.8), 3.0)
    model, body = (simulate(worn, name, accuracy_rad=1e-6) for name in ("analytic", "spatial"))
    assert model.outcome is body.outcome
    assert model.no_return_time_s is not None
    assert body.no_return_time_s == pytest.approx(model.no_return_time_s, abs=budget.TIME_S)


def test_slip_and_turn_do_not_depend_on_the_axes() -> None:
    corners = np.array([[-0.2, -0.1, 0.0], [0.25, -0.2, 0.0], [0.2, 0.3, 0.0], [-0.15, 0.2, 0.0]])
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    along, across = (
        replace(
            block(
                mass_kg=600.0,
                corner_left_m=left_m,
                corner_right_m=right_m,
                centroid_height_m=0.45,
                inertia_kg_m2=80.0,
                height_m=0.9,
                depth_m=0.5,
            ),
            footprint_m=corners @ each.T,
            inertia_tensor_kg_m2=each @ TENSOR @ each.T,
        )
        for each, left_m, right_m in ((np.eye(3), 0.2, 0.25), (turn, 0.3, 0.2))
    )
    push = Pulse("one_sine", 7.0, 0.5)
    told = []
    for body, shaken in ((along, BaseExcitation(x=push)), (across, BaseExcitation(y=push))):
        run = simulate(
            replace(scene(body, mu_statue=0.6, duration_s=1.0), base_excitation=shaken), "spatial", accuracy_rad=1e-6
        )
        told.append([run.validity[name] for name in ("statue_slip_m", "yaw_rad", "peak_lean_rad")])
    assert min(told[0]) > 1e-3
    assert told[0] == pytest.approx(told[1], rel=budget.THRESHOLD)
