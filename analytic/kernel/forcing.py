"""Floor motions as the compiled kernel sees them: one row of numbers, and exact Taylor coefficients of any order.

A motion is smooth between its breaks; ``seg`` counts the breaks already passed. To add a motion: a code in
``analytic.kernel.layout``, a branch in ``encode``, ``break_at`` and ``coefficients``.
"""

from __future__ import annotations

import math

from analytic.kernel.compiler import inlined, jit
from analytic.kernel.elementary import sine_cosine
from analytic.kernel.layout import (
    ALONG_X,
    ALONG_Z,
    AMPLITUDE,
    COSINE,
    DURATION,
    END,
    HARMONIC,
    INVERSE,
    KIND,
    LIMIT,
    MAX_ORDER,
    NONE,
    OMEGA,
    ORDER,
    OVER,
    PHASE,
    RAMP,
    RECTANGULAR,
    RICKER,
    SAMPLED,
    SAMPLES,
    SCALE,
    SEG,
    START,
    TIMES,
    Floats,
    T,
    Task,
)
from analytic.kernel.memory import peek, set_term, term


@inlined
def break_at(task: Task, axis: int) -> float:
    """Time of the motion's next break, s; infinite after the last."""
    kind, seg = int(task.f[axis, KIND]), task.q[SEG + axis]
    if kind == SAMPLED:
        return peek(task.address[TIMES + axis], seg) if seg < task.length[TIMES + axis] else math.inf
    if kind == HARMONIC:
        return float(task.f[axis, RAMP]) if seg == 0 and task.f[axis, RAMP] > 0.0 else math.inf
    if kind == NONE or seg > 1:
        return math.inf
    return float(task.f[axis, START] if seg == 0 else task.f[axis, END])


@inlined
def is_jump(task: Task, axis: int) -> bool:
    """Whether a itself may jump at the break that was passed last."""
    kind, seg = int(task.f[axis, KIND]), task.q[SEG + axis]
    return bool(kind != HARMONIC and (kind != SAMPLED or seg == 1 or seg == task.length[TIMES + axis]))


@inlined
def is_over(task: Task, axis: int) -> bool:
    """Whether the motion is exactly zero from now on."""
    kind, seg = int(task.f[axis, KIND]), task.q[SEG + axis]
    if kind == SAMPLED:
        return bool(seg >= task.length[TIMES + axis])
    return bool(kind == NONE or (kind != HARMONIC and seg >= 2))


@inlined
def look_ahead(task: Task) -> None:
    """Note how far the motions are smooth, and whether both are over."""
    task.s[LIMIT] = min(break_at(task, ALONG_X), break_at(task, ALONG_Z), task.p[DURATION])
    task.q[OVER] = 1 if is_over(task, ALONG_X) and is_over(task, ALONG_Z) else 0


@inlined
def sampled(task: Task, axis: int) -> tuple[float, float, float]:
    """Time and acceleration of the sample that the record has passed last, and the slope to the next; zero outside."""
    seg = task.q[SEG + axis]
    if seg < 1 or seg >= task.length[TIMES + axis]:
        return 0.0, 0.0, 0.0
    times, samples, scale = task.address[TIMES + axis], task.address[SAMPLES + axis], task.f[axis, SCALE]
    start, first = peek(times, seg - 1), peek(samples, seg - 1)
    slope = scale * (peek(samples, seg) - first) / (peek(times, seg) - start)
    return start, scale * first, slope


@inlined
def sampled_at(task: Task, axis: int, time: float) -> float:
    """A record's acceleration at a time within its present segment; the sample itself at its own time."""
    start, first, slope = sampled(task, axis)
    return first + slope * (time - start)


@jit
def prepare(task: Task, axis: int) -> None:
    """Write what the coefficients of a sine need at every step: amplitude ω^k/k! with the sign of the k-th derivative."""
    power = task.f[axis, AMPLITUDE]
    for k in range(MAX_ORDER + 2):
        task.wave[axis, k] = power if k % 4 < 2 else -power
        power *= task.f[axis, OMEGA] * INVERSE[k + 1]


@inlined
def _oscillation(task: Task, axis: int, row: int, n: int, sine: float, cosine: float) -> None:
    """amplitude sin(ωτ + φ) with sine = sin φ, cosine = cos φ."""
    w, wave = task.w, task.wave
    for k in range(0, n + 1, 2):
        set_term(w, row, k, term(wave, axis, k) * sine)
        set_term(w, row, k + 1, term(wave, axis, k + 1) * cosine)


@jit
def _ricker(w: Floats, row: int, n: int, amplitude: float, omega: float, xi: float) -> None:
    """amplitude (1 − w²ξ²) exp(−w²ξ²/2) about ξ."""
    w2 = omega * omega
    e0, e1, e2 = amplitude * math.exp(-0.5 * w2 * xi * xi), 0.0, 0.0
    for k in range(n + 1):
        w[row, k] = (1.0 - w2 * xi * xi) * e0 - 2.0 * w2 * xi * e1 - w2 * e2
        e0, e1, e2 = -w2 * (xi * e0 + e1) / (k + 1), e0, e1


@inlined
def coefficients(task: Task, axis: int, row: int) -> int:
    """Write the Taylor coefficients of the acceleration about the present into the row of the workspace; return the degree.

    Beyond the degree the row is zero: records and rectangles never write there, and a pulse clears it.
    """
    f, w, time = task.f, task.w, task.s[T]
    kind, seg, n = int(f[axis, KIND]), task.q[SEG + axis], int(task.p[ORDER])
    if kind == SAMPLED:
        start, first, slope = sampled(task, axis)
        w[row, 0], w[row, 1] = first + slope * (time - start), slope
        return 1
    if kind == NONE:
        w[row, 0] = 0.0
        return 0
    if kind != HARMONIC and seg != 1:
        w[row, :] = 0.0
        return 0
    if kind == RECTANGULAR:
        w[row, 0] = f[axis, AMPLITUDE]
        return 0
    since = time - f[axis, START]
    if kind == RICKER:
        _ricker(w, row, n, f[axis, AMPLITUDE], f[axis, OMEGA], since - 0.5 * (f[axis, END] - f[axis, START]))
        return n
    angle = f[axis, OMEGA] * since + f[axis, PHASE]
    sine, cosine = sine_cosine(angle)
    if kind == COSINE:
        sine, cosine = cosine, -sine
    _oscillation(task, axis, row, n, sine, cosine)
    if kind == HARMONIC and seg == 0 and f[axis, RAMP] > 0.0:
        for k in range(n, 0, -1):
            w[row, k] = (w[row, k] * since + w[row, k - 1]) / f[axis, RAMP]
        w[row, 0] = w[row, 0] * since / f[axis, RAMP]
    return n
