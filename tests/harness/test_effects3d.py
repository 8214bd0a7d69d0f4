"""The third dimension: directions, what each condition changes, and the same plane found at any azimuth."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import harness
from analytic.excitation import Pulse
from harness.effects3d import (
    CONDITIONS,
    Search,
    amplified,
    changed_scene,
    departure,
    overturning,
    rose,
    tilt_along,
    turned,
    with_solid,
)
from harness.engines import load
from harness.errors import InputError
from harness.scene import Scene, Shake
from meshes import footprint, solid_from_mesh
from tests.budgets_meshes import SAME_PLANE_RAD
from tests.meshes.shapes import box

SEARCH = Search(least=0.4, most=1.6, step=1.25, resolution=0.05, dt_s=1e-3)


@pytest.fixture(scope="module")
def scene(root: Path) -> Scene:
    return harness.load_scene(root / "scenes" / "3d_effects_base.toml")


@pytest.fixture(scope="module")
def block(scene: Scene) -> Scene:
    """The scene with a plain block in place of the statue."""
    vertices, faces = box(0.3, 0.4, 1.2)
    return with_solid(scene, solid_from_mesh(vertices, faces, density_kg_m3=2700.0))


@pytest.mark.parametrize("azimuth", [0.0, 37.0, 180.0])
def test_turned_towards_an_azimuth_shows_its_corners(scene: Scene, azimuth: float) -> None:
    statue = scene.statue
    assert statue.solid is not None
    expected = footprint.planar(statue.solid.footprint_m, statue.centroid_height_m, statue.solid.inertia_kg_m2, azimuth)
    found = turned(scene, azimuth).statue
    assert found.corner_right_m == pytest.approx(expected.corner_right_m, rel=1e-9)
    assert found.corner_left_m == pytest.approx(expected.corner_left_m, rel=1e-9)
    assert found.inertia_kg_m2 == pytest.approx(expected.inertia_kg_m2, rel=1e-9)


def test_every_condition_changes_one_thing(scene: Scene) -> None:
    before = scene.statue
    rel = {
        "centroid 3 % higher": ("centroid_height_m", 1.03),
        "base 3 % narrower": ("corner_right_m", 0.97),
        "inertia 3 % larger": ("inertia_kg_m2", 1.03),
    }
    for name in CONDITIONS:
        after = changed_scene(scene, name, 0.0)
        for attribute in ("mass_kg", "centroid_height_m", "corner_right_m", "inertia_kg_m2"):
            factor = rel.get(name, ("", 1.0))[1] if rel.get(name, ("", 1.0))[0] == attribute else None
            if factor is not None:
                assert getattr(after.statue, attribute) == pytest.approx(factor * getattr(before, attribute), rel=1e-9)
            elif not any(word in name for word in attribute.split("_")) and "base" not in name:
                assert getattr(after.statue, attribute) == pytest.approx(getattr(before, attribute), rel=1e-9), name


def test_flat_base_and_no_products(scene: Scene) -> None:
    solid = scene.statue.solid
    assert solid is not None
    flat = changed_scene(scene, "flat base", 0.0).statue.solid
    plain = changed_scene(scene, "no products of inertia", 0.0).statue.solid
    assert flat is not None
    assert plain is not None
    assert np.ptp(flat.feet_m[:, 2]) == 0.0
    assert np.count_nonzero(plain.inertia_kg_m2) == 3
    assert np.count_nonzero(solid.inertia_kg_m2) == 9


def test_tilt_along_is_the_rotation_in_its_own_plane() -> None:
    tilt = np.linspace(-0.6, 0.6, 13)
    for direction in (0.0, 37.0, 90.0):
        angle = np.deg2rad(direction)
        up = np.column_stack([np.sin(tilt) * np.cos(angle), np.sin(tilt) * np.sin(angle), np.cos(tilt)])
        theta, across = np.arctan2(up[:, 0], up[:, 2]), np.arcsin(up[:, 1])
        np.testing.assert_allclose(tilt_along(theta, across, direction), tilt, atol=1e-12)


def test_overturning_is_bracketed(block: Scene) -> None:
    factor, below, outcome, runs = overturning(block, "analytic", SEARCH)
    assert factor is not None
    assert below < factor <= below * (1.0 + SEARCH.resolution) * 1.0001
    assert outcome.startswith("overturned")
    assert runs <= 12
    assert harness.simulate(amplified(block, factor), "analytic").outcome.value == outcome
    assert harness.simulate(amplified(block, below), "analytic").outcome.value == "stands"


def test_a_symmetric_block_has_a_symmetric_rose(block: Scene) -> None:
    rows = rose(block, [0.0, 180.0], ["analytic"], SEARCH)
    assert rows[0].factor == rows[1].factor


def test_mistakes(scene: Scene, root: Path) -> None:
    with pytest.raises(InputError, match="one of as scanned"):
        rose(scene, [0.0], ["analytic"], SEARCH, conditions=["as dreamt"])
    numbers = harness.load_scene(root / "scenes" / "free_rocking.toml")
    if numbers.statue.solid is None:
        with pytest.raises(InputError, match="numbers alone"):
            turned(numbers, 10.0)


@pytest.mark.skipif(load("pybullet").missing() is not None, reason=str(load("pybullet").missing()))
def test_the_same_plane_at_any_azimuth(block: Scene) -> None:
    """The block and its shaking turned together: the rotation in the plane of shaking is that of azimuth 0."""
    solid = block.statue.solid
    assert solid is not None
    amplitude = 0.3 * 9.81
    histories = []
    for direction in (0.0, 37.0, 90.0):
        angle = np.deg2rad(direction)
        shake = Shake(
            x=Pulse("one_sine", amplitude * float(np.cos(angle)), 0.5),
            y=Pulse("one_sine", amplitude * float(np.sin(angle)), 0.5),
        )
        run = harness.simulate(
            with_solid(block, solid.rotated(direction)).but(shake=shake, duration_s=1.0), "pybullet", dt_s=2.5e-4
        )
        assert run.history is not None
        histories.append(tilt_along(run.history.theta_rad, run.history.extra["out_of_plane_rad"], direction))
    assert np.abs(histories[0]).max() > 0.02
    for other in histories[1:]:
        assert np.abs(other - histories[0]).max() < SAME_PLANE_RAD


@pytest.mark.skipif(load("pybullet").missing() is not None, reason=str(load("pybullet").missing()))
def test_oblique_shaking_leaves_the_plane(scene: Scene) -> None:
    """Shaken at 45° the statue's corner carries it out of the plane; along its own axis of symmetry it stays there."""
    straight, oblique = (departure(scene, azimuth, 0.7, SEARCH) for azimuth in (0.0, 45.0))
    assert straight.out_of_plane_rad < 1e-3
    assert oblique.out_of_plane_rad > 10.0 * straight.out_of_plane_rad
