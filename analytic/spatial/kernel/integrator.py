"""One run: rests, and steps cut at the first event of the mode; then the impact and the next mode."""

import math
from typing import Final

import numpy as np
from scipy.integrate import DOP853

from analytic.kernel.compiler import cell_at, inlined, jit, load_double
from analytic.kernel.records import HARMONIC, NONE, RECTANGULAR, SAMPLED, Floats
from analytic.spatial.kernel.contact import UNLIMITED, edge_friction, normal, tangent, vertex_velocities
from analytic.spatial.kernel.impact import collide, decide, edge_distance, enter, find_mode, rests, thrust
from analytic.spatial.kernel.motion import (
    arm,
    audit,
    contact_forces,
    hold_place,
    hold_velocity,
    kinetic_energy,
    lowest,
    note_event,
    note_peak,
    rates,
    sample,
    take_heading,
    vertex_place,
    watch,
)
from analytic.spatial.kernel.records import (
    BREAK,
    EDGE_PIVOT,
    EDGE_SLIDE,
    EDGE_STICK,
    END,
    FLAT_REST,
    FLAT_SLIDE,
    FLIGHT,
    GAVE_UP,
    MEMORY,
    OVERTURN,
    OVERTURNED,
    RUN,
    RUNNING,
    SLIP_ONSET,
    STANDS,
    START,
    STATE,
    STICK_ONSET,
    UNDECIDED,
    UPLIFT,
    VERTEX_SLIDE,
    VERTEX_STICK,
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
    all_over,
    axes,
    cross,
    dot,
    field,
    minus,
    pass_breaks,
    plus,
    row3,
    times,
    to_table,
    touched,
    vector,
)

# Steps of slow sliding, implicit in what is stiff there.
#
# Friction turns a vertex that slides with v within |v|/(μ g), far faster than anything else moves; an explicit step spans only
# some of these times. The linearly implicit Euler step with any matrix J has an expansion in its length, and is extrapolated
# (Hairer and Wanner, Solving Ordinary Differential Equations II, IV.9). Here J = U V has rank three: V is what the level motion
# of what touches (two velocities of its first vertex, and yaw) changes with the state, U what the rates change with it as
# vertices turn.


COARSE: Final = 1e-9
"""Local error from which fewer extrapolations cost less."""
FEW: Final = 4
"""Extrapolations there, and"""
MANY: Final = 5
"""for a finer one: five weights raise the rounding of slow velocities two hundredfold, eight several thousandfold."""
SLOW_S: Final = 3e-5
"""A vertex that friction turns faster than in this is slow: an explicit step spans some six such times; and"""
COARSE_SLOW_S: Final = 1.5e-4
"""where slow steps are longer."""
FINEST: Final = 1e-12
"""Least local error of a slow step: the rounding of slow velocities, raised as above, stays below."""
FIRST: Final = 2
"""Parts of the step in the first of them; one more in each that follows."""
BENT: Final = 1e-4
"""Share of the slowest vertex' speed by which velocities are changed to see how the rates follow."""


@inlined
def extrapolations(s: Run) -> int:
    """How often a slow step is extrapolated: its order."""
    return FEW if s.tolerance >= COARSE else MANY


@inlined
def is_slow(s: Run, turning_s: float) -> bool:
    """Whether slow steps are cheaper than explicit ones."""
    return turning_s < (COARSE_SLOW_S if s.tolerance >= COARSE else SLOW_S)


@jit
def turning_time_s(s: Run, m: Memory) -> float:
    """Time within which friction turns the slowest vertex whose direction follows its velocity, s; infinite if there is none."""
    if s.mode not in (FLAT_SLIDE, EDGE_SLIDE, VERTEX_SLIDE) or not s.friction_kinetic > 0.0:
        return math.inf
    rows, least_m_s = axes(m.y), math.inf
    vertex_velocities(s, m, m.y)
    for i in touched(s, m):
        x = to_table(rows, row3(m.u, i))
        least_m_s = min(least_m_s, math.sqrt(x[0] * x[0] + x[1] * x[1]))
    return max(least_m_s, s.still_m_s) / (s.friction_kinetic * s.gravity_m_s2)


