"""What several parameter sets in one vector register may gain, and where the time of a step goes.

`python -m tests.measures.lanes` prints the processor time of the parts of a step of two blocks that rock and slide; of the
recurrence of a rocking block alone, one set against four in a register; and of heyoka's single block with its impacts, one set
against its batch mode. All are the least of several.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, Final

import numba
import numpy as np
from numpy.typing import NDArray

from analytic import Harmonic, Pedestal, ZeroExcitation
from analytic.block import GRAVITY_M_S2
from analytic.kernel.compiler import jit
from analytic.kernel.events import first_event
from analytic.kernel.integrator import _expand_step
from analytic.kernel.records import TASK, Records
from analytic.kernel.track import advance
from analytic.problem import Options, Problem, encode
from analytic.solver import prepare
from tests.measures.analytic_model import FORCED, STATUE

Floats = NDArray[np.float64]
ORDER: Final = 13
LANES: Final = 4
REPEATS: Final = 200_000


@numba.njit(fastmath={"contract"})
def one_lane(x: Floats, z: Floats, om: Floats, push: Floats, n: int, repeats: int) -> float:
    """X' = Zω, Z' = −Xω, ω' = gX − aZ, order by order, again and again."""
    total = 0.0
    for _ in range(repeats):
        for i in range(n):
            sx, sz, moment = 0.0, 0.0, 9.81 * x[i]
            for k in range(i + 1):
                sx += z[k] * om[i - k]
                sz -= x[k] * om[i - k]
                moment -= push[i - k] * z[k]
            inverse = 1.0 / (i + 1)
            x[i + 1], z[i + 1], om[i + 1] = sx * inverse, sz * inverse, moment * inverse
        om[0] += 1e-9 * om[n]
        total += om[n]
    return total


@numba.njit(fastmath={"contract"})
def four_lanes(x: Floats, z: Floats, om: Floats, push: Floats, n: int, repeats: int) -> float:
    """The same of four sets at once, (order, 4), each operation written for four lanes so that they share a register."""
    total = 0.0
    for _ in range(repeats):
        for i in range(n):
            a0, a1, a2, a3 = 0.0, 0.0, 0.0, 0.0
            b0, b1, b2, b3 = 0.0, 0.0, 0.0, 0.0
            c0, c1, c2, c3 = 9.81 * x[i, 0], 9.81 * x[i, 1], 9.81 * x[i, 2], 9.81 * x[i, 3]
            for k in range(i + 1):
                j = i - k
                a0, a1 = a0 + z[k, 0] * om[j, 0], a1 + z[k, 1] * om[j, 1]
                a2, a3 = a2 + z[k, 2] * om[j, 2], a3 + z[k, 3] * om[j, 3]
                b0, b1 = b0 - x[k, 0] * om[j, 0], b1 - x[k, 1] * om[j, 1]
                b2, b3 = b2 - x[k, 2] * om[j, 2], b3 - x[k, 3] * om[j, 3]
                c0, c1 = c0 - push[j, 0] * z[k, 0], c1 - push[j, 1] * z[k, 1]
                c2, c3 = c2 - push[j, 2] * z[k, 2], c3 - push[j, 3] * z[k, 3]
            inverse, m = 1.0 / (i + 1), i + 1
            x[m, 0], x[m, 1], x[m, 2], x[m, 3] = a0 * inverse, a1 * inverse, a2 * inverse, a3 * inverse
            z[m, 0], z[m, 1], z[m, 2], z[m, 3] = b0 * inverse, b1 * inverse, b2 * inverse, b3 * inverse
            om[m, 0], om[m, 1], om[m, 2], om[m, 3] = c0 * inverse, c1 * inverse, c2 * inverse, c3 * inverse
        for lane in range(LANES):
            om[0, lane] += 1e-9 * om[n, lane]
            total += om[n, lane]
    return total


def each_ns(work: Callable[..., Any], shape: tuple[int, ...], lanes: int) -> float:
    """Processor time of one set's coefficients, ns; the least of five."""
    x, z, om, push = (np.zeros(shape) for _ in range(4))
    x[0], z[0], om[0], push[:] = 0.1, 0.8, 0.3, 0.2
    work(x, z, om, push, ORDER, 1)
    spent = []
    for _ in range(5):
        begin = time.process_time()
        work(x, z, om, push, ORDER, REPEATS)
        spent.append(time.process_time() - begin)
    return 1e9 * min(spent) / REPEATS / lanes


@jit
def coefficients(tasks: Records, repeats: int) -> None:
    """The step's coefficients and its length, again and again."""
    task = tasks[0]
    for _ in range(repeats):
        task.state.floor_loaded = False
        _expand_step(task, task.state.limit_s - task.state.time_s)


