"""Chipmunk's own functions, called without pymunk's Python layer around each step.

pymunk's `Space.step` spends more time on its lists of pending changes than Chipmunk on two bodies, and a property read costs
as much as a collision. No body, shape or callback is added while a run goes on, so these lists stay empty and the results are
the same (test_pymunk.py compares them). One call reads all bodies.
"""

from __future__ import annotations

from typing import Any, Final

import pymunk
from pymunk import batch
from pymunk._chipmunk_cffi import ffi, lib

from harness.engines.stepping.step_log import Impulse

State = tuple[float, float, float, float, float, float]
"""Place x, z, rotation (anticlockwise, as Chipmunk counts) and their rates."""

step: Final = lib.cpSpaceStep
set_gravity: Final = lib.cpSpaceSetGravity
set_iterations: Final = lib.cpSpaceSetIterations
set_friction: Final = lib.cpShapeSetFriction

unpack: Final = ffi.unpack

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
        x, z, angle, u, w, spin, *more = unpack(floats.arr, self._width)
        one = (x + u * seconds, z + w * seconds, angle + spin * seconds, u, w, spin)
        if not more:
            return [one]
        x, z, angle, u, w, spin = more
        other = (x + u * seconds, z + w * seconds, angle + spin * seconds, u, w, spin)
        return [other, one] if self._backwards else [one, other]
