"""Before two models are said to differ, a contact engine's run is made again to a finer target."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from harness.records.scores import ROBUST, Scores

CONFIRMATION_FACTOR: Final = 4.0
"""The finer run's target is this many times smaller: some two halvings of the step."""
SURE: Final = 30.0
"""A difference of this many times its limit is no luck of two runs that agree: none was off by more than twelve times what it
stated on 303 scenes before their sensitivity was asked."""


def doubted(scores: Mapping[str, Scores]) -> set[str]:
    """The engines of pairs that are said to differ robustly, by less than `SURE` times their limit."""
    return {name for each in scores.values() if each.verdict in ROBUST and _close(each) for name in (each.a, each.b)}


def _close(scores: Scores) -> bool:
    seen = scores.evidence
    if seen.differs_in == "slip":
        return seen.largest_reliable_slip_difference_m < SURE * seen.slip_limit_m
    return seen.largest_reliable_difference_rad < SURE * seen.limit_rad
