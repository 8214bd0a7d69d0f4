"""The planar pose of pictures and replay is the model's."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Literal

import numpy as np
import pytest

from harness.model import SOLID_COLUMNS, History, Pedestal, Wall
from harness.records.scene import SceneRecord
from reports.drawing.kinematics import in_sight_m, posed_m, posed_pedestal_m, poses, room_m, sampled, top_shift_m
from tests.budgets_reports import POSE_M
from tests.reports.invented_run import block_scene

PAESTUM = SceneRecord.of(block_scene(pedestal=False, wall=False))
OUTLINE = np.insert(np.asarray(PAESTUM.statue.section_m), 1, 0.0, axis=1)


def planar_m(points: Sequence[Sequence[float]], theta: float, slip: float = 0.0) -> np.ndarray[Any, Any]:
    """Points (k, 2) in (x, z) at a rotation and a slip, on the floor."""
    flat = np.insert(np.asarray(points, dtype=np.float64), 1, 0.0, axis=1)
    return posed_m(PAESTUM, flat, poses(PAESTUM, {"theta_rad": theta, "slip_m": slip}))[0][:, ::2]


@pytest.mark.parametrize(("theta", "corner"), [(0.3, 0.0682), (-0.3, -0.3585)])
def test_the_pivot_stays_where_it_is(theta: float, corner: float) -> None:
    assert planar_m([[corner, 0.0]], theta)[0] == pytest.approx([corner, 0.0], abs=POSE_M)


def test_positive_rotation_tips_to_the_right() -> None:
    posed = planar_m([[0.0682, 1.0]], 0.1)[0]
    assert posed == pytest.approx([0.0682 + math.sin(0.1), math.cos(0.1)], abs=POSE_M)
    other = planar_m([[-0.3585, 1.0]], -0.1)[0]
    assert other == pytest.approx([-0.3585 - math.sin(0.1), math.cos(0.1)], abs=POSE_M)


def test_nothing_goes_below_the_support() -> None:
    for theta in np.linspace(-1.5, 1.5, 61):
        assert planar_m(OUTLINE[:, ::2], theta)[:, 1].min() >= -POSE_M


def test_slip_moves_everything() -> None:
    still, moved = planar_m(OUTLINE[:, ::2], 0.2), planar_m(OUTLINE[:, ::2], 0.2, 0.03)
    assert np.allclose(moved - still, [0.03, 0.0], atol=POSE_M, rtol=0.0)


def test_the_papers_top_displacement() -> None:
    """0.50 rad to the left displaces a top at 1.46 m by 0.70 m (paper, case study)."""
    pointed = replace(PAESTUM.statue, section_m=[[-0.3585, 0.0], [0.0682, 0.0], [-0.3585, 1.46]])
    scene = replace(PAESTUM, statue=pointed)
    assert abs(top_shift_m(scene, poses(scene, {"theta_rad": -0.5}))[0, 0]) == pytest.approx(0.70, abs=0.005)


def test_what_is_thrown_or_slides_far_is_in_sight_as_what_rocks_is() -> None:
    """Picture and replay of a cube thrown from twice its height began with an empty floor."""
    scene = SceneRecord.of(block_scene())
    high = scene.pedestal.height_m + scene.statue.height_m
    rocking = {"corner_right_x_m": 0.0682, "corner_right_y_m": 0.0, "corner_right_z_m": scene.pedestal.height_m + 0.2}
    for far, wanted in (
        ({}, high),
        ({"corner_right_z_m": 4.0}, 0.7 * high + 3.8),
        ({"corner_right_y_m": -3.0}, 0.7 * high + 3.0),
    ):
        moves = {name: np.array([value]) for name, value in (rocking | far).items()}
        assert in_sight_m(scene, [moves]) == pytest.approx(wanted)


def test_a_lean_across_the_plane_moves_the_top() -> None:
    """Leant across the plane by 0.1 rad the top goes as far as within it; the rotation in the plane tells nothing of that."""
    still, lean = np.zeros(2), np.array([0.0, 0.1])
    across = dict.fromkeys(SOLID_COLUMNS, still) | {"roll_rad": lean, "corner_right_x_m": np.full(2, 0.0682)}
    for columns in (across, {"theta_rad": lean}):
        way_m = np.hypot(*top_shift_m(PAESTUM, poses(PAESTUM, columns)).T)
        assert way_m == pytest.approx([0.0, 1.46 * math.sin(0.1)], abs=2e-3), "about a corner 0.2 m aside"


@pytest.mark.parametrize(("side", "sign"), [("right", 1.0), ("left", -1.0)])
def test_a_walls_distance_is_measured_from_the_bases_edge(side: Literal["right", "left"], sign: float) -> None:
    scene = replace(PAESTUM, wall=Wall(side, 0.9))
    assert room_m(scene, poses(scene, {})) == pytest.approx(0.9, abs=POSE_M)
    moved = {"theta_rad": sign * np.array([0.0, 0.5]), "slip_m": sign * np.array([0.0, 0.01])}
    assert room_m(scene, poses(scene, moved)) == pytest.approx(0.9 - 1.46 * math.sin(0.5) - 0.01, abs=POSE_M)


def test_a_statue_that_turns_comes_nearer_to_the_wall_by_its_front() -> None:
    """Turned by a quarter about its right corner, half its depth stands beyond that."""
    scene = replace(PAESTUM, wall=Wall("right", 0.9))
    turned = dict.fromkeys(SOLID_COLUMNS, 0.0) | {"yaw_rad": 0.5 * math.pi, "corner_right_x_m": 0.0682}
    assert room_m(scene, poses(scene, turned)) == pytest.approx(0.9 - 0.36, abs=POSE_M)


def test_a_planar_pose_in_space_is_the_planar_pose() -> None:
    theta, slip = 0.3, 0.02
    told = dict.fromkeys(SOLID_COLUMNS, 0.0) | {"pitch_rad": theta, "corner_right_x_m": 0.0682 + slip}
    points = np.column_stack([OUTLINE[:, 0], [0.1, 0.2, -0.1, 0.3], OUTLINE[:, 2]])
    (posed,), (flat,) = (
        posed_m(PAESTUM, points, poses(PAESTUM, columns)) for columns in (told, {"theta_rad": theta, "slip_m": slip})
    )
    assert np.allclose(posed, flat, atol=POSE_M, rtol=0.0)
    assert np.array_equal(posed[:, 1], points[:, 1])


def test_yaw_turns_about_the_right_corner() -> None:
    turned = dict.fromkeys(SOLID_COLUMNS, 0.0) | {"yaw_rad": math.pi / 2.0, "corner_right_x_m": 0.0682}
    (posed,) = posed_m(PAESTUM, np.array([[0.0682, 0.0, 0.0], [1.0682, 0.0, 0.5]]), poses(PAESTUM, turned))
    assert np.allclose(posed, [[0.0682, 0.0, 0.0], [0.0682, 1.0, 0.5]], atol=POSE_M, rtol=0.0)


def moving(pedestal: Pedestal | None, **columns: float) -> tuple[SceneRecord, History]:
    """A block's scene, and a history that stands still where those columns say."""
    scene = SceneRecord.of(replace(block_scene(pedestal=False, wall=False), pedestal=pedestal))
    still = {name: np.full(3, value) for name, value in {"theta_rad": 0.0, "slip_m": 0.0, **columns}.items()}
    theta, slip = still.pop("theta_rad"), still.pop("slip_m")
    return scene, History(np.array([0.0, 0.5, 1.0]), theta, np.zeros(3), slip, np.zeros(3), still)


