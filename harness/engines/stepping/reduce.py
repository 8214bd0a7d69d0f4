"""From a contact engine's trajectory to the record of its run."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Final, get_args

import numpy as np
from numpy.typing import NDArray

from harness.engines.stepping import support
from harness.engines.stepping.support import Corners, check_friction, friction_is_known, plain_spells
from harness.engines.stepping.trajectory import OVERTURN_COS, Trajectory
from harness.model import (
    OVERTURN_RAD,
    Array,
    Finding,
    History,
    Intervention,
    Outcome,
    Pattern,
    PatternName,
    Pedestal,
    Run,
    Scene,
    Statue,
    block_of,
    caution,
    hermites,
    info,
    keywords,
    number,
    output_grid,
    rotations,
)
from harness.statics.standstill import tipping_of_pedestal

if TYPE_CHECKING:
    from analytic import Block


# Whether a statue has overturned: the one definition, for contact engines of two and of three dimensions.
#
# A run that reaches `OVERTURN_RAD` has overturned. So has one that ends beyond the balance point of the base it left, the
# vertical through its centroid missing that base, and lies there or cannot come back (docs/model.md, section 2).


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
        return Fall(Outcome.UNDECIDED, None, None) if _may_tip_over(scene, motion) else None
    up = _up(motion)
    excess = body.excess_rad(up)
    if scene.pedestal is not None:
        # It may pass with its pedestal as one body the balance of both before its own.
        excess = np.maximum(excess, tilt_share(scene, scene.pedestal, motion.tilt_rad)[0] - 1.0)
    first, no_return_s = last_outward(motion.t_s, excess)
    if overturn_s is not None or up[-1, 2] <= OVERTURN_COS:
        return Fall(side_of(motion), no_return_s, overturn_s or float(motion.t_s[-1]), whole=True)
    looks = np.unique(np.linspace(first, len(up) - 1, LOOKS).round().astype(np.int64))
    carried = [body.carried(up[k]) for k in looks]
    if _rests(scene, motion, up, carried[-1]) or _cannot_return(scene, motion, body, up, carried=any(carried)):
        # First as far over as it ends.
        tilt = _tilt_rad(up[first:])
        lies_s = _passed_s(motion.t_s[first:], tilt, int((tilt >= tilt[-1]).argmax()), tilt[-1])
        return Fall(side_of(motion), no_return_s, lies_s if any(carried) else None, lies=carried[-1])
    return Fall(Outcome.UNDECIDED, no_return_s, None, lies=carried[-1])


def tilt_share(scene: Scene, pedestal: Pedestal, tilt_rad: Array) -> tuple[Array, Array]:
    """A pedestal's tilt (n,) over the one at which it and the statue balance as one body, and that one's tangent (n,)."""
    statue = scene.statue
    sides = tipping_of_pedestal(statue.mass_kg, statue.centroid_height_m, statue.base_centre_m, pedestal)
    tangent = np.where(tilt_rad > 0.0, sides[0, 1], sides[0, -1])
    return np.divide(np.abs(tilt_rad), np.arctan(tangent), out=np.ones_like(tilt_rad), where=tangent > 0.0), tangent


def _may_tip_over(scene: Scene, motion: Trajectory) -> bool:
    """Whether a pedestal that ends tipped is beyond its balance with the statue on it, or over still ground may yet pass it."""
    stone, statue, tilt = scene.pedestal, scene.statue, motion.tilt_rad[-1:]
    if stone is None or abs(tilt[0]) <= IN_PLANE_RAD:
        return False
    (share,), (tangent,) = tilt_share(scene, stone, tilt)
    still = scene.base_excitation.end_s <= motion.t_s[-1]
    high_m = stone.height_m + statue.centroid_height_m
    moment = statue.mass_kg * high_m + stone.mass_kg * stone.centroid_height_m
    begun = statue.mass_kg * (float(motion.statue_xz_m[0, 1]) - high_m)
    left_j = float(support.energy_j(scene, motion)[-1]) + scene.gravity_m_s2 * begun
    return bool(share >= 1.0 or (still and left_j >= scene.gravity_m_s2 * moment * (math.hypot(1.0, tangent) - 1.0)))


def last_outward(t_s: Array, excess_rad: Array) -> tuple[int, float | None]:
    """First sample after the last outward crossing of zero and its interpolated time; 0 and None when all lie beyond."""
    inside = np.flatnonzero(excess_rad < 0.0)
    if inside.size == 0:
        return 0, None
    k = int(inside[-1]) + 1
    return (k, _passed_s(t_s, excess_rad, k)) if k < t_s.size else (k - 1, float(t_s[-1]))


def _passed_s(t_s: Array, values: Array, k: int, level: float = 0.0) -> float:
    """When values pass a level on a straight line to sample `k`; the first time where there is none before it."""
    if k == 0:
        return float(t_s[0])
    share = (level - values[k - 1]) / (values[k] - values[k - 1])
    return float(t_s[k - 1] + share * (t_s[k] - t_s[k - 1]))


@dataclass(frozen=True, eq=False)
class _Body:
    """The statue about its centroid: of each of its base's sides (k, 3) the normal of the plane through it and the centroid, as
    long as the side is far from the centroid, and the points (n, 3) that a level support can touch; in the plane the two outer
    vertices and the silhouette.
    """

    sides_m: Array
    points_m: Array
    height_m: float
    spatial: bool

    @classmethod
    def of(cls, statue: Statue, motion: Trajectory) -> _Body:
        half, height = 0.5 * statue.depth_m, statue.centroid_height_m
        flat = np.insert(statue.section_m, 1, 0.0, axis=1)
        left_m, right_m = (height - statue.profile_m[k][1] for k in (0, -1))
        sides = np.array([[right_m, 0.0, statue.corner_right_m], [-left_m, 0.0, statue.corner_left_m]])
        spatial = "roll_rad" in motion.extra
        if spatial:
            corner = statue.footprint_m - [0.0, 0.0, height]
            edge = np.roll(corner, -1, axis=0) - corner
            sides = np.cross(corner, edge) / np.linalg.norm(edge, axis=1, keepdims=True)
            flat = np.vstack([flat + np.array([0.0, y, 0.0]) for y in (half, -half)])
            flat = flat if statue.solid is None else statue.solid.vertices_m
        return cls(sides, flat - [0.0, 0.0, height], height, spatial)

    def excess_rad(self, up: Array) -> Array:
        """Tilt (n,) less the one at which the vertical through the centroid passes the base's outline."""
        level = np.hypot(up[:, 0], up[:, 1])
        facing = -up[:, :2] @ self.sides_m[:, :2].T
        reach = np.full(facing.shape, np.inf)
        np.divide(np.maximum(self.sides_m[:, 2], 0.0) * level[:, None], facing, out=reach, where=facing > 0.0)
        return np.asarray(np.arctan2(level, up[:, 2]) - np.arctan(np.min(reach, axis=1)))

    def hill_m(self, up: Array) -> float:
        """Height of the centroid at the lowest balance point by which it can come back: over the side it left, in space any."""
        left = self.sides_m if self.spatial else self.sides_m[-self.sides_m[:, :2] @ up[:2] > 0.0]
        return float(np.linalg.norm(left, axis=1).min())

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
    count = 2 + int((OVERTURN_RAD - tilt[-1]) / HILL_RAD)
    ahead = np.linspace(tilt[-1], OVERTURN_RAD, count)[:, None]
    poses = np.cos(ahead) * [0.0, 0.0, 1.0] - np.sin(ahead) * out
    return all(body.lowest_m(each) <= hill for each in poses)


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
    return np.asarray(np.arctan2(np.hypot(up[:, 0], up[:, 1]), up[:, 2]))


