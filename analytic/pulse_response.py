"""One-sine and one-cosine pulses on the linearised rocking block: exact pieces between impacts, both ways of overturning.

A slender symmetric block (small α) in dimensionless form, x = θ/α, time in units of 1/p, amplitude in units of g α:
ẍ = x − s + A f(t), s = sgn x, ẋ⁺ = r ẋ⁻ at x = 0 (Zhang and Makris 2001). Positive f pushes towards positive x.

Which sine pulses of ω/p = 5 overturn a block that keeps 0.9 of its rate at an impact, and the minimum overturning spectrum:

>>> for lowest, highest, impacts in overturning_ranges(5.0, 0.9):
...     print(f"{lowest:.4f} to {highest:.4f} after {impacts} impacts")
3.0186 to 6.3181 after 1 impacts
7.1681 to inf after 0 impacts
>>> [round(float(a), 4) for a in minimum_overturning_spectrum([5.0], 0.9)]
[3.0186]
>>> pulse_response(2.5, 5.0, 0.9).overturned
0
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, Literal, final

import numpy as np
from numpy.typing import NDArray

from analytic.block import require

__all__ = ["PulseResponse", "minimum_overturning_spectrum", "overturning_ranges", "pulse_response"]

PulseKind = Literal["one_sine", "one_cosine"]
SAMPLES: Final = 96
"""Points per pulse at which a piece is looked at for its return to x = 0; the return itself is then found to rounding."""
REST_RATE: Final = 1e-10
"""|d(θ/α)/d(pt)| after an impact below which the block is held to be at rest until it is lifted again."""
PHASE: Final[dict[str, float]] = {"one_sine": 0.0, "one_cosine": 0.5 * math.pi}


@final
@dataclass(frozen=True)
class PulseResponse:
    """Outcome (0 stands, ±1 overturned to that side), impacts before overturning, largest |θ|/α of a block that stands."""

    overturned: int
    impacts: int
    peak_over_alpha: float


@dataclass(frozen=True)
class _Piece:
    """x = growth (e^τ − 1) + decay (e^−τ − 1) − forced (sin ψ − sin ψ₀), ψ = Ωt + φ: one side, from x = 0 at `start`.

    Written in differences, so that a short hop is not lost in rounding.
    """

    start: float
    side: int
    growth: float
    decay: float
    forced: float
    omega: float
    phase: float

    def x(self, t: float) -> float:
        """θ/α at t."""
        tau = t - self.start
        half = 0.5 * self.omega * tau
        oscillation = 2.0 * math.cos(self.omega * self.start + self.phase + half) * math.sin(half)
        return self.growth * math.expm1(tau) + self.decay * math.expm1(-tau) - self.forced * oscillation

    def rate(self, t: float) -> float:
        """d(θ/α)/d(pt) at t."""
        tau = t - self.start
        oscillation = self.forced * self.omega * math.cos(self.omega * t + self.phase)
        return self.growth * math.exp(tau) - self.decay * math.exp(-tau) - oscillation


def _piece(t: float, rate: float, side: int, amplitude: float, omega: float, phase: float) -> _Piece:
    """The piece that leaves x = 0 at t with the given rate."""
    forced = amplitude / (1.0 + omega**2)
    offset = forced * math.sin(omega * t + phase) - side
    slope = rate + forced * omega * math.cos(omega * t + phase)
    return _Piece(t, side, 0.5 * (offset + slope), 0.5 * (offset - slope), forced, omega, phase)


def _root(f: Callable[[float], float], low: float, high: float) -> float:
    """The zero of f between a positive value at low and a non-positive one at high, to rounding (bisection)."""
    while True:
        middle = 0.5 * (low + high)
        if middle in (low, high):
            return high
        low, high = (middle, high) if f(middle) > 0.0 else (low, middle)


def _uplift(t: float, end: float, amplitude: float, omega: float, phase: float) -> tuple[float, int] | None:
    """First instant from t on at which |A f| exceeds 1, with the side to which it lifts."""
    force = amplitude * math.sin(omega * t + phase)
    if abs(force) > 1.0:
        return t, int(math.copysign(1.0, force))
    if amplitude <= 1.0:
        return None
    first = math.asin(1.0 / amplitude)  # |sin| grows through 1/A at first + kπ
    turns = math.ceil((omega * t + phase - first) / math.pi - 1e-12)
    lift = (first + turns * math.pi - phase) / omega
    return (lift, 1 if turns % 2 == 0 else -1) if lift < end else None


def pulse_response(
    amplitude_over_g_alpha: float, omega_over_p: float, restitution: float, kind: PulseKind = "one_sine"
) -> PulseResponse:
    """Response to one full period of a sine or cosine; after it the outcome follows from the free motion's energy."""
    a, omega, r = amplitude_over_g_alpha, omega_over_p, restitution
    require(
        a >= 0.0 and omega > 0.0 and 0.0 <= r <= 1.0 and math.isfinite(a * omega) and kind in PHASE,
        "wanted amplitude ≥ 0, ω/p > 0, 0 ≤ restitution ≤ 1 and kind in {}; got {}, {}, {}, {!r}",
        sorted(PHASE),
        a,
        omega,
        r,
        kind,
    )
    phase, end = PHASE[kind], 2.0 * math.pi / omega
    step = end / SAMPLES
    t, rate, side, impacts, peak = 0.0, 0.0, 0, 0, 0.0
    while True:
        if side == 0:
            lift = _uplift(t, end, a, omega, phase)
            if lift is None:
                return PulseResponse(0, impacts, peak)
            (t, side), rate = lift, 0.0
        piece = _piece(t, rate, side, a, omega, phase)
        hop = abs(rate) / (2.0 + 2.0 * a) if rate else step / 8.0  # |ẍ| ≤ 1 + A: a return takes four times as long
        hit, highest = _return(piece, hop, step, end)
        peak = max(peak, highest)
        if hit is None:
            return _after_pulse(piece, end, r, impacts, peak)
        impacts += 1
        t, rate = hit, r * piece.rate(hit)
        side = -side if abs(rate) > REST_RATE else 0


