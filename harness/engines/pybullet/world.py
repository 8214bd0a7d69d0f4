"""The world of one run: its client, every parameter sent, bodies in a fixed order and along its axes, closed at the end."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Final, Self, final

import numpy as np
import pybullet
from numpy.typing import NDArray

from harness.engines.base import EngineFailure
from harness.engines.pybullet.settings import REFERENCE_DT_S, BulletSettings
from harness.engines.pybullet.statue import (
    MOST_IN_ARRAY,
    Setup,
    compound,
    described_body,
    halved_pedestal,
    linked_pedestal,
    locked,
    plane,
)
from harness.engines.stepping.step_state import StepState
from harness.engines.stepping.support import SLIDES_M_S
from harness.engines.stepping.trajectory import ALONE, Account, Impulse, Ledger, Row, StepLog, Vector, crossed
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
        body = self._created(plane(normal, self.client), 0.0, place)
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
            moments = locked(moments)
        self.pedestal_half_m = pedestal.centroid_height_m
        radius, place = self.settings.foot_radius_m, (centre_m, 0.0, pedestal.centroid_height_m)
        if self.setup.mirrored:
            shape = halved_pedestal(pedestal, radius, self.client)
            self.pedestal = self.add(shape, pedestal.mass_kg, moments, place)
        else:
            self.pedestal = linked_pedestal(pedestal, radius, place, self.client)
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
            self.statue = described_body(feet_m[:0], radius, convex_m, self.client, apart)
            self._inert(self.statue, mass_kg, moments)
        elif len(feet_m) <= MOST_IN_ARRAY:
            self.statue = self.add(compound(feet_m, radius, self.client), mass_kg, moments, STILL)
        else:
            self.statue = described_body(feet_m, radius, (), self.client)
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


# Bullet behind the layer that locates events: its own step, rows read and written, and what its contacts need next.


NEAR_M: Final = 1e-4
"""A foot further above its support than this rubs on nothing."""
IN_LINE_RAD: Final = 3e-4
"""So near to one of Bullet's axes friction leans by less than a ten-thousandth of itself."""
EIGHTH_RAD: Final = 0.25 * math.pi


# Bullet's gyroscopic torque made of second order: what a step's own misses is added to it as an external torque.
#
# Euler's equations are I ω̇ + ω × I ω = τ. Bullet takes ω × I ω at the velocity with which a step begins, half a step before
# the step's middle: the rotation then errs by the first order of the step, in flight as about a vertex. Here it is taken at the
# velocity foreseen for the middle of the time over which the velocity is changed. No place and no velocity is written.

KIND: Final = "gyroscopic"
"""Kind of this intervention."""
STILL_RAD_S: Final = 1e-6
"""A body that turns more slowly has no gyroscopic torque worth a call: less than 1e-12 rad/s²."""


class Gyroscope:
    """The torque that the next step lacks: `prepare_step` it from the rows, `act` before each solution of the step."""

    def __init__(self, world: World) -> None:
        self.world = world
        # What turns in the plane alone turns about a principal axis: nothing is missing.
        self.moments: list[float] | None = None if world.setup.in_plane else world.setup.moments.tolist()
        self.torque: Vector | None = None

    def prepare_step(self, row: Row, rate_rad_s2: Vector, span_s: float, length_s: float, ledger: Ledger) -> None:
        """A step of `length_s` that takes velocities on by `span_s` (shorter around events), from a row whose angular velocity
        changes by `rate_rad_s2`.
        """
        self.torque = None
        if self.moments is None or abs(row[10]) + abs(row[11]) + abs(row[12]) < STILL_RAD_S:
            return
        (ix, iy, iz), (x, y, z, w), half = self.moments, row[3:7], 0.5 * span_s
        # Columns of the body's rotation.
        ax, ay, az = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)
        bx, by, bz = 2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)
        cx, cy, cz = 2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)
        f, g, h = row[10:13]
        p, q, r = f * ax + g * ay + h * az, f * bx + g * by + h * bz, f * cx + g * cy + h * cz
        f, g, h = f + half * rate_rad_s2[0], g + half * rate_rad_s2[1], h + half * rate_rad_s2[2]
        u, v, s = f * ax + g * ay + h * az, f * bx + g * by + h * bz, f * cx + g * cy + h * cz
        share = span_s / length_s
        a = (iy - iz) * (share * v * s - q * r)
        b = (iz - ix) * (share * s * u - r * p)
        c = (ix - iy) * (share * u * v - p * q)
        self.torque = a * ax + b * bx + c * cx, a * ay + b * by + c * cy, a * az + b * bz + c * cz
        rate_rad_s = length_s * math.hypot(a / ix, b / iy, c / iz)
        ledger[KIND].write(0.0, 0.0, 0.0, rate_rad_s, length_s * (a * p + b * q + c * r))

    def act(self) -> None:
        """Add the torque foreseen to the step that follows: Bullet forgets it with that."""
        if self.torque is not None:
            self.world.twist(self.torque)


