"""Forces on a flat base that slides, or turns about a vertex that sticks.

With more than three vertices a rigid body does not determine how they share the normal force. Of all shares that keep the base
flat, none negative, the one of the least sum of squares is taken: that of equal springs where all vertices slide alike. Where
there is any, it is there alone and changes without a jump. N_i = max(0, a_i · λ): a_i is what a unit of N_i does to the base, and
λ is found by Newton's method on Σ a_i N_i = b, the gradient of a convex function, quadratic between the sets of loaded vertices.
"""

from __future__ import annotations

import math
from typing import Final

from analytic.kernel.compiler import inlined, jit
from analytic.spatial.kernel.codes import FLAT_PIVOT
from analytic.spatial.kernel.contact import Rows, clear, eliminate, respond, sliding_push
from analytic.spatial.kernel.records import MAX_VERTICES, Memory, Run
from analytic.spatial.kernel.vectors import (
    Vector,
    apply,
    cross,
    dot,
    plus,
    row3,
    times,
    to_table,
    touched,
)

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


@inlined
def load_all(s: Run, m: Memory) -> None:
    """Let all vertices that touch bear pressure."""
    for i in touched(s, m):
        m.loaded[i] = 1


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
    load_all(s, m)
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
