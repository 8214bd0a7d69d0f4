"""The command `rockcheck`: what computes comes from the harness, pages and pictures are added here."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from io import TextIOWrapper
from pathlib import Path
from typing import Annotated, Any, Final

import typer

from harness import cli as harness_cli
from harness.campaign.progress import ProgressMessages
from harness.command import FAILED, OK, Asked, Sampling, Saying, SceneFile, Target, command, guarded
from harness.model.terminal import printable
from reports import cli_input, cli_record

OUT: Final = Path("out")

app = typer.Typer(
    name="rockcheck",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
    context_settings={"help_option_names": ["-h", "--help"]},
)

Out = Annotated[Path | None, typer.Option("--out", help="Folder of the result. Default: out/NAME.", show_default=False)]
Jobs = Annotated[int | None, typer.Option("--jobs", "-j", help="Processes. Default: one for each core.")]
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
        bool, typer.Option("--version", help="Say the version and end.", callback=_version, is_eager=True)
    ] = False,
) -> None:
    """How far can an analytic rocking model be trusted? One scene, several models, one report."""


@command(
    app, None, "rockcheck run scenes/paestum_floor.toml",
    "rockcheck run scenes/paestum_floor.toml -e analytic -e pymunk --set motion.x.frequency_hz=2 --accuracy 1e-4",
)  # fmt: skip
def run(
    scene: SceneFile,
    asked: Asked,
    target: Target,
    saying: Saying,
    out: Out = None,
    explain: Annotated[bool, typer.Option("--explain", help="Say what would be skipped and why; run nothing.")] = False,
    no_skip: Annotated[
        list[str] | None,
        typer.Option("--no-skip", metavar="NAME", help="Switch one skip off (see --explain), or `all`."),
    ] = None,
    no_witness: Annotated[
        bool, typer.Option("--no-witness", help="Leave out the engines as they come, which confirm each run or not.")
    ] = False,
    no_assess: Annotated[
        bool, typer.Option("--no-assess", help="Leave out the probability over what the scene does not know.")
    ] = False,
    language: cli_record.InLanguage = "en",
) -> None:
    """Run one scene with several engines; write histories, scores and a report."""
    from harness.accuracy.simulation import check_target
    from harness.records.base import plain
    from harness.records.result_folder import check_folder, named_after
    from harness.scene_run.scene_run import write_result

    folder = out or OUT / named_after(scene)
    check_folder(folder, ("run",))
    cli_record.check_language(language)
    if explain:
        from harness.input.scene_file import load_scene

        check_target(target.accuracy, target.dt)
        saying.say(*harness_cli.explain(load_scene(scene, asked.overrides or ()), asked.engine, no_skip))
        return
    more = {"assess": not no_assess, "witness": not no_witness}
    result = harness_cli.compute(scene, asked, target, no_skip, quiet=saying.silent, out=folder, **more)
    write_result(result, folder)
    _say(plain(result.record()), harness_cli.summary(result), folder, saying, language)
    # An engine that nobody named and that has no wheels here is said, and no failure.
    failed = result.failed_but(() if asked.engine else tuple(result.runs))
    raise typer.Exit(FAILED if failed else OK)


@command(
    app, None, "rockcheck assess scenes/paestum_pedestal.toml",
    "rockcheck assess scenes/paestum_pedestal.toml -e analytic -e pymunk --draws 20000 --seed 1",
    "rockcheck assess scenes/paestum_pedestal.toml --options scenes/options/paestum.toml",
)  # fmt: skip
def assess(
    scene: SceneFile,
    asked: Asked,
    saying: Saying,
    sampling: Sampling,
    options: Annotated[
        Path | None,
        typer.Option("--options", metavar="FILE", help="Your own options (TOML), compared with the others."),
    ] = None,
    no_options: Annotated[bool, typer.Option("--no-options", help="Leave out what would help.")] = False,
    csv: Annotated[bool, typer.Option("--csv", help="Also write every draw and its outcomes to draws.csv.")] = False,
    jobs: Jobs = None,
    resume: Resume = False,
    dask: Dask = None,
    out: Out = None,
) -> None:
    """Find how probable it is that the statue falls, by each model, from what is not known of the scene."""
    from harness import assess_cli
    from harness.assess.words import summary
    from harness.records.base import plain
    from harness.records.result_folder import named_after

    folder = out or OUT / f"{named_after(scene)}-assess"
    found = assess_cli.run(
        scene, folder, asked, sampling, no_options=no_options, options=options,
        csv=csv, jobs=jobs, resume=resume, dask=dask, quiet=saying.silent,
    )  # fmt: skip
    _say(plain(found), summary(found), folder, saying)


@command(app, None, "rockcheck study scenes/paestum_table2.toml --jobs 2")
def study(
    study_file: Annotated[Path, typer.Argument(metavar="STUDY", help="A study file (TOML).", show_default=False)],
    saying: Saying,
    jobs: Jobs = None,
    resume: Resume = False,
    dask: Dask = None,
    export: Annotated[
        Path | None, typer.Option("--export", help="Also write all rows to a .csv or .parquet file.")
    ] = None,
    large: Annotated[bool, typer.Option("--large", help="Run it though it may take more than a day.")] = False,
    language: cli_record.InLanguage = "en",
    out: Out = None,
) -> None:
    """Run many scenes with several engines; what is finished is kept, and never computed again."""
    from harness import study_cli
    from harness.records.result_folder import check_folder, named_after

    folder = out or OUT / named_after(study_file)
    check_folder(folder, ("study", "effects3d"))
    cli_record.check_language(language)
    found, summary = study_cli.run(
        study_file, folder, jobs=jobs, resume=resume, dask=dask, export=export, large=large, quiet=saying.silent
    )
    usage = found.get("usage")
    lines = [f"{study_file.name}: {summary}", *([usage["sentence"]] if usage else [])]
    _say(found, "\n".join(lines), folder, saying, language)
    raise typer.Exit(FAILED if summary.failed else OK)


@command(app, None, "rockcheck validate tests.csv -e analytic -e pymunk@dt=5e-4 --samples 20")
def validate(
    experiments: Annotated[
        Path, typer.Argument(metavar="EXPERIMENTS", help="A table (CSV) of measured tests.", show_default=False)
    ],
    saying: Saying,
    engine: Annotated[
        list[str] | None,
        typer.Option(
            "--engine", "-e", help="A model, with a setting where wanted: pymunk@dt=5e-4, pybullet@accuracy=1e-3."
        ),
    ] = None,
    samples: Annotated[int, typer.Option("--samples", help="Perturbed runs of each test, for probabilities.")] = 0,
    fit_share: Annotated[
        str, typer.Option("--fit-share", help="The share of the tests on which unknowns are fitted.")
    ] = "fit",
    seed: Seed = 0,
    jobs: Jobs = None,
    resume: Resume = False,
    body: Annotated[
        Path | None,
        typer.Option("--body", metavar="SCENE", help="Whose statue is thrown, for a table of measured tosses."),
    ] = None,
    out: Out = None,
) -> None:
    """Run the models on measured tests and score them against what was observed; a table of tosses by pose histories."""
    from harness.records.result_folder import check_folder, named_after
    from harness.validation.toss_run import body_of_tosses, validate_tosses
    from harness.validation.validation_run import validate as run_validation

    folder = out or OUT / named_after(experiments)
    check_folder(folder, ("validation", "tosses"))
    thrown = body_of_tosses(experiments, body, samples=samples, resume=resume, fit_share=fit_share)
    if thrown is not None:
        measured = validate_tosses(experiments, folder, thrown, models=engine, seed=seed, jobs=jobs)
        _say(measured, "", folder, saying)
        return
    found = run_validation(
        experiments,
        folder,
        models=engine,
        samples=samples,
        fit_share=fit_share,
        seed=seed,
        jobs=jobs,
        resume=resume,
        quiet=saying.silent,
    )
    _say(found, "", folder, saying)


Quick = Annotated[bool, typer.Option("--quick", help="A few rows of each kind: to see that it works, not to judge.")]
Parts = Annotated[
    str | None,
    typer.Option(
        "--parts", metavar="NAMES", help="Only these parts (a,b), the others as measured before; see the docs."
    ),
]


@command(app, None, "rockcheck bench --out out/bench", "rockcheck bench --parts precision,skips")
def bench(saying: Saying, quick: Quick = False, parts: Parts = None, out: Out = None) -> None:
    """Measure run time against error for every engine and setting, what skips gain, and how cost grows."""
    from harness.bench.bench_run import run as measure

    folder = out or OUT / "bench"
    with ProgressMessages(saying.silent) as messages:
        found = measure(folder, quick, messages.engine, _names(parts))
    _say(found, "\n".join(found["sentences"]), folder, saying)


@command(app, None, "rockcheck stress --out out/stress", "rockcheck stress --parts fuzz")
def stress(saying: Saying, quick: Quick = False, parts: Parts = None, out: Out = None) -> None:
    """Run hard scenes, map each engine's stability, and read thousands of mutated files."""
    from harness.bench.stress.stress_run import run, sentences
    from harness.records.base import as_file

    folder = out or OUT / "stress"
    with ProgressMessages(saying.silent) as messages:
        found = run(folder, quick, messages.engine, _names(parts))
    _say(as_file(found), "\n".join(sentences(found)), folder, saying)
    raise typer.Exit(OK if found.holds else FAILED)


