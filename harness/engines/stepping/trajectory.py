"""A run as numbers: rows of both bodies, what the table's motion does to them step by step, the log of a loop, its trajectory."""

from __future__ import annotations

import math
from array import array
from bisect import bisect_right
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from struct import Struct
from typing import Final, TypeVar

import numpy as np

from analytic.block import rotation_matrices
from analytic.excitation import ZeroExcitation
from harness.engines.base import LayerFault, Settings
from harness.model import OVERTURN_RAD, Array, Intervention, Scene, Statue, centroid_shift_m

# Rows of numbers: places, rotations and velocities of statue and pedestal at one instant, as the layer keeps them.

Row = tuple[float, ...]
"""Place (3), quaternion (x, y, z, w) of the principal frame, velocity (3) and angular velocity (3) of the statue, world axes,
and the same of the pedestal, if there is one."""
Vector = tuple[float, float, float]
Pair = tuple[float, float]
Impulse = tuple[Vector, Vector]
"""Impulse of a body's contacts in a step, N s, and its moment about the centroid, N m s, world axes."""

ALONE: Final = 13
"""Numbers in a row without a pedestal."""
STANDS_RAD: Final = 2e-5
"""A pedestal that leans by no more stands on its base: solver iterations leave up to 1e-6 rad, in a whole scene 8e-6 at 1 ms."""


def axis_of(row: Row, axis: Vector) -> Vector:
    """World components of the statue's vertical axis, given as `axis` in its principal frame."""
    x, y, z, w = row[3], row[4], row[5], row[6]
    a, b, c = axis
    return (
        (1.0 - 2.0 * (y * y + z * z)) * a + 2.0 * (x * y - z * w) * b + 2.0 * (x * z + y * w) * c,
        2.0 * (x * y + z * w) * a + (1.0 - 2.0 * (x * x + z * z)) * b + 2.0 * (y * z - x * w) * c,
        2.0 * (x * z - y * w) * a + 2.0 * (y * z + x * w) * b + (1.0 - 2.0 * (x * x + y * y)) * c,
    )


def base_velocity(half_m: Vector, places: Row, row: Row) -> tuple[float, float]:
    """Velocity along the floor, m/s, of what the pedestal of half dimensions `half_m` stands on, in the step that led from the
    row `places`, where its contact was solved, to a row: on its base that of its centroid, tipped that of its edge or corner.
    """
    u, v = row[20], row[21]
    a, b, c, d = places[16:20]
    # The vertical in the pedestal's frame: its lowest point lies against it.
    up_x, up_y = 2.0 * (a * c - b * d), 2.0 * (b * c + a * d)
    p, q, r = row[23:26]
    if abs(up_x) <= STANDS_RAD and abs(up_y) <= STANDS_RAD:
        return u - q * half_m[2], v + p * half_m[2]
    x = -math.copysign(half_m[0], up_x) if abs(up_x) > STANDS_RAD else 0.0
    y = -math.copysign(half_m[1], up_y) if abs(up_y) > STANDS_RAD else 0.0
    z = -half_m[2]
    arm_x = (1.0 - 2.0 * (b * b + c * c)) * x + 2.0 * ((a * b - c * d) * y + (a * c + b * d) * z)
    arm_y = 2.0 * ((a * b + c * d) * x + (b * c - a * d) * z) + (1.0 - 2.0 * (a * a + c * c)) * y
    arm_z = up_x * x + up_y * y + (1.0 - 2.0 * (a * a + b * b)) * z
    return u + q * arm_z - r * arm_y, v + r * arm_x - p * arm_z


