"""Two answers to one scene: scored, by how much and from when they differ, and why; knows no engine."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from harness.comparison.scores import (
    NO_EXCURSIONS,
    Excursions,
    Inertia,
    Measured,
    Peak,
    after_horizon,
    comparison_error,
    event_scores,
    excursions_of,
    peak_of,
    rate_by_iso,
    rms,
    sprague_geers,
    together_until_s,
)
from harness.input.history_file import UNIFORM, between_samples, gaps, read_history
from harness.model import (
    Finding,
    History,
    Outcome,
    Pair,
    Run,
    Scene,
    caution,
    changes_answer,
    first_beyond_s,
    info,
    machine,
    number,
    pair,
    require,
    translated,
    versions,
)
from harness.records.base import COMING, PAGES, RECORD, check_folder, check_inputs, write_whole
from harness.records.run import SLIDES_M, STILL_RAD, standing
from harness.records.scores import FILES, CompareRecord, Evidence, Scores, Verdict

if TYPE_CHECKING:
    from harness.records.study import CaseRun


# What a verdict knows of one of its two answers.

ACROSS: Final = (Outcome.OVERTURNED_FRONT, Outcome.OVERTURNED_BACK)
"""Falls of which the rotation in the rocking plane tells nothing."""


@dataclass(frozen=True)
class Side:
    """What the verdict needs to know of one run; None: not stated.

    `uncertainty_rad` and `slip_uncertainty_m` bound the numerical errors up to `reliable_until_s`; `horizon_s` is how far the
    model's own perturbed starts stay together; `left_domain_s` is when the model first broke one of its assumptions (infinite:
    never), `left_domain_by` which. `axes` are the axes of the floor's motion that it was given; `across_s` is when it
    left the rocking plane's balance across it: fell for good over its front or back, or ends leaning beyond it.
    `resolution_rad` and `resolution_m` are how far the digits of a file leave its history open. `floor_impact` is the coefficient
    of the floor that an engine takes at impacts, whatever the scene's choice; empty of one that takes the scene's.
    Of what no slip and no rotation that is compared tells, `statue_slip_m` is how far a statue that stands slid on its support,
    `slip_across_m` how far it slid across the plane, alone or with its pedestal, `out_of_plane_rad` how far it left the plane.
    """

    name: str
    peak: Peak
    outcome: Outcome | None = None
    uncertainty_rad: float | None = None
    slip_uncertainty_m: float | None = None
    reliable_until_s: float | None = None
    horizon_s: float | None = None
    left_domain_s: float = math.inf
    left_domain_by: str = ""
    axes: tuple[str, ...] | None = None
    across_s: float | None = None
    resolution_rad: float = 0.0
    resolution_m: float = 0.0
    floor_impact: str = ""
    statue_slip_m: float = 0.0
    slip_across_m: float = 0.0
    out_of_plane_rad: float = 0.0
    no_return_s: float | None = None

    @property
    def rests(self) -> bool:
        """Whether the run was ended early because nothing moves any more, so that its last value holds."""
        return self.outcome is Outcome.STANDS

    @property
    def open_rad(self) -> float:
        """How far the rotation may be off: its numerical error, zero where none is stated, and the digits it was written with."""
        return (self.uncertainty_rad or 0.0) + self.resolution_rad

    @property
    def open_m(self) -> float:
        """The same of the slip."""
        return (self.slip_uncertainty_m or 0.0) + self.resolution_m

    @property
    def until_s(self) -> float:
        """The time up to which this side's uncertainty holds and its problem is predictable."""
        known = [t for t in (self.reliable_until_s, self.horizon_s) if t is not None]
        return min(known, default=math.inf)


