"""The world of one run: a fresh client, every parameter sent, its solver, bodies in a fixed order and along its axes, closed at
the end.
"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Final, Self, final

import numpy as np
import pybullet
from numpy.typing import NDArray

from harness.engines.base import EngineFailure
from harness.engines.pybullet import mirror, shapes, writing
from harness.engines.pybullet.settings import BulletSettings
from harness.engines.stepping.step_log import ALONE, Body, Row, Vector
from harness.model.scene import Contact, Pedestal, Wall

# What Bullet's solver is told: every parameter of a world, and what the length of a step or a rest asks of
# it.


MIRRORED_RESIDUAL: Final = 1e-2
"""Share of a level's residual in a mirrored world: started from the last step's impulses the solver iterations get there soon."""
RESTING_RESIDUAL: Final = 1e-4
"""Share of it for bodies that rest one on the other: what the iterations leave of a step there adds up to a creep that goes with
the square root of the residual (6e-7 m a minute at 4 ms; 6e-5 without it), and they need as many as"""
RESTING_ITERATIONS: Final = 2000
"""this (docs/engines.md)."""
SHORT: Final = 0.1
"""Share of a step below which nothing is taken back of what a standing foot has crept along: it holds an impact."""
NO_RESTITUTION_BELOW_M_S: Final = 1e9
"""Every contact is slower than this, so none bounces."""


class Solver:
    """Parameters of one world's solver."""

    def __init__(self, settings: BulletSettings, client: int, *, mirrored: bool) -> None:
        self.settings, self.client, self.mirrored, self.resting = settings, client, mirrored, False
        self.length_s = settings.dt_s

    def begin(self) -> None:
        """Send every parameter: some are global to the process and outlive a client."""
        pybullet.setPhysicsEngineParameter(
            numSubSteps=0,
            contactBreakingThreshold=self.settings.reach,
            enableConeFriction=int(self.settings.cone_friction),
            globalCFM=0.0,
            contactSlop=0.0,
            restitutionVelocityThreshold=NO_RESTITUTION_BELOW_M_S,
            deterministicOverlappingPairs=1,
            enableFileCaching=0,
            constraintSolverType=pybullet.CONSTRAINT_SOLVER_LCP_SI,
            physicsClientId=self.client,
        )
        self.set_length(self.settings.dt_s)

    def rest(self, resting: bool) -> None:
        """Whether the steps that follow are of bodies at rest."""
        if resting != self.resting:
            self.resting = resting
            self.set_length(self.settings.dt_s)

    def set_length(self, step_s: float) -> None:
        """The length of the steps that follow; what is a share of a penetration for each step goes with it.

        A step of another length than the level's holds an event, whose impulses are solved more tightly.
        """
        self.length_s = step_s
        s, erp = self.settings, self.settings.erp_for(step_s)
        tight, share = step_s != s.dt_s, step_s / s.dt_s
        iterations, residual = s.iterations, s.residual_for()
        if tight or self.mirrored:
            iterations = max(iterations, s.event_iterations)
            residual *= MIRRORED_RESIDUAL if self.mirrored else s.event_residual
        elif self.resting:
            iterations, residual = max(iterations, RESTING_ITERATIONS), RESTING_RESIDUAL * residual
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=step_s,
            erp=erp,
            contactERP=erp,
            frictionERP=share**2 if share > SHORT else 0.0,
            numSolverIterations=iterations,
            solverResidualThreshold=residual,
            # Impulses of an event are no guess for the next step's, nor the last step's for an event's.
            warmStartingFactor=0.0 if tight else 1.0,
            physicsClientId=self.client,
        )


# The scene turned about the vertical in Bullet's world, so that what slides does so along one of Bullet's
# axes.
#
# Bullet resolves friction along its own x and y. Askew to these the force that it settles on leans towards
# them at every step, so that runs with finer steps agree on it; along them it is Coulomb's
# (docs/engines.md). All above the world keeps the scene's axes: states and pulls are turned as they are
# handed to Bullet, rows as they are read.


