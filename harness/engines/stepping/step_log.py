"""What the loop saw: the samples of a run as it goes on."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from struct import Struct

import numpy as np
from numpy.typing import NDArray

from harness.engines.stepping.interventions import Ledger
from harness.engines.stepping.rows import Row

Array = NDArray[np.float64]


@dataclass(eq=False)
class StepLog:
    """What the loop saw: times, and per time one row (place, quaternion, velocity, angular velocity of statue and pedestal).

    `t_s` are times of the places, `kick_s` of the velocities, at most half a step before; `at_rest` counts the samples that no
    step made, as nothing could move.
    """

    width: int
    t_s: list[float] = field(default_factory=list)
    kick_s: list[float] = field(default_factory=list)
    flat: array[float] = field(default_factory=lambda: array("d"))
    ledger: Ledger = field(default_factory=Ledger)
    rested: bool = False
    at_rest: int = 0

    @property
    def rows(self) -> Array:
        """The rows, shape (n, 13) or (n, 26)."""
        return np.frombuffer(self.flat, dtype=np.float64).reshape(-1, self.width)

    @cached_property
    def pack(self) -> Callable[..., bytes]:
        """The bytes of a row's numbers: an array takes these five times as fast as the numbers one by one."""
        return Struct(f"{self.width}d").pack

    def keep(self, t_s: float, kick_s: float, row: Row) -> None:
        """Append a sample."""
        self.t_s.append(t_s)
        self.kick_s.append(kick_s)
        self.flat.frombytes(self.pack(*row))

    def whole_steps(self, first: int, count: int, step_s: float) -> None:
        """The times of so many whole steps from number `first` on, whose rows stand here already."""
        numbers = range(first, first + count)
        self.t_s.extend([number * step_s for number in numbers])
        self.kick_s.extend([(number - 0.5) * step_s for number in numbers])

    def row(self, index: int) -> Row:
        """A row, counted from the last (-1) backwards."""
        # Rows lie one after the other: an array of them would be copied as it grows.
        end = len(self.flat) + (index + 1) * self.width
        return tuple(self.flat[end - self.width : end])

    @property
    def rate_before(self) -> Sequence[float]:
        """The statue's angular velocity in the row before the last."""
        begin = 10 - 2 * self.width
        return self.flat[begin : begin + 3]

    @property
    def last(self) -> Row:
        """The last row."""
        return self.row(-1)
