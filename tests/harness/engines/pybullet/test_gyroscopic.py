"""The gyroscopic torque that the layer adds to Bullet's: a body in free flight against the exact one, and where none is added."""

from dataclasses import replace
from typing import Final

import numpy as np
import pytest

from analytic.excitation import ZeroExcitation
from harness import Run, RunOptions, engines
from harness.model import BaseExcitation, Contact, Form, Initial, Pose, Scene
from harness.questions.validate.tosses import poses
from tests import budgets_engines as budget
from tests.engines_for_tests import bullet
from tests.measures.seeded_scenes import block

MOMENTS_KG_M2: Final = (140.0, 150.0, 30.0)
FLIGHT_S: Final = 2.0


def flight(rate_rad_s: tuple[float, float, float]) -> Scene:
    """A body thrown 100 m above the floor, turning."""
    statue = block(100.0, 0.3, 0.3, 0.6, MOMENTS_KG_M2[1], 0.6)
    statue = replace(statue, inertia_tensor_kg_m2=np.diag(MOMENTS_KG_M2))
    start = Initial(pose=Pose((0.0, 0.0, 100.0), (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), rate_rad_s))
    still, contact = BaseExcitation(ZeroExcitation()), Contact(0.5, 0.5, 0.5)
    return Scene("free flight", FLIGHT_S, 9.81, Form(), statue, None, contact, still, initial=start)


def attitude_error_rad(scene: Scene, run: Run, exact: Run) -> float:
    """Angle between the two rotations at the end."""
    here, there = (poses(scene.statue, item)[0][-1] for item in (run.history, exact.history))
    assert run.history.t_s[-1] == pytest.approx(exact.history.t_s[-1])
    return float(2.0 * np.arcsin(np.linalg.norm(here - there) / np.sqrt(8.0)))


@pytest.mark.parametrize("rate_rad_s", [(0.3, 1.5, 0.5), (1.0, 0.5, 3.0)])
def test_free_flight_is_of_second_order(rate_rad_s: tuple[float, float, float]) -> None:
    scene, exact = flight(rate_rad_s), engines.load("spatial")
    truth = exact.simulate(scene, exact.refinement_levels(scene)[-1], RunOptions())
    coarse, fine = (attitude_error_rad(scene, bullet(scene, dt_s), truth) for dt_s in (2e-3, 1e-3))
    assert fine < budget.FREE_FLIGHT_RAD
    assert coarse / fine > budget.SECOND_ORDER


def test_it_is_counted_as_an_intervention_and_changes_no_place() -> None:
    run = bullet(flight((1.0, 0.5, 3.0)), 1e-3)
    account = run.interventions["gyroscopic"]
    assert account.count == run.steps
    assert account.rate_rad_s > 0.0
    assert account.moved_m == account.turned_rad == account.velocity_m_s == 0.0


def test_what_turns_in_the_plane_alone_lacks_none() -> None:
    scene = replace(flight((0.0, 1.0, 0.0)), initial=Initial(theta_rad=0.1), duration_s=0.3)
    run = bullet(scene, 1e-3)
    assert "mirror" in run.skipped
    assert "gyroscopic" not in run.interventions
