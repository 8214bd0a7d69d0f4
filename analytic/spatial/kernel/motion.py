"""The motion in each mode: its equations, a state put exactly into it, what ends it, and what is kept of it."""

import math
from typing import Final

from analytic.kernel.compiler import inlined, jit, store_double
from analytic.kernel.records import Floats
from analytic.spatial.kernel.contact import (
    UNLIMITED,
    Rows,
    along_across,
    clear,
    columns,
    edge_margin,
    flat_margin,
    free_accelerations,
    normal,
    pivot_directions,
    set_column,
    solve_columns,
    solve_flat,
    tangent,
    vertex_velocities,
)
from analytic.spatial.kernel.records import (
    DOES,
    EDGE_PIVOT,
    EDGE_SLIDE,
    EDGE_STICK,
    EVENT_HEAD,
    FACET,
    FLAT_PIVOT,
    FLAT_REST,
    FLAT_SLIDE,
    FLIES,
    FLIGHT,
    FREE,
    INTERVAL_HEAD,
    KEEPS,
    LOST,
    PIVOTS,
    SLIDING,
    STATE,
    STICKING,
    STICKS,
    VERTEX_SLIDE,
    VERTEX_STICK,
    WATCH_FRICTION,
    WATCH_GAP,
    WATCH_NORMAL,
    WATCH_SPEED,
    WATCH_TILT,
    WORK,
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
    turn,
    vector,
)

# The equations of motion of each mode, and the forces that go with them.


SHIFT: Final = 4.0
"""Of the slowest sliding: friction turns round beyond where a vertex that stops is seen to have stopped (`arm`)."""


@inlined
def touches_flat(mode: int) -> bool:
    """Whether a facet lies on the floor."""
    return KEEPS[mode] == FACET


@jit
def set_slides(s: Run, m: Memory, y: Floats, rows: Rows) -> None:
    """Directions of sliding at a state; a vertex slower than `still_m_s` keeps the one that it began with, and one that comes
    straight back keeps it to the step's end: where it stops is found on a velocity that goes on smoothly.

    In a slow step all vertices have SHIFT of that speed more, each in its direction at the start: then the directions are smooth.
    """
    spin, v, shift = vector(y, 10), to_body(rows, vector(y, 7)), SHIFT * s.still_m_s
    first = to_table(rows, row3(m.at, m.touch[0]))
    for i in touched(s, m):
        x = plus(v, cross(spin, row3(m.at, i)))
        dx, dy = dot(rows[0], x), dot(rows[1], x)
        if s.slow:
            arm = minus(to_table(rows, row3(m.at, i)), first)
            dx += shift * m.heading[i, 0] + m.bent[0] - m.bent[2] * arm[1]
            dy += shift * m.heading[i, 1] + m.bent[1] + m.bent[2] * arm[0]
        speed = math.sqrt(dx * dx + dy * dy)
        along, across = dx * m.heading[i, 0] + dy * m.heading[i, 1], dy * m.heading[i, 0] - dx * m.heading[i, 1]
        back = along < 0.0 and abs(across) <= s.still_m_s
        if speed > (s.still_m_s if not s.slow else 0.0) and not back:
            m.slide[i, 0], m.slide[i, 1] = dx / speed, dy / speed
        else:
            m.slide[i, 0], m.slide[i, 1] = m.heading[i, 0], m.heading[i, 1]


@jit
def contact_forces(s: Run, m: Memory, y: Floats, rows: Rows, g: Vector) -> bool:
    """Write the contact forces and the response of the present mode of motion; False where its equations have no solution."""
    clear(s, m)
    m.response[:] = 0.0
    if s.mode == FLIGHT:
        return True
    free_accelerations(s, m, y, g)
    if s.mode == FLAT_PIVOT:
        pivot_directions(s, m, rows, s.a, s.sign)
        return solve_flat(s, m, rows, s.mode, s.a)
    if s.mode == FLAT_SLIDE:
        set_slides(s, m, y, rows)
        return solve_flat(s, m, rows, s.mode, -1)
    if s.mode == EDGE_SLIDE or s.mode == VERTEX_SLIDE:
        set_slides(s, m, y, rows)
    return solve_columns(s, m, columns(m, rows, s.mode, s.a, s.b, s.sign))


