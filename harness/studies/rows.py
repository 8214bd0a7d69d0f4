"""The rows of a study as its store holds them: typed once, for all that is counted, judged and shown of them."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, Final

from harness.campaign.store import Store
from harness.model.history import Outcome
from harness.model.run import impacts
from harness.records.study import CaseRun, StudyRow

STORED: Final = tuple(item.name for item in fields(CaseRun) if item.name not in ("outcome", "impacts", "warnings"))
"""What a study shows of a run as the store holds it."""


@dataclass(frozen=True, kw_only=True, eq=False)
class KeyedRow(StudyRow):
    """A row with the key of its result in the store."""

    key: str | None


def study_rows(store: Store, study: str) -> list[KeyedRow]:
    """All rows of a study; words that many rows share are one string, for there may be a million of them."""
    return [
        KeyedRow(
            number=row.number,
            engine=row.engine,
            reason=sys.intern(row.reason),
            varied={sys.intern(key): value for key, value in row.varied.items()},
            run=None if row.run is None else case_run(row.run),
            key=row.key,
        )
        for row in store.rows(study)
    ]


def case_run(stored: Mapping[str, Any]) -> CaseRun:
    """What a study shows of a run, from its stored record (`harness.records.run.EngineRunRecord`)."""
    same = {name: stored.get(name) for name in STORED}
    same["validity"] = {sys.intern(key): value for key, value in stored["validity"].items()}
    warnings = [sys.intern(text) for text in stored["warnings"]]
    return CaseRun(**same, outcome=Outcome(stored["outcome"]), warnings=warnings, impacts=impacts(stored))
