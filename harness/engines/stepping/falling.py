"""Whether a statue has overturned: the one definition, for contact engines of two and of three dimensions.

A run that reaches `OVERTURN_RAD` has overturned. So has one that ends beyond the balance point of the base it left, the vertical
through its centroid missing that base, and lies there or cannot come back (docs/model.md, section 2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.engines.stepping.columns import Trajectory
from harness.engines.stepping.frame import OVERTURN_COS
from harness.model.history import Outcome
from harness.model.scene import OVERTURN_RAD, Scene, Statue
from meshes.footprint import outward_sides

Array = NDArray[np.float64]

TOUCH_SHARE: Final = 1e-3
"""Share of the centroid's height within which a point as low as the lowest carries too: more than any contact's depth or slop."""
LOOKS: Final = 200
"""Samples after the last passage of the balance point at which it is asked what the statue is carried by."""
HILL_RAD: Final = 0.01
"""Rotation between two places at which the height of a hill ahead is looked up: 5e-5 of it may be missed."""
AXES: Final = ("roll", "pitch", "yaw")
REST_S: Final = 0.1
"""A statue is at rest when over this time it neither turns by REST_RAD nor keeps more than"""
REST_SHARE: Final = 1e-6
"""this share of its weight times the centroid's height as kinetic energy;"""
REST_RAD: Final = 1e-3
"""a body that turns back on a slope of 1 in 50 turns by as much."""


@dataclass(frozen=True)
class Fall:
    """The statue's fall: its side, when it passed its balance point for good and when it counts as overturned.

    `no_return_s` is None for a run that begins beyond the balance point. `overturn_s` is the time of `OVERTURN_RAD`, or the first
    at which a statue that ends lying had the rotation in which it lies; None while it still falls when the scene ends. `outcome`
    is `undecided` where it may yet come back; `whole` says that it reached `OVERTURN_RAD`, `lies` that it ends carried by a point
    further out than its centroid.
    """

    outcome: Outcome
    no_return_s: float | None
    overturn_s: float | None
    whole: bool = False
    lies: bool = False

    @property
    def across(self) -> bool:
        """Whether it fell across the rocking plane."""
        return self.outcome in (Outcome.OVERTURNED_FRONT, Outcome.OVERTURNED_BACK)


def fall(scene: Scene, motion: Trajectory, overturn_s: float | None) -> Fall | None:
    """How the statue fell in a motion up to its last sample, None when it ends over its base.

    `overturn_s` is when the rotation in the plane reached `OVERTURN_RAD`, None when it did not.
    """
    body = _Body.of(scene.statue, motion)
    if overturn_s is None and not body.excess_rad(_up(motion, -1))[0] > 0.0:
        return None
    up = _up(motion)
    first, no_return_s = last_outward(motion.t_s, body.excess_rad(up))
    if overturn_s is not None or up[-1, 2] <= OVERTURN_COS:
        return Fall(side_of(motion), no_return_s, overturn_s or float(motion.t_s[-1]), whole=True)
    looks = np.unique(np.linspace(first, len(up) - 1, LOOKS).round().astype(np.int64))
    carried = [body.carried(up[k]) for k in looks]
    if _rests(scene, motion, up, carried[-1]) or _cannot_return(scene, motion, body, up, carried=any(carried)):
        reached = _first_reach_s(motion.t_s[first:], _tilt_rad(up[first:])) if any(carried) else None
        return Fall(side_of(motion), no_return_s, reached, lies=carried[-1])
    return Fall(Outcome.UNDECIDED, no_return_s, None, lies=carried[-1])


def last_outward(t_s: Array, excess_rad: Array) -> tuple[int, float | None]:
    """First sample after the last outward crossing of zero and its interpolated time; 0 and None when all lie beyond."""
    inside = np.flatnonzero(excess_rad < 0.0)
    if inside.size == 0:
        return 0, None
    k = int(inside[-1])
    if k + 1 >= t_s.size:
        return k, float(t_s[-1])
    share = -excess_rad[k] / (excess_rad[k + 1] - excess_rad[k])
    return k + 1, float(t_s[k] + share * (t_s[k + 1] - t_s[k]))


