"""Which mode is possible after an event or at an impact; impacts: impulses at all vertices that touch, at once.

The candidates are tried one after another, the one that sticks most first. The floor is level and the body convex: of the
vertices that touch, those that stay in contact are all of them, the two of an edge of their polygon, one, or none. So some ten
candidates to a vertex are all there are, and each is a small system solved exactly.
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
    free_accelerations,
    largest,
    least_up,
    normal,
    pivot_directions,
    place,
    respond,
    response,
    solve_columns,
    solve_flat,
    tangent,
    vertex_velocities,
)
from analytic.spatial.kernel.motion import (
    contact_forces,
    hold_level,
    hold_place,
    hold_velocity,
    kinetic_energy,
    note_event,
    note_interval,
    set_touch,
    take_heading,
    touches_flat,
    vertex_place,
)
from analytic.spatial.kernel.records import (
    DOES,
    EDGE,
    EDGE_PIVOT,
    EDGE_SLIDE,
    EDGE_STICK,
    FACET,
    FLAT_PIVOT,
    FLAT_REST,
    FLAT_SLIDE,
    FLIGHT,
    IMPACT,
    KEEPS,
    NO_MODE,
    NOTHING,
    PIVOTS,
    SECTORS,
    SETTLED,
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
    axes,
    cross,
    dot,
    field,
    length,
    minus,
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
    down, side = -field[2], math.sqrt(field[0] * field[0] + field[1] * field[1])
    along = -dot(rows[2], row3(m.at, m.touch[0])) / down if down != 0.0 else math.inf
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


# Restitution: what an impact gives back of the normal velocities of the vertices that strike.
#
# After it every vertex' normal velocity is at least −e times that before, and just that where its impulse
# pushes; friction goes by the tangential velocity after it (Moreau's law). That is the plastic impact of a
# body whose vertices come down 1 + e times as fast and slide as they do. As all of them lie in one level
# plane that is a velocity of a rigid body again.


LEAST_RISE_M: Final = 1e-6
"""An impact after which no vertex would rise higher is plastic: bounces that die out come to an end."""
GAIN: Final = 1e-9
"""Share of the kinetic energy by which it may grow: what solving for the impulses leaves open."""


@jit
def strike(s: Run, m: Memory, rows: Rows, size: float) -> tuple[bool, bool]:
    """Set the impulses and the mode of an impact: whether there are any, and whether they give something back.

    Plastic where too little would come back to be seen, and where a friction that turns a vertex round would add energy.
    """
    v0, w0 = vector(m.y, 7), vector(m.y, 10)
    if s.restitution * -least_up(s, m, rows, m.u) > math.sqrt(2.0 * s.gravity_m_s2 * LEAST_RISE_M):
        _come_faster(s, m, rows, v0, w0)
        vertex_velocities(s, m, m.y)
        returns = choose(s, m, rows, to_body(rows, vector(m.y, 7)), True, (1.0 + s.restitution) * size)
        put(m.y, 7, v0)
        put(m.y, 10, w0)
        if returns and not _gains(s, m, to_body(rows, v0), w0):
            return True, True
        # The plastic impact is chosen by what the vertices really do, and the trial left its own in memory.
        vertex_velocities(s, m, m.y)
    found = False
    for sectors in SECTORS:
        s.sectors = sectors
        found = found or choose(s, m, rows, to_body(rows, v0), True, size)
    s.sectors = SECTORS[0]
    return found, False


@jit
def _come_faster(s: Run, m: Memory, rows: Rows, v0: Vector, w0: Vector) -> None:
    """Give the body the velocity with which what touches comes down 1 + e times as fast and slides as it does."""
    spin, z, e = to_table(rows, w0), to_table(rows, row3(m.at, m.touch[0]))[2], s.restitution
    put(m.y, 7, plus(v0, (-e * spin[1] * z, e * spin[0] * z, e * v0[2])))
    put(m.y, 10, plus(w0, to_body(rows, (e * spin[0], e * spin[1], 0.0))))


@jit
def _gains(s: Run, m: Memory, v0: Vector, w0: Vector) -> bool:
    """Whether the impulses in memory would add kinetic energy (velocities in the body's frame)."""
    dv, dw = vector(m.response, 0), vector(m.response, 3)
    before = s.mass_kg * dot(v0, v0) + dot(w0, apply(m.inertia, w0))
    half_v, half_w = plus(v0, times(0.5, dv)), plus(w0, times(0.5, dw))
    gained: float = 2.0 * (s.mass_kg * dot(half_v, dv) + dot(half_w, apply(m.inertia, dw)))
    return gained > GAIN * before


ROUNDED: Final = 4.4e-16
"""Two roundings, relative: of a sum and of its parts."""
PUSHED_M_S: Final = 1e-11
"""A vertex that is pushed down more slowly than this is turned by any force before its gap is more than rounding."""
DROPPED: Final = 4.0
"""Slip over the approach speed up to which an impact of less than `settle_m_s` leaves its vertices standing."""
CHOICES: Final = 4
"""So often a mode is chosen again where its own forces, once the state is in it, pull by more than"""
PULLED: Final = 1e-6
"""this share of the weight: above it is no rounding."""


@jit
def limits(s: Run, m: Memory, zero: float, impulse: bool) -> float:
    """Set what each touching vertex' friction can do from its velocity; the largest speed among them.

    A vertex that does not slide sticks up to the static coefficient. Under impulses one that slides may stick too, up to the
    kinetic one.
    """
    rows, fastest, slow = axes(m.y), 0.0, 0
    vertex_velocities(s, m, m.y)
    for i in touched(s, m):
        x = to_table(rows, row3(m.u, i))
        speed = math.sqrt(x[0] * x[0] + x[1] * x[1])
        slides = speed > zero
        m.known[i] = 1 if slides and not impulse else 0
        if slides:
            m.heading[i, 0], m.heading[i, 1] = x[0] / speed, x[1] / speed
        m.stick_limit[i] = s.friction_kinetic if slides and impulse else s.friction_static
        m.slide_limit[i] = s.friction_kinetic
        fastest = max(fastest, length(x))
        slow += 0 if slides else 1
    if slow > 1 and s.touching > 2:
        # Two vertices of a flat base at rest: the others are only little faster, and none has a direction of its own.
        for i in touched(s, m):
            m.known[i] = 0
    return fastest


@jit
def find_mode(s: Run, m: Memory, still_m_s: float) -> bool:
    """Set the mode of the vertices that are down from their own accelerations, those slower than still_m_s beginning from rest;
    False if none is possible."""
    set_touch(s, m)
    limits(s, m, still_m_s, False)
    g = field(s, m, s.time_s)
    free_accelerations(s, m, m.y, g)
    return choose(s, m, axes(m.y), g, False, max(length(g), largest(s, m)))


@jit
def decide(s: Run, m: Memory, dropped_m_s: float) -> None:
    """Choose the mode of the vertices that are down, and put the state into it; what slides more slowly than `dropped_m_s` may
    stand still in it."""
    for _ in range(CHOICES):
        if not _choose_slowly(s, m, dropped_m_s):
            s.outcome = NO_MODE
            return
        enter(s, m)
        if _presses(s, m):
            return


@jit
def _choose_slowly(s: Run, m: Memory, dropped_m_s: float) -> bool:
    """Set a mode; False if none is possible, whatever the directions of slow vertices are."""
    if dropped_m_s > 10.0 * s.still_m_s and find_mode(s, m, dropped_m_s):
        return True
    found = False
    for sectors in SECTORS:
        s.sectors = sectors
        # What a slow vertex' direction is lies within the errors of its velocity: where no mode goes with it, others are asked.
        # Last one whose rebound was dropped: where impacts of two vertices by turns come to their end both stand still.
        for slower_m_s in (10.0 * s.still_m_s, s.still_m_s, 100.0 * s.still_m_s, 1000.0 * s.still_m_s, s.settle_m_s):
            found = found or find_mode(s, m, slower_m_s)
    s.sectors = SECTORS[0]
    if found:
        return True
    # Friction of what stays only because its rebound is too small to be seen may leave no mode: then it does rebound.
    touched = s.touching
    _leave(s, m, PUSHED_M_S)
    return s.touching < touched and find_mode(s, m, 10.0 * s.still_m_s)


@jit
def _presses(s: Run, m: Memory) -> bool:
    """Whether what slides is pressed down still by the forces at the state that was put into its mode.

    On a base of three vertices nearly in a line what is taken from slow velocities gives them other directions.
    """
    if s.mode not in (FLAT_SLIDE, EDGE_SLIDE):
        return True
    s.slow = False
    rows = axes(m.y)
    contact_forces(s, m, m.y, rows, field(s, m, s.time_s))
    return least_up(s, m, rows, m.force) >= -PULLED * s.mass_kg * s.gravity_m_s2


@jit
def _drop_rebounds(s: Run, m: Memory) -> None:
    """Take away what the mode's vertices rise by; where that would push down another that touches, what all of them do."""
    m.ys[:] = m.y
    hold_velocity(s, m, m.y)
    vertex_velocities(s, m, m.y)
    if least_up(s, m, axes(m.y), m.u) < -PUSHED_M_S:
        m.y[:] = m.ys
        hold_level(s, m, m.y)


@jit
def enter(s: Run, m: Memory) -> None:
    """Put the state into the mode just chosen: what does not take part is free, what sticks has its place."""
    if not touches_flat(s.mode):
        if s.mode != FLIGHT and s.touching > 1:
            _drop_rebounds(s, m)
        for i in range(m.vertices):
            m.down[i] = 1 if takes_part(s.mode, s.a, s.b, i) else 0
        set_touch(s, m)
    for i in touched(s, m):
        at = vertex_place(m, m.y, i)
        m.anchor[i, 0], m.anchor[i, 1] = at[0], at[1]
        m.heading[i, 0], m.heading[i, 1] = m.slide[i, 0], m.slide[i, 1]
    hold_place(s, m, m.y)
    hold_velocity(s, m, m.y)
    take_heading(s, m, m.y)
    s.fresh = True
    note_interval(s, m)


@jit
def collide(s: Run, m: Memory, vertex: int) -> None:
    """The impact of the vertices that reach the floor, with those that are there already."""
    for i in range(m.vertices):
        if vertex_place(m, m.y, i)[2] <= s.touch_m:
            m.down[i] = 1
    set_touch(s, m)
    rows, before_j = axes(m.y), kinetic_energy(s, m, m.y)
    size = limits(s, m, 10.0 * s.still_m_s, True)
    lands_m_s = -least_up(s, m, rows, m.u)
    v0, w0 = vector(m.y, 7), vector(m.y, 10)
    possible, returns = strike(s, m, rows, size)
    if not possible:
        s.outcome = NO_MODE
        return
    cone = _worst_cone(s, m)
    m.impulse[:] = 0.0
    if s.mode == FLAT_REST and not returns:
        m.y[7:13] = 0.0
    else:
        put(m.y, 7, plus(v0, to_table(rows, vector(m.response, 0))))
        put(m.y, 10, plus(w0, vector(m.response, 3)))
    total, moment = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for i in touched(s, m):
        f = row3(m.force, i)
        total, moment = plus(total, f), plus(moment, cross(row3(m.at, i), f))
        m.impulse[i, 0], m.impulse[i, 1], m.impulse[i, 2] = to_table(rows, f)
    _audit_momentum(s, m, v0, w0, to_table(rows, total), moment)
    s.impacts += 1
    _leave(s, m, s.settle_m_s)
    settled = _settle(s, m)
    loss = before_j - kinetic_energy(s, m, m.y)
    s.impact_loss_j += loss
    s.cone_residual = max(s.cone_residual, cone)
    # From less than what is dropped of a rebound: the slip that such an impact sets off ends by itself as soon.
    decide(s, m, DROPPED * lands_m_s if lands_m_s <= s.settle_m_s else 0.0)
    note_event(s, m, SETTLED if settled else IMPACT, vertex, loss, cone)
    m.impulse[:] = 0.0


@jit
def _audit_momentum(s: Run, m: Memory, v0: Vector, w0: Vector, total: Vector, moment: Vector) -> None:
    """Keep the largest residual of the balances of momentum and angular momentum, relative to what was exchanged; what rounding
    of the velocities makes is none."""
    v, w = vector(m.y, 7), vector(m.y, 10)
    dv, dw = minus(v, v0), minus(w, w0)
    linear = length(minus((s.mass_kg * dv[0], s.mass_kg * dv[1], s.mass_kg * dv[2]), total))
    angular = length(minus(apply(m.inertia, dw), moment))
    reach = length(row3(m.at, m.touch[0]))
    rounding = (
        s.mass_kg * (length(v0) + length(v)) + (length(apply(m.inertia, w0)) + length(apply(m.inertia, w))) / reach
    )
    scale = length(total) + length(moment) / reach
    if scale > 0.0:
        residual = linear + angular / reach - ROUNDED * rounding
        s.momentum_residual = max(s.momentum_residual, residual / scale)


@jit
def _worst_cone(s: Run, m: Memory) -> float:
    """By how much impulses leave their cones, relative to their sum, an edge's split as friction allows."""
    if s.mode == FLIGHT or s.friction_static >= UNLIMITED:
        return 0.0
    rows, total, worst = axes(m.y), 0.0, 0.0
    for i in touched(s, m):
        f = to_table(rows, row3(m.force, i))
        total += abs(f[2])
        t = math.sqrt(f[0] * f[0] + f[1] * f[1])
        worst = max(worst, -f[2], t - max(m.stick_limit[i], m.slide_limit[i]) * f[2] if s.mode != EDGE_STICK else -f[2])
    return worst / total if total > 0.0 else 0.0


@jit
def _leave(s: Run, m: Memory, least_m_s: float) -> None:
    """Let go of the vertices that rise faster than this."""
    vertex_velocities(s, m, m.y)
    rows, rises_m_s = axes(m.y), max(least_m_s, 1e-9 * largest(s, m))
    for i in touched(s, m):
        if dot(rows[2], row3(m.u, i)) > rises_m_s:
            m.down[i] = 0
    set_touch(s, m)


@jit
def _settle(s: Run, m: Memory) -> bool:
    """Bring to rest what leaves the floor too slowly for its rebound to be seen; True if that was done."""
    vertex_velocities(s, m, m.y)
    slow = s.touching > 2 and largest(s, m) <= s.settle_m_s
    if not slow or not rests(s, m, axes(m.y), field(s, m, s.time_s)):
        return False
    m.y[7:13] = 0.0
    s.settled += 1
    return True
