"""pybullet where it has ways of its own: standing feet, many vertices, levels, pedestals that turn aside, rest left out."""

import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from analytic.excitation import Harmonic, SampledAcceleration
from harness import load_scene
from harness.engines import load
from harness.engines.pybullet import statue as body
from harness.engines.pybullet.world import BulletBackend, World
from harness.engines.stepping.step_state import Stepper
from harness.engines.stepping.trajectory import Schedule
from harness.model import BaseExcitation, Scene
from harness.questions.bench.standard_scenes import standard_set
from tests import budgets_engines as budget
from tests.engines_for_tests import NOTHING_SKIPPED, apart, bullet, exact
from tests.scenes_for_tests import GRAVITY_M_S2, SCENES, paestum, rectangle, scene

pytest.importorskip("pybullet")


def test_a_standing_foot_stays_where_it_stands() -> None:
    # Each step takes it along the tangent of its circle, half a step's turning off its place: back again in the next.
    on = scene(rectangle(0.2, 1.0), theta_rad=0.0987, duration_s=0.3)
    run = bullet(on, 4e-3)
    assert np.max(np.abs(run.history.columns()["statue_slip_m"])) <= budget.SUPPORT_M


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


def test_a_pedestal_that_a_blow_set_sliding_has_kinetic_friction() -> None:
    """Its friction is at the static limit and its velocity falls, but not to rest: the step is solved again, as a slip's is:
    for the force that would hold it, then with kinetic friction.
    """
    on, step_s = paestum(0.334, 2.0, mu=(0.20, 0.15)), 1e-3
    total_kg = on.statue.mass_kg + (0.0 if on.pedestal is None else on.pedestal.mass_kg)
    pull = (0.0, 0.0, -GRAVITY_M_S2 * step_s)

    def solved_again(before_m_s: float) -> int:
        after_m_s = before_m_s - math.copysign(0.20 * GRAVITY_M_S2 * step_s, before_m_s)
        with World(load("pybullet").settings_for_dt(on, step_s), body.prepare(on)) as world:
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


def test_impacts_are_met_at_steps_that_no_foot_crosses_quickly() -> None:
    """A coming foot that is nearer than a standing one may be, because it goes so little in a step, still comes."""
    case = scene(rectangle(0.4, 1.0), theta_rad=2e-3, duration_s=0.12)
    assert apart(bullet(case, 2e-5), exact(case)) <= budget.SMALL_RAD


def test_finest_level_stays_in_the_plane() -> None:
    case = paestum(0.429, 3.0, duration_s=0.3)
    engine = load("pybullet")
    run = engine.simulate(case, engine.refinement_levels(case)[-1], NOTHING_SKIPPED)
    assert run.validity["out_of_plane_rad"] <= budget.PLANAR_FINEST_RAD


@pytest.mark.parametrize("sampled", [False, True])
def test_rest_that_is_left_out_changes_no_rotation_after_it(sampled: bool) -> None:
    """Each crest passes the statue's limit by a tenth: what it does then begins from contacts as they are at that instant."""
    motion = Harmonic(0.1 * GRAVITY_M_S2, 0.8)
    t_s = np.arange(0.0, 3.0, 0.002)
    x = SampledAcceleration(t_s, motion.accel_m_s2(t_s)) if sampled else motion
    case = replace(load_scene(SCENES / "paestum_pedestal.toml"), base_excitation=BaseExcitation(x=x), duration_s=2.5)
    run = bullet(case, 1e-3)
    assert run.skipped["quiet_start"] > 0.8
    assert run.skipped["quiet_rest"] > 0.5
    assert run.peak_theta_rad > 2e-3
    assert apart(run, bullet(case, 1e-3, NOTHING_SKIPPED)) <= budget.REST_LEFT_OUT_RAD


@pytest.mark.parametrize("sampled", [True, False])
def test_a_table_that_moves_before_anything_else_does_takes_it_along(sampled: bool) -> None:
    """Until a ramp reaches the limits of rest nothing moves on the table, which has its velocity by then."""
    motion, t_s = Harmonic(0.25 * GRAVITY_M_S2, 2.0, ramp_s=1.0), np.arange(0.0, 1.2, 0.002)
    x = SampledAcceleration(t_s, motion.accel_m_s2(t_s)) if sampled else motion
    on = replace(paestum(0.3, 2.0, duration_s=1.0), base_excitation=BaseExcitation(x=x))
    frame, moving = bullet(on, 1e-3), bullet(replace(on, table="moving"), 1e-3)
    assert frame.skipped["quiet_start"] > 0.3
    assert moving.peak_slip_m == pytest.approx(frame.peak_slip_m, abs=budget.TABLE_M)
    assert apart(moving, frame) <= budget.TABLE_RAD