@jit
def _level(m: Memory, rows: tuple[Vector, Vector, Vector], i: int, change: Floats) -> Vector:
    """V: change of the level motion (velocities of vertex i along x and y, yaw) with that of the state, from the present one."""
    spin, arm = vector(m.y, 10), row3(m.at, i)
    # Where the body turns its vertices' velocities do, though its own velocities stay: without that the slow motion is not seen.
    w, axis, turned = m.y[3], vector(m.y, 4), vector(change, 4)
    turn = minus(minus(times(2.0 * w, turned), times(2.0 * change[3], axis)), times(2.0, cross(axis, turned)))
    more = vector(change, 10)
    x = plus(vector(change, 7), to_table(rows, plus(cross(more, arm), cross(turn, cross(spin, arm)))))
    return x[0], x[1], dot(rows[2], plus(more, cross(turn, spin)))


@jit
def bend(s: Run, m: Memory, turning_s: float) -> None:
    """Write U and V U at the present state, by differences."""
    rows, first = axes(m.y), m.touch[0]
    speed, reach = BENT * turning_s * s.friction_kinetic * s.gravity_m_s2, 0.0
    for i in touched(s, m):
        for c in range(3):
            reach = max(reach, abs(m.at[i, c] - m.at[first, c]))
    rates(s, m, m.y, s.time_s, m.k1[0])
    for c in range(3):
        small = speed if c < 2 else speed / max(reach, math.sqrt(dot(row3(m.at, first), row3(m.at, first))))
        m.bent[c] = small
        rates(s, m, m.y, s.time_s, m.k1[1])
        m.bent[c] = 0.0
        for i in range(STATE):
            m.gain[c, i] = (m.k1[1, i] - m.k1[0, i]) / small
        x = _level(m, rows, first, m.gain[c])
        for i in range(3):
            m.returned[i, c] = x[i]


@inlined
def _inverse(m: Memory, h: float) -> tuple[Vector, Vector, Vector]:
    """Rows of (1 − h V U)⁻¹: those of the adjugate are cross products of the columns."""
    a = (1.0 - h * m.returned[0, 0], -h * m.returned[1, 0], -h * m.returned[2, 0])
    b = (-h * m.returned[0, 1], 1.0 - h * m.returned[1, 1], -h * m.returned[2, 1])
    c = (-h * m.returned[0, 2], -h * m.returned[1, 2], 1.0 - h * m.returned[2, 2])
    bc = cross(b, c)
    share = 1.0 / dot(a, bc)
    return times(share, bc), times(share, cross(c, a)), times(share, cross(a, b))


@jit
def slow_step(s: Run, m: Memory, h: float, out: Floats) -> float:
    """A step of length h from the present state, U and V U being there; its error over what is allowed."""
    rows, first, order = axes(m.y), m.touch[0], extrapolations(s)
    for j in range(order):
        parts = FIRST + j
        dt = h / parts
        inverse = _inverse(m, dt)
        # Changes, not states, are extrapolated: the weights raise rounding, here that of what is small.
        m.table[j, :] = 0.0
        for n in range(parts):
            for i in range(STATE):
                m.ys[i] = m.y[i] + m.table[j, i]
            rates(s, m, m.ys, s.time_s + (n + 1) * dt, m.k1[1])
            x = _level(m, rows, first, m.k1[1])
            q = (dot(inverse[0], x), dot(inverse[1], x), dot(inverse[2], x))
            for i in range(STATE):
                back = m.gain[0, i] * q[0] + m.gain[1, i] * q[1] + m.gain[2, i] * q[2]
                m.table[j, i] += dt * (m.k1[1, i] + dt * back)
        for k in range(j - 1, -1, -1):
            share = 1.0 / (parts / (FIRST + k) - 1.0)
            for i in range(STATE):
                m.table[k, i] = m.table[k + 1, i] + share * (m.table[k + 1, i] - m.table[k, i])
    total = 0.0
    for i in range(STATE):
        out[i] = m.y[i] + m.table[0, i]
        scale = s.energy_scale_j if i >= STATE - 2 else 1.0 + max(abs(m.y[i]), abs(out[i]))
        total += ((m.table[0, i] - m.table[1, i]) / (max(s.tolerance, FINEST) * scale)) ** 2
    return math.sqrt(total / STATE)


