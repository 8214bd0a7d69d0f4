"""Directions in which vertices begin to slide: each vertex that leaves rest moves against its own friction."""

from __future__ import annotations

import math
from typing import Final

from analytic.kernel.compiler import inlined, jit
from analytic.spatial.kernel.codes import EDGE_SLIDE, EDGE_STICK, FLAT_SLIDE, VERTEX_SLIDE
from analytic.spatial.kernel.contact import (
    Rows,
    along_across,
    clear,
    columns,
    edge_friction,
    least_up,
    normal,
    respond,
    response,
    solve_columns,
)
from analytic.spatial.kernel.flat import place, press_flat, solve_flat, write_undone
from analytic.spatial.kernel.records import SECTORS, Memory, Run
from analytic.spatial.kernel.vectors import (
    Vector,
    cross,
    dot,
    length,
    minus,
    plus,
    row3,
    times,
    to_table,
    touched,
)

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
                value = _across_at(s, m, rows, mode, a, b, i, mid)
                if below * value > 0.0:
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
