"""What contact forces do to a body, and the forces that keep a given mode, a flat base and directions of sliding among them.

The same equations hold for accelerations under forces and for velocities under impulses: a response x_i = u_i + Σ W_ij F_j of
each vertex, u_i being what it is without contact. All vectors stand in the body's frame unless a name says otherwise.
"""

import math
from typing import Final

from analytic.kernel.compiler import inlined, jit
from analytic.kernel.records import Floats
from analytic.spatial.kernel.records import (
    EDGE_PIVOT,
    EDGE_SLIDE,
    EDGE_STICK,
    FLAT_PIVOT,
    FLAT_SLIDE,
    MAX_VERTICES,
    SECTORS,
    VERTEX_SLIDE,
    Memory,
    Run,
)
from analytic.spatial.kernel.vectors import (
    Vector,
    apply,
    axes,
    cross,
    dot,
    length,
    minus,
    plus,
    row3,
    times,
    to_body,
    to_table,
    touched,
    vector,
)

Rows = tuple[Vector, Vector, Vector]
SINGULAR: Final = 1e-13
"""A pivot below this share of the largest item is rounding."""
UNLIMITED: Final = 1e8
"""A coefficient from here on always suffices: no cone is looked at."""


@jit
def eliminate(matrix: Floats, n: int) -> bool:
    """Solve the n equations of an augmented matrix in place, the solution in its column n; False where it is singular."""
    largest = 0.0
    for i in range(n):
        for j in range(n):
            largest = max(largest, abs(matrix[i, j]))
    for k in range(n):
        best, size = k, abs(matrix[k, k])
        for i in range(k + 1, n):
            if abs(matrix[i, k]) > size:
                best, size = i, abs(matrix[i, k])
        if not size > SINGULAR * largest:
            return False
        if best != k:
            for j in range(k, n + 1):
                matrix[k, j], matrix[best, j] = matrix[best, j], matrix[k, j]
        for i in range(k + 1, n):
            share = matrix[i, k] / matrix[k, k]
            for j in range(k + 1, n + 1):
                matrix[i, j] -= share * matrix[k, j]
    for k in range(n - 1, -1, -1):
        for j in range(k + 1, n):
            matrix[k, n] -= matrix[k, j] * matrix[j, n]
        matrix[k, n] /= matrix[k, k]
    return True


@inlined
def clear(s: Run, m: Memory) -> None:
    """Take the forces away from all vertices that touch."""
    for i in touched(s, m):
        m.force[i, 0], m.force[i, 1], m.force[i, 2] = 0.0, 0.0, 0.0


@jit
def free_accelerations(s: Run, m: Memory, y: Floats, field: Vector) -> None:
    """Write each touching vertex' acceleration without contact: g_e + α × r + ω × (ω × r), I α = −ω × I ω."""
    spin, down = vector(y, 10), to_body(axes(y), field)
    alpha = apply(m.inverse, cross(apply(m.inertia, spin), spin))
    for i in touched(s, m):
        r = row3(m.at, i)
        a = plus(plus(down, cross(alpha, r)), cross(spin, cross(spin, r)))
        m.u[i, 0], m.u[i, 1], m.u[i, 2] = a


@jit
def vertex_velocities(s: Run, m: Memory, y: Floats) -> None:
    """Write each touching vertex' velocity: v + ω × r."""
    spin, v = vector(y, 10), to_body(axes(y), vector(y, 7))
    for i in touched(s, m):
        a = plus(v, cross(spin, row3(m.at, i)))
        m.u[i, 0], m.u[i, 1], m.u[i, 2] = a


@jit
def response(m: Memory, i: int) -> Vector:
    """Vertex i's response with the contact forces that stand in memory."""
    x = plus(row3(m.u, i), vector(m.response, 0))
    return plus(x, cross(vector(m.response, 3), row3(m.at, i)))


