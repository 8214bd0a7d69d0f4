"""The records of a bench (run time against error, what a target takes, what skips gain, how cost grows) and of a stress run."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final, Literal

from harness.model.finding import Answer, Finding, caution, changes_answer, info
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
class LevelRow:
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
    levels: Sequence[LevelRow] = ()

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
class StartRow:
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
    choice: Sequence[LevelChoice] = ()
    seeded: Sequence[LevelChoice] = ()
    coverage: Mapping[str, Covered] = field(default_factory=dict)
    coverage_rows: Sequence[Coverage] = ()
    skips: Sequence[SkipRow] = ()
    scaling: Sequence[ScalingRow] = ()
    solvers: Sequence[SolverRow] = ()
    throughput: Mapping[str, Throughput] = field(default_factory=dict)
    startup: StartRow | None = None
    overhead: Mapping[str, float] = field(default_factory=dict)
    scans: Mapping[str, float] = field(default_factory=dict)
    parts: Sequence[PartRow] = ()
    seconds: float


# The record of a stress run: stability maps, hard scenes and the mutated inputs.

CELL: Final = ("setting", "difficulty", "category")
"""What is said of a cell that nothing explains."""
Remedy = Literal["step", "iterations", "margin", "spheres"]
"""What makes a cell stable: a shorter step, more solver iterations, a hull without its margin, spheres instead of a hull."""


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

    def avoided(self, remedy: Remedy, by: StabilityCell) -> StabilityCell:
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


@dataclass(frozen=True)
class Harm:
    """An input that did harm: its seed (None: the whole file, or a process) and what came of it."""

    seed: int | None
    what: str


@dataclass(frozen=True)
class Mutated:
    """Mutated inputs of one kind: how many were accepted and used, kinds of refusal, and what did harm."""

    reader: str
    inputs: int
    tracebacks: int
    hangs: int
    half_written: int
    accepted: int = 0
    refusals: int = 0
    found: Sequence[Harm] = ()

    @property
    def harm(self) -> int:
        """How many did harm."""
        return self.tracebacks + self.hangs + self.half_written


@dataclass(frozen=True, kw_only=True, eq=False)
class StressRecord(Record):
    """`result.json` of `rockcheck stress`; `absent`: what was not run, and why."""

    kind: Literal["stress"] = "stress"
    title: str = "Numerical stability"
    command: str = "rockcheck stress"
    absent: Mapping[str, str] = field(default_factory=dict)
    scenes: Sequence[HardRow] = ()
    cells: Sequence[StabilityCell] = ()
    fuzz: Sequence[Mutated] = ()
    parts: Sequence[PartRow] = ()
    seconds: float

    @property
    def holds(self) -> bool:
        """Whether every hard scene came out, every cell is explained, no mutated input did harm, and nothing is left to do."""
        whole = not any(part.left for part in self.parts)
        sound = not any(cell.unexplained for cell in self.cells) and not any(item.harm for item in self.fuzz)
        return whole and sound and all(row.holds for row in self.scenes)


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
    """Scenes that did not come out, cells by category, mutated inputs that did harm."""
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
    if inputs := sum(item.inputs for item in record.fuzz):
        used, harm = sum(item.accepted for item in record.fuzz), sum(item.harm for item in record.fuzz)
        found.append(info("mutated", inputs=inputs, used=used, harm=harm))
    found += [
        changes_answer("mutated_harm", reader=item.reader, seed=case.seed, what=case.what)
        for item in record.fuzz
        for case in item.found
    ]
    return [*found, *of_parts(record.parts, record.absent)]
