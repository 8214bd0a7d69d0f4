"""The record of a stress run: stability maps, hard scenes and the mutated inputs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from harness.records.base import Record
from harness.records.bench import PartRow, part_sentences


@dataclass(frozen=True)
class Cell:
    """One cell of a map: `category` (stable, inaccurate, drifting, diverged), the numbers that say so, and what avoids it.

    `short`: only the first part of the scene was run, which says nothing of the rest.
    """

    engine: str
    setting: str
    difficulty: str
    category: str
    evidence: str
    explained: str = ""
    short: bool = False

    @property
    def unexplained(self) -> bool:
        """Whether it is not stable and nothing is known that avoids it."""
        return self.category != "stable" and not self.explained


@dataclass(frozen=True)
class HardRow:
    """A hard scene: the outcome wanted, what each engine gave, what the checks said, and known failures with what avoids them."""

    name: str
    wanted: str
    got: Mapping[str, str]
    holds: bool
    checks: Sequence[str] = ()
    note: str = ""
    known: Mapping[str, str] = field(default_factory=dict)


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


def sentences(record: StressRecord) -> list[str]:
    """What the record says: scenes that did not come out, cells by category, mutated inputs that did harm."""
    wrong = [row for row in record.scenes if not row.holds]
    sentences = []
    if record.scenes:
        sentences.append(
            f"{len(record.scenes) - len(wrong)} of {len(record.scenes)} hard scenes come out as they must."
        )
    for row in wrong:
        bad = "; ".join(f"{name}: {got}" for name, got in row.got.items() if got != row.wanted)
        sentences.append(f"“{row.name}” (wanted: {row.wanted}): {bad}.")
    sentences += [f"{name} was not run: {why}." for name, why in record.absent.items()]
    sentences += [
        f"Known failure, “{row.name}”, {name}: {text}." for row in record.scenes for name, text in row.known.items()
    ]
    counts = Counter(cell.category for cell in record.cells)
    if counts:
        sentences.append("Cells of the stability maps: " + ", ".join(f"{n} {name}" for name, n in counts.items()) + ".")
    sentences += [
        f"Unexplained: {cell.engine}, {cell.setting}, {cell.difficulty}: {cell.category}, {cell.evidence}."
        for cell in record.cells
        if cell.unexplained
    ]
    if inputs := sum(item.inputs for item in record.fuzz):
        used, harm = sum(item.accepted for item in record.fuzz), sum(item.harm for item in record.fuzz)
        sentences.append(f"{inputs} mutated inputs, {used} of them accepted and used, {harm} did harm.")
    sentences += [
        f"Mutated {item.reader}, seed {case.seed}: not refused in words." for item in record.fuzz for case in item.found
    ]
    return [*sentences, *part_sentences(record.parts)]
