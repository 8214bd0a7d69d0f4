"""The scores of one pair of answers, as they stand in the record."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

from harness.comparison.verdict import Verdict
from harness.model.history import Outcome
from harness.model.run import to_plain


@dataclass(frozen=True, eq=False)
class Scores:
    """How far answer a is from answer b (the reference); None where a score is not defined or a history is missing.

    Times in s, rotations in rad, differences a − b. Every score of instants (differences, peaks, events, magnitude, phase, ISO,
    residuals) is taken from `compared_from_s` to `compared_until_s`, at most up to `horizon_s`, the earlier of both sides'
    horizons (None: neither has one); `after_horizon` compares distributions beyond it, where no instant of one can be asked of
    the other. `impact_*` are over matched impacts, `*_alone_*` count those without a partner; `together_until_s`, outcomes and
    no-return times are of the whole runs. `outcome_agrees` for two falls whichever way; `side_agrees` is of falls alone.
    `numerical_uncertainty` gives, beside each score, what the stated numerical errors of both sides can change in it.
    """

    a: str
    b: str
    compared_from_s: float | None
    compared_until_s: float | None
    coverage: float | None
    horizon_s: float | None
    rms_theta_rad: float | None
    largest_difference_rad: float | None
    rms_slip_m: float | None
    peak_theta_a_rad: float
    peak_theta_b_rad: float
    peak_ratio: float | None
    peak_time_difference_s: float | None
    together_until_s: float | None
    together_tolerance_rad: float
    uplift_time_differences_s: Sequence[float]
    uplifts_alone_a: int
    uplifts_alone_b: int
    impact_times_a_s: Sequence[float]
    impact_time_differences_s: Sequence[float]
    impacts_alone_a: int
    impacts_alone_b: int
    impact_energy_share_lost_a: Sequence[float]
    impact_energy_share_lost_b: Sequence[float]
    impact_energy_lost_a_j: Sequence[float] | None
    impact_energy_lost_b_j: Sequence[float] | None
    residual_theta_difference_rad: float | None
    residual_slip_difference_m: float | None
    magnitude: float | None
    phase: float | None
    combined: float | None
    outcome_a: Outcome | None
    outcome_b: Outcome | None
    outcome_agrees: bool | None
    side_agrees: bool | None
    no_return_time_difference_s: float | None
    after_horizon: Mapping[str, Any] | None
    numerical_uncertainty: Mapping[str, Any]
    verdict: Verdict
    verdict_sentence: str
    evidence: Mapping[str, Any]
    iso: Mapping[str, Any] | None = None

    def as_dict(self) -> dict[str, Any]:
        """All scores as plain JSON values."""
        plain: dict[str, Any] = to_plain({field.name: getattr(self, field.name) for field in fields(self)})
        return plain
