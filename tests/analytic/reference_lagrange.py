"""Reference A: the sympy model integrated by DOP853, its events found on the dense output."""

import itertools

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DOP853
from scipy.optimize import brentq

from tests.analytic.reference_case import Case, Path
from tests.analytic.reference_lagrange_model import STUCK, Lagrange, State

RTOL, ATOL = 1e-12, 1e-14
MAX_STEP_S = 4e-3
SUBSAMPLES = 4
REST_RATE = 1e-10
ENDINGS = ("overturned", "lift_off", "friction_paradox", "touches_wall")


def solve(case: Case, end: float, grid: float, *, rtol: float = RTOL) -> Path:
    """Integrate one case to `end`, sampled every `grid` seconds (and at its end)."""
    models = [Lagrange(facet) for facet in case.facets()]
    run = _Run(models, case.start(), grid)
    y = np.array([case.theta0 - run.model.case.tilt, case.rate0, 0.0, 0.0])
    side, slide = 0, STUCK
    for t0, t1, fx, fz in case.windows(end):
        chosen = run.choose(t0, y, fx(t0), fz(t0))
        if isinstance(chosen, str):
            return run.path(chosen, t0, y)
        side, slide = chosen
        t = t0
        while t < t1:
            t, y, name = run.phase(t, t1, y, side, slide, fx, fz, rtol)
            if name is None:
                break
            run.events.append((t, "impact" if name == "roll" else name))
            if name in ENDINGS:
                suffix = ("_right" if side > 0 else "_left") if name == "overturned" else ""
                return run.path(name + suffix, t, y)
            slip = {"slip_forward": 1, "slip_backward": -1}.get(name, 0)
            if name in ("impact", "roll"):
                run.land(side, y, slide == STUCK, rolled=name == "roll")
            elif name == "halt":
                y[3] = 0.0
            elif name.startswith("uplift"):
                side = 1 if name == "uplift_right" else -1
                continue
            elif name == "balance":
                continue
            chosen = run.choose(t, y, fx(t), fz(t), slip)
            if isinstance(chosen, str):
                return run.path(chosen, t, y)
            side, slide = chosen
    return run.path("ran", end, y)


class _Run:
    """Samples, events and ties of one run, and the facet it moves on."""

    def __init__(self, models: list[Lagrange], facet: int, grid: float) -> None:
        self.models, self.facet, self.grid = models, facet, grid
        self.samples: list[tuple[float, ...]] = []
        self.events: list[tuple[float, str]] = []
        self.ties = 0

    @property
    def model(self) -> Lagrange:
        return self.models[self.facet]

    def choose(self, t: float, y: NDArray[np.float64], ax: float, az: float, slip: int = 0) -> tuple[int, int] | str:
        """The joint state, or the ending where there is none."""
        if self.model.case.gravity + az <= 0.0 and y[0] == 0.0 and y[1] == 0.0:
            return "lift_off"
        states, endings = self.model.joint_states(y, ax, az, slip)
        if not states and not endings:
            raise AssertionError(f"no feasible joint state at t = {t}: {y}")
        self.ties += len(states) > 1
        return states[0] if states else min(endings)

    def land(self, side: int, y: NDArray[np.float64], stuck: bool, *, rolled: bool) -> None:
        """The impact on the facet at hand, or on the next one when rolling onto it: there the old corner is on the other side."""
        if rolled:
            self.facet, side = self.facet + side, -side
        y[0] = 0.0
        y[1], y[3] = self.model.impact(side, y, stuck)
        if abs(y[1]) < REST_RATE:
            y[1] = 0.0

    def phase(self, t, end, y, side, slide, fx, fz, rtol):  # type: ignore[no-untyped-def]
        """Integrate one state to its first event or to `end`; returns (t, y, event name or None)."""
        model = self.model

        def rates(t: float, y: NDArray[np.float64]) -> list[float]:
            # Python's own numbers: those of an array take three times as long.
            theta, omega, _, v = y.tolist()
            f = model.forces(side, slide, theta, omega, fx(t), fz(t))
            return [omega if side else 0.0, f.theta_dd, v if slide else 0.0, f.u_dd if slide else 0.0]

        def event_values(t: float, y: State) -> dict[str, float]:
            return model.events(side, slide, y, fx(t), fz(t))

        start = rates(t, y)
        hops = [abs(v / a) / 4 for v, a in ((y[1], start[1]), (y[3], start[3])) if v and a]
        first = min([1e-4, end - t, *[max(h, 1e-13) for h in hops]])
        stepper = DOP853(rates, t, y, end, max_step=MAX_STEP_S, first_step=first, rtol=rtol, atol=ATOL)
        armed = {name for name, value in event_values(t, y).items() if value > 0.0}
        if self.events and self.events[-1] == (t, "balance"):
            armed.discard("balance")  # passed to within rounding
        while stepper.status == "running":
            stepper.step()
            if stepper.status == "failed":
                raise AssertionError(f"DOP853 failed at t = {stepper.t}")
            dense = stepper.dense_output()
            hit = self._first_event(dense, stepper.t_old, stepper.t, event_values, armed)
            t_stop = hit[0] if hit else stepper.t
            self._sample(dense, stepper.t_old, t_stop)
            if hit:
                return t_stop, np.array(dense(t_stop)), hit[1]
        return end, np.array(stepper.y), None

    def _first_event(self, dense, t_old, t_new, event_values, armed):  # type: ignore[no-untyped-def]
        knots = np.linspace(t_old, t_new, SUBSAMPLES + 1)
        for (a, b), y in zip(itertools.pairwise(knots.tolist()), dense(knots[1:]).T.tolist(), strict=True):
            values = event_values(b, y)
            fired = [name for name in armed if values.get(name, 1.0) <= 0.0]
            if fired:
                roots = []
                for name in fired:

                    def g(t: float, name: str = name) -> float:
                        return event_values(t, dense(t)).get(name, 1.0)

                    roots.append((brentq(g, a, b, xtol=1e-15, rtol=8.9e-16) if g(a) > 0.0 else a, name))
                return min(roots)
            for name, value in values.items():
                if value > 0.0 and (name != "balance" or value > 1e-9):
                    armed.add(name)
                elif name == "impact" and value < -1e-9:
                    raise AssertionError(f"penetration at t = {b}")
        return None

    def _sample(self, dense, t_old: float, t_stop: float) -> None:  # type: ignore[no-untyped-def]
        k = len(self.samples)
        while k * self.grid <= t_stop + 1e-12:
            t = k * self.grid
            self._keep(t, dense(min(max(t, t_old), t_stop)))
            k += 1

    def _keep(self, t: float, y: NDArray[np.float64]) -> None:
        self.samples.append((t, y[0] + self.model.case.tilt, y[1], y[2], y[3]))

    def path(self, outcome: str, t: float, y: NDArray[np.float64]) -> Path:
        if not self.samples or self.samples[-1][0] < t - 1e-9:
            self._keep(t, y)
        return Path(np.array(self.samples), tuple(self.events), outcome, self.ties)