@dataclass(frozen=True)
class Heading:
    """The turn from the scene's axes to Bullet's about the vertical, as cosine and sine of it and of its half."""

    cos: float
    sin: float
    half_cos: float
    half_sin: float

    @classmethod
    def of(cls, turn_rad: float) -> Heading | None:
        """A turn by so much; None for none."""
        if turn_rad == 0.0:
            return None
        return cls(math.cos(turn_rad), math.sin(turn_rad), math.cos(0.5 * turn_rad), math.sin(0.5 * turn_rad))

    @property
    def back(self) -> Heading:
        """The turn from Bullet's axes to the scene's."""
        return Heading(self.cos, -self.sin, self.half_cos, -self.half_sin)

    def vector(self, vector: Vector) -> Vector:
        """A vector, turned."""
        x, y, z = vector
        return self.cos * x - self.sin * y, self.sin * x + self.cos * y, z

    def body(self, state: Body) -> Body:
        """A body's state, turned."""
        x, y, z, w = state.turn
        # The turn comes after the body's own: its quaternion (0, 0, s, c) stands on the left of the product.
        c, s = self.half_cos, self.half_sin
        turn = (c * x - s * y, c * y + s * x, c * z + s * w, c * w - s * z)
        return Body(self.vector(state.place_m), turn, self.vector(state.velocity_m_s), self.vector(state.rate_rad_s))

    def row(self, row: Row) -> Row:
        """The row of one or two bodies, turned."""
        turned: Row = ()
        for k in range(0, len(row), ALONE):
            body = self.body(Body(row[k : k + 3], row[k + 3 : k + 7], row[k + 7 : k + 10], row[k + 10 : k + 13]))  # type: ignore[arg-type]
            turned += (*body.place_m, *body.turn, *body.velocity_m_s, *body.rate_rad_s)
        return turned


# Clients of Bullet, kept from one run to the next: to start and end one costs more than many a run. A kept
# client is emptied (`resetSimulation` makes a new world with new solver and new numbering) and every
# parameter is sent again, so a run does not see what ran before. A client whose run failed is ended, not
# kept.


MOST_IDLE: Final = 2
"""Clients kept at once at most: a run and one inside it."""

_idle: list[tuple[int, int]] = []
"""Process and number of each client that is not in use."""


def take() -> int:
    """An empty client of this process, for one run at a time. Raises `EngineFailure` when no client can be had."""
    while _idle:
        process, client = _idle.pop()
        # A process that was forked has its parent's list, whose clients are not its own.
        if process == os.getpid() and pybullet.isConnected(client):
            break
    else:
        client = int(pybullet.connect(pybullet.DIRECT))
        if client < 0:
            raise EngineFailure("pybullet gave no client")
    pybullet.resetSimulation(physicsClientId=client)
    return client


def give_back(client: int, *, sound: bool) -> None:
    """Keep a client for the next run, or end it: when its run failed (`sound` false) or enough are kept."""
    if sound and len(_idle) < MOST_IDLE:
        _idle.append((os.getpid(), client))
    elif pybullet.isConnected(client):
        pybullet.disconnect(client)


Array = NDArray[np.float64]

STILL: Final = (0.0, 0.0, 0.0)
ALOFT_M: Final = 1e3
"""Height at which bodies touch nothing, and above each other."""
UPRIGHT: Final = (0.0, 0.0, 0.0, 1.0)
BOX, FACE, FEET = -1, 0, 1
"""Of a pedestal with edges: a box, which the statue's edges meet, its top's face, which the feet over it do, and its own feet."""
OVER, BESIDE = 0, 1
"""Links of the statue there: its feet over the top, and those beside it."""
WALL_REACH: Final = 1e-4
"""What meets a wall is met by no shorter step: seen from further away, more of it ends a whole step there."""
MOVING: Final = 1
"""Bullet's own group of bodies that move; they touch"""
EVERYTHING: Final = -1


