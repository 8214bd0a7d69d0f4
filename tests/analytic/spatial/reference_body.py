"""The rigid body of the spatial reference: its case, kinematics and inertia, in plain numpy.

Frame: that of the floor (x, y, z up, floor at z = 0), in which gravity is g_e = (−a_x, −a_y, −g − a_z). The state is the vector
(centroid (3), its velocity (3), quaternion w first, body to floor (4), angular velocity in the body's frame (3)).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Motion = Callable[[float], float]


def still(_t: float) -> float:
    """No acceleration."""
    return 0.0


@dataclass(frozen=True)
class Case:
    """One body on one moving floor; SI units, vertices and inertia about the centroid in the body's frame.

    breaks_s: instants at which the motions are not smooth; friction_static is not below friction_kinetic.
    """

    mass_kg: float
    inertia_kg_m2: Array
    vertices_m: Array
    friction_static: float
    friction_kinetic: float
    accel_x_m_s2: Motion = still
    accel_y_m_s2: Motion = still
    accel_z_m_s2: Motion = still
    gravity_m_s2: float = 9.81
    breaks_s: tuple[float, ...] = ()
    inverse_mass: Array = field(init=False)
    skews_m: Array = field(init=False)
    """The matrices (n, 3, 3) of the vertices ×."""

    def __post_init__(self) -> None:
        inverse = np.zeros((6, 6))
        inverse[:3, :3] = np.eye(3) / self.mass_kg
        inverse[3:, 3:] = np.linalg.inv(self.inertia_kg_m2)
        object.__setattr__(self, "inverse_mass", inverse)
        object.__setattr__(self, "skews_m", np.array([skew(r) for r in self.vertices_m]))

    def gravity(self, t: float) -> Array:
        """What a mass at rest on the floor feels, m/s²."""
        return np.array(
            [-self.accel_x_m_s2(t), -self.accel_y_m_s2(t), -self.gravity_m_s2 - self.accel_z_m_s2(t)], dtype=float
        )


def rotation(q: Array) -> Array:
    """The matrix of a quaternion, w first."""
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def quaternion_rate(q: Array, omega: Array) -> Array:
    """q̇ = q ∘ (0, ω) / 2 with ω in the body's frame."""
    w, v = q[0], q[1:]
    return 0.5 * np.concatenate([[-v @ omega], w * omega + skew(v) @ omega])


def skew(v: Array) -> Array:
    """The matrix of v ×."""
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


@dataclass(frozen=True)
class Kinematics:
    """Where the vertices are and how they move in one state: v_i = J_i (v_G, ω), a_i = J_i (v̇_G, ω̇) + centripetal_i."""

    points: Array
    jacobians: Array
    velocities: Array
    centripetal: Array
    speeds: Array

    @classmethod
    def of(cls, case: Case, y: Array) -> Kinematics:
        """The kinematics of a state."""
        turn, omega, speeds = rotation(y[6:10]), y[10:13], np.concatenate([y[3:6], y[10:13]])
        turning = skew(omega)
        jacobians = np.empty((len(case.vertices_m), 3, 6))
        jacobians[:, :, :3] = np.eye(3)
        jacobians[:, :, 3:] = -turn @ case.skews_m
        centripetal = case.vertices_m @ (turn @ turning @ turning).T
        return cls(y[:3] + case.vertices_m @ turn.T, jacobians, jacobians @ speeds, centripetal, speeds)


def unforced(case: Case, t: float, y: Array) -> Array:
    """(v̇_G, ω̇) without contact: gravity, and Euler's equations."""
    omega = y[10:13]
    gyroscopic = np.linalg.solve(case.inertia_kg_m2, -skew(omega) @ (case.inertia_kg_m2 @ omega))
    return np.concatenate([case.gravity(t), gyroscopic])


def snapped(case: Case, y: Array, contacts: list[int], sticking: list[int]) -> Array:
    """The state nearest by kinetic energy in which contacts are on the floor, do not leave it, and sticking ones are still."""
    y = y.copy()
    for _ in range(3):
        now = Kinematics.of(case, y)
        shift = _least(case, now.jacobians[contacts][:, 2], -now.points[contacts, 2])
        y[:3] += shift[:3]
        y[6:10] += quaternion_rate(y[6:10], shift[3:])
        y[6:10] /= np.linalg.norm(y[6:10])
    now = Kinematics.of(case, y)
    rows = np.vstack(
        [now.jacobians[i] if i in sticking else now.jacobians[i][2:] for i in contacts] or [np.zeros((0, 6))]
    )
    change = _least(case, rows, -rows @ now.speeds)
    y[3:6] += change[:3]
    y[10:13] += change[3:]
    return y


def _least(case: Case, rows: Array, wanted: Array) -> Array:
    """The change of speeds of least kinetic energy by which rows change as wanted."""
    if not len(rows):
        return np.zeros(6)
    across = case.inverse_mass @ rows.T
    return across @ np.linalg.lstsq(rows @ across, wanted, rcond=1e-11)[0]
