"""Where the statue stands on its support: slip, gap and penetration of its corners, and the wall."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.contact.trajectory import Trajectory
from harness.scene import Scene

Array = NDArray[np.float64]

CORNERS_ONLY_RAD: Final = 0.3
"""Below this lean a statue on a flat base is taken to touch with its corners only; above it every point is asked."""
FLAT_M: Final = 1e-9


def corner_xz_m(scene: Scene, trajectory: Trajectory, side: int) -> Array:
    """Place of the corner on that side (+1 right, −1 left) in the table's frame, shape (n, 2), for a planar pose."""
    statue = scene.statue
    x, z = side * statue.corner_m(side), -statue.centroid_height_m
    cos, sin = np.cos(trajectory.theta_rad), np.sin(trajectory.theta_rad)
    # θ turns clockwise: x' = x cos θ + z sin θ, z' = z cos θ − x sin θ.
    return trajectory.statue_xz_m + np.column_stack([x * cos + z * sin, z * cos - x * sin])


def statue_slip_m(scene: Scene, trajectory: Trajectory) -> Array:
    """Displacement of the standing corner along the support since t = 0, shape (n,): the model assumes none."""
    low = np.where(trajectory.theta_rad >= 0.0, 1, -1)
    right, left = (corner_xz_m(scene, trajectory, side)[:, 0] for side in (1, -1))
    base = scene.statue.corner_left_m + scene.statue.corner_right_m
    # Upright the corners are a base apart; the standing one tells where the base is.
    place = np.where(low > 0, right, left + base) - trajectory.slip_m
    start: Array = place - place[0]
    return start


def gap_m(scene: Scene, trajectory: Trajectory) -> Array:
    """Height of the lowest point above the support, shape (n,); negative: penetration. The support is taken as level.

    Near upright on a flat base the lowest point is a corner; leaning further, or on an uneven base, any point of the silhouette.
    """
    lowest = np.minimum(*(corner_xz_m(scene, trajectory, side)[:, 1] for side in (1, -1)))
    far = np.abs(trajectory.theta_rad) > CORNERS_ONLY_RAD if _flat(scene) else np.ones(lowest.size, dtype=bool)
    if np.any(far):
        theta, height = trajectory.theta_rad[far], trajectory.statue_xz_m[far, 1]
        cos, sin = np.cos(theta), np.sin(theta)
        least = np.full(theta.size, np.inf)
        for x, z in scene.statue.section_m:
            least = np.minimum(least, (z - scene.statue.centroid_height_m) * cos - x * sin)
        lowest[far] = height + least
    top = np.zeros_like(lowest)
    if scene.pedestal is not None and trajectory.pedestal_xz_m is not None:
        top = trajectory.pedestal_xz_m[:, 1] + scene.pedestal.centroid_height_m
    gap: Array = lowest - top
    return gap


def _flat(scene: Scene) -> bool:
    """Whether the silhouette has both corners at z = 0 and nothing below."""
    statue = scene.statue
    corners = np.array([[-statue.corner_left_m, 0.0], [statue.corner_right_m, 0.0]])
    apart = np.abs(statue.section_m[:, None, :] - corners[None, :, :]).sum(axis=2)
    return bool(np.all(apart.min(axis=0) <= FLAT_M) and np.min(statue.section_m[:, 1]) >= -FLAT_M)


def wall_touch(scene: Scene, trajectory: Trajectory) -> int | None:
    """First sample at which the statue's silhouette reaches the wall, None if it never does or there is no wall."""
    if scene.wall is None:
        return None
    statue, sign = scene.statue, scene.wall.sign
    reach = statue.corner_m(sign) + scene.wall.distance_m
    cos, sin = np.cos(trajectory.theta_rad), np.sin(trajectory.theta_rad)
    furthest = np.full(trajectory.t_s.size, -np.inf)
    for x, z in statue.section_m:
        along = x * cos + (z - statue.centroid_height_m) * sin
        furthest = np.maximum(furthest, sign * (trajectory.statue_xz_m[:, 0] + along))
    touching = np.flatnonzero(furthest >= reach)
    return int(touching[0]) if touching.size else None
