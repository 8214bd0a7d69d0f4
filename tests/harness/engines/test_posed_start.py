"""Starts from a pose in space: closed forms, symmetries and the independent reference beside the engines that take them."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from analytic import Harmonic
from harness import InputError, Outcome, Run, RunOptions, assess, engines, load_scene
from harness.accuracy.refinement import RunTarget, simulate_with
from harness.engines.base import Engine
from harness.model import BaseExcitation, Contact, Initial, Pose, Scene, Uncertain
from harness.questions.assess.probability import assess_models
from tests import budgets_spatial as budget
from tests.analytic.spatial.reference import initial_state, simulate
from tests.analytic.spatial.reference_body import Case
from tests.scenes_for_tests import GRAVITY_M_S2, rectangle, scene

BLOCK = rectangle(0.3, 1.2, depth_m=0.4)
POSED = ("pybullet", "pybullet:plain")
LANDED_S = 0.15
"""Some 0.04 s after the first impact of a throw, before the next."""


def thrown(pose: Pose, duration_s: float, friction: float = 1.0) -> Scene:
    """The block from a pose, on the floor."""
    return replace(
        scene(BLOCK, duration_s=duration_s),
        initial=Initial(pose=pose),
        contact=Contact(0.2, 0.15, friction),
        output_dt_s=0.01,
    )


def run(name: str, on: Scene, dt_s: float) -> Run:
    engine = engines.load(name)
    if engine.missing() is not None:
        pytest.skip(str(engine.missing()))
    return simulate_with(engine, on, RunTarget(dt_s=dt_s))


def turned(found: Run) -> Rotation:
    """The body's rotation at each sample."""
    extra = found.history.extra
    return Rotation.from_euler("xyz", np.column_stack([extra[f"{name}_rad"] for name in ("roll", "pitch", "yaw")]))


def test_a_thrown_body_of_too_many_vertices_is_refused_in_one_sentence() -> None:
    angles = np.linspace(0.0, 2.0 * math.pi, 300, endpoint=False)
    ring = np.column_stack([0.2 * np.cos(angles), 0.2 * np.sin(angles), np.zeros(300)])
    case = thrown(Pose((0.0, 0.0, 2.0)), 0.2)
    found = run("spatial", replace(case, statue=replace(case.statue, footprint_m=ring)), 1e-3)
    assert found.outcome is Outcome.CRASHED
    assert "at most 256 vertices" in found.message
    assert not found.message.endswith(".")


@pytest.mark.parametrize("name", sorted(engines.REGISTRY))
def test_a_pose_is_begun_from_or_refused(name: str) -> None:
    engine: Engine = engines.load(name)
    pose = Pose((0.1, -0.2, 2.0), (math.cos(0.3), 0.0, 0.0, math.sin(0.3)))
    found = run(name, thrown(pose, 0.05), 1e-3)
    if not engine.capabilities.posed_start:
        assert found.outcome is Outcome.CRASHED
        assert "pose" in found.message
        return
    if engine.capabilities.dimensions == 2:
        assert "pose" in found.message
        on = thrown(replace(pose, quaternion_wxyz=(math.cos(0.3), 0.0, math.sin(0.3), 0.0)), 0.05)
        history = run(name, on, 1e-3).history
        assert history.theta_rad[0] == pytest.approx(0.6, abs=budget.INTEGRATED)
        return
    assert turned(found)[0].as_quat()[[3, 0, 1, 2]] == pytest.approx(pose.quaternion_wxyz, abs=budget.INTEGRATED)


@pytest.mark.parametrize("name", POSED)
def test_torque_free_flight_errs_by_the_first_order_of_the_step(name: str) -> None:
    """ω and attitude by Euler's equations (the reference is held to their closed forms); the flight passes any rotation."""
    pose = Pose((0.0, 0.0, 100.0), velocity_m_s=(1.0, 2.0, 0.0), angular_velocity_rad_s=(1.0, 0.5, 3.0))
    on = thrown(pose, 2.0)
    wanted = exact(on)
    errors = [float(np.max((turned(run(name, on, dt)) * wanted.inv()).magnitude())) for dt in (1e-3, 5e-4)]
    assert errors[0] < budget.FLIGHT_RAD_PER_S * 1e-3
    assert errors[1] < budget.FIRST_ORDER * errors[0]


@pytest.mark.parametrize("name", ["spatial", "pybullet"])
def test_torque_free_flight_keeps_its_attitude(name: str) -> None:
    pose = Pose((0.0, 0.0, 100.0), velocity_m_s=(1.0, 2.0, 0.0), angular_velocity_rad_s=(1.0, 0.5, 3.0))
    on = thrown(pose, 2.0)
    assert np.max((turned(run(name, on, 1e-3)) * exact(on).inv()).magnitude()) < budget.TORQUE_FREE_RAD