def side_of(
    answer: Run | CaseRun | History,
    name: str,
    horizon_s: float | None = None,
    uncertainty_rad: float | None = None,
    slip_uncertainty_m: float | None = None,
) -> Side:
    """What is known of one answer; a bare history states no outcome, and of its uncertainties only what is given here."""
    if isinstance(answer, History):
        return Side(
            name,
            peak_of(answer),
            uncertainty_rad=uncertainty_rad,
            slip_uncertainty_m=slip_uncertainty_m,
            horizon_s=horizon_s,
            resolution_rad=answer.resolution_rad,
            resolution_m=answer.resolution_m,
        )
    left_s, by = left_domain(answer)
    return Side(
        name,
        Peak(answer.peak_theta_rad, math.nan if answer.peak_time_s is None else answer.peak_time_s),
        answer.outcome,
        answer.numerical_uncertainty_rad,
        answer.slip_uncertainty_m,
        answer.reliable_until_s,
        horizon_s,
        math.inf if left_s is None else left_s,
        by,
        None if answer.motion_axes is None else tuple(answer.motion_axes),
        _across_s(answer),
        floor_impact=str(answer.settings.get("floor_impact") or "") if isinstance(answer, Run) else "",
        statue_slip_m=standing(answer, "statue_slip_m") or 0.0,
        slip_across_m=number(answer.validity, "slip_across_m", 0.0),
        out_of_plane_rad=number(answer.validity, "out_of_plane_rad", 0.0),
        no_return_s=answer.no_return_time_s,
    )


def _across_s(run: Run | CaseRun) -> float | None:
    """When a run's statue left its balance across the rocking plane, untold by its rotation in that plane; else None."""
    if run.outcome in ACROSS:
        return run.no_return_time_s
    history = run.history if isinstance(run, Run) else None
    if run.outcome is not Outcome.UNDECIDED or history is None or "roll_rad" not in history.extra:
        return None
    return run.end_s if abs(history.extra["roll_rad"][-1]) > abs(history.theta_rad[-1]) else None


def left_domain(run: Run | CaseRun) -> tuple[float | None, str]:
    """When a run first left its model's domain (docs/model.md, section 5) and by what; (None, "") when it never did.

    By what is a code of `analytic.problem.LEFT_BY` or an outcome. Engines state it as `validity["left_domain_s"]` and
    `validity["left_domain_by"]`; a run that ends by lift-off or in the friction paradox leaves at its end.
    """
    stated = run.validity.get("left_domain_s")
    if isinstance(stated, (int, float)):
        return float(stated), str(run.validity.get("left_domain_by") or "")
    if run.outcome in (Outcome.LIFT_OFF, Outcome.FRICTION_PARADOX):
        return run.end_s, run.outcome.value
    return None, ""


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
    # Two statues that stand and are not said to rock, in the plane or out of it.
    still = all(side.rests and max(abs(side.peak.theta_rad), side.out_of_plane_rad) < STILL_RAD for side in (a, b))
    turned = max(COVERAGE * (a.open_rad + b.open_rad), STILL_RAD if still else ROUNDING)
    slid = max(COVERAGE * (a.open_m + b.open_m), ROUNDING)
    until_s = min(a.until_s, b.until_s)
    rotation, slip = differences(a, b, both, (turned, slid), until_s)
    parted_s = [rotation.exceeded_s, slip.exceeded_s]
    alike = _alike(a, b)
    flips = alike is not None and a.outcome is not b.outcome
    sided = flips and alike is True
    if flips:
        # A fall across the plane is none of the planar rotation's: the two part when the statue falls for good.
        parted_s += [a.across_s, b.across_s]
    exceeded_s = min((time_s for time_s in parted_s if time_s is not None), default=None)
    slips = slip.exceeded_s is not None and slip.exceeded_s == exceeded_s != rotation.exceeded_s
    not_given = _not_given(a, b)
    aside = _aside(a, b) if not_given else {}
    end_s = math.inf if both is None else both.end_s
    verdict, left = _decide(a, b, exceeded_s, end_s, flips, aside=bool(aside))
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
        differs_in="" if exceeded_s is None else "slip" if slips else "rotation",
        exceeded_s=exceeded_s,
        largest_difference_rad=rotation.largest,
        largest_reliable_difference_rad=rotation.largest_reliable,
        largest_slip_difference_m=slip.largest,
        largest_reliable_slip_difference_m=slip.largest_reliable,
        horizon_s=until_s if math.isfinite(until_s) else None,
        compared_until_s=end_s,
        left_domain_s=None if left is None else left.left_domain_s,
        left_domain="" if left is None else left.name,
        left_domain_by="" if left is None else left.left_domain_by,
        outcome_flips_within_uncertainty=flips and not sided and verdict in OPEN,
        side_flips_within_uncertainty=sided and verdict in OPEN,
        motion_not_given=not_given,
        **(aside if verdict is Verdict.PLANE and exceeded_s is None else {}),
    )
    return verdict, evidence, _findings(verdict, evidence, a, b)