def side_of(motion: Trajectory) -> Outcome:
    """To which side the statue's axis ends."""
    theta, across = float(motion.theta_rad[-1]), 0.0
    if "out_of_plane_rad" in motion.extra:
        across = float(motion.extra["out_of_plane_rad"][-1])
    if abs(math.sin(across)) > abs(math.cos(across) * math.sin(theta)):
        return Outcome.OVERTURNED_BACK if across > 0.0 else Outcome.OVERTURNED_FRONT
    return Outcome.OVERTURNED_RIGHT if theta > 0.0 else Outcome.OVERTURNED_LEFT


# Impacts, uplifts and motion patterns of a recorded rotation.

Ints = NDArray[np.int64]

REST_BAND_RAD: Final = 1e-5
"""Rotation within which a statue that rests on all its feet is left by the contact's slop, where impacts are located."""
THROUGH_SHARE: Final = 4.0
"""A statue that stays inside the band of rest longer than this many times its passage has come to rest in it."""
SHORTEST_PATTERN_S: Final = 2e-3
"""Shorter stretches of a pattern belong to the one before: a solver's chatter is no motion."""


@dataclass(frozen=True)
class Rocking:
    """Instants, s, of uplift from rest and of impact, and for each impact the rate after it over the one before."""

    uplift_times_s: tuple[float, ...]
    impact_times_s: tuple[float, ...]
    impact_ratios: tuple[float, ...]


