"""Which mode is possible after an event or at an impact: the candidates one after another, the one that sticks most first.

The floor is level and the body convex: of the vertices that touch, those that stay in contact are all of them, the two of an edge
of their polygon, one, or none. So some ten candidates to a vertex are all there are, and each is a small system solved exactly.
"""

from __future__ import annotations

import math
from typing import Final

from analytic.kernel.compiler import inlined, jit
from analytic.spatial.kernel.codes import (
    EDGE_PIVOT,
    EDGE_SLIDE,
    EDGE_STICK,
    FLAT_PIVOT,
    FLAT_REST,
    FLAT_SLIDE,
    FLIGHT,
    VERTEX_SLIDE,
    VERTEX_STICK,
)
from analytic.spatial.kernel.contact import (
    UNLIMITED,
    Rows,
    along_across,
    columns,
    edge_margin,
    normal,
    response,
    solve_columns,
    tangent,
)
from analytic.spatial.kernel.directions import find_directions
from analytic.spatial.kernel.flat import place, solve_flat
from analytic.spatial.kernel.records import Memory, Run
from analytic.spatial.kernel.rest import rests, stops_all
from analytic.spatial.kernel.vectors import Vector, dot, vector

ZERO: Final = 1e-9
"""Share of the largest response within which another counts as zero: what was rounded away, not a way out of the mode."""


@inlined
def _parts(m: Memory, rows: Rows, mode: int, a: int, b: int, i: int) -> bool:
    """Whether vertex i takes part in a mode."""
    if mode in (FLAT_REST, FLAT_PIVOT, FLAT_SLIDE):
        return True
    return mode != FLIGHT and (i == a or (i == b and mode in (EDGE_STICK, EDGE_PIVOT, EDGE_SLIDE)))


@jit
def _signs_hold(s: Run, m: Memory, rows: Rows, mode: int, a: int, b: int, sign: float, zero: float) -> bool:
    """Whether the solution in memory pushes where it touches, leaves where it does not, and keeps inside its cones."""
    for k in range(s.touching):
        i = m.touch[k]
        if _parts(m, rows, mode, a, b, i):
            if normal(m, rows, i) < 0.0:
                return False
        elif dot(rows[2], response(m, i)) < -zero:
            return False
    if mode == EDGE_STICK:
        return m.stick_limit[a] >= UNLIMITED or edge_margin(m, rows, a, b) >= 0.0
    limited = mode in (VERTEX_STICK, EDGE_PIVOT, FLAT_PIVOT) and m.stick_limit[a] < UNLIMITED
    if limited and tangent(m, rows, a) > m.stick_limit[a] * normal(m, rows, a):
        return False
    # A vertex that slides already may be slowed down; one that begins to must move against its friction.
    if mode == EDGE_PIVOT and m.known[b] == 0:
        return sign * dot(along_across(m, rows, a, b)[1], response(m, b)) >= -zero
    j = m.touch[0] if m.touch[0] != a else m.touch[1]
    if mode == FLAT_PIVOT and m.known[j] == 0:
        return sign * dot(along_across(m, rows, a, j)[1], response(m, j)) >= -zero
    return True


@jit
def pivot_directions(s: Run, m: Memory, rows: Rows, a: int, sign: float) -> None:
    """Directions of all vertices of a flat base that turns about vertex a."""
    for k in range(s.touching):
        i = m.touch[k]
        if i != a:
            dx, dy = place(m, rows, i, 1) - place(m, rows, a, 1), place(m, rows, i, 2) - place(m, rows, a, 2)
            size = math.sqrt(dx * dx + dy * dy)
            m.slide[i, 0], m.slide[i, 1] = -sign * dy / size, sign * dx / size


@jit
def _possible(
    s: Run, m: Memory, rows: Rows, mode: int, a: int, b: int, sign: float, field: Vector, impulse: bool, size: float
) -> bool:
    """Whether a mode is consistent with its own response; the solution stands in memory."""
    zero = ZERO * size
    m.force[:] = 0.0
    m.response[:] = 0.0
    for k in range(s.touching):
        i = m.touch[k]
        if m.known[i] != 0:
            m.slide[i, 0], m.slide[i, 1] = m.heading[i, 0], m.heading[i, 1]
    if mode == FLAT_REST:
        if impulse:
            moving, spin = field, _spin(m)
            return stops_all(s, m, rows, moving, spin)
        return rests(s, m, rows, field)
    if mode == FLAT_PIVOT:
        pivot_directions(s, m, rows, a, sign)
        ok = solve_flat(s, m, rows, mode, a)
    elif mode in (FLAT_SLIDE, EDGE_SLIDE, VERTEX_SLIDE):
        ok = find_directions(s, m, rows, mode, a, b, size)
    elif mode == FLIGHT:
        ok = True
    else:
        ok = solve_columns(s, m, columns(m, rows, mode, a, b, sign))
    return ok and _signs_hold(s, m, rows, mode, a, b, sign, zero)


