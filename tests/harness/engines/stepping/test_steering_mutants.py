"""Each wrong formula of what locates events fails the run: by the account of what is written, or by the friction that acted."""

from dataclasses import replace

import pytest

from analytic.block import GRAVITY_M_S2 as G
from analytic.excitation import Pulse
from harness import RunOptions, simulate
from harness.engines.base import LayerFault
from harness.model import BaseExcitation, Initial, Scene
from tests.engines_for_tests import ready
from tests.measures.mechanisms import changed
from tests.measures.seeded_scenes import GENERATORS
from tests.measures.steering_mutants import MUTANTS, STEP_S
from tests.scenes_for_tests import paestum

CASES = [(name, mutant) for name, mutants in MUTANTS.items() for mutant in mutants]


@pytest.fixture(params=[(0.429, 3.0), (0.334, 2.0)], ids=["0.429 g", "0.334 g"])
def scene(request: pytest.FixtureRequest) -> Scene:
    """The paper's pedestal with two coefficients: it breaks loose, slides and sticks again, at impacts and between them."""
    return paestum(*request.param, mu=(0.20, 0.15), duration_s=2.0)


@pytest.mark.parametrize(("name", "mutant"), CASES)
def test_a_wrong_formula_fails_the_run(name: str, mutant: str, scene: Scene) -> None:
    engine = ready(name)
    with changed(MUTANTS[name][mutant]), pytest.raises(LayerFault):
        engine.simulate(scene, engine.settings_for_dt(scene, STEP_S), RunOptions())


@pytest.mark.parametrize("name", MUTANTS)
@pytest.mark.parametrize("pedestal", [True, False])
@pytest.mark.parametrize("mutant", ["gravity + 1 ‰", "inertia + 1 ‰", "shaking + 1 ‰"])
def test_what_falls_without_an_impact_is_held_to_its_balance_too(name: str, mutant: str, pedestal: bool) -> None:
    engine, push = ready(name), Pulse("rectangular", 0.6 * G, 2.0, 0.2)
    falls = replace(
        paestum(0.4, 1.0, mu=(2.0, 2.0), pedestal=pedestal, duration_s=2.0), base_excitation=BaseExcitation(push)
    )
    settings = engine.settings_for_dt(falls, STEP_S)
    right = engine.simulate(falls, settings, RunOptions())
    assert right.impacts == 0
    assert right.outcome.overturned
    with changed(MUTANTS[name][mutant]), pytest.raises(LayerFault):
        engine.simulate(falls, settings, RunOptions())


@pytest.mark.parametrize("name", [*MUTANTS, "pymunk:plain", "pybullet:plain"])
@pytest.mark.parametrize("step_s", [4e-3, STEP_S])
def test_a_right_run_fails_no_check(name: str, step_s: float, scene: Scene) -> None:
    engine = ready(name)
    assert engine.simulate(scene, engine.settings_for_dt(scene, step_s), RunOptions()).history is not None


@pytest.mark.parametrize(("generator", "seed"), [("wide", 792006), ("random", 793026)])
def test_what_once_failed_a_right_run_does_not(generator: str, seed: int) -> None:
    """Two corrections of a statue that slides on its support; a pedestal that creeps by 4e-6 m and never breaks loose."""
    ready("pybullet")
    assert not simulate(GENERATORS[generator](seed), "pybullet").outcome.failed


@pytest.mark.parametrize("theta_rad", [0.2, 0.6])
def test_a_statue_that_falls_fast_over_a_sliding_pedestal_fails_no_check(theta_rad: float) -> None:
    """What a step of 4 ms leaves unread of the floor's friction is 3e-3 of the normal force, however small its coefficient."""
    push = BaseExcitation(Pulse("rectangular", 0.8 * G, 0.6, 0.1))
    falls = replace(paestum(mu=(0.053, 0.043)), initial=Initial(theta_rad=theta_rad), base_excitation=push)
    engine = ready("pymunk")
    assert engine.simulate(falls, engine.refinement_levels(falls)[0], RunOptions()).history is not None


def test_a_motion_of_fifty_g_is_no_impact() -> None:
    """Velocities of a sliding pedestal are read as those of any step, however quickly its table's change."""
    shaken = paestum(50.0, 4.5, mu=(0.11, 0.09), duration_s=0.5)
    engine = ready("pymunk")
    assert engine.simulate(shaken, engine.refinement_levels(shaken)[0], RunOptions()).history is not None
