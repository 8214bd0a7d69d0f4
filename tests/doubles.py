"""Doubles: histories that are made, not simulated, and spoilt copies of them that a score must rank as expected."""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any, Final

import numpy as np

from harness.model import Array, Finding, History, Outcome, Run
from harness.records.study import CaseRun


def codes(findings: Iterable[Finding]) -> list[str]:
    """What findings say, by code."""
    return [each.code for each in findings]


def rocking(
    duration_s: float = 10.0,
    dt_s: float = 1e-3,
    *,
    amplitude_rad: float = 0.1,
    accel_rad_s2: float = 4.0,
    ratio: float = 0.9,
    start_s: float = 0.5,
    slip_m: float = 0.01,
) -> History:
    """A statue that rocks freely under a constant restoring acceleration: parabolic arcs, each impact keeping `ratio`.

    Every arc starts at θ = 0 with rate ω, peaks at ω²/(2a) and lands after 2ω/a with the rate −ω: all known in closed form.
    """
    t = np.arange(round(duration_s / dt_s) + 1) * dt_s
    theta, rate = np.zeros_like(t), np.zeros_like(t)
    for begin, end, side, omega in arcs(duration_s, amplitude_rad, accel_rad_s2, ratio, start_s):
        inside = (t >= begin) & (t < end)
        tau = t[inside] - begin
        theta[inside] = side * (omega * tau - 0.5 * accel_rad_s2 * tau**2)
        rate[inside] = side * (omega - accel_rad_s2 * tau)
    slip = slip_m * 0.5 * (1.0 - np.cos(math.pi * np.clip((t - start_s) / duration_s, 0.0, 1.0)))
    return History(t, theta, rate, slip, np.gradient(slip, t))


def arcs(
    duration_s: float, amplitude_rad: float, accel_rad_s2: float, ratio: float, start_s: float
) -> list[tuple[float, float, int, float]]:
    """Start, end, side and starting rate of each arc of `rocking`, down to peaks of 2e-4 rad."""
    found = []
    begin, side = start_s, 1
    omega = math.sqrt(2.0 * accel_rad_s2 * amplitude_rad)
    while begin < duration_s and omega**2 / (2.0 * accel_rad_s2) > 2e-4:
        end = begin + 2.0 * omega / accel_rad_s2
        found.append((begin, end, side, omega))
        begin, side, omega = end, -side, ratio * omega
    return found


def wave(
    duration_s: float = 4.0, dt_s: float = 1e-3, *, amplitude_rad: float = 0.05, frequency_hz: float = 1.0
) -> History:
    """θ = A sin 2πft, whose scores are known by hand."""
    t = np.arange(round(duration_s / dt_s) + 1) * dt_s
    omega = 2.0 * math.pi * frequency_hz
    none = np.zeros_like(t)
    return History(t, amplitude_rad * np.sin(omega * t), amplitude_rad * omega * np.cos(omega * t), none, none)


def rest(duration_s: float = 10.0, dt_s: float = 1e-3) -> History:
    """A statue that never moves."""
    t = np.arange(round(duration_s / dt_s) + 1) * dt_s
    none = np.zeros_like(t)
    return History(t, none, none, none, none)


def shifted(history: History, by_s: float) -> History:
    """The same motion, later by `by_s`, on the same times."""
    t = history.t_s
    return replace(
        history,
        theta_rad=np.interp(t - by_s, t, history.theta_rad, left=0.0),
        theta_rate_rad_s=np.interp(t - by_s, t, history.theta_rate_rad_s, left=0.0),
    )


def flipped(history: History) -> History:
    """The mirror image: left and right exchanged."""
    return replace(history, theta_rad=-history.theta_rad, theta_rate_rad_s=-history.theta_rate_rad_s)


def scaled(history: History, by: float) -> History:
    """Every rotation larger by a factor."""
    return replace(history, theta_rad=by * history.theta_rad, theta_rate_rad_s=by * history.theta_rate_rad_s)


def raised(history: History, by_rad: float) -> History:
    """Every rotation larger by a constant."""
    return replace(history, theta_rad=history.theta_rad + by_rad)


def truncated(history: History, end_s: float) -> History:
    """The history up to `end_s` alone."""
    count = int(np.searchsorted(history.t_s, end_s, side="right"))
    return History(
        *(column[:count] for column in history.columns().values()),  # type: ignore[arg-type]
    )


def parted(history: History, from_s: float, grows_rad_s: float) -> History:
    """The same motion until `from_s`, then drifting away linearly."""
    drift: Array = grows_rad_s * np.maximum(history.t_s - from_s, 0.0)
    return replace(history, theta_rad=history.theta_rad + drift)


SPOILT: Final[Mapping[str, Callable[[History, float], History]]] = {
    "shifted": lambda history, size: shifted(history, 0.1 * size),
    "scaled": lambda history, size: scaled(history, 1.0 + size),
    "raised": lambda history, size: raised(history, 0.05 * size),
}
"""Ways to spoil a history by a size from 0 (untouched) to 1."""


def run_of(history: History | None, engine: str = "double", **fields: Any) -> Run:
    """A run around a history, standing unless told otherwise."""
    peak = (0.0, 0.0)
    if history is not None:
        k = int(np.argmax(np.abs(history.theta_rad)))
        peak = float(abs(history.theta_rad[k])), float(history.t_s[k])
    known: dict[str, Any] = {
        "engine": engine,
        "outcome": Outcome.STANDS,
        "history": history,
        "settings": {},
        "steps": 0,
        "wall_s": 0.0,
        "peak_theta_rad": peak[0],
        "peak_time_s": peak[1],
        "end_s": 0.0 if history is None else history.duration_s,
    }
    return Run(**(known | fields))


def case_run(**fields: Any) -> CaseRun:
    """A run as studies and validations keep it: it stands and states nothing, but for what is given."""
    known: dict[str, Any] = {
        "engine": "analytic", "outcome": Outcome.STANDS, "peak_theta_rad": 0.0, "no_return_time_s": None,
        "overturn_time_s": None, "peak_slip_m": 0.0, "residual_slip_m": 0.0, "numerical_uncertainty_rad": None,
        "reliable_until_s": None, "steps": 1, "labels": [], "findings": [], "validity": {}, "impacts": 0,
    }  # fmt: skip
    return CaseRun(**known | fields)