def rocking(t_s: Array, theta_rad: Array, theta_rate_rad_s: Array, resolution_rad: float) -> Rocking:
    """Find the excursions of θ out of the band |θ| ≤ `resolution_rad`; each return is an impact, each start from rest an uplift.

    An instant of impact is extrapolated from the last sample outside the band; an instant of uplift from the first one, as the
    start of a power law that has its θ, θ̇ and θ̈.
    """
    starts, stops = _excursions(theta_rad, resolution_rad)
    uplifts: list[float] = []
    impacts: list[float] = []
    ratios: list[float] = []
    last = theta_rad.size - 1
    for index, (first, end) in enumerate(zip(starts, stops, strict=True)):
        previous = int(stops[index - 1]) if index else -1
        if first > 0 and (index == 0 or _rested(t_s, theta_rate_rad_s, previous, int(first), resolution_rad)):
            uplifts.append(_uplift_time(t_s, theta_rad, theta_rate_rad_s, int(first)))
        if end >= last:
            continue
        # The band may hold samples on the way: the impact lies before the first that is back or beyond.
        back, next_first = int(end) + 1, int(starts[index + 1]) if index + 1 < starts.size else last
        while back < next_first and theta_rad[back] * theta_rad[end] > 0.0:
            back += 1
        following = min(back + 1, last)
        falls = theta_rad[end] * theta_rate_rad_s[end] < 0.0
        upright_s = t_s[end] - theta_rad[end] / theta_rate_rad_s[end] if falls else t_s[end + 1]
        impacts.append(float(min(upright_s, t_s[back])))
        before = _rate_at(impacts[-1], t_s, theta_rate_rad_s, int(end), int(end) - 1)
        after = _rate_at(impacts[-1], t_s, theta_rate_rad_s, following, following + 1)
        ratios.append(after / before if before != 0.0 else 0.0)
    return Rocking(tuple(uplifts), tuple(impacts), tuple(ratios))


def _excursions(theta_rad: Array, band: float) -> tuple[Ints, Ints]:
    """First and last sample of each stretch on one side outside the band."""
    side = np.where(theta_rad > band, 1, np.where(theta_rad < -band, -1, 0))
    edges = np.flatnonzero(np.diff(side)) + 1
    starts = np.concatenate([[0], edges]).astype(np.int64)
    stops = np.concatenate([edges - 1, [side.size - 1]]).astype(np.int64)
    out = side[starts] != 0
    return starts[out], stops[out]


def _rested(t_s: Array, rate: Array, end: int, first: int, band: float) -> bool:
    speed = max(abs(float(rate[end])), 1e-12)
    passage = 2.0 * band / speed + 3.0 * float(t_s[min(end + 1, t_s.size - 1)] - t_s[end])
    return float(t_s[first] - t_s[end]) > THROUGH_SHARE * passage


def _rate_at(time_s: float, t_s: Array, rate: Array, sample: int, beside: int) -> float:
    """The rate on one side of an impact, gone on with from two samples there."""
    if not 0 <= beside < t_s.size:
        return float(rate[sample])
    slope = (rate[sample] - rate[beside]) / (t_s[sample] - t_s[beside])
    return float(rate[sample] + slope * (time_s - t_s[sample]))


def _uplift_time(t_s: Array, theta: Array, rate: Array, first: int) -> float:
    k = min(first + 1, t_s.size - 2)
    if theta[k] * rate[k] <= 0.0 or k < 1:
        return float(t_s[first])
    accel = (rate[k + 1] - rate[k - 1]) / (t_s[k + 1] - t_s[k - 1])
    curvature = float(theta[k] * accel / rate[k] ** 2)
    # θ = c τⁿ has θ θ̈/θ̇² = 1 − 1/n: 2 for a jump of the acceleration, 3 for a ramp.
    power = float(np.clip(1.0 / max(1.0 - curvature, 1e-9), 1.0, 4.0))
    return float(max(t_s[k] - power * theta[k] / rate[k], 0.0))


