"""What pages carry that depends on the installed versions only: made once, kept in the user's cache folder."""

from __future__ import annotations

import contextlib
import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Final

from meshes import array_cache

ROOM: Final = "pages"
KEPT: Final = 2
"""Texts kept of each name: of this installed version, and of the one before, to which one may go back."""


def folder() -> Path | None:
    """The user's own folder for what pages carry; None where none is safe: what lies there runs in the reader's browser."""
    return array_cache.folder(ROOM)


def made_once(name: str, state: bytes, make: Callable[[], str]) -> str:
    """The text that `make` gives for `state` (everything that decides it): kept under a digest of it, made where none is kept.

    The text's own digest stands before it: a file that was damaged is made again.
    """
    home = folder()
    if home is None:
        return make()
    file = home / f"{name}-{hashlib.sha256(state).hexdigest()[:32]}.txt"
    with contextlib.suppress(OSError, UnicodeDecodeError):
        mark, _, text = file.read_text(encoding="utf-8").partition("\n")
        if mark == _digest(text):
            return text
    text = make()
    array_cache.put(file, f"{_digest(text)}\n{text}".encode())
    array_cache.prune(home, f"{name}-*.txt", KEPT)
    return text


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
