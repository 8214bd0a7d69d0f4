"""What `rockcheck mesh inspect|prepare` and `rockcheck new` do: records and text; the command's own words are
elsewhere."""

from __future__ import annotations

import os
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from harness.input.files import is_file
from harness.input.mesh_statue import MARBLE_KG_M3, findings_of, mesh_mistake, steps_of
from harness.input.mistakes import wanted_of
from harness.model import Finding, InputError, Mistake, Say, check_own, checksum, require, texted, write_text, writing
from harness.model import run as record
from harness.records.base import listed
from reports.cli.app import ScanOptions, SupportOptions

if TYPE_CHECKING:
    from harness.input.motions.recordfile import Layout
    from meshes.prepare import Inspection


def inspect(file: Path, known: ScanOptions) -> Inspection:
    """Inspect a scan; raises `InputError` where it cannot be prepared."""
    from pydantic import TypeAdapter, ValidationError

    from harness.input.tables import Density, Mass, Tolerance
    from meshes import MeshError
    from meshes.prepare import Wanted
    from meshes.prepare import inspect as inspected

    one = known.density_kg_m3 is None or known.mass_kg is None
    require(one, "--density", "a density or a weighed mass", "both", "give one of them")
    for name, taken, value in (
        ("density", Density, known.density_kg_m3),
        ("mass", Mass, known.mass_kg),
        ("contact-tolerance", Tolerance, known.contact_tolerance_m),
    ):
        if value is None:
            continue
        try:
            TypeAdapter[float](taken).validate_python(value)
        except ValidationError as error:
            raise InputError(Mistake(f"--{name}", "", wanted_of(error.errors()[0]), f"{value:g}")) from None
    density = known.density_kg_m3
    if density is None and known.mass_kg is None:
        density = MARBLE_KG_M3
    wanted = Wanted(known.unit, known.height_m, known.up, known.max_faces, known.cut_below_m, _plane(known.cut_beyond))
    try:
        return inspected(
            file,
            wanted,
            density_kg_m3=density,
            mass_kg=known.mass_kg,
            contact_tolerance_m=known.contact_tolerance_m,
        )
    except MeshError as error:
        raise InputError(mesh_mistake(error, str(file))) from error


def record_of(inspection: Inspection, say: Say) -> dict[str, object]:
    """An inspection as plain values, what was found with its sentences."""
    log = inspection.prepared.log
    findings = texted(findings_of(log.found), say)
    account = log.as_dict() | {"found": [each.text for each in findings], "done": steps_of(log, say)}
    return {**inspection.as_dict(), "account": account, "findings": record.to_plain(findings)}


def prepare(
    file: Path, out: Path, known: ScanOptions, say: Say = lambda finding: finding.code
) -> tuple[Inspection, Path]:
    """Prepare a scan into the mesh file `out`, with its processing log beside it as JSON; returns the inspection and that
    path.

    Raises `InputError` for a scan that cannot be prepared or does not stand; then nothing is written.
    """
    log, sums = _checked_out(out, file)
    inspection = inspect(file, known)
    if inspection.refusal is not None:
        raise InputError(mesh_mistake(inspection.refusal, str(file)))
    out.parent.mkdir(parents=True, exist_ok=True)
    with writing(out, sums) as fresh:
        inspection.prepared.write(fresh)
        # Before the mesh is in its place: where there is no room for its log, both are as they were.
        said = {"known": asdict(known), "files": {out.name: checksum(fresh)}}
        record.write_json(log, {**record_of(inspection, say), **said})
    return inspection, log


def new(
    scan: Path,
    motion: Path,
    out: Path,
    known: ScanOptions,
    around: SupportOptions | None = None,
    layout: Layout | None = None,
    say: Say = lambda finding: finding.code,
) -> tuple[Path, list[Finding]]:
    """Write a first scene `out` (TOML) for a scan and a record, with the prepared mesh beside it; returns its path, and what was
    found doubtful in the scan and assumed.

    All of it stands in the scene as comments, in the sentences of `say`. Raises `InputError`; then no scene is written.
    """
    from harness.input.motions.readers import read_record
    from harness.input.new_scene import first_scene
    from harness.input.scene_file import load_scene

    require(out.suffix == ".toml", "--out", "a file ending in .toml", str(out))
    require(not os.path.lexists(out), "--out", "a file that does not exist yet", str(out), "give another name")
    require(is_file(motion), "--motion", "an existing file", str(motion))
    around = around or SupportOptions()
    pedestal = around.pedestal_keys()
    shaking = read_record(motion, unit=around.motion_unit, layout=layout)
    mesh = out.with_name(f"{out.stem}_statue.ply")
    for beside in (mesh, mesh.with_suffix(".account.json")):
        wanted = f"a name beside which {beside.name} does not exist yet"
        require(not os.path.lexists(beside), "--out", wanted, str(beside))
    inspection, log = prepare(scan, mesh, known, say)
    found = findings_of(inspection.prepared.log.found)
    try:
        text, assumed = first_scene(
            inspection, scan, mesh, shaking, motion, say, density_kg_m3=known.density_kg_m3, mass_kg=known.mass_kg,
            pedestal=pedestal, friction=around.friction, scale=around.scale,
            read_as={"unit": around.motion_unit, **(vars(layout) if layout else {})},
        )  # fmt: skip
        write_text(out, text)
        doubted = [
            each
            for each in load_scene(out).findings
            if each.code in ("odd_density", "odd_friction", "part_beyond_base")
        ]
    except BaseException as error:
        for written in (out, mesh, log):
            written.unlink(missing_ok=True)
        if isinstance(error, InputError):
            # The scene is gone: its numbers were given with options.
            raise InputError(replace(each, where=_option(each.key) or each.where) for each in error.mistakes) from None
        raise
    return out, [*found, *doubted, *assumed]


GIVEN_WITH: Final = {"contact": "--friction", "pedestal": "--pedestal", "motion.scale": "--scale"}
"""What a table or a key of a first scene is given with."""


def _option(key: str) -> str | None:
    return GIVEN_WITH.get(key, GIVEN_WITH.get(key.partition(".")[0]))


def _plane(text: str | None) -> tuple[float, float] | None:
    """The azimuth and the distance of --cut-beyond; "none" cuts nothing. InputError for anything else."""
    if text is None:
        return None
    parts = ["0", "inf"] if text == "none" else text.split(",")
    try:
        azimuth, distance = (float(part) for part in parts)
    except ValueError:
        wanted = "an azimuth in degrees and a distance in metres, such as 90,0.35, or none"
        raise InputError(Mistake("--cut-beyond", "", wanted, repr(text))) from None
    return azimuth, distance


def _checked_out(out: Path, file: Path) -> tuple[Path, set[str]]:
    """The log beside an output and the checksums that it lists of this; `InputError` for an output that is no mesh format, or
    would overwrite the scan, or anything but a mesh that was prepared before.
    """
    from meshes.intake import FORMATS

    require(out.suffix.lower() in FORMATS, "--out", f"a file ending in {', '.join(FORMATS)}", str(out))
    itself = os.path.realpath(out) == os.path.realpath(file)
    require(not itself, "--out", "another file than the scan itself", str(out))
    log = out.with_suffix(".account.json")
    sums = listed(log).get(out.name, set())
    check_own(out, sums, "--out")
    check_own(log)
    return log, sums
