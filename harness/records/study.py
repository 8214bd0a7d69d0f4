"""The records of a rocking spectrum and of a study: one row for each case and engine, how the models compare over them, and what
was not run.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any, Final, Literal

import numpy as np
from pydantic import JsonValue

from harness.model import (
    OMITTED,
    RUN_FIELDS,
    Axes,
    Column,
    Finding,
    Outcome,
    RunRow,
    RunSet,
    Say,
    Severity,
    Shown,
    answered,
    column_of,
    to_plain,
)
from harness.records.base import Plain, Record, plain
from harness.records.scene import SceneRecord
from harness.records.validation import SetScores

# What a study keeps beside its record: the file of all rows, and columns.


@dataclass(frozen=True)
class ExportRecord:
    """The file of all rows that this study wrote, and its checksum."""

    file: str
    sha256: str


@dataclass(frozen=True)
class TableRecord:
    """A study whose results stand in columns: where (beside the record), how many, how many of them are `rows` of the record.

    `outcomes` are counted over all of them; `seconds` are those of all workers.
    """

    folder: str
    rows: int
    shown: int
    outcomes: Mapping[str, int]
    seconds: float


Value = float | int | str | bool
ClaimAnswer = Literal["holds", "does not hold", "holds for some", "not tested"]


@dataclass(frozen=True, kw_only=True, eq=False)
class CaseRun(RunRow):
    """What a study keeps of one run (`harness.model.run.Run`); impacts are counted, and weighed for claims."""

    end_s: float | None = None  # type: ignore[assignment]
    impacts: int
    last_impact_s: float | None = None
    impact_loss_j: float | None = None

    @classmethod
    def stored(cls, run: Mapping[str, Any]) -> CaseRun:
        """From what a store holds of a run (`harness.model.run.Run`).

        Words that many runs share are one string, for there may be a million of them.
        """
        same: dict[str, Any] = {name: run.get(name) for name in STORED}
        validity = {sys.intern(key): value for key, value in run["validity"].items()}
        findings = [Finding(**{**each, "severity": Severity(each["severity"])}) for each in run["findings"]]
        outcome = Outcome(run["outcome"])
        return cls(**same | {"outcome": outcome, "findings": findings, "validity": validity, "impacts": impacts(run)})


def impacts(run: Mapping[str, Any]) -> int:
    """Number of impacts of a run that a store holds; a run for the outcome alone counts them and lists none."""
    return len(run["impact_times_s"]) or int(run["work"].get("impacts", 0))


STORED: Final = tuple(item.name for item in fields(CaseRun) if item.name != "impacts")
"""What a study keeps of a run as its store holds it."""


@dataclass(frozen=True, kw_only=True, eq=False)
class StudyRow:
    """One case by one engine: what varies, and its run; None where it was not sent, for the reason."""

    number: int
    engine: str
    reason: str
    varied: Mapping[str, Value]
    run: CaseRun | None

    @property
    def model(self) -> str:
        """Engine and variant."""
        return f"{self.engine} ({self.varied['variant']})"


ROW: Final = tuple(item.name for item in fields(StudyRow))
"""The keys of a row, its run the last."""


@dataclass(frozen=True)
class SupportRecord:
    """Whether cases have a pedestal, least and greatest static frictions, and the keys of the statue that vary."""

    pedestal: Sequence[bool]
    floor_static: tuple[float, float] | None
    statue: tuple[float, float]
    statue_keys: Sequence[str]


@dataclass(frozen=True, kw_only=True)
class StudySummary:
    """What a call of a study did."""

    cases: int = 0
    wanted: int = 0
    distinct: int = 0
    found: int = 0
    computed: int = 0
    not_sent: int = 0
    failed: int = 0


@dataclass(frozen=True, kw_only=True)
class UsageRecord:
    """Where the seconds of a study went (`harness.runs.execute.Campaign.usage`)."""

    workers: int
    runs: int
    wall_s: float
    busy_s: float
    own_s: float
    utilisation: float | None
    overhead_s_per_run: float | None


@dataclass(frozen=True)
class RecheckRecord:
    """How the cases that were left out came out where a random share of them was run after all: how many `differ` from the
    analytic outcome, or from that which the refined map took for them.
    """

    audited: int
    differ: int
    against: Literal["analytic", "map"]


@dataclass(frozen=True, kw_only=True)
class WitnessCount:
    """Of how many scenes a plain engine confirms the engine beside it, differs, or says nothing."""

    confirmed: int
    differ: int
    silent: int


@dataclass(frozen=True, kw_only=True)
class StudyWitness:
    """What unmodified engines say of a seeded tenth of the scenes: `scenes` of so many, by plain engine; where they differ."""

    scenes: int
    of: int
    counts: Mapping[str, WitnessCount]
    differing: Sequence[Finding]
    seconds: float


@dataclass(frozen=True)
class ClaimVerdict:
    """One claim by one model: the verdict, its number and what the number counts; `untested` are parts that had no case."""

    claim: str
    model: str
    imposed: bool
    verdict: ClaimAnswer
    held: int
    cases: int
    evidence: Finding
    untested: Sequence[str] = ()


@dataclass(frozen=True)
class ThinnedHistory:
    """A history decimated for a small picture."""

    t_s: Sequence[float]
    theta_rad: Sequence[float]
    slip_m: Sequence[float]


@dataclass(frozen=True)
class Panel:
    """One condition of the paper's figures: by model, the histories `floor` and `pedestal`."""

    restitution: float
    amplitude_g: float
    frequency_hz: float
    curves: Mapping[str, Mapping[str, ThinnedHistory]]


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class StudyRecord(Record, Shown):
    """`result.json` of `rockcheck study`."""

    kind: Literal["study"] = "study"
    file: str
    scene: SceneRecord
    vary: Mapping[str, Sequence[Value]]
    supports: SupportRecord | None = field(default=None, metadata=OMITTED)
    summary: StudySummary
    usage: UsageRecord | None = field(default=None, metadata=OMITTED)
    seconds: float
    engine_seconds: Mapping[str, float]
    scores: Mapping[str, SetScores] | None = field(default=None, metadata=OMITTED)
    audit: RecheckRecord | None
    witness: StudyWitness | None = field(default=None, metadata=OMITTED)
    claims: Sequence[ClaimVerdict] | None = field(default=None, metadata=OMITTED)
    headline: Mapping[str, str] | None = field(default=None, metadata=OMITTED)
    panels: Sequence[Panel] | None = field(default=None, metadata=OMITTED)
    rows: Sequence[StudyRow]
    table: TableRecord | None = field(default=None, metadata=OMITTED)
    export: ExportRecord | None = field(default=None, metadata=OMITTED)

    def texted(self, say: Say) -> StudyRecord:
        """The record with its sentences, the evidence of each claim among them."""
        said = [replace(each, evidence=replace(each.evidence, text=say(each.evidence))) for each in self.claims or ()]
        return replace(super().texted(say), claims=self.claims and said)

    def plain(self) -> Plain:
        """The record as plain JSON values.

        There may be a million rows: what came from a store is plain already but for its findings, and is not looked at value
        by value.
        """
        rows: list[JsonValue] = [
            {name: getattr(row, name) for name in ROW[:-1]}
            | {"run": None if row.run is None else {**vars(row.run), "findings": to_plain(row.run.findings)}}
            for row in self.rows
        ]
        return {**plain(replace(self, rows=())), "rows": rows}

    def run_set(self) -> RunSet:
        """Its rows as one table: what varied, and every single value of each run (None where there was none)."""
        keys = list(dict.fromkeys(key for row in self.rows for key in row.varied))
        apart = {"engine", *(each.name for each in RUN_FIELDS if not each.single)}
        table: dict[str, list[object]] = {name: [getattr(row, name) for row in self.rows] for name in ROW[:3]}
        table |= {key: [row.varied.get(key) for row in self.rows] for key in keys}
        own = [each.name for each in fields(CaseRun) if each.name not in apart]
        table |= {name: [getattr(row.run, name, None) for row in self.rows] for name in own}
        return RunSet(self.title, keys, answered({name: column_of(values) for name, values in table.items()}))

    def facts(self) -> dict[str, str]:
        """Title, what varies, how many runs, how many of them overturn, by model."""
        return self.run_set().facts()

    def columns(self) -> dict[str, Column]:
        """One row for each case and engine: what varied, and every single value of its run (None where there was none)."""
        return {"row": np.arange(len(self.rows)), **self.run_set().table}

    def plot(self, ax: Axes | None = None, engine: str | None = None) -> Axes:
        """See `RunSet.plot`."""
        return self.run_set().plot(ax, engine)