def patterns(
    motion: Trajectory, slid_m: Array, resolution_rad: float, stuck_below_m_s: Array | float
) -> tuple[Pattern, ...]:
    """The stretches of rest, rocking, sliding of the pedestal and both, in any direction, and those in which the statue slides on
    its support; `slid_m` is its slip."""
    t_s, still = motion.t_s, np.zeros_like(motion.t_s)
    across_rad, across_m = (motion.extra.get(name, still) for name in ("out_of_plane_rad", "pedestal_y_m"))
    rocks = np.maximum(np.abs(motion.theta_rad), np.abs(across_rad - across_rad[0])) > resolution_rad
    code = rocks + 2 * ((np.abs(motion.slip_rate_m_s) > stuck_below_m_s) | support.moves(t_s, across_m))
    code[support.statue_slides(t_s, slid_m)[1]] = 4
    # Passing upright is no rest: a short stay in the band between two sides of rocking is rocking.
    names = get_args(PatternName)
    edges = np.concatenate([[0], np.flatnonzero(np.diff(code)) + 1, [code.size - 1]])
    found: list[Pattern] = []
    for start, stop in pairwise(edges):
        name = names[int(code[start])]
        begin, end = float(t_s[start]), float(t_s[stop])
        if found and (found[-1].name == name or end - begin < SHORTEST_PATTERN_S):
            found[-1] = Pattern(found[-1].start_s, end, found[-1].name)
        elif end > begin:
            found.append(Pattern(begin, end, name))
    return tuple(found)


# How a run ends whose statue still moves over still ground: by the rule of the analytic model, from the state in which it ends.
# Once the floor is at rest the energy decides (docs/model.md, section 7), in the model and in an engine alike: the engine's
# last state, in the rocking plane and on a vertex of its base, is asked of the same compiled rule by which the model ends its
# own runs.

IN_PLANE_RAD: Final = 0.01
"""A body that leaves the plane, has turned about the vertical or stands on a support that tilts by less rocks as the model's."""
ON_SUPPORT: Final = 1e-3
"""Share of the centroid's height by which the vertex it stands on may be off its support: more than a contact's depth or slop."""
NO_TIME_S: Final = 1e-9
"""Length of a run in which nothing but the rule is asked, and what rounding leaves of a duration."""


def by_energy(scene: Scene, motion: Trajectory, at: Corners, still_m_s: float) -> tuple[Outcome, float] | None:
    """Outcome and largest rotation, rad, of what follows the last sample; None for an end that is not the model's.

    The model's: over still ground, in the plane, on a vertex of the base. `at`: where the statue is on its support; `still_m_s`:
    the velocity below which the pedestal rests. One that slides drains energy: what leans beyond its balance then is `undecided`.
    """
    from analytic import AnalyticInputError, Rest, simulate

    lean, rate, block = float(at.lean_rad[-1]), float(motion.theta_rate_rad_s[-1]), block_of(scene)
    if not (_ends_in_plane(scene, motion) and _stands(block, at)):
        return None
    if abs(float(motion.slip_rate_m_s[-1])) > still_m_s:
        over = abs(lean) > block.alpha_rad(1 if lean > 0.0 else -1)
        return Outcome.UNDECIDED if over else Outcome.STANDS, 0.0
    given = keywords(scene)
    wall = given.get("wall")
    if wall is not None:
        given["wall"] = replace(wall, distance_m=wall.distance_m - wall.sign * float(motion.slip_m[-1]))
    given |= {"theta0_rad": lean, "theta_rate0_rad_s": rate, "duration_s": NO_TIME_S, "dt_s": None, "events": False}
    try:
        found = simulate(block, Rest(), **given)
    except AnalyticInputError:  # at the overturning limit already
        return None
    return Outcome(found.outcome.value), found.peak_theta_rad


def _ends_in_plane(scene: Scene, motion: Trajectory) -> bool:
    """Whether the scene's end was reached over still ground, with nothing turned out of the plane."""
    last_s = float(motion.t_s[-1])
    if scene.initial.pose is not None or not scene.base_excitation.end_s <= last_s >= scene.duration_s - NO_TIME_S:
        return False
    turned = [motion.extra[name] for name in ("out_of_plane_rad", "yaw_rad") if name in motion.extra]
    return max(abs(float(each[-1])) for each in (*turned, motion.tilt_rad)) <= IN_PLANE_RAD


