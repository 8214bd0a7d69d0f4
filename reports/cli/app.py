"""The application `rockcheck`: how a function becomes one of its commands, what these share, and how they end."""

from __future__ import annotations

import errno
import inspect
import shlex
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from harness.model import InputError, Mistake, json_text, printable, printable_lines

if TYPE_CHECKING:
    from harness.input.motions.recordfile import Layout
    from harness.records.base import Record


app = typer.Typer(
    name="rockcheck",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="markdown",
    context_settings={"help_option_names": ["-h", "--help"]},
)


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


def command(app: typer.Typer, name: str | None = None, *examples: str) -> Callable[[Callable[..., None]], None]:
    """Add a function as a command: its parameters that are groups of options are spread into these, its examples shown."""

    def add(function: Callable[..., None]) -> None:
        words = f"Example{'s' if len(examples) > 1 else ''}:  " + "  ·  ".join(f"`{line}`" for line in examples)
        app.command(name, epilog=words)(spread(function))

    return add


def spread(function: Callable[..., None]) -> Callable[..., None]:
    """A function of options alone, for one whose parameters may be dataclasses of options."""
    parameters: list[inspect.Parameter] = []
    groups = {}
    for name, given in inspect.signature(function, eval_str=True).parameters.items():
        if isinstance(given.annotation, type) and is_dataclass(given.annotation):
            groups[name] = given.annotation
            own = list(inspect.signature(given.annotation, eval_str=True).parameters.values())
        else:
            own = [given]
        parameters += [item.replace(kind=inspect.Parameter.KEYWORD_ONLY) for item in own]

    def called(**values: Any) -> None:
        parts = {
            name: group(**{item.name: values.pop(item.name) for item in fields(group)})
            for name, group in groups.items()
        }
        function(**values, **parts)

    described: Any = called
    described.__name__, described.__doc__ = function.__name__, function.__doc__
    described.__signature__ = inspect.Signature(parameters)
    described.__annotations__ = {item.name: item.annotation for item in parameters}
    return called


# What commands share: options, alone and in groups, and how much is said.


SceneFile = Annotated[Path, typer.Argument(metavar="SCENE", help="A scene file (TOML).", show_default=False)]
JsonOnly = Annotated[
    bool,
    typer.Option(
        "--json", help="Print the record as JSON and nothing else; `rockcheck report DIR` writes a result's pages."
    ),
]


OUT: Final = Path("out")


def folder_of(out: Path | None, file: Path, ending: str = "") -> Path:
    """The folder of a result: the one that is named, else one after the file that is asked about."""
    from harness.records.base import named_after

    return out or OUT / f"{named_after(file)}{ending}"


Out = Annotated[Path | None, typer.Option("--out", help="Folder of the result. Default: out/NAME.", show_default=False)]
Jobs = Annotated[int | None, typer.Option("--jobs", "-j", help="Processes. Default: one for each core.", min=1)]
Seed = Annotated[int, typer.Option("--seed", help="Seed of the draws.", min=0)]
Dask = Annotated[
    str | None, typer.Option("--dask", metavar="ADDRESS", help="Run on the Dask cluster of this scheduler.")
]
Resume = Annotated[
    bool,
    typer.Option("--resume", help="Only continue: refuse a folder without results of an earlier call."),
]
InLanguage = Annotated[str, typer.Option("--language", help="Language of the pages: en or it.", show_default=True)]


@dataclass(frozen=True)
class OutputOptions:
    """How much a command prints."""

    as_json: JsonOnly = False
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print errors only.")] = False
    verbose: Annotated[bool, typer.Option("--verbose", "-v", help="Print every finding, by severity.")] = False

    @property
    def silent(self) -> bool:
        """Whether progress is not told."""
        return self.quiet or self.as_json

    def say(self, record: Mapping[str, object] | Sequence[object], text: str) -> None:
        """What a command found: as JSON, or as text, or not at all."""
        if self.as_json:
            typer.echo(json_text(record))
        elif not self.quiet:
            typer.echo(printable_lines(text))


def _engine_names() -> list[str]:
    """For a shell that completes a word."""
    from harness.engines import REGISTRY

    return list(REGISTRY)


