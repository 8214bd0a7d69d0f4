"""The commands that compute: run, compare, engines; pages and pictures are added in `reports/cli.py`."""

from __future__ import annotations

import errno
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from harness.campaign.progress import ProgressMessages
from harness.model.errors import InputError, Mistake
from harness.model.terminal import json_text, printable, printable_lines

if TYPE_CHECKING:
    from harness.model.scene import Scene
    from harness.scene_run.scene_run import Result

OK: Final = 0
FAILED: Final = 1
WRONG_INPUT: Final = 2
INTERRUPTED: Final = 130
NO_SUCH_PLACE: Final = frozenset({errno.ENAMETOOLONG, errno.ENOENT, errno.ENOTDIR, errno.EISDIR, errno.ELOOP})
"""What the system says of a path that is wrong, not of one that cannot be written or read just now."""

Scenes = Annotated[list[Path], typer.Argument(metavar="SCENE...", help="Scene files (TOML).", show_default=False)]
Engines = Annotated[
    list[str] | None,
    typer.Option("--engine", "-e", help="An engine to run (repeat for more). Default: analytic, pymunk, pybullet."),
]
Overrides = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Replace one key of the scene, such as motion.x.amplitude_g=0.3."),
]
Accuracy = Annotated[
    float | None, typer.Option("--accuracy", metavar="RAD", help="Wanted accuracy of the rotation. Default: 1e-3.")
]
Step = Annotated[
    float | None, typer.Option("--dt", metavar="S", help="The expert's own time step, instead of --accuracy.")
]
NoSkip = Annotated[
    list[str] | None, typer.Option("--no-skip", metavar="NAME", help="Switch one skip off (see --explain), or `all`.")
]
Json = Annotated[bool, typer.Option("--json", help="Print the record as JSON and nothing else.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but mistakes.")]


def add_commands(app: typer.Typer) -> None:
    """Mount the computing commands on the application."""
    app.command("engines", epilog="Example:  `rockcheck engines`")(engines)
    app.command(
        "compare", epilog="Examples:  `rockcheck compare scenes/free_rocking.toml`  ·  `rockcheck compare A.csv B.csv`"
    )(compare)
    store = typer.Typer(no_args_is_help=True, help="Look after the stores of studies.")
    store.command("salvage", epilog="Example:  `rockcheck store salvage out/map/store.sqlite saved.sqlite`")(salvage)
    app.add_typer(store, name="store")


def engines(as_json: Json = False) -> None:
    """List the engines: what each computes, and whether it runs here."""
    from dataclasses import asdict

    from harness.engines import REGISTRY, load
    from harness.model.run import to_plain

    rows = [
        to_plain({"engine": name, "missing": engine.missing(), **asdict(engine.capabilities), "order": engine.order})
        for name in REGISTRY
        for engine in [load(name)]
    ]
    if as_json:
        typer.echo(json_text(rows))
        return
    for row in rows:
        able = ", ".join(key.replace("_", " ") for key, value in row.items() if value is True)
        state = f"not here: {row['missing']}" if row["missing"] else "ready"
        typer.echo(f"{row['engine']:10} {row['dimensions']}D  {state}\n{'':10} {able}")