def _stands(block: Block, at: Corners) -> bool:
    """Whether the vertex of the base about which the model would turn is on the support."""
    lean, height = float(at.lean_rad[-1]), block.centroid_height_m
    x, z, facets = block.arrays
    k = int(np.searchsorted(facets, lean))
    off_m = float(at.centroid_z[-1]) + float(z[k] - height) * math.cos(lean) - float(x[k]) * math.sin(lean)
    return abs(off_m) <= ON_SUPPORT * height


@dataclass(frozen=True, eq=False)
class Report:
    """What the adapter knows of its own run: settings, counts, findings.

    `resolution_rad` is the rotation that the contact's slop leaves at rest; `stuck_below_m_s` the velocity that is rest.
    `rested` says that the run was ended at rest before the scene's end, so that the last state holds to it. `repeats` that a step
    in which the pedestal breaks loose is solved again. `coarser` is from when steps were longer, and how long, s.
    """

    engine: str
    settings: Mapping[str, object]
    steps: int
    wall_s: float
    resolution_rad: float
    stuck_below_m_s: float
    rested: bool = False
    with_history: bool = True
    validity: Mapping[str, object] = field(default_factory=dict)
    work: Mapping[str, int] = field(default_factory=dict)
    skipped: Mapping[str, float | None] = field(default_factory=dict)
    findings: Sequence[Finding] = ()
    labels: Sequence[str] = ()
    interventions: Mapping[str, Intervention] = field(default_factory=dict)
    repeats: bool = True
    coarser: tuple[float, float] = (math.inf, 0.0)


