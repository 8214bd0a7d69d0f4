"""Rows of numbers: places, rotations and velocities of statue and pedestal at one instant, as the layer keeps them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

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


@dataclass(frozen=True, eq=False)
class Body:
    """State of one body: place (3,) of its centroid, quaternion (4,) of its principal frame, velocities (3,), world axes."""

    place_m: Vector
    turn: tuple[float, float, float, float]
    velocity_m_s: Vector
    rate_rad_s: Vector


def bodies(row: Row) -> tuple[Body, Body | None]:
    """States of statue and pedestal in a row."""
    statue = Body(row[0:3], row[3:7], row[7:10], row[10:13])  # type: ignore[arg-type]
    if len(row) == ALONE:
        return statue, None
    return statue, Body(row[13:16], row[16:20], row[20:23], row[23:26])  # type: ignore[arg-type]


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
