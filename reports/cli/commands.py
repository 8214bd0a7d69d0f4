"""The commands, in the order in which the help lists them; what each needs is loaded when it runs."""

from __future__ import annotations

import os
import shlex
import time
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from harness.model import (
    InputError,
    Mistake,
    check_known,
    info,
    printable,
    require,
    required,
    texted,
    weighed,
)
from harness.runs.progress import ProgressMessages
from reports.cli.app import (
    FAILED,
    OK,
    OUT,
    Dask,
    EngineOptions,
    InLanguage,
    Jobs,
    JsonOnly,
    Out,
    OutputOptions,
    Resume,
    Sampling,
    ScanOptions,
    SceneFile,
    Seed,
    SupportOptions,
    TargetOptions,
    TextLayout,
    app,
    command,
    folder_of,
    say_record,
)
from reports.messages import ENGLISH
from reports.messages import language as known_language

if TYPE_CHECKING:
    from harness.input.motions.inspect import MotionInspection as MotionInspection
    from harness.model import RunOptions, Scene
    from harness.questions.bench.parts import Measurement, R
    from harness.questions.scene.scene_run import Result
    from harness.records.base import Record
    from harness.records.scores import Scores
    from harness.records.validation import SetScores
    from meshes.prepare import Inspection


# One scene by several engines, and histories held against each other: run, compare; what engines and records there are.


@command(
    app, None, "rockcheck run scenes/paestum_floor.toml",
    "rockcheck run scenes/paestum_floor.toml -e analytic -e pymunk --set motion.x.frequency_hz=2 --accuracy 1e-4",
)  # fmt: skip
def run(
    scene: SceneFile,
    asked: EngineOptions,
    target: TargetOptions,
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
        bool,
        typer.Option(
            "--witness", help="Compare the runs with unmodified engines (up to twice the time; more where they part)."
        ),
    ] = False,
    no_assess: Annotated[bool, typer.Option("--no-assess", help="Skip the overturning probability.")] = False,
    language: InLanguage = "en",
) -> None:
    """Run one scene with several engines; write histories, scores and a report."""
    from harness.questions.scene.scene_run import Ended, write_result
    from harness.records.base import check_folder

    folder = folder_of(out, scene)
    check_folder(folder, ("run",))
    known_language(language)
    if explain:
        saying.say(*plan_of(scene, asked, target, no_skip))
        return
    try:
        result = compute(
            scene, asked, target, no_skip, quiet=saying.silent, out=folder, assess=not no_assess, witness=witness
        )
    except Ended as ending:
        write_result(ending.result, folder, ENGLISH.say)
        pages = f"`rockcheck report {shlex.quote(str(folder))}` writes its pages"
        typer.echo(printable(f"{folder} holds what had finished; {pages}"), err=True)
        raise
    write_result(result, folder, ENGLISH.say)
    say_record(result.record().texted(ENGLISH.say), folder, saying, language)
    # An engine that nobody named and that has no wheels here is said, and no failure.
    failed = result.failed_but(() if asked.engine else tuple(result.runs))
    raise typer.Exit(FAILED if failed else OK)


def plan_of(
    scene_file: Path, asked: EngineOptions, target: TargetOptions, no_skip: Sequence[str] | None
) -> tuple[list[object], str]:
    """What a run would skip and why: as plain values with its sentences, and as lines."""
    from harness.engines import REGISTRY, load
    from harness.model import to_plain
    from harness.statics.plan import plan

    scene, names = asked_scene(scene_file, asked, target)
    steps = plan(scene, [load(name) for name in names], options_without(no_skip), REGISTRY)
    told = [replace(step, reason=replace(step.reason, text=ENGLISH.say(step.reason))) for step in steps]
    lines = [f"{'skip' if step.applies else 'keep'} {step.skip} ({step.engine}): {step.reason.text}" for step in told]
    return to_plain(told), "\n".join(map(printable, lines))