def reduce_trajectory(scene: Scene, trajectory: Trajectory, report: Report, *, wall_s: float | None = None) -> Run:
    """The whole record of a run; a trajectory that is not finite is `diverged`, without a history.

    The run ends at the overturning rotation, the same in every model, unless it begins from a pose in space; the time is
    interpolated between two samples. It ends at a wall, which it reaches at `wall_s` where that is known. Raises `LayerFault`
    where the floor's friction was not Coulomb's.
    """
    finite = (
        np.isfinite(trajectory.theta_rad) & np.isfinite(trajectory.theta_rate_rad_s) & np.isfinite(trajectory.slip_m)
    )
    if not finite.all():
        return _diverged(report, float(trajectory.t_s[int(np.flatnonzero(~finite)[0])]))
    end_s, overturn_s, until_s = _ending(scene, trajectory, report.rested)
    motion = trajectory.until(until_s, end_s)
    theta, rate = motion.theta_rad, motion.theta_rate_rad_s
    cycles = rocking(motion.t_s, theta, rate, report.resolution_rad)
    touch = None if wall_s is not None else support.wall_touch(scene, motion)
    wall_s = wall_s if touch is None else touch[1]
    inside = motion.t_s <= end_s
    peak = int(np.abs(np.where(inside, theta, 0.0)).argmax())
    at, impulses = support.corners(scene, motion), support.impulses(scene, motion)
    slip_m, gap_m = support.statue_slip_m(scene, at), support.gap_m(scene, at)
    slid_m, in_space = slip_m, dict[str, object]()
    if "out_of_plane_rad" in motion.extra:
        placed = on_support(motion)
        # As it rocks across the plane both corners rise, and not the statue.
        gap_m = np.minimum(gap_m, _clear_m(scene, placed[0], at))
        slid_m, in_space = moves_in_space(scene, motion, placed)
    plain = plain_spells(motion, slid_m, gap_m, at, scene.pedestal)
    if friction_is_known(scene, motion):
        account = report.interventions if report.repeats else None
        told_until_s = min(number(plain, "plain_from_s", math.inf), report.coarser[0])
        check_friction(scene, motion, impulses, told_until_s, report.stuck_below_m_s, account)
    fallen = fall(scene, motion, overturn_s)
    coarser_s, dt_s = report.coarser
    stuck_m_s = np.full(motion.t_s.size, report.stuck_below_m_s)
    if coarser_s < math.inf:
        # What longer steps leave at rest is more in proportion.
        stuck_m_s[motion.t_s > coarser_s] *= dt_s / number(report.settings, "dt_s")
    outcome, ahead_rad = _outcome(scene, motion, fallen, wall_s, slip_m, at, float(stuck_m_s[-1]))
    count, reached_s = touch or (0, 0.0)
    if outcome is Outcome.TOUCHES_WALL and count > 1 and reached_s > motion.t_s[count - 1]:
        # The run ends there, as the model's does: the sample after it is of the wall's impact.
        ended = trajectory.up_to(count, reached_s)
        return reduce_trajectory(scene, ended, replace(report, rested=False), wall_s=reached_s)
    if not outcome.overturned and overturn_s is None:
        fallen = None
    peak_rad, peak_s = float(abs(theta[peak])), float(motion.t_s[peak])
    if overturn_s is not None:
        peak_rad, peak_s = OVERTURN_RAD, overturn_s
    elif ahead_rad > peak_rad:
        peak_rad, peak_s = ahead_rad, end_s
    # A point beside the pedestal's top is not in it.
    over = gap_m if scene.pedestal is None else support.gap_m(scene, at, 0.5 * scene.pedestal.width_m)
    energy_j = support.energy_j(scene, motion)
    lost_j = support.energy_lost_j(scene, motion, energy_j)
    validity: dict[str, object] = {
        **support.force_limits(scene, motion, impulses),
        "statue_slip_m": float(np.abs(slid_m).max()),
        "statue_flight_m": float(max(gap_m.max(), 0.0)),
        "penetration_m": float(max(-over.min(), 0.0)),
        # The largest fall of what is lost: energy from nowhere.
        "energy_gained_j": float((np.maximum.accumulate(lost_j) - lost_j).max()),
        "impact_ratios": list(cycles.impact_ratios),
        **plain,
        **in_space,
    }
    if cycles.impact_times_s:
        validity["lost_in_impacts_j"] = support.lost_in_impacts_j(motion.t_s, lost_j, cycles.impact_times_s)
    if scene.pedestal is not None and "pedestal_tilt_rad" in motion.extra:
        validity["pedestal_tilt_rad"] = float(np.abs(motion.tilt_rad).max())
        validity["pedestal_tilt_share"] = float(tilt_share(scene, scene.pedestal, motion.tilt_rad)[0].max())
    # What an engine whose coefficient follows its own sliding does as an impact breaks the pedestal loose.
    two = scene.pedestal is not None and scene.contact.floor_kinetic < scene.contact.floor_static
    static = {"floor_impact": "static"} if two and not report.repeats else {}
    if wall_s is not None:
        validity["wall_touch_time_s"] = wall_s
    return Run(
        engine=report.engine,
        outcome=outcome,
        history=_history(scene, motion, slip_m, energy_j, impulses, end_s) if report.with_history else None,
        settings={**report.settings, **static},
        steps=report.steps,
        wall_s=report.wall_s,
        peak_theta_rad=peak_rad,
        peak_time_s=peak_s,
        end_s=end_s,
        overturn_time_s=None if fallen is None else fallen.overturn_s,
        no_return_time_s=None if fallen is None else fallen.no_return_s,
        impact_times_s=tuple(time for time in cycles.impact_times_s if time <= end_s),
        uplift_times_s=tuple(time for time in cycles.uplift_times_s if time <= end_s),
        peak_slip_m=float(np.abs(motion.slip_m).max()),
        residual_slip_m=float(np.interp(end_s, motion.t_s, motion.slip_m)),
        patterns=patterns(motion, slid_m, report.resolution_rad, stuck_m_s),
        validity=validity | dict(report.validity),
        work=report.work,
        skipped=report.skipped,
        findings=(*own_contact(scene), *_coarser(report.coarser, end_s), *report.findings),
        labels=report.labels,
        interventions=report.interventions,
    )


def _coarser(coarser: tuple[float, float], end_s: float) -> list[Finding]:
    from_s, dt_s = coarser
    return [info("coarser_steps", from_s=from_s, dt_s=dt_s)] if from_s < end_s else []


def own_contact(scene: Scene) -> list[Finding]:
    """Forms of the two-block model that an engine replaces by its own contact."""
    form = scene.form
    replaced = {
        "model.friction_normal": form.friction_normal == "static",
        "model.pedestal_at_impact": form.pedestal_at_impact == "unchanged" and scene.contact.restitution is None,
    }
    keys = [key for key, told in replaced.items() if told and scene.pedestal is not None]
    return [caution("own_contact", keys=keys)] if keys else []


