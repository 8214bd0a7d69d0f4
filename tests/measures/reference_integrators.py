"""The same models on public integrators, as one would write them there: scipy's DOP853 with events, heyoka's Taylor steps."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic import Block, Friction, Harmonic, Pedestal
from analytic.block import GRAVITY_M_S2, OVERTURN_RAD

MAX_EVENTS: Final = 100_000
"""Events after which a run is given up."""

Samples = NDArray[np.float64]
Accel = Callable[[float], float]


@dataclass(frozen=True)
class Model:
    """Plain numbers of a statue of two corners on a pedestal of mass base_kg (0: on the floor) and its friction."""

    mass_kg: float
    base_kg: float
    inertia_kg_m2: float
    height_m: float
    left_m: float
    right_m: float
    static: float
    kinetic: float

    @classmethod
    def of(cls, block: Block, pedestal: Pedestal | None, friction: Friction) -> Model:
        """The numbers of the library's own classes."""
        base = pedestal.mass_kg if pedestal is not None else 0.0
        left, right = -block.profile_m[0][0], block.profile_m[1][0]
        inertia, height = block.inertia_kg_m2, block.centroid_height_m
        return cls(block.mass_kg, base, inertia, height, left, right, friction.static, friction.kinetic)

    @property
    def total_kg(self) -> float:
        """M."""
        return self.mass_kg + self.base_kg

    def corner_m(self, side: int) -> float:
        """b of the corner on that side."""
        return self.right_m if side > 0 else self.left_m

    def forces(self, accel: float, y: Sequence[float], side: int, slide: int) -> tuple[float, float, float, float]:
        """θ̈, ü, F and N in one joint state (docs/model.md, section 2)."""
        m, total, kappa = self.mass_kg, self.total_kg, slide * self.kinetic
        if side == 0:
            support = accel if slide == 0 else -kappa * GRAVITY_M_S2
            return 0.0, support - accel, total * support, total * GRAVITY_M_S2
        theta, omega, b = y[0], y[1], side * self.corner_m(side)
        sine, cosine = math.sin(theta), math.cos(theta)
        x, z = self.height_m * sine - b * cosine, b * sine + self.height_m * cosine
        inertia = self.inertia_kg_m2 + m * (b * b + self.height_m * self.height_m)
        if slide == 0:
            turn, support = m * (GRAVITY_M_S2 * x - accel * z) / inertia, accel
        else:
            lever, rise = z - kappa * x, x + kappa * z
            pull = m * m / total * z
            turn = (m * GRAVITY_M_S2 * rise - pull * rise * omega * omega) / (inertia - pull * lever)
            support = -kappa * GRAVITY_M_S2 - m / total * (lever * turn - rise * omega * omega)
        floor = total * support + m * (z * turn - x * omega * omega)
        normal = total * GRAVITY_M_S2 - m * (z * omega * omega + x * turn)
        return turn, support - accel, floor, normal

    def land(self, side: int, omega: float, rate: float, stuck: bool) -> tuple[float, float]:
        """θ̇ and u̇ after the impact that leaves the corner on that side (docs/model.md, section 3)."""
        m, total, h = self.mass_kg, self.total_kg, self.height_m
        old, new = self.corner_m(side), self.corner_m(-side)
        j_new = self.inertia_kg_m2 + m * (h * h + new * new)
        j_cross = self.inertia_kg_m2 + m * (h * h - old * new)
        if self.base_kg == 0.0:
            return j_cross / j_new * omega, rate
        held = (j_cross * omega + m * h * rate) / j_new
        normal = m * (new * abs(held) + old * abs(omega))
        floor = m * h * (held - omega) - total * rate
        if held * omega >= 0.0 and abs(floor) <= (self.static if stuck else self.kinetic) * normal:
            return held, 0.0
        for sign in (1, -1) if floor <= 0.0 else (-1, 1):
            # M u̇⁺ + m h θ̇⁺ + σμ m b_n |θ̇⁺| = M u̇⁻ + m h θ̇⁻ − σμ m b_o |θ̇⁻| with angular momentum about the new corner
            turn = 1.0 if omega > 0.0 else -1.0
            kappa = sign * self.kinetic * turn
            matrix = [[j_new, m * h], [m * (h + kappa * new), total]]
            known = [j_cross * omega + m * h * rate, m * (h - kappa * old) * omega + total * rate]
            after, moved = np.linalg.solve(matrix, known)
            if moved * sign > 0.0 and after * omega >= 0.0:
                return float(after), float(moved)
        momentum, push = total * rate + m * h * omega, self.kinetic * m * old * abs(omega)
        return 0.0, math.copysign(max(abs(momentum) - push, 0.0), momentum) / total

    def choose(
        self, accel: float, y: Sequence[float], side: int, slide: int, lifted: bool = False, slipped: bool = False
    ) -> tuple[int, int]:
        """The first joint state whose own accelerations keep its signs; only what is at rest is free, and what just left it
        does not stay."""
        sides: tuple[int, ...] = (0, 1, -1) if y[0] == 0.0 and y[1] == 0.0 and not lifted else (side,)
        slides: tuple[int, ...] = (0, 1, -1) if self.base_kg > 0.0 and y[3] == 0.0 else (slide,)
        slides = (1, -1) if slipped else slides
        for sliding in slides:
            for rocking in sides:
                turn, slip, floor, normal = self.forces(accel, y, rocking, sliding)
                support = slip + accel
                lifted = GRAVITY_M_S2 * self.right_m + support * self.height_m < 0.0
                lifted = lifted or GRAVITY_M_S2 * self.left_m - support * self.height_m < 0.0
                rocks = len(sides) == 1 or (not lifted if rocking == 0 else turn * rocking > 0.0)
                held = abs(floor) <= self.static * normal
                slips = len(slides) == 1 or (held if sliding == 0 else slip * sliding > 0.0)
                if rocks and slips:
                    return rocking, sliding
        return side, slide


