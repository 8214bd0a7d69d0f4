"""Where compiled code is kept: one folder for each state of the sources, the newest two of them.

The compiler's own cache notices a change of a function's file, not one of a file that it calls into: so the cache stands in
a folder named after the digest of all compiled sources. What is kept there is run: so it is taken only from folders into which
nobody else can write.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import shutil
import stat
import tempfile
import warnings
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Final

MOST_FOLDERS: Final = 2
"""Folders kept: this state of the sources and the one before, to which one may go back."""
PREFIX: Final = "compiled-"
KERNEL: Final = Path(__file__).resolve().parent / "kernel"
"""The room whose sources every other room of compiled code uses."""
OTHERS: Final = stat.S_IWGRP | stat.S_IWOTH
"""Bits of a mode that let others write."""


def digest(*rooms: Path) -> str:
    """Digest of every source in the folders of compiled code; nothing outside them may decide what is compiled."""
    state = hashlib.sha256()
    for room in rooms:
        for source in sorted(room.glob("*.py")):
            state.update(source.read_bytes())
    return state.hexdigest()[:16]


def homes(sources: Path) -> Iterator[Path]:
    """Where a cache may stand, best first: beside the sources, in the user's cache, among temporary files."""
    yield sources / "__pycache__"
    given = os.environ.get("XDG_CACHE_HOME")
    with contextlib.suppress(RuntimeError):  # nobody's home is known
        yield (Path(given) if given else Path.home() / ".cache") / "rockcheck"
    user = os.getuid() if hasattr(os, "getuid") else os.environ.get("USERNAME", "")
    yield Path(tempfile.gettempdir()) / f"rockcheck-{user}"


def folder(sources: Path, *shared: Path) -> Path | None:
    """The folder for the compiled code of these sources and those that they share, older ones removed; None where nothing can be
    written."""
    name = PREFIX + digest(sources, *shared)
    for home in homes(sources):
        chosen = home / name
        known = chosen.is_dir()
        if not (_private(home, sources) and _writable(chosen) and _private(chosen, sources)):
            continue
        if not known:
            prune(home)
        return chosen
    return None


@cache
def home_of(room: Path = KERNEL) -> Path | None:
    """Folder of the compiled code of a room's very sources; None, with a warning, where nothing can be written."""
    chosen = folder(room, *([] if room == KERNEL else [KERNEL]))
    if chosen is None:
        message = "no folder can be written in which to keep compiled code: every start compiles it again (set XDG_CACHE_HOME)"
        warnings.warn(message, RuntimeWarning, stacklevel=2)
    return chosen


def prune(home: Path, most: int = MOST_FOLDERS) -> None:
    """Remove all but the newest folders of compiled code.

    Safe while other processes run: the compiler takes a file that is gone for one that was never written.
    """
    folders = []
    for each in home.glob(PREFIX + "*"):
        try:
            folders.append((each.stat().st_mtime_ns, each))
        except FileNotFoundError:  # removed by another process just now
            continue
    for _, old in sorted(folders, reverse=True)[most:]:
        shutil.rmtree(old, ignore_errors=True)


def _private(path: Path, sources: Path) -> bool:
    """Whether a folder, made where it is not there yet, is no link and its user's own, and nobody else may write into it.

    Beside the sources it may be theirs who own these, and as open as these: who can write there can change the code itself.
    """
    try:
        path.mkdir(mode=0o700, parents=True, exist_ok=True)
        seen, above, code = path.lstat(), path.parent.stat(), sources.stat()
    except OSError:
        return False
    if not hasattr(os, "getuid"):  # folders have no such owner
        return not path.is_symlink()
    owners, open_to = {os.getuid()}, 0
    if sources in path.parents:
        owners, open_to = owners | {code.st_uid}, code.st_mode
    # Where others may write and no sticky bit holds them off, they could put a folder of theirs in its place.
    replaceable = above.st_mode & OTHERS & ~open_to and not above.st_mode & stat.S_ISVTX
    return (
        stat.S_ISDIR(seen.st_mode) and seen.st_uid in owners and not (seen.st_mode & OTHERS & ~open_to or replaceable)
    )


def _writable(chosen: Path) -> bool:
    """Whether files can be made there, tried rather than asked: the superuser is told yes of a read-only disk."""
    try:
        chosen.mkdir(mode=0o700, exist_ok=True)
        with tempfile.TemporaryFile(dir=chosen):
            return True
    except OSError:
        return False
