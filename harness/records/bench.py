"""The record of a bench: run time against error, what a target takes, what skips gain, how cost grows, other solvers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, Literal

from harness.model.finding import Finding, caution, info
from harness.records.base import Record

Group = Literal["level", "accuracy", "default", "other project"]
LEVEL: Final = "level"
TARGET: Final = "accuracy"
DEFAULT: Final = "default"
OTHER_PROJECT: Final = "other project"
"""Groups of rows: a level, what the target takes, the engine's own defaults, another project's settings."""
TOGETHER: Final = "all together"
"""The skip of a row that has them all."""


@dataclass(frozen=True)
class PrecisionRow:
    """One setting of an engine on one scene: its error and cost, or why it `failed`.

    `reference`: what the error is against; `chosen`: by the target; `stated_rad`: its own uncertainty; `cpu_s`: of the processor.
    """

    engine: str
    scene: str
    group: Group
    label: str
    block: bool = True
    reference: str = "analytic"
    dt_s: float | None = None
    error_rad: float | None = None
    wall_s: float | None = None
    cpu_s: float | None = None
    repeats: int | None = None
    real_time_factor: float | None = None
    steps: int | None = None
    iterations: int | None = None
    stated_rad: float | None = None
    reliable_until_s: float | None = None
    chosen: bool = False
    failed: str | None = None

    def meets(self, target_rad: float) -> bool:
        """Whether it did not fail and its error is within a target."""
        return self.failed is None and self.error_rad is not None and self.error_rad <= target_rad


@dataclass(frozen=True)
class Choice:
    """What a target takes of an engine: in all, beside the one level that meets it everywhere, beside each scene's best level.

    `met`: scenes of `scenes` on which the error is within it; `share`: of the fixed level's cost; `times`: of the best level's.
    """

    engine: str
    scenes: int
    met: int
    total_s: float
    fixed_s: float | None
    share: float | None
    worst_scene: str | None
    worst_times: float | None
    median_times: float | None = None


@dataclass(frozen=True)
class Level:
    """One level of an engine on a seeded scene: its error and processor time, or why there are none."""

    dt_s: float
    failed: str | None = None
    error_rad: float | None = None
    cpu_s: float | None = None


@dataclass(frozen=True)
class Statement:
    """What a run stated of itself, and what it was off by while that is said to hold (None: it kept no history)."""

    engine: str
    outcome: str
    dt_s: float | None
    runs: int
    steps: int
    stated_rad: float
    stated_m: float
    reliable_until_s: float
    end_s: float
    error_rad: float | None
    error_m: float | None
    plain_from_s: float | None = None

    @property
    def rotation_holds(self) -> bool:
        """Whether the error of the rotation stays within the statement."""
        return self.error_rad is not None and self.error_rad <= self.stated_rad

    @property
    def slip_holds(self) -> bool:
        """Whether that of the slip does."""
        return self.error_m is not None and self.error_m <= self.stated_m

    @property
    def share(self) -> float:
        """For what share of the run's length it is said to hold."""
        return self.reliable_until_s / self.end_s if self.end_s > 0.0 else 1.0


@dataclass(frozen=True)
class Coverage:
    """One seeded scene run to a target; no statement where the process died.

    `cpu_s`: processor time of that run; `levels` where it was met to the end, since else none is known to be enough.
    """

    engine: str
    seed: int
    target_rad: float
    stated: Statement | None = None
    cpu_s: float = 0.0
    levels: Sequence[Level] = ()

    @property
    def covered(self) -> bool:
        """Whether the errors of rotation and slip stay within the statement while it holds."""
        return self.stated is not None and self.stated.rotation_holds and self.stated.slip_holds


@dataclass(frozen=True)
class Covered:
    """An engine's seeded scenes: on how many the error lay within the statement, and on which it did not."""

    inside: int
    total: int
    missed: Sequence[int] = ()


