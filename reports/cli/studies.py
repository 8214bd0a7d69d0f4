"""The study command: run what is missing, write the record."""

from __future__ import annotations

import os
import sqlite3
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any, Final

from harness.input.tables import kind_of
from harness.model.errors import InputError, Mistake
from harness.model.files import check_own, checksum, is_sealed
from harness.model.finding import Say, caution
from harness.questions.study import estimate
from harness.questions.study.cases import base_of
from harness.questions.study.file import load_study
from harness.questions.study.study_record import export_csv, export_parquet, study_record
from harness.questions.study.study_run import run_study, study_name
from harness.questions.study.witnessed import witness_study
from harness.records.base import Record, option_words
from harness.records.result_folder import RECORD, check_folder, read_own, write_whole
from harness.records.study import ExportRecord
from harness.runs.progress import LESS_STORED, progress
from harness.runs.runner import LIMIT_S, DaskPool, LocalPool, Pool
from harness.runs.store import STORE_NAME, Store, check_begun

QUESTIONS: Final = {
    "rocking_spectrum": "harness.questions.study.rocking_spectrum",
    "effects3d": "harness.questions.effects3d.study",
}
"""By the kind that a file names the module that answers it: `run_file`, and `REFUSES`: by option what it wants instead."""


def run(
    path: Path,
    folder: Path,
    *,
    jobs: int | None = None,
    resume: bool = False,
    dask: str | None = None,
    export: Path | None = None,
    large: bool = False,
    quiet: bool = False,
    pool: Pool | None = None,
    witness: bool = False,
    say: Say = lambda finding: "",
) -> Record:
    """Run a study into `folder` (store.sqlite, result.json); returns its record.

    `large` lets a study run that would take more than a day; `pool` is used, and not closed, where the caller has one;
    `witness` holds a tenth of its scenes against unmodified engines. Raises `InputError`
    for a wrong study, a store that cannot be used, or `resume` where there is nothing to go on with.
    """
    kind = kind_of(path)
    with ExitStack() as stack:
        if isinstance(kind, str) and kind in QUESTIONS:
            question: Any = import_module(QUESTIONS[kind])
            check_folder(folder, (kind,))
            for name, given in (("--export", export), ("--resume", resume), ("--dask", dask), ("--witness", witness)):
                if given and name in question.REFUSES:
                    raise InputError(Mistake(name, "", question.REFUSES[name], str(given)))
            pool = pool or stack.enter_context(_pool(jobs, dask, LIMIT_S))
            on_progress = stack.enter_context(progress(path.stem, quiet))
            answered: Record = question.run_file(path, folder, pool, on_progress, resume=resume, say=say)
            return answered
        check_folder(folder, ("study",))
        study = load_study(path)
        _check(folder, resume, export)
        base = base_of(study, path)
        pool = pool or stack.enter_context(_pool(jobs, dask, estimate.limit_s(study, base.scene({}))))
        start = time.perf_counter()
        # Its size is told, or refused, before anything is begun.
        cost = estimate.cost(study, base, pool.workers, witness=witness)
        size = estimate.check(study, cost.cpu_s, pool.workers, str(path), large=large)
        size += LESS_STORED * (folder / STORE_NAME).exists()
        each_s = cost.each_s / pool.workers
        on_progress = stack.enter_context(
            progress(study.title, quiet, size, workers=pool.workers, each_s=each_s, after_s=estimate.RESULT_S)
        )
        stack.enter_context(unbegun(folder))
        store = stack.enter_context(Store(folder / STORE_NAME))
        summary = run_study(study, path, store, pool, on_progress, singly=witness)
        seen = witness_study(study, path, store, pool, on_progress) if witness else None
        finished = study_record(study, path, store, summary, time.perf_counter() - start, seen)
        if witness and seen is None:
            finished = replace(finished, findings=[caution("no_witness"), *finished.findings])
        if export is not None:
            writer = export_parquet if export.suffix == ".parquet" else export_csv
            writer(store, study_name(study), export, _exported(export, folder))
            finished = replace(finished, export=ExportRecord(os.path.realpath(export), checksum(export)))
        finished = replace(finished, asked=option_words(witness=witness, large=large) or None)
        return write_whole(folder, finished.texted(say))


@contextmanager
def unbegun(folder: Path) -> Iterator[None]:
    """Take a store away that was made here, and that no other call uses, when the study turns out to be wrong before anything
    was computed."""
    store = folder / STORE_NAME
    made = [path for path in (folder, *folder.parents) if not path.exists()]
    fresh = not store.exists()
    try:
        yield
    except InputError:
        if not fresh or not store.is_file():
            raise
        try:
            with closing(sqlite3.connect(store, timeout=0.0)) as db:
                # Only who is alone with it may leave the mode in which stores are used.
                alone = db.execute("PRAGMA journal_mode=DELETE").fetchone()[0] == "delete"
                empty = alone and db.execute("SELECT 1 FROM result LIMIT 1").fetchone() is None
        except sqlite3.Error:  # a full disk, or used by another call: what is there stays
            empty = False
        if empty:
            store.unlink()
            for path in made:
                path.rmdir()
        raise


def _pool(jobs: int | None, dask: str | None, limit_s: float) -> closing[LocalPool | DaskPool]:
    return closing(LocalPool(jobs, limit_s) if dask is None else DaskPool(dask, limit_s))


def _check(folder: Path, resume: bool, export: Path | None) -> None:
    if resume:
        check_begun(folder, "a study")
    if export is None:
        return
    if export.suffix not in (".csv", ".parquet"):
        raise InputError(Mistake("--export", "", "a file ending in .csv or .parquet", str(export)))
    there = Path(os.path.realpath(export)).parent
    if not there.is_dir() or not os.access(there, os.W_OK | os.X_OK):
        raise InputError(Mistake("--export", "", "a file in a folder that can be written", str(export)))
    check_own(export, _exported(export, folder), "--export")


def _exported(export: Path, folder: Path) -> set[str]:
    """The checksum of what the study in `folder` wrote into that file, where it wrote it."""
    path = folder / RECORD
    written = (read_own(path) or {}).get("export")
    mine = isinstance(written, dict) and written.get("file") == os.path.realpath(export) and is_sealed(path)
    return {str(written["sha256"])} if mine and isinstance(written, dict) and "sha256" in written else set()
