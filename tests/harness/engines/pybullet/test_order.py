"""pybullet's errors fall faster than the step, through impacts, on any step, in half of the scene and in all of it."""

import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from analytic.excitation import Harmonic
from harness import RunOptions, load_scene
from harness.engines import load
from harness.engines.pybullet import pose
from harness.engines.pybullet.backend import BulletBackend
from harness.engines.pybullet.world import World
from harness.engines.stepping.frame import Schedule
from harness.engines.stepping.step_state import Stepper
from harness.model.scene import BaseExcitation, Scene
from harness.questions.bench.standard_scenes import standard_set
from tests import budgets_bullet as budget
from tests.harness.engines.pybullet.cases import WHOLE, apart, bullet, exact
from tests.measures.contact_engines import paper_scene
from tests.measures.seeded_scenes import random_scene
from tests.scenes_for_tests import GRAVITY_M_S2, SCENES, paestum, rectangle, scene

pytest.importorskip("pybullet")

HALF = RunOptions()
COARSEST_S = 4e-3


def error(on: Scene, dt_s: float, options: RunOptions = HALF) -> float:
    found, truth = bullet(on, dt_s, options), exact(on)
    times = np.linspace(0.0, min(found.end_s, truth.end_s), 500)
    return float(np.max(np.abs(found.history.at(times) - truth.history.at(times))))


def free_rocking(duration_s: float = 2.0) -> Scene:
    return scene(rectangle(0.2, 1.0), theta_rad=0.0987, duration_s=duration_s)


@pytest.mark.parametrize("options", [HALF, WHOLE], ids=["half", "whole"])
def test_four_impacts_leave_no_error_of_first_order(options: RunOptions) -> None:
    errors = [error(free_rocking(), dt_s, options) for dt_s in (4e-3, 1e-3)]
    assert errors[0] <= budget.FREE_ROCKING_COARSE_RAD
    assert math.log(errors[0] / errors[1], 4.0) >= budget.ORDER_WITH_IMPACTS


@pytest.mark.parametrize("dt_s", [4.3e-3, 2.6e-3, 1.7e-3, 1.3e-3])
def test_impacts_may_fall_anywhere_in_a_step(dt_s: float) -> None:
    assert error(free_rocking(), dt_s) <= budget.FREE_ROCKING_RAD * (dt_s / 1e-3) ** budget.ORDER_WITH_IMPACTS


@pytest.mark.parametrize("dt_s", [5e-4, 1.25e-4])
def test_a_pedestal_that_came_to_rest_is_held_by_static_friction(dt_s: float) -> None:
    """The step that ends where it comes to rest is at the kinetic limit. If that is taken for sliding still, the next impact
    moves it: 5.7e-4 rad off at once.
    """
    assert error(paper_scene(0.334, 2.0, static=0.2), dt_s) < budget.HELD_AFTER_REST_RAD


def test_a_standing_foot_stays_where_it_stands() -> None:
    # Each step takes it along the tangent of its circle, half a step's turning off its place: back again in the next.
    on = scene(rectangle(0.2, 1.0), theta_rad=0.0987, duration_s=0.3)
    run = bullet(on, 4e-3)
    assert np.max(np.abs(run.history.columns()["statue_slip_m"])) <= budget.SUPPORT_M


def test_a_sliding_foot_has_no_place_to_come_back_to() -> None:
    friction, motion = 0.1, Harmonic(0.4 * GRAVITY_M_S2, 2.0)
    on = scene(rectangle(0.2, 1.0), motion, mu_statue=friction, duration_s=1.0)
    run = bullet(on, 2.5e-4)
    slip_m = run.history.columns()["statue_slip_m"][-1]
    assert slip_m == pytest.approx(newmark_m(motion, friction, 1.0), rel=budget.SLIDING_REL)


@pytest.mark.parametrize("pedestal", [True, False], ids=["pedestal", "floor"])
def test_a_level_errs_by_what_it_states_at_most(pedestal: bool) -> None:
    on = paestum(0.334, 3.0, pedestal=pedestal, mu=(0.20, 0.15))
    for level in load("pybullet").refinement_levels(on)[:3]:
        worst = max(error(on, level.dt_s, options) for options in (HALF, WHOLE))
        assert worst <= level.expected_error_rad
        if level.dt_s == COARSEST_S:
            assert level.expected_error_rad <= budget.STATED_OVER * worst


@pytest.mark.parametrize(
    "on",
    [paestum(), paestum(pedestal=False), replace(paestum(), base_excitation=BaseExcitation(y=Harmonic(1.0, 2.0)))],
    ids=["pedestal", "floor", "across"],
)
def test_finer_levels_and_verification_runs_state_no_more(on: Scene) -> None:
    engine = load("pybullet")
    refinement_levels = engine.refinement_levels(on)
    assert all(coarse.expected_error_rad >= fine.expected_error_rad for coarse, fine in pairwise(refinement_levels))
    # A verification run has a little less than half the step of its level.
    states = [engine.verification_settings(on, level)[0].expected_error_rad for level in refinement_levels]
    assert states == [
        *(level.expected_error_rad for level in refinement_levels[1:-1]),
        *(level.expected_error_rad for level in refinement_levels[-2:]),
    ]


