"""The commands study and assess: what is wrong is told first, runs are kept in a store, the record is written."""

import csv as comma_separated
import os
import shutil
import sqlite3
import tempfile
import time
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass, field, replace
from importlib import import_module
from pathlib import Path
from typing import Any, Final

from harness.accuracy.horizon import MODEL
from harness.input.files import read_files
from harness.input.scene_file import load_scene
from harness.input.tables import kind_of
from harness.model import FRESH, InputError, Say, Scene, caution, check_own, checksum, is_sealed, require
from harness.questions.assess import assessment
from harness.questions.assess.options import read_options
from harness.questions.assess.probability import as_coefficients
from harness.questions.study.cases import base_of, load_study
from harness.questions.study.study_record import export_csv, export_parquet, study_record
from harness.questions.study.study_run import (
    RESULT_S,
    limit_s,
    run_study,
    study_cost,
    study_name,
    told_size,
    witness_study,
)
from harness.records.assess import AssessRecord
from harness.records.base import (
    COMING,
    PAGES,
    RECORD,
    Record,
    check_folder,
    check_inputs,
    option_words,
    read_own,
    write_whole,
)
from harness.records.study import ExportRecord
from harness.runs.progress import LESS_STORED, ProgressMessages, progress
from harness.runs.runner import LIMIT_S, DaskPool, LocalPool, Pool
from harness.runs.store import STORE_NAME, Store, check_begun
from reports.cli.app import EngineOptions, Sampling, ScanOptions, SupportOptions, TextLayout

