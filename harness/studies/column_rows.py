"""The rows of a study whose results stand in columns, all of them or a coarser grid, read block by block."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from harness.model.history import History
from harness.records.study import TableRecord
from harness.runs.column_store import SECONDS, ColumnStore
from harness.runs.store import PlannedRow
from harness.studies import case_selection as selection
from harness.studies.case_columns import rows_of
from harness.studies.file import StudyFile

MOST_WHOLE: Final = 110_000
"""Rows that a page and its record still hold whole: a map of 330 × 330, a record of 110 MB; beyond it"""
MOST_SHOWN: Final = 20_000
"""they hold a coarser grid of so many."""


@dataclass(frozen=True)
class ColumnRows:
    """Rows of a study as `Store.rows` gives them; of each axis every `strides`-th value, the samples last."""

    store: ColumnStore
    study: StudyFile
    strides: Sequence[int] | None = None

    def rows(self, study: str) -> Iterator[PlannedRow]:
        """The rows in order, one block in memory at a time."""
        keys = [*(item.key for item in self.study.vary), *(item.key for item in self.study.scatter)]
        for table in self.store.tables():
            taken = table if self.strides is None else table.filter(self._chosen(table["number"].to_numpy()))
            for number, varied, run in rows_of(taken, keys):
                yield PlannedRow(number, selection.REFERENCE, None, selection.EVERY, varied, run)

    def history(self, key: str) -> History | None:
        """None was kept."""
        return None

    def seconds(self, key: str) -> float | None:
        """A row's own are not known: see `table`."""
        return None

    def _chosen(self, numbers: NDArray[np.int64]) -> NDArray[np.bool_]:
        places = np.unravel_index(numbers, [*self.study.sizes, len(self.study.variant)])
        chosen = [place % stride == 0 for place, stride in zip(places, self.strides or (), strict=False)]
        return np.asarray(np.logical_and.reduce(chosen))


def thinned(store: ColumnStore, study: StudyFile, most: int | None = None) -> ColumnRows:
    """All rows of a study that is shown whole, else those of a coarser grid of at most so many, thinned where it is longest."""
    most = most or (study.runs if study.runs <= MOST_WHOLE else MOST_SHOWN)
    sizes = study.sizes
    strides = [1] * len(sizes)
    while math.prod(-(-n // k) for n, k in zip(sizes, strides, strict=True)) * len(study.variant) > most:
        longest = max(range(len(sizes)), key=lambda axis: -(-sizes[axis] // strides[axis]))
        strides[longest] += 1
    return ColumnRows(store, study, strides)


def table(store: ColumnStore, study: StudyFile, shown: int) -> TableRecord:
    """What the columns hold, counted over all of them."""
    outcomes: Counter[str] = Counter()
    seconds = 0.0
    for each in store.tables():
        outcomes.update({item["values"]: item["counts"] for item in each["outcome"].value_counts().to_pylist()})
        seconds += float((each.schema.metadata or {})[SECONDS])
    rows = outcomes.total()
    folder = f"{store.folder.parent.name}/{store.folder.name}"
    return TableRecord(folder, rows, shown, dict(sorted(outcomes.items())), seconds)