def _alike(a: Side, b: Side) -> bool | None:
    """Whether both statues stand or both fall, whichever way; None where a side states no outcome."""
    return None if a.outcome is None or b.outcome is None else a.outcome.same_as(b.outcome)


SLIDES: Final = "statue_slides"
"""By what a model left its domain that holds the statue on its support: rotations may agree while the statue slides."""


def _decide(
    a: Side, b: Side, exceeded_s: float | None, end_s: float, flips: bool, *, aside: bool
) -> tuple[Verdict, Side | None]:
    """The verdict, and the side that left its domain where that decides; `aside`: one alone moves across the plane."""
    first = min((a, b), key=lambda side: side.left_domain_s)
    left_s, until_s = first.left_domain_s, min(a.until_s, b.until_s)
    if exceeded_s is None:
        slides = first.left_domain_by == SLIDES and max(a.statue_slip_m, b.statue_slip_m) > SLIDES_M
        if not (flips or slides):
            return (Verdict.PLANE if aside else Verdict.AGREE), None
        if left_s < math.inf:
            return Verdict.DOMAIN, first
        return (_beyond(a, b, end_s) if until_s < end_s else Verdict.AGREE), None
    # When a peak that is yet to come parts the two is not known (NaN): where nothing ends what is compared, it is within.
    if exceeded_s <= (known_s := min(left_s, until_s)) or known_s == math.inf:
        if (a.uncertainty_rad is None) != (b.uncertainty_rad is None):
            return Verdict.UNBOUNDED, None  # the difference may be the error that is not stated
        return (Verdict.PLANE if _not_given(a, b) else Verdict.MODEL), None
    return (Verdict.DOMAIN, first) if left_s <= until_s else (_beyond(a, b, exceeded_s), None)


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


def differences(
    a: Side, b: Side, both: Pair | None, limits: tuple[float, float], until_s: float
) -> tuple[Difference, Difference]:
    """Of the rotation, rad, and of the slip, m, each held against its limit; `until_s` is the horizon."""
    if both is None:
        # When a larger peak is reached the other rotation is at most its own peak: by then the two are that far apart. A run
        # without a history may state its peak without a sign.
        smaller, larger = sorted((a.peak, b.peak), key=lambda each: abs(each.theta_rad))
        apart = abs(larger.theta_rad) - abs(smaller.theta_rad)
        exceeded_s = larger.time_s if apart > limits[0] else None
        return Difference(exceeded_s, apart, apart if larger.time_s <= until_s else 0.0), Difference()
    reliable = both.t_s <= until_s
    sizes = np.abs(both.difference_rad), np.abs(both.slip_a_m - both.slip_b_m)
    rotation, slip = (
        Difference(first_beyond_s(both.t_s, size, limit), float(size.max()), float(size[reliable].max(initial=0.0)))
        for size, limit in zip(sizes, limits, strict=True)
    )
    return rotation, slip


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
    name_a, name_b = names or (a.engine if isinstance(a, Run) else "a", b.engine if isinstance(b, Run) else "b")
    for answer, name in ((a, name_a), (b, name_b)):
        if isinstance(answer, Run):
            ended, peak_rad = f"{answer.outcome.value} ({answer.message})", answer.peak_theta_rad
            require(not answer.outcome.failed, name, "a run with an answer", ended)
            require(math.isfinite(peak_rad), name, "a finite rotation", repr(peak_rad), key="peak_theta_rad")
    sides = (
        side_of(a, name_a, horizons_s[0], uncertainties_rad[0], slip_uncertainties_m[0]),
        side_of(b, name_b, horizons_s[1], uncertainties_rad[1], slip_uncertainties_m[1]),
    )
    until = min(side.until_s for side in sides)
    history_a, history_b = (answer.history if isinstance(answer, Run) else answer for answer in (a, b))
    if history_a is None or history_b is None:
        return _scores(sides, None, (sides[0].peak, sides[1].peak), (NO_EXCURSIONS, NO_EXCURSIONS), None, until)
    with translated(ValueError, f"{name_a} and {name_b}", "a common stretch of time", key="t_s"):
        both = pair(history_a, history_b, hold_a=sides[0].rests, hold_b=sides[1].rests)
    within = both.until(until)
    peaks = peak_of(history_a, within.end_s), peak_of(history_b, within.end_s)
    excursions = excursions_of(history_a), excursions_of(history_b)
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
        rms_theta_rad=rms(within, within.difference_rad),
        largest_difference_rad=float(np.max(np.abs(within.difference_rad))),
        rms_slip_m=rms(within, within.slip_a_m - within.slip_b_m),
        together_until_s=together_until_s(both, TOGETHER_RAD),
        residual_theta_difference_rad=float(both.theta_a_rad[-1] - both.theta_b_rad[-1]) if rested else None,
        residual_slip_difference_m=float(both.slip_a_m[-1] - both.slip_b_m[-1]) if rested else None,
        **sprague_geers(within),
        after_horizon=after_horizon(excursions, both, until),
        iso=rate_by_iso(within) if iso else None,
    )


