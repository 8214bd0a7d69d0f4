"""Thrown bodies, bodies in flight and walls: what events are located for is not there, the layer writes next to nothing, and its
checks refuse no right run."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analytic.block import GRAVITY_M_S2 as G
from analytic.excitation import Harmonic, Pulse
from harness import Outcome, Run, load_scene
from harness.engines.base import EngineFailure
from harness.engines.stepping.step_state import StepState
from harness.model import BaseExcitation, Scene, Wall
from tests import budgets_engines as budget
from tests.engines_for_tests import bullet, run
from tests.measures.mechanisms import changed
from tests.measures.steering_mutants import LAYER
from tests.scenes_for_tests import PAESTUM, paestum, scene

CUBE = Path(__file__).parents[4] / "scenes" / "cube_toss.toml"
THROWS = 12
STEP_S = 1e-3


def thrown(seed: int, *, height_m: float = 0.15, duration_s: float = 0.8) -> Scene:
    drawn = np.random.default_rng(seed)
    initial = {
        "initial.position_m": [0.0, 0.0, height_m],
        "initial.velocity_m_s": [float(v) for v in drawn.normal(0.0, 1.0, 2)] + [0.0],
        "initial.angular_velocity_rad_s": [float(v) for v in drawn.normal(0.0, 6.0, 3)],
    }
    return load_scene(CUBE, {**initial, "duration_s": duration_s})


def given_and_taken_j(of: Run) -> float:
    return sum(item.given_j + item.taken_j for item in of.interventions.values())


@pytest.mark.parametrize("seed", range(THROWS))
def test_no_thrown_cube_that_slides_and_tumbles_is_refused(seed: int) -> None:
    found = bullet(thrown(seed), STEP_S)
    assert found.outcome is not Outcome.CRASHED
    assert "impact" in found.interventions


def test_a_wrong_sense_is_seen_in_what_slides_too() -> None:
    """Of the throws that turn on at all, as some never do."""
    with changed(LAYER["turned the other way"]):
        refused = 0
        for seed in range(THROWS):
            try:
                bullet(thrown(seed), STEP_S)
            except EngineFailure:
                refused += 1
    assert refused > THROWS // 2


def test_nothing_is_written_to_a_body_in_flight() -> None:
    found = bullet(thrown(0, height_m=1.0, duration_s=0.3), STEP_S)
    assert given_and_taken_j(found) == 0.0
    assert sum(item.moved_m + item.velocity_m_s for item in found.interventions.values()) == 0.0


@pytest.mark.parametrize("name", ["pymunk", "pybullet"])
def test_next_to_nothing_is_written_to_a_statue_that_is_thrown_up_and_lands(name: str) -> None:
    up = BaseExcitation(x=Harmonic(0.2 * G, 2.0), z=Pulse("one_sine", 1.6 * G, 0.4, 0.1))
    found = run(name, replace(scene(PAESTUM, duration_s=0.8), base_excitation=up), STEP_S)
    fell_j = PAESTUM.mass_kg * G * float(found.validity["statue_flight_m"])  # type: ignore[arg-type]
    assert fell_j > 100.0
    assert given_and_taken_j(found) < budget.WRITTEN_IN_FLIGHT * fell_j


@pytest.mark.parametrize("name", ["pymunk", "pybullet"])
@pytest.mark.parametrize("pedestal", [False, True])
def test_next_to_nothing_is_written_where_a_wall_is_met(name: str, pedestal: bool) -> None:
    on = replace(
        paestum(0.429, 2.0, mu=(0.2, 0.15), pedestal=pedestal, duration_s=2.0),
        wall=Wall("right", 0.2 if pedestal else 0.03),
    )
    found = run(name, on, STEP_S)
    assert found.outcome is Outcome.TOUCHES_WALL
    assert given_and_taken_j(found) < budget.WRITTEN_AT_WALL_J


def test_a_turned_foot_may_slide(monkeypatch: pytest.MonkeyPatch) -> None:
    """The velocity is turned about the foot: what a body slides with is none of its turning."""
    turned: list[tuple[float, ...]] = []
    own = StepState.turn

    def turn(self: StepState, seconds: float, foot_m: tuple[float, float, float]) -> None:
        before = self.row
        own(self, seconds, foot_m)
        spin, change = np.array(before[10:13]), np.array(self.row[7:10]) - before[7:10]
        assert change == pytest.approx(-seconds * np.cross(spin, np.cross(spin, foot_m)), rel=1e-6, abs=1e-15)
        turned.append(foot_m)

    monkeypatch.setattr(StepState, "turn", turn)
    bullet(thrown(1), STEP_S)
    assert turned