def _diverged(report: Report, time_s: float) -> Run:
    return Run(
        engine=report.engine,
        outcome=Outcome.DIVERGED,
        history=None,
        settings=report.settings,
        steps=report.steps,
        wall_s=report.wall_s,
        peak_theta_rad=0.0,
        peak_time_s=0.0,
        end_s=time_s,
        message=f"the engine's numbers are not finite from {time_s:.6g} s",
        findings=report.findings,
        labels=report.labels,
        interventions=report.interventions,
    )


def _ending(scene: Scene, trajectory: Trajectory, rested: bool) -> tuple[float, float | None, int]:
    """End of the run, time of overturning or None, and the number of samples that belong to it."""
    t_s, size = trajectory.t_s, np.abs(trajectory.theta_rad)
    over = np.flatnonzero(size >= OVERTURN_RAD)
    # A body thrown through space has no upright to overturn from: its run goes on over any rotation.
    if over.size and scene.initial.pose is None:
        k = int(over[0])
        time = _passed_s(t_s, size, k, OVERTURN_RAD)
        if time <= scene.duration_s:
            return time, time, k + 1
    last = scene.duration_s if rested else min(float(t_s[-1]), scene.duration_s)
    count = int(np.searchsorted(t_s, last, side="left")) + 1
    return last, None, min(count, t_s.size)


def _outcome(
    scene: Scene,
    motion: Trajectory,
    fallen: Fall | None,
    wall_s: float | None,
    slip_m: Array,
    at: Corners,
    still_m_s: float,
) -> tuple[Outcome, float]:
    """What came first: the wall before a fall across the plane, the slide off the support before the balance point; else what
    the energy that is left gives. With the largest rotation, rad, of what it has yet to give.
    """
    passed_s = math.inf if fallen is None or fallen.no_return_s is None else fallen.no_return_s
    if wall_s is not None and (fallen is None or not fallen.across or wall_s <= passed_s):
        return Outcome.TOUCHES_WALL, 0.0
    if fallen is not None and fallen.whole:
        return fallen.outcome, 0.0
    until = int(np.searchsorted(motion.t_s[:-1], passed_s))
    if scene.pedestal is not None:
        middle_m = float(slip_m[until]) - scene.pedestal.offset_m
        if abs(middle_m) > 0.5 * scene.pedestal.width_m:
            return Outcome.LEFT_PEDESTAL, 0.0
    own = Outcome.STANDS if fallen is None else fallen.outcome
    ahead = None if fallen is not None and fallen.lies else by_energy(scene, motion, at, still_m_s)
    # The model knows no flank: one over which a statue that tips on may not come is asked of its own silhouette.
    if ahead is None or (own is Outcome.UNDECIDED and ahead[0] is side_of(motion)):
        return own, 0.0
    return ahead


def on_support(motion: Trajectory) -> tuple[Array, Array]:
    """The statue's rotations (n, 3, 3) and its right corner's places (n, 3), along its support; from a pedestal's centroid."""
    turn, tilt = rotations(motion.extra), motion.tilt_rad
    place = np.column_stack([motion.extra[f"corner_right_{k}_m"] for k in "xyz"])
    if motion.pedestal_xz_m is not None:
        place[:, ::2] -= motion.pedestal_xz_m
    cos, sin = np.cos(tilt), np.sin(tilt)
    for each in (place, *np.moveaxis(turn, 2, 0)):
        each[:, 0], each[:, 2] = cos * each[:, 0] - sin * each[:, 2], sin * each[:, 0] + cos * each[:, 2]
    return turn, place


def _clear_m(scene: Scene, turn: Array, at: support.Corners) -> Array:
    """Height (n,) of the base's lowest vertex above the support, by the statue's rotations (n, 3, 3) along it."""
    base = scene.statue.feet_m - np.array([0.0, 0.0, scene.statue.centroid_height_m])
    return np.asarray(at.centroid_z + (turn[:, 2] @ base.T).min(axis=1))


def _yaw_rad(turn: Array) -> Array:
    """Turn (n,) about the vertical of rotations (n, 3, 3): what is left once the axis is brought upright the shortest way."""
    return np.unwrap(np.arctan2(turn[:, 1, 0] - turn[:, 0, 1], turn[:, 0, 0] + turn[:, 1, 1]))


