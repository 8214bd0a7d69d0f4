"""The record of two histories from files, compared; both lie beside it in the contract's units."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final, Literal

from harness.model.finding import Say
from harness.records.base import Record
from harness.records.scores import Scores

FILES: Final = ("history_a.csv", "history_b.csv")
"""The two histories beside the record, the reference second."""


@dataclass(frozen=True, kw_only=True, eq=False)
class CompareRecord(Record):
    """`result.json` of `rockcheck compare A.csv B.csv --out DIR`."""

    kind: Literal["compare"] = "compare"
    scores: Scores

    def texted(self, say: Say) -> CompareRecord:
        """The record with its sentences."""
        return replace(super().texted(say), scores=self.scores.texted(say))