@dataclass(frozen=True)
class SkipRow:
    """Seconds with a skip and without it, outcomes that it `changed`, or why it was not measured (`failed`).

    `unsettled`: outcomes that the engine's own finer settings without skips change as well; `apart_rad`: how far rotations
    part; `own_rad`: how far finer settings without the skip part from the same run.
    """

    skip: str
    engine: str
    scenes: int = 1
    on_s: float = 0.0
    off_s: float = 0.0
    changed: Sequence[str] = ()
    unsettled: Sequence[str] = ()
    outcomes: Sequence[str] = ()
    apart_rad: float | None = None
    own_rad: float | None = None
    steps: Sequence[int] | None = None
    failed: str | None = None

    @property
    def gain(self) -> float:
        """Times faster with the skip."""
        return self.off_s / self.on_s


@dataclass(frozen=True)
class ScalingRow:
    """Time and largest memory at one value of a quantity."""

    engine: str
    quantity: str
    value: float
    wall_s: float
    memory_mb: float
    cpu_s: float | None = None


@dataclass(frozen=True)
class SolverRow:
    """One setting of a solver on a case: its error against the exact θ, rad, and the least processor time of all rounds, s."""

    case: str
    solver: str
    tolerance: float
    how: str = ""
    work: int = 0
    error_rad: float | None = None
    seconds: float | None = None
    failed: str | None = None


@dataclass(frozen=True)
class Throughput:
    """Outcome-only runs of a map over amplitude and frequency: how many, how fast, their steps, the share that overturned."""

    runs: int
    threads: int
    wall_s: float
    cpu_s: float
    runs_per_s: float
    runs_per_core_s: float
    steps_per_run: float
    us_per_step: float
    overturned: float


@dataclass(frozen=True)
class Start:
    """Seconds to import the model and for its first call, and their ratios to numpy's and numba's import and a trivial call."""

    import_s: float
    first_call_s: float
    import_ratio: float
    first_call_ratio: float


@dataclass(frozen=True)
class PartRow:
    """What a part of a measurement took: by the clock, of the processor (`busy_s`); tasks that are left to do."""

    part: str
    wall_s: float
    tasks: int
    left: Sequence[str]
    busy_s: float = 0.0


def of_parts(rows: Sequence[PartRow], absent: Mapping[str, str]) -> list[Finding]:
    """The seconds of each part, what is not measured yet, and what cannot be."""
    left = {row.part: len(row.left) for row in rows if row.left}
    found = [caution("parts_left", parts=left)] if left else []
    found += [caution("not_measured", what=name, reason=why) for name, why in absent.items()]
    clock_s, busy_s = ({row.part: vars(row)[name] for row in rows if row.tasks} for name in ("wall_s", "busy_s"))
    return [*found, info("time_by_part", clock_s=clock_s, total_s=sum(clock_s.values()), busy_s=sum(busy_s.values()))]


@dataclass(frozen=True, kw_only=True, eq=False)
class BenchRecord(Record):
    """`result.json` of `rockcheck bench`; what is not measured yet is empty, or None."""

    kind: Literal["bench"] = "bench"
    title: str = "Run time against error"
    command: str = "rockcheck bench"
    target_rad: float
    clock: str = ""
    rows: Sequence[PrecisionRow] = ()
    absent: Mapping[str, str] = field(default_factory=dict)
    choice: Sequence[Choice] = ()
    seeded: Sequence[Choice] = ()
    coverage: Mapping[str, Covered] = field(default_factory=dict)
    coverage_rows: Sequence[Coverage] = ()
    skips: Sequence[SkipRow] = ()
    scaling: Sequence[ScalingRow] = ()
    solvers: Sequence[SolverRow] = ()
    throughput: Mapping[str, Throughput] = field(default_factory=dict)
    startup: Start | None = None
    overhead: Mapping[str, float] = field(default_factory=dict)
    scans: Mapping[str, float] = field(default_factory=dict)
    parts: Sequence[PartRow] = ()
    seconds: float
