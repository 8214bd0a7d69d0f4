"""The floor's acceleration: its breaks, and its exact Taylor coefficients between them, to any order.

Between two breaks a motion is smooth, and a break ends every step (docs/model.md, section 2), so a step never mixes two pieces.
To add a pulse: its formula in `acceleration` and in `coefficients`; a kind without one is not a number, and no run survives it.
"""

import math

from analytic.kernel.compiler import inlined, jit, load_double, set_term, term
from analytic.kernel.polynomial import sine_cosine
from analytic.kernel.records import (
    COSINE,
    HARMONIC,
    INVERSE,
    NONE,
    RECTANGULAR,
    RICKER,
    SAMPLED,
    SINE,
    TERMS,
    Floats,
    Motion,
    Task,
)


@inlined
def next_break_s(motion: Motion) -> float:
    """Time of the motion's next break, s; infinite after the last."""
    params, passed = motion.params, motion.breaks_passed
    if params.kind == SAMPLED:
        return load_double(params.times, passed) if passed < params.n_samples else math.inf
    if params.kind == HARMONIC:
        return params.ramp_s if passed == 0 and params.ramp_s > 0.0 else math.inf
    if params.kind == NONE or passed > 1:
        return math.inf
    return params.start_s if passed == 0 else params.end_s


@inlined
def is_jump(motion: Motion) -> bool:
    """Whether the acceleration itself may jump at the break that was passed last: inside a record only its slope does."""
    kind, passed = motion.params.kind, motion.breaks_passed
    return kind != HARMONIC and (kind != SAMPLED or passed == 1 or passed == motion.params.n_samples)


@inlined
def is_over(motion: Motion) -> bool:
    """Whether the motion is exactly zero from now on."""
    kind = motion.params.kind
    if kind == SAMPLED:
        return motion.breaks_passed >= motion.params.n_samples
    return kind == NONE or (kind != HARMONIC and motion.breaks_passed >= 2)


@inlined
def look_ahead(task: Task) -> None:
    """Note how far the motions are smooth, and whether both are over."""
    task.state.limit_s = min(next_break_s(task.motion_x), next_break_s(task.motion_z), task.params.duration_s)
    task.state.motions_over = is_over(task.motion_x) and is_over(task.motion_z)


@inlined
def segment(motion: Motion) -> tuple[float, float, float]:
    """Time and acceleration of the sample that a record has passed last, and the slope to the next; zero outside."""
    params, passed = motion.params, motion.breaks_passed
    if passed < 1 or passed >= params.n_samples:
        return 0.0, 0.0, 0.0
    start, first = load_double(params.times, passed - 1), load_double(params.samples, passed - 1)
    rise = params.scale * (load_double(params.samples, passed) - first)
    return start, params.scale * first, rise / (load_double(params.times, passed) - start)


@inlined
def sampled_at(motion: Motion, time: float) -> float:
    """A record's acceleration at a time within its present segment; the sample itself at its own time."""
    start, first, slope = segment(motion)
    return first + slope * (time - start)


@jit
def prepare(motion: Motion) -> None:
    """Set the motion to its start; write what the coefficients of a sine take at every step from its amplitude and frequency."""
    motion.breaks_passed, motion.degree = 0, 0
    power = motion.params.amplitude_m_s2
    for k in range(TERMS):
        motion.sine_terms[k] = power if k % 4 < 2 else -power
        power *= motion.params.omega_rad_s * INVERSE[k + 1]


@inlined
def _oscillation(motion: Motion, row: Floats, n: int, sine: float, cosine: float) -> None:
    """amplitude sin(ωτ + φ) with sine = sin φ, cosine = cos φ."""
    for k in range(0, n + 1, 2):
        set_term(row, k, term(motion.sine_terms, k) * sine)
        set_term(row, k + 1, term(motion.sine_terms, k + 1) * cosine)


@jit
def _ricker(row: Floats, n: int, amplitude: float, omega: float, xi: float) -> None:
    """amplitude (1 − w²ξ²) exp(−w²ξ²/2) about ξ; the bell's terms from e' = −w²ξ e, differentiated."""
    w2 = omega * omega
    e0, e1, e2 = amplitude * math.exp(-0.5 * w2 * xi * xi), 0.0, 0.0
    for k in range(n + 1):
        row[k] = (1.0 - w2 * xi * xi) * e0 - 2.0 * w2 * xi * e1 - w2 * e2
        e0, e1, e2 = -w2 * (xi * e0 + e1) / (k + 1), e0, e1


@inlined
def coefficients(motion: Motion, row: Floats, time: float, n: int) -> int:
    """Write the Taylor coefficients of the acceleration about a time into the row, to order n at most; return their degree.

    Beyond the degree the row is zero: records and rectangles never write there, and a pulse clears it.
    """
    params, kind = motion.params, motion.params.kind
    if kind == SAMPLED:
        start, first, slope = segment(motion)
        row[0], row[1] = first + slope * (time - start), slope
        return 1
    if kind == NONE:
        row[0] = 0.0
        return 0
    if kind != HARMONIC and motion.breaks_passed != 1:  # before a pulse or after it
        row[:] = 0.0
        return 0
    if kind == RECTANGULAR:
        row[0] = params.amplitude_m_s2
        return 0
    since = time - params.start_s
    if kind == RICKER:
        from_middle = since - 0.5 * (params.end_s - params.start_s)
        _ricker(row, n, params.amplitude_m_s2, params.omega_rad_s, from_middle)
        return n
    sine, cosine = sine_cosine(params.omega_rad_s * since + params.phase_rad)
    if kind == COSINE:
        sine, cosine = cosine, -sine
    elif kind != SINE and kind != HARMONIC:
        sine, cosine = math.nan, math.nan
    _oscillation(motion, row, n, sine, cosine)
    if kind == HARMONIC and motion.breaks_passed == 0 and params.ramp_s > 0.0:  # times t/ramp
        for k in range(n, 0, -1):
            row[k] = (row[k] * since + row[k - 1]) / params.ramp_s
        row[0] = row[0] * since / params.ramp_s
    return n


@jit
def acceleration(motion: Motion, time: float) -> float:
    """The acceleration itself at a time of the stretch between the breaks passed and to come, m/s²."""
    params, kind = motion.params, motion.params.kind
    if kind == NONE:
        return 0.0
    if kind == SAMPLED:
        return sampled_at(motion, time)
    if kind == HARMONIC:
        value = params.amplitude_m_s2 * math.sin(params.omega_rad_s * time + params.phase_rad)
        return value * time / params.ramp_s if params.ramp_s > 0.0 and motion.breaks_passed == 0 else value
    if motion.breaks_passed != 1:
        return 0.0
    since = time - params.start_s
    if kind == RECTANGULAR:
        return params.amplitude_m_s2
    if kind == SINE:
        return params.amplitude_m_s2 * math.sin(params.omega_rad_s * since)
    if kind == COSINE:
        return params.amplitude_m_s2 * math.cos(params.omega_rad_s * since)
    if kind == RICKER:
        w = (params.omega_rad_s * (since - 0.5 * (params.end_s - params.start_s))) ** 2
        return params.amplitude_m_s2 * (1.0 - w) * math.exp(-0.5 * w)
    return math.nan
