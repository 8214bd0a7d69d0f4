"""The scene as pymunk bodies: statue, pedestal, floor and wall in the rocking plane; and how Chipmunk is stepped and read."""

import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import pymunk
from pymunk import batch
from pymunk._chipmunk_cffi import ffi, lib

from harness.engines.pymunk.settings import MunkSettings
from harness.engines.stepping.support import FLAT_M, pedestal_inertia_kg_m2
from harness.engines.stepping.trajectory import Impulse
from harness.model import Array, Pedestal, Pose, Scene

# Chipmunk's own functions, called without pymunk's Python layer around each step.
#
# pymunk's `Space.step` spends more time on its lists of pending changes than Chipmunk on two bodies, and a property read costs
# as much as a collision. No body, shape or callback is added while a run goes on, so these lists stay empty and the results are
# the same (test_pymunk.py compares them). One call reads all bodies.

State = tuple[float, float, float, float, float, float]
"""Place x, z, rotation (anticlockwise, as Chipmunk counts) and their rates."""

FIELDS: Final = (
    batch.BodyFields.POSITION | batch.BodyFields.ANGLE | batch.BodyFields.VELOCITY | batch.BodyFields.ANGULAR_VELOCITY
)
WIDTH: Final = 6
"""Numbers for each body: x, z, angle (anticlockwise), their rates."""


def contacts_of(body: Any) -> Impulse | None:
    """What the contacts of one of Chipmunk's bodies gave it in the last step, about y as the layer counts.

    None where a pair touches again: its sums begin with an impulse of before, which is not applied.
    """
    sums, again = [0.0, 0.0, 0.0], []

    def add(_: Any, arbiter: Any, __: Any) -> None:
        if arbiter.state == lib.CP_ARBITER_STATE_FIRST_COLLISION:
            again.append(arbiter)
        for k in range(arbiter.count):
            contact, n = arbiter.contacts[k], arbiter.n
            sign, arm = (-1.0, contact.r1) if arbiter.body_a == body else (1.0, contact.r2)
            x = sign * (n.x * contact.jnAcc - n.y * contact.jtAcc)
            z = sign * (n.y * contact.jnAcc + n.x * contact.jtAcc)
            sums[0], sums[1], sums[2] = sums[0] + x, sums[1] + z, sums[2] + arm.y * x - arm.x * z

    lib.cpBodyEachArbiter(body, ffi.callback("void(cpBody *, cpArbiter *, void *)", add), ffi.NULL)
    return None if again else ((sums[0], 0.0, sums[1]), (0.0, sums[2], 0.0))


class StateReader:
    """Reads the states of a space's first bodies: one call into the library for all numbers of all."""

    def __init__(self, space: pymunk.Space, count: int, *, backwards: bool) -> None:
        """All bodies must have been added; the first `count`, one or two, are read, `backwards` in the order opposite to that in
        which they were.
        """
        # Not `batch.Buffer`: it never frees what its arrays have grown to (some 170 bytes a step, in every run).
        self._floats = ffi.gc(lib.pmFloatArrayNew(0), lib.pmFloatArrayFree)
        self._ints = ffi.gc(lib.pmIntArrayNew(0), lib.pmIntArrayFree)
        self._target = ffi.new("pmBatchedData *")
        self._target.fields = FIELDS.value
        self._target.floatArray, self._target.intArray = self._floats, self._ints
        self._each = ffi.addressof(lib, "pmSpaceBodyGetIteratorFuncBatched")
        self._space, self._width, self._backwards = space._space, WIDTH * count, backwards

    def states(self, seconds: float = 0.0) -> list[State]:
        """Each body's place, rotation and rates after so many seconds at these."""
        floats = self._floats
        floats.num = 0
        lib.cpSpaceEachBody(self._space, self._each, self._target)
        # Without a loop: it is done after every step.
        x, z, angle, u, w, spin, *more = ffi.unpack(floats.arr, self._width)
        one = (x + u * seconds, z + w * seconds, angle + spin * seconds, u, w, spin)
        if not more:
            return [one]
        x, z, angle, u, w, spin = more
        other = (x + u * seconds, z + w * seconds, angle + spin * seconds, u, w, spin)
        return [other, one] if self._backwards else [one, other]


# The scene's bodies.

FLOOR_M: Final = 1000.0
"""Half length of the floor and height of the wall: beyond any table's travel."""


@dataclass(frozen=True, eq=False)
class World:
    """Handles of one run; `reader` reads the states of the statue, and of the pedestal if there is one."""

    space: pymunk.Space
    statue: pymunk.Body
    pedestal: pymunk.Body | None
    floor: pymunk.Body
    floor_shape: pymunk.Shape
    reader: StateReader


