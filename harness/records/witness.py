"""The record of a witness: what an unmodified engine says of the runs beside it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

from harness.model.finding import Finding

PLAIN: Final = ":plain"
"""What the name of an unmodified engine adds to that of the event-located one."""
LEAST_S: Final = 1e-9
"""A shorter time is none."""


@dataclass(frozen=True)
class Judged:
    """One run held against a plain engine: whether they agree, until when, and how far the run is from that engine at most.

    `parts_s`: when they part by more than twice their joint numerical error, while both are bounded. `floor_impact`: the
    coefficient at impacts with which the model was run for it, where it is another than the scene's.
    """

    agrees: bool
    until_s: float
    to_rad: float
    parts_s: float | None = None
    floor_impact: str = ""


@dataclass(frozen=True)
class Witness:
    """What one plain engine says: until when it was computed and bounded, its own error, and each run judged against it.

    `reasons` say why it says nothing, or why no further than `until_s`. `steps`: of all its runs. `floor_impact`: which of two
    coefficients of the floor acts in it as an impact breaks the pedestal loose; empty where there is one.
    """

    engine: str
    until_s: float
    to_rad: float | None
    agrees: bool | None
    reasons: Sequence[Finding] = ()
    dt_s: float | None = None
    uncertainty_rad: float | None = None
    steps: int = 0
    runs: Mapping[str, Judged] = field(default_factory=dict)
    floor_impact: str = ""