GRIP: Final = 0.5
"""Share of the statue's friction limit from which on its feet are not taken to stand, and"""
GRIP_AGAIN: Final = 0.35
"""below which they are again."""
STEPS_OFF: Final = 2.0
"""A body's reach over the square of its turning in a step, at least: half of that is what a step takes a foot off its support."""
WIDER: Final = 4.0
"""How many times as wide it is made as that, when it is too narrow, and"""
NARROWER: Final = 256.0
"""how many times too wide it may be."""
RESTING_M_S: Final = 1e-3
"""Velocity, m/s and rad/s, below which statue and pedestal rest: one that rocks is slower for a hundredth of a half-cycle."""
AXES_TURNED: Final = "axes_turned"
"""Kind of steps solved again with Bullet's axes along what slid in them, and"""
MOST_TURNS: Final = 3
"""how often one is at most."""


class BulletBackend:
    """One of Bullet's worlds (`harness.engines.stepping.step_state.Backend`); `step_s` is the length of its whole steps,
    `grip_limit` the statue's coefficient of friction, None where its feet are never told to keep their places.
    """

    depth_m = 0.0
    owed_m_s = (0.0, 0.0)
    near: bool | None = None

    def __init__(self, world: World, step_s: float, grip_limit: float | None = None) -> None:
        self.world, self.step_s, self.grip_limit = world, step_s, grip_limit
        self.read, self.pull = reader(world), puller(world)
        self.gyroscope, self.ledger = Gyroscope(world), Ledger(Account)
        self.row = self.read()
        self.runs = not self.gyroscope.moments
        self.set_length, self.set_floor_friction = world.set_length, world.set_floor_friction
        self.move_table = world.move_table
        self.least_reach, self.grips = world.reach, False
        if grip_limit is not None and world.feet_over:
            self._anchor(held=True)

    def place(self, row: Row) -> None:
        """Put both bodies into the state of a row, and a table that Bullet has moved on back under them."""
        self.row = row
        self.world.place(self.world.statue, row[:ALONE])
        if self.world.pedestal is not None:
            self.world.place(self.world.pedestal, row[ALONE:])
        if any(self.world.table[1]):
            self.world.move_table(*self.world.table)

    def prepare_step(self, state: StepState, kick_s: float, length_s: float) -> None:
        """What Bullet's gyroscopic torque misses in the next step; after an impact the change of velocities is not known yet."""
        self.ledger = state.record.ledger
        if self.gyroscope.moments is None:
            return
        record, change = state.record, (0.0, 0.0, 0.0)
        if state.smooth and len(record.t_s) > 1:
            last_s = record.kick_s[-1] - record.kick_s[-2]
            if last_s > state.events.shortest * self.step_s:
                x, y, z = record.row(-2)[10:13]
                change = ((state.row[10] - x) / last_s, (state.row[11] - y) / last_s, (state.row[12] - z) / last_s)
        self.gyroscope.prepare_step(state.row, change, kick_s - state.kick_s, length_s, record.ledger)

    def impulses(self, places: Row) -> list[Impulse]:
        """What the contacts gave each body in the last step."""
        world, heading = self.world, self.world.heading
        bodies_of = [world.statue] if world.pedestal is None else [world.statue, world.pedestal]
        sums = {body: ([0.0, 0.0, 0.0], [0.0, 0.0, 0.0]) for body in bodies_of}
        for contact in pybullet.getContactPoints(physicsClientId=world.client):
            place, parts = (
                contact[5],
                ((contact[9], contact[7]), (contact[10], contact[11]), (contact[12], contact[13])),
            )
            given: Vector = tuple(world.length_s * sum(size * axis[k] for size, axis in parts) for k in range(3))
            if heading is not None:
                given, place = heading.back.vector(given), heading.back.vector(place)
            for body, sign in ((contact[1], 1.0), (contact[2], -1.0)):
                if body in sums:
                    at = ALONE * bodies_of.index(body)
                    arm = tuple(place[k] - places[at + k] for k in range(3))
                    for total, part in zip(sums[body], (given, crossed(arm, given)), strict=True):
                        for k in range(3):
                            total[k] += sign * part[k]
        return [((*impulse,), (*moment,)) for impulse, moment in sums.values()]  # type: ignore[misc]

    def advance(self, gravity: Vector) -> Row:
        """Bullet's own step under a gravity, and the row after it; again with its axes along what slides after it."""
        before = self.row
        for turns in range(MOST_TURNS + 1):
            self.pull(*gravity, self.world.client)
            self.gyroscope.act()
            pybullet.stepSimulation(self.world.client)
            row = self.read()
            askew_rad = self._askew_rad(row) if self.world.follows and turns < MOST_TURNS else 0.0
            if abs(askew_rad) <= IN_LINE_RAD:
                break
            self.world.turn(-askew_rad)
            self.ledger[AXES_TURNED].steps_again += 1
            self.place(before)
        self.row = row
        return row

    def _askew_rad(self, row: Row) -> float:
        """Angle from the nearer of Bullet's axes to the line along which the pedestal slides on the floor, or while it does not
        the statue's lowest foot; 0 where nothing slides.

        Bullet's friction is Coulomb's along its own x and y, whatever a contact's effective masses: one of these is to lie
        along it.
        """
        (_, _, up), (u, v, _) = self.world.table
        x, y, least = 0.0, 0.0, SLIDES_M_S
        if len(row) > ALONE:
            half_m = self.world.pedestal_half_m
            x, y, up = row[20] - row[24] * half_m - u, row[21] + row[23] * half_m - v, up + 2.0 * half_m
        if math.hypot(x, y) < least:
            x, y, least = self._lowest_foot(row, up)
            x, y = x - u, y - v
        if math.hypot(x, y) < least:
            return 0.0
        own = math.atan2(y, x) + self.world.turn_rad - self.world.settings.turn_rad
        return (own + EIGHTH_RAD) % (2.0 * EIGHTH_RAD) - EIGHTH_RAD

    def _lowest_foot(self, row: Row, support_m: float) -> tuple[float, float, float]:
        """Velocity of the lowest foot, m/s, and how fast it must be to slide: infinitely where it is above its support."""
        x, y, z, w = row[3:7]
        feet_m = self.world.setup.feet_m
        downs = feet_m @ (2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y))
        lowest = int(downs.argmin())
        if row[2] + float(downs[lowest]) - support_m > NEAR_M:
            return 0.0, 0.0, math.inf
        c = float(downs[lowest])
        e, f, g = feet_m[lowest].tolist()
        a = (1.0 - 2.0 * (y * y + z * z)) * e + 2.0 * ((x * y - z * w) * f + (x * z + y * w) * g)
        b = 2.0 * ((x * y + z * w) * e + (y * z - x * w) * g) + (1.0 - 2.0 * (x * x + z * z)) * f
        p, q, r = row[10:13]
        # A foot that stands moves by its body's turning in half a step: velocities are older than places by that.
        turning = (p * p + q * q + r * r) * math.sqrt(a * a + b * b + c * c) * self.step_s
        return row[7] + q * c - r * b, row[8] + r * a - p * c, SLIDES_M_S + turning

    def run(self, pulls: Sequence[Vector], record: StepLog) -> Row:
        """Several steps of a body that needs no gyroscopic torque: rows are recorded, the last is returned."""
        set_gravity, step, read, client = self.pull, pybullet.stepSimulation, self.read, self.world.client
        row: Row = ()
        keep, pack = record.flat.frombytes, record.pack
        for gravity in pulls:
            set_gravity(*gravity, client)
            step(client)
            row = read()
            keep(pack(*row))
        return row

    def look(self, pulls: Sequence[Vector], before: Row, after: Row, table_m_s: Vector) -> None:
        """After whole steps under `pulls`: reach, grip and iterations that the bodies' contacts need next."""
        world, turning = self.world, after[10] * after[10] + after[11] * after[11]
        if len(after) > ALONE:
            table = (*table_m_s, 0.0, 0.0, 0.0)
            moving = (abs(v - w) for k in (7, 20) for v, w in zip(after[k : k + 6], table, strict=True))
            world.rest(not world.setup.in_plane and max(moving) < RESTING_M_S)
            turning = max(turning, after[23] * after[23] + after[24] * after[24])
        # A step takes a foot ω² h dt²/2 off its support: beyond its reach it is no contact there.
        needed = STEPS_OFF * turning * self.step_s**2
        if needed > world.reach or needed * NARROWER < world.reach > self.least_reach:
            world.set_reach(max(WIDER * needed, self.least_reach))
        if world.feet_over and self.grip_limit is not None:
            self._look_at_grip(self.grip_limit, pulls, before, after)

    def _look_at_grip(self, limit: float, pulls: Sequence[Vector], before: Row, after: Row) -> None:
        """Let the statue's feet keep their places only while its friction is far from its limit."""
        first, last, half_s = pulls[0], pulls[-1], 0.5 * len(pulls) * self.step_s
        x = after[7] - before[7] - half_s * (first[0] + last[0])
        y = after[8] - before[8] - half_s * (first[1] + last[1])
        z = after[9] - before[9] - half_s * (first[2] + last[2])
        share = GRIP if self.grips else GRIP_AGAIN
        if (math.hypot(x, y) < share * limit * z) != self.grips:
            self._anchor(held=not self.grips)

    def _anchor(self, *, held: bool) -> None:
        self.grips = held
        self.world.anchor(held=held)


