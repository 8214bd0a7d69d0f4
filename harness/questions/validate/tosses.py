"""Measured tosses, and models against them: coefficients are fitted on a share, rotation and place scored on the others.

One line for each frame, from the hand to rest: `toss` (its name), `t_s`, the centroid's place `x_m, y_m, z_m` (z up), the
rotation from the body's axes to the table's `qw, qx, qy, qz`, the velocities of the centroid `vx_m_s, vy_m_s, vz_m_s` and about
the body's axes `wx_rad_s, wy_rad_s, wz_rad_s`, both as backward differences; as DAIRLab's contact-nets tells them, in SI units.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Final

import numpy as np
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from analytic import spatial
from analytic.block import rotation_matrices
from harness import engines
from harness.accuracy.refinement import simulate_with
from harness.model import (
    Answer,
    Array,
    Contact,
    Finding,
    History,
    Mistake,
    Pose,
    Scene,
    Statue,
    caution,
    info,
    refuse,
    require,
    rotations,
)
from harness.questions.validate.measured_set import MeasuredSet, Rows, by_name, read_groups, target_of, thrown
from harness.questions.validate.scenes import Model
from harness.records.validation import MeasuredRecord, MeasuredTable

PLACE: Final = ("x_m", "y_m", "z_m", "qw", "qx", "qy", "qz")
RATES: Final = ("vx_m_s", "vy_m_s", "vz_m_s", "wx_rad_s", "wy_rad_s", "wz_rad_s")
COLUMNS: Final = ("toss", "t_s", *PLACE, *RATES)
UNIT: Final = 1e-3
"""A measured quaternion's norm may be off by this much (six printed digits leave 1e-6); it is made exact."""
EVEN: Final = 1e-3
"""Share of a frame by which a frame's time may be off the even grid (six printed digits leave 1e-4)."""
FEWEST_FRAMES: Final = 3


@dataclass(frozen=True)
class CameraClock:
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


def read_tosses(path: Path, body: Statue, gravity_m_s2: float) -> tuple[list[Toss], CameraClock | None]:
    """All tosses of a table, stood on it by the body's outer points, begun as their flights say; and their clock, or None.

    Times are those of a clock by which free fall is gravity, where it is not within its error. Raises `InputError` with every
    mistake.
    """
    groups = read_groups(path, COLUMNS)
    refuse([Mistake(str(path), f"toss {name}", *why) for name, table in groups if (why := _wrong(table)) is not None])
    clock = clock_of([table for _, table in groups], body, gravity_m_s2)
    stretch = 1.0 if clock is None else clock.stated_hz / clock.rate_hz
    scale = np.array([stretch, *[1.0] * len(PLACE), *[1.0 / stretch] * len(RATES)])
    return [_stood(name, scale * table, body, gravity_m_s2) for name, table in groups], clock


def clock_of(tables: Sequence[Array], body: Statue, gravity_m_s2: float) -> CameraClock | None:
    """The clock by which the tosses' free falls are gravity: each flight's, weighed by what it knows; None of fewer than two."""
    flights = [table[: in_flight(body, table[:, 1:4], table[:, 4:8])] for table in tables]
    fits = [np.polyfit(each[:, 0], each[:, 3], 2, cov="unscaled") for each in flights if len(each) >= FEWEST_OF_FALL]
    if len(fits) < 2:
        return None
    falls, weights = np.array([(-2.0 * half, 0.25 / cov[0, 0]) for (half, *_), cov in fits]).T
    fall = float(np.average(falls, weights=weights))
    error = float(np.sqrt(np.sum((weights / np.sum(weights) * (falls - fall)) ** 2)))
    stated = 1.0 / float(np.mean([table[-1, 0] / (len(table) - 1) for table in tables]))
    off = fall > 0.0 and abs(fall - gravity_m_s2) > CLOCK_OFF * error and abs(fall / gravity_m_s2 - 1.0) < MOST_OFF
    return CameraClock(fall, error, stated, stated * float(np.sqrt(gravity_m_s2 / fall)) if off else stated)


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
    lowest = float(table[-1, 3] + np.min(body.outer_points_m @ rotation_matrices(turns[-1:])[0, 2]))
    places = table[:, 1:4] - np.array([0.0, 0.0, lowest])
    frame_s = float(table[-1, 0] / (len(table) - 1))
    # A backward difference is the velocity of half a frame before.
    velocity = table[0, 8:11] - [0.0, 0.0, 0.5 * gravity_m_s2 * frame_s]
    first = _pose(places[0], turns[0], velocity, table[0, 11:14])
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
    return _pose(pose.position_m + shift_m, now.as_quat()[[3, 0, 1, 2]], pose.velocity_m_s + push_m_s, rate)