# The coefficients of DOP853: an explicit Runge-Kutta step of order 8 with errors of order 5 and 3 inside it.
#
# Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I, 2nd ed., section II.10.


STAGES: Final = 12
"""Evaluations of a step; the next step's first is one more."""
C: Final[Floats] = DOP853.C[:STAGES].copy()
"""Places of the stages in the step."""
# Contiguous, as compiled code reads them; scipy keeps those of its dense output in the same table.
A: Final[Floats] = np.ascontiguousarray(DOP853.A[:STAGES, :STAGES])
"""What each stage takes of those before it."""
B: Final[Floats] = DOP853.B.copy()
"""What the step takes of its stages."""
# Scipy's weights have one more, of the next step's first stage, which is nought.
E3: Final[Floats] = DOP853.E3[:STAGES].copy()
"""Weights of the error of order 3, and"""
E5: Final[Floats] = DOP853.E5[:STAGES].copy()
"""of order 5."""

SAME_INSTANT_S: Final = 1e-13
"""Width to which an event is located."""
LATER_S: Final = 1e-6
"""A mode whose own sign vanishes is followed by one chosen this much later, where the sign is strictly lost: at the very limit
the successors are borderline too, and one that is impossible an instant later may pass. Far above what an event is located to,
far below the motion's times."""


LEAST_LATER_S: Final = 1e-9
"""Shortest such moment: a sign that is lost more slowly than in this is not told from rounding."""
SOON: Final = 0.1
"""Share of the time within which friction turns a slow vertex that counts as a moment."""


@jit
def stages(s: Run, m: Memory, k: Floats, h: float, out: Floats) -> None:
    """A step of length h from the present state, its first stage being there."""
    for i in range(1, STAGES):
        for c in range(STATE):
            total = 0.0
            for j in range(i):
                total += A[i, j] * k[j, c]
            m.ys[c] = m.y[c] + h * total
        rates(s, m, m.ys, s.time_s + C[i] * h, k[i])
    for c in range(STATE):
        total = 0.0
        for j in range(STAGES):
            total += B[j] * k[j, c]
        out[c] = m.y[c] + h * total


@jit
def error(s: Run, m: Memory, h: float) -> float:
    """The step's error over what is allowed (Hairer, Nørsett and Wanner, equation 10.17)."""
    fine, coarse = 0.0, 0.0
    for c in range(STATE):
        e3, e5 = 0.0, 0.0
        for j in range(STAGES):
            e3, e5 = e3 + E3[j] * m.k[j, c], e5 + E5[j] * m.k[j, c]
        allowed = s.tolerance * (s.energy_scale_j if c >= WORK else 1.0 + max(abs(m.y[c]), abs(m.y1[c])))
        fine, coarse = fine + (e5 / allowed) ** 2, coarse + (e3 / allowed) ** 2
    if fine == 0.0 and coarse == 0.0:
        return 0.0
    return h * fine / math.sqrt((fine + 0.01 * coarse) * STATE)


@jit
def part(s: Run, m: Memory, h: float, out: Floats) -> None:
    """The state at a part of the present step, by a step of its own."""
    if s.slow:
        slow_step(s, m, h, out)
        return
    m.k1[0] = m.k[0]
    stages(s, m, m.k1, h, out)


@jit
def succeed(s: Run, m: Memory) -> None:
    """Choose the mode after one whose own sign has vanished continuously, by its state a moment later."""
    # A slow vertex must not turn or stop within that moment.
    s.slow, turning_s = False, turning_time_s(s, m)
    later_s = min(LATER_S, max(SOON * turning_s, LEAST_LATER_S))
    rates(s, m, m.y, s.time_s, m.k1[0])
    stages(s, m, m.k1, later_s, m.y2)
    now_s, mode, a, b = s.time_s, s.mode, s.a, s.b
    m.y1[:] = m.y
    m.y[:] = m.y2
    s.time_s = now_s + later_s
    possible = find_mode(s, m, s.still_m_s)
    # The same mode a moment later: only the smoothed friction of slow vertices had lost a sign, and it goes on from there.
    same = possible and s.mode == mode and s.a == a and s.b == b
    sampled = s.output_step_s > 0.0 and s.samples * s.output_step_s <= s.time_s
    if not same or sampled or s.time_s >= s.limit_s:
        s.time_s = now_s
        m.y[:] = m.y1
    if possible:
        enter(s, m)
    else:
        decide(s, m, 0.0)


