"""The table's motion step by step, for every contact engine; a pose in the table's frame as columns; what has fallen.

A step changes velocities first and places after, v ← v + g Δt, x ← x + v Δt. Read as velocities half a step before their
places it is of second order; so the gravity of the step from t_n to t_{n+1} is the mean over the time from the middle of the
step before to the middle of this one. The first step begins with synchronous velocities: half of its time lies before t_0.
"""

import math
from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Final

import numpy as np

from analytic.block import rotation_matrices
from analytic.excitation import ZeroExcitation
from harness.engines.stepping.step_log import Vector
from harness.model import OVERTURN_RAD, Array, Scene, Statue

# What three dimensions add to a trajectory: rotation matrices, the columns of a body's pose, a fall in any direction.


OVERTURN_TAN: Final = math.tan(OVERTURN_RAD)
OVERTURN_COS: Final = math.cos(OVERTURN_RAD)


def matrices(turns: Array) -> Array:
    """Rotation matrices (n, 3, 3) of quaternions (n, 4), ordered (x, y, z, w) as Bullet has them."""
    return rotation_matrices(turns[:, [3, 0, 1, 2]])


def planar(up: Array, spin: Array) -> tuple[Array, Array]:
    """θ = atan2(ẑ·x̂, ẑ·ẑ), unwrapped, and its rate, from the statue's axis (n, 3) and its angular velocity (n, 3)."""
    theta = np.unwrap(np.arctan2(up[:, 0], up[:, 2]))
    change = np.cross(spin, up)
    # d atan2(x, z)/dt of the axis, which moves with ω × ẑ; an axis that lies across the plane has no rotation in it.
    size = up[:, 0] ** 2 + up[:, 2] ** 2
    rate: Array = (up[:, 2] * change[:, 0] - up[:, 0] * change[:, 2]) / np.where(size > 0.0, size, 1.0)
    return theta, rate


def statue_columns(statue: Statue, turn: Array, centroid_m: Array) -> dict[str, Array]:
    """Pose of the statue, (n, 3, 3) and (n, 3) in the table's frame, as the columns that every 3D engine records."""
    roll = np.arctan2(turn[:, 2, 1], turn[:, 2, 2])
    sin, cos = np.sin(roll), np.cos(roll)
    # A body on its side (pitch ±π/2) has roll and yaw about one axis: yaw is what is left after the roll, whatever that is.
    yaw = np.arctan2(sin * turn[:, 0, 2] - cos * turn[:, 0, 1], cos * turn[:, 1, 1] - sin * turn[:, 1, 2])
    columns = {
        "roll_rad": roll,
        "pitch_rad": np.arctan2(-turn[:, 2, 0], np.hypot(turn[:, 2, 1], turn[:, 2, 2])),
        "yaw_rad": np.unwrap(yaw),
        "out_of_plane_rad": np.arcsin(np.clip(turn[:, 1, 2], -1.0, 1.0)),
        "statue_y_m": centroid_m[:, 1] - centroid_m[0, 1],
    }
    for name, x in (("right", statue.corner_right_m), ("left", -statue.corner_left_m)):
        path = centroid_m + turn @ np.array([x, 0.0, -statue.centroid_height_m])
        columns |= {f"corner_{name}_{axis}_m": path[:, k] for k, axis in enumerate("xyz")}
    return columns


def fallen(zx: float, zy: float, zz: float) -> bool:
    """Whether the statue's axis (zx, zy, zz) counts as overturned, in the plane or across it."""
    if abs(zx) >= abs(zy):
        return abs(zx) >= zz * OVERTURN_TAN
    return zz <= OVERTURN_COS


def step_count(duration_s: float, dt_s: float) -> int:
    """Number of steps that reach `duration_s` (the last one may pass it by less than a step)."""
    # A duration that is a whole number of steps but for rounding takes no step more.
    return max(1, math.ceil(duration_s / dt_s * (1.0 - 1e-12)))


def apparent_gravity(scene: Scene, edges_s: Array) -> Array:
    """Gravity in the floor's accelerating frame, (−a_x, −a_y, −g − a_z), shape (n − 1, 3), m/s².

    Each row is the exact mean over its step [edges_s[i], edges_s[i+1]] (from the motion's velocity), so that a step's impulse
    is exact also where the acceleration jumps inside it.
    """
    gravity = np.zeros((edges_s.size - 1, 3))
    gravity[:, 2] = -scene.gravity_m_s2
    for axis, part in enumerate(scene.base_excitation.parts):
        if not isinstance(part, ZeroExcitation):
            gravity[:, axis] -= np.diff(np.asarray(part.velocity_m_s(edges_s), dtype=np.float64)) / np.diff(edges_s)
    return gravity


