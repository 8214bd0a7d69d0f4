"""The record of a stress run: stability maps, hard scenes and the mutated inputs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final, Literal

from harness.model.finding import Answer, Finding, caution, changes_answer, info
from harness.records.base import Record
from harness.records.bench import PartRow, of_parts

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
class Cell:
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

    def avoided(self, remedy: Remedy, by: Cell) -> Cell:
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
    cells: Sequence[Cell] = ()
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
