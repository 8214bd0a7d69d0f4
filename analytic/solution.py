"""What a run of the analytic model says: frozen, plain numbers and arrays."""

import math
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property
from typing import Any, Final, final

import numpy as np
from numpy.typing import NDArray

from analytic.kernel.records import EVENT_ROW, Counts, Floats, Params, Records, Results, State


class Outcome(StrEnum):
    """How a run ended."""

    STANDS = "stands"
    OVERTURNED_LEFT = "overturned_left"
    OVERTURNED_RIGHT = "overturned_right"
    TOUCHES_WALL = "touches_wall"
    LIFT_OFF = "lift_off"
    FRICTION_PARADOX = "friction_paradox"
    UNDECIDED = "undecided"


OUTCOMES = (Outcome.UNDECIDED, *Outcome)
"""Outcome of each of the kernel's codes."""


class EventKind(StrEnum):
    """What changed the state of motion."""

    START = "start"
    UPLIFT = "uplift"
    SLIP_ONSET = "slip"
    STICK_ONSET = "halt"
    IMPACT = "impact"
    BREAK = "break"
    OVERTURN = "overturn"
    WALL = "wall"
    LIFT_OFF = "lift_off"
    PARADOX = "paradox"
    END = "end"


PATTERNS: Final = ("rest", "sliding", "rocking", "both")
"""Of motion, by 2 where the statue rocks and 1 where the pedestal slides."""
_START, *_BETWEEN, _END = EventKind
KINDS = (_END, *_BETWEEN, _START, _END)
"""Event of each of the kernel's codes."""


@final
@dataclass(frozen=True)
class Event:
    """One event: the joint state after it, and the velocities before and after.

    pivot is the base vertex rocked about (counted from the left), None at rest; slide the sign of the pedestal's velocity, 0
    stuck; energy_j the kinetic energy after less before, in the floor's frame; feasible_states how many joint states were
    possible where one had to be chosen (0: nothing was free); residual the event's own function, relative to its terms.
    """

    time_s: float
    kind: EventKind
    pivot: int | None
    facet: int
    slide: int
    theta_rad: float
    theta_rate_before_rad_s: float
    theta_rate_after_rad_s: float
    slip_m: float
    slip_rate_before_m_s: float
    slip_rate_after_m_s: float
    energy_j: float
    feasible_states: int
    residual: float

    @property
    def rocking(self) -> bool:
        """Whether the statue rocks after the event."""
        return self.pivot is not None

    @property
    def pattern(self) -> str:
        """Motion pattern after the event: rest, rocking, sliding or both."""
        return PATTERNS[2 * self.rocking + (self.slide != 0)]


@final
@dataclass(frozen=True)
class Interval:
    """A stretch of one motion pattern: rest, rocking, sliding or both."""

    start_s: float
    end_s: float
    pattern: str


@final
@dataclass(frozen=True)
class Validity:
    """How far the run stayed inside the model (docs/model.md, section 5); margins are None without a pedestal.

    Friction needed at the statue's pivot |H|/V, during motion and at impacts; least V and N, N; the pedestal's tipping margin,
    m, negative where it would tip. left_domain_s is when one of these limits was first passed, None if none was.
    """

    pivot_friction_needed: float
    pivot_friction_needed_at_impact: float
    least_pivot_force_n: float
    least_floor_force_n: float
    pedestal_tipping_margin_m: float | None
    pedestal_tipping_margin_at_impact_m: float | None
    left_domain_s: float | None
    left_domain_by: str


# The solution that the kernel's records say.

LEFT_BY: Final = ("", "statue_slides", "contact_lost", "pedestal_tips", "beyond_base")
"""What each of the kernel's codes for a limit passed says: statue on its support, statue or pedestal in flight, pedestal, a lean
beyond the statue's base."""
NO_EVENTS: Final[Records] = np.zeros(0, EVENT_ROW)
NO_TIMES: Final[NDArray[np.float64]] = np.zeros(0)
NO_HISTORY: Final = (NO_TIMES,) * 5
"""The columns of a run without one."""


