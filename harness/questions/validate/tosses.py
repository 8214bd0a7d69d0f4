"""Measured motion in space: a table of tosses, each the pose of one body at equal times from the hand to rest.

One line for each frame: `toss` (its name), `t_s`, the centroid's place `x_m, y_m, z_m` (z up), the rotation from the body's axes
to the table's `qw, qx, qy, qz`, the velocities of the centroid `vx_m_s, vy_m_s, vz_m_s` and about the body's axes
`wx_rad_s, wy_rad_s, wz_rad_s`, both as backward differences; as DAIRLab's contact-nets tells them, in SI units.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from scipy.spatial.transform import Rotation

from analytic import spatial
from analytic.block import rotation_matrices
from harness.model.errors import InputError, Mistake
from harness.model.history import Array
from harness.model.scene import Pose, Statue
from harness.questions.validate.number_table import read_groups

PLACE: Final = ("x_m", "y_m", "z_m", "qw", "qx", "qy", "qz")
RATES: Final = ("vx_m_s", "vy_m_s", "vz_m_s", "wx_rad_s", "wy_rad_s", "wz_rad_s")
COLUMNS: Final = ("toss", "t_s", *PLACE, *RATES)
UNIT: Final = 1e-3
"""A measured quaternion's norm may be off by this much (six printed digits leave 1e-6); it is made exact."""
EVEN: Final = 1e-3
"""Share of a frame by which a frame's time may be off the even grid (six printed digits leave 1e-4)."""
FEWEST_FRAMES: Final = 3


@dataclass(frozen=True)
class Clock:
    """Free fall by the table's clock, its standard error, and the rate of frames with which it is the scene's gravity."""

    fall_m_s2: float
    error_m_s2: float
    stated_hz: float
    rate_hz: float


@dataclass(frozen=True, eq=False)
class Toss:
    """One toss: times (n,) from 0, evenly spaced; places (n, 3); quaternions (n, 4), w first; how it began.

    `raised_m` was added to every height so that the body's lowest point is on the table at the last frame.
    """

    name: str
    frame_s: float
    places_m: Array
    quaternions: Array
    start: Pose
    raised_m: float = 0.0
    contact: int = 0
    """Number of the first frame near the table."""

    @property
    def end_s(self) -> float:
        """Time of the last frame."""
        return self.frame_s * (len(self.places_m) - 1)


def read_tosses(path: Path, body: Statue, gravity_m_s2: float) -> tuple[list[Toss], Clock | None]:
    """All tosses of a table, stood on it by the body's outer points, begun as their flights say; and their clock, or None.

    Times are those of a clock by which free fall is gravity, where it is not within its error. Raises `InputError` with every
    mistake.
    """
    mistakes: list[Mistake] = []
    groups = read_groups(path, COLUMNS)
    for name, table in groups:
        if (wrong := _wrong(table)) is not None:
            mistakes.append(Mistake(str(path), f"toss {name}", *wrong))
    if mistakes:
        raise InputError(mistakes)
    clock = clock_of([table for _, table in groups], body, gravity_m_s2)
    stretch = 1.0 if clock is None else clock.stated_hz / clock.rate_hz
    scale = np.array([stretch, *[1.0] * len(PLACE), *[1.0 / stretch] * len(RATES)])
    return [_stood(name, scale * table, body, gravity_m_s2) for name, table in groups], clock


def clock_of(tables: Sequence[Array], body: Statue, gravity_m_s2: float) -> Clock | None:
    """The clock by which the tosses' free falls are gravity: each flight's, weighed by what it knows; None of fewer than two."""
    falls, weights = [], []
    for table in tables:
        count = in_flight(body, table[:, 1:4], table[:, 4:8])
        if count >= FEWEST_OF_FALL:
            (half, *_), cov = np.polyfit(table[:count, 0], table[:count, 3], 2, cov="unscaled")
            falls.append(-2.0 * half)
            weights.append(0.25 / cov[0, 0])
    if len(falls) < 2:
        return None
    fall = float(np.average(falls, weights=weights))
    shares = np.array(weights) / np.sum(weights)
    error = float(np.sqrt(np.sum((shares * (np.array(falls) - fall)) ** 2)))
    stated = 1.0 / float(np.mean([table[-1, 0] / (len(table) - 1) for table in tables]))
    off = fall > 0.0 and abs(fall - gravity_m_s2) > CLOCK_OFF * error and abs(fall / gravity_m_s2 - 1.0) < MOST_OFF
    return Clock(fall, error, stated, stated * float(np.sqrt(gravity_m_s2 / fall)) if off else stated)


def _wrong(table: Array) -> tuple[str, str] | None:
    """What is wrong with a toss's frames: wanted and got."""
    if len(table) < FEWEST_FRAMES:
        return f"at least {FEWEST_FRAMES} frames", str(len(table))
    times, frame_s = table[:, 0], table[-1, 0] / (len(table) - 1)
    if not frame_s > 0.0 or np.max(np.abs(times - frame_s * np.arange(len(times)))) > EVEN * frame_s:
        return "evenly spaced times from 0", f"times from {times[0]:g} to {times[-1]:g} s that are not"
    norms = np.linalg.norm(table[:, 4:8], axis=1)
    worst = float(norms[np.argmax(np.abs(norms - 1.0))])
    if abs(worst - 1.0) > UNIT:
        return "unit quaternions", f"one of norm {worst:.6g}"
    return None