@jit
def along_across(m: Memory, rows: Rows, a: int, b: int) -> tuple[Vector, Vector]:
    """Unit vectors along the edge from a to b and across it to the left, level."""
    d = minus(row3(m.at, b), row3(m.at, a))
    d = minus(d, times(dot(d, rows[2]), rows[2]))
    along = times(1.0 / length(d), d)
    return along, cross(rows[2], along)


@jit
def set_column(m: Memory, k: int, i: int, push: Vector, hold: Vector) -> None:
    """Column k: a force at vertex i along push keeps i's response along hold at zero."""
    m.column[k] = i
    m.push[k, 0], m.push[k, 1], m.push[k, 2] = push
    m.hold[k, 0], m.hold[k, 1], m.hold[k, 2] = hold


@jit
def sliding_push(m: Memory, rows: Rows, i: int) -> Vector:
    """Force of a unit normal force at a vertex that slides in its direction: ẑ − μ d."""
    mu, dx, dy = m.slide_limit[i], m.slide[i, 0], m.slide[i, 1]
    return minus(rows[2], plus(times(mu * dx, rows[0]), times(mu * dy, rows[1])))


@jit
def columns(m: Memory, rows: Rows, mode: int, a: int, b: int, sign: float) -> int:
    """Set the columns of a mode of one or two vertices; their number."""
    if mode in (VERTEX_SLIDE, EDGE_SLIDE):
        set_column(m, 0, a, sliding_push(m, rows, a), rows[2])
        if mode == VERTEX_SLIDE:
            return 1
        set_column(m, 1, b, sliding_push(m, rows, b), rows[2])
        return 2
    for k in range(3):
        set_column(m, k, a, rows[k], rows[k])
    if mode not in (EDGE_STICK, EDGE_PIVOT):
        return 3
    across = along_across(m, rows, a, b)[1]
    if mode == EDGE_PIVOT:
        set_column(m, 3, b, minus(rows[2], times(sign * m.slide_limit[b], across)), rows[2])
        return 4
    # Of the forces along the edge only the sum is known: all of it is put at a.
    set_column(m, 3, b, across, across)
    set_column(m, 4, b, rows[2], rows[2])
    return 5


@jit
def solve_columns(s: Run, m: Memory, n: int) -> bool:
    """Solve for the n columns' forces; they and the response stand in memory."""
    for k in range(n):
        i, push = m.column[k], row3(m.push, k)
        turned = apply(m.inverse, cross(row3(m.at, i), push))
        for j in range(n):
            hold = row3(m.hold, j)
            m.matrix[j, k] = dot(hold, push) / s.mass_kg + dot(cross(row3(m.at, m.column[j]), hold), turned)
    for j in range(n):
        m.matrix[j, n] = -dot(row3(m.hold, j), row3(m.u, m.column[j]))
    if not eliminate(m.matrix, n):
        return False
    clear(s, m)
    for k in range(n):
        for c in range(3):
            m.force[m.column[k], c] += m.matrix[k, n] * m.push[k, c]
    respond(s, m)
    return True


@jit
def respond(s: Run, m: Memory) -> None:
    """Write the response to the forces that stand in memory."""
    total, moment = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for i in touched(s, m):
        f = row3(m.force, i)
        total, moment = plus(total, f), plus(moment, cross(row3(m.at, i), f))
    turned = apply(m.inverse, moment)
    for c in range(3):
        m.response[c], m.response[3 + c] = total[c] / s.mass_kg, turned[c]


@inlined
def normal(m: Memory, rows: Rows, i: int) -> float:
    """N of vertex i."""
    return dot(rows[2], row3(m.force, i))


@jit
def least_up(s: Run, m: Memory, rows: Rows, vectors: Floats) -> float:
    """Least upward part of the forces or velocities of what touches, none above 0: negative where one pulls or comes down."""
    least = 0.0
    for i in touched(s, m):
        least = min(least, dot(rows[2], row3(vectors, i)))
    return least


@jit
def largest(s: Run, m: Memory) -> float:
    """Largest of the velocities or accelerations in memory of what touches."""
    most = 0.0
    for i in touched(s, m):
        most = max(most, length(row3(m.u, i)))
    return most


