"""What a run leaves behind: samples, events, intervals of one mode, and the balance of energy."""

from __future__ import annotations

import math
from typing import Final

from analytic.kernel.compiler import inlined, jit
from analytic.kernel.memory import store_double
from analytic.kernel.records import Floats
from analytic.spatial.kernel import codes
from analytic.spatial.kernel.rates import kinetic_energy
from analytic.spatial.kernel.records import EVENT_HEAD, INTERVAL_HEAD, LOST, STATE, WORK, Memory, Run

FREE: Final = 0.0
STICKS: Final = 1.0
SLIDES: Final = 2.0


@inlined
def sample(s: Run, m: Memory, time: float, y: Floats) -> None:
    """Write the next output sample."""
    start = s.samples * (STATE - 1)
    store_double(m.history, start, time)
    for c in range(STATE - 2):
        store_double(m.history, start + 1 + c, y[c])
    s.samples += 1


@jit
def _vertex_state(s: Run, m: Memory, i: int) -> float:
    if m.down[i] == 0 or s.mode == codes.FLIGHT:
        return FREE
    if s.mode in (codes.FLAT_REST, codes.EDGE_STICK, codes.VERTEX_STICK):
        return STICKS
    return STICKS if s.mode in (codes.FLAT_PIVOT, codes.EDGE_PIVOT) and i == s.a else SLIDES


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
        store_double(m.event_table, start, s.time_s)
        store_double(m.event_table, start + 1, kind)
        store_double(m.event_table, start + 2, vertex)
        store_double(m.event_table, start + 3, s.mode)
        store_double(m.event_table, start + 4, loss)
        store_double(m.event_table, start + 5, cone)
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