def puller(world: World) -> Callable[[float, float, float, int], None]:
    """What sets a gravity, given along the scene's axes."""
    set_gravity: Callable[[float, float, float, int], None] = pybullet.setGravity

    def turned(x: float, y: float, z: float, client: int) -> None:
        set_gravity(*((x, y, z) if world.heading is None else world.heading.vector((x, y, z))), client)

    return set_gravity if world.heading is None and not world.follows else turned


def reader(world: World) -> Callable[[], Row]:
    """What reads the state of both bodies as one row."""
    pose, speed, client = pybullet.getBasePositionAndOrientation, pybullet.getBaseVelocity, world.client
    statue, pedestal = world.statue, world.pedestal

    def both() -> Row:
        place, turn = pose(statue, client)
        velocity, rate = speed(statue, client)
        below, level = pose(pedestal, client)
        slip, tip = speed(pedestal, client)
        return (*place, *turn, *velocity, *rate, *below, *level, *slip, *tip)

    def alone() -> Row:
        place, turn = pose(statue, client)
        velocity, rate = speed(statue, client)
        return (*place, *turn, *velocity, *rate)

    read = alone if pedestal is None else both
    if world.heading is None and not world.follows:
        return read
    return lambda: read() if world.heading is None else world.heading.back.row(read())