@jit
def events(tasks: Records, repeats: int) -> None:
    """The search for the step's first event."""
    task = tasks[0]
    n, h = _expand_step(task, task.state.limit_s - task.state.time_s)
    for _ in range(repeats):
        first_event(task, n, h)


@jit
def sums(tasks: Records, repeats: int) -> None:
    """The state at the step's end."""
    task = tasks[0]
    n, h = _expand_step(task, task.state.limit_s - task.state.time_s)
    for _ in range(repeats):
        advance(task, n, 0.5 * h, task.state.time_s + 0.5 * h)


def parts_ns(repeats: int = 20_000) -> dict[str, float]:
    """Median processor time of the parts of a step, ns, at instants at which the statue rocks and the pedestal slides."""
    spent: dict[str, list[float]] = {"coefficients": [], "events": [], "sums": []}
    pedestal, motion, still = Pedestal(250.0, 0.6, 0.2), Harmonic(0.35 * GRAVITY_M_S2, 2.2), ZeroExcitation()
    for until_s in np.linspace(2.0, 6.0, 25).tolist():
        problem = Problem(STATUE, motion, still, until_s, pedestal=pedestal, floor_static=0.2, floor_kinetic=0.15)
        options = Options(accuracy_rad=1e-6, dt_s=None, events=False, validity=False, skip_energy=False)
        task = prepare(problem, encode(problem, options), 0)
        task.run()
        tasks = np.frombuffer(task.memory, TASK)
        if tasks["state"]["pivot"][0] < 0 or tasks["state"]["slide"][0] == 0:
            continue
        tasks["state"]["limit_s"] = 1e3
        for name, work in (("coefficients", coefficients), ("events", events), ("sums", sums)):
            work(tasks.copy(), 1)
            begin = time.process_time()
            work(tasks.copy(), repeats)
            spent[name].append(1e9 * (time.process_time() - begin) / repeats)
    return {name: float(np.median(values)) for name, values in spent.items()}


def heyoka_us(lanes: int, tolerance: float = 1e-8, sets: int = 64) -> float:
    """Processor time of one 10 s run of the bench's forced block by heyoka, µs, `lanes` sets at once; Python hears impacts."""
    import heyoka

    block, motion = FORCED.block, FORCED.motion
    assert isinstance(motion, Harmonic)
    inertia, alpha = block.inertia_corner_kg_m2(1), block.alpha_rad(1)
    factor = block.mass_kg * block.radius_m(1) / inertia
    ratio = 1.0 - 2.0 * block.mass_kg * block.profile_m[1][0] ** 2 / inertia
    theta, rate = heyoka.make_vars("theta", "rate")
    side, phi = heyoka.par[0], alpha - heyoka.par[0] * theta
    push = heyoka.par[1] * heyoka.sin(motion.omega_rad_s * heyoka.time) * heyoka.cos(phi)
    system = [(theta, rate), (rate, -factor * (push + side * GRAVITY_M_S2 * heyoka.sin(phi)))]

    def land(integrator: Any, sign: int, lane: int) -> bool:
        integrator.state[0, lane], integrator.state[1, lane] = 0.0, ratio * integrator.state[1, lane]
        integrator.pars[0, lane] = -integrator.pars[0, lane]
        return True

    start = np.array([[FORCED.theta0_rad] * lanes, [0.0] * lanes])
    built = heyoka.taylor_adaptive_batch(
        system, start, pars=np.ones((2, lanes)), tol=tolerance, t_events=[heyoka.t_event_batch(theta, callback=land)]
    )
    amplitudes, spent = np.linspace(0.15, 0.27, sets) * GRAVITY_M_S2, []
    for _ in range(7):
        begin = time.process_time()
        for k in range(0, sets, lanes):
            for lane in range(lanes):
                built.reset_cooldowns(lane)
            built.set_time(0.0)
            built.state[:], built.pars[:] = start, [[1.0] * lanes, amplitudes[k : k + lanes]]
            built.propagate_until(FORCED.duration_s)
        spent.append(time.process_time() - begin)
    return 1e6 * min(spent) / sets


if __name__ == "__main__":
    print("a step of two blocks, ns:", ", ".join(f"{name} {value:.0f}" for name, value in parts_ns().items()))
    alone, together = each_ns(one_lane, (ORDER + 2,), 1), each_ns(four_lanes, (ORDER + 2, LANES), LANES)
    print(
        f"the recurrence: one lane {alone:.0f} ns a set, four lanes {together:.0f} ns a set: {alone / together:.2f} times"
    )
    single, batch = heyoka_us(1), heyoka_us(LANES)
    print(f"heyoka: one lane {single:.1f} µs a run, four lanes {batch:.1f} µs a run: {single / batch:.2f} times")
