"""Read mutated files: each must be read, or refused by a mistake that says what is wrong."""

from __future__ import annotations

import signal
import tempfile
import traceback
import warnings
from collections.abc import Callable, Iterator, Sequence
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


def fuzz(inputs: int, seed: int = 0, told: Callable[[str], None] = lambda text: None) -> list[Row]:
    """Read `inputs` mutated files, shared among the kinds; one row for each kind, failures with their seeds."""
    with tempfile.TemporaryDirectory(prefix="rockcheck-fuzz-") as name:
        folder = Path(name)
        prepare(folder)
        every = kinds()
        return [_kind(kind, range(seed, seed + inputs // len(every)), folder, told) for kind in every]


def _kind(kind: Kind, seeds: Sequence[int], folder: Path, told: Callable[[str], None]) -> Row:
    told(f"mutated input: {kind.name}")
    whole = attempt(kind, kind.content, folder)
    found: list[dict[str, Any]] = [] if whole is None else [{"seed": None, "what": whole}]
    counts = {"tracebacks": 0, "hangs": 0, "half_written": 0}
    for seed in seeds:
        wrong = attempt(kind, mutated(kind.content, seed, kind.ways), folder)
        if wrong is None:
            continue
        counts["hangs" if wrong == "hang" else "half_written" if wrong.startswith("left ") else "tracebacks"] += 1
        if len(found) < EXAMPLES:
            found.append({"seed": seed, "what": wrong})
    return {"reader": kind.name, "inputs": len(seeds), **counts, "found": found}
