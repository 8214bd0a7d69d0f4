"""What a model says happened: one rotation history on one time grid, and one outcome."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from enum import StrEnum
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from harness.model.errors import require, translated
from harness.model.finding import Axes, Shown, new_axes

Array = NDArray[np.float64]


# Two histories brought onto one time grid, so that they can be subtracted.


@dataclass(frozen=True, eq=False)
class Pair:
    """Rotations and slips of two histories at common times, all of shape (n,), n ≥ 1.

    `weights_s` are the trapezoid's weights.
    """

    t_s: Array
    theta_a_rad: Array
    theta_b_rad: Array
    slip_a_m: Array
    slip_b_m: Array

    @cached_property
    def difference_rad(self) -> Array:
        """θ_a − θ_b."""
        return self.theta_a_rad - self.theta_b_rad

    @cached_property
    def weights_s(self) -> Array:
        """Trapezoid weights; a single instant has the weight 1."""
        if self.t_s.size == 1:
            return np.ones(1)
        half = 0.5 * np.diff(self.t_s)
        weights = np.zeros_like(self.t_s)
        weights[:-1] += half
        weights[1:] += half
        return weights

    def integral(self, x: Array, y: Array) -> float:
        """∫ x y dt over the window."""
        # Not a dot product: BLAS starts threads at this length, which costs more than the sum and can change its order.
        return float(np.einsum("i,i,i->", self.weights_s, x, y))

    @property
    def start_s(self) -> float:
        """First common instant."""
        return float(self.t_s[0])

    @property
    def end_s(self) -> float:
        """Last common instant."""
        return float(self.t_s[-1])

    def until(self, end_s: float) -> Pair:
        """The part of the window up to `end_s`; at least its first sample."""
        count = max(int(np.searchsorted(self.t_s, end_s, side="right")), 1)
        if count == self.t_s.size:
            return self
        return Pair(*(getattr(self, each.name)[:count] for each in fields(self)))


def pair(a: History, b: History, *, hold_a: bool = False, hold_b: bool = False) -> Pair:
    """Bring two histories onto common times: those of the finer one over the overlap, the other by cubic Hermite.

    `hold_a`, `hold_b`: that history ended at rest, so its last value holds as long as the other goes on.
    Raises `ValueError` when the two do not overlap in time.
    """
    start = max(float(a.t_s[0]), float(b.t_s[0]))
    end = min(np.inf if hold_a else a.duration_s, np.inf if hold_b else b.duration_s)
    end = min(end, max(a.duration_s, b.duration_s))
    if end < start:
        spans = " and ".join(f"{h.t_s[0]:.6g}…{h.t_s[-1]:.6g} s" for h in (a, b))
        raise ValueError(f"{spans}, which do not overlap")
    t_s = _times(a.t_s, b.t_s, start, end)
    (theta_a, slip_a), (theta_b, slip_b) = _sampled(a, t_s), _sampled(b, t_s)
    return Pair(t_s, theta_a, theta_b, slip_a, slip_b)


def _times(a_s: Array, b_s: Array, start: float, end: float) -> Array:
    inside = [t[np.searchsorted(t, start) : np.searchsorted(t, end, side="right")] for t in (a_s, b_s)]
    finer = max(inside, key=len)
    # The history that begins last has a sample at the start.
    if finer[-1] < end:
        finer = np.append(finer, end)
    return finer if finer[0] == start else np.insert(finer, 0, start)


def _sampled(history: History, t_s: Array) -> tuple[Array, Array]:
    """Rotation and slip at `t_s`; a history that already has these times is passed through untouched."""
    count = t_s.size
    if history.t_s.size >= count and np.array_equal(history.t_s[:count], t_s):
        return history.theta_rad[:count], history.slip_m[:count]
    return history.at(t_s), history.slip_at(t_s)


def first_beyond_s(t_s: Array, size: Array, limit: float) -> float | None:
    """The first time at which `size` exceeds `limit` (linear between samples), None when it never does."""
    beyond = size > limit
    k = int(np.argmax(beyond))
    if not beyond[k]:
        return None
    if k == 0:
        return float(t_s[0])
    share = (limit - size[k - 1]) / (size[k] - size[k - 1])
    return float(t_s[k - 1] + share * (t_s[k] - t_s[k - 1]))


ROWS_AT_ONCE: Final = 100_000
"""Lines of a history that are held as text while it is written: 100 bytes each, and as much for their numbers."""
COLUMNS: Final = ("t_s", "theta_rad", "theta_rate_rad_s", "slip_m", "slip_rate_m_s")


class Outcome(StrEnum):
    """How a run ended; the value stands in every record, its words in the catalogue of messages."""

    STANDS = "stands"
    OVERTURNED_LEFT = "overturned_left"
    OVERTURNED_RIGHT = "overturned_right"
    OVERTURNED_FRONT = "overturned_front"
    OVERTURNED_BACK = "overturned_back"
    TOUCHES_WALL = "touches_wall"
    LEFT_PEDESTAL = "left_pedestal"
    LIFT_OFF = "lift_off"
    FRICTION_PARADOX = "friction_paradox"
    UNDECIDED = "undecided"
    DIVERGED = "diverged"
    CRASHED = "crashed"
    TIMED_OUT = "timed_out"
    UNAVAILABLE = "unavailable"

    @property
    def overturned(self) -> bool:
        """Whether the statue fell, whichever way."""
        return self.value.startswith("overturned")

    @property
    def fell(self) -> bool | None:
        """Whether the statue fell, None where the outcome does not say: neither counts as standing nor as fallen."""
        return True if self.overturned else (False if self is Outcome.STANDS else None)

    def same_as(self, other: Outcome) -> bool:
        """Whether both say the same of the statue; two that overturn do, whichever way."""
        return self is other or (self.overturned and other.overturned)

    @property
    def failed(self) -> bool:
        """Whether the run itself failed, so that nothing is known of the statue."""
        return self in _FAILURES


_FAILURES: Final = frozenset({Outcome.DIVERGED, Outcome.CRASHED, Outcome.TIMED_OUT, Outcome.UNAVAILABLE})


def _frozen(values: ArrayLike) -> Array:
    array = np.array(values, dtype=np.float64, copy=True)
    array.setflags(write=False)
    return array


def numbers(values: ArrayLike, caller: str, name: str) -> Array:
    """The values as an array. Raises `InputError` for what holds others than numbers."""
    with translated((TypeError, ValueError), caller, "an array of numbers", key=name):
        return np.asarray(values, dtype=np.float64)


def history_file(engine: str) -> str:
    """Name of an engine's history in a result folder; a colon is no character of a file's name on every system."""
    return f"history_{engine.replace(':', '-')}.csv"


@dataclass(frozen=True, eq=False, repr=False)
class History(Shown):
    """One run on one time grid, in the table's frame; all arrays float64, shape (n,), read-only.

    `theta_rad` is the rocking rotation (clockwise positive: θ > 0 leans to the right), `slip_m` the displacement of the
    pedestal relative to the floor, of one that tips of the edge on which it stands. `extra` holds further named columns (3D:
    `roll_rad`, `yaw_rad`, ...). `resolution_rad` and `resolution_m` are how far the digits of the file it was read from leave
    rotation and slip open.

    Raises `ValueError` when lengths differ, a value is not finite, or times do not increase.
    """

    t_s: Array
    theta_rad: Array
    theta_rate_rad_s: Array
    slip_m: Array
    slip_rate_m_s: Array
    extra: Mapping[str, Array] = field(default_factory=dict)
    resolution_rad: float = 0.0
    resolution_m: float = 0.0

    def __post_init__(self) -> None:
        for name in COLUMNS:
            object.__setattr__(self, name, _frozen(getattr(self, name)))
        extra = MappingProxyType({name: _frozen(values) for name, values in self.extra.items()})
        object.__setattr__(self, "extra", extra)
        size = self.t_s.shape
        if len(size) != 1 or size[0] == 0:
            raise ValueError(f"a history wants at least one sample in one dimension, got shape {size}")
        for name, values in self.columns().items():
            if values.shape != size:
                raise ValueError(f"column {name} has shape {values.shape}, t_s has {size}")
            if not np.isfinite(values).all():
                raise ValueError(f"column {name} is not finite at sample {np.flatnonzero(~np.isfinite(values))[0]}")
        if (self.t_s[1:] <= self.t_s[:-1]).any():
            raise ValueError("times of a history must increase strictly")

    @classmethod
    def from_arrays(
        cls,
        t_s: ArrayLike,
        theta_rad: ArrayLike,
        *,
        theta_rate_rad_s: ArrayLike | None = None,
        slip_m: ArrayLike | None = None,
        slip_rate_m_s: ArrayLike | None = None,
    ) -> History:
        """A history of one's own arrays: rates that are not given are differences of second order, a slip none at all.

        >>> t_s = np.arange(0.0, 5.0, 0.01)
        >>> mine = harness.History.from_arrays(t_s, 0.05 * np.exp(-t_s) * np.cos(6.0 * t_s))

        Raises `InputError` for fewer than two samples, lengths that differ, numbers that are not finite, times that do not rise.
        """
        times, theta = numbers(t_s, "from_arrays", "t_s"), numbers(theta_rad, "from_arrays", "theta_rad")
        require(
            times.ndim == 1 and times.size >= 2,
            "from_arrays",
            "at least two times in one dimension",
            f"shape {times.shape}",
            key="t_s",
        )
        require(
            (np.diff(times) > 0.0).all(),
            "from_arrays",
            "times that rise",
            "some that do not, or are no numbers",
            key="t_s",
        )
        slip = np.zeros(times.shape) if slip_m is None else numbers(slip_m, "from_arrays", "slip_m")
        given = {"theta_rate_rad_s": (theta_rate_rad_s, theta), "slip_rate_m_s": (slip_rate_m_s, slip)}
        for name, values in (("theta_rad", theta), ("slip_m", slip)):
            require(
                values.shape == times.shape,
                "from_arrays",
                f"{times.size} numbers, one for each time",
                f"shape {values.shape}",
                key=name,
            )
        rates = {
            name: np.gradient(of, times, edge_order=2 if times.size > 2 else 1)
            if own is None
            else numbers(own, "from_arrays", name)
            for name, (own, of) in given.items()
        }
        with translated(ValueError, "from_arrays", "finite numbers, one for each time"):
            return cls(times, theta, rates["theta_rate_rad_s"], slip, rates["slip_rate_m_s"])

    def __reduce__(self) -> tuple[Any, ...]:
        # A read-only view of a mapping cannot be pickled; workers send histories home.
        own = (getattr(self, name) for name in COLUMNS)
        return History, (*own, dict(self.extra), self.resolution_rad, self.resolution_m)

    def columns(self) -> dict[str, Array]:
        """All columns by name, the contract's first, in the order of the file."""
        return {name: getattr(self, name) for name in COLUMNS} | dict(self.extra)

    def facts(self) -> dict[str, str]:
        """Samples, span and largest rotation."""
        largest = float(self.theta_rad[np.argmax(np.abs(self.theta_rad))])
        span = f"{self.t_s[0]:.4g} to {self.duration_s:.4g} s"
        return {"samples": str(self.t_s.size), "from": span, "largest rotation": f"{largest:+.4g} rad"}

    def plot(self, ax: Axes | None = None, **style: Any) -> Axes:
        """Draw the rotation over time; `style` goes to matplotlib's `plot`."""
        ax = new_axes(ax)
        ax.plot(self.t_s, self.theta_rad, **style)
        ax.set(xlabel="time [s]", ylabel="rotation θ [rad]")
        return ax

    def until(self, end_s: float) -> History:
        """The history up to `end_s`; at least its first sample."""
        count = max(int(np.searchsorted(self.t_s, end_s, side="right")), 1)
        columns: dict[str, Any] = {name: getattr(self, name)[:count] for name in COLUMNS}
        return replace(self, **columns, extra={name: values[:count] for name, values in self.extra.items()})

    @property
    def duration_s(self) -> float:
        """Time of the last sample."""
        return float(self.t_s[-1])

    def at(self, t_s: ArrayLike) -> Array:
        """Rotation in rad at the given times, by cubic Hermite between samples (held beyond the ends)."""
        return hermites(np.asarray(t_s, dtype=np.float64), self.t_s, ((self.theta_rad, self.theta_rate_rad_s),))[0]

    def slip_at(self, t_s: ArrayLike) -> Array:
        """Slip in m at the given times, in the same way."""
        return hermites(np.asarray(t_s, dtype=np.float64), self.t_s, ((self.slip_m, self.slip_rate_m_s),))[0]

    def write_csv(self, path: Path) -> None:
        """Write the history with 17 significant digits, so that it reads back bit for bit."""
        columns = self.columns()
        row = ",".join(["%.17g"] * len(columns)) + "\n"
        rows = np.column_stack(list(columns.values()))
        with path.open("w", encoding="utf-8") as file:
            file.write(",".join(columns) + "\n")
            for first in range(0, len(rows), ROWS_AT_ONCE):
                file.write("".join(row % tuple(each) for each in rows[first : first + ROWS_AT_ONCE].tolist()))

    @classmethod
    def read_csv(cls, path: Path) -> History:
        """A history as `write_csv` writes it, bit for bit: without the looks of `harness.read_history` at another's file.

        Raises `ValueError` for anything else.
        """
        with path.open(encoding="utf-8") as file:
            names = file.readline().strip().split(",")
            columns = dict(zip(names, np.loadtxt(file, delimiter=",", ndmin=2).T, strict=True))
        if names[: len(COLUMNS)] != list(COLUMNS):
            raise ValueError(f"columns {', '.join(COLUMNS)} first, got {', '.join(names)}")
        return cls(**{name: columns.pop(name) for name in COLUMNS}, extra=columns)


