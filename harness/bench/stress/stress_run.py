"""The stress run: hard scenes, stability maps, mutated inputs, on all cores and in parts; one record."""

from __future__ import annotations

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
from harness.records.stress import Cell, HardRow, StressRecord, sentences

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
    missing |= {
        "the part questions": source_tree.missing(scenes.ASKS),
        "the fuzz": source_tree.missing(mutated_files.FUZZ),
    }
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


STRESS: Final = Measurement("stress", all_parts, assembled, sentences)
