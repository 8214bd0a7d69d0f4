"""Mutated input files in pieces, each in a process of its own; their rows summed by kind."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, Final

Row = dict[str, Any]

INPUTS: Final = 20_000
PIECE: Final = 5000
"""Inputs of one process, of all kinds in turn: it first uses a whole file of each, which takes seconds."""
COUNTS: Final = ("inputs", "accepted", "tracebacks", "hangs", "half_written")
EXAMPLES: Final = 5
"""Failures kept for each kind, with the seed that makes them again."""
HARM: Final = 3
"""Exit status of a fuzz that came to its end and found a file that did harm."""
SAID: Final = 2000
"""Characters of what a process that died said last."""


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


def tasks(inputs: int) -> list[tuple[str, str]]:
    """So many inputs in pieces that can be computed apart: first and last of each."""
    return [(str(k), str(min(k + PIECE, inputs) - 1)) for k in range(0, inputs, PIECE)]


def compute(piece: Sequence[str]) -> list[Row]:
    """A row for each kind of one piece, and one for the process where it died."""
    command = [sys.executable, "-m", "tests.fuzz", *piece]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    rows = [json.loads(line) for line in done.stdout.splitlines()]
    # A file that did harm is a row; a process that ended before its last kind is one more.
    return rows if done.returncode in (0, HARM) else [*rows, *died(f"{' to '.join(piece)}: {done.stderr[-SAID:]}")]


def died(what: str) -> list[Row]:
    """The row of a piece that took its process with it."""
    counts = dict.fromkeys(COUNTS, 0) | {"tracebacks": 1}
    found = [{"seed": None, "what": f"died in inputs {what}"}]
    return [{"reader": "a process that died", **counts, "said": [], "found": found}]


def whole(inputs: int = INPUTS) -> Iterator[list[Row]]:
    """The rows of each piece as it is done, as many at a time as there are cores."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        yield from pool.map(compute, tasks(inputs))


def summed(rows: Sequence[Row]) -> list[Mutated]:
    """One row for each kind of file from the rows of all pieces."""
    kinds = []
    for name in dict.fromkeys(row["reader"] for row in rows):
        mine = [row for row in rows if row["reader"] == name]
        counts = {key: sum(row[key] for row in mine) for key in COUNTS}
        harm = [Harm(**item) for row in mine for item in row["found"]][:EXAMPLES]
        kinds.append(Mutated(name, **counts, refusals=len({text for row in mine for text in row["said"]}), found=harm))
    return kinds
