"""The rows of a study as its store holds them: typed once, for all that is counted, judged and shown of them."""

from __future__ import annotations

import sys
from dataclasses import dataclass

from harness.records.study import CaseRun, StudyRow
from harness.runs.store import Store
from harness.studies.column_rows import ColumnRows


@dataclass(frozen=True, kw_only=True, eq=False)
class KeyedRow(StudyRow):
    """A row with the key of its result in the store."""

    key: str | None


def study_rows(store: Store | ColumnRows, study: str) -> list[KeyedRow]:
    """All rows of a study; words that many rows share are one string, for there may be a million of them."""
    return [
        KeyedRow(
            number=row.number,
            engine=row.engine,
            reason=sys.intern(row.reason),
            varied={sys.intern(key): value for key, value in row.varied.items()},
            run=None if row.run is None else CaseRun.stored(row.run),
            key=row.key,
        )
        for row in store.rows(study)
    ]
