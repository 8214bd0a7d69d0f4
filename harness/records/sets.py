"""Scores of many cases, as statistics give them and as they stand in the records of studies and validations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from harness.model.finding import Finding, caution, info
from harness.records.scores import Interval


@dataclass(frozen=True)
class OutcomeScores:
    """Scores of a set of predicted outcomes; `positive` means overturned, whichever way.

    `confusion[observed][predicted]` counts by side over all decided cases that are not within the uncertainty;
    `side_accuracy` is the share of those with the very same outcome, where the side is known. Scores without meaning (no
    positive predicted, ...) are None. Proportions carry Wilson's interval, F1 and Matthews' correlation the bootstrap's.
    """

    cases: int
    undecided: int
    within_uncertainty: int
    confusion: Mapping[str, Mapping[str, int]]
    accuracy: Interval | None
    side_accuracy: Interval | None
    precision: Interval | None
    recall: Interval | None
    f1: Interval | None
    matthews: Interval | None
    no_return_difference_s: Interval | None


@dataclass(frozen=True)
class DistributionScores:
    """Two samples of one quantity: their distance by two measures, each with its meaning in probability.

    `area_null` is the quantile (at `confidence`) of the area metric between two samples of these sizes drawn from the pooled
    values: an area above it is more than chance.
    """

    size_a: int
    size_b: int
    ks: float
    ks_p: float
    area: Interval
    area_null: float

    @property
    def differ(self) -> bool:
        """Whether the two lie further apart than chance alone puts samples of one distribution, at its level."""
        return self.area.value > self.area_null


@dataclass(frozen=True)
class LogPeaks:
    """Largest rotations of `cases` motions under which a model and its reference both rock and stand.

    The ratio of the medians, the standard deviation of each model's logarithms, and the ratio of those two.
    """

    cases: int
    median_ratio: Interval
    dispersion: float
    dispersion_of_reference: float
    dispersion_ratio: Interval


@dataclass(frozen=True)
class ReliabilityBin:
    """Cases whose probability of falling lies from `low` to `high`: its mean, and the share that fell with Wilson's interval.

    From `band_low` to `band_high` that share lies in 95 of 100 such sets where the probabilities are true.
    """

    low: float
    high: float
    cases: int
    mean: float
    fell: Interval
    band_low: float
    band_high: float

    @property
    def holds(self) -> bool:
        """Whether the share that fell lies within the band."""
        return self.band_low <= self.fell.value <= self.band_high


@dataclass(frozen=True, kw_only=True)
class SetScores:
    """One model against a reference over the cases that both answered.

    `same` counts the cases in which both say the same of the statue; `verdicts` are the shares of each verdict, `flips` the cases
    whose outcomes differ within the stated uncertainty, `peaks` the distributions of the peak rotation and `log_peaks` their
    medians and dispersions where there are enough of them.
    """

    reference: str
    cases: int
    same: int = 0
    outcomes: OutcomeScores
    verdicts: Mapping[str, float]
    flips: int
    peaks: DistributionScores | None
    log_peaks: LogPeaks | None = None

    def findings(self, name: str) -> list[Finding]:
        """How the distributions of the largest rotations of the model of this name compare with the reference's."""
        found, pair = [], {"model": name, "reference": self.reference}
        if self.peaks is not None:
            values = vars(self.peaks) | pair | {"area": self.peaks.area.value}
            values |= {"low": self.peaks.area.low, "high": self.peaks.area.high}
            found += [caution("peaks_differ", **values)] if self.peaks.differ else [info("peaks_alike", **values)]
        if self.log_peaks is not None:
            median, spread = self.log_peaks.median_ratio, self.log_peaks.dispersion_ratio
            found.append(
                info(
                    "peak_ratios",
                    cases=self.log_peaks.cases,
                    median=[median.value, median.low, median.high],
                    dispersion=[spread.value, spread.low, spread.high],
                    **pair,
                )
            )
        return found


@dataclass(frozen=True, kw_only=True)
class FragilityCurve:
    """A lognormal fragility curve (`harness.comparison.statistics.fragility`) with its band at intensities (None: not known)."""

    cases: int
    fell: int
    median: float | None
    dispersion: float | None
    separated: bool
    bounds: tuple[float, float] | None
    intensity: Sequence[float]
    probability: Sequence[float | None]
    low: Sequence[float]
    high: Sequence[float]
