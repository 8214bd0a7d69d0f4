"""Which mode is possible after an event or at an impact: the candidates one after another, the one that sticks most first.

The floor is level and the body convex: of the vertices that touch, those that stay in contact are all of them, the two of an edge
of their polygon, one, or none. So some ten candidates to a vertex are all there are, and each is a small system solved exactly.
"""

import math
from typing import Final

from analytic.kernel.compiler import inlined, jit
from analytic.kernel.records import Floats
from analytic.spatial.kernel.contact import (
    UNLIMITED,
    Rows,
    along_across,
    clear,
    columns,
    edge_margin,
    eliminate,
    find_directions,
    normal,
    place,
    respond,
    response,
    solve_columns,
    solve_flat,
    tangent,
)
from analytic.spatial.kernel.records import (
    DOES,
    EDGE,
    EDGE_PIVOT,
    EDGE_STICK,
    FACET,
    FLAT_PIVOT,
    FLAT_REST,
    FLIGHT,
    KEEPS,
    NOTHING,
    PIVOTS,
    SLIDES,
    STICKS,
    VERTEX,
    VERTEX_STICK,
    Memory,
    Run,
)
from analytic.spatial.kernel.vectors import (
    Vector,
    apply,
    cross,
    dot,
    plus,
    put,
    row3,
    times,
    to_body,
    to_table,
    touched,
    vector,
)

# Whether a flat base at rest stays, and whether one impulse can bring it to rest.
#
# At rest on a level floor the contact forces have one resultant, −m g_e through the centroid: a force without a moment about the
# point where its line meets the floor. Forces N_i g_h/g_v on all vertices are that, and no others need less friction: so it rests
# if and only if that point lies in the polygon and |H| ≤ μ V. No programme has to be solved.


SPLITS: Final = 4000
"""Reflections between the forces that balance and those inside their cones, at most."""
BALANCED: Final = 1e-11
"""Share of the impulse that may be missing."""


@jit
def edge_distance(s: Run, m: Memory, rows: Rows, k: int, x: float, y: float) -> float:
    """Distance of a point of the floor (from below the centroid) from edge k of the polygon that touches, inward."""
    i, j = m.touch[k], m.touch[(k + 1) % s.touching]
    xi, yi = place(m, rows, i, 1), place(m, rows, i, 2)
    ex, ey = place(m, rows, j, 1) - xi, place(m, rows, j, 2) - yi
    return (ex * (y - yi) - ey * (x - xi)) / math.sqrt(ex * ex + ey * ey)


@jit
def thrust(s: Run, m: Memory, rows: Rows, field: Vector) -> tuple[float, float, float, float]:
    """Where the line of g_e through the centroid meets the floor (x, y from below it), and the forces V and |H| on the floor."""
    height = -dot(rows[2], row3(m.at, m.touch[0]))
    down = -field[2]
    along = height / down if down != 0.0 else math.inf
    side = math.sqrt(field[0] * field[0] + field[1] * field[1])
    return along * field[0], along * field[1], s.mass_kg * down, s.mass_kg * side


@jit
def rests(s: Run, m: Memory, rows: Rows, field: Vector) -> bool:
    """Whether a flat base at rest stays so."""
    x, y, v, h = thrust(s, m, rows, field)
    inside = v > 0.0 and (s.friction_static >= UNLIMITED or h <= s.friction_static * v)
    for k in range(s.touching):
        inside = inside and edge_distance(s, m, rows, k, x, y) >= 0.0
    return inside


