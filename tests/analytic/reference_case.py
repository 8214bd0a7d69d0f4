"""The problem, and nothing of its solution: what the two reference solvers are given, in plain numbers.

Motions are lists of smooth segments, so that the value at a break is one-sided without any convention inside a solver.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

Segment = tuple[float, float, Callable[[float], float]]

PAESTUM = {"m2": 707.0, "h": 0.774, "b_left": 0.3585, "b_right": 0.0682, "inertia": 152.4}
PAESTUM_PEDESTAL_KG = 250.0
GRAVITY = 9.81


def rest() -> tuple[Segment, ...]:
    """No motion, for ever."""
    return ((0.0, math.inf, lambda t: 0.0),)


def harmonic(amplitude: float, frequency: float, phase: float = 0.0) -> tuple[Segment, ...]:
    """a = A sin(2πft + phase) from t = 0 (m/s², Hz, rad)."""
    omega = 2.0 * math.pi * frequency
    return ((0.0, math.inf, lambda t: amplitude * math.sin(omega * t + phase)),)


def one_sine(amplitude: float, duration: float, cycles: float = 1.0) -> tuple[Segment, ...]:
    """A sine that stops after `cycles` cycles of total length `duration` (m/s², s)."""
    omega = 2.0 * math.pi * cycles / duration
    return ((0.0, duration, lambda t: amplitude * math.sin(omega * t)), (duration, math.inf, lambda t: 0.0))


def rectangle(amplitude: float, duration: float) -> tuple[Segment, ...]:
    """A constant acceleration that stops (m/s², s)."""
    return ((0.0, duration, lambda t: amplitude), (duration, math.inf, lambda t: 0.0))


def record(times: Sequence[float], values: Sequence[float]) -> tuple[Segment, ...]:
    """Linear between samples, zero after the last (s, m/s²); the first time must be 0."""

    def line(t0: float, a0: float, slope: float) -> Callable[[float], float]:
        return lambda t: a0 + slope * (t - t0)

    pieces: list[Segment] = []
    for t0, t1, a0, a1 in zip(times[:-1], times[1:], values[:-1], values[1:], strict=True):
        pieces.append((t0, t1, line(t0, a0, (a1 - a0) / (t1 - t0))))
    return (*pieces, (times[-1], math.inf, lambda t: 0.0))


@dataclass(frozen=True)
class Case:
    """One two-block problem in SI units; `pedestal_kg` None means that the statue stands on the floor and never slides.

    `ratio` None is the ratio from angular momentum; a number prescribes it.
    """

    m2: float
    h: float
    b_left: float
    b_right: float
    inertia: float
    pedestal_kg: float | None = None
    mu_static: float = 0.0
    mu_kinetic: float = 0.0
    normal: str = "dynamic"
    ratio: float | None = None
    pedestal_at_impact: str = "momentum"
    accel_x: tuple[Segment, ...] = field(default_factory=rest)
    accel_z: tuple[Segment, ...] = field(default_factory=rest)
    theta0: float = 0.0
    rate0: float = 0.0
    gravity: float = GRAVITY
    overturn: float = 1.5

    def paper_form(self, ratio: float) -> Case:
        """The same problem in the paper's form."""
        return replace(self, normal="static", ratio=ratio, pedestal_at_impact="unchanged")

    def windows(self, end: float) -> list[tuple[float, float, Callable[[float], float], Callable[[float], float]]]:
        """Intervals on which both motions are smooth, with their functions, up to `end`."""
        edges = sorted({t for pieces in (self.accel_x, self.accel_z) for a, b, _ in pieces for t in (a, b)})
        edges = [t for t in edges if t < end] + [end]
        found = []
        for t0, t1 in itertools.pairwise(edges):
            middle = 0.5 * (t0 + t1)
            functions = [next(f for a, b, f in pieces if a <= middle < b) for pieces in (self.accel_x, self.accel_z)]
            found.append((t0, t1, functions[0], functions[1]))
        return found


@dataclass(frozen=True)
class Path:
    """What a reference solver returns: samples (t, θ, θ̇, u, u̇), events (time, name), how it ended, ties met at jumps."""

    samples: NDArray[np.float64]
    events: tuple[tuple[float, str], ...]
    outcome: str
    ties: int

    def times(self, name: str) -> list[float]:
        """Times of the events of one name."""
        return [t for t, kind in self.events if kind == name]
