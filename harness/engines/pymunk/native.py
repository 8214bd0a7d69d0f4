"""Chipmunk's own functions, called without pymunk's Python layer around each step.

pymunk's `Space.step` spends more time on its lists of pending changes than Chipmunk on two bodies, and a property read costs
as much as a collision. No body, shape or callback is added while a run goes on, so these lists stay empty and the results are
the same (test_pymunk.py compares them). One call after each step appends all bodies' states to a buffer
in C.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk import batch
from pymunk._chipmunk_cffi import ffi, lib

Array = NDArray[np.float64]

step: Final = lib.cpSpaceStep
set_gravity: Final = lib.cpSpaceSetGravity
set_iterations: Final = lib.cpSpaceSetIterations
each_body: Final = lib.cpSpaceEachBody
get_angle: Final = lib.cpBodyGetAngle
get_spin: Final = lib.cpBodyGetAngularVelocity
get_place: Final = lib.cpBodyGetPosition
get_velocity: Final = lib.cpBodyGetVelocity
set_friction: Final = lib.cpShapeSetFriction

unpack: Final = ffi.unpack

FIELDS: Final = (
    batch.BodyFields.POSITION | batch.BodyFields.ANGLE | batch.BodyFields.VELOCITY | batch.BodyFields.ANGULAR_VELOCITY
)
WIDTH: Final = 6
"""Numbers for each body: x, z, angle (anticlockwise), their rates."""
ROWS_BACK: Final = 66
"""Rows that `Recorder.last` still knows when all were taken."""
SPIN: Final = 5
"""Place of the last of them."""


def space_of(space: pymunk.Space) -> Any:
    """Chipmunk's space."""
    return space._space


def body_of(body: pymunk.Body) -> Any:
    """Chipmunk's body."""
    return body._body


def shape_of(shape: pymunk.Shape) -> Any:
    """Chipmunk's shape."""
    return shape._shape


def state_of(body: Any) -> list[float]:
    """x, z, angle, and their rates, as a row of the recorder has them."""
    place, velocity = get_place(body), get_velocity(body)
    return [place.x, place.y, get_angle(body), velocity.x, velocity.y, get_spin(body)]


class Recorder:
    """Appends the state of every body of a space to memory in C; `take` moves what is there into an array."""

    def __init__(self, space: pymunk.Space) -> None:
        """All bodies must have been added: dynamic ones come first in a row, the floor after them."""
        # Not `batch.Buffer`: it never frees what its arrays have grown to (some 170 bytes a step with a pedestal, in every run).
        self._floats = ffi.gc(lib.pmFloatArrayNew(0), lib.pmFloatArrayFree)
        self._ints = ffi.gc(lib.pmIntArrayNew(0), lib.pmIntArrayFree)
        self._taken: Array = np.empty((0, 0))
        self.target = ffi.new("pmBatchedData *")
        self.target.fields = FIELDS.value
        self.target.floatArray = self._floats
        self.target.intArray = self._ints
        self.each = ffi.addressof(lib, "pmSpaceBodyGetIteratorFuncBatched")
        each_body(space_of(space), self.each, self.target)
        self.row = int(self._floats.num)
        self._floats.num = 0

    def last(self, back: int = 0) -> list[float]:
        """The row recorded last, or one of those before it (`back` 1, 2, … `ROWS_BACK` − 1); empty where there is none."""
        floats = self._floats
        end = floats.num - back * self.row
        if end > 0:
            row: list[float] = unpack(floats.arr + (end - self.row), self.row)
            return row
        # The rows before were taken.
        rows_before = end // self.row - 1
        taken: list[float] = self._taken[rows_before].tolist() if -rows_before <= len(self._taken) else []
        return taken

    def drop(self) -> bool:
        """Forget the row recorded last; False, and nothing done, where it was taken."""
        if self._floats.num < self.row:
            return False
        self._floats.num -= self.row
        return True

    def take(self) -> Array:
        """The states recorded since the last call, shape (n, 6·bodies), in the order of the space's bodies."""
        floats = self._floats
        recorded = ffi.buffer(floats.arr, floats.num * ffi.sizeof("cpFloat"))
        states = np.frombuffer(recorded, dtype=np.float64).reshape(-1, self.row).copy()
        self._taken = np.concatenate([self._taken.reshape(-1, self.row), states[-ROWS_BACK:]])[-ROWS_BACK:].copy()
        floats.num = 0
        return states
