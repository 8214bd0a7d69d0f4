"""What happens across the rocking plane is told, not only what the plane shows."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from analytic import Harmonic, Pulse
from harness.engines.stepping.reduce import moves_in_space, on_support
from harness.engines.stepping.trajectory import Trajectory, statue_columns
from harness.model import BaseExcitation, Pedestal
from harness.questions.scene.scene_run import Result, run_scene
from harness.records.run import peak_lean_rad, peak_slip_m, standing
from harness.records.scores import Verdict
from tests.budgets_reports import PUSH, SAMPLED_M
from tests.engines_for_tests import ready
from tests.scenes_for_tests import GRAVITY_M_S2, PAESTUM, PAESTUM_PEDESTAL, rectangle, scene


def _shaken_across(strength_g: float, mu_statue: float) -> Result:
    """A block that is shaken to the front and back alone, by the model, and by the exact body."""
    ready("spatial")
    still = scene(rectangle(0.3, 0.45, mass_kg=3.2, depth_m=0.1), mu_statue=mu_statue, duration_s=3.0)
    floor = BaseExcitation(y=Harmonic(strength_g * GRAVITY_M_S2, 3.0))
    return run_scene(replace(still, base_excitation=floor), ["analytic", "spatial"])


def test_a_lean_to_the_front_is_the_statues_lean() -> None:
    """Its rotation in the plane is none; the model, which was given no motion across it, is not said to agree."""
    result = _shaken_across(0.27, 0.9)
    run = result.runs["spatial"]
    across_rad = float(np.abs(run.history.extra["out_of_plane_rad"]).max())
    assert across_rad > 0.02
    assert run.peak_theta_rad < 1e-6 < peak_lean_rad(run) == pytest.approx(across_rad, abs=SAMPLED_M)
    answer = result.answer()
    assert answer.code == "plane_left_out"
    assert answer.findings[0].values["outcome"] == "stands"
    assert answer.findings[0].values["lean_rad"] == [0.0, peak_lean_rad(run)]
    balance_rad = np.arctan2(0.05, 0.225)
    assert answer.findings[0].values["balance_share"] == pytest.approx(peak_lean_rad(run) / balance_rad)
    (pair,) = result.scores.values()
    assert pair.verdict is Verdict.PLANE
    assert pair.evidence.aside_rad == run.validity["out_of_plane_rad"]


def test_a_slide_to_the_front_is_the_statues_slide() -> None:
    result = _shaken_across(0.2, 0.1)
    run = result.runs["spatial"]
    slid_m = standing(run, "statue_slip_m")
    assert slid_m == pytest.approx(float(np.abs(run.history.extra["statue_y_m"]).max()), abs=SAMPLED_M)
    assert slid_m > 2e-3
    assert [found.values["models"] for found in result.findings() if found.code == "statue_slides"] == [["spatial"]]
    (pair,) = result.scores.values()
    assert (pair.verdict, pair.evidence.aside_m) == (Verdict.PLANE, pytest.approx(slid_m))
    told = [found for found in result.findings() if found.code == "motion_not_given"]
    assert len(told) == 1


def test_no_motion_across_leaves_nothing_aside() -> None:
    """At a strength that moves nothing the model agrees, though it was not given the motion."""
    result = _shaken_across(0.05, 0.9)
    assert [pair.verdict for pair in result.scores.values()] == [Verdict.AGREE]
    assert peak_lean_rad(result.runs["spatial"]) == pytest.approx(0.0, abs=1e-12)


def test_a_slide_to_the_front_is_no_standstill() -> None:
    assert "no_model_moves" not in [found.code for found in _shaken_across(0.2, 0.1).findings()]


def test_a_pedestal_that_slides_to_the_front_slips() -> None:
    """Its slip along the plane is none; what it slides across moves the statue, too."""
    ready("pybullet")
    stone = Pedestal(mass_kg=250.0, width_m=0.6, depth_m=0.6, height_m=0.2)
    still = scene(rectangle(0.3, 0.6, depth_m=0.3), pedestal=stone, mu=0.15, duration_s=0.8)
    floor = BaseExcitation(y=Harmonic(0.4 * GRAVITY_M_S2, 3.0))
    result = run_scene(replace(still, base_excitation=floor), ["analytic", "pybullet"])
    run = result.runs["pybullet"]
    assert peak_slip_m(run) == pytest.approx(float(np.abs(run.history.extra["pedestal_y_m"]).max()), abs=SAMPLED_M)
    assert peak_slip_m(run) > 5e-3 > run.peak_slip_m
    (pair,) = result.scores.values()
    assert pair.verdict is Verdict.PLANE
    assert pair.evidence.aside_m == pytest.approx(peak_slip_m(run), abs=SAMPLED_M)
    assert "no_model_moves" not in [found.code for found in result.findings()]


def test_a_hop_is_no_rest() -> None:
    """Shaken up and down by more than gravity a statue leaves the floor, upright all the while."""
    ready("pymunk")
    up = scene(rectangle(0.3, 0.6), None, Harmonic(1.3 * GRAVITY_M_S2, 4.0), duration_s=1.0)
    result = run_scene(up, ["analytic", "pymunk"])
    (found,) = [found for found in result.findings() if found.code == "statue_hops"]
    assert found.values["models"] == ["pymunk"]
    assert min(found.values["most"]) > 2e-3


def test_a_twist_is_told() -> None:
    """A statue that is shaken along and across at once rocks on a corner, about which it turns."""
    ready("spatial")
    still = scene(rectangle(0.3, 0.6, depth_m=0.3), duration_s=2.0)
    floor = BaseExcitation(x=Pulse("one_sine", 0.7 * GRAVITY_M_S2, 0.3), y=Pulse("one_sine", 0.6 * GRAVITY_M_S2, 0.2))
    result = run_scene(replace(still, base_excitation=floor), ["analytic", "spatial"])
    run = result.runs["spatial"]
    assert run.history is not None
    (found,) = [found for found in result.findings() if found.code == "statue_turns"]
    assert found.values["models"] == ["spatial"]
    assert found.values["most"][1] == pytest.approx(float(np.abs(run.history.extra["yaw_rad"]).max()), abs=SAMPLED_M)
    assert found.values["most"][1] > 0.1


def test_a_statue_that_turns_with_its_pedestal_does_not_shift_on_it() -> None:
    """Its base goes round with the top; on a top that keeps still the same turn moves the base along its chord."""
    on, yaw = scene(PAESTUM, pedestal=PAESTUM_PEDESTAL), np.linspace(0.0, 0.1, 50)
    statue = on.statue
    zero, turns = np.zeros_like(yaw), Rotation.from_euler("z", yaw[:, None]).as_matrix()
    centroid_m = turns @ np.array([0.15, 0.0, 0.0]) + [0.0, 0.0, statue.centroid_height_m]
    flat_m, still = np.column_stack([zero, zero]), {"pedestal_y_m": zero}
    middle_m = 0.15 + 0.5 * (statue.corner_right_m - statue.corner_left_m)
    for pedestal_yaw, expected_m in ((yaw, 0.0), (zero, 2.0 * abs(middle_m) * np.sin(0.05))):
        columns = statue_columns(statue, turns, centroid_m) | still | {"pedestal_yaw_rad": pedestal_yaw}
        path = Trajectory(
            yaw, zero, zero, zero, zero, flat_m[1:], centroid_m[:, ::2], flat_m, flat_m, flat_m, zero, extra=columns
        )
        shift_m, found = moves_in_space(on, path, on_support(path))
        assert shift_m.max() == pytest.approx(expected_m, abs=PUSH)
        assert found["yaw_rad"] == pytest.approx(0.1)


def test_a_statue_that_never_stands_flat_shifts_in_any_direction() -> None:
    """It leans on its front edge and slides with it, more across the plane than along: by a history of both that is known."""
    on = scene(PAESTUM)
    statue, share = on.statue, np.linspace(0.0, 1.0, 50)
    front = np.array([0.0, -0.5 * statue.depth_m, 0.0])
    turns = Rotation.from_euler("x", 0.02 + 0.1 * share[:, None]).as_matrix()
    centroid_m = front + share[:, None] * [0.03, 0.04, 0.0]
    centroid_m = centroid_m + turns @ (np.array([0.0, 0.0, statue.centroid_height_m]) - front)
    zero, flat_m = np.zeros_like(share), np.zeros((share.size, 2))
    columns = statue_columns(statue, turns, centroid_m)
    path = Trajectory(share, zero, zero, zero, zero, flat_m[1:], centroid_m[:, ::2], flat_m, extra=columns)
    shift_m, found = moves_in_space(on, path, on_support(path))
    assert shift_m.max() == pytest.approx(0.05, abs=PUSH)
    assert found["slip_across_m"] == pytest.approx(0.04, abs=PUSH)


def test_a_smaller_lean_towards_its_weak_side_is_nearer_to_its_balance() -> None:
    """A block twice as deep as wide leans by 0.2 to its front, then by 0.18 to its right, where it bears half as much."""
    on = scene(rectangle(0.2, 0.8, depth_m=0.4))
    statue, lean = on.statue, np.linspace(0.0, np.pi, 101)
    front, right = (
        np.where(half, np.sin(2.0 * lean) * most, 0.0) for half, most in ((lean < 1.57, 0.2), (lean > 1.57, -0.18))
    )
    turns = Rotation.from_euler("xy", np.column_stack([front, right])).as_matrix()
    zero, flat_m = np.zeros_like(lean), np.zeros((lean.size, 2))
    centroid_m = np.column_stack([zero, zero, zero + statue.centroid_height_m])
    columns = statue_columns(statue, turns, centroid_m)
    path = Trajectory(lean, right, zero, zero, zero, flat_m[1:], flat_m, flat_m, extra=columns)
    _, found = moves_in_space(on, path, on_support(path))
    assert found["peak_lean_rad"] == pytest.approx(0.2, rel=1e-2)
    assert found["peak_lean_balance_rad"] == pytest.approx(np.arctan2(0.1, 0.4))
    assert found["peak_lean_share"] == pytest.approx(0.18 / np.arctan2(0.1, 0.4), rel=1e-2)
