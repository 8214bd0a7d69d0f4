"""A result folder as the pages read it: record, histories, mesh, and when anything moves; nothing is computed anew."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Final

import numpy as np

from harness.input.history_file import read_history
from harness.model import History, InputError, Mistake, Outcome, Run, history_file, refuse
from harness.records.base import RECORD, REWRITE, Record, as_written, read_result
from harness.records.run import RunRecord, has_answer, known_until_s
from harness.records.scene import SceneRecord

MOVED_SHARE: Final = 0.01
"""A rotation of this share of the balance point's shows on a page."""
MOVED_M: Final = 1e-4
"""A slip that shows on a page."""
PEAKS: Final = ("peak_lean_rad", "peak_lean_share", "peak_over_slenderness", "pedestal_tilt_share")
"""What a run says of its largest lean beside its history."""
BESIDE: Final = 0.05
LEAST_BESIDE_S: Final = 0.25
"""Room before and after an event: a share of its length, and at least the time in which an eye finds its place."""


@dataclass(frozen=True, eq=False)
class RunSource:
    """The record of one run with the histories that it names; `mesh` is the statue's mesh file, None without one."""

    folder: Path
    record: RunRecord
    histories: Mapping[str, History]
    mesh: Path | None

    @property
    def scene(self) -> SceneRecord:
        """The resolved scene."""
        return self.record.scene

    @property
    def runs(self) -> Mapping[str, Run]:
        """All engines' answers by name."""
        return self.record.runs

    @property
    def answered(self) -> dict[str, Run]:
        """The answers of the models that say something of the statue."""
        return {name: run for name, run in self.runs.items() if has_answer(run)}

    @property
    def standing(self) -> list[str]:
        """The models that answered with a history and in which the statue stands."""
        answered = self.answered
        return [name for name in self.histories if name in answered and answered[name].outcome is Outcome.STANDS]

    @property
    def within_domain(self) -> RunSource:
        """The same, of what models tell within their domain where one stays in it: histories of those in which it stands, the
        pedestal's slips of all."""
        runs, histories = dict(self.runs), dict(self.histories)
        known = known_until_s({name: run for name, run in self.answered.items() if name in histories})
        for name, until_s in known.items():
            if until_s < runs[name].end_s:
                slip_m = histories[name].until(until_s).slip_m
                runs[name] = replace(runs[name], peak_slip_m=float(np.abs(slip_m).max()))
        for name, until_s in known_until_s({name: self.runs[name] for name in self.standing}).items():
            histories[name] = histories[name].until(until_s)
            if until_s < runs[name].peaks_until_s:
                told = {key: value for key, value in runs[name].validity.items() if key not in PEAKS}
                runs[name] = replace(runs[name], validity=told)
        return replace(self, record=replace(self.record, runs=runs), histories=histories)


def run_source(folder: Path) -> RunSource:
    """The record of a run and its histories; raises `InputError` for a damaged folder, or one of another kind."""
    record = read_result(folder)
    if not isinstance(record, RunRecord):
        raise InputError(Mistake(str(folder / RECORD), "kind", "run", repr(record.kind)))
    return source_of(folder, record)


@lru_cache(maxsize=1)
def source_of(folder: Path, record: RunRecord) -> RunSource:
    """The record of a run with what lies beside it, read once for all pages; raises `InputError` where that is lost."""
    paths = {name: folder / history_file(name) for name in record.histories}
    # Of a statue of numbers none was written: a mesh that lies there is another's.
    mesh = None if record.scene.statue.mesh is None else folder / "statue.glb"
    check_files([*paths.values(), *([] if mesh is None else [mesh])], record)
    # What has its checksum is as it was written; of older records it is read as another's file is.
    listed = record.files or {}
    histories = {
        name: History.read_csv(path) if path.name in listed else read_history(path) for name, path in paths.items()
    }
    return RunSource(folder, record, histories, mesh)


def check_files(paths: Iterable[Path], record: Record) -> None:
    """Raise `InputError` for files of a result that are lost or were changed."""
    found = {
        path: "another content" if path.is_file() else "none there"
        for path in paths
        if not (path.is_file() and as_written(path, record))
    }
    wanted = "the file that result.json names"
    refuse([Mistake(str(path), "", wanted, got, REWRITE) for path, got in found.items()])


def event_s(histories: Iterable[History], level_rad: float, end_s: float) -> tuple[float, float]:
    """From shortly before anything moves to shortly after it has come to its last place: what a chart opens on, s.

    A rotation of `level_rad` counts as moving, a slip of `MOVED_M`; the whole of a run in which nothing moves.
    """
    moved = [
        (history.t_s, *(np.flatnonzero(np.abs(values - values[k]) > least) for k in (0, -1)))
        for history in histories
        for values, least in ((history.theta_rad, level_rad), (history.slip_m, MOVED_M))
    ]
    events = [(float(t_s[gone[0]]), float(t_s[left[-1]])) for t_s, gone, left in moved if len(gone)]
    if not events:
        return 0.0, end_s
    begin, end = min(start for start, _ in events), max(end for _, end in events)
    margin = max(BESIDE * (end - begin), LEAST_BESIDE_S)
    return max(0.0, begin - margin), min(end_s, end + margin)


def run_event_s(source: RunSource) -> tuple[float, float]:
    """The event of a run."""
    statue = source.scene.statue
    level_rad = MOVED_SHARE * min(statue.slenderness_left_rad, statue.slenderness_right_rad)
    return event_s(source.histories.values(), level_rad, source.scene.duration_s)
