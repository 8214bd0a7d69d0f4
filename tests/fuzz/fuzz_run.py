"""Read mutated files: each must be read, or refused by a mistake that says what is wrong."""

import faulthandler
import re
import resource
import shutil
import signal
import tempfile
import traceback
import warnings
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from typing import Any, Final

from harness.model import InputError
from meshes import MeshError
from tests.fuzz.mutate import mutated
from tests.fuzz.originals import Kind, kinds, prepare
from tests.fuzz.pieces import COUNTS, EXAMPLES, Row
from tests.fuzz.use import WRITTEN, unfinished

HANG_S: Final = 10
"""Most processor time for one small file; reading takes milliseconds."""
START_S: Final = 120
"""The same for the first, whole file of a kind: it imports and compiles what its use takes."""
MOST_MIB: Final = 2048.0
"""Of memory for one small file."""
DEAD_SHARE: Final = 20.0
"""Times that limit, by the clock of a busy machine, after which a process that does not even hear of it, or sleeps, is ended."""


class Hang(Exception):
    """Reading a file took too long."""


@contextmanager
def limited(seconds: int) -> Iterator[None]:
    """Raise `Hang` inside the block after so many seconds of processor time (main thread only)."""

    def stop(number: int, frame: FrameType | None) -> None:
        raise Hang

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    # Compiled code that never comes back hears no signal: the process ends, which its pool counts as a failure.
    faulthandler.dump_traceback_later(DEAD_SHARE * seconds, exit=True)
    try:
        yield
    finally:
        faulthandler.cancel_dump_traceback_later()
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


@dataclass(frozen=True)
class Tried:
    """What came of one file: what went `wrong`, or None; else the `refusal`, or None where the file was accepted."""

    wrong: str | None = None
    refusal: str | None = None


def attempt(kind: Kind, content: bytes, folder: Path, limit_s: int | None = None) -> Tried:
    """Use one file in `folder`, for `HANG_S` unless told otherwise, and clear away what it left."""
    path = folder / kind.file
    path.write_bytes(content)
    before, most = {item.name for item in folder.iterdir()} | {WRITTEN}, _most_mib()
    tried = _tried(kind, path, limit_s or HANG_S)
    grown = _most_mib() if _most_mib() > most else 0.0
    left = {item.name for item in folder.iterdir()} - before
    half = unfinished(folder / WRITTEN, accepted=tried == Tried())
    for item in [folder / name for name in (*left, WRITTEN)]:
        shutil.rmtree(item) if item.is_dir() else item.unlink(missing_ok=True)
    if tried.wrong is None and (left or half):
        return Tried(f"left {', '.join(sorted(left))}" if left else f"left half-written: {half}")
    if tried.wrong is None and grown > MOST_MIB:
        return Tried(f"took {grown:.0f} MiB")
    return tried


def _most_mib() -> float:
    """The most memory that this process has taken so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def _tried(kind: Kind, path: Path, limit_s: int) -> Tried:
    try:
        with limited(limit_s), warnings.catch_warnings():
            warnings.simplefilter("error")
            kind.read(path)
    except (InputError, MeshError) as refusal:
        said = str(refusal).strip()
        return Tried(refusal=said) if said else Tried("refused without a word")
    except Hang:
        return Tried("hang")
    except Exception:  # noqa: BLE001 any other exception is what this looks for
        return Tried(traceback.format_exc(limit=-3))
    return Tried()


def rows(first: int, last: int) -> Iterator[Row]:
    """Use the inputs of these numbers; a row for each kind, failures with their seeds. Kinds take turns from input to input."""
    every = kinds()
    with tempfile.TemporaryDirectory(prefix="rockcheck-fuzz-") as name:
        folder = Path(name)
        prepare(folder)
        for number, kind in enumerate(every):
            # The least seed of this kind whose input is not before the first.
            begin = -((number - first) // len(every))
            if seeds := range(begin, (last - number) // len(every) + 1):
                yield _row(kind, seeds, folder)


def _row(kind: Kind, seeds: Sequence[int], folder: Path) -> Row:
    whole = attempt(kind, kind.content, folder, START_S)
    found: list[dict[str, Any]] = [] if whole == Tried() else [{"seed": None, "what": whole.wrong or whole.refusal}]
    counts = dict.fromkeys(COUNTS, 0) | {"inputs": len(seeds), "tracebacks": len(found)}
    said: set[int] = set()
    for seed in seeds:
        tried = attempt(kind, mutated(kind.content, seed, kind.ways), folder)
        if tried.wrong is None:
            counts["accepted"] += tried.refusal is None
            said.update(() if tried.refusal is None else (sentence_of(tried.refusal, folder),))
            continue
        hangs, left = tried.wrong == "hang", tried.wrong.startswith("left ")
        counts["hangs" if hangs else "half_written" if left else "tracebacks"] += 1
        if len(found) < EXAMPLES:
            found.append({"seed": seed, "what": tried.wrong})
    return {"reader": kind.name, **counts, "said": sorted(said), "found": found}


def sentence_of(refusal: str, folder: Path) -> int:
    """A number for the kind of a refusal: its first sentence without the folder, quoted words and digits."""
    bare = re.sub(r"'[^']*'|[-+]?\d[\d.e+-]*", "#", refusal.splitlines()[0].replace(str(folder), ""))
    return zlib.crc32(bare.encode("utf-8", "replace"))