@final
class World:
    """One simulation. `statue`, `pedestal` are Bullet's bodies (`pedestal` None without one); floor and wall do not move alone.

    A context manager: leaving it ends the client. Raises `EngineFailure` when no client can be had.
    """

    def __init__(self, settings: BulletSettings, *, mirrored: bool = False, in_plane: bool = False) -> None:
        self.settings, self.mirrored, self.in_plane = settings, mirrored, mirrored or in_plane
        self.turn_rad, self.heading = settings.turn_rad, Heading.of(settings.turn_rad)
        self.follows = settings.axes == "along"
        self.client = take()
        self.solver = Solver(settings, self.client, mirrored=mirrored)
        self.floor = -1
        self.wall: int | None = None
        self.pedestal: int | None = None
        self.statue = -1
        self.radius_m = settings.foot_radius_m
        self.edges, self.feet_over, self.reach = False, True, settings.reach
        self.moments, self.feet_m, self.pedestal_half_m = STILL, np.zeros((0, 3)), 0.0
        self.table: tuple[Vector, Vector] = (STILL, STILL)
        self._homes: dict[int, Vector] = {}

    def __enter__(self) -> Self:
        self.solver.begin()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        give_back(self.client, sound=error is None)

    def build(
        self,
        contact: Contact,
        pedestal: tuple[Pedestal, float] | None,
        wall: tuple[Wall, float] | None,
        statue: tuple[float, Array, Array, Sequence[Array] | None, Body],
        beside: NDArray[np.bool_] | None = None,
    ) -> None:
        """Create everything: pedestal with its centre's x, wall with its place's x, statue as mass, moments (3,), feet (k, 3)
        and convex bodies (n, 3) each, or None, in its principal frame, and its state. With these the pedestal has edges;
        `beside` (k,) are then the feet beside its top (None: none), the others meet its face as if that had no end.
        """
        self.edges = statue[3] is not None
        radius = self.radius_m
        self.floor = self._fixed((0.0, 0.0, 1.0), (0.0, 0.0, -radius))
        if wall is not None:
            self.set_reach(max(self.reach, WALL_REACH))
            sign = wall[0].sign
            self.wall = self._fixed((-float(sign), 0.0, 0.0), (wall[1] + sign * radius, 0.0, 0.0))
        if self.settings.reversed_bodies:
            self._add_statue(statue, beside)
            self._add_pedestal(pedestal)
        else:
            self._add_pedestal(pedestal)
            self._add_statue(statue, beside)
        if self.pedestal is not None and not self.mirrored:
            self._part_top(self.pedestal)
        # Coefficients multiply: the floor's holds under the pedestal, the statue's on whatever the statue stands on.
        self.surface(self.statue, contact.statue)
        if self.pedestal is not None:
            self.surface(self.pedestal, 1.0)
        self.set_floor_friction(contact.floor_static if self.pedestal is not None else 1.0)
        if self.wall is not None:
            self.surface(self.wall, 1.0)
        if self.mirrored:
            self._take_inertia(statue[4], pedestal)

    def _take_inertia(self, statue: Body, pedestal: tuple[Pedestal, float] | None) -> None:
        """A step far above everything, without gravity: until one has moved it a rigid body turns by the inertia of its shape."""
        states = {self.statue: statue}
        if self.pedestal is not None and pedestal is not None:
            place = (pedestal[1], 0.0, pedestal[0].centroid_height_m)
            states[self.pedestal] = Body(place, UPRIGHT, STILL, STILL)
        for number, (body, state) in enumerate(states.items(), 1):
            x, y, z = state.place_m
            self.place(body, Body((x, y, z + number * ALOFT_M), state.turn, STILL, STILL))
        pybullet.stepSimulation(self.client)
        for body, state in states.items():
            self.place(body, state)

    def _fixed(self, normal: Vector, place: Vector) -> int:
        body = self._created(shapes.plane(normal, self.client), 0.0, place)
        self._homes[body] = place
        if self.heading is not None:
            self.place(body, Body(place, UPRIGHT, STILL, STILL))
        return body

    def add(self, shape: int, mass_kg: float, moments_kg_m2: Array, place: list[float]) -> int:
        """A body of a collision shape with its mass and principal moments (3,)."""
        body = self._created(shape, mass_kg, place)
        self._inert(body, mass_kg, moments_kg_m2)
        return body

    def _created(self, shape: int, mass_kg: float, place: Sequence[float]) -> int:
        """A body of a collision shape. In a mirrored world it is one of Bullet's rigid bodies, whose solver starts each step from
        the impulses of the last; elsewhere a multibody without links, whose friction is a cone.
        """
        # Without a shape to draw, Bullet would make one of each collision shape: most of the time that a body takes.
        drawn = pybullet.createVisualShape(pybullet.GEOM_BOX, halfExtents=[1.0, 1.0, 1.0], physicsClientId=self.client)
        return int(
            pybullet.createMultiBody(
                mass_kg,
                shape,
                drawn,
                basePosition=place,
                useMaximalCoordinates=int(self.mirrored),
                physicsClientId=self.client,
            )
        )

    def _add_pedestal(self, pedestal: tuple[Pedestal, float] | None) -> None:
        if pedestal is None:
            return
        p, centre_m = pedestal
        self.pedestal_half_m = p.centroid_height_m
        squares = np.array([p.width_m**2, p.depth_m**2, p.height_m**2])
        moments = p.mass_kg / 12.0 * (np.sum(squares) - squares)
        if self.in_plane:
            moments = mirror.locked(moments)
        place = [centre_m, 0.0, p.centroid_height_m]
        if not self.mirrored:
            self.pedestal = shapes.linked_pedestal(p, self.radius_m, place, self.client)
            self._inert(self.pedestal, p.mass_kg, moments)
        else:
            shape = shapes.pedestal(p, self.radius_m, False, self.client, halved=self.mirrored)
            self.pedestal = self.add(shape, p.mass_kg, moments, place)
        if self.heading is not None:
            self.place(self.pedestal, Body((centre_m, 0.0, p.centroid_height_m), UPRIGHT, STILL, STILL))

    def _part_top(self, pedestal: int) -> None:
        """Let the face be met by the feet over it alone, and them not by the box."""
        pair, client, links = (
            pybullet.setCollisionFilterPair,
            self.client,
            pybullet.getNumJoints(self.statue, self.client),
        )
        for link in range(-1, links):
            over = self.feet_over and link == (OVER if self.edges else -1)
            pair(self.statue, pedestal, link, FACE, int(over), client)
            pair(self.statue, pedestal, link, BOX, int(self.edges and not over), client)
            pair(self.statue, pedestal, link, FEET, 0, client)
        for body in (self.floor, *(() if self.wall is None else (self.wall,))):
            pair(body, pedestal, -1, FACE, 0, client)
            pair(body, pedestal, -1, BOX, 0, client)

    def _add_statue(
        self,
        statue: tuple[float, Array, Array, Sequence[Array] | None, Body],
        beside: NDArray[np.bool_] | None,
    ) -> None:
        mass, moments, feet_m, convex_m, state = statue
        self.moments = (float(moments[0]), float(moments[1]), float(moments[2]))
        radius, self.feet_m = self.radius_m, feet_m
        if convex_m is not None:
            there = np.zeros(len(feet_m), dtype=bool) if beside is None else beside
            groups = [feet_m[~there], feet_m[there]]
            self.feet_over = len(groups[OVER]) > 0
            apart = [group for group in groups if len(group)]
            self.statue = shapes.described_body(feet_m[:0], radius, convex_m, self.client, apart)
            self._inert(self.statue, mass, moments)
        elif len(feet_m) <= shapes.MOST_IN_ARRAY:
            shape = shapes.feet(feet_m, radius, self.client)
            self.statue = self.add(shape, mass, moments, [0.0, 0.0, 0.0])
        else:
            self.statue = shapes.described_body(feet_m, radius, (), self.client)
            self._inert(self.statue, mass, moments)
        self.place(self.statue, state)

    def _inert(self, body: int, mass_kg: float, moments_kg_m2: Array) -> None:
        pybullet.changeDynamics(
            body,
            -1,
            mass=mass_kg,
            localInertiaDiagonal=[float(value) for value in moments_kg_m2],
            linearDamping=0.0,
            angularDamping=0.0,
            activationState=pybullet.ACTIVATION_STATE_DISABLE_SLEEPING,
            physicsClientId=self.client,
        )

    def surface(self, body: int, friction: float) -> None:
        """Coefficient of friction of a body, nothing else at its contacts."""
        for link in self._links(body):
            pybullet.changeDynamics(
                body,
                link,
                lateralFriction=friction,
                spinningFriction=0.0,
                rollingFriction=0.0,
                restitution=0.0,
                physicsClientId=self.client,
            )

    def _links(self, body: int) -> range:
        """Numbers of a body's links, its base's -1 first."""
        return range(-1, pybullet.getNumJoints(body, self.client))

    def anchor(self, *, held: bool) -> None:
        """Let the statue's feet come back to where they first stood, or no longer: a contact that slides has no such place."""
        link = OVER if self.edges else -1
        pybullet.changeDynamics(self.statue, link, frictionAnchor=int(held), physicsClientId=self.client)

    def place(self, body: int, state: Body) -> None:
        """Put a body into a state."""
        writing.place(body, state if self.heading is None else self.heading.body(state), self.client)

    def turn(self, by_rad: float) -> None:
        """Turn the scene's axes in Bullet's world by so much more; the bodies that move are then to be placed again."""
        self.turn_rad += by_rad
        self.heading = Heading.of(self.turn_rad)
        if self.wall is not None or self.table[1] != STILL:
            self.move_table(*self.table)

    def set_reach(self, reach: float) -> None:
        """The gap, in radii of the body, up to which vertices are contacts. Contacts are made anew: Bullet keeps it with each."""
        self.reach = reach
        pybullet.setPhysicsEngineParameter(contactBreakingThreshold=reach, physicsClientId=self.client)
        for body in (self.statue, self.pedestal):
            if body is not None and body >= 0:
                for link in self._links(body):
                    pybullet.setCollisionFilterGroupMask(body, link, MOVING, EVERYTHING, physicsClientId=self.client)

    def set_floor_friction(self, friction: float) -> None:
        """Coefficient of the pedestal on the floor from now on."""
        self.surface(self.floor, friction)

    def move_table(self, displacement_m: Vector, velocity_m_s: Vector) -> None:
        """Put floor and wall to where the table is, with its velocity."""
        self.table = (displacement_m, velocity_m_s)
        for body, (x, y, z) in self._homes.items():
            there = (x + displacement_m[0], y + displacement_m[1], z + displacement_m[2])
            self.place(body, Body(there, UPRIGHT, velocity_m_s, STILL))