@dataclass(frozen=True)
class EngineOptions:
    """Which engines, and what is changed of the scene."""

    engine: Annotated[
        list[str] | None,
        typer.Option(
            "--engine",
            "-e",
            help="An engine to run (repeat for more). Default: analytic, pymunk, pybullet; where the floor moves across the "
            "plane under a statue without a pedestal, spatial too; thrown: spatial, pybullet.",
            autocompletion=_engine_names,
        ),
    ] = None
    overrides: Annotated[
        list[str] | None,
        typer.Option(
            "--set", metavar="KEY=VALUE", help="Replace one key of the scene, such as motion.x.amplitude_g=0.3."
        ),
    ] = None


@dataclass(frozen=True)
class Sampling:
    """How many draws, of which seed, and how far a contact engine's interval is narrowed with at most how many runs."""

    draws: Annotated[int, typer.Option("--draws", help="Draws of what is uncertain.", min=10, max=1_000_000)] = 10_000
    seed: Seed = 0
    half_width: Annotated[
        float, typer.Option("--half-width", help="Half width of an engine's interval at 90 %.", min=0.005, max=0.5)
    ] = 0.05
    most_runs: Annotated[int, typer.Option("--most-runs", help="Most runs of each contact engine.", min=30)] = 400


@dataclass(frozen=True)
class TargetOptions:
    """To what accuracy, or at which step, engines run."""

    accuracy: Annotated[
        float | None,
        typer.Option("--accuracy", metavar="RAD", help="Target of the rotation's numerical error. Default: 1e-3."),
    ] = None
    dt: Annotated[float | None, typer.Option("--dt", metavar="S", help="Fixed time step, instead of --accuracy.")] = (
        None
    )


@dataclass(frozen=True)
class ScanOptions:
    """What the user says of a scan on the command line; None is found, assumed or refused, and said so."""

    unit: Annotated[str | None, typer.Option("--unit", help="The scan's unit of length: m, dm, cm, mm, in, ft.")] = None
    height_m: Annotated[
        float | None, typer.Option("--height", metavar="M", help="The statue's true height, which sets the scale.")
    ] = None
    up: Annotated[
        str | None,
        typer.Option(
            "--up", help="The scan's vertical axis: x, y, z, -x, -y, -z or a direction X,Y,Z. Default: found."
        ),
    ] = None
    density_kg_m3: Annotated[
        float | None, typer.Option("--density", metavar="KG_M3", help="Density. Default: marble, 2700.")
    ] = None
    mass_kg: Annotated[
        float | None, typer.Option("--mass", metavar="KG", help="Weighed mass, instead of a density.")
    ] = None
    max_faces: Annotated[int, typer.Option("--max-faces", help="Faces to keep, the base untouched.")] = 50_000
    contact_tolerance_m: Annotated[
        float,
        typer.Option(
            "--contact-tolerance", metavar="M", help="Vertices within this height of the lowest are in contact."
        ),
    ] = 1e-3
    cut_below_m: Annotated[
        float | None,
        typer.Option(
            "--cut-below", metavar="M", help="Cut off a scanned floor at this height; 0: keep it as part of the statue."
        ),
    ] = None
    cut_beyond: Annotated[
        str | None,
        typer.Option(
            "--cut-beyond",
            metavar="AZIMUTH,M",
            help="Cut off a scanned wall or second body, beyond M along AZIMUTH (degrees); none: keep it as part of the statue.",
        ),
    ] = None


@dataclass(frozen=True)
class SupportOptions:
    """What the user says on the command line of what a scanned statue stands on and of how it is shaken."""

    pedestal: Annotated[
        str | None,
        typer.Option(
            "--pedestal", metavar="KG,M,M,M", help="A pedestal's mass, width, depth and height: 250,0.6,0.8,0.2."
        ),
    ] = None
    friction: Annotated[
        float | None,
        typer.Option(
            "--friction", metavar="MU", help="Coefficient of friction under the statue, and under a pedestal."
        ),
    ] = None
    scale: Annotated[
        float | None, typer.Option("--scale", metavar="FACTOR", help="Factor on every component of the record.")
    ] = None
    motion_unit: Annotated[
        str | None,
        typer.Option(
            "--motion-unit", help="The record's unit, where its file does not say: m/s2, cm/s2 (gal), mm/s2, g."
        ),
    ] = None

    def pedestal_keys(self) -> dict[str, float] | None:
        """The keys of `[pedestal]`; raises `InputError` for a text that is no four numbers."""
        if self.pedestal is None:
            return None
        names = ("mass_kg", "width_m", "depth_m", "height_m")
        try:
            return dict(zip(names, map(float, self.pedestal.split(",")), strict=True))
        except ValueError:
            wanted = "four numbers with commas between them: " + ", ".join(names)
            raise InputError(Mistake("--pedestal", "", wanted, repr(self.pedestal))) from None