def exact(on: Scene) -> Rotation:
    """The reference's rotations at the output times."""
    pose, statue = on.initial.pose, on.statue
    mu = on.contact.statue
    case = Case(
        statue.mass_kg, statue.inertia_tensor_kg_m2, statue.outer_points_m, mu, mu, gravity_m_s2=on.gravity_m_s2
    )
    parts = (pose.position_m, pose.quaternion_wxyz, pose.velocity_m_s, pose.angular_velocity_rad_s)
    times = np.arange(round(on.duration_s / on.output_dt_s) + 1) * on.output_dt_s
    states = simulate(case, initial_state(*(np.array(part) for part in parts)), times).states
    return Rotation.from_quat(states[:, [7, 8, 9, 6]])


@pytest.mark.parametrize(
    ("name", "limit"), [("pybullet", budget.TUMBLE_RAD), ("pybullet:plain", budget.TUMBLE_PLAIN_RAD)]
)
def test_a_block_that_lands_on_vertex_after_vertex_follows_the_reference(name: str, limit: float) -> None:
    """Four impacts, each on another vertex or edge, off the plane."""
    turn = np.array([math.sqrt(1.0 - 0.03**2 - 0.02**2 - 0.0346**2), 0.03, 0.02, 0.0346])
    pose = Pose((0.0, 0.0, 0.75), tuple(turn), angular_velocity_rad_s=(0.3, 0.2, 0.5))
    on = thrown(pose, 0.8)
    assert np.max((turned(run(name, on, 2.5e-4)) * exact(on).inv()).magnitude()) < limit


@pytest.mark.parametrize("name", POSED)
def test_a_dropped_block_lands_when_it_must_and_stays(name: str) -> None:
    on = thrown(Pose((0.0, 0.0, 0.7)), 0.5)
    found = run(name, on, 2.5e-4)
    height = found.history.extra["corner_right_z_m"]
    times = found.history.t_s
    falling = times < math.sqrt(2.0 * 0.1 / GRAVITY_M_S2)
    # Symplectic steps fall g t dt/2 further than g t²/2.
    late = 0.5 * GRAVITY_M_S2 * times[falling] * 2.5e-4 + budget.INTEGRATED
    assert np.all(np.abs(height[falling] - (0.1 - 0.5 * GRAVITY_M_S2 * times[falling] ** 2)) <= late)
    assert height[-1] == pytest.approx(0.0, abs=budget.SLOP_M)
    assert turned(found)[-1].magnitude() < budget.SLOP_RAD


def test_a_block_dropped_flat_bounces_by_its_coefficient_of_restitution() -> None:
    """To e² of its height, exactly in `spatial`; pybullet, which locates plastic impacts, refuses."""
    on = replace(thrown(Pose((0.0, 0.0, 0.7)), 0.3), contact=Contact(0.2, 0.15, 1.0, 0.5))
    found = run("pybullet:plain", on, 2.5e-4)
    height = found.history.extra["corner_right_z_m"]
    after = found.history.t_s > math.sqrt(2.0 * 0.1 / GRAVITY_M_S2) + 0.02
    assert np.max(height[after]) == pytest.approx(0.25 * 0.1, rel=budget.BOUNCE_RELATIVE)
    exactly = run("spatial", replace(on, output_dt_s=1e-4), 0.01)
    after = exactly.history.t_s > math.sqrt(2.0 * 0.1 / GRAVITY_M_S2)
    top = np.max(exactly.history.extra["corner_right_z_m"][after])
    # A sample at most half an output step from the top is lower by g dt²/8.
    assert top == pytest.approx(0.25 * 0.1, abs=GRAVITY_M_S2 * 1e-8 / 8.0)
    refused = run("pybullet", on, 2.5e-4)
    assert "pybullet:plain" in refused.message


def test_a_square_thrown_in_the_plane_lands_as_the_exact_body_does() -> None:
    """Plastic with impacts located; as it comes Chipmunk bounces by its coefficient, which `pymunk` refuses."""
    turn, block = 0.7, rectangle(0.06, 0.06, depth_m=0.06)
    pose = Pose(
        (0.0, 0.0, 0.15), (math.cos(turn / 2), 0.0, math.sin(turn / 2), 0.0), (-0.6, 0.0, -1.7), (0.0, 5.0, 0.0)
    )
    on = replace(scene(block, duration_s=0.15), initial=Initial(pose=pose), contact=Contact(0.2, 0.2, 0.6))
    exactly, located = (run(name, on, 2.5e-4).history for name in ("spatial", "pymunk"))
    assert np.ptp(exactly.theta_rad) > 0.2
    at = np.interp(exactly.t_s, located.t_s, located.theta_rad)
    assert np.max(np.abs(at - exactly.theta_rad)) < budget.PLANE_LANDING_RAD
    bouncing = replace(on, contact=Contact(0.2, 0.2, 0.6, 0.5))
    assert "pymunk:plain" in run("pymunk", bouncing, 2.5e-4).message
    exactly, plain = (run(name, bouncing, 1e-4).history for name in ("spatial", "pymunk:plain"))
    at = np.interp(exactly.t_s, plain.t_s, plain.theta_rad)
    assert np.max(np.abs(at - exactly.theta_rad)) < budget.PLANE_BOUNCING_RAD


