"""Which mode is possible after an event or at an impact: the candidates one after another, the one that sticks most first.

The floor is level and the body convex: of the vertices that touch, those that stay in contact are all of them, the two of an edge
of their polygon, one, or none. So some ten candidates to a vertex are all there are, and each is a small system solved exactly.
"""

from __future__ import annotations

import math
from typing import Final

from analytic.kernel.compiler import inlined, jit
from analytic.spatial.kernel import codes
from analytic.spatial.kernel.contact import (
    UNLIMITED,
    Rows,
    along_across,
    clear,
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
from analytic.spatial.kernel.vectors import (
    Vector,
    dot,
    put,
    times,
    to_body,
    touched,
    vector,
)

ZERO: Final = 1e-9
"""Share of the largest response within which another counts as zero: what was rounded away, not a way out of the mode."""
ANOTHER: Final = 1e-6
"""Share of the largest response by which another mode's must differ to be another motion: far above what solving rounds away."""


@inlined
def takes_part(mode: int, a: int, b: int, i: int) -> bool:
    """Whether vertex i, which touches, takes part in a mode of the vertices a and b (−1: none)."""
    return i in (a, b) or codes.KEEPS[mode] == codes.FACET


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
    if mode == codes.EDGE_STICK:
        return m.stick_limit[a] >= UNLIMITED or edge_margin(m, rows, a, b) >= 0.0
    limited = mode in (codes.VERTEX_STICK, codes.EDGE_PIVOT, codes.FLAT_PIVOT) and m.stick_limit[a] < UNLIMITED
    if limited and tangent(m, rows, a) > m.stick_limit[a] * normal(m, rows, a):
        return False
    # A vertex that slides already may be slowed down; one that begins to must move against its friction.
    j = _turning(m, a, b)
    if codes.DOES[mode] == codes.PIVOTS and m.known[j] == 0:
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
    if mode == codes.FLAT_REST:
        return stops_all(s, m, rows, field, vector(m.y, 10)) if impulse else rests(s, m, rows, field)
    if mode == codes.FLAT_PIVOT:
        pivot_directions(s, m, rows, a, sign)
        ok = solve_flat(s, m, rows, mode, a)
    elif codes.DOES[mode] == codes.SLIDES:
        ok = find_directions(s, m, rows, mode, a, b, size)
    elif mode == codes.FLIGHT:
        ok = True
    else:
        ok = solve_columns(s, m, columns(m, rows, mode, a, b, sign))
    return ok and _signs_hold(s, m, rows, mode, a, b, sign, ZERO * size)


@jit
def _candidates(s: Run, mode: int) -> int:
    """How many candidates of a mode the vertices that touch give."""
    n, keeps, does = s.touching, codes.KEEPS[mode], codes.DOES[mode]
    held = s.friction_kinetic >= UNLIMITED and does in (codes.PIVOTS, codes.SLIDES)
    if held or (keeps == codes.FACET and n < 3):
        return 0
    signs = 2 if does == codes.PIVOTS else 1
    if keeps == codes.EDGE:
        return signs * signs * (n if n > 2 else n - 1)
    return signs * n if keeps == codes.VERTEX or signs == 2 else 1


@jit
def _candidate(s: Run, m: Memory, mode: int, c: int) -> tuple[int, int, float]:
    """Candidate c of a mode: its vertices a and b, and the sign of the yaw about a."""
    n, keeps = s.touching, codes.KEEPS[mode]
    if mode == codes.FLAT_PIVOT:
        return m.touch[c // 2], -1, 1.0 - 2.0 * (c % 2)
    if mode == codes.EDGE_PIVOT:
        k, swap = c // 4, c // 2 % 2
        return m.touch[(k + swap) % n], m.touch[(k + 1 - swap) % n], 1.0 - 2.0 * (c % 2)
    if keeps in (codes.FACET, codes.NOTHING):
        return -1, -1, 0.0
    return m.touch[c], (m.touch[(c + 1) % n] if keeps == codes.EDGE else -1), 0.0


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
    does = codes.DOES[mode]
    if does == codes.PIVOTS:
        return m.known[a] == 0 and _turns(m, rows, a, _turning(m, a, b), sign)
    if does == codes.STICKS:
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
    some, tie, chosen, a0, b0, sign0 = False, False, codes.FLIGHT, -1, -1, 0.0
    reach = math.sqrt(m.at[0, 0] ** 2 + m.at[0, 1] ** 2 + m.at[0, 2] ** 2)
    for mode in range(codes.FLIGHT + 1):
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
                if mode == codes.FLAT_REST and not impulse:
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
