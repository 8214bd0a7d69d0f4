"""The rows of a study as its store holds them, one by one or in blocks: typed once, for all that is counted and shown of them."""

from __future__ import annotations

import math
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.questions.study.case_blocks import KIND
from harness.questions.study.case_columns import rows_of
from harness.questions.study.file import StudyFile
from harness.records.study import CaseRun, StudyRow, TableRecord
from harness.runs.store import STORE_NAME, PlannedRow, Store

Chosen = Callable[[NDArray[np.int64]], NDArray[np.bool_]]
MOST_WHOLE: Final = 110_000
"""Rows that a page and its record still hold whole: a map of 330 × 330, a record of 110 MB; beyond it"""
MOST_SHOWN: Final = 20_000
"""they hold a coarser grid of so many."""


@dataclass(frozen=True, kw_only=True, eq=False)
class KeyedRow(StudyRow):
    """A row with the key of its result in the store."""

    key: str | None


def every_row(store: Store, study: str, chosen: Chosen | None = None) -> Iterator[PlannedRow]:
    """All rows of a study in order, one block in memory at a time; of a block those that are `chosen` by their numbers (n,)."""
    for row in store.rows(study):
        if row.kind != KIND or row.key is None or row.run is None:
            yield row
            continue
        table = store.table(row.key)
        if chosen is not None:
            kept = chosen(table["number"])
            table = {name: values[kept] for name, values in table.items()}
        for number, varied, run in rows_of(table, row.run):
            yield PlannedRow(number, row.engine, None, row.reason, varied, run)


def study_rows(store: Store, study: str, chosen: Chosen | None = None) -> list[KeyedRow]:
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
        for row in every_row(store, study, chosen)
    ]


def coarser(study: StudyFile, most: int | None = None) -> Chosen:
    """Every row of a study that is shown whole, else those of a coarser grid of at most so many, thinned where it is longest."""
    most = most or (study.runs if study.runs <= MOST_WHOLE else MOST_SHOWN)
    sizes = study.sizes
    strides = [1] * len(sizes)
    while math.prod(-(-n // k) for n, k in zip(sizes, strides, strict=True)) * len(study.variant) > most:
        longest = max(range(len(sizes)), key=lambda axis: -(-sizes[axis] // strides[axis]))
        strides[longest] += 1

    def chosen(numbers: NDArray[np.int64]) -> NDArray[np.bool_]:
        places = np.unravel_index(numbers, [*sizes, len(study.variant)])
        on_grid = [place % stride == 0 for place, stride in zip(places, strides, strict=False)]
        return np.asarray(np.logical_and.reduce(on_grid))

    return chosen


def table(store: Store, study: str, shown: int) -> TableRecord | None:
    """What blocks hold, counted over all of them; None of a study whose rows stand one by one."""
    outcomes: Counter[str] = Counter()
    for row in store.rows(study):
        if row.kind != KIND or row.run is None:
            return None
        outcomes.update(row.run["outcomes"])  # type: ignore[arg-type]
    counts = dict(sorted(outcomes.items()))
    return TableRecord(STORE_NAME, outcomes.total(), shown, counts, sum(store.engine_seconds(study).values()))