@inlined
def tangent(m: Memory, rows: Rows, i: int) -> float:
    """|T| of vertex i."""
    f = to_table(rows, row3(m.force, i))
    return math.sqrt(f[0] * f[0] + f[1] * f[1])


@jit
def edge_margin(m: Memory, rows: Rows, a: int, b: int) -> float:
    """How far friction on a sticking edge is from its limit, N: the force along it may be split as friction allows."""
    along, across = along_across(m, rows, a, b)
    total = abs(dot(along, row3(m.force, a)) + dot(along, row3(m.force, b)))
    least, sum_ = math.inf, 0.0
    for i in (a, b):
        most, needed = m.stick_limit[i] * normal(m, rows, i), abs(dot(across, row3(m.force, i)))
        least = min(least, most - needed)
        sum_ += math.sqrt(max((most - needed) * (most + needed), 0.0))
    return min(least, sum_ - total) if least >= 0.0 else least


@jit
def edge_friction(m: Memory, rows: Rows, a: int, b: int) -> float:
    """The least coefficient that suffices on a sticking edge: for one split of the force along it both vertices are at it."""
    along, across = along_across(m, rows, a, b)
    total = abs(dot(along, row3(m.force, a)) + dot(along, row3(m.force, b)))
    na, nb = normal(m, rows, a), normal(m, rows, b)
    if na <= 0.0 or nb <= 0.0:
        return math.inf
    ta, tb = abs(dot(across, row3(m.force, a))), abs(dot(across, row3(m.force, b)))
    low = max(ta / na, tb / nb)
    high = max(low, (total + ta + tb) / (na + nb))
    for _ in range(60):
        mid = 0.5 * (low + high)
        have = math.sqrt(max((mid * na) ** 2 - ta * ta, 0.0)) + math.sqrt(max((mid * nb) ** 2 - tb * tb, 0.0))
        if have >= total:
            high = mid
        else:
            low = mid
        if high - low <= 1e-15 * high:
            break
    return high


# Forces on a flat base that slides, or turns about a vertex that sticks.
#
# With more than three vertices a rigid body does not determine how they share the normal force. Of all shares that keep the
# base flat, none negative, the one of the least sum of squares is taken: that of equal springs where all vertices slide alike.
# Where there is any, it is there alone and changes without a jump. N_i = max(0, a_i · λ): a_i is what a unit of N_i does to the
# base, and λ is found by Newton's method on Σ a_i N_i = b, the gradient of a convex function, quadratic between the sets of
# loaded vertices.


SETS: Final = 40
"""Sets of loaded vertices tried at most, and"""
LEAST_SHARE: Final = 1e-3
"""the least share of one of Newton's steps."""


@inlined
def place(m: Memory, rows: Rows, i: int, c: int) -> float:
    """1, x, y of vertex i from below the centroid: heights of a flat base are linear in these."""
    return 1.0 if c == 0 else dot(rows[c - 1], row3(m.at, i))


@inlined
def flat_push(m: Memory, rows: Rows, i: int, pivot: int) -> Vector:
    """Force of a unit normal force at a vertex of a flat base."""
    return rows[2] if i == pivot else sliding_push(m, rows, i)


@jit
def _write_effect(s: Run, m: Memory, rows: Rows, i: int, push: Vector, pivot: int, row: int) -> None:
    """Write what a force at vertex i along push does, times the mass: change of height below the centroid and its slopes, and the
    pivot's x and y."""
    turned = apply(m.inverse, cross(row3(m.at, i), push))
    level = to_table(rows, times(s.mass_kg, turned))
    m.effect[row, 0], m.effect[row, 1], m.effect[row, 2] = dot(rows[2], push), -level[1], level[0]
    if pivot >= 0:
        x = plus(push, times(s.mass_kg, cross(turned, row3(m.at, pivot))))
        m.effect[row, 3], m.effect[row, 4] = dot(rows[0], x), dot(rows[1], x)


