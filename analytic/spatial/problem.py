"""What is to be computed in three dimensions, and what a run of it says."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property
from typing import Final, Self, final

import numpy as np
from numpy.typing import ArrayLike

from analytic.block import GRAVITY_M_S2, OVERTURN_RAD, Floats, positive, require, rotation_matrices
from analytic.excitation import Excitation, ZeroExcitation
from analytic.spatial.kernel.records import MAX_VERTICES

SYMMETRIC: Final = 1e-9
"""Relative difference up to which an inertia tensor's halves are taken for rounded."""


@final
@dataclass(frozen=True, eq=False)
class Body:
    """Mass, kg, inertia tensor about the centroid (3, 3), kg m², and vertices (n, 3) from the centroid, m, body's frame.

    The frame's z is the body's axis, up as it stands. The vertices are those that may touch the floor: the corners of the base,
    or of the whole convex hull of a body that is thrown, in any order, n ≥ 3; they need not be level. Raises
    AnalyticInputError for what is no such body.
    """

    mass_kg: float
    inertia_kg_m2: Floats
    vertices_m: Floats

    def __init__(self, mass_kg: float, inertia_kg_m2: ArrayLike, vertices_m: ArrayLike) -> None:
        """Check and copy the numbers."""
        positive(mass_kg=mass_kg)
        inertia, vertices = (np.array(each, dtype=np.float64) for each in (inertia_kg_m2, vertices_m))
        require(
            inertia.shape == (3, 3) and np.isfinite(inertia).all(),
            "inertia_kg_m2: a finite (3, 3) tensor is wanted, {} came.",
            inertia.shape,
        )
        require(
            np.allclose(inertia, inertia.T, rtol=0.0, atol=SYMMETRIC * np.abs(inertia).max()),
            "inertia_kg_m2: a symmetric tensor is wanted.",
        )
        inertia = 0.5 * (inertia + inertia.T)
        moments = np.linalg.eigvalsh(inertia)
        require(
            moments[0] > 0.0 and moments[2] <= (1.0 + SYMMETRIC) * (moments[0] + moments[1]),
            "inertia_kg_m2: positive principal moments, none above the others' sum, are wanted, {} came.",
            moments,
        )
        require(
            vertices.ndim == 2 and vertices.shape[0] > 2 and vertices.shape[1] == 3 and np.isfinite(vertices).all(),
            "vertices_m: at least three finite (x, y, z) are wanted, {} came.",
            vertices.shape,
        )
        require(
            len(vertices) <= MAX_VERTICES,
            "vertices_m: at most {} vertices are wanted, {} came: leave out the flattest.",
            MAX_VERTICES,
            len(vertices),
        )
        for each in (inertia, vertices):
            each.setflags(write=False)
        vars(self).update(mass_kg=float(mass_kg), inertia_kg_m2=inertia, vertices_m=vertices)

    @classmethod
    def block(cls, mass_kg: float, width_m: float, depth_m: float, height_m: float) -> Self:
        """A homogeneous block: width along x, depth along y, height along z."""
        positive(width_m=width_m, depth_m=depth_m, height_m=height_m)
        x, y, z = width_m**2, depth_m**2, height_m**2
        inertia = np.diag([y + z, x + z, x + y]) * mass_kg / 12.0
        corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        vertices = [(0.5 * width_m * i, 0.5 * depth_m * j, -0.5 * height_m) for i, j in corners]
        return cls(mass_kg, inertia, vertices)

    @cached_property
    def inverse_about(self) -> Floats:
        """Inverse of the inertia about each vertex (n, 3, 3)."""
        r = self.vertices_m
        steiner = np.einsum("ij,ij->i", r, r)[:, None, None] * np.eye(3) - r[:, :, None] * r[:, None, :]
        return np.linalg.inv(self.inertia_kg_m2 + self.mass_kg * steiner)

    @property
    def radius_m(self) -> float:
        """Distance of the farthest vertex from the centroid, m."""
        return float(np.linalg.norm(self.vertices_m, axis=1).max())


