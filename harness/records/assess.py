"""The record of an assessment: how probable a fall is, by each model; what it depends on; how strong a shaking is borne."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from harness.model.run import OMITTED
from harness.model.scene import Uncertain
from harness.records.base import Record, Table
from harness.records.scene import SceneRecord


@dataclass(frozen=True)
class Assessment:
    """One model's probability of overturning over the draws; `undecided` is the share that came to no end, or failed."""

    probability_overturned: float
    low: float
    high: float
    level: float
    draws: int
    engine_runs: int
    undecided: float = 0.0

    @property
    def most(self) -> float:
        """The upper end of the interval were every draw that came to no end a fall."""
        return min(self.high + self.undecided, 1.0)

    @property
    def sentence(self) -> str:
        """`falls in 40 % of what may be true (39 to 41 %)`; says where a model came to no end, for that is no standing."""
        if self.undecided >= 1.0:
            return "may fall or stand: the model comes to no end in anything that may be true"
        low, high = percent(self.low), percent(self.high)
        said = f"falls in {percent(self.probability_overturned)} % of what may be true ({low} to {high} %)"
        return said + (f", and in {percent(self.undecided)} % the model comes to no end" if self.undecided else "")


def percent(share: float) -> str:
    """A share in per cent, two digits where it is small."""
    value = 100.0 * share
    return f"{value:.0f}" if value >= 9.95 or value == 0.0 else f"{value:.2g}"


@dataclass(frozen=True)
class NotAssessed:
    """Why there is no assessment by an engine."""

    message: str


@dataclass(frozen=True)
class ProbabilityDifference:
    """The model's probability less an engine's, with its interval."""

    value: float
    low: float
    high: float
    level: float


@dataclass(frozen=True)
class FragilityRecord:
    """Probability of overturning by a factor on the whole motion, and the factor at which it reaches some (None: never)."""

    factor: Sequence[float]
    probability_overturned: Sequence[float]
    draws: int
    factor_at: Mapping[str, float | None]


@dataclass(frozen=True)
class Index:
    """First and total variance-based index of one input."""

    first: float
    total: float


@dataclass(frozen=True, kw_only=True, eq=False)
class AssessRecord(Record):
    """`result.json` of `rockcheck assess`; `fragility` and `indices` are absent where a draw needs the scene read again."""

    kind: Literal["assess"] = "assess"
    scene: SceneRecord
    notes: Sequence[str]
    uncertainty: Sequence[Uncertain]
    assumed: bool
    seed: int
    assessment: Mapping[str, Assessment | NotAssessed | None]
    difference_from_model: Mapping[str, ProbabilityDifference]
    fragility: FragilityRecord | None = field(default=None, metadata=OMITTED)
    indices: Mapping[str, Index] | None = field(default=None, metadata=OMITTED)
    versions: Mapping[str, str]
    machine: Table
    files: Mapping[str, str | None] | None = field(default=None, metadata=OMITTED)

    @property
    def answers(self) -> dict[str, Assessment]:
        """The assessments of the models that gave one."""
        return {name: item for name, item in self.assessment.items() if isinstance(item, Assessment)}