@command(app, None, "rockcheck compare scenes/free_rocking.toml", "rockcheck compare A.csv B.csv --out out/ab")
def compare(
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="SCENE... | A.csv B.csv", help="Scenes, or two histories (B is the reference).", show_default=False
        ),
    ],
    asked: EngineOptions,
    target: TargetOptions,
    saying: OutputOptions,
    iso: Annotated[bool, typer.Option("--iso", help="Also rate by ISO/TS 18571 (extra [iso]).")] = False,
    horizon: Annotated[
        bool,
        typer.Option("--horizon", help="Also measure each model's horizon of prediction (about twenty runs each)."),
    ] = False,
    uncertainty: Annotated[
        float | None,
        typer.Option("--uncertainty", metavar="RAD", help="Numerical error of the rotation in two histories."),
    ] = None,
    slip_uncertainty: Annotated[
        float | None,
        typer.Option("--slip-uncertainty", metavar="M", help="Numerical error of the slip in two histories."),
    ] = None,
    measured: Annotated[
        float | None,
        typer.Option("--measured-uncertainty", metavar="RAD", help="B is measured, with this standard uncertainty."),
    ] = None,
    from_inputs: Annotated[
        float, typer.Option("--input-uncertainty", metavar="RAD", help="That of A because of its inputs.")
    ] = 0.0,
    out: Annotated[
        Path | None, typer.Option("--out", help="Of two histories: the folder of a page with their chart.")
    ] = None,
) -> None:
    """Score histories against each other: of engines on a scene, or of any software from two CSV files."""
    from harness.comparison.scores import Measured
    from harness.model import to_plain
    from harness.records.base import option_words
    from reports.source import scores_text
    from reports.terminal import wrapped

    require(measured is not None or not from_inputs, "--input-uncertainty", "beside --measured-uncertainty", "alone")
    over_all: dict[str, SetScores] = {}
    of_files = {"uncertainty": uncertainty, "slip_uncertainty": slip_uncertainty, "measured_uncertainty": measured}
    given = {name: str(value) for name, value in of_files.items() if value is not None}
    if any(path.suffix == ".csv" for path in files):
        no_run = "no -e, --set, --accuracy, --dt or --horizon with histories: nothing is run"
        require((asked, target, horizon) == (EngineOptions(), TargetOptions(), False), "compare", no_run, "one of them")
        words = option_words(**given, input_uncertainty=from_inputs, iso=iso)
        pairs = compared_histories(
            files, out, words, uncertainty_rad=uncertainty, slip_uncertainty_m=slip_uncertainty, iso=iso,
            measured=None if measured is None else Measured(measured, from_inputs),
        )  # fmt: skip
    else:
        for word in option_words(**given):
            raise InputError(Mistake(word, "", "two .csv histories: runs state their own", "scenes"))
        require(out is None, "--out", "two .csv histories", "scenes", "`rockcheck run SCENE` writes their page")
        pairs, over_all = compared_scenes(files, asked, target, quiet=saying.silent, iso=iso, horizon=horizon)
    lines = [scores_text(pair, scores) for pair, scores in pairs.items()]
    for name, found in over_all.items():
        same = info("same_outcome", model=name, reference=found.reference, same=found.same, cases=found.cases)
        lines += [ENGLISH.say(each) for each in (same, *found.findings(name))]
    lines = [row for line in "\n".join(lines).split("\n") for row in wrapped(line, len(line) + 1, "  ")]
    if out is not None:
        from reports.pages.page import write_report

        lines.append(f"report: {write_report(out)}")
    saying.say(to_plain(pairs | ({"over_all_scenes": over_all} if over_all else {})), "\n".join(lines))


def compared_histories(
    files: Sequence[Path], out: Path | None, asked: Sequence[str], **stated: Any
) -> dict[str, Scores]:
    """The scores of two history files, written into `out` where it is given. Raises `InputError` for other files."""
    from harness.comparison.comparator import compare_files, write_comparison

    two = [path.suffix for path in files] == [".csv", ".csv"]
    require(two, "compare", "scenes, or exactly two .csv histories", ", ".join(map(str, files)))
    a, b = files
    scores = compare_files(a, b, **stated)
    if out is not None:
        write_comparison(a, b, scores, out, asked or None)
    return {f"{a.name}_vs_{b.name}": scores}


