"""Two answers to one scene, scored; knows no engine."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

import numpy as np

from harness.comparison.scores import events, pointwise
from harness.comparison.scores.against_measured import Measured, comparison_error
from harness.comparison.scores.events import after_horizon
from harness.comparison.scores.iso import rate as rate_by_iso
from harness.comparison.scores.matched import RockingInertia, event_scores, numerical_uncertainty
from harness.comparison.side import Side, side_of
from harness.comparison.verdict import judge
from harness.model.errors import InputError, Mistake
from harness.model.history import History, Outcome, Pair, pair
from harness.model.run import Run
from harness.model.scene import Scene
from harness.records.scores import Outcomes, Peaks, Pointwise, Residuals, Scores, SpragueGeers

__all__ = ["Scores", "compare"]

TOGETHER_RAD: Final = 0.01
"""Two histories count as together while no further apart than this: 1.5 cm at the top of a statue of 1.5 m."""


def compare(
    a: Run | History,
    b: Run | History,
    *,
    scene: Scene | None = None,
    names: tuple[str, str] | None = None,
    horizons_s: tuple[float | None, float | None] = (None, None),
    uncertainties_rad: tuple[float | None, float | None] = (None, None),
    slip_uncertainties_m: tuple[float | None, float | None] = (None, None),
    iso: bool = False,
    measured: Measured | None = None,
) -> Scores:
    """Score answer a against answer b, which is the reference.

    >>> scores = harness.compare(run, reference, scene=scene)
    >>> scores.verdict

    `scene` gives the energies in J; `horizons_s` are the horizons of prediction of
    each model where they were computed (`accuracy.horizon`). Scores of instants reach to the nearer horizon of the two, or to
    the time up to which a side's numerical error is stated; beyond it distributions are compared.
    `uncertainties_rad` and `slip_uncertainties_m` are the numerical errors of bare histories, where they are known.
    `measured`: b is a measurement of this uncertainty, against which the error of a is told (ASME V&V 20).
    Raises `InputError` naming the answer when there is nothing to
    compare, or when the two do not overlap in time.
    """
    names = names or (_name(a, "a"), _name(b, "b"))
    _check(a, names[0])
    _check(b, names[1])
    sides = (
        side_of(a, names[0], horizons_s[0], uncertainties_rad[0], slip_uncertainties_m[0]),
        side_of(b, names[1], horizons_s[1], uncertainties_rad[1], slip_uncertainties_m[1]),
    )
    until = min(side.until_s for side in sides)
    history_a, history_b = _history(a), _history(b)
    if history_a is None or history_b is None:
        none = events.NO_EXCURSIONS
        return _scores(a, b, sides, None, (_peak_alone(a), _peak_alone(b)), (none, none), None, until)
    both = _paired(history_a, history_b, a, b, names)
    within = both.until(until)
    peaks = pointwise.peak(history_a, within.end_s), pointwise.peak(history_b, within.end_s)
    excursions = events.excursions(history_a), events.excursions(history_b)
    longest_s = max(history_a.duration_s, history_b.duration_s) - both.start_s
    inertia = None if scene is None else RockingInertia.of(scene.statue)
    scores = _scores(a, b, sides, both, peaks, excursions, inertia, until)
    if measured is not None:
        error, said = comparison_error(within, peaks, sides[0].open_rad, measured)
        scores = replace(scores, comparison_error=error, findings=[*scores.findings, said])
    return replace(
        scores,
        compared_from_s=within.start_s,
        compared_until_s=within.end_s,
        coverage=(within.end_s - within.start_s) / longest_s if longest_s > 0.0 else 1.0,
        rms_theta_rad=pointwise.rms(within, within.difference_rad),
        largest_difference_rad=float(np.max(np.abs(within.difference_rad))),
        rms_slip_m=pointwise.rms(within, within.slip_a_m - within.slip_b_m),
        together_until_s=pointwise.together_until_s(both, TOGETHER_RAD),
        **vars(_residuals(a, b, both, until)),
        **vars(pointwise.sprague_geers(within)),
        after_horizon=after_horizon(excursions, both, until),
        iso=rate_by_iso(within) if iso else None,
    )


def _name(answer: Run | History, otherwise: str) -> str:
    return answer.engine if isinstance(answer, Run) else otherwise


def _history(answer: Run | History) -> History | None:
    return answer.history if isinstance(answer, Run) else answer


def _check(answer: Run | History, name: str) -> None:
    if isinstance(answer, Run) and answer.outcome.failed:
        raise InputError(Mistake(name, "", "a run with an answer", f"{answer.outcome.value} ({answer.message})"))
    if isinstance(answer, Run) and not np.isfinite(answer.peak_theta_rad):
        raise InputError(Mistake(name, "peak_theta_rad", "a finite rotation", repr(answer.peak_theta_rad)))


def _paired(history_a: History, history_b: History, a: Run | History, b: Run | History, names: tuple[str, str]) -> Pair:
    try:
        return pair(history_a, history_b, hold_a=_rests(a), hold_b=_rests(b))
    except ValueError as error:
        raise InputError(
            Mistake(f"{names[0]} and {names[1]}", "t_s", "a common stretch of time", str(error))
        ) from error


def _rests(answer: Run | History) -> bool:
    """Whether the run was ended early because nothing moves any more, so that its last value holds."""
    return isinstance(answer, Run) and answer.outcome is Outcome.STANDS


def _peaks(a: pointwise.Peak, b: pointwise.Peak) -> Peaks:
    both_still = a.theta_rad == 0.0 and b.theta_rad == 0.0
    return Peaks(
        peak_theta_a_rad=a.theta_rad,
        peak_theta_b_rad=b.theta_rad,
        peak_ratio=abs(a.theta_rad / b.theta_rad) if b.theta_rad else (1.0 if both_still else None),
        peak_time_difference_s=0.0 if both_still else a.time_s - b.time_s,
    )


def _residuals(a: Run | History, b: Run | History, both: Pair, until_s: float) -> Residuals:
    """Differences of the last values; None beyond the horizon, and where a run did not end standing: nothing has come to rest."""
    stood = all(not isinstance(answer, Run) or answer.outcome is Outcome.STANDS for answer in (a, b))
    known = stood and until_s >= both.end_s
    return Residuals(
        residual_theta_difference_rad=float(both.theta_a_rad[-1] - both.theta_b_rad[-1]) if known else None,
        residual_slip_difference_m=float(both.slip_a_m[-1] - both.slip_b_m[-1]) if known else None,
    )


def _outcomes(a: Run | History, b: Run | History) -> Outcomes:
    first, second = (answer.outcome if isinstance(answer, Run) else None for answer in (a, b))
    times = [answer.no_return_time_s if isinstance(answer, Run) else None for answer in (a, b)]
    agree = side = None
    if first is not None and second is not None:
        agree = first.same_as(second)
        side = first is second if first.overturned and second.overturned else None
    return Outcomes(
        outcome_a=first,
        outcome_b=second,
        outcome_agrees=agree,
        side_agrees=side,
        no_return_time_difference_s=None if times[0] is None or times[1] is None else times[0] - times[1],
    )


def _scores(
    a: Run | History,
    b: Run | History,
    sides: tuple[Side, Side],
    both: Pair | None,
    peaks: tuple[pointwise.Peak, pointwise.Peak],
    excursions: tuple[events.Excursions, events.Excursions],
    inertia: RockingInertia | None,
    until_s: float,
) -> Scores:
    """What can be said of any two answers, also of a run that kept only its outcome; nothing of single instants."""
    judgement = judge(*sides, both, peaks)
    return Scores(
        a=sides[0].name,
        b=sides[1].name,
        horizon_s=until_s if math.isfinite(until_s) else None,
        together_tolerance_rad=TOGETHER_RAD,
        compared_from_s=None,
        compared_until_s=None,
        coverage=None,
        together_until_s=None,
        after_horizon=None,
        **vars(Pointwise(rms_theta_rad=None, largest_difference_rad=None, rms_slip_m=None)),
        **vars(Residuals(residual_theta_difference_rad=None, residual_slip_difference_m=None)),
        **vars(SpragueGeers(None, None, None)),
        **vars(_peaks(*peaks)),
        **vars(event_scores(*excursions, inertia, until_s)),
        **vars(_outcomes(a, b)),
        numerical_uncertainty=numerical_uncertainty(sides, peaks[1].theta_rad, excursions, until_s),
        verdict=judgement.verdict,
        evidence=judgement.evidence,
        findings=judgement.findings,
    )


def _peak_alone(answer: Run | History) -> pointwise.Peak:
    if isinstance(answer, Run):
        return pointwise.Peak(answer.peak_theta_rad, answer.peak_time_s)
    return pointwise.peak(answer)