def _scores(
    sides: tuple[Side, Side],
    both: Pair | None,
    peaks: tuple[Peak, Peak],
    excursions: tuple[Excursions, Excursions],
    inertia: Inertia | None,
    until_s: float,
) -> Scores:
    """What can be said of any two answers, also of a run that kept only its outcome; nothing of single instants."""
    verdict, evidence, findings = judge(*sides, both)
    # Where one history has not begun or has ended, no event of the other is missing from it.
    common_s = (-math.inf, until_s) if both is None else (both.start_s, min(both.end_s, until_s))
    (a, b), (peak_a, peak_b) = sides, peaks
    still = peak_a.theta_rad == peak_b.theta_rad == 0.0
    fell = [side.outcome for side in sides if side.outcome is not None and side.outcome.overturned]
    apart_s = None if a.no_return_s is None or b.no_return_s is None else a.no_return_s - b.no_return_s
    return Scores(
        a=a.name,
        b=b.name,
        horizon_s=until_s if math.isfinite(until_s) else None,
        together_tolerance_rad=TOGETHER_RAD,
        peak_theta_a_rad=peak_a.theta_rad,
        peak_theta_b_rad=peak_b.theta_rad,
        peak_ratio=abs(peak_a.theta_rad / peak_b.theta_rad) if peak_b.theta_rad else (1.0 if still else None),
        peak_time_difference_s=0.0 if still else peak_a.time_s - peak_b.time_s,
        **event_scores(*excursions, inertia, common_s),
        outcome_a=a.outcome,
        outcome_b=b.outcome,
        outcome_agrees=_alike(a, b),
        side_agrees=fell[0] is fell[1] if len(fell) == len(sides) else None,
        no_return_time_difference_s=apart_s,
        numerical_uncertainty=numerical_uncertainty(sides, peak_b.theta_rad, excursions, until_s),
        verdict=verdict,
        evidence=evidence,
        findings=findings,
    )