# A body at rest: how long it stays so, and the friction that sticking needs.


REST_STEPS: Final = 64.0
"""Steps to a period of a sine in which a body at rest is looked at."""
TWO_PI: Final = 2.0 * math.pi


@jit
def needed(s: Run, m: Memory) -> None:
    """Keep the largest of the least friction that sticking needs; what slides needs all that there is."""
    least = s.friction_static
    if s.mode == FLAT_REST:
        # All feet stick together: the resultant of field and weight is what friction must hold.
        g = field(s, m, s.time_s)
        least = math.sqrt(g[0] * g[0] + g[1] * g[1]) / -g[2] if g[2] < 0.0 else math.inf
    elif s.mode == EDGE_STICK or s.mode == VERTEX_STICK:
        rows = axes(m.y)
        contact_forces(s, m, m.y, rows, field(s, m, s.time_s))
        if s.mode == EDGE_STICK:
            least = edge_friction(m, rows, s.a, s.b)
        else:
            pushed = normal(m, rows, s.a)
            least = tangent(m, rows, s.a) / pushed if pushed > 0.0 else 0.0
    elif s.mode == FLIGHT:
        return
    s.least_friction = max(s.least_friction, least)


@jit
def rest_margin(s: Run, m: Memory, t: float) -> float:
    """How far a body at rest is from its first limit, N: negative beyond it."""
    rows = axes(m.y)
    x, y, v, h = thrust(s, m, rows, field(s, m, t))
    least = s.friction_static * v - h if s.friction_static < UNLIMITED else v
    for k in range(s.touching):
        least = min(least, edge_distance(s, m, rows, k, x, y) * v)
    return least if v > 0.0 else -math.inf


@jit
def _rest_event(s: Run, m: Memory, low: float, high: float) -> float:
    """When between two times the margin of rest becomes negative; it is so at the second."""
    for _ in range(200):
        # Nearer than some roundings of the time itself, a middle is one of both ends.
        if high - low <= max(SAME_INSTANT_S, 4.0 * 2.2e-16 * high):
            break
        at = 0.5 * (low + high)
        if rest_margin(s, m, at) >= 0.0:
            low = at
        else:
            high = at
    return high


@jit
def _dip(s: Run, m: Memory, low: float, high: float) -> float:
    """The time of the least margin between two times about a single minimum, by golden sections."""
    share = 0.5 * (math.sqrt(5.0) - 1.0)
    a, b = high - share * (high - low), low + share * (high - low)
    fa, fb = rest_margin(s, m, a), rest_margin(s, m, b)
    for _ in range(60):
        if min(fa, fb) < 0.0 or high - low < 1e-10:
            break
        if fa < fb:
            high, b, fb = b, a, fa
            a = high - share * (high - low)
            fa = rest_margin(s, m, a)
        else:
            low, a, fa = a, b, fb
            b = low + share * (high - low)
            fb = rest_margin(s, m, b)
    return a if fa < fb else b


@jit
def _rest_step_s(m: Memory) -> float:
    """How finely a rest is looked through: between a record's samples all limits are convex, and their ends tell."""
    longest = math.inf
    for motion in m.motions:
        if motion.params.kind not in (NONE, SAMPLED, RECTANGULAR):
            longest = min(longest, TWO_PI / motion.params.omega_rad_s / REST_STEPS)
    return longest


