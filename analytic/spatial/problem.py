"""What is to be computed in three dimensions, and how finely."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final, final

import numpy as np

from analytic.block import positive
from analytic.constants import GRAVITY_M_S2, OVERTURN_RAD
from analytic.errors import AnalyticInputError
from analytic.motion import Excitation, ZeroExcitation
from analytic.spatial.body import Body

UPRIGHT: Final = (1.0, 0.0, 0.0, 0.0)
UNIT: Final = 1e-6
"""By how much a quaternion's length may differ from one: it is then made one."""


@final
@dataclass(frozen=True, eq=False)
class Problem:
    """A body on a shaking floor; SI units, table's frame, angular velocity in the body's frame.

    position_m of the centroid; None: the lowest vertex on the floor, x = y = 0. velocity_m_s of the centroid. friction_kinetic
    None: as friction_static; both may be infinite. overturn_rad ends a run; from π on nothing does. restitution: the share of
    its normal velocity with which a vertex leaves an impact. Raises AnalyticInputError for numbers that cannot be run.
    """

    body: Body
    duration_s: float
    friction_static: float
    friction_kinetic: float | None = None
    motion_x: Excitation = field(default_factory=ZeroExcitation)
    motion_y: Excitation = field(default_factory=ZeroExcitation)
    motion_z: Excitation = field(default_factory=ZeroExcitation)
    gravity_m_s2: float = GRAVITY_M_S2
    position_m: Sequence[float] | None = None
    quaternion_wxyz: Sequence[float] = UPRIGHT
    velocity_m_s: Sequence[float] = (0.0, 0.0, 0.0)
    angular_velocity_rad_s: Sequence[float] = (0.0, 0.0, 0.0)
    overturn_rad: float = OVERTURN_RAD
    restitution: float = 0.0

    def __post_init__(self) -> None:
        """Check the numbers."""
        positive(duration_s=self.duration_s, gravity_m_s2=self.gravity_m_s2, overturn_rad=self.overturn_rad)
        kinetic = self.kinetic
        if not (0.0 <= kinetic <= self.friction_static):
            raise AnalyticInputError(
                f"0 ≤ friction_kinetic ≤ friction_static is wanted, {kinetic!r} and {self.friction_static!r} came."
            )
        if not 0.0 <= self.restitution <= 1.0:
            raise AnalyticInputError(f"restitution: a number from 0 to 1 is wanted, {self.restitution!r} came.")
        vectors = {
            "position_m": (self.position_m or (0.0, 0.0, 0.0), 3),
            "quaternion_wxyz": (self.quaternion_wxyz, 4),
            "velocity_m_s": (self.velocity_m_s, 3),
            "angular_velocity_rad_s": (self.angular_velocity_rad_s, 3),
        }
        for name, (value, size) in vectors.items():
            if len(value) != size or not all(math.isfinite(item) for item in value):
                raise AnalyticInputError(f"{name}: {size} finite numbers are wanted, {tuple(value)!r} came.")
        if abs(math.hypot(*self.quaternion_wxyz) - 1.0) > UNIT:
            raise AnalyticInputError(f"quaternion_wxyz: length one is wanted, {tuple(self.quaternion_wxyz)!r} came.")

    @property
    def kinetic(self) -> float:
        """Coefficient of sliding friction."""
        return self.friction_static if self.friction_kinetic is None else self.friction_kinetic

    @property
    def start(self) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
        """The initial state (13,): place, quaternion, velocity, angular velocity.

        Without a given place the lowest vertex is put on the floor. The velocity is the centroid's, as given: one that turns
        about a vertex is given ω × (centroid − vertex), which the angular velocity alone does not bring.
        """
        from analytic.rotation import rotation_matrices

        turn = np.array(self.quaternion_wxyz) / math.hypot(*self.quaternion_wxyz)
        velocity, spin = np.array(self.velocity_m_s), np.array(self.angular_velocity_rad_s)
        if self.position_m is None:
            arms = self.body.vertices_m @ rotation_matrices(turn[None])[0].T
            position = np.array([0.0, 0.0, -arms[:, 2].min()])
        else:
            position = np.array(self.position_m)
        return np.concatenate([position, turn, velocity, spin])