@jit
def stops_all(s: Run, m: Memory, rows: Rows, y: Vector, spin: Vector) -> bool:
    """Whether impulses inside their cones bring a body with velocity y and angular velocity spin (body's frame) to rest on a flat
    base; if so they stand in memory.

    A small second-order cone programme: reflections (Douglas and Rachford) between the impulses that balance and the cones.
    """
    linear, moment = times(-s.mass_kg, y), times(-1.0, apply(m.inertia, spin))
    wanted = to_table(rows, linear)
    v, size = wanted[2], math.sqrt(dot(linear, linear)) + math.sqrt(dot(moment, moment))
    if not v > 0.0:
        return False
    height = -dot(rows[2], row3(m.at, m.touch[0]))
    turn = to_table(rows, moment)
    # about a point (x, y) of the floor the moment is level and zero: M_x = y V + h H_y, M_y = −x V − h H_x
    py, px = (turn[0] - height * wanted[1]) / v, -(turn[1] + height * wanted[0]) / v
    for k in range(s.touching):
        if not edge_distance(s, m, rows, k, px, py) >= 0.0:
            return False
    n = s.touching
    z = m.cone
    for k in range(n):
        z[0, k, 0], z[0, k, 1], z[0, k, 2] = wanted[0] / n, wanted[1] / n, v / n
    for _ in range(SPLITS):
        _balance(s, m, rows, wanted, turn, z)
        gap = 0.0
        for k in range(n):
            mu = m.stick_limit[m.touch[k]]
            a = (2.0 * z[1, k, 0] - z[0, k, 0], 2.0 * z[1, k, 1] - z[0, k, 1], 2.0 * z[1, k, 2] - z[0, k, 2])
            b = _into_cone(mu, a)
            for c in range(3):
                z[0, k, c] += b[c] - z[1, k, c]
                gap += abs(b[c] - z[1, k, c])
        if gap <= BALANCED * size:
            for k in range(n):
                f = to_body(rows, (z[1, k, 0], z[1, k, 1], z[1, k, 2]))
                i = m.touch[k]
                m.force[i, 0], m.force[i, 1], m.force[i, 2] = f
            respond(s, m)
            return True
    return False


@jit
def _into_cone(mu: float, a: Vector) -> Vector:
    """The point of the friction cone nearest to a."""
    t = math.sqrt(a[0] * a[0] + a[1] * a[1])
    if mu >= UNLIMITED:
        return a[0], a[1], max(a[2], 0.0)
    if t <= mu * a[2]:
        return a
    if mu * t <= -a[2]:
        return 0.0, 0.0, 0.0
    n = (mu * t + a[2]) / (1.0 + mu * mu)
    return mu * n * a[0] / t, mu * n * a[1] / t, n


@jit
def _balance(s: Run, m: Memory, rows: Rows, wanted: Vector, turn: Vector, z: Floats) -> None:
    """z[1]: the impulses nearest to z[0] with the wanted sum and moment about the centroid, table's frame."""
    total, moment = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    m.matrix[:6, :7] = 0.0
    for k in range(s.touching):
        r = to_table(rows, row3(m.at, m.touch[k]))
        f = (z[0, k, 0], z[0, k, 1], z[0, k, 2])
        total, moment = plus(total, f), plus(moment, cross(r, f))
        rr = dot(r, r)
        for i in range(3):
            m.matrix[i, i] += 1.0
            for j in range(3):
                m.matrix[3 + i, 3 + j] += (rr if i == j else 0.0) - r[i] * r[j]
        # Σ r × (F + λ + μ × r) and Σ (F + λ + μ × r)
        for i, j, value in ((0, 1, -r[2]), (0, 2, r[1]), (1, 0, r[2]), (1, 2, -r[0]), (2, 0, -r[1]), (2, 1, r[0])):
            m.matrix[3 + i, j] += value
            m.matrix[i, 3 + j] -= value
    for c in range(3):
        m.matrix[c, 6], m.matrix[3 + c, 6] = wanted[c] - total[c], turn[c] - moment[c]
    eliminate(m.matrix, 6)
    push = (m.matrix[0, 6], m.matrix[1, 6], m.matrix[2, 6])
    twist = (m.matrix[3, 6], m.matrix[4, 6], m.matrix[5, 6])
    for k in range(s.touching):
        f = plus(push, cross(twist, to_table(rows, row3(m.at, m.touch[k]))))
        for c in range(3):
            z[1, k, c] = z[0, k, c] + f[c]