@jit
def hold(s: Run, m: Memory) -> None:
    """Keep the body at rest up to the next break, or until it moves."""
    until, step_s, found = s.limit_s, _rest_step_s(m), False
    low, before, last = s.time_s, rest_margin(s, m, s.time_s), math.inf
    start = low
    while low < s.limit_s and not found:
        high = min(low + step_s, s.limit_s)
        now = rest_margin(s, m, high)
        if now < 0.0:
            until, found = _rest_event(s, m, low, high), True
        elif before <= last and before <= now and step_s < math.inf:
            at = _dip(s, m, start, high)
            if rest_margin(s, m, at) < 0.0:
                until, found = _rest_event(s, m, start, at), True
        if s.keep_events and not found:
            s.time_s = high
            needed(s, m)
        start, low, last, before = low, high, before, now
    m.y1[:] = m.y
    if s.output_step_s > 0.0:
        while s.samples < m.instants - 1 and s.samples * s.output_step_s <= until:
            sample(s, m, s.samples * s.output_step_s, m.y)
    s.time_s = until
    if s.keep_events:
        needed(s, m)
    if found:
        g = field(s, m, s.time_s)
        slips = s.friction_static < UNLIMITED and math.sqrt(g[0] ** 2 + g[1] ** 2) > s.friction_static * -g[2]
        succeed(s, m)
        note_event(s, m, SLIP_ONSET if slips else UPLIFT, -1, 0.0, 0.0)


# What an event is: an impact, a stop, or a mode that has lost its own sign.


STALLED: Final = 100
"""Events at one instant after which a run is given up."""


@jit
def happen(s: Run, m: Memory) -> None:
    """What the event functions that are no longer positive say has happened."""
    count = watch(s, m, m.y, s.time_s)
    gap, first, kind = -1, -1, -1
    for k in range(count):
        if m.watch[k] + m.offset[k] <= 0.0:
            if m.watch_kind[k] == WATCH_TILT:
                s.outcome = OVERTURNED
                note_event(s, m, OVERTURN, -1, 0.0, 0.0)
                return
            if m.watch_kind[k] == WATCH_GAP and gap < 0:
                gap = m.watch_vertex[k]
            if first < 0:
                first, kind = m.watch_vertex[k], m.watch_kind[k]
    s.stalled = s.stalled + 1 if s.time_s - s.event_s < 10.0 * SAME_INSTANT_S else 0
    s.event_s = s.time_s
    if s.stalled > STALLED:
        s.outcome = GAVE_UP
        return
    # An impact goes first: it changes the velocities and forces from which the other functions have their signs.
    if gap >= 0:
        collide(s, m, gap)
    elif kind == WATCH_SPEED:
        _stop(s, m, first)
    elif kind >= 0:
        succeed(s, m)
        note_event(s, m, UPLIFT if kind == WATCH_NORMAL else SLIP_ONSET, first, 0.0, 0.0)
    else:
        s.fresh = True
    audit(s, m, s.start_j)


@jit
def _stop(s: Run, m: Memory, vertex: int) -> None:
    """A vertex' velocity along its direction has passed zero: it stops, unless it has only turned, as none can about a pivot."""
    moving = False
    if vertex >= 0 and s.mode != EDGE_PIVOT:
        vertex_velocities(s, m, m.y)
        x = to_table(axes(m.y), row3(m.u, vertex))
        moving = math.sqrt(x[0] * x[0] + x[1] * x[1]) > 10.0 * s.still_m_s
    if moving:
        s.fresh = True
        return
    decide(s, m, 0.0)
    note_event(s, m, STICK_ONSET, vertex, 0.0, 0.0)


run_cell: Final = cell_at(RUN, Run)
memory_cell: Final = cell_at(MEMORY, Memory)
SAFETY: Final = 0.9
SHRINK: Final = 0.2
GROW: Final = 5.0
EXPONENT: Final = 1.0 / 8.0
SHORTEST: Final = 1e-15
"""Shortest step, s: below it time does not advance."""
FIRST_STEP_S: Final = 1e-3
LOOKS: Final = 4
"""Places in a step at which the event functions are looked at."""
NEAR: Final = 1e-3
"""Share of a look within which the cubic's event is likely to be."""
GUESSES: Final = 6
"""Places at which the cubic is asked where the event is: as near as the cubic itself is to the step."""


@inlined
def _between(m: Memory, h: float, x: float) -> None:
    """Cubic between the step's ends into the stage's memory: good enough to see where an event may be."""
    a = x * x * (3.0 - 2.0 * x)
    b, c = x * (1.0 - x) * (1.0 - x), -x * x * (1.0 - x)
    for i in range(STATE):
        m.ys[i] = m.y[i] + a * (m.y1[i] - m.y[i]) + h * (b * m.k[0, i] + c * m.k[STAGES, i])


