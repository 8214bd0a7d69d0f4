"""Two answers to one scene: scored, by how much and from when they differ, and why; knows no engine."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any, Final, Literal

import numpy as np

from harness.comparison.scores import events, pointwise
from harness.comparison.scores.events import Inertia, after_horizon, event_scores, numerical_uncertainty
from harness.comparison.scores.pointwise import Measured, Peak, comparison_error
from harness.comparison.scores.pointwise import rate as rate_by_iso
from harness.comparison.side import Side, side_of
from harness.model.errors import InputError, Mistake
from harness.model.finding import Finding, caution, changes_answer, info
from harness.model.history import Array, History, Pair, first_beyond_s, pair
from harness.model.run import Run
from harness.model.scene import Scene
from harness.records.run import SLIDES_M, STILL_RAD
from harness.records.scores import Evidence, Scores, Verdict

# By how much and from when two runs differ, and why, computed from the record.
#
# Numerical error, model, plane, horizon, an error that is not bounded so far, or a model outside its domain.

COVERAGE: Final = 2.0
"""A difference counts when it exceeds this multiple of the joint uncertainty U = u_a + u_b.

Numerical errors alone never pass U; an effect of three times U still shows as at least 3U − U = 2U. So 2 is the one whole
number that calls no pair of equal models different and misses no effect above three times the uncertainty.
"""


OPEN: Final = frozenset({Verdict.AGREE, Verdict.HORIZON, Verdict.UNBOUNDED})
"""Verdicts with which outcomes that differ decide nothing between the two."""


def judge(a: Side, b: Side, both: Pair | None) -> tuple[Verdict, Evidence, list[Finding]]:
    """The verdict on two answers from their histories on one grid, or from their peaks where a history is missing; the numbers
    that it follows from, and what to know of it.

    Rotations are held against twice the joint uncertainty of the rotations, slips against twice that of the slips; where neither
    statue rocks, however exact the two are, rotations against what no lean is told of.
    """
    turned = max(COVERAGE * (a.open_rad + b.open_rad), STILL_RAD if a.is_still and b.is_still else ROUNDING)
    slid = max(COVERAGE * (a.open_m + b.open_m), ROUNDING)
    until = min(a.until_s, b.until_s)
    facts = from_peaks((a.peak, b.peak), turned, until) if both is None else from_histories(both, turned, slid, until)
    flips = sided = False
    if a.outcome is not None and b.outcome is not None:
        flips = a.outcome is not b.outcome
        sided = flips and a.outcome.same_as(b.outcome)
    if flips:
        # A fall across the plane is none of the planar rotation's: the two part when the statue falls for good.
        times = [side.across_s for side in (a, b) if side.across_s is not None]
        facts = replace(facts, fallen_s=min(times, default=None))
    not_given = _not_given(a, b)
    aside = _aside(a, b) if not_given else {}
    verdict, left = _decide(a, b, facts, flips, aside=bool(aside))
    evidence = Evidence(
        uncertainty_a_rad=a.uncertainty_rad,
        uncertainty_b_rad=b.uncertainty_rad,
        slip_uncertainty_a_m=a.slip_uncertainty_m,
        slip_uncertainty_b_m=b.slip_uncertainty_m,
        resolution_a_rad=a.resolution_rad,
        resolution_b_rad=b.resolution_rad,
        resolution_a_m=a.resolution_m,
        resolution_b_m=b.resolution_m,
        limit_rad=turned,
        slip_limit_m=slid,
        coverage=COVERAGE,
        differs_in=facts.differs_in,
        exceeded_s=facts.exceeded_s,
        largest_difference_rad=facts.rotation.largest,
        largest_reliable_difference_rad=facts.rotation.largest_reliable,
        largest_slip_difference_m=facts.slip.largest,
        largest_reliable_slip_difference_m=facts.slip.largest_reliable,
        horizon_s=until if math.isfinite(until) else None,
        compared_until_s=facts.end_s,
        left_domain_s=None if left is None else left.left_domain_s,
        left_domain="" if left is None else left.name,
        left_domain_by="" if left is None else left.left_domain_by,
        outcome_flips_within_uncertainty=flips and not sided and verdict in OPEN,
        side_flips_within_uncertainty=sided and verdict in OPEN,
        motion_not_given=not_given,
        **(aside if verdict is Verdict.PLANE and facts.exceeded_s is None else {}),
    )
    return verdict, evidence, _findings(verdict, evidence, a, b)


SLIDES: Final = "statue_slides"
"""By what a model left its domain that holds the statue on its support: rotations may agree while the statue slides."""


def _decide(a: Side, b: Side, facts: ComparedFacts, flips: bool, *, aside: bool) -> tuple[Verdict, Side | None]:
    """The verdict, and the side that left its domain where that decides; `aside`: one alone moves across the plane."""
    exits = [side for side in (a, b) if side.left_domain_s is not None]
    first = min(exits, key=lambda side: side.left_domain_s or 0.0, default=None)
    left_s = math.inf if first is None or first.left_domain_s is None else first.left_domain_s
    if facts.exceeded_s is None:
        slides = (
            first is not None and first.left_domain_by == SLIDES and max(a.statue_slip_m, b.statue_slip_m) > SLIDES_M
        )
        if not (flips or slides):
            return (Verdict.PLANE if aside else Verdict.AGREE), None
        if left_s < math.inf:
            return Verdict.DOMAIN, first
        return (_beyond(a, b, facts.end_s) if facts.until_s < facts.end_s else Verdict.AGREE), None
    if facts.exceeded_s <= min(left_s, facts.until_s):
        if (a.uncertainty_rad is None) != (b.uncertainty_rad is None):
            return Verdict.UNBOUNDED, None  # the difference may be the error that is not stated
        return (Verdict.PLANE if _not_given(a, b) else Verdict.MODEL), None
    return (Verdict.DOMAIN, first) if left_s <= facts.until_s else (_beyond(a, b, facts.exceeded_s), None)


def _aside(a: Side, b: Side) -> dict[str, float]:
    """How far the statue leaned out of the plane, rad, by more than its side's error, and slid, m, on the side that alone was
    given the motion across it; empty where it did neither."""
    side = max((a, b), key=lambda each: (each.out_of_plane_rad, each.slip_across_m))
    leans = side.out_of_plane_rad > max(COVERAGE * side.open_rad, STILL_RAD)
    found = {"aside_rad": side.out_of_plane_rad} if leans else {}
    return found | ({"aside_m": side.slip_across_m} if side.slip_across_m > SLIDES_M else {})


def _beyond(a: Side, b: Side, at_s: float) -> Verdict:
    """What a difference at a time past what is known rests on: the problem's own measured sensitivity, or an engine's error."""
    horizon_s = min((side.horizon_s for side in (a, b) if side.horizon_s is not None), default=math.inf)
    return Verdict.HORIZON if at_s > horizon_s else Verdict.UNBOUNDED


def _not_given(a: Side, b: Side) -> dict[str, list[str]]:
    """The axes of the floor's motion that one side was given and the other, by its name, was not."""
    if a.axes is None or b.axes is None:
        return {}
    missing = {a.name: sorted(set(b.axes) - set(a.axes)), b.name: sorted(set(a.axes) - set(b.axes))}
    return {name: axes for name, axes in missing.items() if axes}