def _names(parts: str | None) -> list[str] | None:
    """The parts named in one option, None for all."""
    return None if parts is None else [name.strip() for name in parts.split(",") if name.strip()]


def _say(found: Mapping[str, Any], text: str, folder: Path, saying: Saying, language: str = "en") -> None:
    """Say what was computed, then write its pages; one that cannot be written is no mistake of the user's, and costs no other."""
    from harness.model.errors import InputError
    from reports.pages.page import write_report

    if text or saying.as_json:
        saying.say(found, text)
    try:
        page = write_report(folder, language)
    except InputError as error:
        for mistake in error.mistakes:
            typer.echo(f"error: {mistake}", err=True)
        raise typer.Exit(FAILED) from error
    except Exception as fault:
        page_name = ", ".join(getattr(fault, "__notes__", ["a page"]))
        fault_text = (
            f"{page_name} could not be made, {type(fault).__name__}: {fault}; a fault of rockcheck: please report it"
        )
        typer.echo(printable(f"error: {fault_text}"), err=True)
        raise typer.Exit(FAILED) from fault
    if not saying.silent:
        typer.echo(printable(f"report: {page}"))


harness_cli.add_commands(app)
cli_input.add_commands(app)
cli_record.add_commands(app)


def main() -> None:
    """Entry point of the command."""
    if isinstance(sys.stdout, TextIOWrapper):
        # The name of a file may be no text: what cannot be printed is printed as escapes.
        sys.stdout.reconfigure(errors="backslashreplace")
    sys.exit(guarded(app))


if __name__ == "__main__":
    main()