def crossed(a: Sequence[float], b: Sequence[float]) -> Vector:
    """The cross product of two vectors."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def advanced(row: Row, seconds: float) -> Row:
    """The row after so many seconds at its velocities."""
    moved = _carried(row[0:13], seconds)
    return moved if len(row) == ALONE else moved + _carried(row[13:26], seconds)


def _carried(body: Row, seconds: float) -> Row:
    px, py, pz, x, y, z, w, u, v, q, a, b, c = body
    # The exact rotation at a constant angular velocity: an event's instant is met to rounding, whatever the body turns by.
    rate = math.sqrt(a * a + b * b + c * c)
    half = 0.5 * rate * seconds
    share = math.sin(half) / rate if rate > 0.0 else 0.0
    i, j, k, r = a * share, b * share, c * share, math.cos(half)
    turn = (
        r * x + i * w + j * z - k * y,
        r * y - i * z + j * w + k * x,
        r * z + i * y - j * x + k * w,
        r * w - i * x - j * y - k * z,
    )
    return px + u * seconds, py + v * seconds, pz + q * seconds, *turn, u, v, q, a, b, c


# The account of what is written to an engine's bodies, and whether the steps explain it. A step of length dt turns a body by ω
# dt about the point R away on which it stands, so a velocity that belongs to another instant of the same step differs by at
# most ω² R dt. A larger correction is none of time: its formula is wrong (another pivot, another sign, another arm), or what it
# assumes does not hold.

MOST_EXPLAINED: Final = 1.0
"""Sum of a kind's changes of velocity over what the steps explain, at most: corrections are over half a step on average; measured
on 27 scenes at 4, 1 and 0.25 ms: 0.53 at most."""
WORSE: Final = 1.0
"""Of what the places' turning changes in the speed of what stands, a correction may leave this share at most, less than none, and
once in a run what a solver leaves of a foot (`EventSettings.still`, 5e-3 of its least speed): 785 sound runs of random, wide,
tipping and space scenes at 4 to 0.45 ms leave 1.5e-3 of it more than without the correction at most."""
REMAINDER: Final = 1e-3
"""Share of ω R by which a vertex that counts as standing may move all the same: the solver's, in what the steps explain."""


@dataclass(slots=True)
class Account:
    """The sums of one kind of writes while a run goes on; `explained_m_s` is what its steps explain of `velocity_m_s`."""

    count: int = 0
    steps_again: int = 0
    moved_m: float = 0.0
    turned_rad: float = 0.0
    velocity_m_s: float = 0.0
    rate_rad_s: float = 0.0
    given_j: float = 0.0
    taken_j: float = 0.0
    explained_m_s: float = 0.0
    owed_m_s: float = 0.0
    left_m_s: float = 0.0
    solver_m_s: float = 0.0

    def write(self, moved_m: float, turned_rad: float, velocity_m_s: float, rate_rad_s: float, change_j: float) -> None:
        """Count one write: by how much it changes places, rotations, velocities and rates, and the energy."""
        self.count += 1
        self.moved_m += moved_m
        self.turned_rad += turned_rad
        self.velocity_m_s += velocity_m_s
        self.rate_rad_s += rate_rad_s
        # Apart, as one sum would hide a correction that gives as often as it takes.
        if change_j > 0.0:
            self.given_j += change_j
        else:
            self.taken_j -= change_j

    def explain(self, rate_rad_s: float, arm_m: float, step_s: float) -> None:
        """Count what a step explains of one change of velocity of a body that turns on a point `arm_m` from its centroid."""
        rate = abs(rate_rad_s)
        self.explained_m_s += rate * arm_m * (rate * step_s + REMAINDER)

    def compare(self, owed_m_s: float, left_m_s: float, solver_m_s: float) -> None:
        """Count the change of speed of a point that stands, up to the instant corrected for, without the correction and with it.

        A change: what it moves at before, a solver's remainder, is none of the correction's. Of so little as `solver_m_s` no
        correction tells its sense.
        """
        self.owed_m_s += owed_m_s
        self.left_m_s += left_m_s
        self.solver_m_s = max(self.solver_m_s, solver_m_s)


class Ledger(defaultdict[str, Account]):
    """The accounts of a run by kind, `Ledger(Account)`: each is empty at first."""

    def record(self) -> Mapping[str, Intervention]:
        """What was written by kind. Raises `LayerFault` where the steps do not explain it."""
        for kind, sums in self.items():
            most = MOST_EXPLAINED * sums.explained_m_s
            if sums.explained_m_s > 0.0 and not sums.velocity_m_s <= most:
                raise LayerFault("velocities_unexplained", **{f"{kind}_m_s": sums.velocity_m_s, "explained_m_s": most})
            if sums.left_m_s > WORSE * sums.owed_m_s + sums.solver_m_s:
                raise LayerFault("wrong_sense", **{f"{kind}_left_m_s": sums.left_m_s, "owed_m_s": sums.owed_m_s})
        return {
            kind: Intervention(**{name: getattr(sums, name) for name in Intervention.__dataclass_fields__})
            for kind, sums in self.items()
        }