@jit
def _guess(s: Run, m: Memory, h: float, low: float, high: float) -> float:
    """About where between low and high the least event function vanishes, on the cubic: for a start."""
    above, below = 0.0, 0.0
    for count in range(GUESSES):
        at = (low * below - high * above) / (below - above) if above > 0.0 > below else 0.5 * (low + high)
        _between(m, h, at / h)
        value = lowest(s, m, m.ys, s.time_s + at)
        if value > 0.0:
            low, above = at, value
            below *= 0.5 if count > 1 else 1.0
        else:
            high, below = at, value
            above *= 0.5 if count > 1 else 1.0
    return 0.5 * (low + high)


@jit
def _locate(s: Run, m: Memory, h: float, low: float, high: float) -> float:
    """Time in the step of its first event, which lies after low and not after high, to `SAME_INSTANT_S`; the state there in `y1`.

    Secants from a guess, kept inside what encloses the event and a least width away from its ends.
    """
    width = max(SAME_INSTANT_S, 4.0 * 2.2e-16 * s.time_s)
    at, before, value_before, widest = _guess(s, m, h, low, high), high, 0.0, high - low
    part(s, m, high, m.y1)
    for count in range(200):
        if high - low <= width:
            break
        part(s, m, at, m.y2)
        value = lowest(s, m, m.y2, s.time_s + at)
        if value > 0.0:
            low = at
        else:
            high = at
            m.y1[:] = m.y2
        slope = (value - value_before) / (at - before) if count > 0 and at != before else math.nan
        before, value_before = at, value
        if count == 0:
            at += NEAR * widest if value > 0.0 else -NEAR * widest
        else:
            at = at - value / slope if slope < 0.0 else 0.5 * (low + high)
        if count % 4 == 3:
            if high - low > 0.25 * widest:
                at = 0.5 * (low + high)
            widest = high - low
        # A root that is hit from one side leaves the other end where it was: reach a little beyond.
        at = min(max(at, low + 0.6 * width), high - 0.6 * width) if high - low > 1.2 * width else 0.5 * (low + high)
    return high


@jit
def first_event(s: Run, m: Memory, h: float) -> float:
    """Length of the step up to its first event, the state there in `y1`; h if there is none."""
    low = 0.0
    for look in range(1, LOOKS + 1):
        x = look / LOOKS
        if look < LOOKS:
            _between(m, h, x)
            if lowest(s, m, m.ys, s.time_s + x * h) > 0.0:
                low = x * h
                arm(s, m, s.watched, False)
                continue
            part(s, m, x * h, m.y2)
        else:
            m.y2[:] = m.y1
        if lowest(s, m, m.y2, s.time_s + x * h) > 0.0:
            low = x * h
            continue
        return _locate(s, m, h, low, x * h)
    return h


@jit
def write_samples(s: Run, m: Memory, h: float) -> None:
    """Write the output samples within the step of length h."""
    dt = s.output_step_s
    if dt <= 0.0:
        return
    while s.samples < m.instants - 1 and s.samples * dt <= s.time_s + h:
        time = s.samples * dt
        if time >= s.time_s + h:
            sample(s, m, time, m.y1)
        else:
            part(s, m, max(time - s.time_s, 0.0), m.y2)
            sample(s, m, time, m.y2)


