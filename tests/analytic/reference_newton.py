"""Reference B: the Newton-Euler model integrated by Gauss-Legendre collocation of order 8.

Events are found by solving for the length of the step that ends on them, not on a dense output.
"""

import math
from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

from tests.analytic.reference_case import Case, Path
from tests.analytic.reference_newton_bodies import Array, Bodies

STAGES = 4
STEP_S = 2e-3
REST_RATE = 1e-10
SWEEPS = 40


def _tableau(stages: int) -> tuple[Array, Array, Array]:
    """Nodes, weights and matrix of Gauss-Legendre collocation on [0, 1]."""
    nodes, weights = np.polynomial.legendre.leggauss(stages)
    c = 0.5 * (nodes + 1.0)
    powers = np.arange(1, stages + 1)
    vandermonde = c[:, None] ** (powers - 1)
    matrix = (c[:, None] ** powers / powers) @ np.linalg.inv(vandermonde)
    return c, 0.5 * weights, matrix


NODES, WEIGHTS, MATRIX = _tableau(STAGES)


class Collocation:
    """One mode on one smooth window: steps of any length, and the length that ends on an event."""

    def __init__(
        self, bodies: Bodies, mode: tuple[int, int], fx: Callable[[float], float], fz: Callable[[float], float]
    ):
        self.bodies, self.mode, self.fx, self.fz = bodies, mode, fx, fz

    def rates(self, t: float, y: Array) -> Array:
        r = self.bodies.reactions(self.mode, y[0], y[1], self.fx(t), self.fz(t))
        side, slide = self.mode
        turning = (y[1], r.theta_dd) if side else (0.0, 0.0)
        sliding = (y[3], r.u_dd) if slide else (0.0, 0.0)
        return np.array([*turning, *sliding])

    def step(self, t: float, y: Array, length: float) -> Array:
        slopes = np.tile(self.rates(t, y), (STAGES, 1))
        change = math.inf
        for _ in range(SWEEPS):
            stages = y + length * (MATRIX @ slopes)
            fresh = np.array([self.rates(t + c * length, s) for c, s in zip(NODES, stages, strict=True)])
            smaller, change = change, float(np.max(np.abs(fresh - slopes)))
            slopes = fresh
            if change < 1e-15 * (1.0 + float(np.max(np.abs(slopes)))) or (change < 1e-11 and change >= smaller):
                return y + length * (WEIGHTS @ slopes)
        raise AssertionError(f"collocation does not converge at t = {t}")

    def margins(self, t: float, y: Array) -> dict[str, float]:
        return self.bodies.margins(self.mode, y, self.fx(t), self.fz(t))

    def until(self, t: float, y: Array, length: float, live: set[str]) -> tuple[float, Array, str]:
        """A step of `length`, or the shorter one that ends on the first live margin to vanish (its name, else "")."""
        y_end = self.step(t, y, length)
        after = self.margins(t + length, y_end)
        best = (length, "")
        for name in sorted(live):
            if after.get(name, 1.0) <= 0.0:

                def g(part: float, name: str = name) -> float:
                    return self.margins(t + part, self.step(t, y, part) if part else y).get(name, 1.0)

                part = brentq(g, 0.0, length, xtol=1e-15, rtol=8.9e-16) if g(0.0) > 0.0 else 0.0
                best = min(best, (part, name))
        if best[1]:
            return best[0], self.step(t, y, best[0]) if best[0] else y, best[1]
        live |= {name for name, value in after.items() if value > 0.0 and (name != "balance" or value > 1e-9)}
        if self.mode[0] and after["impact"] < -1e-9:
            raise AssertionError(f"penetration at t = {t + length}")
        return length, y_end, ""


def solve(case: Case, end: float, grid: float, *, step: float = STEP_S) -> Path:
    """Integrate one case to `end` by steps of at most `step`, sampled every `grid` seconds (and at its end)."""
    facets = [Bodies(facet) for facet in case.facets()]
    at = case.start()
    y = np.array([case.theta0 - facets[at].case.tilt, case.rate0, 0.0, 0.0])
    samples: list[tuple[float, ...]] = [(0.0, case.theta0, *y[1:])]
    events: list[tuple[float, str]] = []
    ties = 0

    def keep(t: float) -> None:
        samples.append((t, y[0] + facets[at].case.tilt, y[1], y[2], y[3]))

    def finish(t: float, outcome: str) -> Path:
        if samples[-1][0] < t - 1e-9:
            keep(t)
        return Path(np.array(samples), tuple(events), outcome, ties)

    for t0, t1, fx, fz in case.windows(end):
        t, name, mode = t0, "window", (0, 0)
        while True:
            if name:
                if name == "roll":  # the corner that it stands on is the next facet's other one
                    at, mode, name = at + mode[0], (-mode[0], mode[1]), "impact"
                mode, y, count, ending = _enter(facets[at], mode, y, fx(t), fz(t), name)
                ties += count > 1
                if count == 0:
                    return finish(t, ending)
                piece = Collocation(facets[at], mode, fx, fz)
                live = {key for key, value in piece.margins(t, y).items() if value > 0.0} - ({name} & {"balance"})
                length = _cautious(piece.rates(t, y), y, step)
            if t >= t1:
                break
            next_sample = len(samples) * grid
            target = min(t1, next_sample if next_sample > t + 1e-13 else next_sample + grid)
            part, y, name = piece.until(t, y, min(length, target - t), live)
            t = target if not name and part == target - t else t + part
            length = min(step, 2.0 * max(part, 1e-9)) if not name else length
            if abs(t - next_sample) < 1e-12:
                keep(t)
            if name:
                events.append((t, "impact" if name == "roll" else name))
            if name in ("overturned", "lift_off", "friction_paradox", "touches_wall"):
                return finish(t, name if name != "overturned" else f"overturned_{'right' if mode[0] > 0 else 'left'}")
    return finish(end, "ran")


def _cautious(rates: Array, y: Array, step: float) -> float:
    """A first step that cannot jump over the return of a rotation or a slip that has just begun."""
    hops = [abs(v / a) / 4.0 for v, a in ((y[1], rates[1]), (y[3], rates[3])) if v and a]
    return max(1e-13, min([1e-4, step, *hops]))


def _enter(
    bodies: Bodies, mode: tuple[int, int], y: Array, ax: float, az: float, event: str
) -> tuple[tuple[int, int], Array, int, str]:
    """The mode after an event, the state with it, and how many modes were possible (0: the run ends as told last)."""
    y = y.copy()
    if event == "balance":
        return mode, y, 1, ""
    if event.startswith("uplift"):
        return (1 if event == "uplift_right" else -1, mode[1]), y, 1, ""
    if event == "impact":
        y[0] = 0.0
        y[1], y[3] = bodies.impact(mode[0], y, mode[1] == 0)
        if abs(y[1]) < REST_RATE:
            y[1] = 0.0
    if event == "halt":
        y[3] = 0.0
    if bodies.case.gravity + az <= 0.0 and not y[0] and not y[1]:
        return mode, y, 0, "lift_off"
    found, ending = bodies.candidates(y, ax, az, event)
    if not found and not ending:
        raise AssertionError(f"no consistent mode: {y}")
    return (found[0] if found else mode), y, len(found), ending