@dataclass(frozen=True)
class TextLayout:
    """How the numbers of a record stand in a text that no reader knows."""

    dt_s: Annotated[
        float | None, typer.Option("--dt", metavar="S", help="Unknown text format: time step between samples.")
    ] = None
    skip_lines: Annotated[
        int | None, typer.Option("--skip-lines", metavar="N", help="Unknown text format: header lines to skip.")
    ] = None
    columns: Annotated[
        str | None,
        typer.Option(
            "--columns",
            help="Unknown text format: acceleration columns, `2,3` or `2:N,3:E`; `all`: numbers that run on.",
        ),
    ] = None
    time_column: Annotated[
        int | None, typer.Option("--time-column", metavar="N", help="Unknown text format: time column, counted from 1.")
    ] = None

    def layout(self) -> Layout:
        """What the reader of records takes."""
        from harness.input.motions.recordfile import Layout

        return Layout(**vars(self))


# How a command ends: exit codes, a user's mistake told without a traceback, an interrupt; where its result goes.

OK: Final = 0
FAILED: Final = 1
WRONG_INPUT: Final = 2
INTERRUPTED: Final = 130
NO_SUCH_PLACE: Final = frozenset(
    {errno.ENAMETOOLONG, errno.ENOENT, errno.ENOTDIR, errno.EISDIR, errno.ELOOP, errno.EEXIST}
)
"""What the system says of a path that is wrong, not of one that cannot be written or read just now."""


def guarded(action: Any) -> int:
    """Run a command; a user's mistake becomes a message on stderr and exit code 2, never a traceback.

    A request to end (SIGTERM) does what an interrupt does: workers are stopped, a store is closed, what is kept is said. A
    warning of Python's is said where progress is, on one line, or not at all.
    """
    with _ending_cleanly(), warnings.catch_warnings():
        warnings.showwarning = lambda *_: None
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
            again = shlex.join(["rockcheck", *sys.argv[1:]])
            kept = [note for each in _causes(ending) for note in getattr(each, "__notes__", ())]
            told = f"{kept[0]}, and this goes on" if kept else "the same again"
            print(f"interrupted; {told}: {again}", file=sys.stderr)
            return INTERRUPTED
        except BrokenPipeError:
            sys.stderr.close()
            return FAILED
        except OSError as error:
            what = "the output could not be written: "
            if error.filename:
                what = f"{printable(repr(str(error.filename)))} could not be read or written: "
            elif error.errno is None:  # a library's own words
                what = ""
            print(f"error: {what}{printable(error.strerror or str(error))}", file=sys.stderr)
            return WRONG_INPUT if error.errno in NO_SUCH_PLACE else FAILED
    return int(code or OK)


@contextmanager
def _ending_cleanly() -> Iterator[None]:
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _causes(ending: BaseException | None) -> Iterator[BaseException]:
    """An exception and those while which it was raised, the last first."""
    while ending is not None:
        yield ending
        ending = ending.__context__


# Where a command's result goes, and how it is said: as JSON or as text, then its pages.


def say_record(record: Record, folder: Path, saying: OutputOptions, language: str = "en") -> None:
    """Say what was computed, then write its pages, none with `--json`: most of a short run's time, for a program that reads the
    record. A page that cannot be made is no mistake of the user's, and costs no other.
    """
    from harness.records.base import as_file
    from reports.terminal import record_lines

    saying.say(as_file(record), "\n".join(record_lines(record, verbose=saying.verbose)))
    if saying.as_json:
        return
    from reports.pages.page import write_report

    try:
        page = write_report(folder, language)
    except InputError as error:
        for mistake in error.mistakes:
            typer.echo(f"error: {mistake}", err=True)
        raise typer.Exit(FAILED) from error
    except (OSError, KeyboardInterrupt):
        pages = f"`rockcheck report {shlex.quote(str(folder))}` writes its pages"
        typer.echo(printable(f"the result stands in {folder}; {pages}"), err=True)
        raise
    except Exception as fault:
        name = ", ".join(getattr(fault, "__notes__", ["a page"]))
        what = f"{name} could not be made, {type(fault).__name__}: {fault}"
        typer.echo(printable(f"error: {what}; a fault of rockcheck: please report it"), err=True)
        raise typer.Exit(FAILED) from fault
    if not saying.silent:
        typer.echo(printable(f"report: {page}"))
