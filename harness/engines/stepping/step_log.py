"""Rows of numbers, and what the loop saw: the samples of a run as it goes on."""

from __future__ import annotations

import math
from array import array
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from struct import Struct
from typing import Final

import numpy as np

from harness.engines.base import LayerFault
from harness.model import Array, Intervention

# Rows of numbers: places, rotations and velocities of statue and pedestal at one instant, as the layer keeps them.

Row = tuple[float, ...]
"""Place (3), quaternion (x, y, z, w) of the principal frame, velocity (3) and angular velocity (3) of the statue, world axes,
and the same of the pedestal, if there is one."""
Vector = tuple[float, float, float]
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
    step made, as nothing could move.
    """

    width: int
    t_s: list[float] = field(default_factory=list)
    kick_s: list[float] = field(default_factory=list)
    flat: array[float] = field(default_factory=lambda: array("d"))
    ledger: Ledger = field(default_factory=lambda: Ledger(Account))
    rested: bool = False
    at_rest: int = 0

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

    def tail(self, first: int) -> StepLog:
        """The samples from number `first` on."""
        return StepLog(self.width, self.t_s[first:], self.kick_s[first:], self.flat[first * self.width :])

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

    @property
    def rate_before(self) -> Sequence[float]:
        """The statue's angular velocity in the row before the last."""
        begin = 10 - 2 * self.width
        return self.flat[begin : begin + 3]
