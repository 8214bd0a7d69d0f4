"""What a run of the analytic model says: frozen, plain numbers and arrays."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import final


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
    SLIP = "slip"  # further names of these two
    HALT = "halt"
    IMPACT = "impact"
    BREAK = "break"
    OVERTURN = "overturn"
    WALL = "wall"
    LIFT_OFF = "lift_off"
    PARADOX = "paradox"
    END = "end"


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
