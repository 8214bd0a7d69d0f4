"""Where the floor's acceleration jumps a step ends: none takes a mean of what pulls on its sides."""

import math
from dataclasses import replace
from typing import Final

import pytest

from analytic.block import GRAVITY_M_S2 as G
from analytic.excitation import Excitation, Harmonic, Pulse, Record
from harness.accuracy.refinement import simulate
from harness.comparison.scores import error_rad, errors
from harness.engines.stepping.trajectory import Schedule
from harness.model import BaseExcitation, Scene
from tests import budgets_engines as budget
from tests.engines_for_tests import exact, ready, run
from tests.scenes_for_tests import PAESTUM, PAESTUM_PEDESTAL, rectangle, scene

COLUMN = rectangle(0.2, 1.0)
ENDS_AWAY = Record([0.3, 0.5, 0.7, 0.9], [0.25 * G, 0.1 * G, -0.2 * G, -0.22 * G])


def rectangular(start_s: float, share_g: float = 0.3) -> Pulse:
    return Pulse("rectangular", share_g * G, 0.25, start_s)


def cosine(start_s: float) -> Pulse:
    return Pulse("one_cosine", 0.3 * G, 0.3, start_s)


def upwards(motion: Excitation) -> BaseExcitation:
    return BaseExcitation(x=Harmonic(0.3 * G, 2.0), z=motion)


SCENES: Final[dict[str, Scene]] = {
    "on the grid": scene(COLUMN, rectangular(0.2), duration_s=1.0),
    "inside a step": scene(COLUMN, rectangular(0.2007), duration_s=1.0),
    "a record that begins and ends away from zero": scene(COLUMN, ENDS_AWAY, duration_s=1.2),
    "pedestal": scene(PAESTUM, cosine(0.2), pedestal=PAESTUM_PEDESTAL, mu=0.15, duration_s=0.9),
    "two coefficients": scene(PAESTUM, cosine(0.2003), pedestal=PAESTUM_PEDESTAL, mu=(0.2, 0.15), duration_s=0.9),
    "vertical": replace(scene(PAESTUM, duration_s=0.9), base_excitation=upwards(rectangular(0.3, 0.4))),
    "a table that moves": replace(scene(COLUMN, rectangular(0.2), duration_s=1.0), table="moving"),
    "an imposed impact": scene(COLUMN, rectangular(0.2), restitution=0.9, duration_s=1.0),
}


@pytest.mark.parametrize("name", ["pymunk", "pybullet"])
@pytest.mark.parametrize("case", list(SCENES))
def test_errors_are_none_of_the_jump_s(name: str, case: str) -> None:
    on = SCENES[case]
    off_rad, off_m = errors(run(name, on, 1e-3), exact(on), on.duration_s)
    assert off_rad < budget.JUMP_RAD
    assert off_m < budget.JUMP_M


@pytest.mark.parametrize("name", ["pymunk", "pybullet"])
def test_the_statement_holds(name: str) -> None:
    """A cosine pulse on a statue on the floor, begun on the grid of some steps and inside others."""
    engine, on = ready(name), scene(PAESTUM, cosine(0.2184), duration_s=1.2)
    model, found = exact(on), simulate(on, engine.name, accuracy_rad=1e-4)
    until_s = min(found.bounded_until_s, model.no_return_time_s or math.inf)
    assert error_rad(model, found, until_s) < found.numerical_uncertainty_rad


def test_jumps_of_all_directions_are_met_once_each() -> None:
    on = replace(SCENES["on the grid"], base_excitation=upwards(rectangular(0.3)))
    schedule = Schedule(on, 1e-3, 0, 1000)
    assert schedule.jump_after_s(0.0) == 0.3
    assert schedule.jump_after_s(0.3) == 0.3 + 0.25
    assert schedule.jump_after_s(0.55) == math.inf
