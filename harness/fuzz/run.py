"""Read mutated files: each must be read, or refused by a mistake that says what is wrong."""

from __future__ import annotations

import signal
import tempfile
import traceback
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any, Final

from harness.errors import InputError
from harness.fuzz.mutate import mutated
from harness.fuzz.originals import Kind, kinds, prepare
from meshes import MeshError

Row = dict[str, Any]

HANG_S: Final = 10
"""Longest time for one small file; reading takes milliseconds."""
EXAMPLES: Final = 5
"""Failures kept in the record for each kind, with the seed that makes them again."""


PIECE: Final = 100
"""Inputs of one piece of work."""
COUNTS: Final = ("inputs", "tracebacks", "hangs", "half_written")


class Hang(Exception):
    """Reading a file took too long."""


@contextmanager
def limited(seconds: int) -> Iterator[None]:
    """Raise `Hang` inside the block after so many seconds (main thread only)."""

    def stop(number: int, frame: FrameType | None) -> None:
        raise Hang

    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def attempt(kind: Kind, content: bytes, folder: Path) -> str | None:
    """Read one file in `folder`; what went wrong, or None when it was read or refused as it should be."""
    path = folder / kind.file
    path.write_bytes(content)
    before = {item.name for item in folder.iterdir()}
    try:
        with limited(HANG_S), warnings.catch_warnings():
            warnings.simplefilter("error")
            kind.read(path)
    except (InputError, MeshError) as refusal:
        return None if str(refusal).strip() else "refused without a word"
    except Hang:
        return "hang"
    except Exception:  # noqa: BLE001 any other exception is what this looks for
        return traceback.format_exc(limit=-3)
    finally:
        left = {item.name for item in folder.iterdir()} - before
        for name in left:
            (folder / name).unlink()
    return f"left {', '.join(sorted(left))}" if left else None


def fuzz(inputs: int, seed: int = 0) -> list[Row]:
    """Read `inputs` mutated files, shared among the kinds; one row for each kind, failures with their seeds."""
    return summed([row for task in tasks(inputs, seed) for row in compute(task)])


def tasks(inputs: int, seed: int = 0) -> list[str]:
    """At least so many inputs in pieces that can be computed apart: a kind and the first and last of its seeds."""
    each = -(-inputs // len(kinds()))
    return [
        f"{kind.name}: {begin} to {min(begin + PIECE, seed + each) - 1}"
        for kind in kinds()
        for begin in range(seed, seed + each, PIECE)
    ]


def compute(task: str) -> list[Row]:
    """The row of one piece."""
    kind, seeds = _piece(task)
    with tempfile.TemporaryDirectory(prefix="rockcheck-fuzz-") as name:
        folder = Path(name)
        prepare(folder)
        return [_row(kind, seeds, folder)]


def died(task: str) -> list[Row]:
    """The row of a piece that took its process with it."""
    kind, seeds = _piece(task)
    found = [{"seed": seeds[0], "what": f"the process died in seeds {seeds[0]} to {seeds[-1]}"}]
    return [{"reader": kind.name, "inputs": len(seeds), "tracebacks": 1, "hangs": 0, "half_written": 0, "found": found}]


def summed(rows: Sequence[Row]) -> list[Row]:
    """One row for each kind of file from the rows of its pieces."""
    found: dict[str, Row] = {}
    for row in rows:
        known = found.setdefault(row["reader"], {"reader": row["reader"], **dict.fromkeys(COUNTS, 0), "found": []})
        for name in COUNTS:
            known[name] += row[name]
        known["found"] = [*known["found"], *row["found"]][:EXAMPLES]
    return list(found.values())


def _piece(task: str) -> tuple[Kind, range]:
    name, _, span = task.partition(": ")
    first, _, last = span.partition(" to ")
    return next(kind for kind in kinds() if kind.name == name), range(int(first), int(last) + 1)


def _row(kind: Kind, seeds: Sequence[int], folder: Path) -> Row:
    whole = attempt(kind, kind.content, folder)
    found: list[dict[str, Any]] = [] if whole is None else [{"seed": None, "what": whole}]
    counts = dict.fromkeys(COUNTS, 0) | {"inputs": len(seeds), "tracebacks": int(whole is not None)}
    for seed in seeds:
        wrong = attempt(kind, mutated(kind.content, seed, kind.ways), folder)
        if wrong is None:
            continue
        counts["hangs" if wrong == "hang" else "half_written" if wrong.startswith("left ") else "tracebacks"] += 1
        if len(found) < EXAMPLES:
            found.append({"seed": seed, "what": wrong})
    return {"reader": kind.name, **counts, "found": found}
