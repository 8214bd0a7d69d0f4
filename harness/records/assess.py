"""The record of an assessment: how probable a fall is, by each model; what it depends on; how strong a shaking is borne."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final, Literal

from harness.model import OMITTED, Uncertain
from harness.records.base import Record, RunCounts
from harness.records.scene import SceneRecord
from harness.records.scores import Interval

MOSTLY: Final = 0.5
"""A share whose interval is wider than this is no headline."""
CONTRADICTED: Final = "contradicted_in_space"
"""How a probability in the plane is told that leaves out what makes the statue end otherwise."""


@dataclass(frozen=True)
class Assessment:
    """One model's probability of overturning over the draws; `undecided` is the share without an answer, which counts as standing
    in `low` and as falling in `high`: it came to no end, failed, or left what the model knows and was not sampled.

    `left_domain` is the share of draws in which the model left its domain (the pedestal tips, contact is lost, the statue slips
    on its support) before a fall was decided; `sampled` runs of the engine `sampler` answer for them. `touches_wall` is the share
    of draws that ended at the wall: they are undecided. `plane_only`: the scene is
    shaken across the rocking plane too, of which this model knows nothing.
    """

    probability_overturned: float
    low: float
    high: float
    level: float
    draws: int
    engine_runs: int
    undecided: float = 0.0
    plane_only: bool = False
    left_domain: float = 0.0
    sampler: str = ""
    sampled: int = 0
    touches_wall: float = 0.0

    @property
    def tells(self) -> bool:
        """Whether the interval is narrow enough for a number: else the statue may fall or stand."""
        return self.high - self.low <= MOSTLY


def worst(answers: Mapping[str, Assessment]) -> str:
    """The model by which a fall is the most probable, of those that know all of the shaking where one tells: a draw without
    an end is taken for one, a few sampled draws widen an interval and make no fall. Of equal ones that of the higher limit.
    """

    def probable(name: str) -> tuple[float, float]:
        item = answers[name]
        return item.probability_overturned + item.undecided, item.high

    whole = [name for name, item in answers.items() if item.tells and not item.plane_only]
    return max(whole or answers, key=probable)


@dataclass(frozen=True)
class NotAssessed:
    """Why there is no assessment by an engine: its own words, or none of so many `runs` came to an end."""

    message: str
    runs: int = 0


@dataclass(frozen=True)
class ProbabilityDifference:
    """The model's probability less an engine's, with its interval."""

    value: float
    low: float
    high: float
    level: float


@dataclass(frozen=True)
class FragilityRecord:
    """Probability of overturning by a factor on the whole motion, and the factor at which it reaches some (None: never).

    `low` and `high` are its interval (90 %) at each factor: a draw without an answer (share: `undecided`) stands in the low,
    falls in the high. `soonest_at` and `latest_at` are the factors by the high and the low.
    """

    factor: Sequence[float]
    probability_overturned: Sequence[float]
    draws: int
    factor_at: Mapping[str, float | None]
    model: str = "analytic"
    low: Sequence[float] = ()
    high: Sequence[float] = ()
    undecided: Sequence[float] = ()
    soonest_at: Mapping[str, float | None] = field(default_factory=dict)
    latest_at: Mapping[str, float | None] = field(default_factory=dict)


@dataclass(frozen=True)
class Index:
    """First and total variance-based index of one input; `total` None where too few draws were run for it.

    `half_width` is that of the less certain one's interval at 90 %.
    """

    first: float
    half_width: float
    total: float | None = field(default=None, metadata=OMITTED)

    @property
    def most(self) -> float:
        """How much of the doubt hangs on the input: its total where that is known."""
        return self.first if self.total is None else self.total


FLOOR: Final = "floor_alone"
TURNED: Final = "turned_90"
"""Names of options that an answer speaks of: without the pedestal, and turned by a quarter."""


@dataclass(frozen=True)
class OptionAnswer:
    """One option: probability of a fall, the pedestal's slip (median, 95 %; None: not followed), difference to as it is.

    `name` is a code, of the user's own the name given; `values` are what is changed: `static`, `times`, `plate_m`, or keys `set`.
    `undecided` is the share of draws that neither fall nor stand: they stand in `low` and fall in `high`, and the difference's
    interval counts them against either claim.
    """

    name: str
    values: Mapping[str, float | str]
    source: str
    draws: int
    probability_overturned: float
    low: float
    high: float
    slip_median_m: float | None
    slip_high_m: float | None
    difference: Interval | None
    undecided: float = 0.0

    @property
    def tells(self) -> bool:
        """Whether the interval is narrow enough for a number."""
        return self.high - self.low <= MOSTLY

    @property
    def helps(self) -> bool:
        """Whether a fall is shown to be less probable."""
        return self.difference is not None and self.difference.high < 0.0

    @property
    def harms(self) -> bool:
        """Whether a fall is shown to be more probable."""
        return self.difference is not None and self.difference.low > 0.0


@dataclass(frozen=True)
class OptionsRecord:
    """Options with common random numbers, the scene as it is first; `left_out` says why others are not there.

    `plane_only`: the scene is shaken across the rocking plane too, of which these answers know nothing.
    """

    options: Sequence[OptionAnswer]
    draws: int
    level: float
    difference_level: float
    left_out: Mapping[str, str]
    plane_only: bool = False
    model: str = "analytic"

    @property
    def as_it_is(self) -> OptionAnswer:
        """The scene as it is."""
        return self.options[0]

    @property
    def helping(self) -> list[OptionAnswer]:
        """Options that are shown to make a fall less probable."""
        return [item for item in self.options if item.helps]

    @property
    def harming(self) -> list[OptionAnswer]:
        """Options that are shown to make a fall more probable."""
        return [item for item in self.options if item.harms]


@dataclass(frozen=True)
class ClearanceByModel:
    """How far, m, the outline, the middle of its top and the pedestal go beyond where they are at rest, by direction seen from
    above, anticlockwise from the statue's right: a row of quantiles for each `share` of the `standing` draws.

    A planar model has two directions; without any too few draws stand. Draws without an answer are `undecided`, and left out.
    """

    draws: int
    standing: int
    direction_deg: Sequence[float] = ()
    share: Sequence[float] = ()
    outline_m: Sequence[Sequence[float]] = ()
    top_m: Sequence[Sequence[float]] = ()
    pedestal_m: Sequence[Sequence[float]] = ()
    undecided: int = 0

    def at(self, share: float) -> dict[float, float]:
        """How far the outline goes by direction at one of the shares that are told."""
        return dict(zip(self.direction_deg, self.outline_m[list(self.share).index(share)], strict=True))


@dataclass(frozen=True)
class ClearanceRecord:
    """The room needed by each model, beyond the outline at rest (k, 2) seen from above, m; one that falls needs `height_m`, as
    far as its top is above the floor.
    """

    height_m: float
    rest_m: Sequence[Sequence[float]]
    by_model: Mapping[str, ClearanceByModel]

    @property
    def answered(self) -> dict[str, ClearanceByModel]:
        """The models of which enough draws stand, the one that knows most directions first."""
        enough = [(name, item) for name, item in self.by_model.items() if item.share]
        return dict(sorted(enough, key=lambda item: -len(item[1].direction_deg)))


@dataclass(frozen=True, kw_only=True, eq=False)
class AssessRecord(Record):
    """`result.json` of `rockcheck assess`; `indices` are empty where too few draws, or such as end alike, tell none."""

    kind: Literal["assess"] = "assess"
    scene: SceneRecord
    uncertainty: Sequence[Uncertain]
    assumed: bool
    seed: int
    assessment: Mapping[str, Assessment | NotAssessed | None]
    difference_from_model: Mapping[str, ProbabilityDifference]
    fragility: FragilityRecord | None = field(default=None, metadata=OMITTED)
    indices: Mapping[str, Index] | None = field(default=None, metadata=OMITTED)
    options: OptionsRecord | None = field(default=None, metadata=OMITTED)
    clearance: ClearanceRecord | None = field(default=None, metadata=OMITTED)
    runs: RunCounts | None = field(default=None, metadata=OMITTED)

    @property
    def answers(self) -> dict[str, Assessment]:
        """The assessments of the models that gave one."""
        return {name: item for name, item in self.assessment.items() if isinstance(item, Assessment)}

    @property
    def whole_clearance(self) -> ClearanceRecord | None:
        """The room by the models that know all of the shaking, where one does: another may hold upright what falls."""
        whole = {name for name, item in self.answers.items() if not item.plane_only}
        if self.clearance is None or not whole:
            return self.clearance
        known = {name: item for name, item in self.clearance.by_model.items() if name in whole}
        return replace(self.clearance, by_model=known)

    @property
    def plane_only(self) -> bool:
        """Whether the analytic model, and so all that it alone answers, leaves a part of the shaking out."""
        return any(item.plane_only for item in self.answers.values())

    @property
    def contradicted(self) -> bool:
        """Whether another model's probability differs from the analytic one's, so that what it alone answers is its own."""
        return any(item.low > 0.0 or item.high < 0.0 for item in self.difference_from_model.values())
