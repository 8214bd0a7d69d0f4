"""Who hears that code is being compiled, which takes half a minute once after an upgrade."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

OnCompile = Callable[[int, int], None]
"""Called as functions are compiled: how many are begun and how many there are, at the end as many as there are."""
_listeners: Final[list[OnCompile]] = []


def listen(on_compile: OnCompile) -> None:
    """Have it called whenever code has to be compiled."""
    _listeners.append(on_compile)


def unlisten(on_compile: OnCompile) -> None:
    """Have it called no more."""
    _listeners.remove(on_compile)


def say(done: int, total: int) -> None:
    """Call them all."""
    for each in _listeners:
        each(done, total)