@dataclass(eq=False)
class StepLog:
    """What the loop saw: times, and per time one row (place, quaternion, velocity, angular velocity of statue and pedestal).

    `t_s` are times of the places, `kick_s` of the velocities, at most half a step before; `at_rest` counts the samples that no
    step made, as nothing could move, for `rest_s` in all. `coarser` says from when on whole steps are longer, and how long, s.
    """

    width: int
    t_s: list[float] = field(default_factory=list)
    kick_s: list[float] = field(default_factory=list)
    flat: array[float] = field(default_factory=lambda: array("d"))
    ledger: Ledger = field(default_factory=lambda: Ledger(Account))
    rested: bool = False
    at_rest: int = 0
    rest_s: float = 0.0
    coarser: tuple[float, float] = (math.inf, 0.0)

    @classmethod
    def begun(cls, row: Row, t_s: float) -> StepLog:
        """With the sample from which a run begins."""
        record = cls(len(row))
        record.keep(t_s, t_s, row)
        return record

    @property
    def rows(self) -> Array:
        """The rows, shape (n, 13) or (n, 26)."""
        return np.frombuffer(self.flat, dtype=np.float64).reshape(-1, self.width)

    @cached_property
    def pack(self) -> Callable[..., bytes]:
        """The bytes of a row's numbers: an array takes these five times as fast as the numbers one by one."""
        return Struct(f"{self.width}d").pack

    def keep(self, t_s: float, kick_s: float, row: Row) -> None:
        """Append a sample."""
        self.t_s.append(t_s)
        self.kick_s.append(kick_s)
        self.flat.frombytes(self.pack(*row))

    def go_on(self, step_s: float) -> None:
        """Whole steps are of `step_s` from the last sample on."""
        self.coarser = (self.t_s[-1], step_s)

    def tail(self, first: int) -> StepLog:
        """The samples from number `first` on."""
        part = StepLog(self.width, self.t_s[first:], self.kick_s[first:], self.flat[first * self.width :])
        part.coarser = self.coarser
        return part

    def whole_steps(self, first: int, count: int, step_s: float) -> None:
        """The times of so many whole steps from number `first` on, whose rows stand here already."""
        numbers = range(first, first + count)
        self.t_s.extend([number * step_s for number in numbers])
        self.kick_s.extend([(number - 0.5) * step_s for number in numbers])

    def row(self, index: int) -> Row:
        """A row, counted from the last (-1) backwards."""
        # Rows lie one after the other: an array of them would be copied as it grows.
        end = len(self.flat) + (index + 1) * self.width
        return tuple(self.flat[end - self.width : end])


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


# The table's motion step by step, for every contact engine.
#
# A step changes velocities first and places after, v ← v + g Δt, x ← x + v Δt. Read as velocities half a step before their
# places it is of second order; so the gravity of the step from t_n to t_{n+1} is the mean over the time from the middle of the
# step before to the middle of this one. The first step begins with synchronous velocities: half of its time lies before t_0.


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

    def ended(self, t_s: float) -> bool:
        """Whether all steps were made by then."""
        return t_s > (self.count - 0.5) * self.step_s

    def table(self, t_s: float, kick_s: float, step_s: float) -> tuple[Vector, Vector]:
        """Displacement of a moving table at the start of a step, and its mean velocity in it; that of the instant `kick_s`, to
        which the step takes velocities, where this is not its middle: at impacts, and where the floor's acceleration jumps.
        """
        (here, there, _), (_, _, at_kick) = table_motion(self.scene, np.array([t_s, t_s + step_s, kick_s]))
        rate = (there - here) / step_s
        if abs(kick_s - t_s - 0.5 * step_s) > SAME_INSTANT * self.step_s or kick_s in self._jumps_s:
            rate = at_kick
        return (float(here[0]), float(here[1]), float(here[2])), (float(rate[0]), float(rate[1]), float(rate[2]))


Level = TypeVar("Level", bound=Settings)


def schedules(
    scene: Scene, own: Level, coarsest: Level, first: int, coarser_from_s: float
) -> list[tuple[Level, Schedule]]:
    """The steps of a run by its `own` settings from number `first` on, and by the `coarsest` ones from `coarser_from_s` on.

    What comes after that instant no step bounds: a finer one would only take longer to tell one of many possible motions.
    """
    number = step_count(min(coarser_from_s, scene.duration_s), coarsest.dt_s)
    from_s = number * coarsest.dt_s
    if coarsest.dt_s <= own.dt_s or not first * own.dt_s < from_s < scene.duration_s - coarsest.dt_s:
        return [(own, Schedule(scene, own.dt_s, first, step_count(scene.duration_s, own.dt_s)))]
    return [
        (own, Schedule(scene, own.dt_s, first, step_count(from_s, own.dt_s))),
        (coarsest, Schedule(scene, coarsest.dt_s, number, step_count(scene.duration_s, coarsest.dt_s))),
    ]