CODES: Final = {
    Verdict.AGREE: info("pair_agrees"),
    Verdict.MODEL: changes_answer("pair_differs_by_model"),
    Verdict.PLANE: changes_answer("pair_plane_left_out"),
    Verdict.DOMAIN: caution("pair_left_domain"),
    Verdict.HORIZON: caution("pair_beyond_horizon"),
    Verdict.UNBOUNDED: caution("pair_error_not_bounded"),
}
"""What each verdict says, its values aside."""


def _findings(verdict: Verdict, evidence: Evidence, a: Side, b: Side) -> list[Finding]:
    """The verdict with the values of its sentence, and what is to be known beside it."""
    unstated = [side.name for side in (a, b) if side.uncertainty_rad is None]
    values: dict[str, object] = {
        "a": a.name,
        "b": b.name,
        "difference_rad": evidence.largest_difference_rad,
        "limit_rad": evidence.limit_rad,
        "slip_difference_m": evidence.largest_slip_difference_m,
        "slip_limit_m": evidence.slip_limit_m,
        "differs_in": evidence.differs_in,
        "from_s": evidence.exceeded_s,
        "until_s": evidence.horizon_s,
        "static": [side.name for side in (a, b) if side.floor_impact == "static"],
    }
    said = CODES[verdict]
    known_s = math.inf if evidence.horizon_s is None else evidence.horizon_s
    parted = evidence.exceeded_s is not None and evidence.exceeded_s <= known_s
    if unstated and parted and verdict in (Verdict.MODEL, Verdict.UNBOUNDED):
        said = caution("pair_differs_unstated")
        values["unstated"] = unstated
    elif verdict is Verdict.UNBOUNDED:
        values["unbounded"] = [side.name for side in (a, b) if side.reliable_until_s == evidence.horizon_s]
    if evidence.aside:
        values |= {"differs_in": "aside", "aside_rad": evidence.aside_rad, "aside_m": evidence.aside_m}
    if verdict is Verdict.DOMAIN:
        values |= {"left_s": evidence.left_domain_s, "by": evidence.left_domain_by, "left": evidence.left_domain}
    found = [replace(said, values=values)]
    if evidence.outcome_flips_within_uncertainty:
        found.append(changes_answer("outcome_flips", a=a.name, b=b.name))
    if evidence.side_flips_within_uncertainty:
        found.append(caution("side_flips", a=a.name, b=b.name))
    found += [
        changes_answer("motion_not_given", model=name, axes=list(axes))
        for name, axes in (evidence.motion_not_given or {}).items()
    ]
    slipless = [side.name for side in (a, b) if side.slip_uncertainty_m is None and side.uncertainty_rad is not None]
    if unstated:
        found.append(caution("error_not_stated", models=unstated))
    elif slipless and evidence.largest_slip_difference_m > ROUNDING:
        found.append(caution("slip_error_not_stated", models=slipless))
    found += [
        info("digits_counted", model=side.name, resolution_rad=side.resolution_rad, resolution_m=side.resolution_m)
        for side in (a, b)
        if max(side.resolution_rad, side.resolution_m) > ROUNDING
    ]
    pair = f"{a.name}_vs_{b.name}"
    return [each.of(pair) for each in found]


