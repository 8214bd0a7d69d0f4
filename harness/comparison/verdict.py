"""By how much and from when two runs differ, and why, computed from the record.

Numerical error, model, plane, horizon, an error that is not bounded so far, or a model outside its domain.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np

from harness.comparison.scores.pointwise import Peak
from harness.comparison.side import Side
from harness.model.finding import Finding, caution, changes_answer, info
from harness.model.history import Array, Pair, first_beyond_s
from harness.records.scores import Evidence, Verdict

COVERAGE: Final = 2.0
"""A difference counts when it exceeds this multiple of the joint uncertainty U = u_a + u_b.

Numerical errors alone never pass U; an effect of three times U still shows as at least 3U − U = 2U. So 2 is the one whole
number that calls no pair of equal models different and misses no effect above three times the uncertainty.
"""


OPEN: Final = frozenset({Verdict.AGREE, Verdict.HORIZON, Verdict.UNBOUNDED})
"""Verdicts with which outcomes that differ decide nothing between the two."""


@dataclass(frozen=True)
class Judgement:
    """A verdict with what to know of it and the numbers that it follows from."""

    verdict: Verdict
    findings: Sequence[Finding]
    evidence: Evidence


def judge(a: Side, b: Side, both: Pair | None, peaks: tuple[Peak, Peak]) -> Judgement:
    """The verdict on two answers from their histories on one grid, or from their peaks where a history is missing.

    Rotations are held against twice the joint uncertainty of the rotations, slips against twice that of the slips.
    """
    turned = max(COVERAGE * (a.open_rad + b.open_rad), ROUNDING)
    slid = max(COVERAGE * (a.open_m + b.open_m), ROUNDING)
    until = min(a.until_s, b.until_s)
    facts = from_peaks(peaks, turned, slid, until) if both is None else from_histories(both, turned, slid, until)
    known = a.outcome is not None and b.outcome is not None
    flips = known and a.outcome is not b.outcome
    sided = a.outcome is not None and b.outcome is not None and flips and a.outcome.same_as(b.outcome)
    if flips:
        # A fall across the plane is none of the planar rotation's: the two part when the statue falls for good.
        times = [side.across_s for side in (a, b) if side.across_s is not None]
        facts = replace(facts, fallen_s=min(times, default=None))
    verdict, left = _decide(a, b, facts, flips)
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
        motion_not_given=_not_given(a, b),
    )
    return Judgement(verdict, _findings(verdict, evidence, a, b), evidence)


def _decide(a: Side, b: Side, facts: Facts, flips: bool) -> tuple[Verdict, Side | None]:
    """The verdict, and the side that left its domain where that decides."""
    exits = [side for side in (a, b) if side.left_domain_s is not None]
    first = min(exits, key=lambda side: side.left_domain_s or 0.0, default=None)
    left_s = math.inf if first is None or first.left_domain_s is None else first.left_domain_s
    if facts.exceeded_s is None:
        if not flips:
            return Verdict.AGREE, None
        if left_s < math.inf:
            return Verdict.DOMAIN, first
        return (_beyond(a, b, facts.end_s) if facts.until_s < facts.end_s else Verdict.AGREE), None
    if facts.exceeded_s <= min(left_s, facts.until_s):
        if (a.uncertainty_rad is None) != (b.uncertainty_rad is None):
            return Verdict.UNBOUNDED, None  # the difference may be the error that is not stated
        return (Verdict.PLANE if _not_given(a, b) else Verdict.MODEL), None
    return (Verdict.DOMAIN, first) if left_s <= facts.until_s else (_beyond(a, b, facts.exceeded_s), None)


def _beyond(a: Side, b: Side, at_s: float) -> Verdict:
    """What a difference at a time past what is known rests on: the problem's own measured sensitivity, or an engine's error."""
    return Verdict.HORIZON if at_s > _horizon_s(a, b) else Verdict.UNBOUNDED


def _horizon_s(a: Side, b: Side) -> float:
    return min((side.horizon_s for side in (a, b) if side.horizon_s is not None), default=math.inf)


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
    """Of one quantity: the limit, when it is first exceeded, the largest difference, and the largest before the horizon."""

    limit: float
    exceeded_s: float | None = None
    largest: float = 0.0
    largest_reliable: float = 0.0


@dataclass(frozen=True)
class Facts:
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


def from_histories(both: Pair, turned_rad: float, slid_m: float, until: float) -> Facts:
    """From both histories on one grid; `turned_rad` and `slid_m` are the limits, `until` the horizon, s."""

    def of(apart: Array, limit: float) -> Difference:
        inside = both.t_s <= until
        reliable = float(np.max(apart[inside])) if inside.any() else 0.0
        return Difference(limit, first_beyond_s(both.t_s, apart, limit), float(np.max(apart)), reliable)

    rotation = of(np.abs(both.difference_rad), turned_rad)
    return Facts(rotation, of(np.abs(both.slip_a_m - both.slip_b_m), slid_m), until, both.end_s)


def from_peaks(peaks: tuple[Peak, Peak], turned_rad: float, slid_m: float, until: float) -> Facts:
    """When a larger peak is reached the other rotation is at most its own peak: by then the two are that far apart."""
    # A run without a history may state its peak without a sign.
    smaller, larger = sorted(peaks, key=lambda peak: abs(peak.theta_rad))
    apart = abs(larger.theta_rad) - abs(smaller.theta_rad)
    exceeded = larger.time_s if apart > turned_rad else None
    rotation = Difference(turned_rad, exceeded, apart, apart if larger.time_s <= until else 0.0)
    return Facts(rotation, Difference(slid_m), until, math.inf)
