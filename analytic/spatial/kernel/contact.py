"""What contact forces do to a body, and the forces that keep a given mode: linear systems of at most eight unknowns.

The same equations hold for accelerations under forces and for velocities under impulses: a response x_i = u_i + Σ W_ij F_j of
each vertex, u_i being what it is without contact. All vectors stand in the body's frame unless a name says otherwise.
"""

from __future__ import annotations

import math
from typing import Final

from analytic.kernel.compiler import inlined, jit
from analytic.kernel.records import Floats
from analytic.spatial.kernel import codes
from analytic.spatial.kernel.records import Memory, Run
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
    if mode in (codes.VERTEX_SLIDE, codes.EDGE_SLIDE):
        set_column(m, 0, a, sliding_push(m, rows, a), rows[2])
        if mode == codes.VERTEX_SLIDE:
            return 1
        set_column(m, 1, b, sliding_push(m, rows, b), rows[2])
        return 2
    for k in range(3):
        set_column(m, k, a, rows[k], rows[k])
    if mode == codes.EDGE_STICK:
        across = along_across(m, rows, a, b)[1]
        # Of the forces along the edge only the sum is known: all of it is put at a.
        set_column(m, 3, b, across, across)
        set_column(m, 4, b, rows[2], rows[2])
        return 5
    if mode == codes.EDGE_PIVOT:
        across = along_across(m, rows, a, b)[1]
        set_column(m, 3, b, minus(rows[2], times(sign * m.slide_limit[b], across)), rows[2])
        return 4
    return 3


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