@jit
def write_undone(s: Run, m: Memory, rows: Rows, pivot: int) -> None:
    """Write what the forces must undo, whichever way vertices slide: heights below the centroid and slopes, the pivot's x, y."""
    for r in range(3):
        for c in range(4):
            total = 0.0
            for i in touched(s, m):
                total += place(m, rows, i, r) * (place(m, rows, i, c) if c < 3 else -dot(rows[2], row3(m.u, i)))
            m.matrix[r, c] = total
    eliminate(m.matrix, 3)
    for c in range(3):
        m.undone[c] = s.mass_kg * m.matrix[c, 3]
    if pivot >= 0:
        m.undone[3] = -s.mass_kg * dot(rows[0], row3(m.u, pivot))
        m.undone[4] = -s.mass_kg * dot(rows[1], row3(m.u, pivot))


@inlined
def _share(m: Memory, n: int, row: int) -> float:
    """a · λ of a force."""
    total = 0.0
    for c in range(n):
        total += m.effect[row, c] * m.multiplier[c]
    return total


@inlined
def _add(m: Memory, first: int, n: int, row: int) -> None:
    """Add a force to the system's columns from the first on."""
    for r in range(n):
        for c in range(first, n):
            m.matrix[r, c] += m.effect[row, r] * m.effect[row, c]


@jit
def _write_system(s: Run, m: Memory, n: int) -> float:
    """Write the equations for λ over the loaded vertices; by how much the λ in memory misses them."""
    missed, hh, hx, hy, xx, xy, yy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    m.matrix[:n, : n + 1] = 0.0
    for i in touched(s, m):
        if m.loaded[i] != 0:
            # What every base has, height and slopes, is summed up in registers: a sum in memory waits for itself.
            h, x, y = row3(m.effect, i)
            hh, hx, hy, xx, xy, yy = hh + h * h, hx + h * x, hy + h * y, xx + x * x, xy + x * y, yy + y * y
            _add(m, 3, n, i)
    m.matrix[0, 0], m.matrix[0, 1], m.matrix[0, 2] = hh, hx, hy
    m.matrix[1, 0], m.matrix[1, 1], m.matrix[1, 2] = hx, xx, xy
    m.matrix[2, 0], m.matrix[2, 1], m.matrix[2, 2] = hy, xy, yy
    for r in range(3, n):
        for c in range(3):
            m.matrix[r, c] = m.matrix[c, r]
    for t in range(n - 3):
        _add(m, 0, n, MAX_VERTICES + t)
    for r in range(n):
        m.matrix[r, n] = m.undone[r]
        row = -m.undone[r]
        for c in range(n):
            row += m.matrix[r, c] * m.multiplier[c]
        missed += abs(row)
    return missed


@inlined
def _pressed(s: Run, m: Memory, n: int, pivot: int) -> int:
    """How many vertices the λ in memory presses down; none where the pivot is not among them."""
    count = 0
    for i in touched(s, m):
        count += 1 if _share(m, n, i) >= 0.0 else 0
    return count if pivot < 0 or _share(m, n, pivot) >= 0.0 else 0


@inlined
def _load(s: Run, m: Memory, n: int) -> bool:
    """Load the vertices that the λ in memory presses down; whether they were others."""
    changed = False
    for i in touched(s, m):
        now = 1 if _share(m, n, i) >= 0.0 else 0
        changed, m.loaded[i] = changed or m.loaded[i] != now, now
    return changed


@jit
def _press(s: Run, m: Memory, n: int, pivot: int) -> bool:
    """Find λ; it stands in memory. False where there is none: then it is that of the last three vertices or more, and goes on
    smoothly beyond the mode's end."""
    for i in touched(s, m):
        m.loaded[i] = 1
    m.multiplier[:] = 0.0
    missed = _write_system(s, m, n)
    for _ in range(SETS):
        m.before[:] = m.multiplier
        if not eliminate(m.matrix, n):
            return False
        m.multiplier[:n] = m.matrix[:n, n]
        # Fewer than three loaded vertices keep nothing flat, and a pivot without pressure has no friction: other modes.
        if _pressed(s, m, n, pivot) < 3:
            return False
        if not _load(s, m, n):
            return True
        now = _write_system(s, m, n)
        share = 1.0
        while now >= missed and share > LEAST_SHARE:
            share *= 0.5
            # Item by item: an expression of arrays would ask for memory, which loaded machine code has none of.
            for c in range(n):
                m.multiplier[c] = 0.5 * (m.multiplier[c] + m.before[c])
            _load(s, m, n)
            now = _write_system(s, m, n)
        missed = now
    return False


