"""What a run of the analytic model says: frozen, plain numbers and arrays."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Protocol, final

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Outcome(StrEnum):
    """How a run ended."""

    STANDS = "stands"
    OVERTURNED_LEFT = "overturned_left"
    OVERTURNED_RIGHT = "overturned_right"
    TOUCHES_WALL = "touches_wall"
    LIFT_OFF = "lift_off"
    FRICTION_PARADOX = "friction_paradox"
    UNDECIDED = "undecided"


OUTCOMES = (
    Outcome.UNDECIDED,
    Outcome.STANDS,
    Outcome.OVERTURNED_LEFT,
    Outcome.OVERTURNED_RIGHT,
    Outcome.TOUCHES_WALL,
    Outcome.LIFT_OFF,
    Outcome.FRICTION_PARADOX,
    Outcome.UNDECIDED,
)
"""Outcome of each of the kernel's codes."""


class EventKind(StrEnum):
    """What changed the state of motion."""

    START = "start"
    UPLIFT = "uplift"
    SLIP_ONSET = "slip"
    STICK_ONSET = "halt"
    SLIP = "slip"  # further names of these two
    HALT = "halt"
    IMPACT = "impact"
    BREAK = "break"
    OVERTURN = "overturn"
    WALL = "wall"
    LIFT_OFF = "lift_off"
    PARADOX = "paradox"
    END = "end"


KINDS = (
    EventKind.END,
    EventKind.UPLIFT,
    EventKind.SLIP_ONSET,
    EventKind.STICK_ONSET,
    EventKind.IMPACT,
    EventKind.BREAK,
    EventKind.OVERTURN,
    EventKind.WALL,
    EventKind.LIFT_OFF,
    EventKind.PARADOX,
    EventKind.START,
    EventKind.END,
)
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
        if self.rocking:
            return "both" if self.slide else "rocking"
        return "sliding" if self.slide else "rest"


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


@final
@dataclass(frozen=True)
class Work:
    """What the run cost and what it left out."""

    steps: int
    taylor_coefficients: int
    events: int
    impacts: int
    quiet_samples_skipped: int
    skipped_s: float
    ended_by_energy: bool


@final
@dataclass(frozen=True)
class Doubts:
    """What may make a run's numbers unsafe: ambiguous states, near-tangent events, dropped rebounds, near-tie energy.

    worst_residual is the largest event residual relative to its terms; outcome_margin the least distance |E/E_crit − 1| at
    which the energy decided (None: it did not have to); gave_up whether the run was ended for making no progress.
    """

    ambiguous_states: int
    near_tangent_steps: int
    dropped_rebounds: int
    worst_residual: float
    outcome_margin: float | None
    gave_up: bool


class Details(Protocol):
    """What a run says besides its numbers and its history, put together when it is first asked for."""

    @property
    def events(self) -> tuple[Event, ...]:
        """Every event."""

    @property
    def validity(self) -> Validity | None:
        """How far the run stayed inside the model, None where that was not kept."""

    @property
    def work(self) -> Work:
        """What the run cost."""

    @property
    def doubts(self) -> Doubts:
        """What may make its numbers unsafe."""


@final
@dataclass(frozen=True, eq=False)
class Solution:
    """One run: outcome, history on the grid 0, dt, 2dt, ... and at the last instant (arrays of equal length, empty in an
    outcome-only run), events, motion patterns, validity.

    overturn_time_s is the instant of the overturning limit and no_return_time_s the last outward crossing of the balance
    point before it; both None where they did not happen or where energy decided before them.
    """

    outcome: Outcome
    end_s: float
    t_s: Floats
    theta_rad: Floats
    theta_rate_rad_s: Floats
    slip_m: Floats
    slip_rate_m_s: Floats
    peak_theta_rad: float
    peak_signed_rad: float
    peak_time_s: float
    peak_slip_m: float
    final_slip_m: float
    overturn_time_s: float | None
    no_return_time_s: float | None
    energy_lost_j: float
    energy_gained_j: float
    details: Details = field(repr=False)

    @property
    def events(self) -> tuple[Event, ...]:
        """Every event, from the start to the end."""
        return self.details.events

    @property
    def validity(self) -> Validity | None:
        """How far the run stayed inside the model, None where that was not kept."""
        return self.details.validity

    @property
    def work(self) -> Work:
        """What the run cost and what it left out."""
        return self.details.work

    @property
    def doubts(self) -> Doubts:
        """What may make the run's numbers unsafe."""
        return self.details.doubts

    def of_kind(self, kind: EventKind) -> tuple[Event, ...]:
        """The events of one kind."""
        return tuple(event for event in self.events if event.kind is kind)

    @property
    def impacts(self) -> tuple[Event, ...]:
        """The impacts."""
        return self.of_kind(EventKind.IMPACT)

    @property
    def impact_times_s(self) -> Floats:
        """Times of the impacts, s."""
        return np.array([event.time_s for event in self.impacts])

    @property
    def uplift_times_s(self) -> Floats:
        """Times at which the statue left its rest, s."""
        pairs = zip(self.events[:-1], self.events[1:], strict=True)
        lifted = [b.time_s for a, b in pairs if b.rocking and not a.rocking]
        first = (
            [self.events[0].time_s]
            if self.events and self.events[0].rocking and self.events[0].theta_rad == 0.0
            else []
        )
        return np.array(first + lifted)

    @property
    def patterns(self) -> tuple[Interval, ...]:
        """The motion patterns one after another, neighbours of the same pattern joined."""
        strip: list[Interval] = []
        for event, after in zip(self.events[:-1], self.events[1:], strict=True):
            if strip and strip[-1].pattern == event.pattern:
                strip[-1] = Interval(strip[-1].start_s, after.time_s, event.pattern)
            elif after.time_s > event.time_s:
                strip.append(Interval(event.time_s, after.time_s, event.pattern))
        return tuple(strip)
