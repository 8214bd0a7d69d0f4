"""Impacts: impulses at all vertices that touch, at once, and the mode after an event."""

import math
from typing import Final

from analytic.kernel.compiler import jit
from analytic.spatial.kernel.contact import UNLIMITED, Rows, free_accelerations, largest, least_up, vertex_velocities
from analytic.spatial.kernel.modes import choose, rests, takes_part
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
    EDGE_SLIDE,
    EDGE_STICK,
    FLAT_REST,
    FLAT_SLIDE,
    FLIGHT,
    IMPACT,
    NO_MODE,
    SECTORS,
    SETTLED,
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
