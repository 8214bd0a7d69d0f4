"""Hollow and cored statues against closed forms, and a survey set against the mesh."""

import numpy as np
import pytest

from meshes import MeshError, Solid
from meshes.survey import adjusted, agrees, with_core, with_mass
from tests.budgets_meshes import ROUND_OFF_REL
from tests.meshes.shapes import box


def test_hollow_block_is_the_difference_of_two_boxes(block: Solid) -> None:
    hollow = with_core(block, *box(0.2, 0.3, 1.0, (-0.1, -0.15, 0.1)))
    outer_mass, inner_mass = 2700.0 * 0.42, 2700.0 * 0.06
    mass = outer_mass - inner_mass
    height = (outer_mass * 0.75 - inner_mass * 0.6) / mass
    expected = (
        outer_mass * (0.4**2 + 1.5**2) / 12.0
        + outer_mass * (0.75 - height) ** 2
        - inner_mass * (0.2**2 + 1.0**2) / 12.0
        - inner_mass * (0.6 - height) ** 2
    )
    assert hollow.mass_kg == pytest.approx(mass, rel=ROUND_OFF_REL)
    assert hollow.centroid_height_m == pytest.approx(height, rel=ROUND_OFF_REL)
    assert hollow.inertia_planar_kg_m2 == pytest.approx(expected, rel=ROUND_OFF_REL)


def test_an_off_centre_core_moves_the_frame_and_keeps_the_base(block: Solid) -> None:
    cored = with_core(block, *box(0.1, 0.3, 1.0, (0.05, -0.15, 0.1)), core_density_kg_m3=7850.0)
    shift = 5150.0 * 0.03 * 0.1 / cored.mass_kg
    assert cored.corner_right_m == pytest.approx(0.2 - shift, rel=ROUND_OFF_REL)
    assert cored.corner_left_m == pytest.approx(0.2 + shift, rel=ROUND_OFF_REL)
    assert cored.corner_left_m + cored.corner_right_m == pytest.approx(0.4, rel=ROUND_OFF_REL)


def test_an_impossible_tensor_is_refused(block: Solid) -> None:
    with pytest.raises(MeshError, match=r"800 kg .*\[1\. 1\. 5\.\]"):
        with_mass(block, 800.0, np.array([0.0, 0.0, 0.75]), np.diag([1.0, 1.0, 5.0]))
    with pytest.raises(MeshError, match="above the base"):
        with_mass(block, 800.0, np.array([0.3, 0.0, 0.75]), block.inertia_kg_m2)


def test_a_survey_is_set_against_the_mesh(statue: Solid) -> None:
    assert agrees(707.0, statue.mass_kg)
    assert not agrees(0.72 * 1.02, statue.depth_m)


def test_adjusted_changes_what_is_asked_and_keeps_the_mass(statue: Solid) -> None:
    found = adjusted(statue, centroid_rel=0.03, base_rel=-0.02, inertia_rel=0.05)
    assert found.mass_kg == statue.mass_kg
    assert found.centroid_height_m == pytest.approx(1.03 * statue.centroid_height_m, rel=ROUND_OFF_REL)
    assert found.corner_right_m == pytest.approx(0.98 * statue.corner_right_m, rel=ROUND_OFF_REL)
    assert found.corner_left_m == pytest.approx(0.98 * statue.corner_left_m, rel=ROUND_OFF_REL)
    assert found.inertia_planar_kg_m2 == pytest.approx(1.05 * statue.inertia_planar_kg_m2, rel=ROUND_OFF_REL)
    np.testing.assert_array_equal(adjusted(statue).vertices_m, statue.vertices_m)
    with pytest.raises(MeshError, match="shares above -1"):
        adjusted(statue, base_rel=-1.0)
