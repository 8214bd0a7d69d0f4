"""Scores taken sample by sample: differences, peaks, residuals, how long two histories stay together; by ISO/TS 18571; against a
measurement.
"""

import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from harness.model import Array, Finding, History, Pair, Run, caution, first_beyond_s, info, require, translated
from harness.records.scores import ComparisonError, IsoRating

# How far two runs are apart.

INSTANTS: Final = 4000
"""Instants at which two histories are compared: the finest features, impacts, last longer than a thousandth of any scene."""


def errors(run: Run, other: Run, until_s: float = math.inf) -> tuple[float, float]:
    """Largest differences of rotation, rad, and slip, m, at a run's samples while both last; infinite without histories."""
    if run.history is None or other.history is None:
        return math.inf, math.inf
    times = run.history.t_s[run.history.t_s <= min(until_s, run.end_s, other.end_s)]
    return (
        float(np.max(np.abs(run.history.at(times) - other.history.at(times)), initial=0.0)),
        float(np.max(np.abs(run.history.slip_at(times) - other.history.slip_at(times)), initial=0.0)),
    )


def error_rad(run: Run, other: Run, until_s: float = math.inf) -> float:
    """Largest difference of two rotations, rad, at `INSTANTS`, up to the earlier end; infinite without histories."""
    if run.history is None or other.history is None:
        return math.inf
    times = np.linspace(0.0, min(run.end_s, other.end_s, until_s), INSTANTS)
    return float(np.max(np.abs(run.history.at(times) - other.history.at(times))))


@dataclass(frozen=True)
class Peak:
    """The largest rotation by size, signed, and its time."""

    theta_rad: float
    time_s: float


def rms(pair: Pair, values: Array) -> float:
    """Root mean square of values (n,) over the window, weighted by time."""
    return math.sqrt(pair.integral(values, values) / float(pair.weights_s.sum()))


def peak(history: History, until_s: float = math.inf) -> Peak:
    """The largest |θ| up to `until_s`, signed; between samples it is the Hermite value where the rate, taken as linear, vanishes.

    A history that begins later than `until_s` gives its first sample.
    """
    count = max(int(np.searchsorted(history.t_s, until_s, side="right")), 1)
    k = int(np.argmax(np.abs(history.theta_rad[:count])))
    best = Peak(float(history.theta_rad[k]), float(history.t_s[k]))
    rate = history.theta_rate_rad_s
    for i in (k - 1, k):
        if i < 0 or i + 1 >= rate.size or rate[i] * rate[i + 1] >= 0.0:
            continue
        share = rate[i] / (rate[i] - rate[i + 1])
        time = float(history.t_s[i] + share * (history.t_s[i + 1] - history.t_s[i]))
        theta = float(history.at(np.array([time]))[0])
        if abs(theta) > abs(best.theta_rad) and time <= until_s:
            best = Peak(theta, time)
    return best


def sprague_geers(pair: Pair) -> dict[str, Any]:
    """Sprague and Geers' integral errors, b being the reference (Shock and Vibration Bulletin 60, 1989).

    M = √(∫a²/∫b²) − 1, P = acos(∫ab/√(∫a²∫b²))/π, C = √(M² + P²).
    """
    a, b = pair.theta_a_rad, pair.theta_b_rad
    aa, bb, ab = pair.integral(a, a), pair.integral(b, b), pair.integral(a, b)
    if aa == 0.0 and bb == 0.0:
        return {"magnitude": 0.0, "phase": 0.0, "combined": 0.0}
    magnitude = None if bb == 0.0 else math.sqrt(aa / bb) - 1.0
    if aa == 0.0 or bb == 0.0:
        return {"magnitude": magnitude, "phase": None, "combined": None}
    phase = 0.0 if np.array_equal(a, b) else math.acos(min(max(ab / math.sqrt(aa * bb), -1.0), 1.0)) / math.pi
    return {"magnitude": magnitude, "phase": phase, "combined": math.hypot(magnitude or 0.0, phase)}


def together_until_s(pair: Pair, tolerance_rad: float) -> float:
    """The time up to which |θ_a − θ_b| has stayed within the tolerance; the window's end when it always does."""
    left = first_beyond_s(pair.t_s, np.abs(pair.difference_rad), tolerance_rad)
    return pair.end_s if left is None else left


# ISO/TS 18571 by the library of TU Graz (extra `iso`), on a stated resampling; loaded only when asked.

SAMPLES: Final = 1001
"""Samples after resampling: the rating's time warping costs the square of their number in time and memory."""

WEIGHTS: Final = {"corridor": 0.4, "phase": 0.2, "magnitude": 0.2, "slope": 0.2}
"""Weights of the overall rating (ISO/TS 18571, also the library's defaults)."""