def compare(
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="SCENE... | A.csv B.csv", help="Scenes, or two histories (B is the reference).", show_default=False
        ),
    ],
    engine: Engines = None,
    overrides: Overrides = None,
    accuracy: Accuracy = None,
    dt: Step = None,
    iso: Annotated[bool, typer.Option("--iso", help="Also rate by ISO/TS 18571 (extra [iso]).")] = False,
    horizon: Annotated[
        bool, typer.Option("--horizon", help="Also find each model's own horizon (some twenty runs of each).")
    ] = False,
    uncertainty: Annotated[
        float | None,
        typer.Option("--uncertainty", metavar="RAD", help="Numerical error of the rotation in two histories."),
    ] = None,
    slip_uncertainty: Annotated[
        float | None,
        typer.Option("--slip-uncertainty", metavar="M", help="Numerical error of the slip in two histories."),
    ] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Score histories against each other: of engines on a scene, or of any software from two CSV files."""
    tables = [path.suffix == ".csv" for path in files]
    if any(tables):
        if not all(tables) or len(files) != 2:
            got = ", ".join(str(path) for path in files)
            raise InputError(Mistake("compare", "", "scenes, or exactly two .csv histories", got))
        if engine or overrides or accuracy is not None or dt is not None or horizon:
            no_run = "no -e, --set, --accuracy, --dt or --horizon with histories: nothing is run"
            raise InputError(Mistake("compare", "", no_run, "one of them"))
        from harness.comparison.comparator import compare_files

        scores = compare_files(*files, uncertainty_rad=uncertainty, slip_uncertainty_m=slip_uncertainty, iso=iso)
        found = {f"{files[0].name}_vs_{files[1].name}": scores}
    elif uncertainty is not None or slip_uncertainty is not None:
        named = "--slip-uncertainty" if uncertainty is None else "--uncertainty"
        raise InputError(Mistake(named, "", "two .csv histories: runs state their own", "scenes"))
    else:
        found = {}
        for path in files:
            result = compute(
                path, engine, overrides, accuracy, dt, None, quiet=quiet or as_json, iso=iso, horizon=horizon
            )
            prefix = f"{path.stem}: " if len(files) > 1 else ""
            found |= {f"{prefix}{pair}": scores for pair, scores in result.scores.items()}
    from harness.model.run import to_plain

    if as_json:
        typer.echo(json_text(to_plain(found)))
    elif not quiet:
        for pair, scores in found.items():
            typer.echo(table_of(pair, to_plain(scores)))


def table_of(title: str, scores: Mapping[str, Any]) -> str:
    """One pair's scores as aligned lines; lists are counted."""
    lines = [title]
    for name, value in scores.items():
        if name == "warnings":
            lines += [f"  warning: {text}" for text in value]
        elif isinstance(value, float):
            lines.append(f"  {name:34} {value:.6g}")
        elif isinstance(value, (str, int)) or value is None:
            lines.append(f"  {name:34} {'—' if value is None else value}")
        elif isinstance(value, list):
            lines.append(f"  {name:34} {len(value)} of them (see --json)")
        elif isinstance(value, Mapping) and "sentence" in value:
            lines.append(f"  {name:34} {value['sentence']}")
    return "\n".join(map(printable, lines))


