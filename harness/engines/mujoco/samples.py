"""What MuJoCo's steps say at one instant: positions lead velocities by half a step and are taken back by it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic.rotation import rotation_matrices
from harness.engines.contact.spatial import planar, statue_columns
from harness.engines.contact.trajectory import Trajectory
from harness.engines.mujoco.model import integrator
from harness.model.scene import Scene

Array = NDArray[np.float64]


def _back(quaternion: Array, rate: Array, half_s: float) -> tuple[Array, Array]:
    """Rotations (n, 3, 3) taken back by half a step, and angular velocities (n, 3) in the world; `rate` is the body's own."""
    # MuJoCo moves places by the new velocities (semi-implicit Euler): they lead by half a step; to first order, as it is itself.
    turn = rotation_matrices(quaternion)
    nothing = np.zeros(len(rate))
    x, y, z = rate.T
    cross = np.moveaxis(np.array([[nothing, -z, y], [z, nothing, -x], [-y, x, nothing]]), -1, 0)
    return turn - half_s * turn @ cross, np.einsum("nij,nj->ni", turn, rate)


def _tilt(turn: Array, spin: Array) -> Array:
    """Planar rotation of a body from its rotations and angular velocities."""
    return planar(turn[:, :, 2], spin)[0]


def trajectory(scene: Scene, dt_s: float, t_s: Array, gravity_xz: Array, rows: Array) -> Trajectory:
    """Rows of positions and velocities, shape (n, nq + nv), as samples in the table's frame at t_s, shape (n,)."""
    pedestal = scene.pedestal is not None
    nq = 14 if pedestal else 7
    # RK4 moves both at once; semi-implicit Euler's places lead by half a step.
    q, v, half = rows[:, :nq], rows[:, nq:], 0.5 * dt_s if integrator(scene) == "Euler" else 0.0
    zero = np.zeros(t_s.size)
    turn, spin = _back(q[:, 3:7], v[:, 3:6], half)
    centroid = q[:, :3] - half * v[:, :3]
    theta, theta_rate = planar(turn[:, :, 2], spin)
    extra = statue_columns(scene.statue, turn, centroid)
    place, rate, slip, slip_rate = None, None, zero, zero
    if pedestal:
        place, rate = q[:, [7, 9]] - half * v[:, [6, 8]], v[:, [6, 8]]
        slip, slip_rate = place[:, 0] - place[0, 0], rate[:, 0]
        extra["pedestal_tilt_rad"] = _tilt(*_back(q[:, 10:14], v[:, 9:12], half))
    return Trajectory(
        t_s,
        theta,
        theta_rate,
        slip,
        slip_rate,
        gravity_xz,
        centroid[:, [0, 2]],
        v[:, [0, 2]],
        place,
        rate,
        extra,
    )
