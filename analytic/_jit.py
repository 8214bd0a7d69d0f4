"""One place for the compiler's options, with types kept.

The compiler's own cache notices a change of a function's file, not one of a file that it calls into: so the cache stands in
a folder named after the digest of all compiled
sources.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

import numba

P = ParamSpec("P")
R = TypeVar("R")


@cache
def _cache_folder() -> str:
    """Folder of the compiled code of these very sources, beside them if that can be written, else the user's cache."""
    here = Path(__file__).resolve().parent
    digest = hashlib.sha256()
    for source in sorted(here.glob("*.py")):
        text = source.read_bytes()
        if b"analytic._jit" in text or source.stem in ("_jit", "layout", "borrowed"):
            digest.update(text)
    pycache = here / "__pycache__"
    if not os.access(pycache if pycache.is_dir() else here, os.W_OK):
        pycache = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "rockcheck"
    return str(pycache / f"compiled-{digest.hexdigest()[:16]}")


def jit(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a function: cached on disk, without the interpreter's lock, IEEE division, no reordering of sums."""
    config: Any = numba.config
    theirs = config.CACHE_DIR
    config.CACHE_DIR = theirs or _cache_folder()
    try:
        compiled: Callable[P, R] = numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=False)(function)
    finally:
        config.CACHE_DIR = theirs
    return compiled
