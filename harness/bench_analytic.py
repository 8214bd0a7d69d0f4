"""The analytic model against other integrators on the same scenes: error and time side by side.

Errors are measured against a run of 1e-13, at the end of the scene; times are the best of several after a first, compiling
call. A rival that is not installed is a row that says so.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

from analytic import Block, Harmonic, simulate

GRAVITY_M_S2: Final = 9.81
BLOCK: Final = Block.rectangle(width_m=0.5, height_m=2.0, mass_kg=1000.0)
MOTION: Final = Harmonic(0.28 * GRAVITY_M_S2, 1.1)
THETA0_RAD: Final = 0.05
DURATION_S: Final = 10.0
TOLERANCES: Final = (1e-6, 1e-8, 1e-10, 1e-12)
REFERENCE_RAD: Final = 1e-13
REPEATS: Final = 5


@dataclass(frozen=True)
class Answer:
    """θ at the end of the scene, rad, and the work counted by the solver's own measure."""

    theta_rad: float
    work: int


Solver = Callable[[float], Answer]


def _ours(tolerance: float) -> Answer:
    run = simulate(
        BLOCK,
        MOTION,
        theta0_rad=THETA0_RAD,
        duration_s=DURATION_S,
        gravity_m_s2=GRAVITY_M_S2,
        accuracy_rad=tolerance,
        dt_s=DURATION_S,
        events=False,
        validity=False,
    )
    return Answer(float(run.theta_rad[-1]), run.work.steps)


def _numbers() -> tuple[float, float, float, float]:
    """m R/J, α, A, ω of the single block."""
    inertia = BLOCK.inertia_corner_kg_m2(1)
    return BLOCK.mass_kg * BLOCK.radius_m(1) / inertia, BLOCK.alpha_rad(1), MOTION.amplitude_m_s2, MOTION.omega_rad_s


def _ratio() -> float:
    inertia, offset = BLOCK.inertia_corner_kg_m2(1), 2.0 * BLOCK.mass_kg * BLOCK.profile_m[1][0] ** 2
    return 1.0 - offset / inertia


def _scipy(tolerance: float) -> Answer:
    from scipy import integrate

    solve_ivp: Any = integrate.solve_ivp

    factor, alpha, amplitude, omega = _numbers()
    ratio, t, y, side, work = _ratio(), 0.0, [THETA0_RAD, 0.0], 1.0, 0

    def motion(now: float, state: Any, s: float) -> list[float]:
        phi = alpha - s * state[0]
        push = amplitude * math.sin(omega * now) * math.cos(phi)
        return [state[1], -factor * (push + s * GRAVITY_M_S2 * math.sin(phi))]

    def impact(now: float, state: Any, s: float) -> float:
        return float(state[0]) * s

    impact.terminal, impact.direction = True, -1.0  # type: ignore[attr-defined]
    while t < DURATION_S:
        found = solve_ivp(
            motion, (t, DURATION_S), y, "DOP853", args=(side,), events=impact, rtol=tolerance, atol=tolerance
        )
        work += int(found.nfev)
        t, y = float(found.t[-1]), [float(found.y[0, -1]), float(found.y[1, -1])]
        if found.status != 1:
            break
        side, y = -side, [0.0, ratio * y[1]]
    return Answer(y[0], work)


def heyoka_solver(tolerance: float) -> Solver:
    """A solver that runs heyoka's Taylor integrator, built and compiled once, to the tolerance; raises ImportError."""
    import heyoka

    factor, alpha, amplitude, omega = _numbers()
    ratio = _ratio()
    theta, rate = heyoka.make_vars("theta", "rate")
    side, phi = heyoka.par[0], alpha - heyoka.par[0] * theta
    push = amplitude * heyoka.sin(omega * heyoka.time) * heyoka.cos(phi)
    system = [(theta, rate), (rate, -factor * (push + side * GRAVITY_M_S2 * heyoka.sin(phi)))]

    def land(integrator: Any, sign: int) -> bool:
        integrator.state[0], integrator.state[1] = 0.0, ratio * integrator.state[1]
        integrator.pars[0] = -integrator.pars[0]
        return True

    built = heyoka.taylor_adaptive(
        system, [THETA0_RAD, 0.0], pars=[1.0], tol=tolerance, t_events=[heyoka.t_event(theta, callback=land)]
    )

    def solve(_: float) -> Answer:
        built.reset_cooldowns()
        built.time = 0.0
        built.state[:] = [THETA0_RAD, 0.0]
        built.pars[0] = 1.0
        steps = built.propagate_until(DURATION_S)[3]
        return Answer(float(built.state[0]), int(steps))

    return solve


def _row(solver: str, tolerance: float, solve: Solver, exact: float, repeats: int) -> dict[str, Any]:
    answer = solve(tolerance)
    best = math.inf
    for _ in range(repeats):
        start = time.perf_counter()
        answer = solve(tolerance)
        best = min(best, time.perf_counter() - start)
    error = abs(answer.theta_rad - exact)
    return {"solver": solver, "tolerance": tolerance, "error_rad": error, "seconds": best, "work": answer.work}


def measure(repeats: int = REPEATS) -> list[dict[str, Any]]:
    """Rows (solver, tolerance, error_rad, seconds, work) of the single block under a harmonic motion of 10 s."""
    exact = _ours(REFERENCE_RAD).theta_rad
    rows = [_row("analytic", tolerance, _ours, exact, repeats) for tolerance in TOLERANCES]
    rows += [_row("scipy DOP853", tolerance, _scipy, exact, 1) for tolerance in TOLERANCES]
    for tolerance in TOLERANCES:
        try:
            rows.append(_row("heyoka", tolerance, heyoka_solver(tolerance), exact, repeats))
        except ImportError as error:
            rows.append({"solver": "heyoka", "tolerance": tolerance, "failed": str(error)})
    return rows


def throughput(runs: int = 2000, threads: int = 1) -> dict[str, Any]:
    """Outcome-only two-block runs of 10 s per second at 1e-6, over an amplitude × frequency map of the paper's statue."""
    import numpy as np

    from analytic import Pedestal, ensemble

    statue = Block.two_corners(
        mass_kg=707.0, centroid_height_m=0.774, inertia_kg_m2=152.4, corner_left_m=0.3585, corner_right_m=0.0682
    )
    side = max(math.isqrt(runs), 1)
    sweep = {
        "amplitude_m_s2": np.linspace(0.05, 0.8, side)[:, None] * GRAVITY_M_S2,
        "frequency_hz": np.linspace(0.5, 8.0, side)[None, :],
    }
    found = {}
    for name, scene in (
        ("two_block", {"pedestal": Pedestal(250.0, 0.6, 0.2), "floor_static": 0.2, "floor_kinetic": 0.15}),
        ("single_block", {}),
    ):
        options: dict[str, Any] = {"sweep": sweep, "duration_s": DURATION_S, "threads": threads, **scene}
        ensemble(statue, Harmonic(1.0, 1.0), **(options | {"sweep": {"amplitude_m_s2": [1.0]}}))
        start, cpu = time.perf_counter(), time.process_time()
        result = ensemble(statue, Harmonic(1.0, 1.0), **options)
        wall, used = time.perf_counter() - start, time.process_time() - cpu
        found[name] = {
            "runs": side * side,
            "runs_per_s": side * side / wall,
            "runs_per_core_s": side * side / used,
            "steps_per_run": float(result.steps.mean()),
        }
    return found