def _stood(name: str, table: Array, body: Statue, gravity_m_s2: float) -> Toss:
    """The toss with its heights such that it ends on the table: a camera's height has a bias, rest has none."""
    turns = table[:, 4:8] / np.linalg.norm(table[:, 4:8], axis=1)[:, None]
    w, x, y, z = turns[-1].tolist()
    last = Pose((0.0, 0.0, 0.0), (w, x, y, z))
    lowest = float(table[-1, 3] + np.min(body.outer_points_m @ last.rotation[2]))
    places = table[:, 1:4] - np.array([0.0, 0.0, lowest])
    frame_s = float(table[-1, 0] / (len(table) - 1))
    (x, y, z), (a, b, c, d), (u, v, w, p, q, r) = places[0].tolist(), turns[0].tolist(), table[0, 8:14].tolist()
    # A backward difference is the velocity of half a frame before.
    first = Pose((x, y, z), (a, b, c, d), (u, v, w - 0.5 * gravity_m_s2 * frame_s), (p, q, r))
    start = nearest_flight(body, gravity_m_s2, frame_s, places, turns, first)
    return Toss(name, frame_s, places, turns, start, -lowest, in_flight(body, places, turns))


CLOCK_OFF: Final = 3.0
"""Standard errors by which a free fall differs from gravity where the clock is at fault."""
MOST_OFF: Final = 0.1
"""A fall that is farther off than this share is no clock's fault: it is told, and the times are left."""
FEWEST_OF_FALL: Final = 8
"""Frames in flight of which an acceleration is read."""
CLEAR: Final = 0.05
"""Share of the body's radius by which its lowest point must be above the table: a camera is off by some millimetres."""
FEWEST_IN_FLIGHT: Final = 3
ROUNDS: Final = 12
"""Each leaves a sixth of the error before, or less: what the body's turn changes in the effect of its first rate of turn."""
HIGH_M: Final = 1e3
"""The flight is computed so far above the floor."""


def nearest_flight(
    body: Statue, gravity_m_s2: float, frame_s: float, places_m: Array, quaternions: Array, first: Pose
) -> Pose:
    """The start at the first frame whose flight misses places (n, 3) and rotations (n, 4), w first, least before they touch.

    `first` is where it is looked for, and the answer where too few frames are in flight. A velocity that is the difference of two
    frames has their whole noise over one frame's time.
    """
    count = in_flight(body, places_m, quaternions)
    if count < FEWEST_IN_FLIGHT:
        return first
    rigid = spatial.Body(body.mass_kg, body.inertia_tensor_kg_m2, body.outer_points_m[:3])
    seen, times = _rotations(quaternions[:count]), frame_s * np.arange(count)
    design, pose = np.column_stack([np.ones(count), times]), first
    for _ in range(ROUNDS):
        x, y, z = pose.position_m
        flown = spatial.simulate(
            rigid,
            duration_s=count * frame_s,
            friction_static=0.0,
            dt_out_s=frame_s,
            gravity_m_s2=gravity_m_s2,
            overturn_rad=np.pi,
            position_m=(x, y, z + HIGH_M),
            quaternion_wxyz=pose.quaternion_wxyz,
            velocity_m_s=pose.velocity_m_s,
            angular_velocity_rad_s=pose.angular_velocity_rad_s,
        )
        turn = (seen * _rotations(flown.quaternion_wxyz[:count]).inv()).as_rotvec()
        shift = places_m[:count] - flown.position_m[:count] + [0.0, 0.0, HIGH_M]
        (turn, spun), (shift, pushed) = (np.linalg.lstsq(design, missed, rcond=None)[0] for missed in (turn, shift))
        pose = _corrected(pose, turn, spun, shift, pushed)
    return pose


def in_flight(body: Statue, places_m: Array, quaternions: Array) -> int:
    """How many frames are before the first near the table."""
    points, turned = body.outer_points_m, rotation_matrices(quaternions)
    low = places_m[:, 2] + np.min(turned[:, 2] @ points.T, axis=1) < CLEAR * np.max(np.linalg.norm(points, axis=1))
    return int(np.argmax(np.append(low, True)))


def _rotations(quaternions: Array) -> Rotation:
    """Rotations from quaternions (n, 4), w first."""
    return Rotation.from_quat(quaternions[:, [1, 2, 3, 0]])


def _corrected(pose: Pose, turn_rad: Array, spin_rad_s: Array, shift_m: Array, push_m_s: Array) -> Pose:
    """A pose turned, spun, shifted and pushed by vectors (3,) of the table's frame."""
    was = _rotations(np.array([pose.quaternion_wxyz]))[0]
    now = Rotation.from_rotvec(turn_rad) * was
    rate = now.inv().apply(was.apply(pose.angular_velocity_rad_s) + spin_rad_s)
    a, b, c, w = now.as_quat().tolist()
    x, y, z = (np.array(pose.position_m) + shift_m).tolist()
    u, v, up = (np.array(pose.velocity_m_s) + push_m_s).tolist()
    p, q, r = rate.tolist()
    return Pose((x, y, z), (w, a, b, c), (u, v, up), (p, q, r))
