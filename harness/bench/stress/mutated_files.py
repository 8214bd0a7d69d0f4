"""Mutated input files: a fuzz that is given, run in processes of its own; its rows summed by kind."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Final

from harness.bench import programs
from harness.campaign.parts import Row
from harness.records.stress import Harm, Mutated

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
