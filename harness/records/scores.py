"""The scores of one pair of answers, as the comparator gives them and as they stand in a record."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from enum import StrEnum
from typing import Final, Literal

from harness.model import OMITTED, Axes, Finding, Outcome, Say, Shown, new_axes, texted
from harness.records.base import Record

# The record of two histories from files, compared; both lie beside it in the contract's units.

FILES: Final = ("history_a.csv", "history_b.csv")
"""The two histories beside the record, the reference second."""


@dataclass(frozen=True, kw_only=True, eq=False)
class CompareRecord(Record):
    """`result.json` of `rockcheck compare A.csv B.csv --out DIR`."""

    kind: Literal["compare"] = "compare"
    scores: Scores

    def texted(self, say: Say) -> CompareRecord:
        """The record with its sentences."""
        return replace(super().texted(say), scores=self.scores.texted(say))


CONFIDENCE: Final = 0.95
"""Probability of the intervals that are stated beside scores and statistics."""
ONE_NUMBER: Final = frozenset({"float", "int", "float | None", "bool | None"})
"""Types of scores that are one number, where they are defined."""


class Verdict(StrEnum):
    """Why two answers differ, if they do."""

    AGREE = "agree within numerical error"
    MODEL = "differ: model"
    HORIZON = "differ: beyond the horizon"
    DOMAIN = "differ: the model left its domain"
    PLANE = "differ: the plane left out"
    UNBOUNDED = "differ: numerical error not bounded"


ROBUST: Final = frozenset({Verdict.MODEL, Verdict.PLANE})
"""Verdicts that no numerical error and no sensitivity explains."""


@dataclass(frozen=True, kw_only=True)
class Evidence:
    """The numbers that a verdict follows from; of an older record some are not known."""

    uncertainty_a_rad: float | None
    uncertainty_b_rad: float | None
    slip_uncertainty_a_m: float | None = None
    slip_uncertainty_b_m: float | None = None
    resolution_a_rad: float = 0.0
    resolution_b_rad: float = 0.0
    resolution_a_m: float = 0.0
    resolution_b_m: float = 0.0
    limit_rad: float
    slip_limit_m: float = 0.0
    coverage: float
    differs_in: Literal["", "rotation", "slip"] = ""
    exceeded_s: float | None
    largest_difference_rad: float
    largest_reliable_difference_rad: float
    largest_slip_difference_m: float = 0.0
    largest_reliable_slip_difference_m: float = 0.0
    horizon_s: float | None
    compared_until_s: float | None
    left_domain_s: float | None
    left_domain_by: str
    """Which limit was passed (a code of `analytic.problem.LEFT_BY`), or the outcome with which a run left it, and"""
    left_domain: str = ""
    """of which answer."""
    outcome_flips_within_uncertainty: bool
    side_flips_within_uncertainty: bool = False
    motion_not_given: Mapping[str, Sequence[str]] | None = None
    aside_rad: float = 0.0
    aside_m: float = 0.0
    """How far the statue leaned out of the plane, and slid, where that alone is what the plane leaves out."""

    @property
    def aside(self) -> bool:
        """Whether the two agree in the plane, and one moves across it, of which the other was given no motion."""
        return bool(self.aside_rad or self.aside_m)


@dataclass(frozen=True)
class Apart:
    """Two distributions: the area between them, rad, and Kolmogorov and Smirnov's distance."""

    area_rad: float
    ks: float


@dataclass(frozen=True)
class Interval:
    """An estimate with its two-sided confidence interval."""

    value: float
    low: float
    high: float
    confidence: float = CONFIDENCE


@dataclass(frozen=True, kw_only=True)
class PeaksApart:
    """The distributions of peaks; the interval, what chance alone would give and its probability only of enough excursions."""

    area_rad: float
    area_interval_rad: Interval | None = field(default=None, metadata=OMITTED)
    area_by_chance_rad: float | None = field(default=None, metadata=OMITTED)
    ks: float
    ks_p: float | None = field(default=None, metadata=OMITTED)


@dataclass(frozen=True, kw_only=True)
class AfterHorizon:
    """Two histories beyond the horizon, where only distributions compare (`harness.comparison.scores`)."""

    from_s: float
    until_s: float
    largest_a_rad: float
    largest_b_rad: float
    last_difference_rad: float
    last_slip_difference_m: float
    rotation: Apart
    excursions_a: int
    excursions_b: int
    peaks: PeaksApart | None


@dataclass(frozen=True, kw_only=True)
class IsoRating:
    """The rating by ISO/TS 18571; 1 is perfect."""

    corridor: float
    phase: float
    magnitude: float
    slope: float
    overall: float
    resampled_dt_s: float
    samples: int