def compared_scenes(
    files: Sequence[Path], asked: EngineOptions, target: TargetOptions, *, quiet: bool, iso: bool, horizon: bool
) -> tuple[dict[str, Scores], dict[str, SetScores]]:
    """The scores of engines by pair (and scene), and of several scenes each model's against a reference over all of them."""
    from harness.questions.study.study_record import KeyedRow, score_sets
    from harness.records.study import CaseRun
    from harness.runs.task import answer_of

    by_pair: dict[str, Scores] = {}
    rows: list[KeyedRow] = []
    for number, path in enumerate(files):
        result = compute(path, asked, target, quiet=quiet, iso=iso, horizon=horizon)
        prefix = f"{path.stem}: " if len(files) > 1 else ""
        by_pair |= {f"{prefix}{pair}": scores for pair, scores in result.scores.items()}
        cases = {name: CaseRun.stored(answer_of(run, False).record) for name, run in result.runs.items()}
        rows += [
            KeyedRow(number=number, engine=name, reason="", varied={}, run=each, key=None)
            for name, each in cases.items()
        ]
    names = [row.engine for row in rows]
    reference = "analytic" if "analytic" in names else names[0]
    return by_pair, score_sets(rows, reference=reference) if len(files) > 1 else {}


@command(app, None, "rockcheck engines")
def engines(as_json: JsonOnly = False) -> None:
    """List the engines: what each computes, and whether it runs here."""
    from harness.engines import REGISTRY, load
    from harness.model import to_plain

    rows = [
        to_plain({"engine": name, "missing": engine.missing(), **asdict(engine.capabilities), "order": engine.order})
        for name in REGISTRY
        for engine in [load(name)]
    ]
    states = [f"not installed: {row['missing']}" if row["missing"] else "ready" for row in rows]
    able = [", ".join(key.replace("_", " ") for key, value in row.items() if value is True) for row in rows]
    lines = [
        f"{row['engine']:10} {row['dimensions']}D  {state}\n{'':10} {what}"
        for row, state, what in zip(rows, states, able, strict=True)
    ]
    OutputOptions(as_json).say(rows, "\n".join(lines))


@command(app, None, "rockcheck schema run > run.schema.json")
def schema(
    kind: Annotated[str, typer.Argument(metavar="KIND", help="The record's `kind`: run, study, …", show_default=False)],
) -> None:
    """Print the JSON Schema of a kind of `result.json`."""
    from harness.records.base import KINDS, class_of, schema_of

    check_known(kind, KINDS, "KIND")
    OutputOptions(as_json=True).say(schema_of(class_of(kind)), "")


def compute(
    scene_file: Path,
    asked: EngineOptions,
    target: TargetOptions,
    no_skip: Sequence[str] | None = None,
    *,
    quiet: bool,
    out: Path | None = None,
    iso: bool = False,
    horizon: bool = False,
    assess: bool = False,
    witness: bool = False,
) -> Result:
    """Load and run one scene (see `harness.questions.scene.scene_run.run_scene`), telling on stderr what is at work.

    Raises `InputError`, also where `out` cannot take the result.
    """
    from harness.engines import load
    from harness.questions.scene.scene_run import check_work, check_writing, run_scene

    options = options_without(no_skip)
    scene, names = asked_scene(scene_file, asked, target)
    if out is not None:
        check_writing(out, scene, names)
    dimensions = {name: load(name).capabilities.dimensions for name in names}
    with ProgressMessages(quiet) as messages:
        forecast = check_work(
            scene, dimensions, str(scene_file), target.accuracy, target.dt,
            assess=assess, witness=witness, horizon=horizon, spent_s=time.process_time(),
        )  # fmt: skip
        if forecast:
            messages.say(forecast)
        return run_scene(
            scene, names, accuracy_rad=target.accuracy, dt_s=target.dt, options=options, on_progress=messages.engine,
            iso=iso, horizon=horizon, apart=True, assess=assess, witness=witness,
        )  # fmt: skip


def asked_scene(scene_file: Path, asked: EngineOptions, target: TargetOptions) -> tuple[Scene, Sequence[str]]:
    """The scene of a file, and the engines that are to run it. Raises `InputError`, for a wrong target too."""
    from harness.accuracy.refinement import check_target
    from harness.engines import default_engines
    from harness.input.scene_file import load_scene

    check_target(target.accuracy, target.dt)
    scene = load_scene(scene_file, asked.overrides or ())
    return scene, asked.engine or default_engines(scene)