@jit
def flat_margin(s: Run, m: Memory, ok: bool) -> float:
    """How far a sliding facet is from tipping, N: the third largest pressure, as two vertices bear all where it tips; the least
    where it has tipped."""
    first, second, third, least = 0.0, 0.0, 0.0, math.inf
    for i in touched(s, m):
        x = m.pressure[i]
        least = min(least, x)
        if x > first:
            first, second, third = x, first, second
        elif x > second:
            second, third = x, second
        elif x > third:
            third = x
    return third if ok else min(least, 0.0)


@jit
def pivot_directions(s: Run, m: Memory, rows: Rows, a: int, sign: float) -> None:
    """Directions of all vertices of a flat base that turns about vertex a."""
    for i in touched(s, m):
        if i != a:
            dx, dy = place(m, rows, i, 1) - place(m, rows, a, 1), place(m, rows, i, 2) - place(m, rows, a, 2)
            size = math.sqrt(dx * dx + dy * dy)
            m.slide[i, 0], m.slide[i, 1] = -sign * dy / size, sign * dx / size


@jit
def solve_flat(s: Run, m: Memory, rows: Rows, mode: int, a: int) -> bool:
    """Forces on a flat base that slides, about vertex a if that sticks; False where none on its vertices keep it flat."""
    pivot = a if mode == FLAT_PIVOT else -1
    write_undone(s, m, rows, pivot)
    return press_flat(s, m, rows, pivot)


@jit
def press_flat(s: Run, m: Memory, rows: Rows, pivot: int) -> bool:
    """The same, about a pivot where there is one, for other directions of sliding: what is to be undone stands in memory."""
    n = 3 if pivot < 0 else 5
    for i in touched(s, m):
        _write_effect(s, m, rows, i, flat_push(m, rows, i, pivot), pivot, i)
    if pivot >= 0:
        _write_effect(s, m, rows, pivot, rows[0], pivot, MAX_VERTICES)
        _write_effect(s, m, rows, pivot, rows[1], pivot, MAX_VERTICES + 1)
    ok = _press(s, m, n, pivot)
    clear(s, m)
    for i in touched(s, m):
        m.pressure[i] = _share(m, n, i) if m.loaded[i] != 0 else 0.0
        f = times(m.pressure[i], flat_push(m, rows, i, pivot))
        if i == pivot:
            x, y = _share(m, n, MAX_VERTICES), _share(m, n, MAX_VERTICES + 1)
            f = plus(f, plus(times(x, rows[0]), times(y, rows[1])))
        m.force[i, 0], m.force[i, 1], m.force[i, 2] = f
    respond(s, m)
    return ok


# Directions in which vertices begin to slide: each vertex that leaves rest moves against its own friction.


STARTS: Final = 8
"""Directions from which Newton's method starts for each of two vertices."""
NEWTON: Final = 30
HALVINGS: Final = 60
SHORTER: Final = 10
"""Halvings of a step of Newton's method: less than a thousandth of one brings it nowhere."""
CONVERGED: Final = 1e-13
"""Of angles and of relative velocities: rounding of a handful of operations."""
ROOT: Final = 1e3
"""A root's response across, over what counts as zero: its slope times the angle's rounding is far below, a pole's far above."""
TWO_PI: Final = 2.0 * math.pi
TURNS: Final = (0.0, 1.0, -1.0)
"""Shares of a start aside and about the vertical: none, to one side, to the other."""


