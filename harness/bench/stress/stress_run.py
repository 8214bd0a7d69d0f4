"""The stress run: hard scenes, stability maps, mutated inputs, on all cores and in parts; one record."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Final

from harness import engines
from harness.bench import programs
from harness.bench.stress import hard_scenes as scenes
from harness.bench.stress import mutated_files, stability
from harness.bench.stress.catalogue import ALL
from harness.campaign import parts
from harness.campaign.parts import Measured, Measurement, Part
from harness.model.run import machine, versions
from harness.records.stress import Cell, HardRow, StressRecord, answer_of, findings_of

INPUTS: Final = 20_000
QUICK_INPUTS: Final = 500


QUESTIONS, FUZZ, DEFAULTS = "questions", "fuzz", "engine defaults"
"""What programs that are given measure: invariances, mutated files, pybullet's own hull."""


def assembled(
    given: programs.Programs, listed: Sequence[Part], measured: Mapping[str, Measured], command: str
) -> StressRecord:
    """The record from the rows of all parts."""
    rows = {part.name: measured[part.name].in_order(part) for part in listed}
    order = {row.name: place for place, row in enumerate(stability.difficulties())}
    cells = [Cell(**row) for row in rows["maps"]]
    spent = parts.seconds(measured)
    made = StressRecord(
        command=command,
        absent=absent(given),
        scenes=[HardRow(**row) for row in (*rows["scenes"], *rows["questions"])],
        cells=sorted(cells, key=lambda cell: (stability.ENGINES.index(cell.engine), order[cell.difficulty])),
        fuzz=mutated_files.summed(rows["fuzz"]),
        parts=spent,
        seconds=sum(row.wall_s for row in spent),
        versions=versions(),
        machine=machine(),
    )
    return replace(made, answer=answer_of(made), findings=findings_of(made))


def absent(given: programs.Programs) -> dict[str, str]:
    """What cannot be run here, engines of the catalogue or what no program was given for, and why: nothing is said of it."""
    missing = {name: engines.load(name).missing() for name in ALL}
    known = {name: why for name, why in missing.items() if why is not None}
    return known | programs.absent(given, (QUESTIONS, FUZZ, DEFAULTS))


def all_parts(given: programs.Programs, quick: bool) -> list[Part]:
    """The parts, the one with the longest tasks first: all are computed side by side."""
    fuzz = mutated_files.tasks(QUICK_INPUTS if quick else INPUTS) if FUZZ in given else []
    asked = scenes.QUESTIONS if QUESTIONS in given and not quick else ()
    return [
        Part("maps", stability.tasks(quick), partial(stability.compute, given.get(DEFAULTS), quick), stability.died),
        Part("scenes", scenes.tasks(quick), scenes.compute, scenes.died),
        Part("questions", asked, partial(scenes.answer, given.get(QUESTIONS, "")), scenes.died),
        Part("fuzz", fuzz, partial(mutated_files.compute, given.get(FUZZ, "")), mutated_files.died),
    ]


def stress(given: programs.Programs = programs.NONE, sources: Sequence[str] = ()) -> Measurement[StressRecord]:
    """The stress run with what these programs measure; `sources` are the folders of their code, in the source tree."""
    return Measurement("stress", partial(all_parts, given), partial(assembled, given), tuple(sources))
