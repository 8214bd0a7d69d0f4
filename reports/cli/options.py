"""What commands share: options, alone and in groups, and how much is said."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from harness.model import InputError, Mistake, json_text, printable_lines

if TYPE_CHECKING:
    from harness.input.motions.recordfile import Layout

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