def options_without(no_skip: Sequence[str] | None) -> RunOptions:
    """The options of a run without the skips that `--no-skip` names. Raises `InputError` for a name that is no skip."""
    from harness.model import SKIPS, RunOptions

    off = no_skip or ()
    for name in off:
        check_known(name, ("all", *SKIPS), "--no-skip")
    return RunOptions(skips=frozenset() if "all" in off else frozenset(SKIPS).difference(off))


# The commands over many runs (assess, study, trust, validate, bench, stress) and finished records (report, figures, gif).


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
    from reports.export.figures import write_gif

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


# The commands that look at a user's own files: scans, motions, a first scene, histories of other software.


Scan = Annotated[Path, typer.Argument(metavar="SCAN", help="A scan: PLY, OBJ, STL, GLB or glTF.", show_default=False)]

mesh = typer.Typer(no_args_is_help=True, help="Inspect and prepare scans.")
motion = typer.Typer(no_args_is_help=True, help="Inspect motions.")
app.add_typer(mesh, name="mesh")
app.add_typer(motion, name="motion")


@command(mesh, "inspect", "rockcheck mesh inspect statue.obj --unit mm --picture statue.png")
def mesh_inspect(
    scan: Scan,
    known: ScanOptions,
    saying: OutputOptions,
    picture: Annotated[
        Path | None,
        typer.Option(
            "--picture",
            metavar="FILE",
            help="Draw the scan with base, weakest direction and axes (.png, .svg, .pdf, .html).",
        ),
    ] = None,
) -> None:
    """Print a scan's size, mass properties, repairs and doubts; write nothing but --picture."""
    from reports.cli.scans import inspect

    if picture is not None:
        _check_picture(picture)
    inspection = inspect(scan, known)
    if picture is not None:
        _draw(inspection, scan, picture)
    _say_scan(inspection, saying, *([f"picture: {picture}"] if picture is not None else []))


def _draw(inspection: Inspection, scan: Path, picture: Path) -> None:
    """Draw a scan. Raises `InputError` for one that cannot stand."""
    from harness.input.mesh_statue import mesh_mistake
    from reports.drawing.pictures import scan_picture
    from reports.export.figures import printed, write_picture

    if inspection.refusal is not None:
        raise InputError(mesh_mistake(inspection.refusal, str(scan)))
    assert inspection.solid is not None  # without a refusal there is one
    drawn = scan_picture(inspection.solid, inspection.prepared.rotation, scan.name)
    write_picture(printed(drawn, drawn.width), picture, dpi=150)


def _say_scan(inspection: Inspection, saying: OutputOptions, *last: str) -> None:
    from reports.cli.scans import record_of
    from reports.terminal import scan_lines

    lines = scan_lines(inspection, len(last), verbose=saying.verbose)
    saying.say(record_of(inspection, ENGLISH.say), "\n".join([*lines, *last]))


def _check_picture(picture: Path) -> None:
    """Raise `InputError` unless a picture of that name can be written without a loss."""
    from harness.model import check_own
    from reports.export.figures import FORMATS

    kinds = (*FORMATS, "html")
    require(picture.suffix[1:] in kinds, "--picture", f"a file ending in .{', .'.join(kinds)}", str(picture))
    there = Path(os.path.realpath(picture)).parent
    require(there.is_dir(), "--picture", "a file in an existing folder", str(picture))
    check_own(picture, option="--picture")


@command(mesh, "prepare", "rockcheck mesh prepare statue.obj --unit mm --out statue.ply")
def mesh_prepare(
    scan: Scan,
    known: ScanOptions,
    saying: OutputOptions,
    out: Annotated[Path, typer.Option("--out", help="The mesh to write (.ply, .obj, .stl, .glb).", show_default=False)],
) -> None:
    """Write a scan as a closed mesh in metres, z up, with a log of every change beside it."""
    from reports.cli.scans import prepare

    inspection, log = prepare(scan, out, known, ENGLISH.say)
    _say_scan(inspection, saying, f"mesh: {out}", f"processing log: {log}")


