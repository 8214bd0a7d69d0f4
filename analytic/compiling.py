"""Who hears that code is being compiled, which takes half a minute once after an upgrade."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

OnCompile = Callable[[int, int], None]
"""Called as functions are compiled: how many are begun and how many there are, at the end as many as there are."""
listeners: Final[list[OnCompile]] = []
"""Called whenever code has to be compiled: whoever wants to hear of it adds itself, and takes itself away."""


def say(done: int, total: int) -> None:
    """Call them all."""
    for each in listeners:
        each(done, total)