@jit
def step(s: Run, m: Memory) -> None:
    """One step, up to its first event at most."""
    if s.steps + s.rejected >= s.most_steps:
        s.outcome = GAVE_UP
        return
    if s.fresh:
        s.slow = False
        take_heading(s, m, m.y)
        arm(s, m, watch(s, m, m.y, s.time_s), True)
        s.step_s = min(s.step_s, FIRST_STEP_S)
        s.fresh = False
    turning_s = turning_time_s(s, m)
    s.slow = is_slow(s, turning_s)
    rates(s, m, m.y, s.time_s, m.k[0])
    if s.slow:
        bend(s, m, turning_s)
    left = s.limit_s - s.time_s
    h = min(s.step_s, s.step_cap_s, left)
    if left - h < 0.1 * h:
        h = left
    exponent = 1.0 / extrapolations(s) if s.slow else EXPONENT
    while True:
        if s.slow:
            size = slow_step(s, m, h, m.y1)
        else:
            stages(s, m, m.k, h, m.y1)
            size = error(s, m, h)
        if size <= 1.0:
            break
        s.rejected += 1
        if h <= SHORTEST:
            s.outcome = GAVE_UP
            return
        h *= max(SHRINK, SAFETY * size**-exponent) if size < math.inf else SHRINK
    s.steps += 1
    s.step_s = h * (min(GROW, SAFETY * size**-exponent) if size > 0.0 else GROW)
    rates(s, m, m.y1, s.time_s + h, m.k[STAGES])
    cut = first_event(s, m, h)
    write_samples(s, m, cut)
    whole = cut == h and lowest(s, m, m.y1, s.time_s + h) > 0.0
    m.y[:] = m.y1
    s.time_s = s.limit_s if whole and h == left else s.time_s + cut
    if s.keep_events:
        needed(s, m)
    note_peak(s, m.y)
    if not whole:
        happen(s, m)
        return
    arm(s, m, watch(s, m, m.y, s.time_s), False)
    hold_place(s, m, m.y)
    hold_velocity(s, m, m.y)
    take_heading(s, m, m.y)


@jit
def begin(s: Run, m: Memory) -> None:
    """The mode at t = 0: an impact first where a vertex that touches moves down."""
    s.time_s, s.outcome, s.fresh, s.stalled, s.event_s = 0.0, RUNNING, True, 0, -1.0
    pass_breaks(s, m)
    down, rows = False, axes(m.y)
    s.touching = m.vertices
    for i in range(m.vertices):
        m.touch[i] = i
    vertex_velocities(s, m, m.y)
    for i in range(m.vertices):
        m.down[i] = 0
        if vertex_place(m, m.y, i)[2] <= s.touch_m:
            speed = to_table(rows, row3(m.u, i))[2]
            m.down[i] = 1 if speed <= s.settle_m_s else 0
            down = down or speed < -s.settle_m_s
    s.start_j = kinetic_energy(s, m, m.y)
    if down:
        collide(s, m, -1)
    else:
        decide(s, m, 0.0)
        note_event(s, m, START, -1, 0.0, 0.0)
    note_peak(s, m.y)


@jit
def run_one(s: Run, m: Memory) -> None:
    """Run to the end; the state is the last one."""
    begin(s, m)
    while s.outcome == RUNNING and s.time_s < s.duration_s:
        if s.mode == FLAT_REST:
            if s.output_step_s == 0.0 and all_over(m) and rests(s, m, axes(m.y), field(s, m, s.time_s)):
                break
            hold(s, m)
        else:
            step(s, m)
        if s.outcome == RUNNING and s.time_s >= s.limit_s and s.time_s < s.duration_s:
            jump = False
            for motion in m.motions:
                kind, passed, last = motion.params.kind, motion.breaks_passed, motion.params.n_samples
                jump = jump or (kind not in (NONE, HARMONIC, SAMPLED)) or (kind == SAMPLED and passed in (0, last - 1))
            pass_breaks(s, m)
            if jump:
                mode = s.mode
                decide(s, m, 0.0)
                if mode != s.mode:
                    note_event(s, m, BREAK, -1, 0.0, 0.0)
    audit(s, m, s.start_j)
    if s.outcome == RUNNING:
        s.outcome = STANDS if s.mode == FLAT_REST or axes(m.y)[2][2] > s.stands_cos else UNDECIDED
    note_event(s, m, END, -1, 0.0, 0.0)
    if s.output_step_s > 0.0:
        if s.samples > 0 and s.time_s - load_double(m.history, (s.samples - 1) * (STATE - 1)) <= 1e-9 * s.output_step_s:
            s.samples -= 1
        sample(s, m, s.time_s, m.y)


def run(runs: int, memories: int, start: int, stop: int) -> None:
    """Run the rows start to stop − 1 of the tables at these addresses; memories know the callers' arrays (`machine_code`)."""
    # One entry for one run and for many: another would be compiled from the first line to the last once more.
    for i in range(start, stop):
        run_one(run_cell(runs, i).item, memory_cell(memories, i).item)