def hermites(t_s: Array, knots_s: Array, pairs: Sequence[tuple[Array, Array]]) -> list[Array]:
    """Cubic Hermite interpolation of several values with their slopes at knots (increasing), whose places are looked up once;
    held beyond the ends.
    """
    if knots_s.size == 1:
        return [np.full(t_s.shape, values[0]) for values, _ in pairs]
    clipped = np.minimum(np.maximum(t_s, knots_s[0]), knots_s[-1])
    i = np.minimum(np.maximum(np.searchsorted(knots_s, clipped, side="right") - 1, 0), knots_s.size - 2)
    following, begin = i + 1, knots_s[i]
    step = knots_s[following] - begin
    x = (clipped - begin) / step
    pieces: list[Array] = []
    for values, rates in pairs:
        y0, y1 = values[i], values[following]
        d0, d1 = rates[i] * step, rates[following] * step
        pieces.append(y0 + x * (d0 + x * (3.0 * (y1 - y0) - 2.0 * d0 - d1 + x * (2.0 * (y0 - y1) + d0 + d1))))
    return pieces


def output_grid(duration_s: float, dt_s: float) -> Array:
    """The contract's times 0, dt, 2 dt, ... and the last instant, shape (n,)."""
    count = int(np.floor(duration_s / dt_s * (1.0 + 1e-12)))
    grid = np.arange(count + 1) * dt_s
    # A last instant within rounding of a grid point is that grid point.
    if duration_s - grid[-1] > 1e-9 * dt_s:
        grid = np.append(grid, duration_s)
    return _frozen(grid)