UPRIGHT: Final = (1.0, 0.0, 0.0, 0.0)
UNIT: Final = 1e-6
"""By how much a quaternion's length may differ from one: it is then made one."""


@final
@dataclass(frozen=True, eq=False)
class Problem:
    """A body on a shaking floor; SI units, table's frame, angular velocity in the body's frame.

    position_m of the centroid; None: the lowest vertex on the floor, x = y = 0. velocity_m_s of the centroid. friction_kinetic
    None: as friction_static; both may be infinite. overturn_rad ends a run; from π on nothing does. restitution: the share of
    its normal velocity with which a vertex leaves an impact. Raises AnalyticInputError for numbers that cannot be run.
    """

    body: Body
    duration_s: float
    friction_static: float
    friction_kinetic: float | None = None
    motion_x: Excitation = field(default_factory=ZeroExcitation)
    motion_y: Excitation = field(default_factory=ZeroExcitation)
    motion_z: Excitation = field(default_factory=ZeroExcitation)
    gravity_m_s2: float = GRAVITY_M_S2
    position_m: Sequence[float] | None = None
    quaternion_wxyz: Sequence[float] = UPRIGHT
    velocity_m_s: Sequence[float] = (0.0, 0.0, 0.0)
    angular_velocity_rad_s: Sequence[float] = (0.0, 0.0, 0.0)
    overturn_rad: float = OVERTURN_RAD
    restitution: float = 0.0

    def __post_init__(self) -> None:
        """Check the numbers."""
        positive(duration_s=self.duration_s, gravity_m_s2=self.gravity_m_s2, overturn_rad=self.overturn_rad)
        require(
            0.0 <= self.kinetic <= self.friction_static,
            "0 ≤ friction_kinetic ≤ friction_static is wanted, {!r} and {!r} came.",
            self.kinetic,
            self.friction_static,
        )
        require(
            0.0 <= self.restitution <= 1.0,
            "restitution: a number from 0 to 1 is wanted, {!r} came.",
            self.restitution,
        )
        vectors = {
            "position_m": (self.position_m or (0.0, 0.0, 0.0), 3),
            "quaternion_wxyz": (self.quaternion_wxyz, 4),
            "velocity_m_s": (self.velocity_m_s, 3),
            "angular_velocity_rad_s": (self.angular_velocity_rad_s, 3),
        }
        for name, (value, size) in vectors.items():
            holds = len(value) == size and all(math.isfinite(item) for item in value)
            require(holds, "{}: {} finite numbers are wanted, {!r} came.", name, size, tuple(value))
        turn = tuple(self.quaternion_wxyz)
        require(abs(math.hypot(*turn) - 1.0) <= UNIT, "quaternion_wxyz: length one is wanted, {!r} came.", turn)

    @property
    def kinetic(self) -> float:
        """Coefficient of sliding friction."""
        return self.friction_static if self.friction_kinetic is None else self.friction_kinetic

    @property
    def start(self) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
        """The initial state (13,): place, quaternion, velocity, angular velocity.

        Without a given place the lowest vertex is put on the floor. The velocity is the centroid's, as given: one that turns
        about a vertex is given ω × (centroid − vertex), which the angular velocity alone does not bring.
        """
        turn = np.array(self.quaternion_wxyz) / math.hypot(*self.quaternion_wxyz)
        velocity, spin = np.array(self.velocity_m_s), np.array(self.angular_velocity_rad_s)
        if self.position_m is None:
            arms = self.body.vertices_m @ rotation_matrices(turn[None])[0].T
            position = np.array([0.0, 0.0, -arms[:, 2].min()])
        else:
            position = np.array(self.position_m)
        return np.concatenate([position, turn, velocity, spin])


# What a run in three dimensions says: frozen arrays, events and balances.


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