def _events(model: Model, accel: Accel, side: int, slide: int) -> list[Any]:
    """The functions that end the joint state by falling to zero."""
    height, weight = model.height_m, GRAVITY_M_S2
    functions: list[Any] = []
    if side != 0:
        functions += [lambda t, y: side * y[0], lambda t, y: OVERTURN_RAD - abs(y[0])]
    else:
        for b, sign in ((model.right_m, 1.0), (model.left_m, -1.0)):
            functions.append(
                lambda t, y, b=b, sign=sign: (
                    weight * b + sign * height * (model.forces(accel(t), y, 0, slide)[1] + accel(t))
                )
            )
    if model.base_kg > 0.0 and slide != 0:
        functions.append(lambda t, y: slide * y[3])
    elif model.base_kg > 0.0:

        def grip(t: float, y: Sequence[float]) -> float:
            _, _, floor, normal = model.forces(accel(t), y, side, 0)
            return model.static * normal - abs(floor)

        functions.append(grip)
    for function in functions:
        function.terminal, function.direction = True, -1.0
    return functions


def _after(
    model: Model, accel: float, y: list[float], side: int, slide: int, hit: int, tolerance: float
) -> tuple[list[float], int, int]:
    """State and joint state with which the run goes on after an event of `_events`, the overturning excepted."""
    landed = side != 0 and hit == 0
    if landed:
        after, moved = model.land(side, y[1], y[3], slide == 0)
        still = after * after < tolerance * model.mass_kg * GRAVITY_M_S2 * model.right_m / model.inertia_kg_m2
        y, side = [0.0, 0.0 if still else after, y[2], moved], -side
    lifted = not landed and side == 0 and hit < 2
    slipped = not lifted and hit == 2 and slide == 0
    if lifted:
        side = 1 if hit == 0 else -1
    elif hit == 2 and slide != 0:
        y[3] = 0.0
    side, slide = model.choose(accel, y, side, int(np.sign(y[3])), lifted, slipped)
    return y, side, slide