@command(app, None, "rockcheck new statue.obj --motion quake.AT2 --height 1.62")
def new(
    scan: Scan,
    motion_file: Annotated[Path, typer.Option("--motion", metavar="FILE", help="A record.", show_default=False)],
    known: ScanOptions,
    around: SupportOptions,
    text: TextLayout,
    saying: OutputOptions,
    out: Annotated[
        Path | None, typer.Option("--out", help="The scene to write. Default: SCAN's name with .toml.")
    ] = None,
) -> None:
    """Write a first, commented scene from a scan and a record; it runs as it is."""
    from harness.model import to_plain
    from reports.cli.scans import new as write_scene
    from reports.terminal import found_lines

    path = out or Path(f"{scan.stem}.toml")
    written, found = write_scene(scan, motion_file, path, known, around, text.layout(), ENGLISH.say)
    findings = texted(weighed(found), ENGLISH.say)
    run_it = f"run it: rockcheck run {shlex.quote(str(written))}"
    lines = [f"scene: {written}", *found_lines(findings, 2, verbose=saying.verbose), run_it]
    texts = [each.text for each in findings if each.code.startswith("scan_")]
    saying.say({"scene": str(written), "found": texts, "findings": to_plain(findings)}, "\n".join(lines))


@command(
    motion,
    "inspect",
    "rockcheck motion inspect quake.V2",
    "rockcheck motion inspect scenes/maria.toml --axis z",
    "rockcheck motion inspect any.txt --skip-lines 4 --dt 0.01 --columns 1:N,2:E --unit gal",
)
def motion_inspect(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A record, or a scene (TOML).", show_default=False)],
    saying: OutputOptions,
    text: TextLayout,
    unit: Annotated[
        str | None,
        typer.Option(
            "--unit", "--motion-unit", help="A record's unit, where the file does not say: m/s2, cm/s2 (gal), mm/s2, g."
        ),
    ] = None,
    axis: Annotated[str, typer.Option("--axis", help="Component of a scene to show: x, y or z.")] = "x",
    out: Annotated[Path | None, typer.Option("--out", help="Folder of picture and record. Default: out/NAME.")] = None,
) -> None:
    """Show a motion: measures in a table; histories, spectrum and Arias build-up in a picture."""
    from harness.model import write_json
    from harness.records.base import INSPECTED, check_folder, listing
    from reports.export.figures import printed, write_picture
    from reports.export.motion_figure import WIDE, motion_picture
    from reports.terminal import motion_lines

    folder = folder_of(out, Path(file.name.split(".")[0] or file.name))
    picture, record = (folder / name for name in INSPECTED)
    check_folder(folder, names=INSPECTED)
    inspected = _inspected(file, unit, axis, text)
    folder.mkdir(parents=True, exist_ok=True)
    write_picture(printed(motion_picture(inspected), WIDE), picture, dpi=150)
    shown = inspected.record(ENGLISH.say)
    write_json(record, {**shown, "files": listing([picture])})
    lines = motion_lines(inspected, texted(inspected.findings, ENGLISH.say), verbose=saying.verbose)
    saying.say(shown, "\n".join([*lines, printable(f"picture: {picture}")]))


def _inspected(file: Path, unit: str | None, axis: str, text: TextLayout) -> MotionInspection:
    """The record in a file, or the named component of a scene."""
    from harness.input.motions import SceneMotion
    from harness.input.motions.inspect import inspect_component, inspect_file
    from harness.input.tables import parse, read

    if file.suffix != ".toml":
        require(file.is_file(), str(file), "an existing record", "a folder" if file.is_dir() else "no such file")
        return inspect_file(file, unit=unit, layout=text.layout())
    model, _ = parse(read(file), str(file))
    component = SceneMotion.of(model, axis, file) if axis in ("x", "y", "z") else None
    given = [name for name in ("x", "y", "z") if getattr(model.motion, name) is not None]
    wanted = f"a component of the scene ({', '.join(given) or 'it has none'})"
    return inspect_component(required(component, "--axis", wanted, axis))
