"""The records of measured sets and of a validation: models and a bare threshold on PGV scored on measured tests."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from harness.model import OMITTED, Finding, caution, info
from harness.records.base import Record, RunCounts
from harness.records.scores import Interval, Scores

# The record of a measured set that is told by tables: tosses, planar drops, impact ratios; or of all that was checked.

Cell = str | int | float | None
"""A count that is read as one is told without decimals."""
About = Literal["tosses", "drops", "impact_ratios", "checked"]


@dataclass(frozen=True)
class MeasuredTable:
    """One table: `name` says what its rows are, `columns` carry their units."""

    name: str
    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]


@dataclass(frozen=True, kw_only=True, eq=False)
class MeasuredRecord(Record):
    """`result.json` of `rockcheck validate` on a measured set; the first table is the one to read."""

    kind: Literal["measured"] = "measured"
    title: str = ""
    about: About
    source: str
    body: str | None = field(default=None, metadata=OMITTED)
    samples: int | None = field(default=None, metadata=OMITTED)
    tables: Sequence[MeasuredTable]
    seed: int = 0
    seconds: float


# Scores of many cases, as statistics give them and as they stand in the records of studies and validations.


@dataclass(frozen=True)
class FallScores:
    """Scores of predicted falls, whichever way they go; None without meaning (no positive predicted, ...)."""

    cases: int
    accuracy: Interval | None
    precision: Interval | None
    recall: Interval | None
    f1: Interval | None
    matthews: Interval | None


@dataclass(frozen=True)
class OutcomeScores(FallScores):
    """Scores of a set of predicted outcomes; `positive` means overturned, whichever way.

    `confusion[observed][predicted]` counts by side over all decided cases that are not within the uncertainty;
    `side_accuracy` is the share of those with the very same outcome, where the side is known. Scores without meaning (no
    positive predicted, ...) are None. Proportions carry Wilson's interval, F1 and Matthews' correlation the bootstrap's.
    """

    undecided: int
    within_uncertainty: int
    confusion: Mapping[str, Mapping[str, int]]
    side_accuracy: Interval | None
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
    """A lognormal fragility curve (`comparison.statistics.fit_fragility`) with its band at intensities (None: not known)."""

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


@dataclass(frozen=True)
class ProbabilityScores:
    """Brier's score of the probabilities, its skill over the mean, the area under the curve, and the reliability diagram.

    Over the tests of which a probability is known; `samples` perturbed runs of each (none of the baseline, which has a curve).
    """

    tests: int
    brier: float | None
    brier_skill: float | None
    samples: int | None = field(default=None, metadata=OMITTED)
    area: Interval | None = None
    reliability: Sequence[ReliabilityBin] = ()


@dataclass(frozen=True)
class IntensityClass:
    """The share of tests predicted right in one class of PGV."""

    pgv_from_m_s: float
    pgv_to_m_s: float
    tests: int
    accuracy: Interval | None


@dataclass(frozen=True)
class ContourLine:
    """PGA in g at which half of the tests fall, by PGV/PGA in s."""

    ratio_s: Sequence[float]
    pga_g: Sequence[float]


@dataclass(frozen=True)
class ContourRecord:
    """The fitted contour (`harness.questions.validate.scoring.contour`) with its line."""

    cases: int
    fell: int
    coefficients: tuple[float, float, float]
    separated: bool
    contour_50: ContourLine


@dataclass(frozen=True)
class Curves:
    """Fragility in PGV, and the contour in PGA against PGV/PGA."""

    fragility_pgv: FragilityCurve | None
    contour: ContourRecord | None


@dataclass(frozen=True)
class FittedInput:
    """The most probable value of one input of a body (on one day), its probability, and whether it ends its list."""

    body: str
    day: str
    input: str
    value: float | str | Sequence[float] | None
    weight: float
    at_end: bool


@dataclass(frozen=True)
class Fitted:
    """What was fitted on how many tests: −ln of the mean probability given to each by all others (`log_score`), the factor on the
    scatter of draws and the counts added to theirs, the unknown inputs, the runs it took.
    """

    tests: int
    log_score: float | None
    width: float
    width_at_end: bool
    counts: float
    inputs: Sequence[FittedInput] = ()
    runs: int = 0


@dataclass(frozen=True)
class BodyScores:
    """Scores on the tests of one body: how many nominal runs are right; with draws P ≥ ½ and Brier's score."""

    body: str
    tests: int
    fell: int
    accuracy: Interval | None
    by_probability: Interval | None
    brier: float | None


@dataclass(frozen=True)
class Repeats:
    """Tests of the same body, motion and inputs: how many in how many groups, and what no prediction of all tests exceeds: the
    share right (each group's more frequent outcome), and Brier's score.
    """

    tests: int
    groups: int
    disagreeing: int
    best_accuracy: float
    best_brier: float


@dataclass(frozen=True)
class MeasuredHistory:
    """Scores of a test's run against its measured history; None where none was computed."""

    test: str
    scores: Scores | None


@dataclass(frozen=True, kw_only=True)
class ModelRecord(Curves):
    """One model: the accuracy or the step asked of it; its scores, of its nominal runs, of P ≥ ½ (None without perturbed runs)
    and of the probabilities; its histories beside measured ones; where it is asked only `near` the boundary of another model, on
    how many tests it was."""

    tests: int
    failed: int
    fitted: Fitted
    outcomes: OutcomeScores
    by_probability: FallScores | None
    probability: ProbabilityScores
    by_intensity: Sequence[IntensityClass]
    by_body: Sequence[BodyScores] = ()
    engine: str
    accuracy_rad: float | None
    dt_s: float | None
    histories: Sequence[MeasuredHistory] = ()
    near: str = field(default="", metadata=OMITTED)
    asked: int | None = field(default=None, metadata=OMITTED)


@dataclass(frozen=True)
class BaselineRecord:
    """What needs no model: each body's threshold on PGV (`threshold_m_s`: of all together), the probability by PGV alone."""

    rule: str
    threshold_m_s: float
    fitted_on: str
    outcomes: FallScores
    probability: ProbabilityScores
    by_intensity: Sequence[IntensityClass]
    threshold_by_body_m_s: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class PairScores(SetScores):
    """Two models beside each other, `a` against `b`; `unstated` are those whose numerical error is not stated in every run."""

    a: str
    b: str
    unstated: Sequence[str]


@dataclass(frozen=True)
class TestRow:
    """One test: what was observed, and by model what was predicted and the share of the runs that overturn."""

    test: str
    body: str
    share: str
    observed: str
    pga_g: float
    pgv_m_s: float
    predicted: Mapping[str, str]
    probability: Mapping[str, float | None]


@dataclass(frozen=True)
class FitShare:
    """The share of the tests on which unknown inputs are fitted."""

    name: str
    tests: int


@dataclass(frozen=True, kw_only=True, eq=False)
class ValidationRecord(Record):
    """`result.json` of `rockcheck validate`; `unknown` inputs have several values in the table, `unfitted` had no share.

    `unexplained` are tests whose observed outcome no run of any model gave: at no setting of the table, in no draw.
    """

    kind: Literal["validation"] = "validation"
    title: str = ""
    tests: int
    bodies: int
    fit_share: FitShare
    samples: int = 0
    unknown: Sequence[str]
    unfitted: Sequence[str]
    models: Mapping[str, ModelRecord]
    pairs: Sequence[PairScores] = ()
    observed: Curves
    baseline: BaselineRecord
    rows: Sequence[TestRow]
    unexplained: Sequence[str] = ()
    repeats: Repeats | None = None
    experiments: str
    runs: RunCounts
    seed: int = 0
    seconds: float