# The record of a rocking spectrum: how far blocks of every size and slenderness rock in a set of motions, and which fall.

Numbers = Sequence[Sequence[float]]
"""A number for each size (rows) and slenderness (columns)."""


@dataclass(frozen=True)
class SpectrumMotion:
    """One motion of the set."""

    name: str
    pga_g: float
    pgv_m_s: float
    duration_s: float


@dataclass(frozen=True)
class SpectrumSummary:
    """What a call computed."""

    runs: int
    cpu_s: float
    failed: int = 0


@dataclass(frozen=True, kw_only=True, eq=False)
class RockingSpectrumRecord(Record):
    """`result.json` of `rockcheck study` for a file of `kind = "rocking_spectrum"`.

    Sizes are half diagonals R, slendernesses h/b of homogeneous blocks. `cases` are motions × draws; over them the share
    that overturns, and the median and 84 % quantile of the peak rotation over α (None: more than that share overturns).
    `undecided` is the share of all runs that still leaned beyond α at the end.
    """

    kind: Literal["rocking_spectrum"] = "rocking_spectrum"
    title: str
    file: str = ""
    restitution: float | Literal["momentum"]
    motions: Sequence[SpectrumMotion]
    strength_cov: float
    draws: int
    seed: int
    cases: int
    size_m: Sequence[float]
    slenderness: Sequence[float]
    probability_overturned: Numbers
    peak_median: Sequence[Sequence[float | None]]
    peak_high: Sequence[Sequence[float | None]]
    undecided: float
    summary: SpectrumSummary