@jit
def rates(s: Run, m: Memory, y: Floats, t: float, out: Floats) -> None:
    """Write the state's rates in the present mode."""
    rows, spin, v = axes(y), vector(y, 10), vector(y, 7)
    g = field(s, m, t)
    lost = 0.0
    if s.mode == FLAT_REST:
        out[:] = 0.0
        return
    momentum = cross(apply(m.inertia, spin), spin)
    if s.mode == FLIGHT:
        accel, alpha = g, apply(m.inverse, momentum)
    elif s.mode == VERTEX_STICK or s.mode == EDGE_STICK:
        arm = row3(m.at, s.a)
        # About the fixed vertex O, r from it to the centroid −arm: I_O ω̇ + ω × I_O ω = m r × g_e.
        turn = times(s.mass_kg, cross(to_body(rows, g), arm))
        if s.mode == VERTEX_STICK:
            about = minus(momentum, times(s.mass_kg, cross(spin, cross(arm, cross(spin, arm)))))
            alpha = apply(m.about[s.a], plus(turn, about))
        else:
            edge = minus(row3(m.at, s.b), arm)
            edge = times(1.0 / length(edge), edge)
            reach = cross(edge, arm)
            inertia = dot(edge, apply(m.inertia, edge)) + s.mass_kg * dot(reach, reach)
            alpha = times(dot(edge, turn) / inertia, edge)
        accel = to_table(rows, minus(times(-1.0, cross(alpha, arm)), cross(spin, cross(spin, arm))))
    else:
        contact_forces(s, m, y, rows, g)
        pull, twist = vector(m.response, 0), vector(m.response, 3)
        accel = plus(g, to_table(rows, pull))
        alpha = plus(apply(m.inverse, momentum), twist)
        lost = sliding_power(s, m, y, rows)
    put(out, 0, v)
    w, x, y_, z = y[3], y[4], y[5], y[6]
    out[3] = 0.5 * (-x * spin[0] - y_ * spin[1] - z * spin[2])
    out[4] = 0.5 * (w * spin[0] + y_ * spin[2] - z * spin[1])
    out[5] = 0.5 * (w * spin[1] + z * spin[0] - x * spin[2])
    out[6] = 0.5 * (w * spin[2] + x * spin[1] - y_ * spin[0])
    put(out, 7, accel)
    put(out, 10, alpha)
    out[WORK] = s.mass_kg * dot(g, v)
    out[LOST] = lost


@jit
def sliding_power(s: Run, m: Memory, y: Floats, rows: Rows) -> float:
    """Work lost in a second by the forces in memory where they slide: −Σ F · v, W."""
    spin, v, total = vector(y, 10), to_body(rows, vector(y, 7)), 0.0
    for i in touched(s, m):
        total -= dot(row3(m.force, i), plus(v, cross(spin, row3(m.at, i))))
    return total


@jit
def kinetic_energy(s: Run, m: Memory, y: Floats) -> float:
    """Of the body in the table's frame, J."""
    v, spin = vector(y, 7), vector(y, 10)
    return 0.5 * (s.mass_kg * dot(v, v) + dot(spin, apply(m.inertia, spin)))


# A state put exactly into its mode: what steps and events leave by rounding is taken away, place and velocity.


@jit
def vertex_place(m: Memory, y: Floats, i: int) -> Vector:
    """Place of vertex i in the table's frame."""
    return plus(vector(y, 0), to_table(axes(y), row3(m.at, i)))