def greatest_pull_m_s2(scene: Scene) -> float:
    """A bound on what weight and table together can do, m/s²."""
    return sum((part.peak_m_s2 for part in scene.base_excitation.parts), scene.gravity_m_s2)


def table_motion(scene: Scene, t_s: Array) -> tuple[Array, Array]:
    """Displacement, m, and velocity, m/s, of a moving table (x, y, z) at the given times, shape (n, 3); zero before t = 0."""
    later, parts = np.maximum(t_s, 0.0), scene.base_excitation.parts
    places = np.column_stack([np.asarray(part.displacement_m(later)) for part in parts])
    return places, np.column_stack([np.asarray(part.velocity_m_s(later)) for part in parts])


# Impulses of the table's motion, step by step, for an engine's own integrator read as a leapfrog.

SAME_INSTANT: Final = 1e-6
"""Share of a step by which two instants may differ and be one."""


@dataclass(frozen=True, eq=False)
class Schedule:
    """Steps of `step_s` from number `first` to `count`; `moving` says that the table itself moves, so that gravity is constant.

    A gravity is what acts for a whole step, m/s².
    """

    scene: Scene
    step_s: float
    first: int
    count: int

    @property
    def moving(self) -> bool:
        """Whether the table moves instead of the frame."""
        return self.scene.table == "moving"

    @cached_property
    def coarse(self) -> list[Vector]:
        """Gravity of every whole step that follows a whole step, from number `first` on."""
        middles = (np.arange(self.first, self.count) + 0.5) * self.step_s
        # From the middle of one step to that of the next; the first begins at its own instant, with half the time.
        edges_s = np.concatenate([[self.first * self.step_s], middles])
        share = np.diff(edges_s)[:, None] / self.step_s
        if self.moving:
            gravity = np.array([0.0, 0.0, -self.scene.gravity_m_s2]) * share
        else:
            gravity = apparent_gravity(self.scene, edges_s) * share
        return list(zip(*gravity.T.tolist(), strict=True))

    @cached_property
    def _jumps_s(self) -> list[float]:
        """Instants at which the floor's acceleration jumps, in order."""
        end_s = (self.count + 1) * self.step_s
        return sorted({float(t) for part in self.scene.base_excitation.parts for t in part.jumps_s(end_s)})

    def jump_after_s(self, kick_s: float) -> float:
        """The first instant after `kick_s` at which the floor's acceleration jumps; infinite for none."""
        # What is nearer is where the velocities stand already.
        number = bisect_right(self._jumps_s, kick_s + SAME_INSTANT * self.step_s)
        return self._jumps_s[number] if number < len(self._jumps_s) else math.inf

    def between(self, start_s: float, end_s: float, step_s: float) -> Vector:
        """Gravity of a step of `step_s` that takes velocities from `start_s` to `end_s`."""
        if end_s <= start_s:
            return 0.0, 0.0, 0.0
        pull = [0.0, 0.0, -self.scene.gravity_m_s2 * (end_s - start_s) / step_s]
        for (axis, after), (_, before) in zip(self._velocities(end_s), self._velocities(start_s), strict=True):
            pull[axis] -= (after - before) / step_s
        return pull[0], pull[1], pull[2]

    @cached_property
    def _velocities(self) -> Callable[[float], list[tuple[int, float]]]:
        """What gives, at a time, the axes along which the frame is accelerated, each with its motion's velocity, m/s."""
        parts = () if self.moving else self.scene.base_excitation.parts
        moving = [(axis, part.velocity_at) for axis, part in enumerate(parts) if not isinstance(part, ZeroExcitation)]

        # One step begins where the last one ended.
        @lru_cache(maxsize=2)
        def at(t_s: float) -> list[tuple[int, float]]:
            return [(axis, velocity(t_s)) for axis, velocity in moving]

        return at

    def table(self, t_s: float, kick_s: float, step_s: float) -> tuple[Vector, Vector]:
        """Displacement of a moving table at the start of a step, and its mean velocity in it; that of the instant `kick_s`, to
        which the step takes velocities, where this is not its middle: at impacts, and where the floor's acceleration jumps.
        """
        (here, there, _), (_, _, at_kick) = table_motion(self.scene, np.array([t_s, t_s + step_s, kick_s]))
        rate = (there - here) / step_s
        if abs(kick_s - t_s - 0.5 * step_s) > SAME_INSTANT * self.step_s or kick_s in self._jumps_s:
            rate = at_kick
        return (float(here[0]), float(here[1]), float(here[2])), (float(rate[0]), float(rate[1]), float(rate[2]))