def _pose(*parts: Array) -> Pose:
    """A pose of its place, quaternion, velocity and angular velocity as arrays."""
    return Pose(*(tuple(part.tolist()) for part in parts))


# One toss computed and scored: how far rotation and place are off at every frame.

STEPS_A_FRAME: Final = 8
"""Steps between two frames where no step is asked for: 0.84 ms at 148 Hz; four times as many change no median by a sixth
of itself, less than the fit of friction leaves open (docs/scores.md)."""
AFTER_IMPACT: Final = 8
"""Frames whose slope is a velocity, one stretch after the other from the first contact on: 0.05 s, before most bodies land
again; differences of two frames would drown in noise."""
TAKEN: Final = 1e-3
"""Metres, and entries of the rotation: some hundred times what an engine's contact settles in its first step."""


@dataclass(frozen=True)
class Coefficients:
    """What is fitted: friction, and the share of the normal velocity that an impact gives back (None: plastic)."""

    friction: float
    restitution: float | None = None


@dataclass(frozen=True, eq=False)
class Errors:
    """By frame (n,): angle between the computed and the measured rotation, distance of the centroids, mean distance of the
    body's outer points (what the two do together; fitted). `rate_m_s` (m,): mean distance of these points' velocities in each
    stretch after the first contact. Beyond `ended_s` the run's last pose is held.
    """

    rotation_rad: Array
    place_m: Array
    points_m: Array
    rate_m_s: Array
    ended_s: float | None = None


def scored(base: Scene, model: Model, coefficients: Sequence[Coefficients], toss: Toss) -> list[Errors | str]:
    """The errors of a toss with each pair of coefficients, or the sentence with which the engine failed."""
    engine, target = engines.load(model.engine), target_of(model, toss.frame_s, STEPS_A_FRAME)
    found: list[Errors | str] = []
    for item in coefficients:
        run = simulate_with(engine, scene_of(base, toss, item), target)
        if run.history is None:
            found.append(run.message or run.outcome.value)
        elif not began_as_asked(toss, base.statue, run.history):
            found.append("its start did not take: its first pose is another one")
        else:
            found.append(errors(toss, base.statue, run.history))
    return found


def began_as_asked(toss: Toss, body: Statue, history: History) -> bool:
    """Whether a run's first pose is the toss's start: one that is not says nothing of the toss."""
    turn, place = poses(body, history)
    apart = np.linalg.norm(place[0] - toss.start.position_m), np.linalg.norm(turn[0] - toss.start.rotation)
    return bool(max(apart) < TAKEN)


def scene_of(base: Scene, toss: Toss, item: Coefficients) -> Scene:
    """The body of a scene thrown as measured onto a still floor."""
    contact = Contact(base.contact.floor_static, base.contact.floor_kinetic, item.friction, item.restitution)
    return thrown(base, toss.start, contact, toss.end_s, toss.frame_s)