@inlined
def set_direction(m: Memory, i: int, angle: float) -> None:
    """Let vertex i slide at an angle from the table's x."""
    m.slide[i, 0], m.slide[i, 1] = math.cos(angle), math.sin(angle)


@inlined
def off_direction(m: Memory, rows: Rows, i: int) -> tuple[float, float]:
    """Vertex i's response across and along its direction of sliding."""
    x = to_table(rows, response(m, i))
    dx, dy = m.slide[i, 0], m.slide[i, 1]
    return dx * x[1] - dy * x[0], dx * x[0] + dy * x[1]


@jit
def _across_at(s: Run, m: Memory, rows: Rows, mode: int, a: int, b: int, i: int, angle: float) -> float:
    set_direction(m, i, angle)
    # Beyond its own end a flat mode goes on smoothly, so that a sign change is seen from both sides.
    if mode == FLAT_SLIDE:
        press_flat(s, m, rows, -1)
    elif not solve_columns(s, m, columns(m, rows, mode, a, b, 0.0)):
        return math.nan
    return off_direction(m, rows, i)[0]


@jit
def one_direction(s: Run, m: Memory, rows: Rows, mode: int, a: int, b: int, i: int, zero: float) -> bool:
    """Find the direction of vertex i, the others' being given; True with the solution in memory.

    First one to which friction turns the vertex back: from there it turns no further, away from another one at once. Looking for
    it in vain has filled the memory that the other is looked for in.
    """
    return _direction(s, m, rows, mode, a, b, i, zero, True) or _direction(s, m, rows, mode, a, b, i, zero, False)


@jit
def _direction(s: Run, m: Memory, rows: Rows, mode: int, a: int, b: int, i: int, zero: float, stable: bool) -> bool:
    step = TWO_PI / s.sectors
    if stable:
        m.across[0] = _across_at(s, m, rows, mode, a, b, i, 0.0)
    before = m.across[0]
    for k in range(1, s.sectors + 1):
        if stable:
            m.across[k] = _across_at(s, m, rows, mode, a, b, i, k * step)
        after = m.across[k]
        if before == 0.0 or (before > 0.0 > after if stable else before * after < 0.0):
            low, high, below = (k - 1) * step, k * step, before
            if before == 0.0:
                high = low
            for _ in range(HALVINGS):
                if high - low <= CONVERGED:
                    break
                mid = 0.5 * (low + high)
                if below * _across_at(s, m, rows, mode, a, b, i, mid) > 0.0:
                    low = mid
                else:
                    high = mid
            _across_at(s, m, rows, mode, a, b, i, high)
            across, along = off_direction(m, rows, i)
            # Where the equations have no solution the sign changes too, from one infinity to the other; a root at which a force
            # pulls must not hide the next.
            pushes = mode == FLAT_SLIDE or least_up(s, m, rows, m.force) >= 0.0
            if along >= -zero and abs(across) <= ROOT * zero and pushes:
                return True
        before = after
    return False


@jit
def _two_across(s: Run, m: Memory, rows: Rows, a: int, b: int, p: float, q: float) -> tuple[float, float]:
    set_direction(m, a, p)
    set_direction(m, b, q)
    if not solve_columns(s, m, columns(m, rows, EDGE_SLIDE, a, b, 0.0)):
        return math.nan, math.nan
    return off_direction(m, rows, a)[0], off_direction(m, rows, b)[0]


@jit
def _against_holding(m: Memory, rows: Rows, a: int, b: int, i: int) -> float:
    """Angle against the friction on vertex i of an edge that holds it, both vertices being at the same share of their limits."""
    along, across = along_across(m, rows, a, b)
    total = dot(along, row3(m.force, a)) + dot(along, row3(m.force, b))
    most, aside = edge_friction(m, rows, a, b) * normal(m, rows, i), dot(across, row3(m.force, i))
    ahead = math.copysign(math.sqrt(max((most - aside) * (most + aside), 0.0)), total)
    force = to_table(rows, plus(times(ahead, along), times(aside, across)))
    return math.atan2(-force[1], -force[0])


