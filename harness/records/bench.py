"""The records of a bench (run time against error, what a target takes, what skips gain, how cost grows) and of a stress run."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final, Literal, Self

from harness.model import Answer, Finding, caution, changes_answer, info
from harness.records.base import Record

Group = Literal["level", "accuracy"]
LEVEL: Final = "level"
TARGET: Final = "accuracy"
"""Groups of rows: a level, what the target takes."""
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
class LevelChoice:
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
    clock: str = (
        "cpu_s: processor time of the process (single-threaded runs); wall_s: by the clock; both best of several"
    )
    rows: Sequence[PrecisionRow] = ()
    absent: Mapping[str, str] = field(default_factory=dict)
    choice: Sequence[LevelChoice] = ()
    skips: Sequence[SkipRow] = ()
    scaling: Sequence[ScalingRow] = ()
    parts: Sequence[PartRow] = ()
    seconds: float


# The record of a stress run: stability maps and hard scenes.

CELL: Final = ("setting", "difficulty", "category")
"""What is said of a cell that nothing explains."""
Remedy = Literal["step", "iterations"]
"""What makes a cell stable: a shorter step, more solver iterations."""


@dataclass(frozen=True)
class Measure:
    """What a check of a run found: `value` of `allowed` in the unit that ends `check`; without these `holds` says all.

    `case` tells several of one check apart; `until_s` is how long the check was held, where that is not to the end.
    """

    check: str
    holds: bool
    value: float | None = None
    allowed: float | None = None
    case: str = ""
    until_s: float | None = None


@dataclass(frozen=True)
class StabilityCell:
    """One cell of a map: `category` (stable, inaccurate, drifting, diverged), the measures that say so, and what avoids it.

    `message` is an engine's own, where it gave up. `remedy` and the `stable` setting that it leads to explain a cell that is not
    stable. `short`: only the first part of the scene was run, which says nothing of the rest.
    """

    engine: str
    setting: str
    difficulty: str
    category: str
    evidence: Sequence[Measure] = ()
    message: str = ""
    remedy: Remedy | None = None
    stable: str = ""
    short: bool = False

    @property
    def unexplained(self) -> bool:
        """Whether it is not stable and nothing is known that avoids it."""
        return self.category != "stable" and self.remedy is None

    def avoided(self, remedy: Remedy, by: Self) -> Self:
        """The same cell, explained by one that is stable."""
        return replace(self, remedy=remedy, stable=by.setting)


@dataclass(frozen=True)
class KnownFailure:
    """What avoids a failure of a hard scene: so many iterations a step, tried over its first `tried_s`, and its checks then."""

    step_s: float
    iterations: int
    tried_s: float
    checks: Sequence[Measure]


@dataclass(frozen=True)
class HardRow:
    """A hard scene: the outcome wanted, what each engine gave (an outcome, or why it gave none), what was measured by engine, and
    known failures with what avoids them.
    """

    name: str
    wanted: str
    got: Mapping[str, str]
    holds: bool
    checks: Mapping[str, Sequence[Measure]] = field(default_factory=dict)
    note: str = ""
    known: Mapping[str, KnownFailure] = field(default_factory=dict)

    def failed(self, engine: str) -> list[Measure]:
        """The checks of an engine that do not hold, none where that is a known failure."""
        return [] if engine in self.known else [each for each in self.checks.get(engine, ()) if not each.holds]

    def right(self, engine: str) -> bool:
        """Whether an engine gave what is wanted, and no check of it fails."""
        return self.got[engine] == self.wanted and not self.failed(engine)


@dataclass(frozen=True, kw_only=True, eq=False)
class StressRecord(Record):
    """`result.json` of `rockcheck stress`; `absent`: what was not run, and why."""

    kind: Literal["stress"] = "stress"
    title: str = "Numerical stability"
    command: str = "rockcheck stress"
    absent: Mapping[str, str] = field(default_factory=dict)
    scenes: Sequence[HardRow] = ()
    cells: Sequence[StabilityCell] = ()
    parts: Sequence[PartRow] = ()
    seconds: float

    @property
    def holds(self) -> bool:
        """Whether every hard scene came out, every cell is explained, and nothing is left to do."""
        left = any(part.left for part in self.parts) or any(cell.unexplained for cell in self.cells)
        return not left and all(row.holds for row in self.scenes)


def answer_of(record: StressRecord) -> Answer:
    """How many hard scenes come out as they must."""
    if not record.scenes:
        return Answer("not_run", [caution("no_hard_scene")])
    right = sum(row.holds for row in record.scenes)
    values = {"right": right, "scenes": len(record.scenes)}
    if right < len(record.scenes):
        return Answer("wrong", [changes_answer("hard_scenes", **values)])
    return Answer("sound" if record.holds else "open", [info("hard_scenes", **values)])


def findings_of(record: StressRecord) -> list[Finding]:
    """Scenes that did not come out, cells by category."""
    found = []
    for row in record.scenes:
        wrong = {name: got for name, got in row.got.items() if got != row.wanted}
        if wrong or not row.got:
            found.append(changes_answer("hard_scene_wrong", scene=row.name, wanted=row.wanted, got=wrong))
        found += [
            changes_answer("hard_check_fails", scene=row.name, check=each.check, value=each.value, allowed=each.allowed).of(name)
            for name in row.checks for each in row.failed(name)
        ]  # fmt: skip
        found += [
            info("known_failure", scene=row.name, iterations=known.iterations, step_s=known.step_s).of(name)
            for name, known in row.known.items()
        ]
    counts = Counter(cell.category for cell in record.cells)
    found += [info("stability_cells", counts=dict(counts))] if counts else []
    found += [
        changes_answer("cell_unexplained", **{key: vars(cell)[key] for key in CELL}).of(cell.engine)
        for cell in record.cells
        if cell.unexplained
    ]
    return [*found, *of_parts(record.parts, record.absent)]
