"""The record of a measured set that is told by tables: planar drops, or ratios at first impacts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

from harness.model.run import OMITTED
from harness.records.base import Record

Cell = str | float | None


@dataclass(frozen=True)
class MeasuredTable:
    """One table: `name` says what its rows are, `columns` carry their units."""

    name: str
    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]


@dataclass(frozen=True, kw_only=True, eq=False)
class MeasuredRecord(Record):
    """`result.json` of `rockcheck validate` on measured drops or impact ratios; the first table is the one to read."""

    kind: Literal["measured"] = "measured"
    title: str = ""
    about: Literal["drops", "impact_ratios"]
    source: str
    body: str | None = field(default=None, metadata=OMITTED)
    samples: int | None = field(default=None, metadata=OMITTED)
    tables: Sequence[MeasuredTable]
    seed: int = 0
    seconds: float
