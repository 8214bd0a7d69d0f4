"""Out of the plane: the same rotation at any azimuth, and where oblique shaking leaves its plane."""

from dataclasses import replace

import numpy as np
import pytest

import harness
from analytic.excitation import Pulse, SampledAcceleration
from harness.engines import load
from harness.model import Array, BaseExcitation, RunOptions, Scene
from harness.questions.effects3d import changed_scene, departure, with_solid
from harness.records.effects3d import BASELINE
from tests.budgets_meshes import SAME_PLANE_RAD

needs_pybullet = pytest.mark.skipif(load("pybullet").missing() is not None, reason=str(load("pybullet").missing()))


def tilt_along(theta_rad: Array, out_of_plane_rad: Array, direction_deg: float) -> Array:
    """Rotation (n,) towards a horizontal direction of the table, from the planar rotation and the tilt out of the x-z plane."""
    up_x, up_y = np.cos(out_of_plane_rad) * np.sin(theta_rad), np.sin(out_of_plane_rad)
    up_z = np.cos(out_of_plane_rad) * np.cos(theta_rad)
    angle = np.deg2rad(direction_deg)
    return np.asarray(np.arctan2(np.cos(angle) * up_x + np.sin(angle) * up_y, up_z))


def test_tilt_along_is_the_rotation_in_its_own_plane() -> None:
    tilt = np.linspace(-0.6, 0.6, 13)
    for direction in (0.0, 37.0, 90.0):
        angle = np.deg2rad(direction)
        up = np.column_stack([np.sin(tilt) * np.cos(angle), np.sin(tilt) * np.sin(angle), np.cos(tilt)])
        theta, across = np.arctan2(up[:, 0], up[:, 2]), np.arcsin(up[:, 1])
        np.testing.assert_allclose(tilt_along(theta, across, direction), tilt, atol=1e-12)


@needs_pybullet
def test_the_same_plane_at_any_azimuth(block: Scene) -> None:
    """The block and its shaking turned together: the rotation in the plane of shaking is that of azimuth 0."""
    solid = block.statue.solid
    amplitude = 0.3 * 9.81
    histories = []
    for direction in (0.0, 37.0, 90.0):
        angle = np.deg2rad(direction)
        base_excitation = BaseExcitation(
            x=Pulse("one_sine", amplitude * float(np.cos(angle)), 0.5),
            y=Pulse("one_sine", amplitude * float(np.sin(angle)), 0.5),
        )
        run = harness.simulate(
            replace(with_solid(block, solid.rotated(direction)), base_excitation=base_excitation, duration_s=1.0),
            "pybullet",
            dt_s=2.5e-4,
        )
        histories.append(tilt_along(run.history.theta_rad, run.history.extra["out_of_plane_rad"], direction))
    assert np.abs(histories[0]).max() > 0.02
    for other in histories[1:]:
        assert np.abs(other - histories[0]).max() < SAME_PLANE_RAD


@needs_pybullet
def test_the_quiet_start_of_oblique_shaking_ends_where_the_base_is_left(scene: Scene) -> None:
    """Under a rising push at 45° the statue lifts at 0.125 g, where it leaves the base, its planar section only at 0.39 g."""
    from harness.engines.pybullet import run_phases
    from harness.engines.pybullet import statue as body

    t_s = np.linspace(0.0, 2.0, 201)
    push = BaseExcitation(x=SampledAcceleration(t_s, -0.4 * 9.81 * t_s / 2.0))
    straight, oblique = (
        replace(
            changed_scene(scene, BASELINE, azimuth), base_excitation=push, contact=replace(scene.contact, statue=1.0)
        )
        for azimuth in (0.0, 45.0)
    )
    assert run_phases.quiet_start_s(straight, body.prepare(straight)) == pytest.approx(2.0 * 0.0881 / 0.4, abs=0.01)
    assert run_phases.quiet_start_s(oblique, body.prepare(oblique)) == pytest.approx(2.0 * 0.1246 / 0.4, abs=0.01)
    moved = harness.simulate(
        replace(oblique, duration_s=1.0), "pybullet", dt_s=1e-3, options=RunOptions(skips=frozenset())
    )
    first = moved.history.t_s[
        np.argmax(np.hypot(moved.history.theta_rad, moved.history.extra["out_of_plane_rad"]) > 1e-5)
    ]
    assert 0.0 < first - 2.0 * 0.1246 / 0.4 < 0.05


@needs_pybullet
def test_oblique_shaking_leaves_the_plane_on_one_corner(scene: Scene) -> None:
    """Shaken at 110° the statue turns about a corner and yaws; along its own axis of symmetry it does neither."""
    straight, oblique = (departure(scene, azimuth, "pybullet", 0.22, 1e-3) for azimuth in (0.0, 30.0))
    assert straight.out_of_plane_rad < 1e-3
    assert straight.corner_share == 0.0
    assert oblique.out_of_plane_rad > 10.0 * straight.out_of_plane_rad
    turning = departure(scene, 110.0, "pybullet", 0.8, 1e-3)
    assert turning.corner_share > 0.2
    assert turning.yaw_rad > 0.02
