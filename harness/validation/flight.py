"""How a toss began: the free flight that is nearest to what was seen of it before it touched."""

from __future__ import annotations

from typing import Final

import numpy as np
from scipy.spatial.transform import Rotation

from analytic import spatial
from analytic.rotation import rotation_matrices
from harness.model.history import Array
from harness.model.scene import Pose, Statue

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
    points, turned = body.outer_points_m, rotation_matrices(quaternions)
    low = places_m[:, 2] + np.min(turned[:, 2] @ points.T, axis=1) < CLEAR * np.max(np.linalg.norm(points, axis=1))
    count = int(np.argmax(np.append(low, True)))
    if count < FEWEST_IN_FLIGHT:
        return first
    rigid = spatial.Body(body.mass_kg, body.inertia_tensor_kg_m2, points[:3])
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
