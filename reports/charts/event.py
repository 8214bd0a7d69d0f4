"""The event within a run: the stretch of time on which charts open, and from which the replay begins."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

import numpy as np

from harness.model.history import History
from reports.source import RunSource

MOVED_SHARE: Final = 0.01
"""A rotation of this share of the balance point's shows on a page."""
MOVED_M: Final = 1e-4
"""A slip that shows on a page."""
BESIDE: Final = 0.05
LEAST_BESIDE_S: Final = 0.25
"""Room before and after an event: a share of its length, and at least the time in which an eye finds its place."""


def event_s(histories: Iterable[History], level_rad: float, end_s: float) -> tuple[float, float]:
    """From shortly before anything moves to shortly after it has come to its last place: what a chart opens on, s.

    A rotation of `level_rad` counts as moving, a slip of `MOVED_M`; the whole of a run in which nothing moves.
    """
    starts, ends = [], []
    for history in histories:
        for values, least in ((history.theta_rad, level_rad), (history.slip_m, MOVED_M)):
            gone, left = (np.flatnonzero(np.abs(values - values[k]) > least) for k in (0, -1))
            if len(gone):
                starts.append(float(history.t_s[gone[0]]))
                ends.append(float(history.t_s[left[-1]]))
    if not starts:
        return 0.0, end_s
    begin, end = min(starts), max(ends)
    margin = max(BESIDE * (end - begin), LEAST_BESIDE_S)
    return max(0.0, begin - margin), min(end_s, end + margin)


def run_event_s(source: RunSource) -> tuple[float, float]:
    """The event of a run."""
    statue = source.scene.statue
    level_rad = MOVED_SHARE * min(statue.slenderness_left_rad, statue.slenderness_right_rad)
    return event_s(source.histories.values(), level_rad, source.scene.duration_s)
