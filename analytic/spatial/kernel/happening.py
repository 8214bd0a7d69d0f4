"""What an event is: an impact, a stop, or a mode that has lost its own sign."""

from __future__ import annotations

import math
from typing import Final

from analytic.kernel.compiler import jit
from analytic.spatial.kernel import codes
from analytic.spatial.kernel.contact import vertex_velocities
from analytic.spatial.kernel.impact import collide, decide
from analytic.spatial.kernel.records import Memory, Run
from analytic.spatial.kernel.steps import SAME_INSTANT_S, succeed
from analytic.spatial.kernel.track import audit, note_event
from analytic.spatial.kernel.vectors import axes, row3, to_table
from analytic.spatial.kernel.watching import watch

STALLED: Final = 100
"""Events at one instant after which a run is given up."""


@jit
def happen(s: Run, m: Memory) -> None:
    """What the event functions that are no longer positive say has happened."""
    count = watch(s, m, m.y, s.time_s)
    gap, first, kind = -1, -1, -1
    for k in range(count):
        if m.watch[k] + m.offset[k] <= 0.0:
            if m.watch_kind[k] == codes.WATCH_TILT:
                s.outcome = codes.OVERTURNED
                note_event(s, m, codes.OVERTURN, -1, 0.0, 0.0)
                return
            if m.watch_kind[k] == codes.WATCH_GAP and gap < 0:
                gap = m.watch_vertex[k]
            if first < 0:
                first, kind = m.watch_vertex[k], m.watch_kind[k]
    s.stalled = s.stalled + 1 if s.time_s - s.event_s < 10.0 * SAME_INSTANT_S else 0
    s.event_s = s.time_s
    if s.stalled > STALLED:
        s.outcome = codes.GAVE_UP
        return
    # An impact goes first: it changes the velocities and forces from which the other functions have their signs.
    if gap >= 0:
        collide(s, m, gap)
    elif kind == codes.WATCH_SPEED:
        _stop(s, m, first)
    elif kind >= 0:
        succeed(s, m)
        note_event(s, m, codes.UPLIFT if kind == codes.WATCH_NORMAL else codes.SLIP_ONSET, first, 0.0, 0.0)
    else:
        s.fresh = True
    audit(s, m, s.start_j)


@jit
def _stop(s: Run, m: Memory, vertex: int) -> None:
    """A vertex' velocity along its direction has passed zero: it stops, unless it has only turned, as none can about a pivot."""
    moving = False
    if vertex >= 0 and s.mode != codes.EDGE_PIVOT:
        vertex_velocities(s, m, m.y)
        x = to_table(axes(m.y), row3(m.u, vertex))
        moving = math.sqrt(x[0] * x[0] + x[1] * x[1]) > 10.0 * s.still_m_s
    if moving:
        s.fresh = True
        return
    decide(s, m, 0.0)
    note_event(s, m, codes.STICK_ONSET, vertex, 0.0, 0.0)
