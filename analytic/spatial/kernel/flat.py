"""Forces on a flat base that slides, or turns about a vertex that sticks."""

from __future__ import annotations

import math

from analytic.kernel.compiler import inlined, jit
from analytic.spatial.kernel.codes import FLAT_PIVOT
from analytic.spatial.kernel.contact import Rows, clear, eliminate, respond, sliding_push
from analytic.spatial.kernel.records import Memory, Run
from analytic.spatial.kernel.vectors import Vector, cross, dot, plus, row3, times, vector


@inlined
def place(m: Memory, rows: Rows, i: int, c: int) -> float:
    """1, x, y of vertex i from below the centroid: the pressure of a stiff base on a bed of springs is linear in these."""
    return 1.0 if c == 0 else dot(rows[c - 1], row3(m.at, i))


@jit
def flat_row(s: Run, m: Memory, rows: Rows, row: int, column: int, pivot: int) -> None:
    """Write the five sums of the response to the forces in memory, as a column of the flat system: heights by `place`, and the
    pivot's x and y."""
    lift, turn = vector(m.response, 0), vector(m.response, 3)
    for c in range(3):
        total = 0.0
        for k in range(s.touching):
            i = m.touch[k]
            x = plus(lift, cross(turn, row3(m.at, i)))
            total += place(m, rows, i, c) * dot(rows[2], x)
        m.matrix[row + c, column] = total
    if pivot >= 0:
        x = plus(lift, cross(turn, row3(m.at, pivot)))
        m.matrix[row + 3, column] = dot(rows[0], x)
        m.matrix[row + 4, column] = dot(rows[1], x)


@inlined
def flat_push(m: Memory, rows: Rows, i: int, pivot: int) -> Vector:
    """Force of a unit normal force at a vertex of a flat base."""
    return rows[2] if i == pivot else sliding_push(m, rows, i)


@inlined
def load_all(s: Run, m: Memory) -> None:
    """Let all vertices that touch bear pressure."""
    for k in range(s.touching):
        m.loaded[m.touch[k]] = 1


@jit
def _flat_once(s: Run, m: Memory, rows: Rows, pivot: int) -> bool:
    """Solve for the pressure plane over the loaded vertices."""
    n = 3 if pivot < 0 else 5
    for c in range(n):
        clear(s, m)
        if c < 3:
            for k in range(s.touching):
                i = m.touch[k]
                if m.loaded[i] != 0:
                    f = times(place(m, rows, i, c), flat_push(m, rows, i, pivot))
                    m.force[i, 0], m.force[i, 1], m.force[i, 2] = f
        else:
            m.force[pivot, 0], m.force[pivot, 1], m.force[pivot, 2] = rows[c - 3]
        respond(s, m)
        flat_row(s, m, rows, 0, c, pivot)
    for c in range(3):
        total = 0.0
        for k in range(s.touching):
            i = m.touch[k]
            total += place(m, rows, i, c) * dot(rows[2], row3(m.u, i))
        m.matrix[c, n] = -total
    if pivot >= 0:
        m.matrix[3, n] = -dot(rows[0], row3(m.u, pivot))
        m.matrix[4, n] = -dot(rows[1], row3(m.u, pivot))
    return eliminate(m.matrix, n)


@inlined
def _plane(m: Memory, rows: Rows, i: int, n: int) -> float:
    """Pressure at vertex i in the plane that the system's column n holds."""
    plane: float = m.matrix[0, n] + m.matrix[1, n] * place(m, rows, i, 1) + m.matrix[2, n] * place(m, rows, i, 2)
    return plane


@jit
def flat_margin(s: Run, m: Memory, ok: bool) -> float:
    """How far a sliding facet is from tipping, N: the third largest pressure, as two vertices bear all where it tips; the least
    where it has tipped."""
    first, second, third, least = 0.0, 0.0, 0.0, math.inf
    for k in range(s.touching):
        x = m.pressure[m.touch[k]]
        least = min(least, x)
        if x > first:
            first, second, third = x, first, second
        elif x > second:
            second, third = x, second
        elif x > third:
            third = x
    return third if ok else min(least, 0.0)


@jit
def solve_flat(s: Run, m: Memory, rows: Rows, mode: int, a: int) -> bool:
    """Forces on a flat base that slides, about vertex a if that sticks; False where no pressure on its vertices keeps it flat.

    With more than three vertices the split of the normal force is not determined: it is that of equal springs under the vertices,
    a pressure linear in place and never negative. Beyond the mode's end the last plane goes on smoothly.
    """
    pivot = a if mode == FLAT_PIVOT else -1
    n = 3 if pivot < 0 else 5
    ok, smooth = False, False
    load_all(s, m)
    for _ in range(4 + 2 * s.touching):
        if not _flat_once(s, m, rows, pivot):
            break
        changed, count = False, 0
        for k in range(s.touching):
            i = m.touch[k]
            m.pressed[i] = 1 if _plane(m, rows, i, n) >= 0.0 else 0
            changed, count = changed or m.loaded[i] != m.pressed[i], count + m.pressed[i]
        last = count < 3 or (pivot >= 0 and m.pressed[pivot] == 0)
        if last or not changed:
            # Fewer than three loaded vertices bear no pressure plane, and a pivot without pressure no friction: other modes.
            ok, smooth = not last, True
            break
        for k in range(s.touching):
            m.loaded[m.touch[k]] = m.pressed[m.touch[k]]
    if not smooth:
        load_all(s, m)
        if not _flat_once(s, m, rows, pivot):
            return False
    for k in range(s.touching):
        i = m.touch[k]
        m.pressure[i] = _plane(m, rows, i, n) if m.loaded[i] != 0 else 0.0
    t0, t1 = (m.matrix[3, n], m.matrix[4, n]) if pivot >= 0 else (0.0, 0.0)
    clear(s, m)
    for k in range(s.touching):
        i = m.touch[k]
        if m.loaded[i] != 0:
            f = times(m.pressure[i], flat_push(m, rows, i, pivot))
            if i == pivot:
                f = plus(f, plus(times(t0, rows[0]), times(t1, rows[1])))
            m.force[i, 0], m.force[i, 1], m.force[i, 2] = f
    respond(s, m)
    return ok