def shares(verdicts: Iterable[Verdict]) -> dict[str, float]:
    """The share of each verdict over a set; all zero for an empty one."""
    counts = Counter(verdicts)
    total = sum(counts.values())
    return {verdict.value: counts[verdict] / total if total else 0.0 for verdict in Verdict}


ROUNDING: Final = 1e-12
"""Differences below this, rad or m, are rounding of numbers of order one through some thousand operations."""


@dataclass(frozen=True)
class Difference:
    """Of one quantity: when its limit is first exceeded, the largest difference, and the largest before the horizon."""

    exceeded_s: float | None = None
    largest: float = 0.0
    largest_reliable: float = 0.0


@dataclass(frozen=True)
class ComparedFacts:
    """What decides: the differences of rotation, rad, and slip, m, the horizon and the end of what was compared.

    `fallen_s`: when a fall across the plane parts the two, which the planar rotation does not tell.
    """

    rotation: Difference
    slip: Difference
    until_s: float
    end_s: float
    fallen_s: float | None = None

    @property
    def exceeded_s(self) -> float | None:
        """When the two answers part: the first of both quantities exceeds its limit, or one falls across the plane."""
        known = [t for t in (self.rotation.exceeded_s, self.slip.exceeded_s, self.fallen_s) if t is not None]
        return min(known, default=None)

    @property
    def differs_in(self) -> Literal["", "rotation", "slip"]:
        """In what they then differ; empty: in nothing."""
        if self.exceeded_s is None:
            return ""
        return "slip" if self.slip.exceeded_s == self.exceeded_s != self.rotation.exceeded_s else "rotation"


def from_histories(both: Pair, turned_rad: float, slid_m: float, until: float) -> ComparedFacts:
    """From both histories on one grid; `turned_rad` and `slid_m` are the limits, `until` the horizon, s."""

    def of(apart: Array, limit: float) -> Difference:
        inside = both.t_s <= until
        reliable = float(np.max(apart[inside])) if inside.any() else 0.0
        return Difference(first_beyond_s(both.t_s, apart, limit), float(np.max(apart)), reliable)

    rotation = of(np.abs(both.difference_rad), turned_rad)
    return ComparedFacts(rotation, of(np.abs(both.slip_a_m - both.slip_b_m), slid_m), until, both.end_s)