@jit
def hold_place(s: Run, m: Memory, y: Floats) -> None:
    """Turn and shift the body so that what touches is on the floor, and what sticks is where it stuck."""
    if s.mode == FLIGHT or s.mode == VERTEX_STICK or s.mode == VERTEX_SLIDE:
        turn(y, (0.0, 0.0, 0.0))
    elif touches_flat(s.mode):
        i, j, k = m.touch[0], m.touch[1], m.touch[2]
        rows = axes(y)
        p = row3(m.at, i)
        up = to_table(rows, cross(minus(row3(m.at, j), p), minus(row3(m.at, k), p)))
        up = times(1.0 / length(up), up)
        # What is left is small: the cross product of two unit vectors is the turn from one to the other, to third order.
        turn(y, cross(up, (0.0, 0.0, 1.0)))
    else:
        d = to_table(axes(y), minus(row3(m.at, s.b), row3(m.at, s.a)))
        wanted = (d[0], d[1], 0.0)
        if s.mode == EDGE_STICK:
            wanted = (m.anchor[s.b, 0] - m.anchor[s.a, 0], m.anchor[s.b, 1] - m.anchor[s.a, 1], 0.0)
        turn(y, times(1.0 / (length(d) * length(wanted)), cross(d, wanted)))
    if s.mode == FLIGHT:
        return
    i = s.a if not touches_flat(s.mode) or s.mode == FLAT_PIVOT else m.touch[0]
    x = vertex_place(m, y, i)
    y[2] -= x[2]
    if s.mode in (VERTEX_STICK, EDGE_STICK, EDGE_PIVOT, FLAT_PIVOT):
        y[0] += m.anchor[i, 0] - x[0]
        y[1] += m.anchor[i, 1] - x[1]


@jit
def _stop(s: Run, m: Memory, y: Floats, turning: bool) -> None:
    """Take away the velocities that the mode does not have by impulses where it holds them; that of turning too where asked."""
    rows, n = axes(y), 0
    vertex_velocities(s, m, y)
    a, b = s.a if not touches_flat(s.mode) or s.mode == FLAT_PIVOT else m.touch[0], s.b
    for c in range(0 if s.mode in (VERTEX_STICK, EDGE_STICK, EDGE_PIVOT, FLAT_PIVOT) else 2, 3):
        set_column(m, n, a, rows[c], rows[c])
        n += 1
    if touches_flat(s.mode):
        third = s.touching // 3
        start = 0
        for k in range(s.touching):
            if m.touch[k] == a:
                start = k
        b = m.touch[(start + third) % s.touching]
        for k in (start + third, start + 2 * third):
            set_column(m, n, m.touch[k % s.touching], rows[2], rows[2])
            n += 1
    elif s.mode not in (VERTEX_STICK, VERTEX_SLIDE):
        set_column(m, n, b, rows[2], rows[2])
        n += 1
    if turning:
        across = along_across(m, rows, a, b)[1]
        set_column(m, n, b, across, across)
        n += 1
    if solve_columns(s, m, n):
        put(y, 7, plus(vector(y, 7), to_table(rows, vector(m.response, 0))))
        put(y, 10, plus(vector(y, 10), vector(m.response, 3)))


@jit
def hold_velocity(s: Run, m: Memory, y: Floats) -> None:
    """Take away the velocities that the mode does not have: what that costs in energy is of second order in what is taken."""
    if s.mode == FLIGHT:
        return
    if s.mode == FLAT_REST:
        y[7:13] = 0.0
        return
    _stop(s, m, y, s.mode == EDGE_STICK)
    if s.mode in (EDGE_PIVOT, FLAT_PIVOT) and s.sign * dot(axes(y)[2], vector(y, 10)) < 0.0:
        # What was taken has turned it round, or it did turn the other way: what turns from rest must not.
        _stop(s, m, y, True)