# What a contact engine's loop recorded, before it becomes a run: from its rows to the trajectory, with the columns that only
# three dimensions have.


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Samples at the engine's own steps, in the table's frame, all of length n, `t_s` strictly increasing from 0.

    `statue_xz_m`, `statue_rate_m_s` (n, 2): the statue's centroid; `pedestal_xz_m`, `pedestal_rate_m_s` (n, 2): the
    pedestal's centroid, `pedestal_spin_rad_s` its rotation's rate, None without one; `gravity_xz_m_s2` (n − 1, 2): apparent
    gravity of each step. `slip_m` is of the edge on which a pedestal stands, zero without one. `extra`: further columns of
    the history by name with unit (n,), of a pedestal `pedestal_tilt_rad`.
    """

    t_s: Array
    theta_rad: Array
    theta_rate_rad_s: Array
    slip_m: Array
    slip_rate_m_s: Array
    gravity_xz_m_s2: Array
    statue_xz_m: Array
    statue_rate_m_s: Array
    pedestal_xz_m: Array | None = None
    pedestal_rate_m_s: Array | None = None
    pedestal_spin_rad_s: Array | None = None
    extra: Mapping[str, Array] = field(default_factory=dict)

    @property
    def tilt_rad(self) -> Array:
        """The support's rotation (n,), clockwise: the pedestal's."""
        return self.extra.get("pedestal_tilt_rad", np.zeros_like(self.t_s))

    def until(self, count: int, end_s: float) -> Trajectory:
        """The first `count` samples, the last of them at `end_s` where it lies beyond."""
        before_s, last_s = self.t_s[max(count - 2, 0)], self.t_s[count - 1]
        share = (end_s - before_s) / (last_s - before_s) if before_s < end_s < last_s else 1.0

        def ended(column: Array) -> Array:
            if share == 1.0:
                return column[:count]
            cut = column[:count].copy()
            cut[-1] = share * cut[-1] + (1.0 - share) * cut[-2]
            return cut

        return self._changed(ended, count)

    def up_to(self, count: int, t_s: float) -> Trajectory:
        """The first `count` samples (two at least), and one at `t_s`, as the last two of them go on."""
        last, before = count - 1, count - 2
        share = (t_s - self.t_s[last]) / (self.t_s[last] - self.t_s[before])

        def longer(column: Array) -> Array:
            return np.concatenate(
                [column[:count], column[last:count] + share * (column[last:count] - column[before:last])]
            )

        return self._changed(longer, count + 1)

    def _changed(self, change: Callable[[Array], Array], count: int) -> Trajectory:
        """Every column changed alike, to `count` samples."""
        columns = {
            name: value if value is None else change(value) for name, value in vars(self).items() if name != "extra"
        }
        # A gravity belongs to the step between two samples: there is one fewer.
        columns["gravity_xz_m_s2"] = self.gravity_xz_m_s2[: max(count - 1, 0)]
        extra = {name: change(value) for name, value in self.extra.items()}
        return Trajectory(**columns, extra=extra)  # type: ignore[arg-type]


JUMP_IN_G: Final = 10.0
PULLS: Final = 2.0
"""An acceleration above this many g, and this many times what weight and table can do together, is an impact's: velocities on
its two sides are not averaged."""


def trajectory(scene: Scene, record: StepLog, axes: Array | None, step_s: float) -> Trajectory:
    """The trajectory in the table's frame; `axes` (3, 3) holds the statue's principal axes as columns (None: a planar engine)."""
    t_s, rows = _whole_steps(record, step_s, scene)
    # Of a moving frame the table's own motion is none.
    place = table_rate = np.zeros((t_s.size, 3))
    if scene.table == "moving":
        place, table_rate = table_motion(scene, t_s)
    turn = matrices(rows[:, 3:7]) @ (np.eye(3) if axes is None else axes.T)
    spin = rows[:, 10:13]
    centroid, velocity = rows[:, 0:3] - place, rows[:, 7:10] - table_rate
    theta, theta_rate = planar(turn[:, :, 2], spin)
    extra = {} if axes is None else statue_columns(scene.statue, turn, centroid)
    slip = slip_rate = np.zeros_like(t_s)
    pedestal = pedestal_rate = pedestal_spin = None
    if scene.pedestal is not None:
        below, moving = rows[:, 13:16] - place, rows[:, 20:23] - table_rate
        pedestal, pedestal_rate, pedestal_spin = below[:, [0, 2]], moving[:, [0, 2]], rows[:, 24]
        top = matrices(rows[:, 16:20])
        columns = {
            "pedestal_tilt_rad": np.arctan2(top[:, 0, 2], top[:, 2, 2]),
            "pedestal_yaw_rad": np.arctan2(top[:, 1, 0], top[:, 0, 0]),
            "pedestal_y_m": below[:, 1] - below[0, 1],
        }
        tilt, (half_width, _, half_height) = columns["pedestal_tilt_rad"], scene.pedestal.half_m
        # What slips is the edge on which it stands.
        slip = below[:, 0] - below[0, 0] - centroid_shift_m(scene.pedestal, tilt)
        slip_rate = moving[:, 0] - pedestal_spin * (half_height * np.cos(tilt) + half_width * np.abs(np.sin(tilt)))
        # A planar engine has none but the tilt.
        extra |= {name: columns[name] for name in (("pedestal_tilt_rad",) if axes is None else columns)}
    return Trajectory(
        t_s=t_s,
        theta_rad=theta,
        theta_rate_rad_s=theta_rate,
        slip_m=slip,
        slip_rate_m_s=slip_rate,
        gravity_xz_m_s2=apparent_gravity(scene, t_s)[:, [0, 2]],
        statue_xz_m=centroid[:, [0, 2]],
        statue_rate_m_s=velocity[:, [0, 2]],
        pedestal_xz_m=pedestal,
        pedestal_rate_m_s=pedestal_rate,
        pedestal_spin_rad_s=pedestal_spin,
        extra=extra,
    )


def _whole_steps(record: StepLog, step_s: float, scene: Scene) -> tuple[Array, Array]:
    """Times (n,) and rows (n, 13 or 26) at whole steps, with velocities of those times instead of half a step before."""
    t_s, kick_s, rows = np.array(record.t_s), np.array(record.kick_s), record.rows.copy()
    jump = max(JUMP_IN_G * scene.gravity_m_s2, PULLS * greatest_pull_m_s2(scene))
    for columns, limit in (
        (slice(7, 10), jump),
        (slice(10, 13), jump / scene.statue.centroid_height_m),
        (slice(20, 23), jump),
        (slice(23, 26), jump / (math.inf if scene.pedestal is None else scene.pedestal.centroid_height_m)),
    ):
        if columns.stop <= rows.shape[1]:
            rows[:, columns] = _synchronous(rows[:, columns], t_s, kick_s, limit)
    coarser_from_s, coarser_s = record.coarser
    steps_s = np.where(t_s > coarser_from_s, coarser_s, step_s)
    whole = t_s == np.round(t_s / steps_s) * steps_s
    whole[-1] = True
    t_s, rows = t_s[whole], rows[whole]
    if t_s[0] > 0.0:
        # What came before was not integrated: nothing moved.
        t_s, rows = np.concatenate([[0.0], t_s]), np.vstack([rows[:1], rows])
    return t_s, rows


def _synchronous(values: Array, t_s: Array, kick_s: Array, jump: float) -> Array:
    """Velocities (n, 3) at the samples' own times from those of `kick_s`, at most half a step before.

    Between two samples the value is interpolated, except where the acceleration is an impact's: there the one before holds. The
    last goes on as it did before.
    """
    result = values.copy()
    between = np.diff(kick_s)
    # An impact's step takes no time for velocities.
    accel = np.diff(values, axis=0) / np.where(between > 0.0, between, 1.0)[:, None]
    smooth = (between > 0.0) & (np.max(np.abs(accel), axis=1) < jump)
    slope = np.where(smooth[:, None], accel, 0.0)
    # A run of one sample has no acceleration: its velocities stay.
    last = slope[-1:] if len(slope) else np.zeros_like(values)
    result += np.vstack([slope, last]) * (t_s - kick_s)[:, None]
    return result
