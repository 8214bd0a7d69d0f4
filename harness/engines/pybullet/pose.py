"""The statue in its principal frame and as it starts, rotations as quaternions (x, y, z, w)."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import permutations

import numpy as np
from scipy.spatial.transform import Rotation

from harness.engines.pybullet import feet, mirror
from harness.engines.pybullet.feet import Rest
from harness.engines.stepping.step_log import Row, Vector
from harness.model import Array, Scene, Statue


@dataclass(frozen=True, eq=False)
class Setup:
    """The statue in its principal frame, origin at its centroid: `axes` (3, 3) as columns in the statue frame, `moments` (3,),
    `feet_m` (k, 3) and `hull_m` (n, 3); `rest` is its pose at rest, `start` its part of the row at t = 0.
    """

    axes: Array
    moments: Array
    feet_m: Array
    hull_m: Array
    rest: Rest
    start: Row
    mirrored: bool = False
    in_plane: bool = False

    @property
    def axis(self) -> Vector:
        """The statue's vertical axis in its principal frame."""
        return vector(self.axes[2])

    @property
    def flat(self) -> Setup:
        """All of a scene that mirrors itself, its bodies turning in the plane alone."""
        return replace(self, moments=mirror.locked(self.moments), in_plane=True)

    @property
    def halved(self) -> Setup:
        """The half of a scene that mirrors itself."""
        return replace(self.flat, feet_m=mirror.halved(self.feet_m), mirrored=True)


def prepare(scene: Scene) -> Setup:
    """Feet, hull, inertia, rest pose and start of a scene's statue."""
    statue = scene.statue
    moments, axes = principal(statue)
    centroid = np.array([0.0, 0.0, statue.centroid_height_m])
    hull = feet.hull_vertices(statue)
    # Any vertex can touch a wall, and the floor under a thrown body; else those that a lean brings down to a level support.
    touching = hull if scene.wall is not None or scene.initial.pose is not None else feet.touchable(statue)
    rest = feet.rest(statue)
    return Setup(
        axes, moments, (touching - centroid) @ axes, (hull - centroid) @ axes, rest, start(scene, touching, rest, axes)
    )


def principal(statue: Statue) -> tuple[Array, Array]:
    """Principal moments (3,), kg m², and axes (3, 3) as columns of the rotation nearest to none (exactly none if diagonal)."""
    tensor = statue.inertia_tensor_kg_m2
    off = tensor - np.diag(np.diag(tensor))
    if float(np.max(np.abs(off))) <= 1e-12 * float(np.trace(tensor)):
        return np.diag(tensor).copy(), np.eye(3)
    moments, axes = np.linalg.eigh(0.5 * (tensor + tensor.T))
    order = max(permutations(range(3)), key=lambda item: float(np.sum(np.abs(np.diag(axes[:, list(item)])))))
    moments, axes = moments[list(order)], axes[:, list(order)]
    axes = axes * np.where(np.diag(axes) < 0.0, -1.0, 1.0)
    if np.linalg.det(axes) < 0.0:
        axes[:, 2] = -axes[:, 2]
    return moments, axes


def start(scene: Scene, feet_m: Array, rest: Rest, axes: Array) -> Row:
    """The statue's part of the first row: at rest on its facet, or turned from upright by the rotation that the scene gives.

    The lowest foot touches the support; the centroid of an upright statue stands over the origin. Where the scene gives a pose,
    that.
    """
    statue, initial = scene.statue, scene.initial
    if initial.pose is not None:
        turn, spin = initial.pose.rotation, np.array(initial.pose.angular_velocity_rad_s)
        pose = initial.pose
        return (*pose.position_m, *quaternion(turn @ axes), *pose.velocity_m_s, *vector(turn @ spin))
    height = 0.0 if scene.pedestal is None else scene.pedestal.height_m
    centroid = np.array([0.0, 0.0, statue.centroid_height_m])
    stands = rest.rotation if initial.theta_rad == 0.0 else np.eye(3)
    rested, turned = feet_m @ stands.T, about_y(initial.theta_rad) @ stands
    side = math.copysign(1.0, initial.theta_rad if initial.theta_rad != 0.0 else initial.theta_rate_rad_s)
    turned_feet_m = feet_m @ turned.T
    low = turned_feet_m[:, 2] - side * 1e-9 * turned_feet_m[:, 0]
    pivot = int(np.argmin(low))
    shift = rested[pivot] - turned_feet_m[pivot]
    shift[2] = height - turned_feet_m[pivot, 2]
    place = turned @ centroid + shift
    rate = np.array([0.0, initial.theta_rate_rad_s, 0.0])
    velocity = np.cross(rate, place - (turned_feet_m[pivot] + shift))
    return (*vector(place), *quaternion(turned @ axes), *vector(velocity), *vector(rate))


def vector(values: Array) -> Vector:
    """Three numbers of an array, plain."""
    return float(values[0]), float(values[1]), float(values[2])


def about_y(theta_rad: float) -> Array:
    """Rotation (3, 3) that tips z towards +x: the planar rotation θ."""
    cos, sin = math.cos(theta_rad), math.sin(theta_rad)
    return np.array([[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]])


def quaternion(rotation: Array) -> tuple[float, float, float, float]:
    """Quaternion (x, y, z, w), w ≥ 0, of a rotation matrix (3, 3)."""
    x, y, z, w = Rotation.from_matrix(rotation).as_quat(canonical=True).tolist()
    return x, y, z, w