def _first_reach_s(t_s: Array, tilt_rad: Array) -> float:
    """When a tilt first is as large as it is at the end."""
    k = int(np.flatnonzero(tilt_rad >= tilt_rad[-1])[0])
    if k == 0:
        return float(t_s[0])
    share = (tilt_rad[-1] - tilt_rad[k - 1]) / (tilt_rad[k] - tilt_rad[k - 1])
    return float(t_s[k - 1] + share * (t_s[k] - t_s[k - 1]))


@dataclass(frozen=True, eq=False)
class _Body:
    """The statue about its centroid: the outward normals (k, 2) of its base's sides, their distances (k,) from the centroid's
    vertical, and the points (n, 3) that a level support can touch; in the plane the two corners and the silhouette.
    """

    outward: Array
    distance_m: Array
    points_m: Array
    height_m: float
    spatial: bool

    @classmethod
    def of(cls, statue: Statue, motion: Trajectory) -> _Body:
        half = 0.5 * statue.depth_m
        flat = np.insert(statue.section_m, 1, 0.0, axis=1)
        outward, distance = np.array([[1.0, 0.0], [-1.0, 0.0]]), np.array([statue.corner_m(1), statue.corner_m(-1)])
        spatial = "roll_rad" in motion.extra
        if spatial:
            outward, distance = outward_sides(statue.footprint_m)
            flat = np.vstack([flat + np.array([0.0, y, 0.0]) for y in (half, -half)])
            flat = flat if statue.solid is None else statue.solid.vertices_m
        height = statue.centroid_height_m
        return cls(outward, np.maximum(distance, 0.0), flat - [0.0, 0.0, height], height, spatial)

    def excess_rad(self, up: Array) -> Array:
        """Tilt (n,) less the one at which the vertical through the centroid passes the base's outline."""
        level = np.hypot(up[:, 0], up[:, 1])
        facing = -up[:, :2] @ self.outward.T
        reach = np.full(facing.shape, np.inf)
        np.divide(self.distance_m * level[:, None], facing, out=reach, where=facing > 0.0)
        excess: Array = np.arctan2(level, up[:, 2]) - np.arctan2(np.min(reach, axis=1), self.height_m)
        return excess

    def hill_m(self, up: Array) -> float:
        """Height of the centroid at the lowest balance point by which it can come back: over the side it left, in space any."""
        left = self.distance_m if self.spatial else self.distance_m[-up[:2] @ self.outward.T > 0.0]
        return math.hypot(float(np.min(left)), self.height_m)

    def lowest_m(self, up: Array) -> float:
        """Height of the centroid over a level support in a pose."""
        return float(np.max(-self.points_m @ up))

    def carried(self, up: Array) -> bool:
        """Whether a point that touches lies further out than the centroid, so that its weight does not tip it on."""
        depth = -self.points_m @ up
        out = np.array([0.0, 0.0, 1.0]) - up[2] * up
        touching = depth >= depth.max() - TOUCH_SHARE * self.height_m
        return bool(np.max(self.points_m[touching] @ out) >= 0.0)


def _rests(scene: Scene, motion: Trajectory, up: Array, carried: bool) -> bool:
    """Whether the statue ends lying still on something beyond its base."""
    last = motion.t_s >= motion.t_s[-1] - REST_S
    still = float(np.ptp(_tilt_rad(up[last]))) <= REST_RAD
    weight = scene.statue.mass_kg * scene.gravity_m_s2 * scene.statue.centroid_height_m
    return carried and still and _kinetic_j(scene.statue, motion) <= REST_SHARE * weight


