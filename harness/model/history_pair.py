"""Two histories brought onto one time grid, so that they can be subtracted."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from harness.model.history import Array, History


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
        return Pair(
            self.t_s[:count],
            self.theta_a_rad[:count],
            self.theta_b_rad[:count],
            self.slip_a_m[:count],
            self.slip_b_m[:count],
        )


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
    if finer.size == 0:
        return np.array([start])
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
