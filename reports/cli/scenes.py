"""One scene by several engines, and histories held against each other: run, compare; what engines and records there are."""

from __future__ import annotations

import shlex
import time
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from harness.model import InputError, Mistake, check_known, printable, require
from harness.runs.progress import ProgressMessages
from reports.cli.app import app, command
from reports.cli.ending import FAILED, OK, say_record
from reports.cli.options import (
    EngineOptions,
    InLanguage,
    JsonOnly,
    Out,
    OutputOptions,
    SceneFile,
    TargetOptions,
    folder_of,
)
from reports.messages import ENGLISH
from reports.messages import language as known_language

if TYPE_CHECKING:
    from harness.model import RunOptions, Scene
    from harness.questions.scene.scene_run import Result
    from harness.records.scores import Scores
    from harness.records.validation import SetScores


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
    from harness.model import info, to_plain
    from harness.records.base import option_words
    from reports.terminal import wrapped
    from reports.text.wording import scores_text

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
    from harness.questions.scene.scene_run import check_writing, run_scene
    from harness.questions.scene.workload import check as check_work

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
