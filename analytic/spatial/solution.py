"""What a run in three dimensions says: frozen arrays, events and balances."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import final

import numpy as np

from analytic.block import Floats, rotation_matrices


class Outcome(StrEnum):
    """How a run ended."""

    STANDS = "stands"
    OVERTURNED = "overturned"
    FRICTION_PARADOX = "friction_paradox"
    UNDECIDED = "undecided"


OUTCOMES = (Outcome.UNDECIDED, *Outcome, Outcome.UNDECIDED)
"""Outcome of each of the kernel's codes."""


class Mode(StrEnum):
    """What touches the floor, and how."""

    REST = "rest"
    EDGE_STICK = "edge sticking"
    FLAT_PIVOT = "flat, turning about a vertex"
    EDGE_PIVOT = "edge, one vertex sliding"
    VERTEX_STICK = "vertex sticking"
    FLAT_SLIDE = "flat, sliding"
    EDGE_SLIDE = "edge sliding"
    VERTEX_SLIDE = "vertex sliding"
    FLIGHT = "flight"


MODES = tuple(Mode)


class EventKind(StrEnum):
    """What changed the mode."""

    START = "start"
    UPLIFT = "uplift"
    SLIP_ONSET = "slip onset"
    STICK_ONSET = "stick onset"
    IMPACT = "impact"
    BREAK = "break of the motion"
    OVERTURN = "overturn"
    END = "end"
    SETTLED = "impact to rest"


KINDS = tuple(EventKind)


class VertexState(StrEnum):
    """How one vertex touches."""

    FREE = "free"
    STICKING = "sticking"
    SLIDING = "sliding"


VERTEX_STATES = tuple(VertexState)


@final
@dataclass(frozen=True, eq=False)
class Event:
    """One event: the vertex (None: several, or the whole base), the mode after it, the impulses at an impact (n, 3), N s, and the
    energy lost in it, J; cone_residual by how much impulses leave their cones, relative to their sum."""

    time_s: float
    kind: EventKind
    vertex: int | None
    mode: Mode
    impulses_n_s: Floats
    energy_lost_j: float
    cone_residual: float

    @property
    def is_impact(self) -> bool:
        """Whether velocities jumped."""
        return self.kind in (EventKind.IMPACT, EventKind.SETTLED)


@final
@dataclass(frozen=True)
class Interval:
    """A stretch of one mode with the state of each vertex."""

    start_s: float
    end_s: float
    mode: Mode
    vertices: tuple[VertexState, ...]


@final
@dataclass(frozen=True)
class Work:
    """What the run took."""

    steps: int
    rejected: int
    events: int
    impacts: int
    settled: int


@final
@dataclass(frozen=True, eq=False)
class Solution:
    """A run: n samples at the output step and at the end, in the table's frame; angular velocity in the body's.

    The quaternion (w, x, y, z) turns the body's frame into the table's. Residuals are
    relative: of the balance of energy to m g times the body's radius, of momentum and of the cones to what the impact exchanged.
    least_friction is the largest over the steps of the least coefficient that sticking needed, where it slid the static one.
    """

    t_s: Floats
    position_m: Floats
    quaternion_wxyz: Floats
    velocity_m_s: Floats
    angular_velocity_rad_s: Floats
    vertices_m: Floats
    """Of the body, from its centroid (vertices, 3)."""
    outcome: Outcome
    end_s: float
    peak_tilt_rad: float
    events: tuple[Event, ...]
    intervals: tuple[Interval, ...]
    energy_lost_at_impacts_j: float
    energy_lost_by_sliding_j: float
    energy_residual: float
    momentum_residual: float
    cone_residual: float
    least_friction: float
    gave_up: bool
    work: Work
    ambiguous_states: int
    """Choices of a mode after which another motion was possible too; the one that sticks most is taken. Counted with events."""

    @property
    def impacts(self) -> tuple[Event, ...]:
        """Events at which velocities jumped."""
        return tuple(event for event in self.events if event.is_impact)

    @property
    def overturn_time_s(self) -> float | None:
        """When it overturned, s."""
        return self.end_s if self.outcome is Outcome.OVERTURNED else None

    @property
    def rotation(self) -> Floats:
        """Rotation matrices (n, 3, 3) from the body's frame to the table's."""
        return rotation_matrices(self.quaternion_wxyz)

    @property
    def gap_m(self) -> Floats:
        """Height of each vertex above the floor (n, vertices), m."""
        return np.asarray(self.position_m[:, 2:] + self.rotation[:, 2] @ self.vertices_m.T)