@dataclass(frozen=True, kw_only=True)
class ComparisonError:
    """The largest rotation simulated (S) and measured (D), E = S − D, over the history its rms and the share of the time in which
    |E| exceeds 2 u_val, and the standard uncertainties of ASME V&V 20: u_val² = u_num² + u_input² + u_D².
    """

    simulated_rad: float
    measured_rad: float
    error_rad: float
    rms_error_rad: float
    beyond_share: float
    u_num_rad: float
    u_input_rad: float
    u_data_rad: float
    u_val_rad: float


@dataclass(frozen=True, kw_only=True, repr=False)
class Scores(Shown):
    """How far answer a is from answer b (the reference); None where a score is not defined or a history is missing.

    Times in s, rotations in rad, differences a − b. Every score of instants
    (differences, peaks, events, magnitude, phase, ISO, residuals) is taken from `compared_from_s` to `compared_until_s`, at most
    up to `horizon_s`, the earlier of both sides' horizons (None: neither has one); `after_horizon` compares distributions beyond
    it, where no instant of one can be asked of the other. `impact_*` are over matched impacts, `*_alone_*` count those without a
    partner; `together_until_s`, outcomes and no-return times are of the whole runs. `numerical_uncertainty` gives, beside each
    score, what the stated numerical errors of both sides can change in it. `comparison_error` holds a against a measured b.
    """

    # The two names and the stretch of time in which instants are compared.
    a: str
    b: str
    compared_from_s: float | None = None
    compared_until_s: float | None = None
    coverage: float | None = None
    horizon_s: float | None
    # Differences sample by sample.
    rms_theta_rad: float | None = None
    largest_difference_rad: float | None = None
    rms_slip_m: float | None = None
    # The largest rotations.
    peak_theta_a_rad: float
    peak_theta_b_rad: float
    peak_ratio: float | None
    peak_time_difference_s: float | None
    # How long the two stay within a tolerance.
    together_until_s: float | None = None
    together_tolerance_rad: float
    # Matched uplifts and impacts.
    uplift_time_differences_s: Sequence[float]
    uplifts_alone_a: int
    uplifts_alone_b: int
    impact_times_a_s: Sequence[float]
    impact_time_differences_s: Sequence[float]
    impacts_alone_a: int
    impacts_alone_b: int
    impact_energy_share_lost_a: Sequence[float | None]
    impact_energy_share_lost_b: Sequence[float | None]
    impact_energy_lost_a_j: Sequence[float | None] | None
    impact_energy_lost_b_j: Sequence[float | None] | None
    # Differences of the last values.
    residual_theta_difference_rad: float | None = None
    residual_slip_difference_m: float | None = None
    # By Sprague and Geers, 0 is perfect: M and C are None when the reference never moves, P and C when either does not.
    magnitude: float | None = None
    phase: float | None = None
    combined: float | None = None
    # How both ended; `outcome_agrees` for two falls whichever way; `side_agrees` is of falls alone.
    outcome_a: Outcome | None
    outcome_b: Outcome | None
    outcome_agrees: bool | None
    side_agrees: bool | None = None
    no_return_time_difference_s: float | None
    # The whole.
    after_horizon: AfterHorizon | None = None
    numerical_uncertainty: Mapping[str, float | None]
    verdict: Verdict
    evidence: Evidence
    iso: IsoRating | None = None
    comparison_error: ComparisonError | None = field(default=None, metadata=OMITTED)
    findings: Sequence[Finding] = ()
    """The verdict with its values, and what is to be known beside it."""
    verdict_sentence: str = ""
    """The first finding's sentence, in a record; empty before."""

    def texted(self, say: Say) -> Scores:
        """The scores with the sentences of their findings."""
        said = texted(self.findings, say)
        return replace(self, findings=said, verdict_sentence=said[0].text if said else "")

    def facts(self) -> dict[str, str]:
        """The verdict."""
        return {"pair": f"{self.a} against {self.b}", "verdict": self.verdict.value}

    def columns(self) -> dict[str, list[str] | list[float]]:
        """Every score that is one number, and what the stated numerical errors can change in it (NaN: not defined)."""
        names = [each.name for each in fields(self) if each.type in ONE_NUMBER]
        return {
            "score": names,
            "value": [_number(getattr(self, name)) for name in names],
            "error": [_number(self.numerical_uncertainty.get(name)) for name in names],
        }

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the largest differences as multiples of the limits that the verdict holds them against: beyond 1 they count."""
        ax, evidence = new_axes(ax), self.evidence
        parts = {
            "rotation": (evidence.largest_difference_rad, evidence.limit_rad),
            "slip": (evidence.largest_slip_difference_m, evidence.slip_limit_m),
        }
        shares = {name: size / limit for name, (size, limit) in parts.items() if limit > 0.0}
        ax.barh([*shares], [*shares.values()])
        ax.axvline(1.0, color="black", linestyle="--")
        ax.set(xlabel="largest difference / what numerical errors explain", xscale="symlog", title=self.verdict.value)
        return ax


def _number(value: float | None) -> float:
    return math.nan if value is None else float(value)