def scipy_run(
    model: Model,
    accel: Accel,
    theta0_rad: float,
    at_s: Samples,
    tolerance: float,
    rest_step_s: float,
    stops_s: Samples | None = None,
    longest_step_s: float = math.inf,
) -> tuple[Samples, int]:
    """θ at the instants at_s by DOP853 with events, and the number of evaluations.

    It steps over the kinks of a record unless it stops at each of them: stops_s. While the statue rests no error bounds a step,
    and events between its ends would be missed: rest_step_s does. Events are found on an interpolant of order 7, whose error
    no tolerance bounds: longest_step_s does.
    """
    from scipy import integrate

    solve: Any = integrate.solve_ivp
    last = float(at_s[-1])
    stops = [last] if stops_s is None else [*stops_s[(stops_s > 0.0) & (stops_s < last)].tolist(), last]
    y, t, work, theta = [theta0_rad, 0.0, 0.0, 0.0], 0.0, 0, np.zeros(at_s.size)
    side, slide = model.choose(accel(0.0), y, int(np.sign(theta0_rad)), 0)
    stop = 0
    for _ in range(MAX_EVENTS):
        if t >= last:
            return theta, work
        stop += t >= stops[stop]
        end = stops[stop]

        def motion(now: float, state: Sequence[float], side: int = side, slide: int = slide) -> list[float]:
            turn, slip, _, _ = model.forces(accel(now), state, side, slide)
            return [state[1] if side else 0.0, turn, state[3] if slide else 0.0, slip if slide else 0.0]

        inside = (at_s > t) & (at_s <= end)
        piece = solve(
            motion, (t, end), y, "DOP853", t_eval=np.union1d(at_s[inside], [end]),
            events=_events(model, accel, side, slide), rtol=tolerance, atol=tolerance,
            max_step=longest_step_s if side else min(longest_step_s, rest_step_s),
        )  # fmt: skip
        work += int(piece.nfev)
        ended = piece.status == 1
        hit = next((i for i, times in enumerate(piece.t_events) if times.size), -1) if ended else -1
        now = float(piece.t_events[hit][0]) if ended else end
        reached = inside & (at_s <= now)
        if reached.any():
            theta[reached] = piece.y[0][: int(reached.sum())]
        y = [float(v) for v in (piece.y_events[hit][0] if ended else piece.y[:, -1])]
        t = now
        if ended and side != 0 and hit == 1:
            theta[at_s > t] = y[0]
            return theta, work
        if ended:
            y, side, slide = _after(model, accel(t), y, side, slide, hit, tolerance)
    raise RuntimeError(f"{MAX_EVENTS} events did not end the run")


def heyoka_solver(
    block: Block, motion: Harmonic, theta0_rad: float, duration_s: float, tolerance: float
) -> Callable[[], tuple[Samples, int]]:
    """A symmetric single block on heyoka's Taylor integrator with a terminal event, built and compiled once.

    Each call gives θ at the end and the number of steps. Raises ImportError.
    """
    import heyoka

    inertia, alpha = block.inertia_kg_m2 + block.mass_kg * block.radius_m(1) ** 2, block.alpha_rad(1)
    factor, ratio = (
        block.mass_kg * block.radius_m(1) / inertia,
        1.0 - 2.0 * block.mass_kg * block.profile_m[1][0] ** 2 / inertia,
    )
    theta, rate = heyoka.make_vars("theta", "rate")
    side, phi = heyoka.par[0], alpha - heyoka.par[0] * theta
    push = motion.amplitude_m_s2 * heyoka.sin(motion.omega_rad_s * heyoka.time) * heyoka.cos(phi)
    system = [(theta, rate), (rate, -factor * (push + side * GRAVITY_M_S2 * heyoka.sin(phi)))]

    def land(integrator: Any, sign: int) -> bool:
        integrator.state[0], integrator.state[1] = 0.0, ratio * integrator.state[1]
        integrator.pars[0] = -integrator.pars[0]
        return True

    built = heyoka.taylor_adaptive(
        system, [theta0_rad, 0.0], pars=[1.0], tol=tolerance, t_events=[heyoka.t_event(theta, callback=land)]
    )

    def solve() -> tuple[Samples, int]:
        built.reset_cooldowns()
        built.time = 0.0
        built.state[:] = [theta0_rad, 0.0]
        built.pars[0] = 1.0
        steps = built.propagate_until(duration_s)[3]
        return np.array([built.state[0]]), int(steps)

    return solve