@inlined
def _spin(m: Memory) -> Vector:
    return vector(m.y, 10)


@inlined
def _sticks(m: Memory, i: int) -> bool:
    """Whether no velocity says that vertex i slides."""
    return bool(m.known[i] == 0)


@jit
def _still_all(s: Run, m: Memory) -> bool:
    known = 0
    for k in range(s.touching):
        known += m.known[m.touch[k]]
    return bool(known == 0)


@inlined
def _take(s: Run, mode: int, a: int, b: int, sign: float) -> bool:
    s.mode, s.a, s.b, s.sign = mode, a, b, sign
    return True


@inlined
def _turns(m: Memory, rows: Rows, a: int, b: int, sign: float) -> bool:
    """Whether vertex b's known direction about the sticking vertex a, if it has one, is that of the sign."""
    if m.known[b] == 0:
        return True
    across = along_across(m, rows, a, b)[1]
    turned: float = dot(rows[0], across) * m.slide[b, 0] + dot(rows[1], across) * m.slide[b, 1]
    return sign * turned > 0.0


@jit
def choose(s: Run, m: Memory, rows: Rows, field: Vector, impulse: bool, size: float) -> bool:
    """Set the first mode that is possible, its forces or impulses in memory; False if none is.

    field: g_e in the table's frame; with impulses the centroid's velocity in the body's frame. size: of the responses.
    """
    n = s.touching
    pairs = n if n > 2 else n - 1
    slides = s.friction_kinetic < UNLIMITED
    if n > 2 and _still_all(s, m) and _possible(s, m, rows, FLAT_REST, -1, -1, 0.0, field, impulse, size):
        return _take(s, FLAT_REST, -1, -1, 0.0)
    for k in range(pairs):
        a, b = m.touch[k], m.touch[(k + 1) % n]
        if _sticks(m, a) and _sticks(m, b) and _possible(s, m, rows, EDGE_STICK, a, b, 0.0, field, impulse, size):
            return _take(s, EDGE_STICK, a, b, 0.0)
    if n > 2 and slides:
        for k in range(n):
            a = m.touch[k]
            for sign in (1.0, -1.0):
                may = _sticks(m, a) and _turns(m, rows, a, m.touch[(k + 1) % n], sign)
                if may and _possible(s, m, rows, FLAT_PIVOT, a, -1, sign, field, impulse, size):
                    return _take(s, FLAT_PIVOT, a, -1, sign)
    for k in range(pairs if slides else 0):
        for swap in range(2):
            a, b = m.touch[(k + swap) % n], m.touch[(k + 1 - swap) % n]
            for sign in (1.0, -1.0):
                may = _sticks(m, a) and _turns(m, rows, a, b, sign)
                if may and _possible(s, m, rows, EDGE_PIVOT, a, b, sign, field, impulse, size):
                    return _take(s, EDGE_PIVOT, a, b, sign)
    for k in range(n):
        a = m.touch[k]
        if _sticks(m, a) and _possible(s, m, rows, VERTEX_STICK, a, -1, 0.0, field, impulse, size):
            return _take(s, VERTEX_STICK, a, -1, 0.0)
    return _choose_sliding(s, m, rows, field, impulse, size)


@jit
def _choose_sliding(s: Run, m: Memory, rows: Rows, field: Vector, impulse: bool, size: float) -> bool:
    """The same among the modes in which nothing sticks."""
    n = s.touching if s.friction_kinetic < UNLIMITED else 0
    pairs = n if n > 2 else n - 1
    if n > 2 and _possible(s, m, rows, FLAT_SLIDE, -1, -1, 0.0, field, impulse, size):
        return _take(s, FLAT_SLIDE, -1, -1, 0.0)
    for k in range(pairs):
        a, b = m.touch[k], m.touch[(k + 1) % n]
        if _possible(s, m, rows, EDGE_SLIDE, a, b, 0.0, field, impulse, size):
            return _take(s, EDGE_SLIDE, a, b, 0.0)
    for k in range(n):
        a = m.touch[k]
        if _possible(s, m, rows, VERTEX_SLIDE, a, -1, 0.0, field, impulse, size):
            return _take(s, VERTEX_SLIDE, a, -1, 0.0)
    if _possible(s, m, rows, FLIGHT, -1, -1, 0.0, field, impulse, size):
        return _take(s, FLIGHT, -1, -1, 0.0)
    return False