def _return(piece: _Piece, hop: float, step: float, end: float) -> tuple[float | None, float]:
    """When the piece comes back to x = 0 (None: not before the pulse's end), and its largest |x| until then.

    `hop` is a first step shorter than any return.
    """
    s, t, peak, width = piece.side, piece.start, 0.0, min(hop, step)
    while t < end:
        u = min(t + width, end)
        x = s * piece.x(u)
        if x <= 0.0:
            return _root(lambda v: s * piece.x(v), t, u), peak
        peak, t, width = max(peak, x), u, min(step, 1.5 * width)
    return None, peak


def _after_pulse(piece: _Piece, end: float, r: float, impacts: int, peak: float) -> PulseResponse:
    """Free motion from the pulse's end: past the unstable manifold it overturns, else it may only at its first impacts."""
    s, x, rate = piece.side, piece.side * piece.x(end), piece.side * piece.rate(end)
    if x - 1.0 + rate > 0.0:
        return PulseResponse(s, impacts, math.inf)
    energy = rate * rate - (x - 1.0) ** 2  # its square of rate where x = 1; below 0 the block turns back before
    if rate > 0.0:
        peak = max(peak, 1.0 - math.sqrt(-energy))
    landing = r * r * (energy + 1.0)
    if landing > 1.0:
        return PulseResponse(-s, impacts + 1, math.inf)
    return PulseResponse(0, impacts, max(peak, 1.0 - math.sqrt(1.0 - landing)))


def overturning_ranges(
    omega_over_p: float,
    restitution: float,
    kind: PulseKind = "one_sine",
    *,
    highest: float = 20.0,
    resolution: float = 0.01,
) -> tuple[tuple[float, float, int], ...]:
    """Ranges of A/(gα) below `highest` that overturn: (from, to, impacts before overturning), ends to rounding.

    The number of impacts tells the modes apart: 1 rocks once and falls to the other side, 0 falls at once. Ranges
    narrower than `resolution` can be missed. A range still open at `highest` ends with inf.
    """
    require(
        highest > 1.0 and 0.0 < resolution < 1.0,
        "wanted highest > 1 and 0 < resolution < 1, got {!r} and {!r}",
        highest,
        resolution,
    )

    def label(a: float) -> int:
        response = pulse_response(a, omega_over_p, restitution, kind)
        return response.impacts if response.overturned else -1

    grid = np.arange(1.0, highest + resolution, resolution)
    labels = [label(float(a)) for a in grid]
    ranges: list[tuple[float, float, int]] = []
    opened = float(grid[0])
    for low, high, before, after in zip(grid[:-1], grid[1:], labels[:-1], labels[1:], strict=True):
        if before == after:
            continue
        edge = _root(lambda a, low_label=before: 1.0 if label(a) == low_label else -1.0, float(low), float(high))  # type: ignore[misc]
        if before >= 0:
            ranges.append((opened, edge, before))
        opened = edge
    return (*ranges, *([(opened, math.inf, labels[-1])] if labels[-1] >= 0 else []))


def minimum_overturning_spectrum(
    omega_over_p: Sequence[float] | NDArray[np.float64],
    restitution: float,
    kind: PulseKind = "one_sine",
    *,
    highest: float = 20.0,
    resolution: float = 0.05,
) -> NDArray[np.float64]:
    """Least A/(gα) that overturns, for each ω/p (nan: none below `highest`)."""
    least = [
        overturning_ranges(float(w), restitution, kind, highest=highest, resolution=resolution) for w in omega_over_p
    ]
    return np.array([ranges[0][0] if ranges else math.nan for ranges in least])
