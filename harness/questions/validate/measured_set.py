"""What every measured set takes beside its own reading and scoring: a folder to be written, a body, one record of tables."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from harness.input.paths import read_files
from harness.input.scene_file import load_scene
from harness.model import run as record
from harness.model.errors import InputError, Mistake
from harness.model.finding import Say
from harness.model.scene import Scene
from harness.records.result_folder import COMING, PAGES, RECORD, check_folder, check_inputs, write_whole
from harness.records.validation import About, Cell, MeasuredRecord, MeasuredTable

FITTED: Final = 1.0 / 3.0
"""Share of a set on which coefficients are fitted."""
Rows = list[Sequence[Cell]]


class MeasuredSet:
    """A table of measurements, the scene of the body where one was thrown, and the folder that its record goes to."""

    def __init__(self, table: Path, folder: Path, body: Path | None = None) -> None:
        self._start_s = time.perf_counter()
        self.table, self._folder, self._body = table, folder, body
        self._base = None if body is None else _thrown(body)
        names = [RECORD, COMING, *PAGES]
        check_folder(folder, ("measured",), names)
        files = [] if self._base is None else read_files(self._base.given, self._base.source)
        check_inputs(folder, names, [table, *files])

    @property
    def base(self) -> Scene:
        """The scene whose statue was thrown."""
        assert self._base is not None
        return self._base

    def written(
        self, about: About, title: str, tables: Sequence[MeasuredTable], say: Say, **fields: Any
    ) -> MeasuredRecord:
        """The record, written: the first table is the one to read."""
        result = MeasuredRecord(
            title=title,
            about=about,
            source=self.table.name,
            body=None if self._body is None else self._body.name,
            tables=tables,
            versions=record.versions(),
            machine=record.machine(),
            seconds=time.perf_counter() - self._start_s,
            **fields,
        )
        return write_whole(self._folder, result.texted(say))


def _thrown(path: Path) -> Scene:
    """The scene whose statue is thrown. Raises `InputError` for one with a pedestal or a wall, which no measured throw has."""
    base = load_scene(path)
    beside = [name for name in ("pedestal", "wall") if getattr(base, name) is not None]
    if beside:
        raise InputError([Mistake(str(path), name, "a body alone over the floor", "one beside it") for name in beside])
    return base


def shares(count: int, seed: int) -> tuple[list[int], list[int]]:
    """Numbers of a set's members that are fitted on, a seeded third, and of those that are scored."""
    order = np.random.default_rng(seed).permutation(count).tolist()
    most = max(round(FITTED * count), 1)
    return sorted(order[:most]), sorted(order[most:])