@jit
def hold_level(s: Run, m: Memory, y: Floats) -> None:
    """Take away at once what the vertices that touch still rise by: a rebound dropped at one must not push another down."""
    rows, n = axes(y), min(s.touching, 3)
    vertex_velocities(s, m, y)
    for k in range(n):
        set_column(m, k, m.touch[k * s.touching // n], rows[2], rows[2])
    if solve_columns(s, m, n):
        put(y, 7, plus(vector(y, 7), to_table(rows, vector(m.response, 0))))
        put(y, 10, plus(vector(y, 10), vector(m.response, 3)))


@jit
def take_heading(s: Run, m: Memory, y: Floats) -> None:
    """Note in which direction each touching vertex slides now; a vertex slower than `still_m_s` keeps its direction."""
    rows = axes(y)
    vertex_velocities(s, m, y)
    for i in touched(s, m):
        x = to_table(rows, row3(m.u, i))
        speed = math.sqrt(x[0] * x[0] + x[1] * x[1])
        # The direction of a slower one is rounding.
        if speed > s.still_m_s:
            m.heading[i, 0], m.heading[i, 1] = x[0] / speed, x[1] / speed


@jit
def set_touch(s: Run, m: Memory) -> None:
    """List the vertices that are down in the order of their polygon, by angle about their middle, from above."""
    x, y, n = 0.0, 0.0, 0
    for i in range(m.vertices):
        if m.down[i] != 0:
            m.touch[n] = i
            x, y, n = x + vertex_place(m, m.y, i)[0], y + vertex_place(m, m.y, i)[1], n + 1
    s.touching = n
    if n < 3:
        return
    x, y = x / n, y / n
    for k in range(1, n):
        i = m.touch[k]
        at = vertex_place(m, m.y, i)
        angle, j = math.atan2(at[1] - y, at[0] - x), k
        while j > 0:
            before = vertex_place(m, m.y, m.touch[j - 1])
            if math.atan2(before[1] - y, before[0] - x) <= angle:
                break
            m.touch[j] = m.touch[j - 1]
            j -= 1
        m.touch[j] = i


# What ends a mode of motion: functions that are positive while it lasts (of rest: `integrator.rest_margin`).


ROUNDED_M: Final = 2e-15
"""Rounding of a gap, the difference of heights of some metres."""
ROUNDED: Final = 1e-10
"""The same of forces, in the body's weight: they are differences of accelerations, solved for."""


@inlined
def _note(m: Memory, n: int, kind: int, vertex: int, value: float) -> int:
    m.watch[n], m.watch_kind[n], m.watch_vertex[n] = value, kind, vertex
    return n + 1


@jit
def heading_speed(m: Memory, y: Floats, rows: Rows, i: int) -> float:
    """Vertex i's velocity along its direction of sliding at the start of the step, m/s."""
    x = plus(to_table(rows, cross(vector(y, 10), row3(m.at, i))), vector(y, 7))
    return float(x[0] * m.heading[i, 0] + x[1] * m.heading[i, 1])


@jit
def _watch_flat(s: Run, m: Memory, y: Floats, rows: Rows, n: int, ok: bool) -> int:
    if s.mode == FLAT_PIVOT:
        n = _note(m, n, WATCH_SPEED, -1, s.sign * dot(rows[2], vector(y, 10)))
        if s.friction_static < UNLIMITED:
            n = _note(m, n, WATCH_FRICTION, s.a, s.friction_static * normal(m, rows, s.a) - tangent(m, rows, s.a))
    else:
        for i in touched(s, m):
            n = _note(m, n, WATCH_SPEED, i, heading_speed(m, y, rows, i))
    return _note(m, n, WATCH_NORMAL, -1, flat_margin(s, m, ok))


@jit
def watch(s: Run, m: Memory, y: Floats, t: float) -> int:
    """Write the mode's event functions at a state; their number."""
    rows, n = axes(y), 0
    n = _note(m, n, WATCH_TILT, -1, rows[2][2] - s.overturn_cos)
    for i in range(m.vertices):
        # Only a vertex in the air can come down: the gap of one that touches is rounding, of either sign.
        if m.down[i] == 0:
            n = _note(m, n, WATCH_GAP, i, vertex_place(m, y, i)[2])
    if s.mode == FLIGHT:
        return n
    ok = contact_forces(s, m, y, rows, field(s, m, t))
    if touches_flat(s.mode):
        return _watch_flat(s, m, y, rows, n, ok)
    a, b = s.a, s.b
    two = s.mode != VERTEX_STICK and s.mode != VERTEX_SLIDE
    n = _note(m, n, WATCH_NORMAL, a, normal(m, rows, a))
    if two:
        n = _note(m, n, WATCH_NORMAL, b, normal(m, rows, b))
    if s.mode == EDGE_PIVOT:
        n = _note(m, n, WATCH_SPEED, b, s.sign * dot(rows[2], vector(y, 10)))
    if s.mode == EDGE_SLIDE or s.mode == VERTEX_SLIDE:
        n = _note(m, n, WATCH_SPEED, a, heading_speed(m, y, rows, a))
        if two:
            n = _note(m, n, WATCH_SPEED, b, heading_speed(m, y, rows, b))
    elif s.friction_static < UNLIMITED:
        if s.mode == EDGE_STICK:
            n = _note(m, n, WATCH_FRICTION, -1, edge_margin(m, rows, a, b))
        else:
            n = _note(m, n, WATCH_FRICTION, a, s.friction_static * normal(m, rows, a) - tangent(m, rows, a))
    return n


@inlined
def clearance(s: Run, kind: int) -> float:
    """What a function must exceed before its sign counts: less is rounding of the event that began the mode."""
    if kind == WATCH_GAP:
        return ROUNDED_M
    if kind == WATCH_SPEED:
        return s.still_m_s
    return ROUNDED * s.mass_kg * s.gravity_m_s2 if kind != WATCH_TILT else 0.0


@jit
def arm(s: Run, m: Memory, count: int, fresh: bool) -> None:
    """Lift functions that begin at zero, and set down those that have become clear of it."""
    for k in range(count):
        least = clearance(s, m.watch_kind[k])
        if fresh:
            m.offset[k] = max(2.0 * least - m.watch[k], 0.0)
        elif m.watch[k] > least:
            m.offset[k] = 0.0


@jit
def lowest(s: Run, m: Memory, y: Floats, t: float) -> float:
    """Least of the event functions, positive while the mode lasts."""
    least = math.inf
    s.watched = watch(s, m, y, t)
    for k in range(s.watched):
        least = min(least, m.watch[k] + m.offset[k])
    return least


@inlined
def sample(s: Run, m: Memory, time: float, y: Floats) -> None:
    """Write the next output sample."""
    start = s.samples * (STATE - 1)
    store_double(m.history, start, time)
    for c in range(STATE - 2):
        store_double(m.history, start + 1 + c, y[c])
    s.samples += 1


@jit
def _vertex_state(s: Run, m: Memory, i: int) -> int:
    does = DOES[s.mode]
    if m.down[i] == 0 or does == FLIES:
        return FREE
    return STICKING if does == STICKS or (does == PIVOTS and i == s.a) else SLIDING


@jit
def note_interval(s: Run, m: Memory) -> None:
    """Write the present mode as the next interval, if there is room."""
    if s.intervals < m.rows:
        start = s.intervals * (INTERVAL_HEAD + m.vertices)
        store_double(m.interval_table, start, s.time_s)
        store_double(m.interval_table, start + 1, s.mode)
        for i in range(m.vertices):
            store_double(m.interval_table, start + INTERVAL_HEAD + i, _vertex_state(s, m, i))
    s.intervals += 1


@jit
def note_event(s: Run, m: Memory, kind: int, vertex: int, loss: float, cone: float) -> None:
    """Write an event, if there is room; the impulses of an impact are those in memory (table's frame: `m.impulse`)."""
    if s.events < m.rows:
        start = s.events * (EVENT_HEAD + 3 * m.vertices)
        head = (s.time_s, float(kind), float(vertex), float(s.mode), loss, cone)
        for c in range(EVENT_HEAD):
            store_double(m.event_table, start + c, head[c])
        for i in range(m.vertices):
            for c in range(3):
                store_double(m.event_table, start + EVENT_HEAD + 3 * i + c, m.impulse[i, c])
    s.events += 1


@jit
def audit(s: Run, m: Memory, start_j: float) -> None:
    """Keep the largest residual of the balance of energy, relative to m g times the height of the centroid's reach."""
    # Kinetic energy less that at the start is the field's work less what sliding and impacts took.
    balance = kinetic_energy(s, m, m.y) - start_j - m.y[WORK] + m.y[LOST] + s.impact_loss_j
    s.energy_residual = max(s.energy_residual, abs(balance) / s.energy_scale_j)


@jit
def note_peak(s: Run, y: Floats) -> None:
    """Keep the largest tilt of the body's axis from the vertical."""
    # The last item of the rotation matrix is the cosine of the tilt; rounding may take it past one.
    up = y[3] * y[3] + y[6] * y[6] - y[4] * y[4] - y[5] * y[5]
    s.peak_tilt_rad = max(s.peak_tilt_rad, math.acos(min(max(up, -1.0), 1.0)))
