"""The commands that look at a user's own files: scans, motions, a first scene, histories of other software."""

from __future__ import annotations

import os
import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from harness.model import InputError, printable, require, required, texted, weighed
from reports.cli.app import app, command
from reports.cli.options import OutputOptions, ScanOptions, SupportOptions, TextLayout, folder_of
from reports.messages import ENGLISH

if TYPE_CHECKING:
    from harness.input.motions.inspect import MotionInspection as MotionInspection
    from meshes.prepare import Inspection

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
    from reports.drawing.scan_picture import scan_picture
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
        got = "a folder" if file.is_dir() else "no such file"
        require(file.is_file(), str(file), "an existing record", got)
        return inspect_file(file, unit=unit, layout=text.layout())
    model, _ = parse(read(file), str(file))
    component = SceneMotion.of(model, axis, file) if axis in ("x", "y", "z") else None
    given = [name for name in ("x", "y", "z") if getattr(model.motion, name) is not None]
    wanted = f"a component of the scene ({', '.join(given) or 'it has none'})"
    return inspect_component(required(component, "--axis", wanted, axis))
