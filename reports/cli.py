"""The command `rockcheck`: what computes comes from the harness, pages and pictures are added here."""

from __future__ import annotations

import gc
import sys
from io import TextIOWrapper
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from harness import cli as harness_cli
from harness.campaign.progress import ProgressMessages
from harness.command import (
    FAILED,
    OK,
    EngineOptions,
    OutputOptions,
    Sampling,
    ScanOptions,
    SceneFile,
    SupportOptions,
    Target,
    TextLayout,
    command,
    guarded,
)
from harness.model.terminal import printable
from reports import cli_bench, cli_input
from reports.cli_result import OUT, Out, say_result

if TYPE_CHECKING:
    from harness.records.measured import MeasuredRecord
    from harness.records.tosses import TossesRecord


# The commands that make something of finished records: pages, figures, an animation.


READERS: Final = ("engineer", "conservator")

Folder = Annotated[Path, typer.Argument(metavar="DIR", help="A folder with a result.json.", show_default=False)]
InLanguage = Annotated[
    str, typer.Option("--language", help="Language of the conservator's page: en or it.", show_default=True)
]


def add_commands(app: typer.Typer) -> None:
    """Mount the commands on the application."""
    examples = "rockcheck report out/maria", "rockcheck report out/maria --for conservator --language it --pdf"
    command(app, "report", *examples)(report)
    command(app, "figures", "rockcheck figures out/paestum_floor --format pdf --width column")(figures)
    command(app, "gif", "rockcheck gif out/paestum_floor")(gif)


def check_language(code: str) -> None:
    """Raise `InputError` for a language that the conservator's page does not speak, before anything is computed."""
    from reports.messages import language

    language(code)


def report(
    folder: Folder,
    saying: OutputOptions,
    reader: Annotated[str, typer.Option("--for", help="Whose page to name: engineer or conservator.")] = "engineer",
    pdf: Annotated[bool, typer.Option("--pdf", help="Also print that page, beside it (by Chromium).")] = False,
    language: InLanguage = "en",
) -> None:
    """Write the pages of a result folder again from its records: report.html, and conservator.html where there is one."""
    from harness.model.errors import InputError, Mistake
    from reports.export.pdf import browser, write_pdf
    from reports.pages.page import CONSERVATOR_NAME, write_report

    if reader not in READERS:
        raise InputError(Mistake("--for", "", f"one of {', '.join(READERS)}", repr(reader)))
    if pdf:
        browser()
    page = write_report(folder, language)
    if reader == "conservator":
        page = folder / CONSERVATOR_NAME
        if not page.is_file():
            raise InputError(Mistake("--for", "", "a run or a study", "a record that has no conservator's page"))
    paths = {"report": str(page)} | ({"pdf": str(write_pdf(page))} if pdf else {})
    saying.say(paths, "\n".join(f"{name}: {path}" for name, path in paths.items()))


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


app = typer.Typer(
    name="rockcheck",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
    context_settings={"help_option_names": ["-h", "--help"]},
)

Jobs = Annotated[int | None, typer.Option("--jobs", "-j", help="Processes. Default: one for each core.", min=1)]
Seed = Annotated[int, typer.Option("--seed", help="Seed of the draws.", min=0)]
Dask = Annotated[
    str | None, typer.Option("--dask", metavar="ADDRESS", help="Run on the Dask cluster of this scheduler.")
]
Resume = Annotated[bool, typer.Option("--resume", help="Go on with what was begun in this folder.")]


def _version(asked: bool) -> None:
    if asked:
        from importlib.metadata import version

        typer.echo(f"rockcheck {version('rockcheck')}")
        raise typer.Exit


@app.callback()
def top(
    version: Annotated[
        bool, typer.Option("--version", help="Print the version and exit.", callback=_version, is_eager=True)
    ] = False,
) -> None:
    """How far can an analytic rocking model be trusted? One scene, several models, one report."""


