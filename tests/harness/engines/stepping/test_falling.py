"""What counts as overturned, by motions whose end is known: lying, falling, coming back, on another facet of the base."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from analytic.excitation import Harmonic
from harness.engines.stepping.reduce import Report, reduce_trajectory
from harness.engines.stepping.trajectory import Trajectory, statue_columns
from harness.model import Array, BaseExcitation, Outcome, Pedestal, Run, Scene, Statue, Wall
from tests import budgets_engines as budget
from tests.scenes_for_tests import rectangle, scene

T_S: Array = np.arange(2001) * 1e-3
REPORT = Report(engine="test", settings={}, steps=0, wall_s=0.0, resolution_rad=1e-5, stuck_below_m_s=1e-5)
BLOCK = rectangle(0.4, 1.2)
ALPHA = BLOCK.slenderness_rad(1)
SHAKEN = BaseExcitation(x=Harmonic(1.0, 2.0))
TAPERED = replace(BLOCK, section_m=np.array([[-0.2, 0.0], [0.2, 0.0], [0.45, 1.2], [-0.45, 1.2]]))
FLANK_RAD = math.atan2(1.2, 0.25)


def motion(statue: Statue, theta: Array, rate: Array | None = None) -> Trajectory:
    """A body that turns about whatever lies lowest, without flight."""
    rate = np.gradient(theta, T_S) if rate is None else rate
    points = statue.section_m - [0.0, statue.centroid_height_m]
    heights = points[:, 1] * np.cos(theta)[:, None] - points[:, 0] * np.sin(theta)[:, None]
    z = -heights.min(axis=1)
    place = np.column_stack([np.zeros_like(z), z])
    speed = np.column_stack([np.zeros_like(z), np.gradient(z, T_S)])
    zero = np.zeros_like(theta)
    return Trajectory(T_S, theta, rate, zero, zero, np.tile([0.0, -9.81], (T_S.size - 1, 1)), place, speed)


def on(statue: Statue, base_excitation: BaseExcitation | None = None) -> Scene:
    return replace(scene(statue, duration_s=2.0), base_excitation=base_excitation or BaseExcitation())


def ended(statue: Statue, theta: Array, base_excitation: BaseExcitation | None = None) -> Run:
    return reduce_trajectory(on(statue, base_excitation), motion(statue, theta), REPORT)


@pytest.mark.parametrize("base_excitation", [BaseExcitation(), SHAKEN], ids=["still", "shaken"])
def test_lying_on_a_flank_is_overturned_from_when_it_came_there(base_excitation: BaseExcitation) -> None:
    theta = np.minimum(T_S, FLANK_RAD)
    found = ended(TAPERED, theta, base_excitation)
    assert found.outcome is Outcome.OVERTURNED_RIGHT
    assert found.no_return_time_s == pytest.approx(ALPHA, abs=budget.EVENT_TIME_S)
    assert found.overturn_time_s == pytest.approx(FLANK_RAD, abs=1.1e-3)
    assert found.end_s == 2.0
    assert found.peak_theta_rad == pytest.approx(FLANK_RAD)
    assert ended(TAPERED, -theta, base_excitation).outcome is Outcome.OVERTURNED_LEFT


def test_beyond_balance_on_its_corner_the_shaking_may_bring_it_back() -> None:
    """Turning back at 1.1 α it has less energy than the balance point; a floor that moves on can give it more."""
    theta = 1.1 * ALPHA - 0.05 * (T_S - 2.0) ** 2
    assert ended(BLOCK, theta, SHAKEN).outcome is Outcome.UNDECIDED
    found = ended(BLOCK, theta)
    assert found.outcome is Outcome.OVERTURNED_RIGHT
    assert found.no_return_time_s is not None
    assert found.overturn_time_s is None


@pytest.mark.parametrize(
    ("rate", "outcome"),
    [(2.0, Outcome.OVERTURNED_RIGHT), (-0.3, Outcome.STANDS), (-3.0, Outcome.OVERTURNED_LEFT)],
    ids=["outwards", "back", "over to the other side"],
)
def test_with_energy_to_come_back_it_is_overturned_when_it_moves_outwards(rate: float, outcome: Outcome) -> None:
    theta = np.clip(1.2 * ALPHA + rate * (T_S - 2.0), 0.0, 1.4)
    assert ended(BLOCK, theta).outcome is outcome
    assert ended(BLOCK, theta, SHAKEN).outcome is Outcome.UNDECIDED


def test_a_higher_hill_ahead_may_send_it_back() -> None:
    """A pole across the flank, whose tip is further from the centroid than the corner: thrown onto it the body can return."""
    poled = replace(BLOCK, section_m=np.vstack([BLOCK.section_m, [[1.0, 0.6]]]))
    fast = np.clip(1.2 * ALPHA + 4.0 * (T_S - 2.0), 0.0, None)
    assert ended(BLOCK, fast).outcome is Outcome.OVERTURNED_RIGHT
    assert ended(poled, fast).outcome is Outcome.UNDECIDED


def test_another_facet_of_its_own_base_is_a_rest() -> None:
    """A bulging base rests on a side facet: the balance angle is that of its outermost feet."""
    bulging = replace(BLOCK, section_m=np.vstack([BLOCK.section_m, [[0.0, -0.02]]]))
    lean = math.atan2(0.02, 0.2)
    assert ended(bulging, np.minimum(T_S, lean)).outcome is Outcome.STANDS


def spatial(up: Array, statue: Statue = BLOCK) -> Trajectory:
    """At rest with its axis along `up` (3,) from half of the time on, turned there evenly; on the floor."""
    share = np.minimum(T_S, 1.0)[:, None]
    across, theta = math.asin(up[1]), math.atan2(up[0], up[2])
    flat = motion(statue, share[:, 0] * theta)
    # R = R_y(θ) R_x(−across): its third column is the axis.
    roll, pitch = -share[:, 0] * across, share[:, 0] * theta
    zero = np.zeros_like(T_S)
    turn = Rotation.from_euler("xyz", np.column_stack([roll, pitch, zero])).as_matrix()
    told = {"roll_rad": roll, "pitch_rad": pitch, "yaw_rad": zero, "out_of_plane_rad": share[:, 0] * across}
    return replace(flat, extra=statue_columns(statue, turn, np.insert(flat.statue_xz_m, 1, 0.0, axis=1)) | told)


@pytest.mark.parametrize(
    ("tilt", "azimuth", "outcome"),
    [
        (1.4, 90.0, Outcome.OVERTURNED_BACK),
        (1.4, -90.0, Outcome.OVERTURNED_FRONT),
        (1.4, 170.0, Outcome.OVERTURNED_LEFT),
        (0.3, 0.0, Outcome.STANDS),
        # Along the base's diagonal it balances further out than in the plane.
        (0.4, 51.0, Outcome.STANDS),
        (0.4, 90.0, Outcome.OVERTURNED_BACK),
    ],
)
def test_in_space_the_edge_it_falls_over_counts(tilt: float, azimuth: float, outcome: Outcome) -> None:
    a = math.radians(azimuth)
    up = np.array([math.sin(tilt) * math.cos(a), math.sin(tilt) * math.sin(a), math.cos(tilt)])
    squat = replace(BLOCK, footprint_m=BLOCK.footprint_m * np.array([1.0, 0.8, 1.0]))
    found = reduce_trajectory(on(squat), spatial(up, squat), REPORT)
    assert found.outcome is outcome
    assert (found.no_return_time_s is not None) is outcome.overturned


def test_a_wall_that_it_leans_on_is_touched() -> None:
    walled = replace(on(TAPERED), wall=Wall("right", 0.4))
    found = reduce_trajectory(walled, motion(TAPERED, np.minimum(T_S, 0.9)), REPORT)
    assert found.outcome is Outcome.TOUCHES_WALL
    assert found.no_return_time_s is None


@pytest.mark.parametrize(
    ("slid_m", "outcome"), [(0.0, Outcome.OVERTURNED_RIGHT), (0.6, Outcome.LEFT_PEDESTAL)], ids=["toppled", "slid off"]
)
def test_what_came_first_at_the_pedestal_s_edge_counts(slid_m: float, outcome: Outcome) -> None:
    """It ends lying on its flank either way; slid off its support before, it has left that first."""
    below = Pedestal(mass_kg=400.0, width_m=0.6, depth_m=0.6, height_m=0.4)
    lying = motion(TAPERED, np.minimum(T_S, FLANK_RAD))
    shift = np.column_stack([slid_m * np.minimum(T_S / 0.2, 1.0), np.full_like(T_S, below.height_m)])
    still = np.zeros((T_S.size, 2))
    moved = replace(
        lying,
        statue_xz_m=lying.statue_xz_m + shift,
        pedestal_xz_m=still + np.array([0.0, below.centroid_height_m]),
        pedestal_rate_m_s=still,
    )
    found = reduce_trajectory(replace(on(TAPERED), pedestal=below), moved, REPORT)
    assert found.outcome is outcome
    assert (found.no_return_time_s is not None) is outcome.overturned
