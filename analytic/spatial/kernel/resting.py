"""A body at rest: how long it stays so, and the friction that sticking needs."""

from __future__ import annotations

import math
from typing import Final

from analytic.kernel.codes import NONE, RECTANGULAR, SAMPLED
from analytic.kernel.compiler import jit
from analytic.spatial.kernel import codes
from analytic.spatial.kernel.contact import UNLIMITED, edge_friction, normal, tangent
from analytic.spatial.kernel.rates import contact_forces
from analytic.spatial.kernel.records import Memory, Run
from analytic.spatial.kernel.rest import edge_distance, thrust
from analytic.spatial.kernel.steps import SAME_INSTANT_S, succeed
from analytic.spatial.kernel.track import note_event, sample
from analytic.spatial.kernel.vectors import axes, field

REST_STEPS: Final = 64.0
"""Steps to a period of a sine in which a body at rest is looked at."""
TWO_PI: Final = 2.0 * math.pi


@jit
def needed(s: Run, m: Memory) -> None:
    """Keep the largest of the least friction that sticking needs; what slides needs all that there is."""
    least = s.friction_static
    if s.mode == codes.FLAT_REST:
        # All feet stick together: the resultant of field and weight is what friction must hold.
        g = field(s, m, s.time_s)
        least = math.sqrt(g[0] * g[0] + g[1] * g[1]) / -g[2] if g[2] < 0.0 else math.inf
    elif s.mode == codes.EDGE_STICK or s.mode == codes.VERTEX_STICK:
        rows = axes(m.y)
        contact_forces(s, m, m.y, rows, field(s, m, s.time_s))
        if s.mode == codes.EDGE_STICK:
            least = edge_friction(m, rows, s.a, s.b)
        else:
            pushed = normal(m, rows, s.a)
            least = tangent(m, rows, s.a) / pushed if pushed > 0.0 else 0.0
    elif s.mode == codes.FLIGHT:
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
        note_event(s, m, codes.SLIP_ONSET if slips else codes.UPLIFT, -1, 0.0, 0.0)