def numerical_uncertainty(
    sides: tuple[Side, Side],
    peak_b_rad: float,
    excursions: tuple[Excursions, Excursions],
    until_s: float = math.inf,
) -> dict[str, float | None]:
    """What the stated numerical errors can change in each score, while they hold; None where one is not stated.

    A rotation known to u moves a root mean square and a difference of peaks by at most u_a + u_b, an impact by u/|θ̇⁻|; a slip
    known to u moves its root mean square by as much.
    """
    u_a, u_b = sides[0].uncertainty_rad, sides[1].uncertainty_rad
    joint = None if u_a is None or u_b is None else u_a + u_b
    slips = sides[0].slip_uncertainty_m, sides[1].slip_uncertainty_m
    rates = [np.abs(each.rate_before_rad_s[each.landed & (each.impact_s <= until_s)]) for each in excursions]
    slowest = [float(np.nanmin(each)) if np.isfinite(each).any() else None for each in rates]
    times = [u / rate if u is not None and rate else None for u, rate in zip((u_a, u_b), slowest, strict=True)]
    return {
        "rms_theta_rad": joint,
        "largest_difference_rad": joint,
        "peak_theta_a_rad": u_a,
        "peak_theta_b_rad": u_b,
        "peak_ratio": joint / abs(peak_b_rad) if joint is not None and peak_b_rad else None,
        "rms_slip_m": None if slips[0] is None or slips[1] is None else slips[0] + slips[1],
        "impact_times_a_s": times[0],
        "impact_times_b_s": times[1],
    }


# Two histories from files, of whatever software, scored.


def compare_files(
    a: Path | str,
    b: Path | str,
    *,
    uncertainty_rad: float | None = None,
    slip_uncertainty_m: float | None = None,
    iso: bool = False,
    measured: Measured | None = None,
) -> Scores:
    """Score history file a against history file b, the reference, of whatever software; raises `InputError`.

    >>> scores = harness.compare_files("mine.csv", "theirs.csv")

    `uncertainty_rad` and `slip_uncertainty_m` are the numerical errors of either rotation and slip, where they are known.
    `measured` are the uncertainties where b is a measurement: a alone has a numerical error then.
    """
    require(
        slip_uncertainty_m is None or 0.0 <= slip_uncertainty_m < math.inf,
        "--slip-uncertainty",
        "a length from 0 m",
        f"{slip_uncertainty_m!r}",
    )
    require(
        uncertainty_rad is None or 0.0 <= uncertainty_rad < 1.0,
        "--uncertainty",
        "a rotation from 0 to 1 rad",
        f"{uncertainty_rad!r}",
    )
    a, b = Path(a), Path(b)
    histories = [read_history(a), read_history(b)]
    a_s, b_s = (history.t_s for history in histories)
    if a_s.size != b_s.size or not np.allclose(a_s, b_s, rtol=UNIFORM, atol=UNIFORM):
        # What lies open between samples counts as the history's resolution.
        histories = [
            replace(
                history,
                resolution_rad=history.resolution_rad + between_samples(history.theta_rad, history.t_s),
                resolution_m=history.resolution_m + between_samples(history.slip_m, history.t_s),
            )
            for history in histories
        ]
    scores = compare(
        *histories,
        names=(a.name, b.name) if a.name != b.name else (str(a), str(b)),
        uncertainties_rad=(uncertainty_rad, uncertainty_rad if measured is None else None),
        slip_uncertainties_m=(slip_uncertainty_m, slip_uncertainty_m),
        iso=iso,
        measured=measured,
    )
    begin_s, end_s = scores.compared_from_s, scores.compared_until_s
    if begin_s is not None and end_s is not None:
        where, got = f"{a.name} and {b.name}", f"one common instant at {begin_s:g} s"
        require(end_s > begin_s, where, "a common stretch of time", got, key="t_s")
    missing = [
        caution("no_samples", file=path.name, from_s=begin, until_s=end)
        for path, history in zip((a, b), histories, strict=True)
        for begin, end in gaps(history)
    ]
    return replace(scores, findings=(*scores.findings, *missing))


def write_comparison(a: Path, b: Path, scores: Scores, folder: Path, asked: Sequence[str] | None = None) -> None:
    """Write the scores of two files, by these options of the command, with both histories, into a result folder; raises
    `InputError` rather than lose a file."""
    names = [*PAGES, RECORD, COMING, *FILES]
    check_inputs(folder, names, (a, b))
    check_folder(folder, ("compare",), names)
    record = CompareRecord(
        title=f"{scores.a} against {scores.b}", scores=scores, asked=asked, versions=versions(), machine=machine()
    )

    def write(fresh: Path) -> None:
        for path, name in zip((a, b), FILES, strict=True):
            read_history(path).write_csv(fresh / name)

    write_whole(folder, record, write)