def _optional(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _event(given: tuple[Any, ...]) -> Event:
    """The event of a row of the kernel's table, whose fields are in the same order."""
    time_s, kind, pivot, *rest = given
    return Event(time_s, KINDS[kind], pivot if pivot >= 0 else None, *rest)


def peak_is_ahead(energy_endings: Any, peak_time_s: Any, end_s: Any) -> Any:
    """Whether the largest rotation is yet to come at a run's end, as its energy tells: of numbers, or of arrays of them (n,)."""
    return (energy_endings > 0) & (peak_time_s == end_s)


@final
@dataclass(frozen=True, eq=False)
class Solution:
    """One run: outcome, history on the grid 0, dt, 2dt, ... and at the last instant (arrays of equal length, empty in an
    outcome-only run), events, motion patterns, validity.

    overturn_time_s is the instant of the overturning limit and no_return_time_s the last outward crossing of the balance
    point before it; both None where they did not happen or where energy decided before them.
    """

    outcome: Outcome
    results: Results
    params: Params = field(repr=False)
    state: State = field(repr=False)
    counts: Counts = field(repr=False)
    """What it cost, what it left out, and how often it was in doubt."""
    event_rows: Records = field(repr=False)
    """The kernel's own records, made into what is asked of them when it is asked."""
    t_s: Floats = field(repr=False)
    """Times of the history, s (n,), and at each of them"""
    theta_rad: Floats = field(repr=False)
    """θ,"""
    theta_rate_rad_s: Floats = field(repr=False)
    """θ̇,"""
    slip_m: Floats = field(repr=False)
    """u and"""
    slip_rate_m_s: Floats = field(repr=False)
    """u̇."""

    @property
    def end_s(self) -> float:
        """When it ended, s."""
        return self.state.time_s

    @property
    def peak_theta_rad(self) -> float:
        """Largest |θ|."""
        return abs(self.results.peak_theta_rad)

    @property
    def peak_signed_rad(self) -> float:
        """θ where it was largest."""
        return self.results.peak_theta_rad

    @property
    def peak_time_s(self) -> float | None:
        """When it was; None where it is yet to come, as the energy at the run's end tells."""
        ahead = peak_is_ahead(self.counts.energy_endings, self.results.peak_time_s, self.end_s)
        return None if ahead else self.results.peak_time_s

    @property
    def peak_slip_m(self) -> float:
        """Largest |u|."""
        return self.results.peak_slip_m

    @property
    def final_slip_m(self) -> float:
        """u at the end."""
        return self.state.slip_m

    @property
    def overturn_time_s(self) -> float | None:
        """Instant of the overturning limit, s."""
        return _optional(self.results.overturn_time_s)

    @property
    def no_return_time_s(self) -> float | None:
        """Last outward crossing of the balance point before an overturning, s."""
        overturned = self.outcome in (Outcome.OVERTURNED_LEFT, Outcome.OVERTURNED_RIGHT)
        return _optional(self.results.no_return_time_s) if overturned else None

    @property
    def energy_lost_j(self) -> float:
        """Energy lost at impacts, J."""
        return self.results.energy_lost_j

    @property
    def energy_gained_j(self) -> float:
        """Energy gained at impacts, J."""
        return self.results.energy_gained_j

    @cached_property
    def events(self) -> tuple[Event, ...]:
        """Every event, from the start to the end."""
        return tuple(_event(each) for each in self.event_rows.tolist())

    @cached_property
    def validity(self) -> Validity | None:
        """How far the run stayed inside the model, None where that was not kept."""
        r, on_pedestal = self.results, self.params.has_pedestal
        if not self.params.keep_validity:
            return None
        return Validity(
            pivot_friction_needed=r.pivot_friction,
            pivot_friction_needed_at_impact=r.pivot_friction_at_impact,
            least_pivot_force_n=r.least_pivot_normal_n,
            least_floor_force_n=r.least_floor_normal_n,
            pedestal_tipping_margin_m=_optional(r.tipping_margin_m) if on_pedestal else None,
            pedestal_tipping_margin_at_impact_m=_optional(r.tipping_margin_at_impact_m) if on_pedestal else None,
            left_domain_s=_optional(r.left_domain_s),
            left_domain_by=LEFT_BY[r.left_domain_by],
        )

    @property
    def impacts(self) -> tuple[Event, ...]:
        """The impacts."""
        return tuple(event for event in self.events if event.kind is EventKind.IMPACT)

    @property
    def _impact_rows(self) -> Records:
        return np.asarray(self.event_rows[self.event_rows["kind"] == KINDS.index(EventKind.IMPACT)])

    @property
    def impact_times_s(self) -> Floats:
        """Times of the impacts, s."""
        return np.asarray(self._impact_rows["time_s"])

    @property
    def impact_ratios(self) -> Floats:
        """Angular velocity after each impact over that before it; 0 where there was none."""
        rows = self._impact_rows
        before, after = rows["theta_rate_before_rad_s"], rows["theta_rate_after_rad_s"]
        return np.asarray(np.divide(after, before, out=np.zeros(before.size), where=before != 0.0))

    @property
    def ambiguous_times_s(self) -> Floats:
        """Times of the events after which several states of motion were possible, s."""
        return np.asarray(self.event_rows["time_s"][self.event_rows["feasible_states"] > 1])

    @property
    def uplift_times_s(self) -> Floats:
        """Times at which the statue left its rest, s."""
        rows = self.event_rows
        if not rows.size:
            return NO_TIMES
        rocks = rows["pivot"] >= 0
        # A start at an angle is no uplift.
        rested = np.concatenate([rows["theta_rad"][:1] == 0.0, ~rocks[:-1]])
        return np.asarray(rows["time_s"][rocks & rested])

    @property
    def patterns(self) -> tuple[Interval, ...]:
        """The motion patterns one after another, neighbours of the same pattern joined."""
        if not self.event_rows.size:
            return ()
        time_s, lasts = self.event_rows["time_s"], np.diff(self.event_rows["time_s"]) > 0.0
        kinds = 2 * (self.event_rows["pivot"] >= 0) + (self.event_rows["slide"] != 0)
        begin = np.flatnonzero(lasts)
        begin = begin[np.diff(kinds[begin], prepend=-1) != 0]
        ends = [*time_s[begin[1:]].tolist(), *time_s[-1:].tolist()]
        patterns = [PATTERNS[kind] for kind in kinds[begin].tolist()]
        return tuple(map(Interval, time_s[begin].tolist(), ends, patterns))