@command(
    app, None, "rockcheck run scenes/paestum_floor.toml",
    "rockcheck run scenes/paestum_floor.toml -e analytic -e pymunk --set motion.x.frequency_hz=2 --accuracy 1e-4",
)  # fmt: skip
def run(
    scene: SceneFile,
    asked: EngineOptions,
    target: Target,
    saying: OutputOptions,
    out: Out = None,
    explain: Annotated[
        bool, typer.Option("--explain", help="Print what would be skipped and why, without a run.")
    ] = False,
    no_skip: Annotated[
        list[str] | None,
        typer.Option("--no-skip", metavar="NAME", help="Switch one skip off (see --explain), or `all`."),
    ] = None,
    witness: Annotated[
        bool, typer.Option("--witness", help="Compare the runs with unmodified engines (up to twice the time).")
    ] = False,
    no_assess: Annotated[bool, typer.Option("--no-assess", help="Skip the overturning probability.")] = False,
    language: InLanguage = "en",
) -> None:
    """Run one scene with several engines; write histories, scores and a report."""
    from harness.accuracy.simulation import check_target
    from harness.records.base import plain
    from harness.records.result_folder import check_folder, named_after
    from harness.scene_run.scene_run import Ended, write_result
    from reports.messages import ENGLISH
    from reports.terminal import explained, run_lines

    folder = out or OUT / named_after(scene)
    check_folder(folder, ("run",))
    check_language(language)
    if explain:
        from harness.input.scene_file import load_scene

        check_target(target.accuracy, target.dt)
        steps = harness_cli.explain(load_scene(scene, asked.overrides or ()), asked.engine, no_skip)
        saying.say(*explained(steps))
        return
    try:
        result = harness_cli.compute(
            scene, asked, target, no_skip, quiet=saying.silent, out=folder, assess=not no_assess, witness=witness
        )
    except Ended as ending:
        write_result(ending.result, folder, ENGLISH.say)
        typer.echo(
            printable(f"{folder} holds what had finished; `rockcheck report {folder}` writes its pages"), err=True
        )
        raise
    write_result(result, folder, ENGLISH.say)
    record = result.record().texted(ENGLISH.say)
    lines = run_lines(record, verbose=saying.verbose)
    say_result(plain(record), "\n".join(lines), folder, saying, language)
    # An engine that nobody named and that has no wheels here is said, and no failure.
    failed = result.failed_but(() if asked.engine else tuple(result.runs))
    raise typer.Exit(FAILED if failed else OK)


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
    from harness import assess_cli
    from harness.records.base import plain
    from harness.records.result_folder import named_after
    from reports.messages import ENGLISH
    from reports.terminal import assess_lines

    folder = out or OUT / f"{named_after(scene)}-assess"
    record = assess_cli.run(
        scene, folder, asked, sampling, no_options=no_options, options=options,
        csv=csv, jobs=jobs, resume=resume, dask=dask, quiet=saying.silent,
        scanned=assess_cli.Scanned(motion_file, known, around, text), say=ENGLISH.say,
    )  # fmt: skip
    say_result(plain(record), "\n".join(assess_lines(record, verbose=saying.verbose)), folder, saying)


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
    from harness import study_cli
    from harness.records.base import as_file
    from harness.records.result_folder import named_after
    from reports.messages import ENGLISH
    from reports.terminal import study_lines

    folder = out or OUT / named_after(study_file)
    check_language(language)
    record = study_cli.run(
        study_file, folder, jobs=jobs, resume=resume, dask=dask, export=export, large=large, quiet=saying.silent,
        witness=witness, say=ENGLISH.say,
    )  # fmt: skip
    say_result(as_file(record), "\n".join(study_lines(record, verbose=saying.verbose)), folder, saying, language)
    raise typer.Exit(FAILED if record.summary.failed else OK)


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
            "--motion", help="What shakes: sine, pulse (one sine), scene (its own motion, weaker or stronger)."
        ),
    ] = "sine",
    coarse: Annotated[
        bool, typer.Option("--coarse", help="Fewer points, and engines in the plane alone unless named.")
    ] = False,
    seed: Seed = 0,
    jobs: Jobs = None,
    resume: Resume = False,
    dask: Dask = None,
    out: Out = None,
) -> None:
    """Map over strength and frequency how far the analytic model is confirmed by the engines for this statue."""
    from harness.records.base import plain
    from harness.records.result_folder import named_after
    from harness.trust.trust_run import run_trust
    from reports.messages import ENGLISH
    from reports.terminal import trust_lines

    folder = out or OUT / f"{named_after(scene)}-trust"
    record = run_trust(
        scene, folder, asked.engine, asked.overrides or (), motion=motion, coarse=coarse, seed=seed, jobs=jobs,
        resume=resume, dask=dask, quiet=saying.silent, say=ENGLISH.say,
    )  # fmt: skip
    say_result(plain(record), "\n".join(trust_lines(record, verbose=saying.verbose)), folder, saying)
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
            "--engine", "-e", help="A model, with a setting where wanted: pymunk@dt=5e-4, pybullet@accuracy=1e-3."
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
    from harness.records.base import as_file
    from harness.records.result_folder import check_folder, named_after
    from harness.validation.kinds import kind_of
    from harness.validation.validation_run import run_validation
    from reports.messages import ENGLISH
    from reports.terminal import measured_lines, validation_lines

    folder = out or OUT / named_after(experiments)
    kind = kind_of(experiments, samples=samples, resume=resume, fit_share=fit_share, body=body, engine=engine)
    if kind != "tests":
        measured = _measured(kind, experiments, folder, body or Path(), engine, samples, seed, jobs, saying.silent)
        say_result(as_file(measured), "\n".join(measured_lines(measured, verbose=saying.verbose)), folder, saying)
        return
    check_folder(folder, ("validation",))
    record = run_validation(
        experiments,
        folder,
        models=engine,
        samples=samples,
        fit_share=fit_share or "fit",
        seed=seed,
        jobs=jobs,
        resume=resume,
        quiet=saying.silent,
        say=ENGLISH.say,
    )
    say_result(as_file(record), "\n".join(validation_lines(record, verbose=saying.verbose)), folder, saying)


def _measured(
    kind: str,
    table: Path,
    folder: Path,
    body: Path,
    models: list[str] | None,
    samples: int,
    seed: int,
    jobs: int | None,
    quiet: bool,
) -> TossesRecord | MeasuredRecord:
    """The record of a table of tosses, drops or impact ratios."""
    from harness.validation.drop_run import validate_drops
    from harness.validation.impact_ratios import validate_ratios
    from harness.validation.toss_run import validate_tosses
    from reports.messages import ENGLISH

    say = ENGLISH.say
    if kind == "tosses":
        return validate_tosses(table, folder, body, models=models, seed=seed, jobs=jobs, say=say)
    if kind == "impact_ratios":
        return validate_ratios(table, folder, say)
    return validate_drops(
        table, folder, body, models=models, samples=samples, seed=seed, jobs=jobs, quiet=quiet, say=say
    )


cli_bench.add_commands(app)


harness_cli.add_commands(app)
cli_input.add_commands(app)
add_commands(app)


def main() -> None:
    """Entry point of the command."""
    gc.set_threshold(
        100_000
    )  # what is imported lives to the end: to look through it every 700 objects takes a tenth of a start
    if isinstance(sys.stdout, TextIOWrapper):
        # The name of a file may be no text: what cannot be printed is printed as escapes.
        sys.stdout.reconfigure(errors="backslashreplace")
    sys.exit(guarded(app))


if __name__ == "__main__":
    main()
