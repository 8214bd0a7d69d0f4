"""What a study keeps beside its record: the file of all rows, and columns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class ExportRecord:
    """The file of all rows that this study wrote, and its checksum."""

    file: str
    sha256: str


@dataclass(frozen=True)
class TableRecord:
    """A study whose results stand in columns: where (beside the record), how many, how many of them are `rows` of the record.

    `outcomes` are counted over all of them; `seconds` are those of all workers.
    """

    folder: str
    rows: int
    shown: int
    outcomes: Mapping[str, int]
    seconds: float