def salvage(
    damaged: Annotated[Path, typer.Argument(metavar="FILE", help="The damaged store.", show_default=False)],
    fresh: Annotated[Path, typer.Argument(metavar="NEW", help="The store to write.", show_default=False)],
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Copy what can still be read of a damaged store into a new one."""
    from harness.studies.recover import salvage as rescue

    saved = rescue(damaged, fresh)
    found = {**vars(saved), "store": str(fresh)}
    say(found, f"{fresh}: {saved}", as_json, quiet)


def say(found: Mapping[str, Any] | Sequence[Any], text: str, as_json: bool, quiet: bool) -> None:
    """What a command found: as JSON, or as text, or not at all."""
    if as_json:
        typer.echo(json_text(found))
    elif not quiet:
        typer.echo(printable_lines(text))


def compute(
    scene_file: Path,
    names: Sequence[str] | None,
    overrides: Sequence[str] | None,
    accuracy: float | None,
    dt: float | None,
    no_skip: Sequence[str] | None,
    *,
    quiet: bool,
    iso: bool = False,
    horizon: bool = False,
    out: Path | None = None,
    assess: bool = False,
    witness: bool = False,
) -> Result:
    """Load and run one scene, telling on stderr what is at work. Raises `InputError`, also where `out` cannot take the result."""
    from harness.accuracy.simulation import check_target
    from harness.engines import DEFAULT_ENGINES, load
    from harness.input.scene_file import load_scene
    from harness.scene_run.scene_run import check_writing, run_scene
    from harness.scene_run.workload import check as check_work

    check_target(accuracy, dt)
    want = wanted(no_skip)
    scene = load_scene(scene_file, overrides or ())
    engines_asked = names or DEFAULT_ENGINES
    if out is not None:
        check_writing(out, scene, engines_asked)
    dimensions = {name: load(name).capabilities.dimensions for name in engines_asked}
    estimate = check_work(scene, dimensions, str(scene_file), accuracy, dt)
    with ProgressMessages(quiet) as telling:
        if estimate:
            telling.say(estimate)
        return run_scene(
            scene,
            engines_asked,
            accuracy_rad=accuracy,
            dt_s=dt,
            want=want,
            told=telling.engine,
            apart=True,
            iso=iso,
            horizon=horizon,
            assess=assess,
            witness=witness,
        )


def explain(scene: Scene, names: Sequence[str] | None, no_skip: Sequence[str] | None, *, as_json: bool = False) -> str:
    """The plan of a scene as text, or as a JSON list of its steps."""
    from harness.engines import DEFAULT_ENGINES, REGISTRY, load
    from harness.model.run import to_plain
    from harness.statics.plan import plan

    steps = plan(scene, [load(name) for name in names or DEFAULT_ENGINES], wanted(no_skip), REGISTRY)
    if as_json:
        return json_text(to_plain(steps))
    return "\n".join(printable(str(step)) for step in steps)


def wanted(no_skip: Sequence[str] | None) -> Any:
    """What is asked, from the `--no-skip` options. Raises `InputError` for a name that is no skip."""
    from difflib import get_close_matches

    from harness.model.options import SKIPS, RunOptions

    off = set(no_skip or ())
    unknown = [name for name in off if name not in SKIPS and name != "all"]
    if unknown:
        near = get_close_matches(unknown[0], SKIPS, n=1)
        advice = f"did you mean {near[0]}?" if near else ""
        raise InputError(Mistake("--no-skip", "", f"all or one of {', '.join(SKIPS)}", repr(unknown[0]), advice))
    return RunOptions(skips=frozenset() if "all" in off else frozenset(SKIPS) - off)


def summary(result: Result) -> str:
    """The result in a few lines of plain words."""
    from harness.assess.assessment import sentence
    from harness.records.witness import sentences as witness_sentences

    lines = [result.scene.title]
    lines += [f"  {name}: the statue {sentence(item)}" for name, item in result.assessment.items()]
    outcomes = sorted({run.outcome for run in result.runs.values() if not run.outcome.failed})
    if len(result.runs) > 1 and outcomes:
        ended = "all models agree: " + outcomes[0].sentence if len(outcomes) == 1 else "the models differ"
        if len(outcomes) > 1 and all(outcome.overturned for outcome in outcomes):
            ended = "all models agree that the statue overturns; the side differs"
        given = {tuple(run.motion_axes) for run in result.runs.values() if run.motion_axes is not None}
        lines.append(f"  outcome: {ended}" + (" (given unlike motions, see below)" if len(given) > 1 else ""))
    width = max(len("analytic"), *(len(name) for name in result.runs)) + 1
    for name, run in result.runs.items():
        lines.append(f"  {name:{width}} {run.outcome.sentence}{_details(run)}")
    for pair, scores in result.scores.items():
        lines.append(f"  {pair.replace('_vs_', ' vs ')}: {scores.verdict_sentence}")
    lines += [f"  witness: {text}" for text in witness_sentences(result.witness)]
    lines += [f"  horizon of {name}: {found.sentence}" for name, found in result.horizons.items()]
    lines += [f"  note: {note}" for note in result.scene.notes]
    lines += [f"  warning: {name}: {text}" for name, run in result.runs.items() for text in run.warnings]
    return "\n".join(map(printable, lines))


def _details(run: Any) -> str:
    if run.outcome.failed:
        return f": {run.message}"
    # An overturned run has no peak of its own: it was ended at the rotation that counts as overturned.
    if run.overturn_time_s is not None:
        parts = [f"counts as overturned at {run.overturn_time_s:.3f} s"]
    else:
        parts = [f"peak {run.peak_theta_rad:+.4f} rad at {run.peak_time_s:.3f} s"]
    if run.numerical_uncertainty_rad is not None:
        until = run.reliable_until_s
        slip = f" and {1e3 * run.slip_uncertainty_m:.1e} mm of slip" if run.slip_uncertainty_m else ""
        parts.append(
            f"± {run.numerical_uncertainty_rad:.1e} rad{slip}" + (f" until {until:.2f} s" if until is not None else "")
        )
    return " (" + ", ".join(parts) + f"; {run.wall_s:.2f} s)"


def guarded(action: Any) -> int:
    """Run a command; a user's mistake becomes a message on stderr and exit code 2, never a traceback."""
    try:
        code = action()
    except InputError as error:
        for mistake in error.mistakes:
            print(f"error: {mistake}", file=sys.stderr)
        return WRONG_INPUT
    except (KeyboardInterrupt, SystemExit) as ending:
        # Typer turns an interrupt into this exit code and says nothing.
        if isinstance(ending, SystemExit) and ending.code != INTERRUPTED:
            raise
        print("interrupted: no result was written; what a study has finished is kept in its store", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:
        sys.stderr.close()
        return FAILED
    except OSError as error:
        what = (
            f"{printable(repr(str(error.filename)))} could not be read or"
            if error.filename
            else "the output could not be"
        )
        print(f"error: {what} written: {error.strerror or error}", file=sys.stderr)
        return WRONG_INPUT if error.errno in NO_SUCH_PLACE else FAILED
    return int(code or OK)