def test_many_vertices_let_go_at_once(data_dir: Path) -> None:
    # A scan stands on seventeen vertices of one plane: where those that have left stay contacts, solver iterations do
    # not reach the end.
    assert data_dir.is_dir()
    on = next(item for item in standard_set() if item.name.endswith("planar")).scene()
    rough, fine = (bullet(on, dt_s).history for dt_s in (4e-3, 5e-4))
    assert np.max(np.abs(rough.theta_rad - fine.at(rough.t_s))) <= budget.SCAN_UPLIFT_RAD


@pytest.mark.parametrize("options", [HALF, WHOLE], ids=["half", "whole"])
def test_static_friction_gives_way_inside_a_step(options: RunOptions) -> None:
    # From rest to the first slip: a step that is wholly static or wholly kinetic is off by up to (μ_s − μ_k) g times the step.
    on = paestum(0.334, 2.0, mu=(0.20, 0.15), duration_s=0.2)
    truth = exact(on)
    for dt_s, again in ((2e-3, 3), (1e-3, 4)):
        run = bullet(on, dt_s, options)
        # Once for the force that would hold it, once with the kinetic coefficient, once with the mean that acts over the step;
        # at 1 ms the force of the step before comes near its limit too, and holds.
        assert run.interventions["friction_release"].steps_again == again
        assert apart(run, truth, "slip_m") <= budget.SLIP_ONSET_M


def test_friction_just_below_its_limit_holds() -> None:
    # The force that holds the pedestal is within 0.2 % of its limit for ten steps: until it has passed it, it holds.
    on = replace(random_scene(19_040), duration_s=0.25)
    truth = exact(on)
    for dt_s in (1e-3, 1.1e-4):
        assert apart(bullet(on, dt_s), truth, "slip_m") <= budget.SLIP_ONSET_M


def newmark_m(motion: Harmonic, friction: float, duration_s: float, steps: int = 20_000) -> float:
    """Displacement of a sliding block on its support at the end, by steps in which friction may at most stop it."""
    dt_s = duration_s / steps
    table_m_s = motion.velocity_m_s(np.linspace(0.0, duration_s, steps + 1))
    lost_m_s, rate_m_s, slip_m = friction * GRAVITY_M_S2 * dt_s, 0.0, 0.0
    for pushed_m_s in -np.diff(table_m_s):
        free_m_s = rate_m_s + float(pushed_m_s)
        rate_m_s = math.copysign(max(abs(free_m_s) - lost_m_s, 0.0), free_m_s)
        slip_m += rate_m_s * dt_s
    return slip_m


def test_a_pedestal_that_a_blow_set_sliding_has_kinetic_friction() -> None:
    """Its friction is at the static limit and its velocity falls, but not to rest: the step is solved again, as a slip's is:
    for the force that would hold it, then with kinetic friction.
    """
    on, step_s = paestum(0.334, 2.0, mu=(0.20, 0.15)), 1e-3
    total_kg = on.statue.mass_kg + (0.0 if on.pedestal is None else on.pedestal.mass_kg)
    pull = (0.0, 0.0, -GRAVITY_M_S2 * step_s)

    def solved_again(before_m_s: float) -> int:
        after_m_s = before_m_s - math.copysign(0.20 * GRAVITY_M_S2 * step_s, before_m_s)
        with World(load("pybullet").settings_for_dt(on, step_s), pose.prepare(on)) as world:
            world.build(on)
            backend = BulletBackend(world, step_s, on.contact.statue)
            stepper = Stepper(backend, on, Schedule(on, step_s, 0, 10))
            row = backend.read()
            before, after = (
                (*row[:7], rate, 0.0, 0.0, *row[10:20], rate, 0.0, 0.0, *row[23:]) for rate in (before_m_s, after_m_s)
            )
            assert math.hypot(*stepper.friction(pull, before, after)[:2]) == pytest.approx(0.20 * total_kg * -pull[2])
            stepper.slip_before = (before_m_s, 0.0)
            stepper._slip_onset((0.0, 0.0, -GRAVITY_M_S2), pull, before, after)
            return sum(item.steps_again for item in stepper.writer.ledger.record().values())

    assert solved_again(0.05) == 2
    assert solved_again(0.20 * GRAVITY_M_S2 * step_s) == 0, "it comes to rest"
    assert solved_again(0.10 * GRAVITY_M_S2 * step_s) == 0, "it passes rest, where static friction holds it"


def test_a_pedestal_that_turns_aside_slides_on_past_rest() -> None:
    """The scan's products of inertia push the pedestal 2 mm/s across the plane: where it turns back more than kinetic friction is
    needed to hold it, so that it stays in motion, at every step; the plane's model has it stick, 4.7 mm away.
    """
    case = load_scene(
        SCENES / "paestum_pedestal.toml",
        ["motion.x.amplitude_g=0.334", "motion.x.frequency_hz=2", "duration_s=1.5"],
    )
    histories = [bullet(case, dt_s).history for dt_s in (1e-3, 5e-4, 2.5e-4)]
    finest = histories[-1]
    assert finest is not None
    for history in histories:
        assert abs(history.slip_m[-1] - finest.slip_m[-1]) <= budget.PAST_REST_M
        assert np.max(np.abs(history.theta_rad - finest.at(history.t_s))) <= budget.PAST_REST_RAD
    plane = exact(case).history
    assert abs(plane.slip_m[-1] - finest.slip_m[-1]) > 20.0 * budget.PAST_REST_M
