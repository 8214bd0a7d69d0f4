"""pybullet's bodies: the mesh's own vertices and inertia, edges, rolling in three dimensions, nothing left over between runs."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from analytic.closed_form import rolling_cylinder
from harness import Outcome
from harness.engines import load
from harness.engines.pybullet import run_phases
from harness.engines.pybullet import statue as body
from harness.engines.pybullet.statue import EdgeWatch
from harness.engines.stepping.trajectory import matrices
from harness.input.mesh_statue import statue_of
from harness.model import Statue
from meshes.solid import Solid, solid_from_mesh
from tests import budgets_engines as budget
from tests import doubles
from tests.engines_for_tests import NOTHING_SKIPPED, apart, bullet
from tests.meshes import togatus
from tests.scenes_for_tests import GRAVITY_M_S2, PAESTUM, paestum, scene


@cache
def figure() -> Solid:
    return togatus.build()


def prism(sides: int, radius_m: float, half_height_m: float) -> Solid:
    """A round column as a prism, 100 kg."""
    from trimesh.creation import cylinder

    mesh = cylinder(radius=radius_m, height=2.0 * half_height_m, sections=sides)
    vertices = np.array(mesh.vertices) + np.array([0.0, 0.0, half_height_m])
    return solid_from_mesh(vertices, np.array(mesh.faces), mass_kg=100.0)


def raised(solid: Solid, height_m: float) -> Statue:
    """The solid with the front right vertex of its base raised, everything else kept."""
    vertices = solid.vertices_m.copy()
    vertices[np.argmax(vertices[:, 0] - vertices[:, 1] - 1e3 * vertices[:, 2]), 2] += height_m
    return statue_of(replace(solid, vertices_m=vertices))


def test_feet_are_the_meshes_own_base_vertices() -> None:
    found = body.touchable(statue_of(figure()), 0.5)
    for corner in figure().footprint_m:
        assert np.min(np.linalg.norm(found - corner, axis=1)) == 0.0
    assert np.all(found[:, 2] == 0.0)
    # Every direction of a fall has the hull's own support point among the vertices kept for it.
    every = body.touchable(statue_of(figure()))
    hull = body.hull_vertices(statue_of(figure()))
    generator = np.random.default_rng(1)
    lean, azimuth = generator.uniform(0.0, 1.5, 500), generator.uniform(0.0, 2.0 * math.pi, 500)
    down = np.column_stack([np.sin(lean) * np.cos(azimuth), np.sin(lean) * np.sin(azimuth), -np.cos(lean)])
    assert np.max(np.abs((every @ down.T).max(axis=0) - (hull @ down.T).max(axis=0))) == 0.0
    assert np.max((found @ down.T).max(axis=0) - (hull @ down.T).max(axis=0)) < 0.0 or len(found) < len(every)


def test_a_raised_vertex_changes_the_history() -> None:
    case = paestum(0.429, 3.0, pedestal=False, duration_s=0.6)
    whole = bullet(replace(case, statue=statue_of(figure())), 5e-4)
    same = bullet(replace(case, statue=raised(figure(), 0.0)), 5e-4)
    bent = bullet(replace(case, statue=raised(figure(), 2e-3)), 5e-4)
    assert apart(whole, same) == 0.0
    assert apart(whole, bent) > budget.RAISED_RAD
    assert bent.validity["out_of_plane_rad"] > 10.0 * whole.validity["out_of_plane_rad"]


def test_inertia_is_the_meshes_not_bullets() -> None:
    import pybullet

    from harness.engines.pybullet.world import World

    case = replace(paestum(pedestal=False), statue=statue_of(figure()))
    setup = body.prepare(case)
    tensor = setup.axes @ np.diag(setup.moments) @ setup.axes.T
    np.testing.assert_allclose(tensor, figure().inertia_kg_m2, rtol=1e-12, atol=1e-9)
    level = load("pybullet").settings_for_dt(case, 1e-3)
    with World(level, setup) as world:  # type: ignore[arg-type]
        world.build(case)
        info = pybullet.getDynamicsInfo(world.statue, -1, world.client)
        assert len(pybullet.getCollisionShapeData(world.statue, -1, world.client)) == len(setup.feet_m) > 16
    assert info[0] == pytest.approx(case.statue.mass_kg, rel=1e-15)
    np.testing.assert_allclose(info[2], setup.moments, rtol=1e-15)


def test_a_compound_too_large_for_one_call_is_refused() -> None:
    from harness.engines.base import EngineFailure

    with pytest.raises(EngineFailure, match="17 spheres"):
        body.compound(np.zeros((17, 3)), 1e-5, 0)


def test_a_bent_base_starts_on_the_face_that_carries_it() -> None:
    vertices = figure().vertices_m.copy()
    base = vertices[:, 2] == 0.0
    vertices[base & (vertices[:, 0] > 0.0), 2] += 2e-3
    statue = statue_of(replace(figure(), vertices_m=vertices))
    rest = body.rest_of(statue)
    # It stands on the raised right edge and on the last row of base vertices left of the centroid.
    lean = 2e-3 / (statue.corner_right_m - np.max(vertices[base & (vertices[:, 0] <= 0.0), 0]))
    assert rest.stable
    assert rest.lean_rad == pytest.approx(math.atan(lean), rel=1e-6)
    still = bullet(scene(statue, duration_s=0.2), 1e-3, NOTHING_SKIPPED)
    np.testing.assert_allclose(still.history.theta_rad, math.atan(lean), atol=budget.PLANAR_RAD)
    assert "base_not_flat" in doubles.codes(still.findings)
    # A rotation that is given is from upright, as every other model takes it.
    given = bullet(scene(statue, theta_rad=0.02, duration_s=0.01), 1e-3, NOTHING_SKIPPED)
    assert given.history.theta_rad[0] == pytest.approx(0.02, abs=1e-12)


def test_rolling_on_the_rim() -> None:
    radius, half, tilt = 0.3, 0.1, 0.3
    solid = prism(256, radius, half)
    closed = rolling_cylinder(radius, half, tilt, gravity_m_s2=GRAVITY_M_S2)
    case = scene(statue_of(solid), duration_s=0.5)
    setup = body.prepare(case)
    turned = body.about_y(tilt)
    lowest = float(np.min((setup.feet_m @ setup.axes.T @ turned.T)[:, 2]))
    spin = turned @ np.array([-closed.precession_rad_s * math.sin(tilt), 0.0, closed.axial_rad_s])
    start = (0.0, 0.0, -lowest, *body.quaternion(turned @ setup.axes), 0.0, 0.0, 0.0, *spin.tolist())
    level = load("pybullet").settings_for_dt(case, 2.5e-4)
    found = run_phases.run(case, level, replace(setup, start=start), NOTHING_SKIPPED, level)  # type: ignore[arg-type]
    up = (matrices(found.record.rows[:, 3:7]) @ setup.axes.T)[:, :, 2]
    azimuth = np.unwrap(np.arctan2(up[:, 1], up[:, 0]))
    rate = (azimuth[-1] - azimuth[0]) / found.record.t_s[-1]
    assert rate == pytest.approx(closed.precession_rad_s, rel=budget.PRECESSION_REL)
    assert math.acos(up[-1, 2]) == pytest.approx(tilt, rel=budget.TILT_REL)


def test_the_edge_is_watched() -> None:
    block = PAESTUM
    corners = body.hull_vertices(block) - np.array([0.0, 0.0, block.centroid_height_m])
    watch = EdgeWatch(corners, (0.30, 0.40, 0.10))
    level = (0.0, 0.0, 0.0, 1.0)
    pedestal = (block.base_centre_m, 0.0, 0.1, *level)

    def row(x: float, z: float, turn: tuple[float, ...] = level) -> tuple[float, ...]:
        return (x, 0.0, z, *turn, *(0.0,) * 6, *pedestal, *(0.0,) * 6)

    standing = 0.2 + block.centroid_height_m
    assert not watch(row(0.0, standing))
    assert not watch(row(0.08, standing))
    assert watch(row(0.09, standing)), "a foot beside the top"
    assert watch(row(0.0, standing - 2e-4)), "a vertex below the top"
    assert not watch(row(0.09, standing + 2e-4)), "above the top beside it"
    ahead = EdgeWatch(corners, (0.30, 0.40, 0.10), ahead_s=0.02, pull_m_s2=GRAVITY_M_S2)
    falling = (*row(0.09, standing + 0.02)[:7], 0.0, 0.0, -1.0, *(0.0,) * 3, *pedestal, *(0.0,) * 6)
    assert ahead(falling), "coming down beside the top before the next look"
    assert not watch(falling)
    assert not ahead(row(0.09, standing + 0.02)), "hanging there"
    assert not ahead(row(0.0, standing)), "standing"
    sliding = (*row(0.08, standing)[:7], 1.0, *(0.0,) * 5, *pedestal, *(0.0,) * 6)
    assert ahead(sliding), "a foot that slides over the edge before the next look"


def test_feet_alone_and_the_full_shape_agree_until_the_edge_is_reached() -> None:
    case = replace(paestum(0.429, 1.5, mu=0.8, duration_s=2.0), statue=statue_of(figure()))
    short, full = bullet(case, 5e-4), bullet(case, 5e-4, NOTHING_SKIPPED)
    assert short.outcome is full.outcome is Outcome.OVERTURNED_RIGHT
    changed = short.validity["full_shape_from_s"]
    assert full.validity["full_shape_from_s"] == 0.0
    assert 1.0 < changed < short.end_s
    assert apart(short, full, until_s=changed) <= budget.MERGED_RAD


def test_the_order_of_bodies_changes_the_iterations_not_the_solution() -> None:
    case = paestum(0.429, 3.0, duration_s=0.4)
    solved = {"residual": 0.0, "iterations": 1000}
    assert apart(bullet(case, 1e-3), bullet(case, 1e-3, reversed_bodies=True)) > 0.0
    one, other = bullet(case, 1e-3, **solved), bullet(case, 1e-3, reversed_bodies=True, **solved)
    assert apart(one, other) <= budget.SOLVED_RAD


def test_verification_runs_are_finer_and_solved_more_tightly() -> None:
    case = paestum(0.429, 3.0)
    engine = load("pybullet")
    for level in engine.refinement_levels(case):
        for verification in engine.verification_settings(case, level):
            assert verification.dt_s < 0.5 * level.dt_s
            assert verification.as_dict()["residual"] <= level.as_dict()["residual"]
            assert verification.as_dict()["iterations"] > level.as_dict()["iterations"]
            solved = level.as_dict()["residual"] == 0.0
            assert (verification.as_dict()["reversed_bodies"] != level.as_dict()["reversed_bodies"]) == solved


def test_masses_all_changed_in_proportion_change_no_motion() -> None:
    """The solver's threshold is one of velocities, not of impulses: powers of two change no bit."""
    case = paestum(0.429, 3.0, duration_s=0.4)
    statue, pedestal = case.statue, case.pedestal
    light = replace(
        case,
        statue=replace(
            statue,
            mass_kg=statue.mass_kg / 16.0,
            inertia_kg_m2=statue.inertia_kg_m2 / 16.0,
            inertia_tensor_kg_m2=statue.inertia_tensor_kg_m2 / 16.0,
        ),
        pedestal=replace(pedestal, mass_kg=pedestal.mass_kg / 16.0),
    )
    assert apart(bullet(case, 1e-3), bullet(light, 1e-3)) == 0.0