@pytest.mark.parametrize("name", POSED)
def test_a_body_that_begins_on_its_side_runs_to_the_end(name: str) -> None:
    on = thrown(Pose((0.0, 0.0, 0.5), (math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0)), 0.4)
    found = run(name, on, 1e-3)
    assert found.end_s == on.duration_s
    assert found.history.t_s.size == 41


@pytest.mark.parametrize("name", POSED)
def test_a_mirrored_start_gives_the_mirrored_history(name: str) -> None:
    """Across the rocking plane: y and the rotations about x and z change their sign."""
    turn = Rotation.from_euler("xyz", [0.1, -0.05, 0.3])
    x, y, z, w = turn.as_quat()
    pose = Pose((0.0, 0.0, 0.8), (w, x, y, z), (0.1, 0.2, 0.0), (0.3, 0.2, 0.5))
    mirrored = Pose((0.0, 0.0, 0.8), (w, -x, y, -z), (0.1, -0.2, 0.0), (-0.3, 0.2, -0.5))
    one, other = (turned(run(name, thrown(each, 0.4), 5e-4)) for each in (pose, mirrored))
    reflected = Rotation.from_quat(other.as_quat() * np.array([-1.0, 1.0, -1.0, 1.0]))
    assert np.max((one * reflected.inv()).magnitude()) < budget.MIRRORED_RAD


def test_a_start_is_perturbed_by_its_velocities() -> None:
    pose = Pose((0.0, 0.0, 0.8), angular_velocity_rad_s=(1.0, 0.0, 0.0))
    start = Initial(pose=pose)
    assert not start.still
    assert start.plus(0.0, 0.5) == Initial(pose=replace(pose, angular_velocity_rad_s=(1.0, 0.5, 0.0)))
    assert pose.faster(2.0).angular_velocity_rad_s == (2.0, 0.0, 0.0)


def test_no_probability_is_stated_by_a_model_that_does_not_see_the_pose() -> None:
    unknown = (Uncertain("statue.mass_kg", "lognormal", 1000.0, 0.1),)
    on = replace(thrown(Pose((0.0, 0.0, 0.8)), 0.1), uncertainty=unknown)
    assert assess_models(on, draws=10) == {}
    with pytest.raises(InputError, match=r"^the scene: initial\.position_m: "):
        assess(on, draws=10)


@pytest.mark.parametrize("friction", [1.0, 0.18])
def test_one_impact_of_a_cube_is_the_reference(root: Path, friction: float) -> None:
    """At 1.0 the vertex sticks for 0.06 s; at 0.18 it slides on, along one of Bullet's axes."""
    cube = load_scene(root / "scenes" / "cube_toss.toml")
    w, x, y, z = (np.array([0.4, 0.5, 0.3, 0.7]) / math.sqrt(0.99)).tolist()
    pose = Pose((0.0, 0.0, 0.15), (w, x, y, z), (-1.0, 0.5, 0.0), (-3.0, -1.0, 4.0))
    contact = replace(cube.contact, statue=friction)
    on = replace(cube, contact=contact, initial=Initial(pose=pose), duration_s=LANDED_S, output_dt_s=0.01)
    wanted, found = exact(on), turned(run("pybullet", on, 1.25e-4))
    assert np.max((found * wanted.inv()).magnitude()) < budget.ONE_IMPACT_RAD


@pytest.mark.parametrize("friction", [1.0, 0.18])
def test_the_exact_body_thrown_follows_the_reference(root: Path, friction: float) -> None:
    """A cube lands on one of its eight corners; and may turn over any angle."""
    cube = load_scene(root / "scenes" / "cube_toss.toml")
    w, x, y, z = (np.array([0.4, 0.5, 0.3, 0.7]) / math.sqrt(0.99)).tolist()
    pose = Pose((0.0, 0.0, 0.15), (w, x, y, z), (-1.0, 0.5, 0.0), (-3.0, -1.0, 4.0))
    contact = replace(cube.contact, statue=friction)
    on = replace(cube, contact=contact, initial=Initial(pose=pose), duration_s=LANDED_S, output_dt_s=0.01)
    found = turned(run("spatial", on, 0.01))
    assert np.max((found * exact(on).inv()).magnitude()) < budget.TWO_SOLVERS_RAD


def test_a_thrown_body_runs_by_default_with_engines_that_take_it(root: Path) -> None:
    cube = load_scene(root / "scenes" / "cube_toss.toml")
    bouncing = replace(cube, contact=replace(cube.contact, restitution=0.1))
    for on in (cube, bouncing):
        for name in engines.default_engines(on):
            engine = engines.load(name)
            short = replace(on, duration_s=0.05)
            assert engine.missing() or engine.simulate(short, engine.settings_for_dt(short, 1e-3), RunOptions()).history
    standing = replace(cube, initial=Initial())
    assert engines.default_engines(standing) == engines.DEFAULT_ENGINES
    across = replace(standing, base_excitation=BaseExcitation(y=Harmonic(1.0, 2.0)))
    assert engines.default_engines(across) == (*engines.DEFAULT_ENGINES, "spatial")