@pytest.mark.parametrize("lean", [0.0, 0.2, -0.15])
@pytest.mark.parametrize("theta", [0.35, -0.3])
def test_the_statue_stands_on_the_top_of_its_pedestal_and_that_on_the_floor(theta: float, lean: float) -> None:
    pedestal = Pedestal(250.0, 0.60, 0.80, 0.20, offset_m=0.03)
    scene, history = moving(pedestal, theta_rad=theta, slip_m=0.04, statue_slip_m=-0.02, pedestal_tilt_rad=lean)
    pose = poses(scene, sampled(history, np.array([0.7])))
    (stone,) = posed_pedestal_m(pedestal, pose)
    assert stone[:, 2].min() == pytest.approx(0.0, abs=POSE_M)
    low = (0.30 if lean > 0.0 else -0.30) + 0.5 * (0.0682 - 0.3585) + 0.03 + 0.04
    assert lean == 0.0 or stone[stone[:, 2].argmin(), 0] == pytest.approx(low, abs=POSE_M), "slid by its lower edge"
    corner = 0.0682 if theta > lean else -0.3585
    at = posed_m(scene, np.array([[corner, 0.0, 0.0]]), pose)[0, 0]
    left, right = stone[1], stone[5]
    along, up = right - left, np.array([-(right - left)[2], 0.0, (right - left)[0]])
    assert (at - left) @ up == pytest.approx(0.0, abs=POSE_M), "on its top"
    asked = corner - (0.5 * (0.0682 - 0.3585) + 0.03) - 0.02 + 0.30
    assert (at - left) @ along / np.linalg.norm(along) == pytest.approx(asked, abs=POSE_M), "where it stood, and slid"


def test_an_engine_of_three_dimensions_says_the_pose_itself() -> None:
    told = dict(zip(SOLID_COLUMNS, (0.1, 0.02, 0.3, 0.05, 0.01, 0.2), strict=True))
    scene, history = moving(None, theta_rad=0.1, slip_m=0.5, **told)
    found = poses(scene, sampled(history, np.array([0.0, 2.0])))
    assert {name: values.tolist() for name, values in found.items()} == {
        name: [value] * 2 for name, value in told.items()
    }
