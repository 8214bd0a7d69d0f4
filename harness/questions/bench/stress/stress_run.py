"""The stress run: hard scenes, stability maps, mutated inputs, on all cores and in parts; one record."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Final

from harness import engines
from harness.questions.bench import programs
from harness.questions.bench.stress import hard_scenes as scenes
from harness.questions.bench.stress import stability
from harness.questions.bench.stress.catalogue import ALL
from harness.records.bench import HardRow, Harm, Mutated, StabilityCell, StressRecord, answer_of, findings_of
from harness.runs.parts import Measurement, Part, Row

# Mutated input files: a fuzz that is given, run in processes of its own; its rows summed by kind.

PIECE: Final = 5000
"""Inputs of one process, of all kinds in turn: it first uses a whole file of each, which takes seconds."""
COUNTS: Final = ("inputs", "accepted", "tracebacks", "hangs", "half_written")
EXAMPLES: Final = 5
"""Failures kept in the record for each kind, with the seed that makes them again."""
HARM: Final = 3
"""Exit status of a fuzz that came to its end and found a file that did harm."""
SAID: Final = 2000
"""Characters of what a process that died said last."""


def tasks(inputs: int) -> list[str]:
    """So many inputs in pieces that can be computed apart."""
    return [f"inputs {k} to {min(k + PIECE, inputs) - 1}" for k in range(0, inputs, PIECE)]


def compute(program: str, task: str) -> list[Row]:
    """A row for each kind of one piece, and one for the process where it died."""
    done = programs.ask(program, *task.removeprefix("inputs ").split(" to "))
    rows = [json.loads(line) for line in done.stdout.splitlines()]
    # A file that did harm is a row; a process that ended before its last kind is one more.
    return rows if done.returncode in (0, HARM) else [*rows, *died(f"{task}: {done.stderr[-SAID:]}")]


def died(task: str) -> list[Row]:
    """The row of a piece that took its process with it."""
    counts = dict.fromkeys(COUNTS, 0) | {"tracebacks": 1}
    return [
        {"reader": "a process that died", **counts, "said": [], "found": [{"seed": None, "what": f"died in {task}"}]}
    ]


def summed(rows: Sequence[Row]) -> list[Mutated]:
    """One row for each kind of file from the rows of all pieces."""
    kinds = []
    for name in dict.fromkeys(row["reader"] for row in rows):
        mine = [row for row in rows if row["reader"] == name]
        counts = {key: sum(row[key] for row in mine) for key in COUNTS}
        harm = [Harm(**item) for row in mine for item in row["found"]][:EXAMPLES]
        kinds.append(Mutated(name, **counts, refusals=len({text for row in mine for text in row["said"]}), found=harm))
    return kinds


INPUTS: Final = 20_000
QUICK_INPUTS: Final = 500


QUESTIONS, FUZZ, DEFAULTS = "questions", "fuzz", "engine defaults"
"""What programs that are given measure: invariances, mutated files, pybullet's own hull."""


def assembled(given: programs.Programs, rows: Mapping[str, Sequence[Any]], head: Mapping[str, Any]) -> StressRecord:
    """The record from the rows of all parts."""
    order = {row.name: place for place, row in enumerate(stability.difficulties())}
    made = StressRecord(
        absent=absent(given),
        scenes=[*rows["scenes"], *rows["questions"]],
        cells=sorted(rows["maps"], key=lambda cell: (stability.ENGINES.index(cell.engine), order[cell.difficulty])),
        fuzz=summed(rows["fuzz"]),
        **head,
    )
    return replace(made, answer=answer_of(made), findings=findings_of(made))


def absent(given: programs.Programs) -> dict[str, str]:
    """What cannot be run here, engines of the catalogue or what no program was given for, and why: nothing is said of it."""
    missing = {name: engines.load(name).missing() for name in ALL}
    known = {name: why for name, why in missing.items() if why is not None}
    return known | programs.absent(given, (QUESTIONS, FUZZ, DEFAULTS))


def all_parts(given: programs.Programs, quick: bool) -> list[Part]:
    """The parts, the one with the longest tasks first: all are computed side by side."""
    fuzz = tasks(QUICK_INPUTS if quick else INPUTS) if FUZZ in given else []
    asked = scenes.QUESTIONS if QUESTIONS in given and not quick else ()
    return [
        Part(
            "maps",
            stability.tasks(quick),
            partial(stability.compute, given.get(DEFAULTS), quick),
            stability.died,
            StabilityCell,
        ),
        Part("scenes", scenes.tasks(quick), scenes.compute, scenes.died, HardRow),
        Part("questions", asked, partial(scenes.answer, given.get(QUESTIONS, "")), scenes.died, HardRow),
        Part("fuzz", fuzz, partial(compute, given.get(FUZZ, "")), died),
    ]


def stress(given: programs.Programs = programs.NONE, sources: Sequence[str] = ()) -> Measurement[StressRecord]:
    """The stress run with what these programs measure; `sources` are the folders of their code, in the source tree."""
    return Measurement("stress", partial(all_parts, given), partial(assembled, given), tuple(sources))
