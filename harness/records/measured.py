"""The record of a measured set that is told by tables: tosses, planar drops, impact ratios; or of all that was checked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

from harness.model.run import OMITTED
from harness.records.base import Record

Cell = str | float | None
About = Literal["tosses", "drops", "impact_ratios", "checked"]


@dataclass(frozen=True)
class MeasuredTable:
    """One table: `name` says what its rows are, `columns` carry their units."""

    name: str
    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]


@dataclass(frozen=True, kw_only=True, eq=False)
class MeasuredRecord(Record):
    """`result.json` of `rockcheck validate` on a measured set; the first table is the one to read."""

    kind: Literal["measured"] = "measured"
    title: str = ""
    about: About
    source: str
    body: str | None = field(default=None, metadata=OMITTED)
    samples: int | None = field(default=None, metadata=OMITTED)
    tables: Sequence[MeasuredTable]
    seed: int = 0
    seconds: float
