"""Clients of Bullet, kept from one run to the next: to start and end one costs more than many a run.

A kept client is emptied (`resetSimulation` makes a new world with new solver and new numbering) and every parameter is sent
again, so a run does not see what ran before. A client whose run failed is ended, not kept.
"""

from __future__ import annotations

import os
from typing import Final

import pybullet

from harness.engines.base import EngineFailure

MOST_IDLE: Final = 2
"""Clients kept at once at most: a run and one inside it."""

_idle: list[tuple[int, int]] = []
"""Process and number of each client that is not in use."""


def take() -> int:
    """An empty client of this process, for one run at a time. Raises `EngineFailure` when no client can be had."""
    while _idle:
        process, client = _idle.pop()
        # A process that was forked has its parent's list, whose clients are not its own.
        if process == os.getpid() and pybullet.isConnected(client):
            break
    else:
        client = int(pybullet.connect(pybullet.DIRECT))
        if client < 0:
            raise EngineFailure("pybullet gave no client")
    pybullet.resetSimulation(physicsClientId=client)
    return client


def give_back(client: int, *, sound: bool) -> None:
    """Keep a client for the next run, or end it: when its run failed (`sound` false) or enough are kept."""
    if sound and len(_idle) < MOST_IDLE:
        _idle.append((os.getpid(), client))
    elif pybullet.isConnected(client):
        pybullet.disconnect(client)
