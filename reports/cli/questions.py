"""The commands over many runs (assess, study, trust, validate, bench, stress) and finished records (report, figures, gif)."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from harness.model import InputError, Mistake, check_known
from harness.runs.progress import ProgressMessages
from reports.cli.app import app, command
from reports.cli.ending import FAILED, OK, say_record
from reports.cli.options import (
    OUT,
    Dask,
    EngineOptions,
    InLanguage,
    Jobs,
    Out,
    OutputOptions,
    Resume,
    Sampling,
    ScanOptions,
    SceneFile,
    Seed,
    SupportOptions,
    TextLayout,
    folder_of,
)
from reports.messages import ENGLISH
from reports.messages import language as known_language

if TYPE_CHECKING:
    from harness.questions.bench.parts import Measurement, R
    from harness.records.base import Record


@command(
    app, None, "rockcheck assess scenes/paestum_pedestal.toml",
    "rockcheck assess scenes/paestum_pedestal.toml -e analytic -e pymunk --draws 20000 --seed 1",
    "rockcheck assess scenes/paestum_pedestal.toml --options scenes/options/paestum.toml",
    "rockcheck assess statue.obj --motion quake.AT2 --height 1.80",
)  # fmt: skip
def assess(
    scene: Annotated[Path, typer.Argument(metavar="SCENE", help="A scene file (TOML), or a scan.", show_default=False)],
    asked: EngineOptions,
    saying: OutputOptions,
    sampling: Sampling,
    known: ScanOptions,
    around: SupportOptions,
    text: TextLayout,
    motion_file: Annotated[
        Path | None, typer.Option("--motion", metavar="FILE", help="Of a scan: the record that shakes it.")
    ] = None,
    options: Annotated[
        Path | None,
        typer.Option("--options", metavar="FILE", help="Your own options (TOML), compared with the others."),
    ] = None,
    no_options: Annotated[bool, typer.Option("--no-options", help="Leave out what would help.")] = False,
    csv: Annotated[
        bool,
        typer.Option("--csv", help="Also write draws.csv and clearance.csv."),
    ] = False,
    jobs: Jobs = None,
    resume: Resume = False,
    dask: Dask = None,
    out: Out = None,
) -> None:
    """Compute the overturning probability by each model from the uncertain inputs of the scene."""
    from reports.cli import studies

    folder = folder_of(out, scene, "-assess")
    record = studies.assess(
        scene, folder, asked, sampling, no_options=no_options, options=options,
        csv=csv, jobs=jobs, resume=resume, dask=dask, quiet=saying.silent,
        scanned=studies.Scanned(motion_file, known, around, text), say=ENGLISH.say,
    )  # fmt: skip
    say_record(record, folder, saying)


@command(app, None, "rockcheck study scenes/paestum_table2.toml --jobs 2")
def study(
    study_file: Annotated[Path, typer.Argument(metavar="STUDY", help="A study file (TOML).", show_default=False)],
    saying: OutputOptions,
    jobs: Jobs = None,
    resume: Resume = False,
    dask: Dask = None,
    export: Annotated[
        Path | None, typer.Option("--export", help="Also write all rows to a .csv or .parquet file.")
    ] = None,
    large: Annotated[bool, typer.Option("--large", help="Run it though it may take more than a day.")] = False,
    witness: Annotated[
        bool, typer.Option("--witness", help="Compare a tenth of the scenes with unmodified engines.")
    ] = False,
    language: InLanguage = "en",
    out: Out = None,
) -> None:
    """Run many scenes with several engines; results are cached."""
    from reports.cli import studies

    folder = folder_of(out, study_file)
    known_language(language)
    record = studies.run(
        study_file, folder, jobs=jobs, resume=resume, dask=dask, export=export, large=large, quiet=saying.silent,
        witness=witness, say=ENGLISH.say,
    )  # fmt: skip
    say_record(record, folder, saying, language)
    raise typer.Exit(FAILED if getattr(getattr(record, "summary", None), "failed", 0) else OK)


@command(
    app, None, "rockcheck trust scenes/paestum_floor.toml --coarse",
    "rockcheck trust scenes/paestum_pedestal.toml -e pymunk -e pybullet --motion pulse --jobs 2",
)  # fmt: skip
def trust(
    scene: SceneFile,
    asked: EngineOptions,
    saying: OutputOptions,
    motion: Annotated[
        str,
        typer.Option(
            "--motion",
            help="What shakes: sine or pulse (one sine) in place of the scene's motion; scene: that, weaker or stronger.",
        ),
    ] = "sine",
    coarse: Annotated[
        bool,
        typer.Option("--coarse", help="Fewer points, shorter climbs, and engines in the plane alone unless named."),
    ] = False,
    seed: Seed = 0,
    jobs: Jobs = None,
    resume: Resume = False,
    dask: Dask = None,
    out: Out = None,
) -> None:
    """Map over strength and frequency how far the analytic model is confirmed by the engines for this statue."""
    from harness.questions.trust import run_trust

    folder = folder_of(out, scene, "-trust")
    record = run_trust(
        scene, folder, asked.engine, asked.overrides or (), motion=motion, coarse=coarse, seed=seed, jobs=jobs,
        resume=resume, dask=dask, quiet=saying.silent, say=ENGLISH.say,
    )  # fmt: skip
    say_record(record, folder, saying)
    raise typer.Exit(FAILED if record.summary.failed else OK)


@command(app, None, "rockcheck validate tests.csv -e analytic -e pymunk@dt=5e-4 --samples 20")
def validate(
    experiments: Annotated[
        Path, typer.Argument(metavar="EXPERIMENTS", help="A table (CSV) of measured tests.", show_default=False)
    ],
    saying: OutputOptions,
    engine: Annotated[
        list[str] | None,
        typer.Option(
            "--engine", "-e", help="A model, with a setting where wanted: pymunk@dt=5e-4, spatial@near=analytic."
        ),
    ] = None,
    samples: Annotated[int, typer.Option("--samples", help="Draws of each test, for probabilities.")] = 0,
    fit_share: Annotated[
        str | None,
        typer.Option("--fit-share", help="The share of the tests on which unknowns are fitted. Default: fit."),
    ] = None,
    seed: Seed = 0,
    jobs: Jobs = None,
    resume: Resume = False,
    body: Annotated[
        Path | None,
        typer.Option("--body", metavar="SCENE", help="Whose statue is thrown, for measured tosses or drops."),
    ] = None,
    out: Out = None,
) -> None:
    """Run the models on measured tests, tosses or drops and score them against what was observed; or on impact ratios."""
    from harness.questions.validate.validation_run import kind_of, run_validation, validate_measured
    from harness.records.base import check_folder

    folder = folder_of(out, experiments)
    kind = kind_of(experiments, samples=samples, resume=resume, fit_share=fit_share, body=body, engine=engine)
    record: Record
    if kind == "tests":
        check_folder(folder, ("validation",))
        record = run_validation(
            experiments, folder, models=engine, samples=samples, fit_share=fit_share or "fit", seed=seed, jobs=jobs,
            resume=resume, quiet=saying.silent, say=ENGLISH.say,
        )  # fmt: skip
    else:
        record = validate_measured(
            experiments, folder, body=body, models=engine, samples=samples, seed=seed, jobs=jobs, quiet=saying.silent,
            say=ENGLISH.say,
        )  # fmt: skip
    say_record(record, folder, saying)


# The commands that make something of finished records: pages, figures, an animation.

READERS: Final = ("engineer", "conservator")
Folder = Annotated[Path, typer.Argument(metavar="DIR", help="A folder with a result.json.", show_default=False)]


@command(app, None, "rockcheck report out/maria", "rockcheck report out/maria --for conservator --language it --pdf")
def report(
    folder: Folder,
    saying: OutputOptions,
    reader: Annotated[str, typer.Option("--for", help="Whose page to name: engineer or conservator.")] = "engineer",
    pdf: Annotated[bool, typer.Option("--pdf", help="Also print that page, beside it (by Chromium).")] = False,
    language: InLanguage = "en",
) -> None:
    """Write the pages of a result folder again from its records: report.html, and conservator.html where there is one."""
    from harness.records.base import read_result
    from reports.export.figures import browser, write_pdf
    from reports.pages.page import CONSERVATOR_NAME, FOR_CONSERVATORS, write_report

    check_known(reader, READERS, "--for")
    if reader == "conservator" and (kind := read_result(folder).kind) not in FOR_CONSERVATORS:
        raise InputError(Mistake("--for", "", f"a record of a {' or '.join(FOR_CONSERVATORS)}", f"that of a {kind}"))
    if pdf:
        browser()
    page = write_report(folder, language)
    if reader == "conservator":
        page = folder / CONSERVATOR_NAME
    paths = {"report": str(page)} | ({"pdf": str(write_pdf(page))} if pdf else {})
    saying.say(paths, "\n".join(f"{name}: {path}" for name, path in paths.items()))


@command(app, None, "rockcheck figures out/paestum_floor --format pdf --width column")
def figures(
    folder: Folder,
    saying: OutputOptions,
    formats: Annotated[list[str] | None, typer.Option("--format", help="png, svg, pdf (repeat). Default: all.")] = None,
    width: Annotated[str, typer.Option("--width", help="column or page, as journals print.")] = "page",
    model: Annotated[
        str | None, typer.Option("--model", help="Of a study: whose panels, such as `pymunk (paper)`.")
    ] = None,
) -> None:
    """Write the figures of a result for print."""
    from reports.export.figures import FORMATS, write_figures

    written = [str(path) for path in write_figures(folder, formats or FORMATS, width, model)]
    saying.say(written, "\n".join(written))


@command(app, None, "rockcheck gif out/paestum_floor")
def gif(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A folder of a run.", show_default=False)],
    saying: OutputOptions,
    out: Annotated[Path | None, typer.Option("--out", help="The file to write. Default: replay.gif in DIR.")] = None,
    model: Annotated[str | None, typer.Option("--model", help="Whose motion. Default: the 3D engine's.")] = None,
) -> None:
    """Write the replay of a run as an animated picture for slides."""
    from reports.export.animation import write_gif

    with ProgressMessages(saying.silent) as messages:
        messages.now("drawing the frames")
        written = str(write_gif(folder, out, model))
    saying.say([written], written)


# The commands that measure: run time against error, and numerical stability.

Quick = Annotated[bool, typer.Option("--quick", help="A few rows of each kind: to see that it works, not to judge.")]
Parts = Annotated[
    str | None,
    typer.Option(
        "--parts",
        metavar="NAMES",
        help="Only these parts (a,b), the others as measured before; a wrong name lists them.",
    ),
]


@command(app, None, "rockcheck bench --out out/bench", "rockcheck bench --parts precision,skips")
def bench(saying: OutputOptions, quick: Quick = False, parts: Parts = None, out: Out = None) -> None:
    """Measure run time against error for every engine and setting, what skips gain, and how cost grows."""
    from harness.questions.bench.bench_run import BENCH

    measured(BENCH, saying, quick, parts, out)


@command(app, None, "rockcheck stress --out out/stress", "rockcheck stress --parts scenes")
def stress(saying: OutputOptions, quick: Quick = False, parts: Parts = None, out: Out = None) -> None:
    """Run hard scenes and map each engine's stability."""
    from harness.questions.bench.stress_run import STRESS

    record = measured(STRESS, saying, quick, parts, out)
    raise typer.Exit(OK if record.holds else FAILED)


def measured(measurement: Measurement[R], saying: OutputOptions, quick: bool, parts: str | None, out: Path | None) -> R:
    """The record of a measurement of these parts (comma-separated; None: of all), once it is said."""

    folder = out or OUT / measurement.name
    only = None if parts is None else [name.strip() for name in parts.split(",") if name.strip()]
    with ProgressMessages(saying.silent) as messages:
        record = measurement.run(folder, quick, only, messages.engine, ENGLISH.say)
    say_record(record, folder, saying)
    return record