def build(scene: Scene, settings: MunkSettings) -> World:
    """A fresh space with everything in its place."""
    space = pymunk.Space()
    space.iterations = settings.iterations
    space.collision_slop = settings.slop_m
    space.sleep_time_threshold = math.inf
    floor = space.static_body
    if scene.table == "moving":
        floor = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    centre_m = scene.statue.base_centre_m
    pedestal = None if scene.pedestal is None else _pedestal(scene.pedestal, centre_m, settings)
    statue = _statue(scene, settings)
    dynamic = [statue] if pedestal is None else [statue, pedestal]
    if settings.pedestal_first:
        dynamic.reverse()
    for body in dynamic:
        space.add(body, *body.shapes)
    # The floor last: bodies are read in the order in which they are added.
    if floor is not space.static_body:
        space.add(floor)
    floor_shape = _floor(scene, space, floor)
    reader = StateReader(space, len(dynamic), backwards=settings.pedestal_first)
    return World(space, statue, pedestal, floor, floor_shape, reader)


def _floor(scene: Scene, space: pymunk.Space, floor: pymunk.Body) -> pymunk.Shape:
    thick = 1.0
    shape = pymunk.Segment(floor, (-FLOOR_M, -thick), (FLOOR_M, -thick), thick)
    # Chipmunk multiplies the coefficients of two shapes: the statue brings its own, the pedestal 1, the floor the rest.
    shape.friction = 1.0 if scene.pedestal is None else scene.contact.floor_static
    shape.elasticity = 1.0
    space.add(shape)
    if scene.wall is not None:
        reach = scene.statue.corner_m(scene.wall.sign) + scene.wall.distance_m
        x = scene.wall.sign * (reach + thick)
        wall = pymunk.Segment(floor, (x, 0.0), (x, FLOOR_M), thick)
        wall.friction = 1.0
        space.add(wall)
    return shape


def _pedestal(pedestal: Pedestal, centre_m: float, settings: MunkSettings) -> pymunk.Body:
    w, _, h = pedestal.half_m
    body = pymunk.Body(pedestal.mass_kg, pedestal_inertia_kg_m2(pedestal))
    shape = pymunk.Poly(body, [(-w, -h), (w, -h), (w, h), (-w, h)])
    shape.friction = 1.0
    body.position = (centre_m + pedestal.offset_m, h - 0.5 * settings.slop_m)
    return body


def _statue(scene: Scene, settings: MunkSettings) -> pymunk.Body:
    statue = scene.statue
    section = statue.section_m - np.array([0.0, statue.centroid_height_m])
    body = pymunk.Body(statue.mass_kg, statue.inertia_kg_m2)
    shape = pymunk.Poly(body, [(float(x), float(z)) for x, z in section])
    shape.friction = scene.contact.statue
    if scene.initial.pose is not None:
        _throw(body, scene.initial.pose)
        # Chipmunk multiplies these coefficients too: the floor's is 1.
        shape.elasticity = scene.contact.restitution or 0.0
        return body
    theta, rate = scene.initial.theta_rad, scene.initial.theta_rate_rad_s
    top = 0.0 if scene.pedestal is None else scene.pedestal.height_m - 0.5 * settings.slop_m
    # The vertex it stands on keeps its place; the body turns about it.
    side = math.copysign(1.0, theta if theta != 0.0 else rate)
    turned = rotated(section, theta)
    lowest = np.flatnonzero(turned[:, 1] <= np.min(turned[:, 1]) + FLAT_M)
    pivot = int(lowest[np.argmax(side * section[lowest, 0])])
    arm = turned[pivot]
    velocity = rate * np.array([-arm[1], arm[0]])
    start = np.array([section[pivot, 0], top - settings.depth_m]) - arm
    body.angle, body.angular_velocity = -theta, -rate
    body.position = (float(start[0]), float(start[1]))
    body.velocity = (float(velocity[0]), float(velocity[1]))
    return body


def _throw(body: pymunk.Body, pose: Pose) -> None:
    """Place a body as a pose in the rocking plane says; `harness.engines.pymunk` refuses any other."""
    (w, _, turn, _), (x, _, z), (u, _, v) = pose.quaternion_wxyz, pose.position_m, pose.velocity_m_s
    body.angle, body.angular_velocity = -2.0 * math.atan2(turn, w), -pose.angular_velocity_rad_s[1]
    body.position, body.velocity = (x, z), (u, v)


def rotated(points_m: Array, theta_rad: float) -> Array:
    """Points (k, 2) turned clockwise by θ."""
    cos, sin = math.cos(theta_rad), math.sin(theta_rad)
    x, z = points_m[:, 0], points_m[:, 1]
    return np.column_stack([x * cos + z * sin, z * cos - x * sin])