def _set_down_m(statue: Statue, turn: Array, yaw_rad: Array, corner_m: Array) -> Array:
    """Where (n, 2) the middle of the base would be on its support, set down flat about the foot that is lowest."""
    foot = statue.feet_m[(turn[:, 2] @ statue.feet_m.T).argmin(axis=1)]
    place = corner_m + np.einsum("tij,tj->ti", turn, foot - np.array([statue.corner_right_m, 0.0, 0.0]))
    middle_y_m = 0.5 * (statue.footprint_m[:, 1].min() + statue.footprint_m[:, 1].max())
    x, y = statue.base_centre_m - foot[:, 0], middle_y_m - foot[:, 1]
    cos, sin = np.cos(yaw_rad), np.sin(yaw_rad)
    arm = np.column_stack([cos * x - sin * y, sin * x + cos * y])
    return np.asarray(place[:, :2] + arm)


def _leans(scene: Scene, motion: Trajectory) -> dict[str, object]:
    """The largest leans, rad, from where the statue stood at first, across the plane and in any direction, and the largest as a
    share of the one at which it balances in its direction: less of a lean may be nearer to it.
    """
    columns, up = motion.extra, _up(motion)
    balance = _tilt_rad(up) - _Body.of(scene.statue, motion).excess_rad(up)
    # A body that is thrown leans from upright.
    first_rad = columns["out_of_plane_rad"][0] if scene.initial.pose is None else 0.0
    across = np.abs(columns["out_of_plane_rad"] - first_rad)
    lean = np.arccos(np.clip(np.cos(motion.theta_rad) * np.cos(across), -1.0, 1.0))
    nearest = int((lean / balance).argmax())
    return {
        "out_of_plane_rad": float(across.max()),
        "peak_lean_rad": float(lean.max()),
        "peak_lean_share": float(lean[nearest] / balance[nearest]),
        "peak_lean_balance_rad": float(balance[nearest]),
    }


def moves_in_space(scene: Scene, motion: Trajectory, placed: tuple[Array, Array]) -> tuple[Array, dict[str, object]]:
    """How far (n,) the statue, `placed` on its support as `on_support` has it, shifted there, turned with it, and what else the
    plane does not tell: leans in any direction, and how far pedestal and base turned and slid.
    """
    (turn, corner_m), leans, columns = placed, _leans(scene, motion), motion.extra
    yaw_rad = _yaw_rad(turn)
    base = _set_down_m(scene.statue, turn, yaw_rad, corner_m)
    shift, pedestal_y_m = base, np.zeros_like(motion.slip_m)
    if scene.pedestal is not None:
        pedestal_y_m, yaw = columns["pedestal_y_m"], columns["pedestal_yaw_rad"]
        x, y = base[:, 0], base[:, 1] - pedestal_y_m
        shift = np.column_stack([np.cos(yaw) * x + np.sin(yaw) * y, np.cos(yaw) * y - np.sin(yaw) * x])
    return np.hypot(*(shift - shift[0]).T), {
        **leans,
        "yaw_rad": float(np.abs(yaw_rad - yaw_rad[0]).max()),
        "pedestal_slip_m": float(np.hypot(motion.slip_m, pedestal_y_m).max()),
        "slip_across_m": float(np.abs(base[:, 1] - base[0, 1]).max()),
    }


def _history(
    scene: Scene, motion: Trajectory, statue_slip_m: Array, energy_j: Array, impulses: support.Impulses, end_s: float
) -> History:
    grid = output_grid(end_s, scene.output_dt_s) if end_s > 0.0 else np.zeros(1)
    t_s = motion.t_s
    columns = {"statue_slip_m": statue_slip_m, "energy_j": energy_j, **motion.extra}
    extra = {name: np.interp(grid, t_s, values) for name, values in columns.items()}
    loads = {"statue_force_x_n": impulses.statue_x, "statue_force_z_n": impulses.statue_z}
    if scene.pedestal is not None:
        loads |= {"floor_force_x_n": impulses.floor_x, "floor_force_z_n": impulses.floor_z}
    extra |= zip(loads, support.mean_forces(t_s, list(loads.values()), grid), strict=True)
    theta, slip = hermites(
        grid, t_s, ((motion.theta_rad, motion.theta_rate_rad_s), (motion.slip_m, motion.slip_rate_m_s))
    )
    return History(
        grid,
        theta,
        np.interp(grid, t_s, motion.theta_rate_rad_s),
        slip,
        np.interp(grid, t_s, motion.slip_rate_m_s),
        extra,
    )
