"""What every command shares: options that come in groups, how much is said, exit codes, mistakes told without a traceback."""

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
from typing import Annotated, Any, Final

import typer

from harness.model.errors import InputError, Mistake
from harness.model.terminal import json_text, printable, printable_lines

OK: Final = 0
FAILED: Final = 1
WRONG_INPUT: Final = 2
INTERRUPTED: Final = 130
NO_SUCH_PLACE: Final = frozenset(
    {errno.ENAMETOOLONG, errno.ENOENT, errno.ENOTDIR, errno.EISDIR, errno.ELOOP, errno.EEXIST}
)
"""What the system says of a path that is wrong, not of one that cannot be written or read just now."""

SceneFile = Annotated[Path, typer.Argument(metavar="SCENE", help="A scene file (TOML).", show_default=False)]
Accuracy = Annotated[
    float | None,
    typer.Option("--accuracy", metavar="RAD", help="Target of the rotation's numerical error. Default: 1e-3."),
]
Step = Annotated[float | None, typer.Option("--dt", metavar="S", help="Fixed time step, instead of --accuracy.")]
JsonOnly = Annotated[
    bool,
    typer.Option("--json", help="Print the record as JSON and nothing else; `rockcheck report DIR` writes its pages."),
]


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

    draws: Annotated[int, typer.Option("--draws", help="Draws of what is uncertain.", min=10, max=1_000_000)] = 20_000
    seed: Annotated[int, typer.Option("--seed", help="Seed of the draws.", min=0)] = 0
    half_width: Annotated[
        float, typer.Option("--half-width", help="Half width of an engine's interval at 90 %.", min=0.005, max=0.5)
    ] = 0.05
    most_runs: Annotated[int, typer.Option("--most-runs", help="Most runs of each contact engine.", min=30)] = 400


@dataclass(frozen=True)
class Target:
    """To what accuracy, or at which step, engines run."""

    accuracy: Accuracy = None
    dt: Step = None


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
        typer.Option("--motion-unit", help="The record's unit, where its file does not say: m/s2, cm/s2, g."),
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
    """How the numbers of a record stand in a text that no reader knows (`harness.input.motions.recordfile.Layout`)."""

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


def guarded(action: Any) -> int:
    """Run a command; a user's mistake becomes a message on stderr and exit code 2, never a traceback.

    A request to end (SIGTERM) does what an interrupt does: workers are stopped, a store is closed, what is kept is said. A
    warning of Python's is said where progress is, on one line, or not at all.
    """
    with _ending_cleanly(), warnings.catch_warnings():
        warnings.showwarning = lambda *_: None
        return _guarded(action)


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


def _guarded(action: Any) -> int:
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
        print(f"interrupted: what a study has finished is kept in its store; this goes on: {again}", file=sys.stderr)
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
