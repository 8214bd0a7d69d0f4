"""pybullet as an engine; its first import, without the line that its C code writes to stderr."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Final

STDERR: Final = 2


@contextmanager
def _without_banner() -> Iterator[None]:
    """Keep the line that pybullet's C code writes to stderr at its first import from the user's terminal."""
    try:
        stderr_copy = os.dup(STDERR)
    except OSError:  # stderr is closed: nothing to keep from it
        yield
        return
    try:
        with open(os.devnull, "wb") as nowhere:
            os.dup2(nowhere.fileno(), STDERR)
        yield
    finally:
        os.dup2(stderr_copy, STDERR)
        os.close(stderr_copy)


# Where it is not installed, the engine is still listed, and says so itself (`Bullet3D.missing`).
with _without_banner(), suppress(ImportError):
    import pybullet  # noqa: F401
