"""The world of one run: its client, every parameter sent, bodies in a fixed order and along its axes, closed at the end."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Final, Self, final

import numpy as np
import pybullet
from numpy.typing import NDArray

from harness.engines.base import EngineFailure
from harness.engines.pybullet import mirror, shapes
from harness.engines.pybullet.pose import Setup
from harness.engines.pybullet.settings import REFERENCE_DT_S, BulletSettings
from harness.engines.stepping.step_log import ALONE, Row, Vector
from harness.model import Array, Pedestal, Scene

# What Bullet's solver is told: every parameter of a world, and what the length of a step or a rest asks of it.


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


# The scene turned about the vertical in Bullet's world, so that what slides does so along one of Bullet's axes.
#
# Bullet resolves friction along its own x and y. Askew to these the force that it settles on leans towards them at every step,
# so that runs with finer steps agree on it; along them it is Coulomb's (docs/engines.md). All above the world keeps the scene's
# axes: states and pulls are turned as they are handed to Bullet, rows as they are read.


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

    def row(self, row: Row) -> Row:
        """The row of one or two bodies, turned."""
        turned: Row = ()
        c, s = self.half_cos, self.half_sin
        for k in range(0, len(row), ALONE):
            px, py, pz, x, y, z, w, u, v, q, a, b, r = row[k : k + ALONE]
            # The turn comes after the body's own: its quaternion (0, 0, s, c) stands on the left of the product.
            turn = (c * x - s * y, c * y + s * x, c * z + s * w, c * w - s * z)
            turned += (*self.vector((px, py, pz)), *turn, *self.vector((u, v, q)), *self.vector((a, b, r)))
        return turned


STILL: Final = (0.0, 0.0, 0.0)
UPRIGHT: Final = (0.0, 0.0, 0.0, 1.0)
ALOFT_M: Final = 1e3
"""Height at which bodies touch nothing, and above each other."""
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

    def __init__(self, settings: BulletSettings, setup: Setup) -> None:
        self.settings, self.setup = settings, setup
        self.turn_rad, self.heading = settings.turn_rad, Heading.of(settings.turn_rad)
        self.follows = settings.axes == "along"
        self.client = int(pybullet.connect(pybullet.DIRECT))
        if self.client < 0:
            raise EngineFailure("pybullet gave no client")
        self.length_s, self.resting = settings.dt_s, False
        self.floor = self.statue = -1
        self.wall: int | None = None
        self.pedestal: int | None = None
        self.edges, self.feet_over, self.reach = False, True, settings.reach
        self.pedestal_half_m = 0.0
        self.table: tuple[Vector, Vector] = (STILL, STILL)
        self._homes: dict[int, Vector] = {}

    def __enter__(self) -> Self:
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
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        pybullet.disconnect(self.client)

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
        s, mirrored = self.settings, self.setup.mirrored
        tight, share = step_s != s.dt_s, step_s / s.dt_s
        # So that a sub-step pushes no faster.
        erp = s.erp * step_s / s.dt_s
        # A step changes velocities by forces times Δt, so the squares that are compared go with Δt².
        iterations, residual = s.iterations, s.residual * (s.dt_s / REFERENCE_DT_S) ** 2
        if tight or mirrored:
            iterations = max(iterations, s.event_iterations)
            residual *= MIRRORED_RESIDUAL if mirrored else s.event_residual
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

    def build(
        self, scene: Scene, convex_m: Sequence[Array] | None = None, beside: NDArray[np.bool_] | None = None
    ) -> None:
        """Create the scene's bodies: the statue on its feet alone, or with convex bodies (n, 3) each in its principal frame.

        With these the pedestal has edges; `beside` (k,) are then the feet beside its top (None: none), the others meet its face
        as if that had no end.
        """
        self.edges = convex_m is not None
        radius, statue = self.settings.foot_radius_m, scene.statue
        self.floor = self._fixed((0.0, 0.0, 1.0), (0.0, 0.0, -radius))
        if scene.wall is not None:
            self.set_reach(max(self.reach, WALL_REACH))
            sign = scene.wall.sign
            place_m = sign * (statue.corner_m(sign) + scene.wall.distance_m)
            self.wall = self._fixed((-float(sign), 0.0, 0.0), (place_m + sign * radius, 0.0, 0.0))
        if self.settings.reversed_bodies:
            self._add_statue(statue.mass_kg, convex_m, beside)
        if scene.pedestal is not None:
            self._add_pedestal(scene.pedestal, statue.base_centre_m + scene.pedestal.offset_m)
        if not self.settings.reversed_bodies:
            self._add_statue(statue.mass_kg, convex_m, beside)
        if self.pedestal is not None and not self.setup.mirrored:
            self._part_top(self.pedestal)
        # Coefficients multiply: the floor's holds under the pedestal, the statue's on whatever the statue stands on.
        self.surface(self.statue, scene.contact.statue)
        if self.pedestal is not None:
            self.surface(self.pedestal, 1.0)
        self.set_floor_friction(scene.contact.floor_static if self.pedestal is not None else 1.0)
        if self.wall is not None:
            self.surface(self.wall, 1.0)
        if self.setup.mirrored:
            self._take_inertia()

    def _take_inertia(self) -> None:
        """A step far above everything, without gravity: until one has moved it a rigid body turns by the inertia of its shape."""
        states = {self.statue: self.setup.start}
        if self.pedestal is not None:
            states[self.pedestal] = at_rest(pybullet.getBasePositionAndOrientation(self.pedestal, self.client)[0])
        for number, (body, state) in enumerate(states.items(), 1):
            self.place(body, (*state[:2], state[2] + number * ALOFT_M, *state[3:7], *STILL, *STILL))
        pybullet.stepSimulation(self.client)
        for body, state in states.items():
            self.place(body, state)

    def _fixed(self, normal: Vector, place: Vector) -> int:
        body = self._created(shapes.plane(normal, self.client), 0.0, place)
        self._homes[body] = place
        if self.heading is not None:
            self.place(body, at_rest(place))
        return body

    def add(self, shape: int, mass_kg: float, moments_kg_m2: Array, place: Sequence[float]) -> int:
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
                useMaximalCoordinates=int(self.setup.mirrored),
                physicsClientId=self.client,
            )
        )

    def _add_pedestal(self, pedestal: Pedestal, centre_m: float) -> None:
        squares = np.array([pedestal.width_m**2, pedestal.depth_m**2, pedestal.height_m**2])
        moments = pedestal.mass_kg / 12.0 * (np.sum(squares) - squares)
        if self.setup.in_plane:
            moments = mirror.locked(moments)
        self.pedestal_half_m = pedestal.centroid_height_m
        radius, place = self.settings.foot_radius_m, (centre_m, 0.0, pedestal.centroid_height_m)
        if self.setup.mirrored:
            shape = shapes.halved_pedestal(pedestal, radius, self.client)
            self.pedestal = self.add(shape, pedestal.mass_kg, moments, place)
        else:
            self.pedestal = shapes.linked_pedestal(pedestal, radius, place, self.client)
            self._inert(self.pedestal, pedestal.mass_kg, moments)
        if self.heading is not None:
            self.place(self.pedestal, at_rest(place))

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

    def _add_statue(self, mass_kg: float, convex_m: Sequence[Array] | None, beside: NDArray[np.bool_] | None) -> None:
        radius, feet_m, moments = self.settings.foot_radius_m, self.setup.feet_m, self.setup.moments
        if convex_m is not None:
            there = np.zeros(len(feet_m), dtype=bool) if beside is None else beside
            groups = [feet_m[~there], feet_m[there]]
            self.feet_over = len(groups[OVER]) > 0
            apart = [group for group in groups if len(group)]
            self.statue = shapes.described_body(feet_m[:0], radius, convex_m, self.client, apart)
            self._inert(self.statue, mass_kg, moments)
        elif len(feet_m) <= shapes.MOST_IN_ARRAY:
            self.statue = self.add(shapes.feet(feet_m, radius, self.client), mass_kg, moments, STILL)
        else:
            self.statue = shapes.described_body(feet_m, radius, (), self.client)
            self._inert(self.statue, mass_kg, moments)
        self.place(self.statue, self.setup.start)

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

    def place(self, body: int, state: Row) -> None:
        """Put a body into a state, its part of a row."""
        state = state if self.heading is None else self.heading.row(state)
        pybullet.resetBasePositionAndOrientation(body, state[0:3], state[3:7], physicsClientId=self.client)
        pybullet.resetBaseVelocity(body, state[7:10], state[10:13], physicsClientId=self.client)

    def twist(self, torque_n_m: Vector) -> None:
        """Add a torque on the statue to the step that follows: Bullet forgets it with that."""
        torque = torque_n_m if self.heading is None else self.heading.vector(torque_n_m)
        # In the world's axes: Bullet would turn one given in the body's by the rotation at the step's beginning.
        pybullet.applyExternalTorque(self.statue, -1, torque, pybullet.WORLD_FRAME, self.client)

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
            self.place(body, (*there, *UPRIGHT, *velocity_m_s, *STILL))


def at_rest(place_m: Sequence[float]) -> Row:
    """The part of a row of a body that stands upright and still."""
    return (*place_m, *UPRIGHT, *STILL, *STILL)
