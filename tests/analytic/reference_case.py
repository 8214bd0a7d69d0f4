"""The problem, and nothing of its solution: what the reference solver is given, in plain numbers; and the cases on which the
kernel is held to it: the paper's, and reproducible random ones.

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
PAPER_RATIO = 0.875
AMPLITUDES_G = (0.334, 0.429)
FREQUENCIES_HZ = (1.5, 2.0, 3.0, 4.5, 6.0)
FORMS: dict[str, dict[str, object]] = {
    "consistent": {},
    "paper": {"ratio": PAPER_RATIO, "pedestal_at_impact": "unchanged", "normal": "static"},
    "ratio with momentum": {"ratio": PAPER_RATIO},
    "momentum with unchanged pedestal": {"pedestal_at_impact": "unchanged"},
    "static normal": {"normal": "static"},
}


@dataclass(frozen=True)
class Motion:
    """A floor's acceleration as smooth segments; `recipe` names it for solvers that build it their own way."""

    segments: tuple[Segment, ...]
    recipe: tuple[str, tuple[object, ...]] = ("custom", ())


def rest() -> Motion:
    """No motion, for ever."""
    return Motion(((0.0, math.inf, lambda t: 0.0),), ("rest", ()))


def harmonic(amplitude: float, frequency: float, phase: float = 0.0) -> Motion:
    """a = A sin(2πft + phase) from t = 0 (m/s², Hz, rad)."""
    omega = 2.0 * math.pi * frequency
    segment = (0.0, math.inf, lambda t: amplitude * math.sin(omega * t + phase))
    return Motion((segment,), ("harmonic", (amplitude, frequency, phase)))


def full_period(amplitude: float, duration: float, kind: str = "one_sine") -> Motion:
    """One full period of a sine or a cosine (m/s², s)."""
    omega, phase = 2.0 * math.pi / duration, 0.0 if kind == "one_sine" else 0.5 * math.pi
    sine = (0.0, duration, lambda t: amplitude * math.sin(omega * t + phase))
    return Motion((sine, (duration, math.inf, lambda t: 0.0)), (kind, (amplitude, duration)))


def rectangle(amplitude: float, duration: float) -> Motion:
    """A constant acceleration that stops (m/s², s)."""
    segments = ((0.0, duration, lambda t: amplitude), (duration, math.inf, lambda t: 0.0))
    return Motion(segments, ("rectangular", (amplitude, duration)))


def record(times: Sequence[float], values: Sequence[float]) -> Motion:
    """Linear between samples, zero after the last (s, m/s²); the first time must be 0."""

    def line(t0: float, a0: float, slope: float) -> Callable[[float], float]:
        return lambda t: a0 + slope * (t - t0)

    pieces: list[Segment] = []
    for (t0, a0), (t1, a1) in itertools.pairwise(zip(times, values, strict=True)):
        pieces.append((t0, t1, line(t0, a0, (a1 - a0) / (t1 - t0))))
    return Motion((*pieces, (times[-1], math.inf, lambda t: 0.0)), ("record", (tuple(times), tuple(values))))


PEDESTAL_SIZE_M = (0.6, 0.2)