def errors(toss: Toss, body: Statue, history: History) -> Errors:
    """A computed pose history beside the measured one, frame by frame."""
    turn, place = poses(body, history)
    count = len(toss.places_m)
    # A frame that a run did not reach counts too: a model must not gain by giving up.
    reached = np.minimum(np.arange(count), len(turn) - 1)
    turn, place = turn[reached], place[reached]
    measured, seen = rotation_matrices(toss.quaternions), toss.places_m
    angle = np.asarray((_rotations(toss.quaternions).inv() * Rotation.from_matrix(turn)).magnitude())
    points = body.outer_points_m
    shift = place - seen
    moved = points @ np.swapaxes(turn - measured, 1, 2) + shift[:, None, :]
    end_s = float(history.t_s[-1])
    ended_s = end_s if end_s < toss.end_s - 0.5 * toss.frame_s else None
    size = min(AFTER_IMPACT, count)
    first = min(toss.contact + 1, count - size)
    stretches = moved[first : first + (count - first) // size * size].reshape(-1, size, *moved.shape[1:])
    since = np.arange(size) - 0.5 * (size - 1)
    slopes = np.einsum("n,mnpk->mpk", since, stretches) / (toss.frame_s * float(since @ since))
    rate = np.mean(np.linalg.norm(slopes, axis=2), axis=1)
    return Errors(angle, np.linalg.norm(shift, axis=1), np.mean(np.linalg.norm(moved, axis=2), axis=1), rate, ended_s)


def poses(body: Statue, history: History) -> tuple[Array, Array]:
    """Rotations (n, 3, 3) and centroids (n, 3) from the columns that every engine of three dimensions records."""
    turn = rotations(history.extra)
    corner = np.stack([history.extra[f"corner_right_{axis}_m"] for axis in "xyz"], axis=1)
    return turn, corner - turn @ np.array([body.corner_right_m, 0.0, -body.centroid_height_m])


def quartiles(values: Sequence[float] | Array) -> list[float]:
    """Lower quartile, median and upper quartile."""
    return [float(each) for each in np.percentile(np.asarray(values), [25.0, 50.0, 75.0])]


TOSS_ENGINES: Final = ("spatial", "pybullet", "pybullet:plain")
FRICTIONS: Final = (0.10, 0.13, 0.15, 0.17, 0.18, 0.19, 0.20, 0.21, 0.23, 0.26, 0.30)
"""Coefficients tried: plastic on wood lies between 0.1 and 0.3."""
RESTITUTIONS: Final = (0.05, 0.1, 0.2, 0.4)
"""Both are looked through first; from the best of them the fit goes downhill, by at most so many"""
EVALUATIONS: Final = 24
TRAJECTORY, VELOCITIES = "trajectory", "impact_velocities"
"""What a fit looks at: the points at all frames, or their velocities after impacts."""
PUBLISHED: Final = (
    ("Drake", "published", None, None, 13.5, 8.2, 16.5, 20.0),
    ("Bullet", "published", None, None, 14.9, 8.9, 16.5, 20.2),
    ("MuJoCo", "published", None, None, 25.1, 10.8, 21.7, 21.4),
)
"""On DAIRLab's cube tosses, by Acosta, Yang and Posa (RA-L 2022, arXiv 2110.00541)."""
PUBLISHED_WIDTH_M: Final = 0.1048
OVER_TIME_S: Final = 0.1
"""Errors over time are told at every so many seconds."""

MEANS: Final = (
    "model", "fitted_on", "friction", "restitution", "place_percent", "place_sd_percent", "rotation_deg", "rotation_sd_deg",
)  # fmt: skip
TABLES: Final = {
    "means": MEANS,
    "poses": (
        "model", "at_s", "tosses", "rotation_low_rad", "rotation_median_rad", "rotation_high_rad", "place_low_m",
        "place_median_m", "place_high_m",
    ),
    # Missed: m at the median of all frames, or m/s at the median of all stretches after the first contact.
    "losses": ("model", "fitted_on", "along", "friction", "restitution", "missed"),
    "tosses": ("model", "toss", "rotation_rad", "end_rotation_rad", "end_place_m"),
}  # fmt: skip


def scored_tosses(measured: MeasuredSet) -> MeasuredRecord:
    """How far each model's rotations and places are off, with the friction and restitution with which it comes nearest.

    Raises `InputError` for a wrong table or model.
    """
    base, models = measured.base, measured.asked(TOSS_ENGINES)
    tosses, clock = read_tosses(measured.table, base.statue, base.gravity_m_s2)
    require(len(tosses) >= 2, str(measured.table), "two tosses: one to fit, one to score", str(len(tosses)))
    # How many runs a fit takes is not known before.
    measured.on_progress(0, 0)
    fitting, rest = ([tosses[k] for k in numbers] for numbers in measured.shares(len(tosses)))
    rows: dict[str, Rows] = {name: [] for name in TABLES}
    found = [] if clock is None or clock.rate_hz == clock.stated_hz else [caution("clock_calibrated", **vars(clock))]
    low_m, median_m, high_m = quartiles([toss.raised_m for toss in tosses])
    found.append(info("tosses_raised", low_m=low_m, median_m=median_m, high_m=high_m))
    for model in models:
        for fitted_on in (TRAJECTORY, VELOCITIES):
            found += _score(measured, model, fitted_on, fitting, rest, rows)
    answer = _answer(rows["means"], len(models))
    if abs(_width_m(base) - PUBLISHED_WIDTH_M) < 1e-4:
        rows["means"] += PUBLISHED
    tables = [MeasuredTable(name, columns, rows[name]) for name, columns in TABLES.items()]
    return measured.told(title=f"{len(tosses)} measured tosses", answer=answer, tables=tables, findings=found)


def _width_m(base: Scene) -> float:
    return base.statue.corner_left_m + base.statue.corner_right_m


def _answer(means: Rows, asked: int) -> Answer:
    """Which model's places are nearest at the mean of all trajectories."""
    known = [dict(zip(MEANS, row, strict=True)) for row in means if row[1] == TRAJECTORY]
    best = min(known, key=lambda row: float(row["place_percent"] or 0.0), default=None)
    if best is None:
        return Answer("no_answer", [info("no_answer", asked=asked)])
    share, share_sd = (0.01 * float(best[name] or 0.0) for name in ("place_percent", "place_sd_percent"))
    turn, turn_sd = (math.radians(float(best[name] or 0.0)) for name in ("rotation_deg", "rotation_sd_deg"))
    values = {"place_share": share, "place_share_sd": share_sd, "rotation_rad": turn, "rotation_rad_sd": turn_sd}
    return Answer("tosses", [info("tosses_nearest", model=best["model"], **values)])


def _score(
    measured: MeasuredSet,
    model: Model,
    fitted_on: str,
    fitting: Sequence[Toss],
    rest: Sequence[Toss],
    rows: dict[str, Rows],
) -> list[Finding]:
    """What is fitted for a model on one thing, and its scores on the tosses that are left, added to the tables' rows."""

    def computed(tosses: Sequence[Toss], items: Sequence[Coefficients]) -> dict[str, list[Errors | str]]:
        found = by_name(measured.pool, partial(scored, measured.base, model, items), tosses)
        return {
            name: each if isinstance(each, list) else [f"the engine's process died: {each}"] * len(items)
            for name, each in found.items()
        }

    def losses(items: Sequence[Coefficients]) -> list[float]:
        answers = computed(fitting, items)
        return [_missed(fitted_on, fitting, [each[k] for each in answers.values()]) for k in range(len(items))]

    best, tried = least(losses)
    rows["losses"] += [[model.name, fitted_on, *row] for row in tried]
    answers = computed(rest, [best])
    known = {name: item for name, (item,) in answers.items() if isinstance(item, Errors)}
    if known:
        means = _means(list(known.values()), _width_m(measured.base))
        rows["means"].append([model.name, fitted_on, best.friction, best.restitution or 0.0, *means])
    if fitted_on != TRAJECTORY:
        return []
    rows["poses"] += [[model.name, *row] for row in _poses(known, rest)]
    for name, item in known.items():
        turned = float(np.median(item.rotation_rad)), float(item.rotation_rad[-1])
        rows["tosses"].append([model.name, name, *turned, float(item.place_m[-1])])
    lost, ended = len(answers) - len(known), sum(item.ended_s is not None for item in known.values())
    failed = [caution("tosses_failed", model=model.name, count=lost)] if lost else []
    return failed + ([info("tosses_ended", model=model.name, count=ended)] if ended else [])


def _means(errors: Sequence[Errors], width_m: float) -> list[float]:
    """Over tosses, mean and standard deviation of each one's mean over its frames: place in % of a width, rotation in degrees."""
    places = [100.0 * float(np.mean(each.place_m)) / width_m for each in errors]
    turns = [math.degrees(float(np.mean(each.rotation_rad))) for each in errors]
    return [float(of(values)) for values in (places, turns) for of in (np.mean, np.std)]


def least(losses: Callable[[Sequence[Coefficients]], list[float]]) -> tuple[Coefficients, Rows]:
    """The coefficients of least loss, and all that is told of the way there: a coarse look, then downhill from its best."""
    plastic = losses([Coefficients(friction) for friction in FRICTIONS])
    friction = FRICTIONS[int(np.argmin(plastic))]
    bounced = losses([Coefficients(friction, each) for each in RESTITUTIONS])
    by_restitution = {0.0: min(plastic), **dict(zip(RESTITUTIONS, bounced, strict=True))}
    tried = [("friction", each, 0.0, missed) for each, missed in zip(FRICTIONS, plastic, strict=True)]
    tried += [("restitution", friction, each, missed) for each, missed in by_restitution.items()]
    first = np.array([friction, min(by_restitution, key=lambda each: by_restitution[each])])
    # An engine that cannot bounce has its friction fitted alone.
    free = 2 if np.isfinite(bounced).any() else 1
    simplex = first[:free] + np.array([[0.0, 0.0], [0.1 * friction, 0.0], [0.0, 0.03]])[: free + 1, :free]

    def at(point: Array) -> float:
        item = _coefficients(point)
        outside = float(np.sum(np.abs(point - [item.friction, item.restitution or 0.0][: point.size])))
        return losses([item])[0] + outside

    found = minimize(
        at,
        first[:free],
        method="Nelder-Mead",
        options={"initial_simplex": simplex, "maxfev": EVALUATIONS, "xatol": 1e-3, "fatol": 1e-5},
    )
    best = _coefficients(found.x)
    rows: Rows = [[*row[:3], row[3] if math.isfinite(row[3]) else None] for row in tried]
    return best, [*rows, ["fitted", best.friction, best.restitution or 0.0, float(found.fun)]]


def _coefficients(point: Array) -> Coefficients:
    """The coefficients at a point, or the nearest that there are."""
    friction = float(np.clip(point[0], 1e-3, 2.0))
    restitution = float(np.clip(point[1], 0.0, 1.0)) if point.size > 1 else 0.0
    return Coefficients(friction, restitution or None)


def _missed(fitted_on: str, tosses: Sequence[Toss], answers: Sequence[Errors | str]) -> float:
    """Median over all frames of the mean distance of the body's points, m, or over all stretches after the first contact of that
    of their velocities, m/s: infinite in a toss that could not be computed.
    """
    by_frame = fitted_on == TRAJECTORY
    missed = [
        (item.points_m if by_frame else item.rate_m_s)
        if isinstance(item, Errors)
        else np.full(len(toss.places_m) if by_frame else 1, np.inf)
        for toss, item in zip(tosses, answers, strict=True)
    ]
    return float(np.median(np.concatenate(missed)))


def _poses(known: dict[str, Errors], tosses: Sequence[Toss]) -> Rows:
    """Quartiles of rotation and place over all frames, at the end, and over time (s)."""
    if not known:
        return []
    every, frame_s = list(known.values()), {toss.name: toss.frame_s for toss in tosses}
    # Half a frame beyond the last the nearest one is still there.
    longest = max((len(item.rotation_rad) - 0.5) * frame_s[name] for name, item in known.items())
    turned, apart = (np.concatenate([getattr(item, name) for item in every]) for name in ("rotation_rad", "place_m"))
    rows: Rows = [["all_frames", len(every), *quartiles(turned), *quartiles(apart)]]
    last = [item.rotation_rad[-1] for item in every], [item.place_m[-1] for item in every]
    rows.append(["end", len(every), *quartiles(last[0]), *quartiles(last[1])])
    for time_s in np.arange(OVER_TIME_S, longest, OVER_TIME_S).tolist():
        at = {name: round(time_s / frame_s[name]) for name in known}
        there = [(item, at[name]) for name, item in known.items() if at[name] < len(item.rotation_rad)]
        errors = [item.rotation_rad[k] for item, k in there], [item.place_m[k] for item, k in there]
        rows.append([time_s, len(there), *quartiles(errors[0]), *quartiles(errors[1])])
    return rows
