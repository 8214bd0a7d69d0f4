"""Three numbers at a time: tuples, which the compiler keeps in registers."""

import math

from analytic.kernel.compiler import inlined, jit
from analytic.kernel.forcing import acceleration, is_over, next_break_s
from analytic.kernel.records import Floats, Ints
from analytic.spatial.kernel.records import Memory, Run

Vector = tuple[float, float, float]


@inlined
def vector(row: Floats, start: int) -> Vector:
    """Three items of an array from start on."""
    return row[start], row[start + 1], row[start + 2]


@inlined
def row3(rows: Floats, i: int) -> Vector:
    """Row i of an array (n, 3)."""
    return rows[i, 0], rows[i, 1], rows[i, 2]


@inlined
def put(row: Floats, start: int, a: Vector) -> None:
    """Write three items of an array from start on."""
    row[start], row[start + 1], row[start + 2] = a[0], a[1], a[2]


@inlined
def dot(a: Vector, b: Vector) -> float:
    """a · b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def cross(a: Vector, b: Vector) -> Vector:
    """a × b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@inlined
def plus(a: Vector, b: Vector) -> Vector:
    """a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@inlined
def minus(a: Vector, b: Vector) -> Vector:
    """a − b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@inlined
def times(s: float, a: Vector) -> Vector:
    """s a."""
    return s * a[0], s * a[1], s * a[2]


@inlined
def length(a: Vector) -> float:
    """|a|."""
    return math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


@inlined
def apply(matrix: Floats, a: Vector) -> Vector:
    """The matrix (3, 3) times a."""
    return (
        matrix[0, 0] * a[0] + matrix[0, 1] * a[1] + matrix[0, 2] * a[2],
        matrix[1, 0] * a[0] + matrix[1, 1] * a[1] + matrix[1, 2] * a[2],
        matrix[2, 0] * a[0] + matrix[2, 1] * a[1] + matrix[2, 2] * a[2],
    )


@jit
def axes(y: Floats) -> tuple[Vector, Vector, Vector]:
    """The table's axes in the body's frame, x, y, z: the rows of the rotation matrix of the state's quaternion."""
    w, x, y_, z = y[3], y[4], y[5], y[6]
    return (
        (w * w + x * x - y_ * y_ - z * z, 2.0 * (x * y_ - w * z), 2.0 * (x * z + w * y_)),
        (2.0 * (x * y_ + w * z), w * w - x * x + y_ * y_ - z * z, 2.0 * (y_ * z - w * x)),
        (2.0 * (x * z - w * y_), 2.0 * (y_ * z + w * x), w * w - x * x - y_ * y_ + z * z),
    )


@inlined
def to_table(rows: tuple[Vector, Vector, Vector], a: Vector) -> Vector:
    """A vector of the body's frame in the table's."""
    return dot(rows[0], a), dot(rows[1], a), dot(rows[2], a)


@inlined
def to_body(rows: tuple[Vector, Vector, Vector], a: Vector) -> Vector:
    """A vector of the table's frame in the body's."""
    return (
        rows[0][0] * a[0] + rows[1][0] * a[1] + rows[2][0] * a[2],
        rows[0][1] * a[0] + rows[1][1] * a[1] + rows[2][1] * a[2],
        rows[0][2] * a[0] + rows[1][2] * a[1] + rows[2][2] * a[2],
    )


@jit
def turn(y: Floats, a: Vector) -> None:
    """Turn the state's quaternion by the small rotation vector a of the table's frame, and make its length one."""
    half = 0.5 * length(a)
    # sin x / x differs from one by x²/6: by less than a rounding below 1e-8.
    s = 0.5 * (math.sin(half) / half if half > 1e-8 else 1.0)
    c, x, y_, z = math.cos(half), s * a[0], s * a[1], s * a[2]
    w1, x1, y1, z1 = y[3], y[4], y[5], y[6]
    w2 = c * w1 - x * x1 - y_ * y1 - z * z1
    x2 = c * x1 + x * w1 + y_ * z1 - z * y1
    y2 = c * y1 - x * z1 + y_ * w1 + z * x1
    z2 = c * z1 + x * y1 - y_ * x1 + z * w1
    size = math.sqrt(w2 * w2 + x2 * x2 + y2 * y2 + z2 * z2)
    y[3], y[4], y[5], y[6] = w2 / size, x2 / size, y2 / size, z2 / size


# The floor's acceleration as a body in space feels it, and the breaks of its three components.


@jit
def field(s: Run, m: Memory, t: float) -> Vector:
    """g_e = (−a_x, −a_y, −g − a_z), table's frame, m/s²."""
    x, y, z = acceleration(m.motions[0], t), acceleration(m.motions[1], t), acceleration(m.motions[2], t)
    return -x, -y, -s.gravity_m_s2 - z


@jit
def pass_breaks(s: Run, m: Memory) -> None:
    """Pass the breaks up to now, and note how far the motions are smooth."""
    s.limit_s = s.duration_s
    for motion in m.motions:
        while next_break_s(motion) <= s.time_s:
            motion.breaks_passed += 1
        s.limit_s = min(s.limit_s, next_break_s(motion))


@jit
def all_over(m: Memory) -> bool:
    """Whether the floor is at rest from now on."""
    return is_over(m.motions[0]) and is_over(m.motions[1]) and is_over(m.motions[2])


@inlined
def touched(s: Run, m: Memory) -> Ints:
    """The vertices that touch, in the polygon's order."""
    return m.touch[: s.touching]