@dataclass(frozen=True)
class Case:
    """One two-block problem in SI units; `pedestal_kg` None means that the statue stands on the floor and never slides.

    `ratio` None is the ratio from angular momentum; a number prescribes it. `mu_impact` acts as an impact breaks a stuck pedestal
    loose (None: `mu_kinetic`). `wall` is its side, its distance from the statue's base and the height of the statue's flat top,
    as wide as that base. `profile` are the base vertices (x, z) of a statue with more than two of them, or None; `tilt` and
    `gaps` belong to one facet of such a base: its rotation, and how much further the statue turns to the next one on the left
    and right.
    """

    m2: float
    h: float
    b_left: float
    b_right: float
    inertia: float
    pedestal_kg: float | None = None
    mu_static: float = 0.0
    mu_kinetic: float = 0.0
    mu_impact: float | None = None
    normal: str = "dynamic"
    ratio: float | None = None
    pedestal_at_impact: str = "momentum"
    accel_x: Motion = field(default_factory=rest)
    accel_z: Motion = field(default_factory=rest)
    theta0: float = 0.0
    rate0: float = 0.0
    gravity: float = GRAVITY
    overturn: float = 1.5
    wall: tuple[int, float, float] | None = None
    profile: tuple[tuple[float, float], ...] | None = None
    tilt: float = 0.0
    gaps: tuple[float, float] = (math.inf, math.inf)

    def gap(self, side: int) -> float:
        """Rotation from this facet to the next one on that side, infinite at the outer vertices."""
        return self.gaps[1] if side > 0 else self.gaps[0]

    def before_wall(self, side: int, theta: float, slip: float) -> float:
        """Distance of a statue of two corners, on the one of that side (0: both), and of its pedestal to the wall."""
        if self.wall is None:
            return math.inf
        to, distance, top = self.wall
        wide = self.b_left + self.b_right
        pivot = self.b_right if side > 0 else -self.b_left
        place = (self.b_right if to > 0 else self.b_left) + distance
        corners = [(x, z) for x in (-self.b_left, self.b_right) for z in (0.0, top)]
        reach = max(to * (pivot + (x - pivot) * math.cos(theta) + z * math.sin(theta)) for x, z in corners)
        if self.pedestal_kg is not None:
            middle = self.b_right - 0.5 * wide
            reach = max(reach, to * middle + 0.5 * PEDESTAL_SIZE_M[0])
        return place - reach - to * slip

    def facets(self) -> list[Case]:
        """The statue standing on each of its facets: two corners, which need not lie on both sides of its centroid."""
        if self.profile is None:
            return [self]
        tilts = [math.atan2(b[1] - a[1], b[0] - a[0]) for a, b in itertools.pairwise(self.profile)]
        found = []
        for j, ((x0, z0), (x1, z1)) in enumerate(itertools.pairwise(self.profile)):
            cos, sin = math.cos(tilts[j]), math.sin(tilts[j])
            foot = -x0 * cos + (self.h - z0) * sin
            left = tilts[j] - tilts[j - 1] if j > 0 else math.inf
            right = tilts[j + 1] - tilts[j] if j + 1 < len(tilts) else math.inf
            found.append(
                replace(
                    self,
                    h=(self.h - z0) * cos + x0 * sin,
                    b_left=foot,
                    b_right=math.hypot(x1 - x0, z1 - z0) - foot,
                    tilt=tilts[j],
                    gaps=(left, right),
                )
            )
        return found

    def start(self) -> int:
        """The facet on which the run starts: the last one that the statue has rolled over."""
        return max(sum(each.tilt <= self.theta0 for each in self.facets()) - 1, 0)

    def windows(self, end: float) -> list[tuple[float, float, Callable[[float], float], Callable[[float], float]]]:
        """Intervals on which both motions are smooth, with their functions, up to `end`."""
        edges = sorted(
            {t for pieces in (self.accel_x.segments, self.accel_z.segments) for a, b, _ in pieces for t in (a, b)}
        )
        edges = [t for t in edges if t < end] + [end]
        found = []
        for t0, t1 in itertools.pairwise(edges):
            middle = 0.5 * (t0 + t1)
            functions = [
                next(f for a, b, f in pieces if a <= middle < b)
                for pieces in (self.accel_x.segments, self.accel_z.segments)
            ]
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


def paper_case(amplitude_g: float, frequency_hz: float, *, pedestal: bool, form: str, mu_static: float = 0.20) -> Case:
    """One of the paper's cases with a kinetic friction of 0.15."""
    return Case(
        **PAESTUM,
        pedestal_kg=PAESTUM_PEDESTAL_KG if pedestal else None,
        mu_static=mu_static,
        mu_kinetic=0.15,
        accel_x=harmonic(amplitude_g * GRAVITY, frequency_hz),
        **FORMS[form],  # type: ignore[arg-type]
    )


def random_case(seed: int) -> Case:
    """A statue of any size, asymmetry, pedestal, friction and form under harmonic, pulse or record, vertical motion too."""
    rng = np.random.default_rng(seed)
    h = rng.uniform(0.3, 1.2)
    b_left, b_right = h * rng.uniform(0.06, 0.6, 2)
    m2 = rng.uniform(50.0, 900.0)
    inertia = m2 * (h * h + (0.5 * (b_left + b_right)) ** 2) / 3.0 * rng.uniform(0.6, 1.3)
    mu_kinetic = rng.uniform(0.05, 0.5)
    mu_static = mu_kinetic * rng.uniform(1.0, 1.5)
    pedestal_kg = None if rng.random() < 0.25 else m2 * 10.0 ** rng.uniform(-1.5, 1.0)
    motions = [_random_motion(rng, scale) for scale in (1.0, float(rng.choice([0.0, 0.4, 1.2])))]
    return Case(
        m2,
        h,
        b_left,
        b_right,
        inertia,
        pedestal_kg,
        mu_static,
        mu_kinetic,
        normal=str(rng.choice(["dynamic", "static"])),
        ratio=None if rng.random() < 0.6 else rng.uniform(0.6, 0.95),
        pedestal_at_impact=str(rng.choice(["momentum", "unchanged"], p=[0.7, 0.3])),
        accel_x=motions[0],
        accel_z=motions[1],
        theta0=0.0 if rng.random() < 0.6 else rng.uniform(-0.8 * b_left / h, 0.8 * b_right / h),
    )


def _random_motion(rng: np.random.Generator, scale: float) -> Motion:
    amplitude = scale * GRAVITY * rng.uniform(0.1, 0.9)
    kind = rng.integers(3)
    if amplitude == 0.0:
        return rest()
    if kind == 0:
        return harmonic(amplitude, rng.uniform(0.7, 6.0), rng.uniform(0.0, 6.0))
    if kind == 1:
        return full_period(amplitude, rng.uniform(0.2, 1.0))
    times = np.arange(0.0, 1.51, 0.02)
    return record(times.tolist(), (amplitude * 0.6 * rng.standard_normal(times.size)).tolist())