# The candidates.


ZERO: Final = 1e-9
"""Share of the largest response within which another counts as zero: what was rounded away, not a way out of the mode."""
ANOTHER: Final = 1e-6
"""Share of the largest response by which another mode's must differ to be another motion: far above what solving rounds away."""


@inlined
def takes_part(mode: int, a: int, b: int, i: int) -> bool:
    """Whether vertex i, which touches, takes part in a mode of the vertices a and b (−1: none)."""
    return i in (a, b) or KEEPS[mode] == FACET


@inlined
def _turning(m: Memory, a: int, b: int) -> int:
    """The vertex whose way tells how a pivot turns: the edge's other one, or one of the facet's."""
    if b >= 0:
        return b
    return int(m.touch[0] if m.touch[0] != a else m.touch[1])


@jit
def _signs_hold(s: Run, m: Memory, rows: Rows, mode: int, a: int, b: int, sign: float, zero: float) -> bool:
    """Whether the solution in memory pushes where it touches, leaves where it does not, and keeps inside its cones."""
    for i in touched(s, m):
        lift = dot(rows[2], response(m, i))
        # A singular system's forces need not hold what they were to hold.
        if takes_part(mode, a, b, i) and (normal(m, rows, i) < 0.0 or lift > zero):
            return False
        if lift < -zero:
            return False
    if mode == EDGE_STICK:
        return m.stick_limit[a] >= UNLIMITED or edge_margin(m, rows, a, b) >= 0.0
    limited = mode in (VERTEX_STICK, EDGE_PIVOT, FLAT_PIVOT) and m.stick_limit[a] < UNLIMITED
    if limited and tangent(m, rows, a) > m.stick_limit[a] * normal(m, rows, a):
        return False
    # A vertex that slides already may be slowed down; one that begins to must move against its friction.
    j = _turning(m, a, b)
    if DOES[mode] == PIVOTS and m.known[j] == 0:
        return sign * dot(along_across(m, rows, a, j)[1], response(m, j)) >= -zero
    return True


@jit
def pivot_directions(s: Run, m: Memory, rows: Rows, a: int, sign: float) -> None:
    """Directions of all vertices of a flat base that turns about vertex a."""
    for i in touched(s, m):
        if i != a:
            dx, dy = place(m, rows, i, 1) - place(m, rows, a, 1), place(m, rows, i, 2) - place(m, rows, a, 2)
            size = math.sqrt(dx * dx + dy * dy)
            m.slide[i, 0], m.slide[i, 1] = -sign * dy / size, sign * dx / size


@jit
def _possible(
    s: Run, m: Memory, rows: Rows, mode: int, a: int, b: int, sign: float, field: Vector, impulse: bool, size: float
) -> bool:
    """Whether a mode is consistent with its own response; the solution stands in memory."""
    clear(s, m)
    m.response[:] = 0.0
    for i in touched(s, m):
        if m.known[i] != 0:
            m.slide[i, 0], m.slide[i, 1] = m.heading[i, 0], m.heading[i, 1]
    if mode == FLAT_REST:
        return stops_all(s, m, rows, field, vector(m.y, 10)) if impulse else rests(s, m, rows, field)
    if mode == FLAT_PIVOT:
        pivot_directions(s, m, rows, a, sign)
        ok = solve_flat(s, m, rows, mode, a)
    elif DOES[mode] == SLIDES:
        ok = find_directions(s, m, rows, mode, a, b, size)
    elif mode == FLIGHT:
        ok = True
    else:
        ok = solve_columns(s, m, columns(m, rows, mode, a, b, sign))
    return ok and _signs_hold(s, m, rows, mode, a, b, sign, ZERO * size)


@jit
def _candidates(s: Run, mode: int) -> int:
    """How many candidates of a mode the vertices that touch give."""
    n, keeps, does = s.touching, KEEPS[mode], DOES[mode]
    held = s.friction_kinetic >= UNLIMITED and does in (PIVOTS, SLIDES)
    if held or (keeps == FACET and n < 3):
        return 0
    signs = 2 if does == PIVOTS else 1
    if keeps == EDGE:
        return signs * signs * (n if n > 2 else n - 1)
    return signs * n if keeps == VERTEX or signs == 2 else 1


