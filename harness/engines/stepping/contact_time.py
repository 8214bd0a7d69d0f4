"""When a foot comes down that gathers speed: velocities are older than places, and a short half-cycle's change much in that
time."""

from __future__ import annotations

import math

from harness.engines.stepping.contact_gaps import ContactGaps
from harness.engines.stepping.rows import Row
from harness.engines.stepping.step_state import StepState


class ContactTimeEstimate:
    """Called, tells the time, s, until a foot is down if its speed goes on changing as in the last step; infinite if never.

    Where velocities are not older than places, the foot comes with its present one.
    """

    def __init__(self, state: StepState, gaps: ContactGaps, foot: int) -> None:
        """Begin with what the last two samples show, unless an impact or a stick onset lies between them."""
        self.state, self.gaps, self.foot = state, gaps, foot
        self.gained_m_s2 = 0.0
        self.row, self.seen = state.row, self._height(state.row)
        self.kick_s, self.closing_m_s = state.kick_s, self.seen[1]
        kicks = state.record.kick_s
        if len(kicks) > 1 and kicks[-2] < kicks[-1] and state.smooth:
            self._gain(self._height(state.record.row(-2))[1], kicks[-2])

    def __call__(self) -> float:
        state = self.state
        gap, closing = self._look()
        if state.kick_s >= state.t_s:
            return gap / closing if closing > self.gaps.falling_m_s(state.row) else math.inf
        gained = self._gathers(closing)
        now = closing + gained * (state.t_s - state.kick_s)
        if gained <= 0.0:
            return gap / now if now > self.gaps.least_m_s else math.inf
        # The first t with gap = now t + gained t²/2.
        return (math.sqrt(now * now + 2.0 * gained * max(gap, 0.0)) - now) / gained

    def speeds(self) -> tuple[float, float]:
        """Time, s, until it would be down at its present speed, and that speed when it is down over the present one (≥ 1)."""
        gap, closing = self._look()
        contact_s = self()
        if contact_s == math.inf or closing <= self.gaps.least_m_s:
            return contact_s, 1.0
        then = closing + self._gathers(closing) * (self.state.t_s + contact_s - self.state.kick_s)
        return gap / closing, max(then / closing, 1.0)

    def _look(self) -> tuple[float, float]:
        if self.row is not self.state.row:
            self.row, self.seen = self.state.row, self._height(self.state.row)
        gap, closing = self.seen
        if self.state.kick_s > self.kick_s:
            before, self.closing_m_s = self.closing_m_s, closing
            before_s, self.kick_s = self.kick_s, self.state.kick_s
            self._gain(before, before_s)
        return gap, closing

    def _gain(self, before_m_s: float, before_s: float) -> None:
        most = float(self.gaps.bounds[self.foot])
        self.gained_m_s2 = min(max((self.closing_m_s - before_m_s) / (self.kick_s - before_s), -most), most)

    def _gathers(self, closing_m_s: float) -> float:
        row = self.state.row
        turning = self.gaps.base_m * math.hypot(row[10], row[11])
        return self.gained_m_s2 if abs(closing_m_s) >= self.state.events.least_turning * turning else 0.0

    def _height(self, row: Row) -> tuple[float, float]:
        stepper = self.state.stepper
        return self.gaps.height(self.foot, row, stepper.table_place[2], stepper.table_rate[2])
