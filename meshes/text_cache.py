"""Texts that are costly to compute, kept in the user's cache folder under a digest of what they were computed from.

The folder is `rockcheck/meshes` in XDG_CACHE_HOME or `~/.cache`. It may be removed at any time. Where none can be written, or
where others could write into it, nothing is kept.
"""

import contextlib
import hashlib
import os
import stat
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Final

MOST_FILES: Final = 64
"""Texts kept of a name, the last used ones: some 100 KB each."""


def folder(room: str = "meshes") -> Path | None:
    """Where files are kept, made where it is not there yet; None when nobody's home is known or the folder is not its own user's.

    Parts that someone else put there would change results unseen: it and the folder around it are no links, and only their
    owner, who runs this, may write into them.
    """
    given = os.environ.get("XDG_CACHE_HOME")
    try:
        home = (Path(given) if given else Path.home() / ".cache") / "rockcheck"
        for path in (home, home / room):
            path.mkdir(mode=0o700, parents=True, exist_ok=True)
            if not _private(path.lstat()):
                return None
    except (OSError, RuntimeError):
        return None
    return home / room


def _private(seen: os.stat_result) -> bool:
    mine = not hasattr(os, "getuid") or seen.st_uid == os.getuid()
    return stat.S_ISDIR(seen.st_mode) and mine and not seen.st_mode & (stat.S_IWGRP | stat.S_IWOTH)


def made_once(name: str, state: bytes, make: Callable[[], str], room: str = "meshes", most: int = MOST_FILES) -> str:
    """The text that `make` gives for `state` (everything that decides it): kept under a digest of it, made where none is kept.

    The text's own digest stands before it: a file that was damaged is made again. Of a name the `most` last used are kept.
    """
    home = folder(room)
    if home is None:
        return make()
    file = home / f"{name}-{hashlib.sha256(state).hexdigest()[:32]}.txt"
    with contextlib.suppress(OSError, UnicodeDecodeError):
        mark, _, text = file.read_bytes().decode().partition("\n")
        if mark == hashlib.sha256(text.encode()).hexdigest():
            os.utime(file)
            return text
    text = make()
    put(file, f"{hashlib.sha256(text.encode()).hexdigest()}\n{text}".encode())
    prune(home, f"{name}-*.txt", most)
    return text


def put(file: Path, content: bytes) -> None:
    """Write a file of a safe folder: beside and then renamed, so that no other process sees half of it."""
    with contextlib.suppress(OSError):  # a full or read-only disk: computed again the next time
        handle, name = tempfile.mkstemp(prefix="new-", suffix=".part", dir=file.parent)
        try:
            with os.fdopen(handle, "wb") as fresh:
                fresh.write(content)
            os.replace(name, file)
        finally:
            Path(name).unlink(missing_ok=True)


def prune(home: Path, names: str, most: int) -> None:
    """Remove all but the last used files of such names; one that another process removed meanwhile is gone all the same."""
    entries = []
    for file in home.glob(names):
        with contextlib.suppress(FileNotFoundError):
            entries.append((file.stat().st_mtime_ns, file))
    for _, old in sorted(entries, reverse=True)[most:]:
        old.unlink(missing_ok=True)
