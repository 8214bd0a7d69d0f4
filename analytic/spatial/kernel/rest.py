"""Whether a flat base at rest stays, and whether one impulse can bring it to rest.

At rest on a level floor the contact forces have one resultant, −m g_e through the centroid: a force without a moment about the
point where its line meets the floor. Forces N_i g_h/g_v on all vertices are that, and no others need less friction: so it rests
if and only if that point lies in the polygon and |H| ≤ μ V. No programme has to be solved.
"""

from __future__ import annotations

import math
from typing import Final

from analytic.kernel.compiler import jit
from analytic.kernel.records import Floats
from analytic.spatial.kernel.contact import UNLIMITED, Rows, eliminate, respond
from analytic.spatial.kernel.flat import place
from analytic.spatial.kernel.records import Memory, Run
from analytic.spatial.kernel.vectors import Vector, apply, cross, dot, plus, row3, times, to_body, to_table

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