def _cannot_return(scene: Scene, motion: Trajectory, body: _Body, up: Array, *, carried: bool) -> bool:
    """Whether the energy that is left does not reach the balance point again, the floor being still or the statue lying.

    With more energy it does not come back either when it moves outwards, the floor is still and no hill ahead is higher than
    the one it passed: caught before such a hill it has less than the hill needs. Contacts only take energy.
    """
    still = scene.base_excitation.end_s <= motion.t_s[-1]
    hill, pose = body.hill_m(up[-1]), up[-1]
    weight = scene.statue.mass_kg * scene.gravity_m_s2
    if _kinetic_j(scene.statue, motion) + weight * _over_support_m(scene, motion) < weight * hill:
        return still or carried
    tilt = _tilt_rad(up[-2:])
    if not still or tilt[-1] <= tilt[0]:
        return False
    out = np.append(-pose[:2] / math.hypot(pose[0], pose[1]), 0.0)
    ahead = (math.cos(turn) * np.array([0.0, 0.0, 1.0]) - math.sin(turn) * out for turn in _between(float(tilt[-1])))
    return all(body.lowest_m(each) <= hill for each in ahead)


def _between(tilt_rad: float) -> Array:
    return np.linspace(tilt_rad, OVERTURN_RAD, 2 + int((OVERTURN_RAD - tilt_rad) / HILL_RAD))


def _over_support_m(scene: Scene, motion: Trajectory) -> float:
    """Height of the centroid over the floor, or over the pedestal's top, at the end."""
    height = float(motion.statue_xz_m[-1, 1])
    if scene.pedestal is None or motion.pedestal_xz_m is None:
        return height
    return height - float(motion.pedestal_xz_m[-1, 1]) - scene.pedestal.centroid_height_m


def _kinetic_j(statue: Statue, motion: Trajectory) -> float:
    """Kinetic energy at the last sample; in space at most this, turning taken with the largest moment of inertia."""
    from scipy.spatial.transform import Rotation

    speed2 = float(np.sum(motion.statue_rate_m_s[-1] ** 2))
    if "roll_rad" not in motion.extra:
        return 0.5 * (statue.mass_kg * speed2 + statue.inertia_kg_m2 * float(motion.theta_rate_rad_s[-1]) ** 2)
    # The columns in space are poses: their rates are those over the last step.
    step_s = float(motion.t_s[-1] - motion.t_s[-2]) if motion.t_s.size > 1 else math.inf
    turns = Rotation.from_euler("xyz", np.column_stack([motion.extra[f"{name}_rad"][-2:] for name in AXES]))
    spin = float((turns[-1] * turns[0].inv()).magnitude()) / step_s
    speed2 += float(np.diff(motion.extra["statue_y_m"][-2:]).sum() / step_s) ** 2
    return 0.5 * (statue.mass_kg * speed2 + float(np.linalg.eigvalsh(statue.inertia_tensor_kg_m2)[-1]) * spin**2)


def _up(motion: Trajectory, first: int = 0) -> Array:
    """The vertical (n, 3) in the statue's frame, from one sample on."""
    if "roll_rad" not in motion.extra:
        theta = motion.theta_rad[first:]
        return np.column_stack([-np.sin(theta), np.zeros_like(theta), np.cos(theta)])
    roll, pitch = motion.extra["roll_rad"][first:], motion.extra["pitch_rad"][first:]
    level = np.cos(pitch)
    return np.column_stack([-np.sin(pitch), level * np.sin(roll), level * np.cos(roll)])


def _tilt_rad(up: Array) -> Array:
    tilt: Array = np.arctan2(np.hypot(up[:, 0], up[:, 1]), up[:, 2])
    return tilt


def side_of(motion: Trajectory) -> Outcome:
    """To which side the statue's axis ends."""
    theta, across = float(motion.theta_rad[-1]), 0.0
    if "out_of_plane_rad" in motion.extra:
        across = float(motion.extra["out_of_plane_rad"][-1])
    if abs(math.sin(across)) > abs(math.cos(across) * math.sin(theta)):
        return Outcome.OVERTURNED_BACK if across > 0.0 else Outcome.OVERTURNED_FRONT
    return Outcome.OVERTURNED_RIGHT if theta > 0.0 else Outcome.OVERTURNED_LEFT
