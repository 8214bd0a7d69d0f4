"""The stress run: hard scenes, stability maps, mutated inputs, on all cores and in parts; one record."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Final

from harness import engines
from harness.bench import source_tree
from harness.bench.stress import hard_scenes as scenes
from harness.bench.stress import mutated_files, stability
from harness.bench.stress.catalogue import ALL
from harness.campaign import parts
from harness.campaign.parts import Measured, Measurement, Part
from harness.model.run import machine, versions
from harness.records.stress import Cell, HardRow, StressRecord

INPUTS: Final = 20_000
QUICK_INPUTS: Final = 500


def assembled(listed: Sequence[Part], measured: Mapping[str, Measured], command: str) -> StressRecord:
    """The record from the rows of all parts."""
    rows = {part.name: measured[part.name].in_order(part) for part in listed}
    order = {row.name: place for place, row in enumerate(stability.difficulties())}
    cells = [Cell(**row) for row in rows["maps"]]
    spent = parts.seconds(measured)
    return StressRecord(
        command=command,
        absent=absent(),
        scenes=[HardRow(**row) for row in (*rows["scenes"], *rows["questions"])],
        cells=sorted(cells, key=lambda cell: (stability.ENGINES.index(cell.engine), order[cell.difficulty])),
        fuzz=mutated_files.summed(rows["fuzz"]),
        parts=spent,
        seconds=sum(row.wall_s for row in spent),
        versions=versions(),
        machine=machine(),
    )


def absent() -> dict[str, str]:
    """What cannot be run here, engines of the catalogue or what the source tree holds, and why: nothing is said of it."""
    missing = {name: engines.load(name).missing() for name in ALL}
    missing |= {"the part questions": source_tree.missing(scenes.ASKS), "the fuzz": mutated_files.missing()}
    return {name: why for name, why in missing.items() if why is not None}


def all_parts(quick: bool) -> list[Part]:
    """The parts, the one with the longest tasks first: all are computed side by side."""
    inputs = QUICK_INPUTS if quick else INPUTS
    return [
        Part("maps", stability.tasks(quick), partial(stability.compute, quick), stability.died),
        Part("scenes", scenes.tasks(quick), scenes.compute, scenes.died),
        Part("questions", scenes.questions(quick), scenes.answer, scenes.died),
        Part("fuzz", mutated_files.tasks(inputs), mutated_files.compute, mutated_files.died),
    ]


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
    return [*sentences, *parts.sentences(record.parts)]


STRESS: Final = Measurement("stress", all_parts, assembled, sentences)