@jit
def _candidate(s: Run, m: Memory, mode: int, c: int) -> tuple[int, int, float]:
    """Candidate c of a mode: its vertices a and b, and the sign of the yaw about a."""
    n, keeps = s.touching, KEEPS[mode]
    if mode == FLAT_PIVOT:
        return m.touch[c // 2], -1, 1.0 - 2.0 * (c % 2)
    if mode == EDGE_PIVOT:
        k, swap = c // 4, c // 2 % 2
        return m.touch[(k + swap) % n], m.touch[(k + 1 - swap) % n], 1.0 - 2.0 * (c % 2)
    if keeps in (FACET, NOTHING):
        return -1, -1, 0.0
    return m.touch[c], (m.touch[(c + 1) % n] if keeps == EDGE else -1), 0.0


@jit
def _turns(m: Memory, rows: Rows, a: int, b: int, sign: float) -> bool:
    """Whether vertex b's velocity about the sticking vertex a, if it has one, is that of the sign."""
    if m.known[b] == 0:
        return True
    across = along_across(m, rows, a, b)[1]
    turned: float = dot(rows[0], across) * m.heading[b, 0] + dot(rows[1], across) * m.heading[b, 1]
    return sign * turned > 0.0


@jit
def _may(s: Run, m: Memory, rows: Rows, mode: int, a: int, b: int, sign: float) -> bool:
    """Whether the velocities allow a candidate: what sticks in it must not slide."""
    does = DOES[mode]
    if does == PIVOTS:
        return m.known[a] == 0 and _turns(m, rows, a, _turning(m, a, b), sign)
    if does == STICKS:
        for i in touched(s, m):
            if m.known[i] != 0 and takes_part(mode, a, b, i):
                return False
    return True


@inlined
def _differs(m: Memory, reach: float, size: float) -> bool:
    """Whether the response in memory is another than the one chosen."""
    change = 0.0
    for c in range(6):
        change = max(change, abs(m.response[c] - m.chosen[c]) * (1.0 if c < 3 else reach))
    return change > ANOTHER * size


@jit
def choose(s: Run, m: Memory, rows: Rows, field: Vector, impulse: bool, size: float) -> bool:
    """Set the first mode that is possible, its forces or impulses in memory; False if none is.

    field: g_e in the table's frame; with impulses the centroid's velocity in the body's frame. size: of the responses. Where
    all candidates are tried (`Run.try_all`), `ties` counts the choices that another motion could have followed.
    """
    some, tie, chosen, a0, b0, sign0 = False, False, FLIGHT, -1, -1, 0.0
    reach = math.sqrt(m.at[0, 0] ** 2 + m.at[0, 1] ** 2 + m.at[0, 2] ** 2)
    for mode in range(FLIGHT + 1):
        for c in range(_candidates(s, mode)):
            a, b, sign = _candidate(s, m, mode, c)
            if not _may(s, m, rows, mode, a, b, sign):
                continue
            if not _possible(s, m, rows, mode, a, b, sign, field, impulse, size):
                continue
            if some:
                tie = tie or _differs(m, reach, size)
            else:
                some, chosen, a0, b0, sign0 = True, mode, a, b, sign
                m.chosen[:] = m.response
                if mode == FLAT_REST and not impulse:
                    # No forces were solved for: at rest they undo the field.
                    put(m.chosen, 0, to_body(rows, times(-1.0, field)))
                if not s.try_all:
                    s.mode, s.a, s.b, s.sign = mode, a, b, sign
                    return True
    if some:
        s.ties += 1 if tie else 0
        _possible(s, m, rows, chosen, a0, b0, sign0, field, impulse, size)
        s.mode, s.a, s.b, s.sign = chosen, a0, b0, sign0
    return some