@jit
def two_directions(s: Run, m: Memory, rows: Rows, a: int, b: int, size: float, zero: float) -> bool:
    """Find the directions of both vertices of an edge by Newton's method from several starts."""
    across = to_table(rows, along_across(m, rows, a, b)[1])
    first, small = math.atan2(across[1], across[0]), 1e-7
    for start in range(-1, STARTS * STARTS):
        # At the limit of friction as that has held them; then both the same way first, across the edge before along it.
        p = first + TWO_PI * (start % STARTS) / STARTS
        q = p + TWO_PI * (start // STARTS) / STARTS
        if start < 0 and solve_columns(s, m, columns(m, rows, EDGE_STICK, a, b, 0.0)):
            p, q = _against_holding(m, rows, a, b, a), _against_holding(m, rows, a, b, b)
        for _ in range(NEWTON):
            fp, fq = _two_across(s, m, rows, a, b, p, q)
            if not abs(fp) + abs(fq) < math.inf:
                break
            if abs(fp) + abs(fq) <= CONVERGED * size:
                along = min(off_direction(m, rows, a)[1], off_direction(m, rows, b)[1])
                # To look past a root at which a force pulls takes a quarter of a run: only where nothing was found.
                if along >= -zero and (s.sectors == SECTORS[0] or least_up(s, m, rows, m.force) >= 0.0):
                    return True
                break
            pp, pq = _two_across(s, m, rows, a, b, p + small, q)
            qp, qq = _two_across(s, m, rows, a, b, p, q + small)
            app, apq, aqp, aqq = (pp - fp) / small, (pq - fq) / small, (qp - fp) / small, (qq - fq) / small
            det = app * aqq - aqp * apq
            if det == 0.0:
                break
            dp, dq = -(aqq * fp - aqp * fq) / det, -(app * fq - apq * fp) / det
            most = max(abs(dp), abs(dq), 0.5)
            p, q = p + 0.5 * dp / most if most > 0.5 else p + dp, q + 0.5 * dq / most if most > 0.5 else q + dq
    return False


@jit
def _level_response(m: Memory, rows: Rows, reach: float) -> Vector:
    """Response of a flat base in place of the point below the centroid (x, y) and yaw times reach: two vertices give it."""
    i, j = m.touch[0], m.touch[1]
    xi, xj = to_table(rows, response(m, i)), to_table(rows, response(m, j))
    lx, ly = place(m, rows, j, 1) - place(m, rows, i, 1), place(m, rows, j, 2) - place(m, rows, i, 2)
    yaw = (lx * (xj[1] - xi[1]) - ly * (xj[0] - xi[0])) / (lx * lx + ly * ly)
    return xi[0] + yaw * place(m, rows, i, 2), xi[1] - yaw * place(m, rows, i, 1), yaw * reach


@jit
def _flat_response(s: Run, m: Memory, rows: Rows, d: Vector, reach: float) -> Vector:
    """Response to sliding of a flat base in the direction d: a unit vector of (place of the point below the centroid x, y; yaw
    times reach). It does not depend on how fast the base slides.
    """
    for i in touched(s, m):
        dx, dy = d[0] - d[2] / reach * place(m, rows, i, 2), d[1] + d[2] / reach * place(m, rows, i, 1)
        speed = math.sqrt(dx * dx + dy * dy)
        if speed > 0.0:
            m.slide[i, 0], m.slide[i, 1] = dx / speed, dy / speed
    press_flat(s, m, rows, -1)
    return _level_response(m, rows, reach)


@inlined
def _towards(d: Vector, step: Vector) -> Vector:
    """The unit vector of their sum."""
    sum_ = plus(d, step)
    return times(1.0 / length(sum_), sum_)


@jit
def _flat_newton(s: Run, m: Memory, rows: Rows, d: Vector, reach: float, size: float, zero: float) -> bool:
    """Newton's method on the sphere of directions, steps halved: the response lies along the direction. True with the solution in
    memory."""
    small = 1e-7
    for _ in range(NEWTON):
        first = cross(d, (1.0, 0.0, 0.0) if abs(d[0]) < 0.6 else (0.0, 1.0, 0.0))
        first = times(1.0 / length(first), first)
        second = cross(d, first)
        r = _flat_response(s, m, rows, d, reach)
        along, miss = dot(d, r), length(cross(d, r))
        if miss <= CONVERGED * size:
            return along >= -zero
        # What is to vanish is r − (r · d) d: turning d by a small angle takes (r · d) of it away on its own.
        p = minus(_flat_response(s, m, rows, _towards(d, times(small, first)), reach), r)
        q = minus(_flat_response(s, m, rows, _towards(d, times(small, second)), reach), r)
        f, g = dot(first, r), dot(second, r)
        a, b = dot(first, p) / small - along, dot(first, q) / small
        c, e = dot(second, p) / small, dot(second, q) / small - along
        det = a * e - b * c
        if det == 0.0:
            return False
        step = plus(times((b * g - e * f) / det, first), times((c * f - a * g) / det, second))
        share, smaller = 1.0 / max(1.0, 2.0 * length(step)), False
        for _half in range(SHORTER):
            trial = _towards(d, times(share, step))
            if length(cross(trial, _flat_response(s, m, rows, trial, reach))) < miss:
                d, smaller = trial, True
                break
            share *= 0.5
        if not smaller:
            _flat_response(s, m, rows, d, reach)
            return miss <= 100.0 * CONVERGED * size and along >= -zero
    return False


@jit
def flat_directions(s: Run, m: Memory, rows: Rows, size: float, zero: float) -> bool:
    """Find the directions of all vertices of a flat base that begins to slide; True with the solution in memory.

    Newton's method starts from the motion without contact, and from its place ahead, back (an impact may turn a slide round), and
    aside, without and with yaw.
    """
    reach, n = 0.0, 1.0 * s.touching
    for i in touched(s, m):
        reach += math.sqrt(place(m, rows, i, 1) ** 2 + place(m, rows, i, 2) ** 2) / n
    clear(s, m)
    respond(s, m)
    free = _level_response(m, rows, reach)
    side = math.sqrt(free[0] * free[0] + free[1] * free[1])
    if _flat_newton(s, m, rows, _towards(free, (0.0, 0.0, 0.0)), reach, size, zero):
        return True
    fx, fy = (free[0] / side, free[1] / side) if side > 0.0 else (0.0, 0.0)
    for start in range(27):
        ahead, aside, yaw = 1.0 - start // 3 % 3, TURNS[start // 9], TURNS[start % 3]
        d = ahead * fx - aside * fy, ahead * fy + aside * fx, yaw
        if length(d) == 0.0:
            continue
        d = _towards(d, (0.0, 0.0, 0.0))
        if _flat_newton(s, m, rows, d, reach, size, zero):
            return True
    return False


@jit
def find_directions(s: Run, m: Memory, rows: Rows, mode: int, a: int, b: int, size: float) -> bool:
    """Solve a sliding mode, the directions that no velocity gives being found; True with the solution in memory."""
    zero = 1e-9 * size
    if mode == FLAT_SLIDE:
        unknown, last = 0, -1
        for i in touched(s, m):
            if m.known[i] == 0:
                unknown, last = unknown + 1, i
        if unknown == 0:
            return solve_flat(s, m, rows, mode, -1)
        write_undone(s, m, rows, -1)
        if unknown == 1:
            return one_direction(s, m, rows, mode, a, b, last, zero)
        return flat_directions(s, m, rows, size, zero)
    if mode == VERTEX_SLIDE and m.known[a] == 0:
        return one_direction(s, m, rows, mode, a, b, a, zero)
    if mode == EDGE_SLIDE and m.known[a] + m.known[b] < 2:
        if m.known[a] + m.known[b] == 0:
            return two_directions(s, m, rows, a, b, size, zero)
        return one_direction(s, m, rows, mode, a, b, a if m.known[a] == 0 else b, zero)
    return solve_columns(s, m, columns(m, rows, mode, a, b, 0.0))