def from_peaks(peaks: tuple[Peak, Peak], turned_rad: float, until: float) -> ComparedFacts:
    """When a larger peak is reached the other rotation is at most its own peak: by then the two are that far apart."""
    # A run without a history may state its peak without a sign.
    smaller, larger = sorted(peaks, key=lambda peak: abs(peak.theta_rad))
    apart = abs(larger.theta_rad) - abs(smaller.theta_rad)
    exceeded = larger.time_s if apart > turned_rad else None
    rotation = Difference(exceeded, apart, apart if larger.time_s <= until else 0.0)
    return ComparedFacts(rotation, Difference(), until, math.inf)


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
    own = [answer.engine if isinstance(answer, Run) else otherwise for answer, otherwise in ((a, "a"), (b, "b"))]
    names = names or (own[0], own[1])
    _check(a, names[0])
    _check(b, names[1])
    sides = (
        side_of(a, names[0], horizons_s[0], uncertainties_rad[0], slip_uncertainties_m[0]),
        side_of(b, names[1], horizons_s[1], uncertainties_rad[1], slip_uncertainties_m[1]),
    )
    until = min(side.until_s for side in sides)
    history_a, history_b = (answer.history if isinstance(answer, Run) else answer for answer in (a, b))
    if history_a is None or history_b is None:
        none = events.NO_EXCURSIONS
        return _scores(sides, None, (sides[0].peak, sides[1].peak), (none, none), None, until)
    try:
        both = pair(history_a, history_b, hold_a=sides[0].rests, hold_b=sides[1].rests)
    except ValueError as error:
        where = f"{names[0]} and {names[1]}"
        raise InputError(Mistake(where, "t_s", "a common stretch of time", str(error))) from error
    within = both.until(until)
    peaks = pointwise.peak(history_a, within.end_s), pointwise.peak(history_b, within.end_s)
    excursions = events.excursions(history_a), events.excursions(history_b)
    # Of what did not end standing nothing has come to rest; beyond the horizon no last value is known.
    rested = all(side.rests or side.outcome is None for side in sides) and until >= both.end_s
    longest_s = max(history_a.duration_s, history_b.duration_s) - both.start_s
    inertia = None if scene is None else scene.pivot_inertia_kg_m2
    scores = _scores(sides, both, peaks, excursions, inertia, until)
    if measured is not None:
        cut_s = within.end_s if within.end_s < both.end_s else None
        compared, said = comparison_error(within, peaks, sides[0].open_rad, measured, cut_s)
        scores = replace(scores, comparison_error=compared, findings=[*scores.findings, said])
    return replace(
        scores,
        compared_from_s=within.start_s,
        compared_until_s=within.end_s,
        coverage=(within.end_s - within.start_s) / longest_s if longest_s > 0.0 else 1.0,
        rms_theta_rad=pointwise.rms(within, within.difference_rad),
        largest_difference_rad=float(np.max(np.abs(within.difference_rad))),
        rms_slip_m=pointwise.rms(within, within.slip_a_m - within.slip_b_m),
        together_until_s=pointwise.together_until_s(both, TOGETHER_RAD),
        residual_theta_difference_rad=float(both.theta_a_rad[-1] - both.theta_b_rad[-1]) if rested else None,
        residual_slip_difference_m=float(both.slip_a_m[-1] - both.slip_b_m[-1]) if rested else None,
        **pointwise.sprague_geers(within),
        after_horizon=after_horizon(excursions, both, until),
        iso=rate_by_iso(within) if iso else None,
    )


def _check(answer: Run | History, name: str) -> None:
    if isinstance(answer, Run) and answer.outcome.failed:
        raise InputError(Mistake(name, "", "a run with an answer", f"{answer.outcome.value} ({answer.message})"))
    if isinstance(answer, Run) and not np.isfinite(answer.peak_theta_rad):
        raise InputError(Mistake(name, "peak_theta_rad", "a finite rotation", repr(answer.peak_theta_rad)))


def _peaks(a: Peak, b: Peak) -> dict[str, Any]:
    both_still = a.theta_rad == 0.0 and b.theta_rad == 0.0
    return {
        "peak_theta_a_rad": a.theta_rad,
        "peak_theta_b_rad": b.theta_rad,
        "peak_ratio": abs(a.theta_rad / b.theta_rad) if b.theta_rad else (1.0 if both_still else None),
        "peak_time_difference_s": 0.0 if both_still else a.time_s - b.time_s,
    }


def _outcomes(a: Side, b: Side) -> dict[str, Any]:
    agree = side = None
    if a.outcome is not None and b.outcome is not None:
        agree = a.outcome.same_as(b.outcome)
        side = a.outcome is b.outcome if a.outcome.overturned and b.outcome.overturned else None
    apart_s = None if a.no_return_s is None or b.no_return_s is None else a.no_return_s - b.no_return_s
    return {
        "outcome_a": a.outcome,
        "outcome_b": b.outcome,
        "outcome_agrees": agree,
        "side_agrees": side,
        "no_return_time_difference_s": apart_s,
    }


def _scores(
    sides: tuple[Side, Side],
    both: Pair | None,
    peaks: tuple[Peak, Peak],
    excursions: tuple[events.Excursions, events.Excursions],
    inertia: Inertia | None,
    until_s: float,
) -> Scores:
    """What can be said of any two answers, also of a run that kept only its outcome; nothing of single instants."""
    verdict, evidence, findings = judge(*sides, both)
    # Where one history has not begun or has ended, no event of the other is missing from it.
    common_s = (-math.inf, until_s) if both is None else (both.start_s, min(both.end_s, until_s))
    return Scores(
        a=sides[0].name,
        b=sides[1].name,
        horizon_s=until_s if math.isfinite(until_s) else None,
        together_tolerance_rad=TOGETHER_RAD,
        **_peaks(*peaks),
        **event_scores(*excursions, inertia, common_s),
        **_outcomes(*sides),
        numerical_uncertainty=numerical_uncertainty(sides, peaks[1].theta_rad, excursions, until_s),
        verdict=verdict,
        evidence=evidence,
        findings=findings,
    )