QUESTIONS: Final = {
    "rocking_spectrum": "harness.questions.study.rocking_spectrum",
    "effects3d": "harness.questions.effects3d",
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
                require(not given or name not in question.REFUSES, name, question.REFUSES.get(name, ""), str(given))
            pool = pool or stack.enter_context(_pool(jobs, dask, LIMIT_S))
            on_progress = stack.enter_context(progress(path.stem, quiet))
            answered: Record = question.run_file(path, folder, pool, on_progress, resume=resume, say=say)
            return answered
        check_folder(folder, ("study",))
        study = load_study(path)
        _check(folder, resume, export)
        base = base_of(study, path)
        pool = pool or stack.enter_context(_pool(jobs, dask, limit_s(study, base.scene({}))))
        start = time.perf_counter()
        # Its size is told, or refused, before anything is begun.
        cost = study_cost(study, base, pool.workers, witness=witness)
        size = told_size(study, cost.cpu_s, pool.workers, str(path), large=large)
        size += LESS_STORED * (folder / STORE_NAME).exists()
        each_s = cost.each_s / pool.workers
        on_progress = stack.enter_context(
            progress(study.title, quiet, size, workers=pool.workers, each_s=each_s, after_s=RESULT_S)
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
    require(export.suffix in (".csv", ".parquet"), "--export", "a file ending in .csv or .parquet", str(export))
    there = Path(os.path.realpath(export)).parent
    writable = there.is_dir() and os.access(there, os.W_OK | os.X_OK)
    require(writable, "--export", "a file in a folder that can be written", str(export))
    check_own(export, _exported(export, folder), "--export")


def _exported(export: Path, folder: Path) -> set[str]:
    """The checksum of what the study in `folder` wrote into that file, where it wrote it."""
    path = folder / RECORD
    written = (read_own(path) or {}).get("export")
    mine = isinstance(written, dict) and written.get("file") == os.path.realpath(export) and is_sealed(path)
    return {str(written["sha256"])} if mine and isinstance(written, dict) and "sha256" in written else set()


# The assess command: what is wrong told first, engine runs kept in a store, the record and its draws written.

DRAWS_NAME, CLEARANCE_NAME = "draws.csv", "clearance.csv"
SCENE_NAME, MESH_NAME, LOG_NAME = "scene.toml", "scene_statue.ply", "scene_statue.account.json"
"""The first scene of a scan, kept in the result's folder with its prepared mesh and that mesh's log."""


@dataclass(frozen=True)
class Scanned:
    """What is said where a scan is given instead of a scene: the record that shakes it, and what the user knows of both."""

    motion: Path | None = None
    known: ScanOptions = field(default_factory=ScanOptions)
    around: SupportOptions = field(default_factory=SupportOptions)
    layout: TextLayout = field(default_factory=TextLayout)

    @contextmanager
    def scene_file(self, path: Path, folder: Path, say: Say) -> Iterator[Path]:
        """The scene to assess: `path` itself, or a first scene of the scan, beside `folder` until it is part of the result.

        Raises `InputError` for a record without a scan, and for words on a scan beside a scene.
        """
        is_scene = path.suffix.lower() == ".toml"
        if self.motion is None:
            wanted = "a record, beside a scan and what is known of it"
            require(is_scene and self == Scanned(), "--motion", wanted, "nothing", "or give a scene (.toml) alone")
            yield path
            return
        require(not is_scene, "--motion", "a scan beside it: a scene has its own [motion]", str(path))
        from reports.cli.scans import new

        folder.parent.mkdir(parents=True, exist_ok=True)
        # At the depth of the result's folder: the scene's relative path to the record is then the same in both.
        with tempfile.TemporaryDirectory(dir=folder.parent, prefix=FRESH) as made:
            yield new(path, self.motion, Path(made) / SCENE_NAME, self.known, self.around, self.layout.layout(), say)[0]


def assess(
    path: Path,
    folder: Path,
    asked: EngineOptions,
    sampling: Sampling,
    *,
    options: Path | None = None,
    no_options: bool = False,
    csv: bool = False,
    jobs: int | None = None,
    resume: bool = False,
    dask: str | None = None,
    quiet: bool = False,
    scanned: Scanned = Scanned(),
    say: Say = lambda finding: "",
) -> AssessRecord:
    """Assess a scene file, or a scan, into `folder` (store.sqlite, result.json, draws.csv where asked, the scan's scene).

    Engine runs in the store are not computed again; `say` fills in the sentences. Raises `InputError` for wrong input, or
    `resume` where there is nothing to go on with.
    """
    of_scan = [SCENE_NAME, MESH_NAME, LOG_NAME]
    names = [RECORD, COMING, *PAGES, *([DRAWS_NAME, CLEARANCE_NAME] if csv else [])]
    names += [] if scanned.motion is None else of_scan
    check_folder(folder, ("assess",), names)
    with scanned.scene_file(path, folder, say) as scene_file:
        scene = load_scene(scene_file, asked.overrides or ())
        given = [item for item in (path, scanned.motion, options) if item is not None]
        check_inputs(folder, [*names, *of_scan], [*given, *read_files(scene.given, scene.source)])
        require(options is None or not no_options, "--options", "either your own options or --no-options", "both")
        if resume:
            check_begun(folder, "an assessment")
        own_options = () if options is None else read_options(options, scene)
        with (
            _pool(jobs, dask, LIMIT_S) as pool,
            unbegun(folder),
            Store(folder / STORE_NAME, "assess") as store,
            ProgressMessages(quiet) as messages,
        ):
            assessed = assessment.assess(
                scene,
                asked.engine,
                **vars(sampling),
                more_options=None if no_options else own_options,
                store=store,
                pool=pool,
                on_progress=messages.now,
            )

        words = vars(sampling) | {"seed": None, "options": options and options.name, "no_options": no_options}
        record = replace(assessed.record, asked=option_words(**words))

        def write(fresh: Path) -> None:
            if csv:
                _write_draws(scene, assessed, fresh / DRAWS_NAME)
                _write_clearance(assessed.record, fresh / CLEARANCE_NAME)
            if scene_file != path:
                for made in scene_file.parent.iterdir():
                    shutil.copy(made, fresh)

        return write_whole(folder, record.texted(say), write)


def _write_draws(scene: Scene, assessed: assessment.Assessed, path: Path) -> None:
    """A row for each draw: its values by key, the model's answers, and each engine's (empty where it did not run, or failed)."""
    model, draws = assessed.model, range(assessed.model.overturned.size)
    columns = {
        "draw": draws,
        **{name: column.tolist() for name, column in as_coefficients(scene, assessed.values).items()},
        f"{MODEL}_decided": model.decided.astype(int).tolist(),
        f"{MODEL}_overturned": model.overturned.astype(int).tolist(),
        f"{MODEL}_peak_theta_over_alpha": model.peak_share.tolist(),
        f"{MODEL}_peak_slip_m": model.peak_slip_m.tolist(),
        **{
            f"{name}_overturned": [int(item) if isinstance(item := answers.get(k), bool) else "" for k in draws]
            for name, answers in assessed.fell.items()
        },
    }
    _write_csv(path, columns, zip(*columns.values(), strict=True))


def _write_clearance(record: AssessRecord, path: Path) -> None:
    """A row for each model, share and direction: how far outline, top and pedestal go, m."""
    models = {} if record.clearance is None else record.clearance.answered
    rows = (
        [name, share, *numbers]
        for name, item in models.items()
        for share, *table in zip(item.share, item.outline_m, item.top_m, item.pedestal_m, strict=True)
        for numbers in zip(item.direction_deg, *table, strict=True)
    )
    _write_csv(path, ["model", "share", "direction_deg", "outline_m", "top_m", "pedestal_m"], rows)


def _write_csv(path: Path, heading: Iterable[str], rows: Iterable[Iterable[object]]) -> None:
    with path.open("w", newline="", encoding="utf-8") as stream:
        comma_separated.writer(stream).writerows([heading, *rows])
