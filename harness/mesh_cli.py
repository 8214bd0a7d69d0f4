"""What `rockcheck mesh inspect|prepare` and `rockcheck new` do: records and text; the command's own words are
elsewhere."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from harness.input import paths
from harness.input.new_scene import Told, scene_text
from harness.model import run as record
from harness.model.errors import InputError, Mistake, mistake_from
from harness.records.result_folder import check_listed, listing, writing

if TYPE_CHECKING:
    from meshes.inspection import Inspection

MARBLE_KG_M3 = 2700.0
"""Density assumed for a statue of which nothing is said, and said so: marble."""


@dataclass(frozen=True)
class Known:
    """What the user says of a scan on the command line; None is found, assumed or refused, and said so."""

    unit: Annotated[str | None, typer.Option("--unit", help="The scan's unit of length: m, dm, cm, mm, in, ft.")] = None
    height_m: Annotated[
        float | None, typer.Option("--height", metavar="M", help="The statue's known height, to scale by.")
    ] = None
    up: Annotated[
        str | None, typer.Option("--up", help="The scan's vertical axis: x, y, z, -x, -y, -z. Default: found.")
    ] = None
    density_kg_m3: Annotated[
        float | None, typer.Option("--density", metavar="KG_M3", help="Density. Default: marble, 2700.")
    ] = None
    mass_kg: Annotated[
        float | None, typer.Option("--mass", metavar="KG", help="Weighed mass, instead of a density.")
    ] = None
    max_faces: Annotated[int, typer.Option("--max-faces", help="Faces to keep, the base untouched.")] = 50_000
    contact_tolerance_m: Annotated[
        float, typer.Option("--contact-tolerance", metavar="M", help="How near to the floor touches it.")
    ] = 1e-3
    cut_below_m: Annotated[
        float | None,
        typer.Option(
            "--cut-below", metavar="M", help="Height to cut a scanned floor off at; 0: it is the statue's own."
        ),
    ] = None


def inspect(file: Path, known: Known) -> Inspection:
    """Inspect a scan; raises `InputError` where it cannot be prepared."""
    from meshes import MeshError
    from meshes.inspection import inspect as inspected
    from meshes.prepare import Wanted

    if known.density_kg_m3 is not None and known.mass_kg is not None:
        raise InputError(Mistake("--density", "", "a density or a weighed mass", "both", "give one of them"))
    density = known.density_kg_m3
    if density is None and known.mass_kg is None:
        density = MARBLE_KG_M3
    wanted = Wanted(known.unit, known.height_m, known.up, known.max_faces, known.cut_below_m)
    try:
        return inspected(
            file,
            wanted,
            density_kg_m3=density,
            mass_kg=known.mass_kg,
            contact_tolerance_m=known.contact_tolerance_m,
        )
    except MeshError as error:
        raise InputError(mistake_from(str(error), str(file))) from error


def prepare(file: Path, out: Path, known: Known) -> tuple[Inspection, Path]:
    """Prepare a scan into the mesh file `out`, with its account beside it as JSON; returns the inspection and that
    path.

    Raises `InputError` for a scan that cannot be prepared or does not stand; then nothing is written.
    """
    account = out.with_suffix(".account.json")
    _check_out(out, account, file)
    found = inspect(file, known)
    if found.solid is None:
        raise InputError(mistake_from(str(found.refusal), str(file)))
    out.parent.mkdir(parents=True, exist_ok=True)
    with writing(out) as fresh:
        found.prepared.write(fresh)
    record.write_json(account, _plain(found, known) | {"files": listing([out], pages=False)})
    return found, account


@dataclass(frozen=True)
class Surroundings:
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
            "--friction", metavar="MU", help="Friction of the statue on its support, and of a pedestal's on the floor."
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


def new(scan: Path, motion: Path, out: Path, known: Known, around: Surroundings = Surroundings()) -> Path:
    """Write a first scene `out` (TOML) for a scan and a record, with the prepared mesh beside it; returns its path.

    Everything assumed stands in the scene as a comment. Raises `InputError`; then no scene is written.
    """
    from harness.input.motions.readers import read_record
    from harness.input.scene_file import load_scene

    if out.suffix != ".toml":
        raise InputError(Mistake("--out", "", "a file ending in .toml", str(out)))
    if os.path.lexists(out):
        raise InputError(Mistake("--out", "", "a file that does not exist yet", str(out), "give another name"))
    if not paths.is_file(motion):
        raise InputError(Mistake("--motion", "", "an existing file", str(motion)))
    told = Told(
        known.density_kg_m3, known.mass_kg, around.pedestal_keys(), around.friction, around.scale, around.motion_unit
    )
    shaking = read_record(motion, unit=told.motion_unit)
    mesh = out.with_name(f"{out.stem}_statue.ply")
    for beside in (mesh, mesh.with_suffix(".account.json")):
        if os.path.lexists(beside):
            raise InputError(Mistake("--out", "", f"a name beside which {beside.name} does not exist yet", str(beside)))
    found, account = prepare(scan, mesh, known)
    try:
        record.write_text(out, scene_text(found, scan, mesh, shaking, motion, told))
        load_scene(out)
    except Exception:
        for written in (out, mesh, account):
            written.unlink(missing_ok=True)
        raise
    return out


def _check_out(out: Path, account: Path, file: Path) -> None:
    """Refuse an output that is no mesh format, would overwrite the scan, or anything but a mesh that was prepared before."""
    from meshes.intake import FORMATS

    if out.suffix.lower() not in FORMATS:
        raise InputError(Mistake("--out", "", f"a file ending in {', '.join(FORMATS)}", str(out)))
    if out.resolve() == file.resolve():
        raise InputError(Mistake("--out", "", "another file than the scan itself", str(out)))
    check_listed(out, account)


def _plain(found: Inspection, known: Known) -> dict[str, Any]:
    """The account as it is written, with what the user said."""
    from dataclasses import asdict

    return {**found.as_dict(), "known": asdict(known)}