def rate(pair: Pair, samples: int = SAMPLES) -> IsoRating:
    """Corridor, phase, magnitude, slope and overall rating (1 is perfect) of θ_a against θ_b.

    The specification was made for signals at 10 kHz; here both histories are resampled linearly to `samples` equal steps over
    the window, and that step is stated. Raises `InputError` when the extra is not installed, the window is too short, or a
    history does not move (the rating divides by its norm).
    """
    advice = 'install it: pip install "rockcheck[iso]"'
    with translated(ImportError, "--iso", "the extra `iso`", "no objective_rating_metrics", advice):
        from objective_rating_metrics.rating import ISO18571
    require(pair.t_s.size >= 10, "--iso", "at least 10 common samples", f"{pair.t_s.size}")
    require(
        np.ptp(pair.theta_a_rad) > 0.0 and np.ptp(pair.theta_b_rad) > 0.0,
        "--iso",
        "two histories that move",
        "one that stays at a constant rotation",
    )
    curves, step = resampled(pair, samples)
    rating = ISO18571(reference_curve=curves[1], comparison_curve=curves[0], dt=step)
    # Each rating once: the library's own overall_rating computes them all again.
    parts = {
        "corridor": float(rating.corridor_rating(-1)),
        "phase": float(rating.phase_rating(-1)),
        "magnitude": float(rating.magnitude_rating(-1)),
        "slope": float(rating.slope_rating(-1)),
    }
    overall = sum(WEIGHTS[name] * value for name, value in parts.items())
    return IsoRating(**parts, overall=overall, resampled_dt_s=step, samples=samples)


def resampled(pair: Pair, samples: int) -> tuple[tuple[Any, Any], float]:
    """Both rotations as (samples, 2) arrays of time and value on equal steps, and the step in s."""
    t_s = np.linspace(pair.start_s, pair.end_s, samples)
    curves = [np.column_stack((t_s, np.interp(t_s, pair.t_s, x))) for x in (pair.theta_a_rad, pair.theta_b_rad)]
    return (curves[0], curves[1]), float(t_s[1] - t_s[0])


# A simulation against a measurement: the comparison error E = S − D and the uncertainties of both (ASME V&V 20).

RECTANGLE: Final = 1.0 / math.sqrt(3.0)
"""Standard uncertainty of what is only known to lie within ± 1 (GUM, 4.3.7): a stated numerical error is such a bound."""
COVERAGE: Final = 2.0
"""Standard uncertainties within which 95 % of errors lie."""
LARGEST_RAD: Final = 1.0


@dataclass(frozen=True)
class Measured:
    """Standard uncertainties, rad, of a measured rotation, and of a computed one because its inputs are not known."""

    data_rad: float
    input_rad: float = 0.0

    def __post_init__(self) -> None:
        for name, value in (("--measured-uncertainty", self.data_rad), ("--input-uncertainty", self.input_rad)):
            require(0.0 <= value < LARGEST_RAD, name, f"a rotation from 0 to {LARGEST_RAD:g} rad", f"{value!r}")


def comparison_error(
    within: Pair, peaks: tuple[Peak, Peak], numerical_rad: float, measured: Measured, until_s: float | None = None
) -> tuple[ComparisonError, Finding]:
    """E of the largest rotation and over the history of a simulation (first) against a measurement, and what it says.

    `numerical_rad` bounds the simulation's numerical error; `until_s`: up to when they are compared, where that is not to the
    end. ASME V&V 20-2009, section 1: u_val² = u_num² + u_input² + u_D², and the model's own error lies within E ± 2 u_val.
    """
    simulated, seen = (abs(each.theta_rad) for each in peaks)
    own = RECTANGLE * numerical_rad
    total = math.hypot(own, measured.input_rad, measured.data_rad)
    beyond = np.abs(within.difference_rad) > COVERAGE * total
    found = ComparisonError(
        simulated_rad=simulated,
        measured_rad=seen,
        error_rad=simulated - seen,
        rms_error_rad=rms(within, within.difference_rad),
        beyond_share=float(within.weights_s @ beyond / within.weights_s.sum()),
        u_num_rad=own,
        u_input_rad=measured.input_rad,
        u_data_rad=measured.data_rad,
        u_val_rad=total,
    )
    apart = abs(found.error_rad) > COVERAGE * total
    values = {
        "until_s": until_s,
        "error_rad": found.error_rad,
        "u_val_rad": total,
        "beyond_share": found.beyond_share,
        "low_rad": found.error_rad - COVERAGE * total,
        "high_rad": found.error_rad + COVERAGE * total,
        "u_num_rad": own,
        "u_input_rad": measured.input_rad,
        "u_data_rad": measured.data_rad,
    }
    return found, caution("model_error", **values) if apart else info("model_error_not_told", **values)
