"""MuJoCo behind the layer: its own step, and rows read and written.

MuJoCo changes velocities first and moves places with the new ones, as the layer reads a step. An impact on its soft contact takes
several steps: none is located, and of the layer friction's two numbers are used alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mujoco

from harness.engines.event_stepping.backend import Instant
from harness.engines.event_stepping.rows import ALONE, Row, Vector
from harness.engines.event_stepping.step_log import StepLog
from harness.engines.mujoco.model import FLOOR_PAIR


class MujocoBackend:
    """One of MuJoCo's models (`harness.engines.event_stepping.backend.Backend`). Raises `ValueError` for a bad text of it."""

    depth_m = 0.0
    owed_m_s = (0.0, 0.0)
    near: bool | None = None
    runs = True

    def __init__(self, text: str) -> None:
        self.model = mujoco.MjModel.from_xml_string(text)
        self.data = mujoco.MjData(self.model)

    def read(self) -> Row:
        """The bodies' state."""
        places, rates = self.data.qpos.tolist(), self.data.qvel.tolist()
        row: Row = ()
        for k in range(len(rates) // 6):
            x, y, z, w, a, b, c = places[7 * k : 7 * k + 7]
            # MuJoCo's angular velocity is along the body's axes.
            spin = _turned((a, b, c, w), rates[6 * k + 3 : 6 * k + 6])
            row += (x, y, z, a, b, c, w, *rates[6 * k : 6 * k + 3], *spin)
        return row

    def place(self, row: Row) -> None:
        """Put the bodies into the state of a row."""
        places: list[float] = []
        rates: list[float] = []
        for k in range(0, len(row), ALONE):
            a, b, c, w = row[k + 3 : k + 7]
            places += (*row[k : k + 3], w, a, b, c)
            rates += (*row[k + 7 : k + 10], *_turned((-a, -b, -c, w), row[k + 10 : k + 13]))
        self.data.qpos[:], self.data.qvel[:] = places, rates

    def set_length(self, length_s: float) -> None:
        """Length of the steps that follow, s."""
        self.model.opt.timestep = length_s

    def foresee(self, state: Instant, kick_s: float, length_s: float) -> None:
        """Nothing: a step tells all that the next one needs."""

    def advance(self, gravity: Vector) -> Row:
        """One step under a gravity; the row after it."""
        self.model.opt.gravity[:] = gravity
        mujoco.mj_step(self.model, self.data)
        return self.read()

    def run(self, pulls: Sequence[Vector], record: StepLog) -> Row:
        """Whole steps one after the other; rows are recorded, the last is returned."""
        row: Row = ()
        for gravity in pulls:
            row = self.advance(gravity)
            record.flat.frombytes(record.pack(*row))
        return row

    def set_floor_friction(self, friction: float) -> None:
        """Coefficient of the pedestal on the floor from now on."""
        self.model.pair(FLOOR_PAIR).friction[:2] = friction

    def move_table(self, place_m: Vector, velocity_m_s: Vector) -> None:
        """Raises `NotImplementedError`: scenes with a moving table are refused before."""
        raise NotImplementedError

    def look(self, pulls: Sequence[Vector], before: Row, after: Row, table_m_s: Vector) -> None:
        """Nothing: contacts need no other settings."""


def _turned(turn: tuple[float, float, float, float], vector: Sequence[Any]) -> Vector:
    """A vector turned by a quaternion (x, y, z, w)."""
    (a, b, c, w), (x, y, z) = turn, vector
    p, q, r = b * z - c * y, c * x - a * z, a * y - b * x
    return (
        x + 2.0 * (w * p + b * r - c * q),
        y + 2.0 * (w * q + c * p - a * r),
        z + 2.0 * (w * r + a * q - b * p),
    )
