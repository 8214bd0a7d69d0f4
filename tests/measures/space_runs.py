"""The body in three dimensions: outcomes a second, and how many bodies of every kind run to their end with their balances kept.

python -m tests.measures.space_runs speed|variety [number]: of the runs of each scene, or of the bodies.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from typing import Final

import numpy as np
from scipy import signal

import analytic
from analytic import spatial
from analytic.block import GRAVITY_M_S2 as GRAVITY
from analytic.excitation import Excitation
from tests import budgets_spatial as budget
from tests.analytic.spatial.test_variety import drawn

BODY: Final = spatial.Body.block(400.0, 0.35, 0.45, 1.1)
DURATION_S: Final = 10.0
FRICTIONS: Final = (0.1, 0.2, 0.4, 0.8)


def record(seed: int) -> np.ndarray:
    """Noise of 0.5 to 8 Hz in 20 ms under a bell, its largest value one."""
    times = np.arange(0.0, DURATION_S + 1e-9, 0.02)
    b, a = signal.butter(2, [0.5, 8.0], btype="band", fs=50.0)
    noise = signal.lfilter(b, a, np.random.default_rng(seed).normal(size=len(times)))
    noise = noise * np.exp(-(((times - 4.0) / 2.5) ** 2))
    return np.asarray(noise / np.abs(noise).max())


def motions() -> dict[str, tuple[Excitation, Excitation]]:
    """One sine each way, sines, and records of 20 ms."""
    times = np.arange(0.0, DURATION_S + 1e-9, 0.02)
    return {
        "one sine": (
            analytic.Pulse("one_sine", 0.4 * GRAVITY, 1.0 / 1.3),
            analytic.Pulse("one_sine", 0.35 * GRAVITY, 1.0 / 1.7),
        ),
        "sines": (analytic.Harmonic(0.4 * GRAVITY, 1.3), analytic.Harmonic(0.35 * GRAVITY, 1.7)),
        "records": (
            analytic.SampledAcceleration(times, 0.6 * GRAVITY * record(3)),
            analytic.SampledAcceleration(times, 0.5 * GRAVITY * record(4)),
        ),
    }


def speed(number: int) -> None:
    """Print runs a second of one core, steps and outcomes, at strengths from 0.3 to 1.5."""
    scales = np.linspace(0.3, 1.5, number)
    for name, (x, y) in motions().items():
        for mu in FRICTIONS:
            problem = spatial.Problem(BODY, DURATION_S, mu, None, x, y, gravity_m_s2=GRAVITY)
            spatial.outcomes(problem, {"scale": scales[:1]}, threads=1)
            start = time.process_time()
            runs = spatial.outcomes(problem, {"scale": scales}, threads=1)
            rate = number / (time.process_time() - start)
            ends = dict(Counter(runs.outcomes.astype(str)))
            steps = f"{np.median(runs.steps):.0f} steps ({runs.steps.max()} at most)"
            print(f"{name:>8} friction {mu}: {rate:6.0f}/s, {steps}, {ends}", flush=True)


def variety(number: int) -> None:
    """Print which bodies end as a paradox, give up or miss a balance; at the end how many did."""
    missed = 0
    for seed in range(number):
        run = spatial.solve(drawn(seed), dt_out_s=None)
        paradox = run.outcome is spatial.Outcome.FRICTION_PARADOX
        if paradox or run.gave_up or max(run.energy_residual, run.momentum_residual) > budget.AUDIT:
            missed += 1
            residuals = f"energy {run.energy_residual:.1e}, momentum {run.momentum_residual:.1e}"
            print(
                f"body {seed}: {run.outcome.value} at {run.end_s:.4f} s after {run.work.steps} steps, {residuals}",
                flush=True,
            )
    print(f"{number} bodies, {missed} of them end as a paradox, give up or miss a balance")


if __name__ == "__main__":
    {"speed": speed, "variety": variety}[sys.argv[1]](int(sys.argv[2]) if len(sys.argv) > 2 else 64)
