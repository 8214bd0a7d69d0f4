"""The assess command: what is wrong told first, engine runs kept in a store, the record and its draws written."""

from __future__ import annotations

import csv as comma_separated
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path

from harness.input.paths import read_files
from harness.input.scene_file import load_scene
from harness.model.errors import InputError, Mistake
from harness.model.files import FRESH
from harness.model.finding import Say
from harness.model.scene import Scene
from harness.questions.assess.assessment import Assessed, assess
from harness.questions.assess.by_model import MODEL
from harness.questions.assess.model_draws import as_coefficients
from harness.questions.assess.options import read_options
from harness.records.assess import AssessRecord
from harness.records.base import option_words
from harness.records.result_folder import COMING, PAGES, RECORD, check_folder, check_inputs, write_whole
from harness.runs.progress import ProgressMessages
from harness.runs.runner import DaskPool, LocalPool
from harness.runs.store import STORE_NAME, Store, check_begun
from reports.cli.options import EngineOptions, Sampling, ScanOptions, SupportOptions, TextLayout
from reports.cli.studies import unbegun

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
        if self.motion is None:
            if self != Scanned() or path.suffix.lower() != ".toml":
                wanted = "a record, beside a scan and what is known of it"
                raise InputError(Mistake("--motion", "", wanted, "nothing", "or give a scene (.toml) alone"))
            yield path
            return
        if path.suffix.lower() == ".toml":
            raise InputError(Mistake("--motion", "", "a scan beside it: a scene has its own [motion]", str(path)))
        from reports.cli.scans import new

        folder.parent.mkdir(parents=True, exist_ok=True)
        # At the depth of the result's folder: the scene's relative path to the record is then the same in both.
        with tempfile.TemporaryDirectory(dir=folder.parent, prefix=FRESH) as made:
            first = Path(made) / SCENE_NAME
            yield new(path, self.motion, first, self.known, self.around, self.layout.layout(), say)[0]


def run(
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
        if no_options and options is not None:
            raise InputError(Mistake("--options", "", "either your own options or --no-options", "both"))
        if resume:
            check_begun(folder, "an assessment")
        own_options = () if options is None else read_options(options, scene)
        pool = LocalPool(jobs) if dask is None else DaskPool(dask)
        with (
            closing(pool),
            unbegun(folder),
            Store(folder / STORE_NAME, "assess") as store,
            ProgressMessages(quiet) as messages,
        ):
            assessed = assess(
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


def _write_draws(scene: Scene, assessed: Assessed, path: Path) -> None:
    """A row for each draw: its values by key, the model's answers, and each engine's (empty where it did not run, or failed)."""
    model = assessed.model
    columns = {
        "draw": range(model.overturned.size),
        **{name: column.tolist() for name, column in as_coefficients(scene, assessed.values).items()},
        f"{MODEL}_decided": model.decided.astype(int).tolist(),
        f"{MODEL}_overturned": model.overturned.astype(int).tolist(),
        f"{MODEL}_peak_theta_over_alpha": model.peak_share.tolist(),
        f"{MODEL}_peak_slip_m": model.peak_slip_m.tolist(),
    }
    for name, answers in assessed.fell.items():
        fell = (answers.get(k) for k in columns["draw"])
        columns[f"{name}_overturned"] = ["" if item is None else int(item) for item in fell]
    with path.open("w", newline="", encoding="utf-8") as stream:
        rows = comma_separated.writer(stream)
        rows.writerow(columns)
        rows.writerows(zip(*columns.values(), strict=True))


def _write_clearance(record: AssessRecord, path: Path) -> None:
    """A row for each model, share and direction: how far outline, top and pedestal go, m."""
    models = {} if record.clearance is None else record.clearance.answered
    with path.open("w", newline="", encoding="utf-8") as stream:
        rows = comma_separated.writer(stream)
        rows.writerow(["model", "share", "direction_deg", "outline_m", "top_m", "pedestal_m"])
        for name, item in models.items():
            tables = zip(item.share, item.outline_m, item.top_m, item.pedestal_m, strict=True)
            for share, *table in tables:
                each = zip(item.direction_deg, *table, strict=True)
                rows.writerows([name, share, *numbers] for numbers in each)
