"""What each condition changes, and what an azimuth turns."""

import numpy as np
import pytest

from harness.model import Scene
from harness.questions.effects3d import CONDITIONS, changed_scene, turned
from harness.records.effects3d import BASELINE
from meshes import footprint


@pytest.mark.parametrize("azimuth", [0.0, 37.0, 180.0])
def test_turned_towards_an_azimuth_shows_its_corners(scene: Scene, azimuth: float) -> None:
    statue = scene.statue
    right, left = footprint.corner_m(statue.solid.footprint_m, [azimuth, azimuth + 180.0])
    across = [-np.sin(np.deg2rad(azimuth)), np.cos(np.deg2rad(azimuth)), 0.0]
    found = turned(scene, azimuth).statue
    assert found.corner_right_m == pytest.approx(right, rel=1e-9)
    assert found.corner_left_m == pytest.approx(left, rel=1e-9)
    assert found.inertia_kg_m2 == pytest.approx(across @ statue.solid.inertia_kg_m2 @ across, rel=1e-9)


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
    peaks = {name: tuple(_peaks(changed_scene(scene, name, 0.0))) for name in CONDITIONS}
    assert peaks.pop("with the vertical component") == pytest.approx((0.3, 0.0, 0.27))
    assert peaks.pop("with the second horizontal component") == pytest.approx((0.3, 0.09, 0.0))
    assert peaks.pop("with all three components") == pytest.approx((0.3, 0.09, 0.27))
    assert set(peaks.values()) == {peaks[BASELINE]}
    assert peaks[BASELINE] == pytest.approx((0.3, 0.0, 0.0))


def _peaks(scene: Scene) -> list[float]:
    base_excitation = scene.base_excitation
    return [item.peak_m_s2 / scene.gravity_m_s2 for item in (base_excitation.x, base_excitation.y, base_excitation.z)]


def test_ragged_base_and_no_products(scene: Scene) -> None:
    solid = scene.statue.solid
    rough = changed_scene(scene, "base ragged by 1 mm", 0.0).statue
    plain = changed_scene(scene, "products of inertia left out", 0.0).statue.solid
    assert 0.0 < np.ptp(rough.solid.feet_m[:, 2]) <= 1e-3
    assert len(rough.solid.feet_m) > len(solid.feet_m)
    assert rough.inertia_kg_m2 == scene.statue.inertia_kg_m2
    assert np.count_nonzero(plain.inertia_kg_m2) == 3
    assert np.count_nonzero(solid.inertia_kg_m2) == 9
